// Fulcrum for JavaScript. SI units and radians; arrays are [x, y, z], rotations [x, y, z, w]. What is wrong is thrown as a
// FulcrumError that names the field, its value and what would be valid; then nothing has changed.
import type { BodyFields, JointFields, MaterialFields, MotorFields, LimitFields, SpringFields, WorldFields } from '../dist/settings.js';

export type Vector = readonly [number, number, number] | readonly number[];
export type Rotation = readonly [number, number, number, number] | readonly number[];
/** Valid until the body or joint is removed; never again after that. */
export type BodyId = number;
export type JointId = number;
/** As a body of a joint: the world. */
export const WORLD: -1;

export type ShapeDescription =
  | { kind: 'Sphere'; radius: number }
  | { kind: 'Box'; halfExtents: Vector; convexRadius?: number }
  | { kind: 'Capsule'; halfHeight: number; radius: number }
  | { kind: 'TaperedCapsule'; halfHeight: number; topRadius: number; bottomRadius: number }
  | { kind: 'Cylinder'; halfHeight: number; radius: number; convexRadius?: number }
  | { kind: 'Cylinder'; halfHeight: number; topRadius: number; bottomRadius: number; convexRadius?: number }
  | { kind: 'ConvexHull'; points: readonly Vector[]; maxVertices?: number; convexRadius?: number }
  | { kind: 'Plane'; normal?: Vector; offset?: number }
  | { kind: 'TriangleMesh'; vertices: readonly Vector[]; indices: readonly number[]; isTwoSided?: boolean; activeEdgeCosine?: number }
  | {
      kind: 'HeightField'; sampleCountX: number; sampleCountZ: number; heights: readonly number[];
      cellSizeX?: number; cellSizeZ?: number; origin?: Vector; isTwoSided?: boolean;
    }
  | { kind: 'Compound' | 'MutableCompound'; children: readonly { shape: ShapeLike; position?: Vector; rotation?: Rotation; density?: number }[] }
  | { kind: 'Empty' }
  | { kind: 'Baked'; base64: string };
export type ShapeLike = Shape | ShapeDescription;

/** A shape that several bodies may have. */
export interface Shape {
  readonly number: number;
  /** Bodies of it keep what they need. */
  destroy(): void;
}

/** Those of the engine's SystemSettings (Physics/Settings.h), by the same names. */
export type WorldSettings = WorldFields;
export type BodySettings = Omit<BodyFields, 'shape' | 'name'> & { shape: ShapeLike };
/** Of every kind of joint (Physics/Joints). The world is where a body is left out. */
export type JointSettings = JointFields & { bodyA?: BodyId; bodyB?: BodyId };
export type Material = MaterialFields;
export type JointMotor = MotorFields;
export type JointLimits = LimitFields;
export type Spring = SpringFields;
export type MotionType = 'Static' | 'Kinematic' | 'Dynamic';
export type JointAxis = 'LinearX' | 'LinearY' | 'LinearZ' | 'AngularX' | 'AngularY' | 'AngularZ';

export class FulcrumError extends Error {}

export interface LoadOptions {
  /** Address of the folder dist/ of this package. In node it is found by itself. */
  base?: string | URL;
  /** The most that a world may have, 1 by default. More than one where the page is cross-origin isolated; else one, with the same results. */
  threads?: number;
}
export function load(options?: LoadOptions): Promise<Fulcrum>;
/** Whether worlds can have more than one thread here. */
export function canUseThreads(): boolean;
/** For programs that have the module's parts themselves: what the .cjs exports, the bytes of the .wasm; for threads also the addresses of the other parts. */
export function instantiate(parts: {
  factory: (options: object) => Promise<unknown>; wasm: BufferSource; threads?: number; worker?: string | URL; script?: string | Blob;
}): Promise<Fulcrum>;

export interface SceneInfo {
  name: string;
  description: string;
  kind: 'Performance' | 'Sample';
  /** Of 1/60 s, that a run takes. */
  steps: number;
}

export class Fulcrum {
  readonly version: string;
  readonly simd: string;
  readonly lanes: number;
  readonly threads: number;
  createWorld(settings?: WorldSettings, options?: { threads?: number }): World;
  createShape(description: ShapeDescription): Shape;
  /** The engine's sample and performance scenes. */
  readonly scenes: SceneInfo[];
  createScene(name: string, options?: {
    seed?: number; solver?: WorldSettings['solver']; gravityScale?: number; measuresErrors?: boolean; threads?: number;
  }): World;
  /** Ends the threads, which keep node running. After that nothing of this may be used. */
  close(): void;
}

/** Functions may be called by the thread that loaded the module alone. */
export class World {
  readonly bodies: Bodies;
  readonly joints: Joints;
  readonly queries: Queries;
  /** Advances by dt seconds, 0 .. 1; 1/60 by default. */
  step(dt?: number): void;
  readonly settings: WorldSettings;
  /** What is left out stays as it is. */
  set(settings: WorldSettings): void;
  /** Sizes, times and errors of the last step. */
  readonly report: StepReport;
  /** 64 bits of all poses: the same on every machine, for any number of threads. */
  hashPoses(): bigint;
  /** Of the whole state that later steps depend on. */
  hashState(): bigint;
  /** Kinetic plus gravitational potential energy of the dynamic bodies, J. */
  readonly energy: number;
  /** Bytes. */
  readonly memoryUsed: number;
  readonly threads: number;
  /** The whole state, from which steps go on with the same bits. */
  save(): Uint8Array;
  restore(bytes: Uint8Array): void;
  /** Frees its memory. */
  destroy(): void;
}

export interface BodyState {
  position: number[];
  rotation: number[];
  linearVelocity: number[];
  angularVelocity: number[];
  mass: number;
  motion: MotionType;
  isAwake: boolean;
}

/** By index; flags: 1 there, 2 awake, 4 static, 8 kinematic. */
export interface AllBodies {
  count: number;
  positions: Float64Array;
  rotations: Float32Array;
  linearVelocities: Float32Array;
  angularVelocities: Float32Array;
  generations: Uint32Array;
  flags: Uint8Array;
  idAt(index: number): BodyId;
}

export interface Bodies {
  create(settings: BodySettings): BodyId;
  remove(body: BodyId): void;
  exists(body: BodyId): boolean;
  read(body: BodyId): BodyState;
  /** Of all bodies, without a copy: the arrays are valid until the next call of anything. */
  readAll(): AllBodies;
  /** Teleports. */
  setPose(body: BodyId, position: Vector, rotation?: Rotation): void;
  /** Gives a kinematic body the velocity with which it is there after dt seconds. */
  moveKinematic(body: BodyId, position: Vector, rotation: Rotation, dt: number): void;
  setVelocity(body: BodyId, linear: Vector, angular?: Vector): void;
  /** N, during the next step; at a point of the world, else at the center of mass. */
  addForce(body: BodyId, force: Vector, point?: Vector): void;
  addTorque(body: BodyId, torque: Vector): void;
  /** N s, at once. */
  addImpulse(body: BodyId, impulse: Vector, point?: Vector): void;
  addAngularImpulse(body: BodyId, impulse: Vector): void;
  setMotion(body: BodyId, motion: MotionType): void;
  setMass(body: BodyId, mass: number): void;
  setGravityFactor(body: BodyId, factor: number): void;
  setDamping(body: BodyId, linear: number, angular: number): void;
  setMaterial(body: BodyId, material: Material): void;
  setShape(body: BodyId, shape: Shape): void;
  wake(body: BodyId): void;
  sleep(body: BodyId): void;
}

export interface JointState {
  /** N and N m on body B, mean of the last step. */
  force: number[];
  torque: number[];
  /** m and rad along what it locks. */
  distance: number;
  angle: number;
  anchorA: number[];
  anchorB: number[];
}

export interface Joints {
  create(settings: JointSettings): JointId;
  /** A spring from a place of the world to a point of a body, as a mouse drags it. */
  createTarget(settings: { body: BodyId; anchor: Vector; target: Vector; spring?: Spring; maxForce?: number }): JointId;
  setTarget(joint: JointId, target: Vector): void;
  remove(joint: JointId): void;
  exists(joint: JointId): boolean;
  setEnabled(joint: JointId, enabled: boolean): void;
  /** False also once it broke. */
  isEnabled(joint: JointId): boolean;
  setMotor(joint: JointId, axis: JointAxis, motor: JointMotor): void;
  setLimits(joint: JointId, axis: JointAxis, limits: JointLimits | null): void;
  /** m or rad. */
  coordinate(joint: JointId, axis: JointAxis): number;
  read(joint: JointId): JointState;
}

export interface Filter {
  /** Bit i: bodies of layer i. */
  layers?: number;
  sensors?: boolean;
  ignore?: readonly BodyId[];
}
export interface Hit {
  body: BodyId;
  child: number;
  /** Of the displacement. */
  fraction: number;
  normal: number[];
  position: number[];
}

export interface Queries {
  castRay(query: { origin: Vector; displacement: Vector } & Filter): (Hit & { isBackFace: boolean }) | undefined;
  /** Sorted by fraction. */
  castRayAll(query: { origin: Vector; displacement: Vector } & Filter): (Hit & { isBackFace: boolean })[];
  castShape(query: {
    shape: ShapeLike; position?: Vector; rotation?: Rotation; displacement: Vector; turn?: Vector;
  } & Filter): (Hit & { depth: number }) | undefined;
  findOverlaps(query: { shape: ShapeLike; position?: Vector; rotation?: Rotation } & Filter): { body: BodyId; child: number }[];
  findClosest(query: { position: Vector; maxDistance?: number } & Filter):
    { body: BodyId; distance: number; normal: number[]; position: number[] } | undefined;
}

export interface StepErrors {
  areMeasured: boolean;
  energyChange: number;
  energyGain: number;
  mostGaining?: BodyId;
  momentumError: number;
  angularMomentumError: number;
  pushEnergy: number;
  largestPushEnergy: number;
  mostPushed?: BodyId;
}

/** As the engine's StepReport (Physics/StepReport.h). */
export interface StepReport {
  step: number;
  totalMs: number;
  stageMs: Record<string, number>;
  bodies: number;
  awakeBodies: number;
  pairs: number;
  contacts: number;
  contactPoints: number;
  joints: number;
  islands: number;
  islandsWithMoreEffort: number;
  mostEffort: { substeps: number; velocityIterations: number; positionIterations: number; culprit?: BodyId; bodies: number; isDirect: boolean }[];
  largestPenetration: number;
  deepestA?: BodyId;
  deepestB?: BodyId;
  /** m and rad: the largest errors of what joints hold: locks, lengths, limits, ratios, hard motors. */
  largestJointError: number;
  largestJointAngle: number;
  frozenBodies: number;
  sweptBodies: number;
  errors: StepErrors;
}
