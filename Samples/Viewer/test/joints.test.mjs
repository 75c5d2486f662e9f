// Joints: what is decoded of them, where they are and how far out of place, and what the page shows.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { Quaternion, Vector3 } from 'three';
import { launch, openPage } from './browser.mjs';
import { hingeHtml, html, readRecording } from './recording.mjs';
import { decodeJoints } from '../Page/decodeJoints.js';
import { JointPose, decompose, errorOf, ropeLength, stateAt, twistOf, unwrapped } from '../Page/jointPose.js';
import { limitShape } from '../Page/jointShapes.js';
import { Reader } from '../Page/reader.js';
import { Timeline } from '../Page/timeline.js';

const near = (value, expected, tolerance, what = 'value') =>
  assert.ok(Math.abs(value - expected) <= tolerance, `${what} is ${value}, not ${expected} within ${tolerance}`);
const FREE = [-Infinity, Infinity];

// Frame B against frame A, which is that of the world.
function poseOf(offset, turn = new Quaternion()) {
  const joint = { frameA: { position: [0, 0, 0], rotation: [0, 0, 0, 1] }, frameB: { position: [0, 0, 0], rotation: [0, 0, 0, 1] } };
  return new JointPose().set(joint, [0, 0, 0, ...offset], [0, 0, 0, 1, ...turn.toArray()], 0, 1);
}

// As the writer's own test expects them (UnitTests/Samples/ViewerJointsTest.cpp), with a track and a circle.
test('columns are decoded as they are encoded', () => {
  const header = { times: [0, 1], joints: { count: 1, kinds: ['pulley'], step: 1e-5, rotationSteps: 1 << 20, ratioStep: 1e-5, errorStep: 1e-6 } };
  const columns = [
    [0, 0, 0, 0, 0, 66, 1, 0, 0, 50001 & 127 | 128, 50001 >> 7 & 127 | 128, 50001 >> 14, 0, 2, 128, 181, 24, 160, 141, 6, 0, 207, 134, 3, 0, 0, 0, 128, 128, 128, 1,
      0, 0, 0, 0, 0, 255, 255, 127, 0, 1, 0, 20, 0],
    [1, 0, 3, 2, 20, 1, 0, 2, 0],
    [10, 0, 2, 0, 0, 0, 0, 0],
  ];
  const { joints, jointErrors } = decodeJoints(header, columns.map((bytes) => new Reader(new Uint8Array(bytes))));
  const [joint] = joints;
  assert.equal(joint.kind, 'pulley');
  assert.deepEqual([joint.bodyA, joint.bodyB, joint.isHardLength, joint.isRope, joint.isPyramid], [0, 1, true, true, false]);
  assert.deepEqual([joint.trackA, joint.trackB], [0, -1]);
  near(joint.circleB, 0.5, 1e-9);
  assert.ok(joint.circleA < 0, 'no circle');
  near(joint.ratio, 2, 1e-9);
  near(joint.frameA.position[0], 0.5, 1e-9);
  near(joint.frameA.position[2], -0.25, 1e-9);
  assert.deepEqual(joint.frameA.rotation, [0, 0, 0, 1]);
  assert.deepEqual(joint.frameB.rotation, [0, 0, -1, 0]);
  near(joint.points[0][1], 1e-4, 1e-12);
  assert.deepEqual(joint.states.map(({ frame, enabled }) => [frame, enabled]), [[0, true], [1, false]]);
  assert.equal(joint.states[0].limits[0][0], -Infinity);
  near(joint.states[0].limits[0][1], 1e-4, 1e-12);
  assert.deepEqual(joint.states[1].limits[0], FREE);
  near(jointErrors[0].distance, 1e-5, 1e-12);
  near(jointErrors[0].angle, 2e-6, 1e-12);
});

test('a joint is as its last state before a frame says, and is not before its first', () => {
  const joint = { states: [{ frame: 3, enabled: true }, { frame: 7, enabled: false }] };
  assert.equal(stateAt(joint, 2), undefined);
  assert.equal(stateAt(joint, 3).enabled, true);
  assert.equal(stateAt(joint, 6).enabled, true);
  assert.equal(stateAt(joint, 70).enabled, false);
});

test('errors are of what is locked', () => {
  const turn = new Quaternion().setFromAxisAngle(new Vector3(0, 1, 0), 0.2);
  const pose = poseOf([0.3, 0.4, 0], turn);
  const error = (joint) => errorOf({ linearLock: 'none', angularLock: 'none', ...joint }, pose, [[0, 0.4], FREE, FREE]);
  assert.deepEqual(error({}), { distance: 0, angle: 0 });
  near(error({ linearLock: 'point' }).distance, 0.5, 1e-6);
  near(error({ linearLock: 'line', line: 0 }).distance, 0.4, 1e-6);
  near(error({ isHardLength: true, isRope: true, points: [] }).distance, 0.1, 1e-6);
  near(error({ angularLock: 'all' }).angle, 0.2, 1e-6);
  near(error({ angularLock: 'axis', axis: 0 }).angle, 0.2, 1e-6);
  near(error({ angularLock: 'axis', axis: 1 }).angle, 0, 1e-6);
});

test('a rotation comes apart into swing and twist', () => {
  const swing = new Quaternion().setFromAxisAngle(new Vector3(0, 0.6, 0.8), 0.9);
  const twist = new Quaternion().setFromAxisAngle(new Vector3(1, 0, 0), -0.4);
  const parts = decompose(swing.clone().multiply(twist));
  near(parts.alpha, 0.9, 1e-9);
  near(parts.y, 0.54, 1e-9);
  near(parts.z, 0.72, 1e-9);
  near(parts.twist, -0.4, 1e-9);
  near(twistOf(new Quaternion().setFromAxisAngle(new Vector3(0, 0, 1), 2), 2), 2, 1e-9);
  near(unwrapped(-3, [2, 4]), 2 * Math.PI - 3, 1e-9);
});

test('a rope is as long as its parts', () => {
  near(ropeLength({ points: [[0, 1, 0], [3, 1, 0]], ratio: 2 }, poseOf([3, -1, 0])), 1 + 2 * 2, 1e-6);
});

// Of each corner of lines: how far it is from frame A's x axis, as an angle.
const anglesOf = ({ lines }, radius) => {
  const angles = [];
  for (let i = 0; i < lines.length; i += 3) if (Math.hypot(...lines.slice(i, i + 3)) > 0.9 * radius) angles.push(Math.acos(lines[i] / radius));
  return angles;
};

test('limits are drawn where they are', () => {
  const locked = [0, 0];
  const cone = limitShape({ rotations: true, angularLock: 'none' }, [FREE, FREE, FREE, FREE, [-0.7, 0.7], [-0.7, 0.7]], 2).turn;
  for (const angle of anglesOf(cone, 2)) near(angle, 0.7, 1e-6);

  const swing = (isPyramid) => anglesOf(limitShape({ rotations: true, isPyramid, angularLock: 'none' },
    [FREE, FREE, FREE, locked, [-0.5, 0.5], [-1.2, 1.2]], 2).turn, 2);
  near(Math.min(...swing(false)), 0.5, 1e-6);
  near(Math.max(...swing(false)), 1.2, 1e-6);
  near(Math.min(...swing(true)), 0.5, 1e-6);
  assert.ok(Math.max(...swing(true)) > 1.25, 'the corners of a pyramid are further out than its faces');

  const { lines } = limitShape({ rotations: true, angularLock: 'axis', axis: 0 }, [FREE, FREE, FREE, [-1, 2], FREE, FREE], 2).turn;
  const angles = [];
  for (let i = 0; i < lines.length; i += 3) if (Math.hypot(lines[i + 1], lines[i + 2]) > 1) angles.push(Math.atan2(lines[i + 2], lines[i + 1]));
  near(Math.min(...angles), -1, 1e-6);
  near(Math.max(...angles), 2, 1e-6);

  const slide = limitShape({ trackA: 0 }, [[-0.5, 3], locked, locked, locked, locked, locked], 0.1).A.lines;
  const along = slide.filter((_, i) => i % 3 === 0);
  near(Math.min(...along), -0.5, 1e-9);
  near(Math.max(...along), 3, 1e-9);

  const box = limitShape({ translations: true, rotations: true, angularLock: 'all' }, [[-1, 2], [-3, 4], [-5, 6], locked, locked, locked], 1).A.lines;
  assert.equal(box.length, 12 * 6, 'a box has twelve edges');
});

test('frames on the bodies meet within the errors that were recorded', async () => {
  const recording = await readRecording(hingeHtml);
  assert.deepEqual(recording.joints.map(({ kind }) => kind), Array(5).fill('hinge'));
  near(recording.joints[0].states[0].limits[3][1], 1.2, 1e-5);
  assert.deepEqual(recording.joints[4].states[0].limits[3], FREE);
  const timeline = new Timeline(recording), pose = new JointPose();
  let farthest = 0;
  for (let frame = 0; frame <= timeline.lastFrame; ++frame) {
    timeline.seek(frame);
    for (const joint of recording.joints) {
      pose.set(joint, timeline.positions, timeline.rotations, joint.bodyA, joint.bodyB);
      const { distance, angle } = errorOf(joint, pose, stateAt(joint, frame).limits);
      // Places are recorded in steps of 0.1 mm at most, rotations in steps of 1 / 32768.
      near(Math.max(0, distance - recording.jointErrors[frame].distance), 0, 3e-4, 'gap');
      near(Math.max(0, angle - recording.jointErrors[frame].angle), 0, 3e-4, 'tilt');
      if (joint.id === 0) farthest = Math.max(farthest, Math.abs(twistOf(pose.relative, 0)));
    }
  }
  near(farthest, 1.2, 5e-3, 'the way of the driven door');
});

let browser, page;
const complaints = [];
before(async () => {
  browser = await launch();
  page = await openPage(browser, hingeHtml, complaints);
});
after(() => browser?.close());

test('a few joints are shown at once, and the switch takes them away and back', async () => {
  const toggle = page.locator('#toggles input[value=joints]');
  assert.ok(await toggle.isChecked());
  await page.evaluate(() => window.fulcrum.seek(60));
  await page.evaluate(() => window.keepPicture());
  await toggle.click();
  assert.ok((await page.evaluate(() => window.differenceToKept())) > 0.002, 'the joints show nothing');
  await toggle.click();
  assert.equal(await page.evaluate(() => window.differenceToKept()), 0, 'the joints are not the same again');
});

test('the panel tells the errors of the frame, and of a body its joints', async () => {
  const gaps = (await readRecording(hingeHtml)).jointErrors.map(({ distance }) => distance);
  const widest = gaps.indexOf(Math.max(...gaps)), closed = gaps.indexOf(0);
  await page.evaluate((frame) => window.fulcrum.seek(frame), widest);
  const { count, enabled, distance } = await page.evaluate(() => window.fulcrum.joints());
  assert.ok(distance > 0, 'no frame has a gap');
  assert.deepEqual([count, enabled], [5, 5]);
  const value = (label) => page.locator(`#joint-errors dt:text-is("${label}") + dd`).textContent();
  assert.equal(await value('Number'), '5');
  assert.equal(Number.parseFloat(await value('Largest gap')), Number((1000 * distance).toPrecision(3)));
  assert.match(await value('Largest tilt'), /rad, joint \d+$|^none$/);
  if (closed >= 0) {
    await page.evaluate((frame) => window.fulcrum.seek(frame), closed);
    assert.equal(await value('Largest gap'), 'none');
  }
  assert.deepEqual((await page.evaluate(() => window.fulcrum.body(2))).joints, ['hinge 0']);
  assert.deepEqual(complaints, []);
});

test('without joints there is no word of them', async () => {
  const other = await openPage(browser, html, complaints);
  assert.equal(await other.locator('#joints').isVisible(), false);
  assert.equal(await other.locator('#toggles input[value=joints]').isVisible(), false);
  assert.deepEqual(complaints, []);
  await other.close();
});
