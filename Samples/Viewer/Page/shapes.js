// What shapes look like and how large they are. A shape is drawn as leaves: convex shapes with a pose in the body's frame
// (a compound has several) and a scale, so that spheres of any size share one geometry.
import { BoxGeometry, BufferAttribute, BufferGeometry, CapsuleGeometry, Quaternion, SphereGeometry, Vector3 } from 'three';
import { RoundedBoxGeometry } from 'three/addons/geometries/RoundedBoxGeometry.js';
import { gearGeometry, triangleColor } from './looks.js';

const BEVELLED_BOXES_AT_MOST = 20000; // their edges catch the light, at nine times the triangles
const BOX_GEOMETRIES_AT_MOST = 48;    // of more sizes than this, all boxes share one geometry, and have sharp edges
const FINE_SPHERES_AT_MOST = 3000;

// All leaves of shape `index`: [{ shape, position, rotation }].
export function leavesOf(shapes, index, position = new Vector3(), rotation = new Quaternion()) {
  const shape = shapes[index];
  if (shape.kind !== 'compound') return [{ shape, position, rotation }];
  return shape.children.flatMap((child) => leavesOf(
    shapes, child.shape,
    new Vector3(...child.position).applyQuaternion(rotation).add(position),
    rotation.clone().multiply(new Quaternion(...child.rotation))));
}

// Half the size of a leaf's bounding box, its rotation given as the rows of |R|; `out` is a Vector3.
export function halfBounds(shape, rotation, out) {
  if (shape.kind === 'sphere') return out.setScalar(shape.radius);
  const { x, y, z, w } = rotation;
  if (shape.kind === 'capsule') {
    out.set(2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)); // the turned y axis
    return out.set(Math.abs(out.x), Math.abs(out.y), Math.abs(out.z)).multiplyScalar(shape.halfHeight).addScalar(shape.radius);
  }
  const [a, b, c] = shape.halfExtents;
  return out.set(
    Math.abs(1 - 2 * (y * y + z * z)) * a + Math.abs(2 * (x * y - w * z)) * b + Math.abs(2 * (x * z + w * y)) * c,
    Math.abs(2 * (x * y + w * z)) * a + Math.abs(1 - 2 * (x * x + z * z)) * b + Math.abs(2 * (y * z - w * x)) * c,
    Math.abs(2 * (x * z - w * y)) * a + Math.abs(2 * (y * z + w * x)) * b + Math.abs(1 - 2 * (x * x + y * y)) * c);
}

// Widens `lower` and `upper` by the leaf, its pose given in the frame that the bounds are in.
export function includeLeaf(shape, position, rotation, lower, upper, scratch) {
  if (shape.kind === 'hull') {
    for (const vertex of shape.vertices) {
      scratch.set(...vertex).applyQuaternion(rotation).add(position);
      lower.min(scratch);
      upper.max(scratch);
    }
    return;
  }
  halfBounds(shape, rotation, scratch);
  lower.set(Math.min(lower.x, position.x - scratch.x), Math.min(lower.y, position.y - scratch.y), Math.min(lower.z, position.z - scratch.z));
  upper.set(Math.max(upper.x, position.x + scratch.x), Math.max(upper.y, position.y + scratch.y), Math.max(upper.z, position.z + scratch.z));
}

// Distance of the shape's farthest point from its frame's origin.
export function outerRadius(shapes, index) {
  let radius = 0;
  for (const { shape, position } of leavesOf(shapes, index)) {
    const own = shape.kind === 'sphere' ? shape.radius
      : shape.kind === 'capsule' ? shape.halfHeight + shape.radius
      : shape.kind === 'box' ? Math.hypot(...shape.halfExtents)
      : Math.max(...shape.vertices.map((vertex) => Math.hypot(...vertex)));
    radius = Math.max(radius, position.length() + own);
  }
  return radius;
}

export function describe(shape) {
  const meters = (...values) => values.map((value) => Number(value.toPrecision(3))).join(' × ') + ' m';
  switch (shape.kind) {
    case 'sphere': return `sphere, radius ${meters(shape.radius)}`;
    case 'box': return `box, ${meters(...shape.halfExtents.map((half) => 2 * half))}`;
    case 'capsule': return `capsule, radius ${meters(shape.radius)}, length ${meters(2 * (shape.halfHeight + shape.radius))}`;
    case 'hull': return `hull of ${shape.vertices.length} points`;
    default: return `compound of ${shape.children.length} shapes`;
  }
}

// Every other part of a round body is darker, so that one sees it turn.
function paint(geometry, isRound, looks) {
  const flat = geometry.index ? geometry.toNonIndexed() : geometry;
  const places = flat.attributes.position;
  const colors = new Float32Array(3 * places.count).fill(1);
  looks?.forEach((look, triangle) => {
    const { r, g, b } = triangleColor(look);
    for (let corner = 0; corner < 3; ++corner) colors.set([r, g, b], 9 * triangle + 3 * corner);
  });
  if (isRound) {
    for (let i = 0; i < places.count; i += 3) {
      const sum = (read) => read(i) + read(i + 1) + read(i + 2);
      const sign = sum((k) => places.getX(k)) * sum((k) => places.getY(k)) * sum((k) => places.getZ(k));
      if (sign < 0) colors.fill(0.68, 3 * i, 3 * i + 9);
    }
  }
  flat.setAttribute('color', new BufferAttribute(colors, 3));
  flat.deleteAttribute('uv');
  return flat;
}

const CREASE = Math.cos((38 * Math.PI) / 180); // what bends by less is round

// Faces meet in edges where they bend by more than the crease, and smoothly elsewhere: hills and teapots are round, crystals are not.
function hullGeometry({ vertices, triangles }) {
  const places = new Float32Array(9 * triangles.length), normals = new Float32Array(9 * triangles.length);
  const corners = vertices.map((vertex) => new Vector3(...vertex)), around = vertices.map(() => []);
  const edge = new Vector3();
  // Twice the area long, so that large faces count for more.
  const faces = triangles.map(([a, b, c], i) => {
    const face = new Vector3().subVectors(corners[b], corners[a]).cross(edge.subVectors(corners[c], corners[a]));
    for (const corner of [a, b, c]) around[corner].push(i);
    return face;
  });
  const units = faces.map((face) => face.clone().normalize());
  const sum = new Vector3();
  triangles.forEach((triangle, i) => triangle.forEach((corner, k) => {
    sum.set(0, 0, 0);
    for (const other of around[corner]) if (units[other].dot(units[i]) >= CREASE) sum.add(faces[other]);
    corners[corner].toArray(places, 9 * i + 3 * k);
    sum.normalize().toArray(normals, 9 * i + 3 * k);
  }));
  return new BufferGeometry().setAttribute('position', new BufferAttribute(places, 3)).setAttribute('normal', new BufferAttribute(normals, 3));
}

// Says which geometry a leaf is drawn with: { key, scale, make }. Leaves of one key share what `make` returns.
export class GeometryChoice {
  constructor(leafCount, shapes) {
    this.leafCount = leafCount;
    this.oneBox = leafCount > BEVELLED_BOXES_AT_MOST || shapes.filter((shape) => shape.kind === 'box').length > BOX_GEOMETRIES_AT_MOST;
  }

  // `look`: of the body, where the scene gave it one.
  of(shape, isFixed, look) {
    if (look?.teeth > 0 && shape.kind === 'hull') {
      const make = () => paint(gearGeometry(shape.vertices, look.teeth, look.phase ?? 0), false);
      return { key: `gear ${look.teeth} ${look.phase} ${JSON.stringify(shape.vertices[0])}`, scale: [1, 1, 1], make };
    }
    if (shape.kind === 'sphere') {
      const [across, down] = this.leafCount > FINE_SPHERES_AT_MOST ? [16, 10] : [32, 20];
      return { key: 'sphere', scale: [shape.radius, shape.radius, shape.radius], make: () => paint(new SphereGeometry(1, across, down), true) };
    }
    if (shape.kind === 'capsule') {
      const segments = this.leafCount > FINE_SPHERES_AT_MOST ? 4 : 7;
      const make = () => paint(new CapsuleGeometry(shape.radius, 2 * shape.halfHeight, segments, 4 * segments, 2), true);
      return { key: `capsule ${shape.radius} ${shape.halfHeight}`, scale: [1, 1, 1], make };
    }
    if (shape.kind === 'box') {
      const size = shape.halfExtents.map((half) => 2 * half);
      if (this.oneBox || isFixed) return { key: 'box', scale: size, make: () => paint(new BoxGeometry(1, 1, 1), false) };
      const bevel = 0.05 * Math.min(...size);
      return { key: `box ${size}`, scale: [1, 1, 1], make: () => paint(new RoundedBoxGeometry(...size, 1, bevel), false) };
    }
    return { key: shape, scale: [1, 1, 1], make: () => paint(hullGeometry(shape), false, shape.looks) };
  }
}
