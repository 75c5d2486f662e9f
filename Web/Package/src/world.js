// A world: its bodies, joints and queries.
import { FulcrumError } from './module.js';

// Ids are numbers: the index, and the generation above it, so that an id of a removed body is never valid again.
const INDICES = 2 ** 32;
const idOf = (index, generation) => generation * INDICES + index;
const split = (id) => [id % INDICES, Math.floor(id / INDICES)];
const isNone = ([index]) => index === 0xffffffff;
export const WORLD = -1; // as a body of a joint
const NONE = [0xffffffff, 0xffffffff];
const partsOf = (body) => (body === WORLD ? NONE : split(body));

// Bytes, see Bindings/Show.cpp.
export const SHOWN_STATE = 56, SHOWN_JOINT = 56, SHOWN_LINE = 28, SHOWN_POINT = 16;

const MOTIONS = ['Static', 'Kinematic', 'Dynamic'];
const AXES = ['LinearX', 'LinearY', 'LinearZ', 'AngularX', 'AngularY', 'AngularZ'];
function axisOf(name) {
  const axis = AXES.indexOf(name);
  if (axis < 0) throw new FulcrumError(`axis is "${name}"; it must be one of ${AXES.join(', ')}`);
  return axis;
}
const withId = (hit) => hit && { ...hit, body: idOf(...hit.body) };
const bodyOf = (pair) => (isNone(pair) ? undefined : idOf(...pair));

export class World {
  #module;
  #address;
  constructor(module, address) {
    this.#module = module;
    this.#address = address;
    const access = (method, name, ...values) => module[method](name, this.address, ...values);
    this.bodies = new Bodies(module, access);
    this.joints = new Joints(module, access);
    this.queries = new Queries(module, access);
  }

  // For what is built upon this: throws once the world is destroyed.
  get address() {
    if (!this.#address) throw new FulcrumError('this world was destroyed');
    return this.#address;
  }
  destroy() {
    this.#module.call('destroyWorld', this.address);
    this.#address = 0;
  }

  step(dt = 1 / 60) { this.#module.must('step', this.address, dt); }

  get settings() {
    this.#module.must('getSettings', this.address);
    return this.#module.json();
  }
  // What is left out stays as it is.
  set(settings) {
    this.#module.putJson(settings);
    this.#module.must('setSettings', this.address);
  }

  get report() {
    this.#module.must('report', this.address);
    const report = this.#module.json();
    for (const name of ['deepestA', 'deepestB']) report[name] = bodyOf(report[name]);
    for (const name of ['mostGaining', 'mostPushed']) report.errors[name] = bodyOf(report.errors[name]);
    for (const effort of report.mostEffort) effort.culprit = bodyOf(effort.culprit);
    return report;
  }

  hashPoses() { return this.#module.hash('hashPoses', this.address); }
  hashState() { return this.#module.hash('hashState', this.address); }
  get energy() { return this.#module.call('energy', this.address); }
  get memoryUsed() { return this.#module.call('memoryUsed', this.address); }
  get threads() { return this.#module.call('threads', this.address); }

  save() {
    this.#module.must('save', this.address);
    return this.#module.answerBytes();
  }
  restore(bytes) {
    this.#module.put(bytes);
    this.#module.must('restore', this.address);
  }

  // For the page that draws the world of a scene: its bytes as those of a page of a recording, whose first frame is the world now.
  show() {
    this.#module.must('show', this.address);
    return this.#module.answerBytes();
  }
  // After each step: the states of what `show` returned, in place, and whether bodies, shapes or joints came that it did not have.
  // Of joints those that changed; of lines and points all that the scene draws.
  readShown() {
    const count = this.#module.call('readShown', this.address);
    const [address, isChanged, x, y, z, ...lists] = this.#module.numbers(11);
    const view = (at, size) => this.#module.view(DataView, at, size);
    return {
      count, states: view(address, SHOWN_STATE * count), isChanged: isChanged === 1, origin: [x, y, z],
      joints: view(lists[0], SHOWN_JOINT * lists[1]), lines: view(lists[2], SHOWN_LINE * lists[3]), points: view(lists[4], SHOWN_POINT * lists[5]),
    };
  }
  shownBody(index) {
    this.#module.call('shownBody', this.address, index);
    return idOf(...this.#module.numbers(2));
  }
}

class Bodies {
  #module;
  #access;
  #changes = new Map();
  constructor(module, access) {
    this.#module = module;
    this.#access = access;
  }

  create(settings) {
    this.#module.putJson(settings);
    this.#access('must', 'createBody');
    return idOf(...this.#module.numbers(2));
  }
  remove(id) { this.#access('must', 'removeBody', ...split(id)); }
  exists(id) { return this.#access('call', 'bodyExists', ...split(id)) === 1; }

  read(id) {
    this.#access('must', 'readBody', ...split(id));
    const n = Array.from(this.#module.numbers(16));
    return {
      position: n.slice(0, 3), rotation: n.slice(3, 7), linearVelocity: n.slice(7, 10), angularVelocity: n.slice(10, 13),
      mass: n[13], motion: MOTIONS[n[14]], isAwake: n[15] === 1,
    };
  }
  // Of all bodies at once, without a copy: valid until the next call of anything.
  readAll() {
    const count = this.#access('call', 'readBodies');
    const [positions, rotations, linear, angular, generations, flags] = this.#module.numbers(6);
    const view = (Type, address, length) => this.#module.view(Type, address, length);
    return {
      count,
      positions: view(Float64Array, positions, 3 * count),
      rotations: view(Float32Array, rotations, 4 * count),
      linearVelocities: view(Float32Array, linear, 3 * count),
      angularVelocities: view(Float32Array, angular, 3 * count),
      generations: view(Uint32Array, generations, count),
      flags: view(Uint8Array, flags, count),
      idAt: (index) => idOf(index, this.#module.view(Uint32Array, generations, count)[index]),
    };
  }

  setPose(id, position, rotation = [0, 0, 0, 1]) { this.#change('setPose', id, ...position, ...rotation); }
  moveKinematic(id, position, rotation, dt) { this.#change('moveKinematic', id, ...position, ...rotation, dt); }
  setVelocity(id, linear, angular = [0, 0, 0]) { this.#change('setVelocity', id, ...linear, ...angular); }
  addForce(id, force, point) {
    if (point) this.#change('addForceAt', id, ...force, ...point);
    else this.#change('addForce', id, ...force);
  }
  addTorque(id, torque) { this.#change('addTorque', id, ...torque); }
  addImpulse(id, impulse, point) {
    if (point) this.#change('addImpulseAt', id, ...impulse, ...point);
    else this.#change('addImpulse', id, ...impulse);
  }
  addAngularImpulse(id, impulse) { this.#change('addAngularImpulse', id, ...impulse); }
  setMotion(id, motion) { this.#change('setMotionType', id, MOTIONS.indexOf(motion)); }
  setMass(id, mass) { this.#change('setMass', id, mass); }
  setGravityFactor(id, factor) { this.#change('setGravityFactor', id, factor); }
  setDamping(id, linear, angular) { this.#change('setDamping', id, linear, angular); }
  wake(id) { this.#change('wake', id); }
  sleep(id) { this.#change('sleep', id); }
  setShape(id, shape) { this.#access('must', 'setShape', ...split(id), shape.number); }
  setMaterial(id, material) {
    this.#module.putJson(material);
    this.#access('must', 'setMaterial', ...split(id));
  }

  #change(name, id, ...numbers) {
    if (!this.#changes.has(name)) {
      this.#module.putText(name);
      this.#changes.set(name, this.#module.call('findBodyChange'));
    }
    this.#module.putNumbers(...numbers);
    this.#access('must', 'changeBody', ...split(id), this.#changes.get(name));
  }
}

class Joints {
  #module;
  #access;
  constructor(module, access) {
    this.#module = module;
    this.#access = access;
  }

  create({ bodyA = WORLD, bodyB = WORLD, ...settings }) {
    this.#module.putJson(settings);
    this.#access('must', 'createJoint', ...partsOf(bodyA), ...partsOf(bodyB));
    return idOf(...this.#module.numbers(2));
  }
  // A spring from a place of the world to a point of a body.
  createTarget({ body, ...settings }) {
    this.#module.putJson(settings);
    this.#access('must', 'createTarget', ...split(body));
    return idOf(...this.#module.numbers(2));
  }
  setTarget(id, position) { this.#access('must', 'setTarget', ...split(id), ...position); }
  remove(id) { this.#access('must', 'removeJoint', ...split(id)); }
  exists(id) { return this.#access('call', 'jointExists', ...split(id)) === 1; }
  setEnabled(id, enabled) { this.#access('must', 'setJointEnabled', ...split(id), enabled ? 1 : 0); }
  isEnabled(id) { return this.#access('call', 'isJointEnabled', ...split(id)) === 1; }
  setMotor(id, axis, motor) {
    this.#module.putJson(motor);
    this.#access('must', 'setMotor', ...split(id), axisOf(axis));
  }
  setLimits(id, axis, limits) {
    this.#module.putJson(limits);
    this.#access('must', 'setLimits', ...split(id), axisOf(axis));
  }
  coordinate(id, axis) { return this.#access('call', 'jointCoordinate', ...split(id), axisOf(axis)); }
  read(id) {
    this.#access('must', 'readJoint', ...split(id));
    const n = Array.from(this.#module.numbers(14));
    return { force: n.slice(0, 3), torque: n.slice(3, 6), distance: n[6], angle: n[7], anchorA: n.slice(8, 11), anchorB: n.slice(11, 14) };
  }
}

class Queries {
  #module;
  #access;
  constructor(module, access) {
    this.#module = module;
    this.#access = access;
  }

  castRay(query) { return withId(this.#ask('castRay', query)) ?? undefined; }
  castRayAll(query) { return this.#ask('castRayAll', query).map(withId); }
  castShape(query) { return withId(this.#ask('castShape', query)) ?? undefined; }
  findOverlaps(query) { return this.#ask('findOverlaps', query).map(withId); }
  findClosest(query) { return withId(this.#ask('findClosest', query)) ?? undefined; }

  #ask(name, { ignore = [], ...query }) {
    this.#module.putJson({ ...query, ignore: ignore.map(split) });
    this.#access('must', name);
    return this.#module.json();
  }
}
