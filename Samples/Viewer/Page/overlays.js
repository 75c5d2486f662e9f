// What is drawn over the bodies: contact points, contact normals and bounding boxes.
import {
  BufferAttribute, BufferGeometry, Color, DynamicDrawUsage, InstancedBufferAttribute, InstancedBufferGeometry, LineBasicMaterial,
  LineSegments, Points, Quaternion, ShaderMaterial, Vector3,
} from 'three';
import { includeLeaf, leavesOf } from './shapes.js';

const TOUCHING = new Color('#0d3b66');
const OVERLAPPING = new Color('#d7263d');
const NORMAL = new Color('#0f7a43');
const OVERLAP_SHOWN_RED = 0.01; // m

// Contacts lie between bodies: those in sight are drawn in full, the others faintly through what hides them.
export const IN_SIGHT = { transparent: true, depthWrite: false };
export const HIDDEN = { ...IN_SIGHT, depthTest: false };

export function pointMaterial(settings, opacity, pixels) {
  return new ShaderMaterial({
    ...settings,
    vertexColors: true,
    uniforms: { pixels: { value: pixels }, opacity: { value: opacity } },
    vertexShader: `
      uniform float pixels;
      varying vec3 tint;
      void main() {
        tint = color;
        vec4 place = modelViewMatrix * vec4(position, 1.0);
        gl_Position = projectionMatrix * vec4(0.997 * place.xyz, 1.0); // before the surface that it lies in
        gl_PointSize = pixels;
      }`,
    fragmentShader: `
      uniform float opacity;
      varying vec3 tint;
      void main() {
        float distance = length(gl_PointCoord - 0.5);
        if (distance > 0.5) discard;
        gl_FragColor = vec4(distance > 0.36 ? vec3(1.0) : tint, opacity);
        #include <colorspace_fragment>
      }`,
  });
}

// An object drawn twice, as above. `pair.visible` shows both. `order`: among the overlays, the highest comes last.
export class SeenThrough {
  constructor(stage, inSight, hidden, order = 2) {
    this.objects = [hidden, inSight];
    this.visible = false;
    this.objects.forEach((object, i) => {
      object.frustumCulled = false;
      object.renderOrder = order + i;
      stage.scene.add(object);
    });
  }
  get visible() { return this.objects[0].visible; }
  set visible(isVisible) { for (const object of this.objects) object.visible = isVisible; }
}

export class Contacts {
  constructor(recording, stage) {
    const most = recording.contacts.reduce((sum, contacts) => Math.max(sum, contacts.count), 0);
    const buffer = (perContact) => new BufferAttribute(new Float32Array(perContact * most), 3).setUsage(DynamicDrawUsage);
    this.geometry = new BufferGeometry().setAttribute('position', buffer(3)).setAttribute('color', buffer(3));
    this.lineGeometry = new BufferGeometry().setAttribute('position', buffer(6));
    for (const geometry of [this.geometry, this.lineGeometry]) geometry.setDrawRange(0, 0);
    const pixels = 7 * stage.renderer.getPixelRatio();
    this.points = new SeenThrough(stage, new Points(this.geometry, pointMaterial(IN_SIGHT, 1, pixels)),
      new Points(this.geometry, pointMaterial(HIDDEN, 0.16, 0.6 * pixels)));
    const lines = (settings, opacity) => new LineSegments(this.lineGeometry, new LineBasicMaterial({ color: NORMAL, opacity, ...settings }));
    this.normals = new SeenThrough(stage, lines(IN_SIGHT, 1), lines(HIDDEN, 0.1));
  }

  get isVisible() { return this.points.visible || this.normals.visible; }

  // `length`: of the normal of the largest impulse, meters.
  update(contacts, length) {
    if (contacts === this.shown) return;
    this.shown = contacts;
    const count = contacts?.count ?? 0;
    const places = this.geometry.attributes.position, colors = this.geometry.attributes.color, ends = this.lineGeometry.attributes.position;
    if (count > 0) places.array.set(contacts.points.subarray(0, 3 * count));
    const color = new Color();
    const largest = count > 0 ? contacts.impulses.subarray(0, count).reduce((a, b) => Math.max(a, b), 1e-9) : 1;
    for (let i = 0; i < count; ++i) {
      color.lerpColors(TOUCHING, OVERLAPPING, Math.min(1, Math.max(0, -contacts.separations[i] / OVERLAP_SHOWN_RED))).toArray(colors.array, 3 * i);
      const reach = length * (0.3 + 0.7 * Math.sqrt(contacts.impulses[i] / largest));
      for (let k = 0; k < 3; ++k) {
        ends.array[6 * i + k] = contacts.points[3 * i + k];
        ends.array[6 * i + 3 + k] = contacts.points[3 * i + k] + reach * contacts.normals[3 * i + k];
      }
    }
    for (const attribute of [places, colors, ends]) attribute.needsUpdate = true;
    this.geometry.setDrawRange(0, count);
    this.lineGeometry.setDrawRange(0, 2 * count);
  }
}

function unitBoxLines() {
  const lines = [];
  for (let axis = 0; axis < 3; ++axis) {
    for (const [u, v] of [[-1, -1], [-1, 1], [1, -1], [1, 1]]) {
      for (const end of [-1, 1]) {
        const corner = [];
        corner[axis] = end;
        corner[(axis + 1) % 3] = u;
        corner[(axis + 2) % 3] = v;
        lines.push(...corner);
      }
    }
  }
  return new BufferAttribute(new Float32Array(lines), 3);
}

export class BoundingBoxes {
  constructor(recording, timeline, stage) {
    this.timeline = timeline;
    this.leaves = recording.shapes.map((_, index) => leavesOf(recording.shapes, index));
    this.bodies = [...recording.bodies.motions.keys()].filter((body) => recording.bodies.motions[body] !== 0);
    const buffer = () => new InstancedBufferAttribute(new Float32Array(3 * this.bodies.length), 3).setUsage(DynamicDrawUsage);
    this.geometry = new InstancedBufferGeometry().setAttribute('position', unitBoxLines())
      .setAttribute('center', buffer()).setAttribute('halfSize', buffer());
    this.geometry.instanceCount = this.bodies.length;
    const material = new ShaderMaterial({
      uniforms: { tint: { value: new Color('#b0357a') } },
      vertexShader: `
        attribute vec3 center, halfSize;
        void main() { gl_Position = projectionMatrix * viewMatrix * vec4(center + position * halfSize, 1.0); }`,
      fragmentShader: `
        uniform vec3 tint;
        void main() {
          gl_FragColor = vec4(tint, 1.0);
          #include <colorspace_fragment>
        }`,
    });
    this.object = new LineSegments(this.geometry, material);
    this.object.frustumCulled = false;
    this.object.visible = false;
    stage.scene.add(this.object);
  }

  update() {
    if (!this.object.visible) return;
    const { center, halfSize } = this.geometry.attributes;
    const place = new Vector3(), turn = new Quaternion(), leafPlace = new Vector3(), leafTurn = new Quaternion();
    const lower = new Vector3(), upper = new Vector3(), scratch = new Vector3();
    this.bodies.forEach((body, i) => {
      const shape = this.timeline.presence(body)?.shape;
      if (shape === undefined) {
        halfSize.array.fill(0, 3 * i, 3 * i + 3);
        return;
      }
      place.fromArray(this.timeline.positions, 3 * body);
      turn.fromArray(this.timeline.rotations, 4 * body).normalize();
      lower.setScalar(Infinity);
      upper.setScalar(-Infinity);
      for (const { shape: leaf, position, rotation } of this.leaves[shape]) {
        leafPlace.copy(position).applyQuaternion(turn).add(place);
        includeLeaf(leaf, leafPlace, leafTurn.copy(turn).multiply(rotation), lower, upper, scratch);
      }
      lower.add(upper).multiplyScalar(0.5).toArray(center.array, 3 * i);
      upper.sub(lower).toArray(halfSize.array, 3 * i);
    });
    center.needsUpdate = true;
    halfSize.needsUpdate = true;
  }
}
