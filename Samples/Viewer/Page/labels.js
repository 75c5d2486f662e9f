// The names of bodies, written beside them: sprites of a constant size, seen through what hides them.
import { CanvasTexture, Quaternion, SRGBColorSpace, Sprite, SpriteMaterial, Vector3 } from 'three';
import { includeLeaf, leavesOf } from './shapes.js';

const PIXELS = 12; // height of the letters
const PADDING = 4;

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

export class Labels {
  constructor(recording, timeline, stage) {
    this.recording = recording;
    this.timeline = timeline;
    this.stage = stage;
    const scale = Math.max(2, stage.renderer.getPixelRatio());
    this.labels = Object.entries(recording.bodies.names).map(([body, text]) => {
      const { texture, width, height } = textureOf(text, scale);
      const sprite = new Sprite(new SpriteMaterial({ map: texture, depthTest: false, depthWrite: false, sizeAttenuation: false, toneMapped: false, fog: false }));
      sprite.center.set(0.5, -0.25);
      sprite.renderOrder = 20;
      stage.scene.add(sprite);
      return { body: Number(body), sprite, width, height };
    });
    this.visible = this.labels.length > 0;
  }

  update() {
    // A sprite without attenuation is as large as at a distance of one.
    const perPixel = (2 * Math.tan((this.stage.camera.fov * Math.PI) / 360)) / this.stage.height;
    const turn = new Quaternion();
    for (const { body, sprite, width, height } of this.labels) {
      const presence = this.visible ? this.timeline.presence(body) : undefined;
      sprite.visible = presence !== undefined;
      if (!presence) continue;
      sprite.scale.set(width * perPixel, height * perPixel, 1);
      turn.fromArray(this.timeline.rotations, 4 * body).normalize();
      sprite.position.fromArray(this.timeline.positions, 3 * body);
      sprite.position.y += topOf(this.recording, presence.shape, turn);
    }
  }
}
