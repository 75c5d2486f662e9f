// Each engine: a function that loads it and gives { name, build(scene) }; build gives { step(), position(body), rotation(body) }.
// All settings but those of the scene are the engine's own; one thread.
import { load } from '../Package/src/node.js';

const DT = 1 / 60, DENSITY = 1000, FRICTION = 0.5;
// What a description of a shape becomes, made once however many bodies have it.
function once(make) {
  const made = new Map();
  return (shape) => made.get(shape) ?? made.set(shape, make(shape)).get(shape);
}

async function fulcrum() {
  const engine = await load();
  return {
    name: `Fulcrum ${engine.version}`,
    build({ bodies, joints = [], collides = true }) {
      const world = engine.createWorld({ sleep: { enabled: false } });
      const shapeOf = once(({ box, sphere, hull }) => engine.createShape(
        box ? { kind: 'Box', halfExtents: box } : sphere ? { kind: 'Sphere', radius: sphere } : { kind: 'ConvexHull', points: hull }));
      const ids = bodies.map(([shape, position, isStatic]) => world.bodies.create({
        shape: shapeOf(shape), position, motion: isStatic ? 'Static' : 'Dynamic', ...(collides ? {} : { mask: 0 }),
      }));
      for (const [a, b, point] of joints) world.joints.create({ kind: 'Point', bodyA: ids[a], bodyB: ids[b], anchorA: { point } });
      return { step: () => world.step(DT), position: (body) => world.bodies.read(ids[body]).position, rotation: (body) => world.bodies.read(ids[body]).rotation };
    },
  };
}

async function rapier() {
  const { default: R } = await import('@dimforge/rapier3d-simd-compat');
  await R.init();
  return {
    name: `Rapier ${R.version()}, SIMD`,
    build({ bodies, joints = [], collides = true }) {
      const world = new R.World({ x: 0, y: -9.81, z: 0 });
      world.timestep = DT;
      const collider = ({ box, sphere, hull }) => (box ? R.ColliderDesc.cuboid(...box) : sphere ? R.ColliderDesc.ball(sphere) : R.ColliderDesc.convexHull(new Float32Array(hull.flat())));
      const made = bodies.map(([shape, position, isStatic]) => {
        const body = world.createRigidBody((isStatic ? R.RigidBodyDesc.fixed() : R.RigidBodyDesc.dynamic().setCanSleep(false)).setTranslation(...position));
        const description = collider(shape).setDensity(DENSITY).setFriction(FRICTION).setRestitution(0);
        world.createCollider(collides ? description : description.setCollisionGroups(0), body);
        return body;
      });
      const local = (body, point) => Object.fromEntries(['x', 'y', 'z'].map((name, k) => [name, point[k] - bodies[body][1][k]]));
      for (const [a, b, point] of joints) world.createImpulseJoint(R.JointData.spherical(local(a, point), local(b, point)), made[a], made[b], true);
      const list = ({ x, y, z, w }) => (w === undefined ? [x, y, z] : [x, y, z, w]);
      return { step: () => world.step(), position: (body) => list(made[body].translation()), rotation: (body) => list(made[body].rotation()) };
    },
  };
}

async function havok() {
  const { default: create } = await import('@babylonjs/havok');
  const { createRequire } = await import('node:module');
  const { readFileSync } = await import('node:fs');
  const path = createRequire(import.meta.url).resolve('@babylonjs/havok').replace(/lib\/(umd|esm)\/.*$/, 'lib/esm/HavokPhysics.wasm');
  const H = await create({ wasmBinary: readFileSync(path) });
  const must = ([result, value]) => {
    if (result !== H.Result.RESULT_OK) throw new Error(`Havok: result ${JSON.stringify(result)}`);
    return value;
  };
  return {
    name: 'Havok',
    build({ bodies, joints = [], collides = true }) {
      const world = must(H.HP_World_Create());
      H.HP_World_SetGravity(world, [0, -9.81, 0]);
      H.HP_World_SetIdealStepTime(world, DT);
      const shapeOf = once(({ box, sphere, hull }) => {
        let shape;
        if (box) shape = must(H.HP_Shape_CreateBox([0, 0, 0], [0, 0, 0, 1], box.map((half) => 2 * half)));
        else if (sphere) shape = must(H.HP_Shape_CreateSphere([0, 0, 0], sphere));
        else {
          const address = H._malloc(12 * hull.length);
          new Float32Array(H.HEAPU8.buffer, address, 3 * hull.length).set(hull.flat());
          shape = must(H.HP_Shape_CreateConvexHull(address, hull.length));
          H._free(address);
        }
        H.HP_Shape_SetDensity(shape, DENSITY);
        H.HP_Shape_SetMaterial(shape, [FRICTION, FRICTION, 0, H.MaterialCombine.GEOMETRIC_MEAN, H.MaterialCombine.MAXIMUM]);
        if (!collides) H.HP_Shape_SetFilterInfo(shape, [0, 0]);
        return shape;
      });
      const made = bodies.map(([description, position, isStatic]) => {
        const body = must(H.HP_Body_Create()), shape = shapeOf(description);
        H.HP_Body_SetShape(body, shape);
        H.HP_Body_SetMotionType(body, isStatic ? H.MotionType.STATIC : H.MotionType.DYNAMIC);
        if (!isStatic) H.HP_Body_SetMassProperties(body, must(H.HP_Shape_BuildMassProperties(shape)));
        H.HP_Body_SetLinearDamping(body, 0);
        H.HP_Body_SetAngularDamping(body, 0);
        H.HP_Body_SetQTransform(body, [position, [0, 0, 0, 1]]);
        H.HP_World_AddBody(world, body, false);
        if (!isStatic) H.HP_Body_SetActivationControl(body, H.ActivationControl.ALWAYS_ACTIVE);
        return body;
      });
      for (const [a, b, point] of joints) {
        const joint = must(H.HP_Constraint_Create());
        H.HP_Constraint_SetParentBody(joint, made[a]);
        H.HP_Constraint_SetChildBody(joint, made[b]);
        const local = (body) => point.map((value, k) => value - bodies[body][1][k]);
        H.HP_Constraint_SetAnchorInParent(joint, local(a), [1, 0, 0], [0, 1, 0]);
        H.HP_Constraint_SetAnchorInChild(joint, local(b), [1, 0, 0], [0, 1, 0]);
        for (const axis of ['LINEAR_X', 'LINEAR_Y', 'LINEAR_Z']) H.HP_Constraint_SetAxisMode(joint, H.ConstraintAxis[axis], H.ConstraintAxisLimitMode.LOCKED);
        H.HP_Constraint_SetEnabled(joint, 1);
      }
      return {
        step: () => H.HP_World_Step(world, DT),
        position: (body) => must(H.HP_Body_GetPosition(made[body])),
        rotation: (body) => must(H.HP_Body_GetOrientation(made[body])),
      };
    },
  };
}

async function jolt() {
  const { default: create } = await import('jolt-physics');
  const J = await create();
  return {
    name: 'Jolt 1.1.0',
    build({ bodies, joints = [], collides = true }) {
      const settings = new J.JoltSettings();
      settings.mMaxBodies = bodies.length + 10;
      settings.mMaxBodyPairs = 65536;
      settings.mMaxContactConstraints = collides ? 20480 : 1024; // more does not fit into its memory for a step
      settings.mMaxWorkerThreads = 0;
      const pairs = new J.ObjectLayerPairFilterTable(2), layers = new J.BroadPhaseLayerInterfaceTable(2, 2);
      if (collides) {
        pairs.EnableCollision(0, 1);
        pairs.EnableCollision(1, 1);
      }
      const still = new J.BroadPhaseLayer(0), moving = new J.BroadPhaseLayer(1);
      layers.MapObjectToBroadPhaseLayer(0, still);
      layers.MapObjectToBroadPhaseLayer(1, moving);
      settings.mObjectLayerPairFilter = pairs;
      settings.mBroadPhaseLayerInterface = layers;
      settings.mObjectVsBroadPhaseLayerFilter = new J.ObjectVsBroadPhaseLayerFilterTable(layers, 2, pairs, 2);
      const world = new J.JoltInterface(settings), system = world.GetPhysicsSystem(), all = system.GetBodyInterface();
      const shapeOf = once(({ box, sphere, hull }) => {
        if (box) return new J.BoxShape(new J.Vec3(...box));
        if (sphere) return new J.SphereShape(sphere);
        const description = new J.ConvexHullShapeSettings();
        for (const point of hull) description.mPoints.push_back(new J.Vec3(...point));
        return description.Create().Get();
      });
      const made = bodies.map(([shape, position, isStatic]) => {
        const description = new J.BodyCreationSettings(shapeOf(shape), new J.RVec3(...position), new J.Quat(0, 0, 0, 1),
          isStatic ? J.EMotionType_Static : J.EMotionType_Dynamic, isStatic ? 0 : 1);
        Object.assign(description, { mFriction: FRICTION, mRestitution: 0, mAllowSleeping: false, mLinearDamping: 0, mAngularDamping: 0 });
        const body = all.CreateBody(description);
        all.AddBody(body.GetID(), isStatic ? J.EActivation_DontActivate : J.EActivation_Activate);
        J.destroy(description);
        return body;
      });
      for (const [a, b, point] of joints) {
        const description = new J.PointConstraintSettings();
        description.mPoint1 = description.mPoint2 = new J.RVec3(...point);
        system.AddConstraint(description.Create(made[a], made[b]));
      }
      const list = (v) => [v.GetX(), v.GetY(), v.GetZ()];
      return {
        step: () => world.Step(DT, 1),
        position: (body) => list(made[body].GetPosition()),
        rotation: (body) => [...list(made[body].GetRotation()), made[body].GetRotation().GetW()],
      };
    },
  };
}

export const ENGINES = { fulcrum, rapier, havok, jolt };
