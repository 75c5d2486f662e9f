// Where a joint's frames are, how far it is along and about its axes, and how far out of place. No drawing here.
import { Quaternion, Vector3 } from 'three';

const turn = new Quaternion();

// The state of a joint at a frame: { enabled, limits }; undefined before its first.
export function stateAt(joint, frame) {
  const { states } = joint;
  let low = 0, high = states.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (states[middle].frame <= frame) low = middle + 1;
    else high = middle;
  }
  return states[low - 1];
}

// Both frames of a joint. `positions` and `rotations` are of bodies, at the indices `a` and `b`.
export class JointPose {
  constructor() {
    this.a = { position: new Vector3(), rotation: new Quaternion() };
    this.b = { position: new Vector3(), rotation: new Quaternion() };
    this.offset = new Vector3(); // of B's anchor, along the axes of frame A
    this.relative = new Quaternion(); // rotation of frame B against frame A
  }

  set(joint, positions, rotations, a, b) {
    this.#place(this.a, joint.frameA, positions, rotations, a);
    this.#place(this.b, joint.frameB, positions, rotations, b);
    turn.copy(this.a.rotation).conjugate();
    this.offset.subVectors(this.b.position, this.a.position).applyQuaternion(turn);
    this.relative.multiplyQuaternions(turn, this.b.rotation);
    return this;
  }

  #place(out, frame, positions, rotations, body) {
    turn.fromArray(rotations, 4 * body).normalize();
    out.position.fromArray(frame.position).applyQuaternion(turn);
    out.position.x += positions[3 * body];
    out.position.y += positions[3 * body + 1];
    out.position.z += positions[3 * body + 2];
    out.rotation.fromArray(frame.rotation).premultiply(turn);
  }
}

// Rotation within q about the axis 0, 1, 2, rad, within half a turn.
export function twistOf(q, axis) {
  const part = [q.x, q.y, q.z][axis];
  return q.w < 0 ? 2 * Math.atan2(-part, -q.w) : 2 * Math.atan2(part, q.w);
}

// As Constraints/Parts/SwingTwist.h: { swing (a quaternion), alpha, y, z, twist }.
export function decompose(q, swing = new Quaternion()) {
  const cosine = Math.hypot(q.x, q.w);
  if (cosine > 1e-12) swing.set(0, (q.w * q.y - q.x * q.z) / cosine, (q.w * q.z + q.x * q.y) / cosine, cosine);
  else swing.set(0, q.y, q.z, 0);
  const sine = Math.hypot(swing.y, swing.z), alpha = 2 * Math.atan2(sine, swing.w), perSine = sine > 1e-12 ? alpha / sine : 0;
  return { swing, alpha, y: swing.y * perSine, z: swing.z * perSine, twist: twistOf(q, 0) };
}

// By whole turns into a range or nearest to its middle.
export function unwrapped(angle, [min, max]) {
  if (!Number.isFinite(min + max)) return angle;
  const turnLength = 2 * Math.PI;
  return angle + turnLength * Math.round((0.5 * (min + max) - angle) / turnLength);
}

// The length of a rope over points as its limits mean it.
export function ropeLength(joint, pose) {
  const away = (place, [x, y, z]) => Math.hypot(place.x - x, place.y - y, place.z - z);
  return away(pose.a.position, joint.points[0]) + joint.ratio * away(pose.b.position, joint.points[1]);
}

export function lengthOf(joint, pose) {
  return joint.isRope && joint.points.length > 0 ? ropeLength(joint, pose) : pose.offset.length();
}

// { distance, angle } in meters and radians, of what the joint locks; of a rod or rope how far it is out of its range.
export function errorOf(joint, pose, limits) {
  let distance = 0, angle = 0;
  const { offset, relative } = pose;
  if (joint.linearLock === 'point') distance = offset.length();
  if (joint.linearLock === 'line') {
    const [u, v] = offset.toArray().filter((_, k) => k !== joint.line);
    distance = Math.hypot(u, v);
  }
  if (joint.isHardLength) {
    const length = lengthOf(joint, pose), [min, max] = limits[0];
    distance = Math.max(0, min - length, length - max);
  }
  if (joint.angularLock === 'all') angle = 2 * Math.atan2(Math.hypot(relative.x, relative.y, relative.z), Math.abs(relative.w));
  if (joint.angularLock === 'axis') {
    // The angle between the two axes that should be one.
    const parts = [relative.x, relative.y, relative.z], along = parts[joint.axis];
    angle = 2 * Math.atan2(Math.hypot(...parts.filter((_, k) => k !== joint.axis)), Math.hypot(along, relative.w));
  }
  return { distance, angle };
}
