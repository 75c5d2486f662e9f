// Many lines, dots and triangles that change with every picture, each kind one draw call and seen through what hides it.
import {
  BufferAttribute, BufferGeometry, DoubleSide, DynamicDrawUsage, Mesh, MeshBasicMaterial, Points,
} from 'three';
import { LineMaterial } from 'three/addons/lines/LineMaterial.js';
import { LineSegments2 } from 'three/addons/lines/LineSegments2.js';
import { LineSegmentsGeometry } from 'three/addons/lines/LineSegmentsGeometry.js';
import { HIDDEN, IN_SIGHT, SeenThrough, pointMaterial } from './overlays.js';

// Numbers of which there are more or fewer each time; grows, and never shrinks.
class Growing {
  constructor(count) {
    this.array = new Float32Array(count);
    this.count = 0;
  }
  room(count) {
    if (this.count + count <= this.array.length) return;
    const larger = new Float32Array(2 * (this.count + count));
    larger.set(this.array);
    this.array = larger;
  }
  three(a, b, c) {
    this.array[this.count++] = a;
    this.array[this.count++] = b;
    this.array[this.count++] = c;
  }
}

class Strokes {
  constructor() {
    this.places = new Growing(600);
    this.colors = new Growing(600);
  }
  get visible() { return this.pair.visible; }
  set visible(isVisible) { this.pair.visible = isVisible; }
  begin() {
    this.places.count = this.colors.count = 0;
  }
  // `points`: x y z of each, as many as the kind takes at a time; a matrix' elements put them into the world.
  add(points, matrix, color) {
    this.places.room(points.length);
    this.colors.room(points.length);
    for (let i = 0; i < points.length; i += 3) {
      const x = points[i], y = points[i + 1], z = points[i + 2], m = matrix;
      this.places.three(m[0] * x + m[4] * y + m[8] * z + m[12], m[1] * x + m[5] * y + m[9] * z + m[13], m[2] * x + m[6] * y + m[10] * z + m[14]);
      this.colors.three(color.r, color.g, color.b);
    }
  }
}

// Lines of `pixels` width, however far away; with a rim of `rim` pixels they are seen on any color.
export class Lines extends Strokes {
  constructor(stage, order, pixels, rim = 0) {
    super();
    this.geometry = new LineSegmentsGeometry();
    this.#reserve();
    this.geometry.instanceCount = 0; // until they are filled: else as many at the origin as there is room for
    const lines = (settings) => new LineSegments2(this.geometry, new LineMaterial({ toneMapped: false, ...settings }));
    const shown = { linewidth: pixels, vertexColors: true };
    this.pair = new SeenThrough(stage, lines({ ...shown, ...IN_SIGHT }), lines({ ...shown, ...HIDDEN, opacity: 0.75 }), order);
    if (rim > 0) {
      const behind = lines({ linewidth: pixels + 2 * rim, color: '#ffffff', ...HIDDEN, opacity: 0.6 });
      behind.renderOrder = order - 0.5;
      behind.frustumCulled = false;
      stage.scene.add(behind);
      this.pair.objects.push(behind);
    }
  }
  line(from, to, color) {
    this.places.room(6);
    this.colors.room(6);
    for (const end of [from, to]) {
      this.places.three(end.x, end.y, end.z);
      this.colors.three(color.r, color.g, color.b);
    }
  }
  end() {
    if (this.places.array !== this.reserved) this.#reserve();
    const { instanceStart, instanceColorStart } = this.geometry.attributes;
    instanceStart.data.needsUpdate = instanceColorStart.data.needsUpdate = true;
    this.geometry.instanceCount = this.places.count / 6;
  }
  #reserve() {
    this.geometry.dispose();
    this.reserved = this.places.array;
    this.geometry.setPositions(this.places.array).setColors(this.colors.array);
    for (const name of ['instanceStart', 'instanceColorStart']) this.geometry.attributes[name].data.setUsage(DynamicDrawUsage);
  }
}

// A geometry of points or triangles, three numbers a corner.
class Corners extends Strokes {
  constructor() {
    super();
    this.geometry = new BufferGeometry();
    this.#reserve();
    this.geometry.setDrawRange(0, 0);
  }
  end() {
    if (this.places.array !== this.reserved) this.#reserve();
    this.geometry.attributes.position.needsUpdate = this.geometry.attributes.color.needsUpdate = true;
    this.geometry.setDrawRange(0, this.places.count / 3);
  }
  #reserve() {
    this.geometry.dispose();
    this.reserved = this.places.array;
    this.geometry.setAttribute('position', new BufferAttribute(this.places.array, 3).setUsage(DynamicDrawUsage));
    this.geometry.setAttribute('color', new BufferAttribute(this.colors.array, 3).setUsage(DynamicDrawUsage));
  }
}

export class Dots extends Corners {
  constructor(stage, order, pixels) {
    super();
    const width = pixels * stage.renderer.getPixelRatio();
    this.pair = new SeenThrough(stage, new Points(this.geometry, pointMaterial(IN_SIGHT, 1, width)),
      new Points(this.geometry, pointMaterial(HIDDEN, 0.75, width)), order);
  }
  dot(place, color) {
    this.places.room(3);
    this.colors.room(3);
    this.places.three(place.x, place.y, place.z);
    this.colors.three(color.r, color.g, color.b);
  }
}

// Faint surfaces, seen from both sides.
export class Surfaces extends Corners {
  constructor(stage, order) {
    super();
    const surface = (settings, opacity) => new Mesh(this.geometry,
      new MeshBasicMaterial({ vertexColors: true, side: DoubleSide, toneMapped: false, opacity, ...settings }));
    this.pair = new SeenThrough(stage, surface(IN_SIGHT, 0.2), surface(HIDDEN, 0.06), order);
  }
}
