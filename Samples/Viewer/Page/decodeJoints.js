// Reads the joints that PageJoints.cpp writes; the format is described in PageJoints.h.

const FLAGS = ['isPyramid', 'isHardLength', 'isClosed', 'rotations', 'translations', 'steering', 'isRope', 'isPath'];
const LINEAR_LOCKS = ['none', 'line', 'point'];
const ANGULAR_LOCKS = ['none', 'axis', 'all'];

function decodeConstants({ count, kinds, step, rotationSteps, ratioStep }, reader) {
  let bodyA = 0, bodyB = 0, ratio = 0;
  const frames = [new Float64Array(7), new Float64Array(7)];
  const joints = [];
  for (let id = 0; id < count; ++id) {
    const kind = kinds[reader.unsigned()], linearLock = LINEAR_LOCKS[reader.unsigned()], angularLock = ANGULAR_LOCKS[reader.unsigned()];
    const line = reader.unsigned(), axis = reader.unsigned(), flags = reader.unsigned();
    const [trackA, trackB] = [0, 1].map(() => reader.unsigned() - 1), [circleA, circleB] = [0, 1].map(() => (reader.unsigned() - 1) * step);
    bodyA += reader.signed();
    bodyB += reader.signed();
    ratio += reader.signed();
    const [frameA, frameB] = frames.map((frame) => {
      for (let k = 0; k < 7; ++k) frame[k] += reader.signed();
      return { position: [...frame.subarray(0, 3)].map((n) => n * step), rotation: [...frame.subarray(3)].map((n) => n / rotationSteps) };
    });
    const points = [], place = [0, 0, 0];
    for (let left = reader.unsigned(); left > 0; --left) points.push(place.map((_, k) => (place[k] += reader.signed()) * step));
    joints.push({
      id, kind, bodyA, bodyB, frameA, frameB, linearLock, angularLock, line, axis, ratio: ratio * ratioStep, points,
      trackA, trackB, circleA, circleB, ...Object.fromEntries(FLAGS.map((name, bit) => [name, (flags & (1 << bit)) > 0])), states: [],
    });
  }
  return joints;
}

// limits: of translations along and rotations about x, y, z; infinite where a side has none.
function decodeStates(joints, frameCount, step, reader) {
  const ends = joints.map(() => ({ steps: new Float64Array(12), present: 0 }));
  for (let frame = 0; frame < frameCount; ++frame) {
    for (let left = reader.unsigned(), id = 0; left > 0; --left, ++id) {
      id += reader.unsigned();
      const flags = reader.unsigned(), last = ends[id], states = joints[id].states;
      let limits = states[states.length - 1]?.limits;
      if (flags & 2) {
        last.present = reader.unsigned();
        for (let i = 0; i < 12; ++i) if (last.present & (1 << i)) last.steps[i] += reader.signed();
      }
      if (flags & 2 || !limits) {
        const end = (i, none) => (last.present & (1 << i) ? last.steps[i] * step : none);
        limits = [0, 1, 2, 3, 4, 5].map((k) => [end(2 * k, -Infinity), end(2 * k + 1, Infinity)]);
      }
      states.push({ frame, enabled: (flags & 1) > 0, limits });
    }
  }
}

// `readers`: of the three columns. Errors are in meters and radians, one a frame.
export function decodeJoints(header, [constants, states, errors]) {
  const { count, step, errorStep } = header.joints;
  if (count === 0) return { joints: [], jointErrors: [] };
  const joints = decodeConstants(header.joints, constants);
  decodeStates(joints, header.times.length, step, states);
  const jointErrors = header.times.map(() => ({
    distance: errors.unsigned() * errorStep, distanceJoint: errors.unsigned(),
    angle: errors.unsigned() * errorStep, angleJoint: errors.unsigned(),
  }));
  return { joints, jointErrors };
}
