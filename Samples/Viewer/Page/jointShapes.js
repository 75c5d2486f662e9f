// Lines and surfaces that show the limits of a joint. They are made once for a joint and a set of limits, each in a frame that
// the joint carries along:
//
//   A, B   the joint's frames           turn   frame A at B's anchor           swing  that, swung: its x is that of B
//   line   at A's anchor, x towards B's
//
// The result maps a frame's name to { lines: [x0, y0, z0, x1, y1, z1, ...], surface: [three corners of a triangle, ...] }.
import { Quaternion, Vector3 } from 'three';

const FULL = 2 * Math.PI;
const AXES = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
const hasBoth = ([min, max]) => Number.isFinite(min) && Number.isFinite(max);
const isLocked = ([min, max]) => max - min < 2e-4;
const isFreeAngle = ([min, max]) => !(max - min < FULL - 2e-4);

class Part {
  lines = [];
  surface = [];

  line(from, to) {
    this.lines.push(...from, ...to);
  }
  strip(points) {
    for (let i = 0; i + 1 < points.length; ++i) this.line(points[i], points[i + 1]);
  }
  fan(apex, points) {
    for (let i = 0; i + 1 < points.length; ++i) this.surface.push(...apex, ...points[i], ...points[i + 1]);
  }
  // A small cross where a range along `axis` ends.
  tick(axis, at, size) {
    const center = AXES[axis].map((n) => n * at);
    for (const other of [(axis + 1) % 3, (axis + 2) % 3]) {
      const end = (side) => center.map((n, k) => n + side * size * AXES[other][k]);
      this.line(end(-1), end(1));
    }
  }
}

// Points of an arc in the plane of the axes u and v (0, 1, 2), from u towards v, around the point `x` along w.
function arc(u, v, radius, from, to, shift = 0) {
  const w = 3 - u - v, count = Math.max(2, Math.ceil((48 * (to - from)) / FULL));
  return Array.from({ length: count + 1 }, (_, i) => {
    const angle = from + ((to - from) * i) / count, point = [0, 0, 0];
    point[u] = radius * Math.cos(angle);
    point[v] = radius * Math.sin(angle);
    point[w] = shift;
    return point;
  });
}

// The range of a rotation about w = u x v: a sector; a circle where it is free; nothing where it is locked.
function sector(part, u, v, range, radius, shift = 0) {
  if (isLocked(range)) return;
  if (isFreeAngle(range)) {
    part.strip(arc(u, v, radius, 0, FULL, shift));
    return;
  }
  const edge = arc(u, v, radius, range[0], range[1], shift), center = [0, 0, 0];
  center[3 - u - v] = shift;
  part.strip(edge);
  part.line(center, edge[0]);
  part.line(center, edge[edge.length - 1]);
  part.fan(center, edge);
}

// The range of a translation along an axis: a line with a tick at each limit; a side without one goes on for a bit.
function track(part, axis, [min, max], size) {
  if (isLocked([min, max])) return;
  const endless = 4 * size;
  const from = Number.isFinite(min) ? min : Math.min(0, max) - endless, to = Number.isFinite(max) ? max : Math.max(0, min) + endless;
  part.line(AXES[axis].map((n) => n * from), AXES[axis].map((n) => n * to));
  if (Number.isFinite(min)) part.tick(axis, min, 0.3 * size);
  if (Number.isFinite(max)) part.tick(axis, max, 0.3 * size);
}

// The ranges of the three translations together: a line, a rectangle or a box; nothing along an axis that is free or locked.
function room(part, ranges, size) {
  const wide = [0, 1, 2].filter((axis) => !isLocked(ranges[axis]) && ranges[axis].some(Number.isFinite));
  if (wide.length === 1 || !wide.every((axis) => hasBoth(ranges[axis]))) {
    for (const axis of wide) track(part, axis, ranges[axis], size);
    return;
  }
  const corner = (choice) => ranges.map((range, axis) => (wide.includes(axis) ? range[(choice >> axis) & 1] : 0));
  const all = wide.reduce((sum, axis) => sum | (1 << axis), 0);
  for (const axis of wide)
    for (let choice = 0; choice < 8; ++choice)
      if ((choice & all & ~(1 << axis)) === choice) part.line(corner(choice), corner(choice | (1 << axis)));
}

const x = new Vector3(), swing = new Quaternion();
const direction = (y, z, w, radius) => x.set(radius, 0, 0).applyQuaternion(swing.set(0, y, z, w).normalize()).toArray();

// The edge that B's x axis stays within, from the frame's origin: closed curves, see Constraints/Parts/SwingTwist.h.
function swingEdges(y, z, isPyramid, radius) {
  const count = 64, angles = Array.from({ length: count + 1 }, (_, i) => (FULL * i) / count);
  const freeY = isFreeAngle(y), freeZ = isFreeAngle(z);
  if (freeY && freeZ) return [];
  if (freeY || freeZ) {
    // A band between two circles of latitude: towards -z for y, towards y for z.
    const [range, pole] = freeZ ? [y, [0, 0, -1]] : [z, [0, 1, 0]];
    const across = freeZ ? [0, 1, 0] : [0, 0, 1];
    return range.filter((latitude) => Math.abs(latitude) < Math.PI / 2).map((latitude) => angles.map((angle) => {
      const c = radius * Math.cos(latitude), s = radius * Math.sin(latitude);
      return [0, 1, 2].map((k) => pole[k] * s + c * (Math.cos(angle) * AXES[0][k] + Math.sin(angle) * across[k]));
    }));
  }
  if (!isPyramid && !isLocked(y) && !isLocked(z)) {
    return [angles.map((angle) => {
      const a = y[1] * Math.cos(angle), b = z[1] * Math.sin(angle), alpha = Math.max(1e-9, Math.hypot(a, b));
      const sine = Math.sin(alpha / 2) / alpha;
      return direction(a * sine, b * sine, Math.cos(alpha / 2), radius);
    })];
  }
  // Along the four sides of the rectangle of both angles' half tangents.
  const tangent = (angle) => Math.tan(0.5 * Math.min(3.1, Math.max(-3.1, angle)));
  const corners = [[y[1], z[1]], [y[0], z[1]], [y[0], z[0]], [y[1], z[0]]];
  const edge = [];
  for (let side = 0; side < 4; ++side) {
    const from = corners[side], to = corners[(side + 1) % 4];
    for (let i = 0; i < 16; ++i) {
      const at = (k) => tangent(from[k] + ((to[k] - from[k]) * i) / 16);
      edge.push(direction(at(0), at(1), 1, radius));
    }
  }
  return [[...edge, edge[0]]];
}

function swingCone(part, y, z, isPyramid, radius) {
  if (isLocked(y) && isLocked(z)) return;
  for (const edge of swingEdges(y, z, isPyramid, radius)) {
    part.strip(edge);
    const isCone = !isFreeAngle(y) && !isFreeAngle(z);
    if (!isCone) continue;
    part.fan([0, 0, 0], edge);
    for (let i = 0; i + 1 < edge.length; i += (edge.length - 1) / 8) part.line([0, 0, 0], edge[i]);
  }
}

// What turns: one axis as a hinge, else swing and twist, whose dial is on the swung axis.
function rotations(parts, joint, limits, radius) {
  const [twist, y, z] = limits.slice(3);
  if (joint.angularLock === 'all') return;
  if (joint.angularLock === 'axis') {
    sector(parts('turn'), (joint.axis + 1) % 3, (joint.axis + 2) % 3, limits[3 + joint.axis], radius);
    return;
  }
  swingCone(parts('turn'), y, z, joint.isPyramid, radius);
  if (!isFreeAngle(twist)) sector(parts('swing'), 1, 2, twist, 0.45 * radius, 0.8 * radius);
}

function rings(part, [min, max], size) {
  for (const at of new Set([min, max])) if (at > 0 && Number.isFinite(at)) part.strip(arc(1, 2, 0.3 * size, 0, FULL, at));
  if (Number.isFinite(max) && max - min > 1e-4) part.line([min, 0, 0], [max, 0, 0]);
}

// `size`: radius of arcs and cones, meters.
export function limitShape(joint, limits, size) {
  const shape = {}, parts = (frame) => (shape[frame] ??= new Part());
  if (joint.translations) room(parts('A'), limits.slice(0, 3), size);
  if (joint.rotations) rotations(parts, joint, limits, size);
  if (joint.trackA >= 0) track(parts('A'), joint.trackA, limits[joint.trackA], size);
  if (joint.trackB >= 0) track(parts('B'), joint.trackB, limits[joint.trackB], size);
  // Steering turns x towards -z, which is z towards x.
  if (joint.steering) sector(parts('A'), 0, 2, limits[4].map((n) => -n).reverse(), size);
  for (const frame of ['A', 'B']) {
    const radius = joint[`circle${frame}`];
    if (radius >= 0) parts(frame).strip(arc(1, 2, radius || size, 0, FULL));
  }
  if (joint.isRope && joint.points.length === 0) rings(parts('line'), limits[0], size);
  if (joint.isPath) parts('A').strip(joint.points);
  return shape;
}
