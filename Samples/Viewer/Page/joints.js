// What is drawn of joints: both frames, limits, where the joint is between them, and how far it is out of place.
import { Color, Matrix4, Quaternion, Vector3 } from 'three';
import { JointPose, decompose, errorOf, lengthOf, stateAt, twistOf, unwrapped } from './jointPose.js';
import { limitShape } from './jointShapes.js';
import { outerRadius } from './shapes.js';
import { Dots, Lines, Surfaces } from './strokes.js';

const FRAME_A = ['#c1121f', '#1b7f2a', '#1d4fc4'].map((hex) => new Color(hex));
const FRAME_B = ['#ff9d9d', '#9be8a4', '#a3c4ff'].map((hex) => new Color(hex));
const LIMIT = new Color('#7b2cbf');
const NEEDLE = new Color('#161a22');
const AT_LIMIT = new Color('#f05a00');
const SLACK = new Color('#7d8894');
const ERRORS = ['#2a9d4a', '#f0c419', '#d00000'].map((hex) => new Color(hex));
const LEAST_ERROR = 3e-4, LARGEST_ERROR = 3e-2; // m or rad, the ends of the colors' scale

// Of more joints than these only the dots and gaps are drawn, or those and the frames; of the selected body's all.
export const MOST_WITH_LIMITS = 200, MOST_WITH_FRAMES = 3000;

const CROSS = [0, 1, 2].map((axis) => [0, 0, 0, ...[0, 1, 2].map((k) => (k === axis ? 1 : 0))]);
const ONE = new Vector3(1, 1, 1);
const X = new Vector3(1, 0, 0);

export function errorColor({ distance, angle }, out) {
  const error = Math.max(distance, angle, 1e-9);
  const at = 2 * Math.min(1, Math.max(0, Math.log(error / LEAST_ERROR) / Math.log(LARGEST_ERROR / LEAST_ERROR)));
  return at < 1 ? out.lerpColors(ERRORS[0], ERRORS[1], at) : out.lerpColors(ERRORS[1], ERRORS[2], at - 1);
}

// How large each joint is drawn, meters: as the smaller of its moving bodies, less where joints of a body are close together.
function sizesOf(recording, timeline, subject) {
  const { bodies, shapes, joints } = recording;
  const radii = shapes.map((_, index) => outerRadius(shapes, index));
  const pose = new JointPose(), places = [], ofBody = new Map();
  const sizes = joints.map((joint) => {
    const ends = [joint.bodyA, joint.bodyB];
    const moving = ends.filter((body) => bodies.motions[body] === 2);
    for (const body of ends) ofBody.set(body, [...(ofBody.get(body) ?? []), joint.id]);
    places.push(pose.set(joint, timeline.positions, timeline.rotations, ...ends).b.position.clone());
    return 0.9 * Math.min(...(moving.length > 0 ? moving : ends).map((body) => radii[bodies.shapes[body]]));
  });
  for (const list of ofBody.values()) {
    if (list.length > 50) continue; // the ground's
    for (const a of list) {
      for (const b of list) {
        const apart = places[a].distanceTo(places[b]);
        if (apart > 1e-3) sizes[a] = Math.min(sizes[a], 0.7 * apart);
      }
    }
  }
  // A few joints are to be seen from afar; many would cover each other.
  const least = (joints.length <= MOST_WITH_LIMITS ? 0.02 : 0.002) * subject.radius;
  return sizes.map((size) => Math.min(0.13 * subject.radius, Math.max(least, size)));
}

export class Joints {
  constructor(recording, timeline, stage) {
    this.recording = recording;
    this.timeline = timeline;
    this.sizes = sizesOf(recording, timeline, stage.subject);
    this.shapes = []; // by joint: { limits, shape }
    this.pose = new JointPose();
    this.surfaces = new Surfaces(stage, 4);
    this.fine = new Lines(stage, 6, 1.6);
    this.bold = new Lines(stage, 8, 3, 1);
    const { length } = recording.joints;
    this.dots = new Dots(stage, 10, length <= MOST_WITH_LIMITS ? 7 : length <= MOST_WITH_FRAMES ? 5 : 3);
    this.parts = [this.surfaces, this.fine, this.bold, this.dots];
  }

  get visible() { return this.dots.visible; }
  set visible(isVisible) { for (const part of this.parts) part.visible = isVisible; }

  // `selected`: a body, whose joints are always drawn in full; -1: none.
  update(selected) {
    if (!this.visible || this.recording.joints.length === 0) return;
    const { joints } = this.recording;
    for (const part of this.parts) part.begin();
    for (const joint of joints) {
      const state = stateAt(joint, Math.floor(this.timeline.frame));
      if (!state?.enabled) continue;
      const isChosen = joint.bodyA === selected || joint.bodyB === selected;
      const { positions, rotations } = this.timeline;
      const pose = this.pose.set(joint, positions, rotations, joint.bodyA, joint.bodyB);
      if (isChosen || joints.length <= MOST_WITH_FRAMES) this.#drawFrames(joint, pose);
      if (isChosen || joints.length <= MOST_WITH_LIMITS) {
        this.#drawLimits(joint, state.limits, pose);
        this.#drawNeedles(joint, state.limits, pose);
      }
      this.#drawConnection(joint, state.limits, pose);
    }
    for (const part of this.parts) part.end();
  }

  // How far a joint is out of place at the frame, not between frames, where straight lines are not what bodies do.
  error(joint, limits) {
    const { samples } = this.recording, { sample } = this.timeline;
    this.exact ??= new JointPose();
    const { positions, rotations } = samples;
    return errorOf(joint, this.exact.set(joint, positions, rotations, sample[joint.bodyA], sample[joint.bodyB]), limits);
  }

  #drawFrames(joint, { a, b }) {
    const length = new Vector3().setScalar(0.55 * this.sizes[joint.id]);
    const matrix = this.matrix ??= new Matrix4();
    matrix.compose(a.position, a.rotation, length);
    CROSS.forEach((line, axis) => this.bold.add(line, matrix.elements, FRAME_A[axis]));
    matrix.compose(b.position, b.rotation, length);
    CROSS.forEach((line, axis) => this.fine.add(line, matrix.elements, FRAME_B[axis]));
  }

  #drawLimits(joint, limits, pose) {
    const known = (this.shapes[joint.id] ??= {});
    if (known.limits !== limits) {
      known.limits = limits;
      known.shape = limitShape(joint, limits, this.sizes[joint.id]);
    }
    const matrix = new Matrix4();
    for (const [frame, part] of Object.entries(known.shape)) {
      const { position, rotation } = this.#frame(frame, pose);
      matrix.compose(position, rotation, ONE);
      this.fine.add(part.lines, matrix.elements, LIMIT);
      this.surfaces.add(part.surface, matrix.elements, LIMIT);
    }
  }

  #frame(name, { a, b, relative }) {
    if (name === 'A') return a;
    if (name === 'B') return b;
    const rotation = new Quaternion();
    if (name === 'turn') return { position: b.position, rotation: a.rotation };
    if (name === 'swing') return { position: b.position, rotation: rotation.multiplyQuaternions(a.rotation, decompose(relative).swing) };
    const towards = new Vector3().subVectors(b.position, a.position);
    if (towards.lengthSq() > 1e-12) rotation.setFromUnitVectors(X, towards.normalize());
    return { position: a.position, rotation };
  }

  // Where the joint is between its limits.
  #drawNeedles(joint, limits, pose) {
    const size = this.sizes[joint.id], { a, b, relative, offset } = pose;
    const axisOf = (frame, axis) => new Vector3().setComponent(axis, 1).applyQuaternion(frame.rotation);
    const needle = (frame, axis, length, isAtLimit, from = frame.position) =>
      this.bold.line(from, new Vector3().copy(from).addScaledVector(axisOf(frame, axis), length), isAtLimit ? AT_LIMIT : NEEDLE);
    const isAt = (value, [min, max], tolerance) => max > min && (value < min + tolerance || value > max - tolerance);
    const isAtAngle = (angle, range) => isAt(unwrapped(angle, range), range, 0.01);
    const mark = (frame, axis, isAtLimit) => {
      for (const other of [(axis + 1) % 3, (axis + 2) % 3])
        for (const side of [-1, 1]) needle(frame, other, 0.22 * side * size, isAtLimit, b.position);
    };
    const turning = () => {
      if (joint.angularLock === 'all') return;
      if (joint.angularLock === 'axis') {
        const isAtLimit = isAtAngle(twistOf(relative, joint.axis), limits[3 + joint.axis]);
        needle(b, (joint.axis + 1) % 3, size, isAtLimit);
        return;
      }
      const { y, z, twist, swing } = decompose(relative);
      const [rangeTwist, rangeY, rangeZ] = limits.slice(3);
      const ofEllipse = Math.hypot(y / rangeY[1], z / rangeZ[1]);
      const isAtSwing = joint.isPyramid
        ? isAt(2 * Math.atan2(swing.y, swing.w), rangeY, 0.01) || isAt(2 * Math.atan2(swing.z, swing.w), rangeZ, 0.01)
        : ofEllipse > 0.985;
      if (rangeY[1] > rangeY[0] || rangeZ[1] > rangeZ[0]) needle(b, 0, size, isAtSwing);
      if (rangeTwist[1] - rangeTwist[0] < 6.28 && rangeTwist[1] > rangeTwist[0]) {
        const tip = new Vector3().copy(b.position).addScaledVector(axisOf(b, 0), 0.8 * size);
        needle(b, 1, 0.45 * size, isAtAngle(twist, rangeTwist), tip);
      }
    };
    const isAtLength = (axis) => isAt(offset.getComponent(axis), limits[axis], 2e-3);
    if (joint.rotations) turning();
    if (joint.translations && joint.linearLock !== 'point' && limits.slice(0, 3).some(([min, max]) => max > min))
      mark(a, joint.line, [0, 1, 2].some(isAtLength));
    if (joint.trackA >= 0) mark(a, joint.trackA, isAtLength(joint.trackA));
    if (joint.circleA >= 0) needle(a, 1, joint.circleA || size, false);
    if (joint.circleB >= 0) needle(b, 1, joint.circleB || size, false);
    if (joint.isPath) mark(b, 0, false);
  }

  // The dot at B's anchor and the line from A's, in the color of the error; ropes and rods as they are.
  #drawConnection(joint, limits, pose) {
    const { a, b } = pose, color = errorColor(this.error(joint, limits), new Color());
    if (joint.isRope) {
      const isTaut = !joint.isHardLength || lengthOf(joint, pose) > limits[0][1] * 0.999;
      const rope = isTaut ? color : SLACK;
      const knots = joint.points.map((point) => new Vector3().fromArray(point));
      const places = [a.position, ...knots, b.position];
      for (let i = 0; i + 1 < places.length; ++i) (knots.length > 0 && i === 1 ? this.fine : this.bold).line(places[i], places[i + 1], rope);
    } else if (joint.linearLock !== 'none') {
      // Along a line that is free there is no error: from the point of it that is nearest to B's anchor.
      const foot = new Vector3();
      if (joint.linearLock === 'line') foot.setComponent(joint.line, pose.offset.getComponent(joint.line));
      foot.applyQuaternion(a.rotation).add(a.position);
      // A shorter one is behind the dot.
      if (foot.distanceTo(b.position) > 0.01 * this.sizes[joint.id]) this.bold.line(foot, b.position, color);
    } else if (!joint.isPath) {
      this.fine.line(a.position, b.position, SLACK);
    }
    this.dots.dot(b.position, color);
  }
}

// What is known of the joints at a frame: their number, how many of them hold, and the frame's largest errors.
export function jointSummary(recording, frame) {
  const whole = Math.floor(frame);
  const enabled = recording.joints.reduce((sum, joint) => sum + (stateAt(joint, whole)?.enabled ? 1 : 0), 0);
  return { count: recording.joints.length, enabled, ...recording.jointErrors[whole] };
}

const byHex = (color) => `#${color.getHexString()}`;

export function jointLegend() {
  return `<div>joint error, mm or mrad</div><div class="scale" style="background:linear-gradient(90deg,${ERRORS.map(byHex).join(',')})"></div>` +
    `<div class="ends"><span>${1000 * LEAST_ERROR}</span><span>${1000 * LARGEST_ERROR}</span></div>`;
}
