// The states of all bodies of a running world, in the place of a recording's timeline: what the viewer's parts ask of one.
import { decode } from '../../Samples/Viewer/Page/decode.js';
import { SHOWN_JOINT, SHOWN_LINE, SHOWN_POINT, SHOWN_STATE } from '../Package/src/world.js';

const LIMITS = 8;  // where they begin in the state of a joint

const floatsAt = (view, at, count) => Array.from({ length: count }, (_, i) => view.getFloat32(at + 4 * i, true));

// Lines or points, as the viewer's Drawings take them: `size` bytes each, the last four of which are the color.
function readDrawn(view, size) {
  const count = view.byteLength / size, places = size / 4 - 1;
  const drawn = { count, places: new Float32Array(places * count), colors: new Uint32Array(count) };
  for (let i = 0; i < count; ++i) {
    drawn.places.set(floatsAt(view, size * i, places), places * i);
    drawn.colors[i] = view.getUint32(size * (i + 1) - 4, true);
  }
  return drawn;
}

export class Live {
  constructor(world) {
    this.world = world;
    const recording = (this.recording = decode(world.show()));
    const count = recording.bodyCount;
    this.frame = this.lastFrame = this.time = 0;
    this.top = 1;
    this.positions = new Float32Array(3 * count);
    this.rotations = new Float32Array(4 * count);
    this.velocities = new Float32Array(3 * count);
    this.awake = new Uint8Array(count);
    this.islands = new Int32Array(count).fill(-1);
    recording.movers = [...recording.bodies.motions.keys()].filter((body) => recording.bodies.motions[body] !== 0);
    this.origin = [0, 0, 0];
    for (let body = 0; body < count; ++body) {
      for (let k = 0; k < 3; ++k) this.positions[3 * body + k] = recording.samples.positions[3 * body + k];
      for (let k = 0; k < 4; ++k) this.rotations[4 * body + k] = recording.samples.rotations[4 * body + k];
    }
    // What a recording says of its last frame is here what is so now.
    this.sample = Int32Array.from({ length: count }, (_, body) => body);
    Object.assign(recording.samples, { positions: this.positions, rotations: this.rotations });
  }

  // True if bodies, shapes or joints came that are not drawn yet: then a new Live is needed.
  update() {
    const { count, states, isChanged, origin, joints, lines, points } = this.world.readShown();
    this.origin = origin;
    let fastest = 0;
    for (let body = 0, at = 0; body < Math.min(count, this.recording.bodyCount); ++body, at += SHOWN_STATE) {
      for (let k = 0; k < 3; ++k) {
        this.positions[3 * body + k] = states.getFloat32(at + 4 + 4 * k, true);
        this.velocities[3 * body + k] = states.getFloat32(at + 32 + 4 * k, true);
      }
      for (let k = 0; k < 4; ++k) this.rotations[4 * body + k] = states.getFloat32(at + 16 + 4 * k, true);
      this.awake[body] = states.getUint8(at + 44);
      this.islands[body] = states.getInt32(at + 48, true);
      if (states.getUint8(at + 52) === 0) for (const presence of this.recording.presences[body]) presence.until = 0;
      if (this.recording.bodies.motions[body] === 2) fastest = Math.max(fastest, this.speed(body));
    }
    // The scale of speeds follows slowly.
    this.top = Math.max(1, fastest, 0.99 * this.top);
    this.#readJoints(joints);
    this.recording.drawings = [{ lines: readDrawn(lines, SHOWN_LINE), points: readDrawn(points, SHOWN_POINT) }];
    return isChanged;
  }

  // Of joints that came since, nothing is drawn yet.
  #readJoints(states) {
    for (let at = 0; at < states.byteLength; at += SHOWN_JOINT) {
      const joint = this.recording.joints[states.getUint32(at, true)];
      if (!joint) continue;
      const ends = floatsAt(states, at + LIMITS, 12);
      joint.states = [{ frame: 0, enabled: states.getUint8(at + 4) === 1, limits: [0, 1, 2, 3, 4, 5].map((axis) => ends.slice(2 * axis, 2 * axis + 2)) }];
    }
  }

  seek() {}
  isThere(body) { return this.presence(body) !== undefined; }
  presence(body) { return this.recording.presences[body].find(({ until }) => until > 0); }
  isAwake(body) { return this.awake[body] === 1; }
  island(body) { return this.islands[body]; }
  velocity(body) { return this.velocities.subarray(3 * body, 3 * body + 3); }
  speed(body) {
    const { velocities } = this, at = 3 * body;
    return Math.sqrt(velocities[at] ** 2 + velocities[at + 1] ** 2 + velocities[at + 2] ** 2);
  }
}
