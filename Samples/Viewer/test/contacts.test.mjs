// Contact points between the frames that recorded them; and the scale bar and the decades of logarithmic plots, by their numbers.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { contactsNow } from '../Page/contactsNow.js';
import { decadesOf, hasLogarithm, positive, splitsOf } from '../Page/curves.js';
import { Contacts } from '../Page/overlays.js';
import { lengthText, roundBelow } from '../Page/scaleBar.js';
import { Dots, Lines, Surfaces } from '../Page/strokes.js';

// Two bodies, of which each has a sample of frame 0; they are now where `positions` and `rotations` say.
function timelineAt(frame, positions, rotations = [0, 0, 0, 1, 0, 0, 0, 1], there = [true, true]) {
  const samples = { positions: [0, 0, 0, 0, 1, 0], rotations: [0, 0, 0, 1, 0, 0, 0, 1] };
  return { frame, recording: { samples }, positions, rotations, isThere: (body) => there[body], sampleAt: (body) => body };
}
const CONTACTS = {
  frame: 0, count: 2, bodies: Uint32Array.of(0, 1, 0, 1), points: Float32Array.of(0.4, 0.5, 0, -0.4, 0.5, 0), normals: Float32Array.of(0, 1, 0, 0, 1, 0),
  separations: Float32Array.of(-0.001, -0.002), impulses: Float32Array.of(1, 2),
};
const near = (values, expected) => expected.forEach((value, i) => assert.ok(Math.abs(values[i] - value) < 1e-6, `${[...values]} is not ${expected}`));

test('contacts of their own frame are those that were recorded', () => {
  assert.equal(contactsNow(CONTACTS, timelineAt(0, [0, 0, 0, 0, 1, 0]), 0.5), CONTACTS);
  assert.equal(contactsNow(undefined, timelineAt(3, [0, 0, 0, 0, 1, 0]), 0.5), undefined);
});

test('contacts go with bodies that move and turn together', () => {
  const half = Math.SQRT1_2; // a quarter turn about z, about (0, 0, 0), and 3 m along x
  const now = contactsNow(CONTACTS, timelineAt(17, [3, 0, 0, 2, 0, 0], [0, 0, half, half, 0, 0, half, half]), 0.5);
  assert.equal(now.count, 2);
  near(now.points, [2.5, 0.4, 0, 2.5, -0.4, 0]);
  near(now.normals, [-1, 0, 0, -1, 0, 0]);
  near(now.impulses, [1, 2]);
  near(now.separations, [-0.001, -0.002]);
});

test('contacts of bodies that have parted, slid, rolled or gone are not shown', () => {
  const { sin, cos } = Math;
  assert.equal(contactsNow(CONTACTS, timelineAt(5, [0, 0, 0, 0, 1.2, 0]), 0.5).count, 0);
  assert.equal(contactsNow(CONTACTS, timelineAt(5, [0, 0, 0, 0.1, 1, 0]), 0.5).count, 0);
  assert.equal(contactsNow(CONTACTS, timelineAt(5, [0, 0, 0, 0, 1, 0], [0, 0, 0, 1, 0, 0, sin(0.1), cos(0.1)]), 0.5).count, 0);
  assert.equal(contactsNow(CONTACTS, timelineAt(5, [0, 0, 0, 0, 1, 0], undefined, [true, false]), 0.5).count, 0);
  // A fiftieth of a body: as good as where it was.
  near(contactsNow(CONTACTS, timelineAt(5, [0, 0, 0, 0.01, 1, 0]), 0.5).points, [0.405, 0.5, 0, -0.395, 0.5, 0]);
});

test('what has not been filled yet draws nothing', () => {
  const stage = { renderer: { getPixelRatio: () => 1 }, scene: { add() {} } };
  for (const strokes of [new Dots(stage, 1, 5), new Surfaces(stage, 1)]) {
    assert.equal(strokes.geometry.drawRange.count, 0);
    strokes.begin();
    strokes.add([0, 0, 0, 1, 0, 0, 0, 1, 0], [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1], { r: 1, g: 0, b: 0 });
    strokes.end();
    assert.equal(strokes.geometry.drawRange.count, 3);
  }
  assert.equal(new Lines(stage, 1, 1).geometry.instanceCount, 0);
  const { geometry, lineGeometry } = new Contacts({ contacts: [CONTACTS] }, stage);
  assert.deepEqual([geometry.drawRange.count, lineGeometry.drawRange.count], [0, 0]);
});

test('the scale bar has round lengths that fit', () => {
  for (const [most, expected] of [[1, 1], [1.99, 1], [2, 2], [4.9, 2], [5.1, 5], [9.99, 5], [10, 10], [0.03, 0.02], [7e-4, 5e-4], [2500, 2000]])
    assert.ok(Math.abs(roundBelow(most) / expected - 1) < 1e-9, `${roundBelow(most)} at most ${most}`);
  assert.deepEqual([2000, 5, 1, 0.5, 0.02, 0.005, 2e-4].map(lengthText), ['2 km', '5 m', '1 m', '50 cm', '2 cm', '5 mm', '0.2 mm']);
});

test('logarithmic plots have whole decades, and no zeros', () => {
  assert.deepEqual(decadesOf(0.02, 30), [0.01, 100]);
  assert.deepEqual(decadesOf(3, 3), [1, 10]);
  assert.deepEqual(decadesOf(1e-30, 1), [1e-9, 10]);
  assert.deepEqual(decadesOf(null, null), [0.1, 1]);
  assert.deepEqual(splitsOf(0.01, 10), [0.01, 0.1, 1, 10]);
  assert.deepEqual(splitsOf(1e-9, 1), [1e-9, 1e-6, 1e-3, 1]);
  assert.deepEqual(positive([0, 1, -2, 3]), [null, 1, null, 3]);
  const plot = (values, stacked) => ({ series: [{ values }], stacked });
  assert.deepEqual([plot([0, 1]), plot([-1, 1]), plot([0, 1], true)].map(hasLogarithm), [true, false, false]);
});
