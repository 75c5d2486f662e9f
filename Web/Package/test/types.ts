// Compiled, never run: the types accept what the engine does, and refuse what it does not.
import { load, WORLD, type BodyId, type World } from 'fulcrum-physics';

export async function example(): Promise<number> {
  const fulcrum = await load({ threads: 4 });
  const world: World = fulcrum.createWorld({ gravity: [0, -9.81, 0], solver: { substeps: 8 }, accuracy: { jointError: Infinity } });
  const box = fulcrum.createShape({ kind: 'Box', halfExtents: [0.5, 0.5, 0.5] });
  world.bodies.create({ shape: { kind: 'Plane' }, motion: 'Static', material: { friction: 0.8 } });
  const crate: BodyId = world.bodies.create({ shape: box, position: [0, 2, 0], continuous: 'Linear' });
  const door = world.joints.create({ kind: 'Hinge', bodyA: WORLD, bodyB: crate, anchorA: { point: [0, 2, 0.5], axis: [0, 1, 0] } });
  world.joints.setMotor(door, 'AngularX', { mode: 'ToVelocity', targetSpeed: 2 });
  // @ts-expect-error: no such kind
  world.joints.create({ kind: 'Rope', bodyB: crate });
  // @ts-expect-error: no such setting
  world.set({ substeps: 4 });
  // @ts-expect-error: a sphere has a radius
  fulcrum.createShape({ kind: 'Sphere' });
  world.step();
  const hit = world.queries.castRay({ origin: [0, 5, 0], displacement: [0, -10, 0], ignore: [crate] });
  return hit ? hit.fraction : world.report.largestPenetration + Number(world.hashPoses() % 2n);
}
