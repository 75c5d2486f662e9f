// The names of bodies, written above them: sprites of a constant size, seen through what hides them. One that would be over another
// stands higher, on a stem.
import { CanvasTexture, Quaternion, SRGBColorSpace, Sprite, SpriteMaterial, Vector3 } from 'three';
import { includeLeaf, leavesOf } from './shapes.js';

const PIXELS = 12; // height of the letters
const PADDING = 4;
const STEM = 1.5;       // pixels wide
const OVER_ALL = { depthTest: false, depthWrite: false, transparent: true, sizeAttenuation: false, toneMapped: false, fog: false };
const ABOVE = 0.25;     // of a label's height: its distance from what it names
const GAP = 2;          // pixels between labels
const MOST_RAISED = 12; // labels on top of each other

function textureOf(text, scale) {
  const canvas = document.createElement('canvas');
  const context = canvas.getContext('2d');
  const font = `600 ${PIXELS * scale}px system-ui, "Segoe UI", "DejaVu Sans", sans-serif`;
  context.font = font;
  canvas.width = Math.ceil(context.measureText(text).width) + 2 * PADDING * scale;
  canvas.height = Math.ceil((PIXELS + PADDING) * scale);
  context.font = font;
  context.fillStyle = 'rgba(255, 255, 255, 0.82)';
  context.beginPath();
  context.roundRect(0, 0, canvas.width, canvas.height, 3 * scale);
  context.fill();
  context.fillStyle = '#16202b';
  context.textBaseline = 'middle';
  context.fillText(text, PADDING * scale, canvas.height / 2);
  const texture = new CanvasTexture(canvas);
  texture.colorSpace = SRGBColorSpace;
  return { texture, width: canvas.width / scale, height: canvas.height / scale };
}

// The highest point of a body's shape above its origin, as it stands.
function topOf(recording, shape, turn) {
  const lower = new Vector3().setScalar(Infinity), upper = new Vector3().setScalar(-Infinity), scratch = new Vector3();
  const place = new Vector3(), leafTurn = new Quaternion();
  for (const { shape: leaf, position, rotation } of leavesOf(recording.shapes, shape))
    includeLeaf(leaf, place.copy(position).applyQuaternion(turn), leafTurn.copy(turn).multiply(rotation), lower, upper, scratch);
  return Number.isFinite(upper.y) ? upper.y : 0;
}

// How much higher each label stands, pixels. `labels`: [{ x, y, width, height }], the lower middle and y upwards, in order of y.
export function raises(labels) {
  const placed = [];
  return labels.map(({ x, y, width, height }) => {
    const isFree = (raise) => placed.every((other) => Math.abs(other.x - x) >= (other.width + width) / 2 + GAP ||
      y + raise >= other.y + other.height + GAP || y + raise + height + GAP <= other.y);
    let raise = 0;
    // A place that is free is on the ground or on top of another.
    if (!isFree(0)) {
      const tops = placed.map((other) => other.y + other.height + GAP - y).filter((top) => top > 0 && top < MOST_RAISED * (height + GAP)).sort((a, b) => a - b);
      raise = tops.find(isFree) ?? 0;
    }
    placed.push({ x, y: y + raise, width, height });
    return raise;
  });
}

export class Labels {
  constructor(recording, timeline, stage) {
    this.recording = recording;
    this.timeline = timeline;
    this.stage = stage;
    const scale = Math.max(2, stage.renderer.getPixelRatio());
    this.stemMaterial = new SpriteMaterial({ color: '#ffffff', opacity: 0.82, ...OVER_ALL });
    this.labels = Object.entries(recording.bodies.names).map(([body, text]) => {
      const { texture, width, height } = textureOf(text, scale);
      const sprite = new Sprite(new SpriteMaterial({ map: texture, ...OVER_ALL }));
      sprite.renderOrder = 21;
      const stem = new Sprite(this.stemMaterial);
      stem.center.set(0.5, 0);
      stem.renderOrder = 20;
      stage.scene.add(sprite, stem);
      return { body: Number(body), sprite, stem, width, height };
    });
    this.visible = this.labels.length > 0;
  }

  update() {
    // A sprite without attenuation is as large as at a distance of one.
    const { camera, height: pixels } = this.stage;
    const perPixel = (2 * Math.tan((camera.fov * Math.PI) / 360)) / pixels;
    const turn = new Quaternion(), seen = [];
    for (const label of this.labels) {
      const { body, sprite, stem, width, height } = label;
      const presence = this.visible ? this.timeline.presence(body) : undefined;
      sprite.visible = presence !== undefined;
      stem.visible = false;
      if (!presence) continue;
      sprite.scale.set(width * perPixel, height * perPixel, 1);
      turn.fromArray(this.timeline.rotations, 4 * body).normalize();
      sprite.position.fromArray(this.timeline.positions, 3 * body);
      sprite.position.y += topOf(this.recording, presence.shape, turn);
      const [x, y, depth] = this.stage.project(...sprite.position.toArray()), halfPicture = (pixels * camera.aspect) / 2;
      if (depth >= 1 || Math.abs(x) > 1) continue;
      // Whole, also at the picture's sides.
      const at = x * halfPicture, most = Math.max(0, halfPicture - width / 2 - GAP), inside = Math.min(most, Math.max(-most, at));
      seen.push({ label, aside: (at - inside) / width, x: inside, y: (y * pixels) / 2 + ABOVE * height, width, height });
    }
    seen.sort((a, b) => a.y - b.y || a.label.body - b.label.body);
    raises(seen).forEach((raise, i) => {
      const { label: { sprite, stem, height }, aside } = seen[i];
      sprite.center.set(0.5 + aside, -ABOVE - raise / height);
      stem.visible = raise > 0;
      stem.position.copy(sprite.position);
      stem.scale.set(STEM * perPixel, (raise + ABOVE * height) * perPixel, 1);
    });
  }
}
