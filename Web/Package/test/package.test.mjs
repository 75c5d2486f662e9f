// The package as its users have it: golden hashes, physics that one can compute, errors, threads, types. `./fulcrum test` builds
// what it needs; FULCRUM_RUNNER names the native runner, whose hashes are compared, too.
import assert from 'node:assert/strict';
import { execFileSync, spawnSync } from 'node:child_process';
import { existsSync, mkdtempSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import test from 'node:test';
import { fileURLToPath } from 'node:url';
import { FulcrumError, WORLD, load } from '../src/node.js';

const pathOf = (name) => fileURLToPath(new URL(name, import.meta.url));
const fulcrum = await load();
const isNear = (value, wanted, tolerance) => assert.ok(Math.abs(value - wanted) <= tolerance, `${value} is not within ${tolerance} of ${wanted}`);

function worldOnFloor(settings) {
  const world = fulcrum.createWorld(settings);
  world.bodies.create({ shape: { kind: 'Plane' }, motion: 'Static' });
  return world;
}

test('the golden hashes of the engine', () => {
  const program = pathOf('../../../build/webassembly/bin/FulcrumGoldenTests.js');
  assert.ok(existsSync(program), `${program} is missing: ./fulcrum web --package builds it`);
  const run = spawnSync(process.execPath, [program, '--gtest_filter=GoldenHash.*:TrigonometryBits.*:TrigonometryOfLanes.*'], { encoding: 'utf8' });
  assert.equal(run.status, 0, (run.stdout + run.stderr).slice(-2000));
  for (const name of ['OfTheMixedScene', 'OfTheJointScene', 'OfTheSurfaceScene', 'OfTheFastScene']) assert.ok(run.stdout.includes(`OK ] GoldenHash.${name}`), name);
  assert.ok(run.stdout.includes('OK ] TrigonometryBits.AreTheSameOnEveryMachine'));
});

test('a fall is that of the closed form', () => {
  const world = fulcrum.createWorld({ gravity: [0, -10, 0] });
  const ball = world.bodies.create({ shape: { kind: 'Sphere', radius: 0.5 }, position: [1, 100, 2], linearVelocity: [3, 0, 0] });
  for (let step = 0; step < 60; ++step) world.step(1 / 60);
  const { position, linearVelocity, mass } = world.bodies.read(ball);
  isNear(position[0], 4, 1e-4);
  isNear(position[1], 95, 1e-3);
  isNear(linearVelocity[1], -10, 1e-4);
  isNear(mass, (1000 * 4 * Math.PI * 0.125) / 3, 0.1);
  world.destroy();
});

test('crates come to rest on a floor, fall asleep, and all arrays say so', () => {
  const world = worldOnFloor();
  const box = fulcrum.createShape({ kind: 'Box', halfExtents: [0.5, 0.5, 0.5] });
  const crates = [0, 1, 2].map((i) => world.bodies.create({ shape: box, position: [0, 0.6 + 1.1 * i, 0] }));
  box.destroy(); // the bodies keep it
  for (let step = 0; step < 180; ++step) world.step();
  const all = world.bodies.readAll();
  crates.forEach((crate, i) => {
    const { position, isAwake } = world.bodies.read(crate);
    isNear(position[1], 0.5 + i, 0.02);
    assert.equal(isAwake, false);
  });
  assert.equal(all.count, 4);
  assert.deepEqual(Array.from(all.flags), [5, 1, 1, 1]);
  isNear(all.positions[3 * 3 + 1], 2.5, 0.02);
  assert.equal(all.idAt(1), crates[0]);
  assert.equal(world.report.awakeBodies, 0);
  world.destroy();
});

test('bodies are changed, removed, and ids of removed ones stay invalid', () => {
  const world = fulcrum.createWorld({ gravity: [0, 0, 0] });
  const ball = world.bodies.create({ shape: { kind: 'Sphere', radius: 0.5 }, mass: 2 });
  world.bodies.addImpulse(ball, [4, 0, 0]);
  assert.deepEqual(world.bodies.read(ball).linearVelocity, [2, 0, 0]);
  world.bodies.setVelocity(ball, [0, 1, 0], [0, 0, 3]);
  world.bodies.setMass(ball, 5);
  world.bodies.setMotion(ball, 'Kinematic');
  assert.equal(world.bodies.read(ball).motion, 'Kinematic');
  world.bodies.setPose(ball, [7, 8, 9]);
  assert.deepEqual(world.bodies.read(ball).position, [7, 8, 9]);
  world.bodies.remove(ball);
  const next = world.bodies.create({ shape: { kind: 'Sphere', radius: 0.5 } });
  assert.equal(world.bodies.exists(ball), false);
  assert.notEqual(next, ball);
  assert.throws(() => world.bodies.read(ball), FulcrumError);
  world.destroy();
});

test('a pendulum keeps its length, a motor turns a hinge, a target pulls', () => {
  const world = fulcrum.createWorld({ sleep: { enabled: false } });
  const bob = world.bodies.create({ shape: { kind: 'Sphere', radius: 0.1 }, position: [1, 0, 0] });
  const rope = world.joints.create({ kind: 'Point', bodyB: bob, anchorA: { point: [0, 0, 0] } });
  const rotor = world.bodies.create({ shape: { kind: 'Cylinder', halfHeight: 0.1, radius: 0.5 }, position: [10, 0, 0], gravityFactor: 0 });
  const hinge = world.joints.create({ kind: 'Hinge', bodyA: WORLD, bodyB: rotor, anchorA: { point: [10, 0, 0], axis: [0, 1, 0] } });
  world.joints.setMotor(hinge, 'AngularX', { mode: 'ToVelocity', targetSpeed: 2 });
  const pulled = world.bodies.create({ shape: { kind: 'Sphere', radius: 0.5 }, position: [20, 0, 0], gravityFactor: 0 });
  const hand = world.joints.createTarget({ body: pulled, anchor: [20, 0, 0], target: [20, 0, 0] });
  world.joints.setTarget(hand, [20, 3, 0]);
  for (let step = 0; step < 120; ++step) world.step();
  isNear(Math.hypot(...world.bodies.read(bob).position), 1, 2e-3);
  assert.ok(world.joints.read(rope).distance < 2e-3);
  isNear(world.bodies.read(rotor).angularVelocity[1], 2, 0.01);
  isNear(world.bodies.read(pulled).position[1], 3, 0.05);
  world.joints.remove(hand);
  assert.equal(world.joints.exists(hand), false);
  world.destroy();
});

test('queries find what is there', () => {
  const world = worldOnFloor();
  const box = world.bodies.create({ shape: { kind: 'Box', halfExtents: [1, 1, 1] }, position: [0, 1, 0], motion: 'Static' });
  const down = { origin: [0, 5, 0], displacement: [0, -10, 0] };
  const hit = world.queries.castRay(down);
  assert.equal(hit.body, box);
  isNear(hit.fraction, 0.3, 1e-6);
  assert.deepEqual(hit.normal, [0, 1, 0]);
  isNear(world.queries.castRay({ ...down, ignore: [box] }).fraction, 0.5, 1e-6);
  assert.equal(world.queries.castRayAll(down).length, 2);
  assert.equal(world.queries.castRay({ origin: [0, 5, 0], displacement: [0, 10, 0] }), undefined);
  isNear(world.queries.castShape({ shape: { kind: 'Sphere', radius: 0.5 }, position: [0, 5, 0], displacement: [0, -10, 0] }).fraction, 0.25, 1e-4);
  assert.deepEqual(world.queries.findOverlaps({ shape: { kind: 'Sphere', radius: 0.5 }, position: [1.2, 1, 0] }).map(({ body }) => body), [box]);
  isNear(world.queries.findClosest({ position: [0, 4, 0], maxDistance: 10 }).distance, 2, 1e-5);
  world.destroy();
});

test('what is wrong is named, and changes nothing', () => {
  const world = worldOnFloor();
  const before = world.hashState();
  const says = (act, pattern) => assert.throws(act, (error) => error instanceof FulcrumError && pattern.test(error.message));
  says(() => fulcrum.createShape({ kind: 'Sphere', radius: -1 }), /radius/);
  says(() => fulcrum.createShape({ kind: 'Sphere', radius: '1' }), /shape\.radius: .*must be a number/);
  says(() => fulcrum.createShape({ kind: 'Ball' }), /one of Sphere, Box/);
  says(() => fulcrum.createShape({ kind: 'MeshFile', file: 'a.obj' }), /not read here/);
  says(() => world.bodies.create({ shape: { kind: 'Sphere', radius: 1 }, colour: 'red' }), /colour: an unknown name/);
  says(() => world.bodies.create({}), /shape/);
  says(() => world.joints.create({ kind: 'Point', bodyB: 12345 }), /body/i);
  says(() => world.set({ solver: { substeps: 0 } }), /solver\.substeps/);
  says(() => world.set({ narrowPhase: 'Libccd' }), /does not contain/);
  says(() => world.step(NaN), /dt|finite/i);
  says(() => world.queries.castRay({ origin: [0, 0, 0] }), /displacement/);
  says(() => fulcrum.createScene('nowhere'), /nowhere/);
  assert.equal(world.hashState(), before);
  world.destroy();
  says(() => world.step(), /destroyed/);
});

test('settings are set in part, and read as they are', () => {
  const world = fulcrum.createWorld();
  world.set({ solver: { substeps: 9 } });
  world.set({ accuracy: { penetration: Infinity, jointError: 0.002 } });
  const { solver, accuracy, gravity } = world.settings;
  assert.deepEqual([solver.substeps, solver.velocityIterations, accuracy.penetration, accuracy.jointError], [9, 1, Infinity, 0.002]);
  assert.deepEqual(gravity, [0, -9.81, 0]);
  world.destroy();
});

test('a world that is restored goes on with the same bits', () => {
  const world = fulcrum.createScene('pyramid');
  for (let step = 0; step < 20; ++step) world.step();
  const saved = world.save();
  const run = () => {
    for (let step = 0; step < 20; ++step) world.step();
    return world.hashState();
  };
  const first = run();
  world.restore(saved);
  assert.equal(run(), first);
  world.destroy();
});

const SCENES = [['pyramid', 60], ['convex_on_mesh', 60], ['ragdolls', 30], ['high_speed', 20], ['hinge', 120], ['springs', 120], ['bridge', 120]];
function hashOf(engine, scene, steps) {
  const world = engine.createScene(scene);
  for (let step = 0; step < steps; ++step) world.step();
  const hash = world.hashPoses().toString(16).padStart(16, '0');
  assert.equal(world.threads, engine.threads);
  world.destroy();
  return hash;
}

test('scenes end with the hashes of the native build', { skip: !process.env.FULCRUM_RUNNER && 'FULCRUM_RUNNER is not set' }, () => {
  const folder = mkdtempSync(join(tmpdir(), 'fulcrum-web-'));
  for (const [scene, steps] of SCENES) {
    const report = execFileSync(process.env.FULCRUM_RUNNER, ['run', scene, '--steps', String(steps), '--record', 'none'], { cwd: folder, encoding: 'utf8' });
    const [, native] = report.match(/pose hash\s+([0-9a-f]{16})/);
    assert.equal(hashOf(fulcrum, scene, steps), native, scene);
  }
});

test('any number of threads gives the same hashes', async () => {
  const threaded = await load({ threads: 3 });
  assert.equal(threaded.threads, 3);
  for (const [scene, steps] of SCENES.slice(0, 3)) assert.equal(hashOf(threaded, scene, steps), hashOf(fulcrum, scene, steps), scene);
  threaded.close();
});

test('memory of worlds is given back', () => {
  const used = () => {
    const world = fulcrum.createScene('pyramid');
    world.step();
    const bytes = world.memoryUsed;
    world.destroy();
    return bytes;
  };
  const first = used();
  for (let i = 0; i < 20; ++i) assert.equal(used(), first);
});

test('the types say what the package does', () => {
  const compiler = pathOf('../node_modules/typescript/bin/tsc');
  assert.ok(existsSync(compiler), 'typescript is missing: npm ci');
  const run = spawnSync(process.execPath, [compiler, '-p', pathOf('tsconfig.json')], { encoding: 'utf8' });
  assert.equal(run.status, 0, run.stdout);
});
