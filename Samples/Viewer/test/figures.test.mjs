// The series of a recording: what is decoded of them, and what the page plots.
import assert from 'node:assert/strict';
import { test } from 'node:test';
import { decodeFigures, peakOf, stagesOf } from '../Page/decodeFigures.js';
import { plotsOf, short } from '../Page/curves.js';
import { hingeHtml, html, readRecording, springsHtml } from './recording.mjs';

test('series are decoded as they are encoded: one after the other, 32 bits a frame', () => {
  const bytes = new Uint8Array(16);
  const view = new DataView(bytes.buffer);
  [1.5, -2, 3e6, 0].forEach((value, i) => view.setFloat32(4 * i, value, true));
  const figures = decodeFigures({ figures: ['a', 'b'], times: [0, 1] }, bytes);
  assert.deepEqual([...figures.a], [1.5, -2]);
  assert.deepEqual([...figures.b], [3e6, 0]);
  assert.deepEqual(decodeFigures({ times: [0, 1] }, new Uint8Array()), {});
});

test('the most expensive stages stand alone, the others together; nothing is lost', () => {
  const figures = { 'ms A': [1, 1], 'ms B': [5, 7], 'ms C': [3, 1], kinetic: [9, 9] };
  const stages = stagesOf(figures, 1);
  assert.deepEqual(stages.map(({ name }) => name), ['B', 'other']);
  assert.deepEqual([...stages[1].values], [4, 2]);
  assert.deepEqual(stagesOf(figures, 5).map(({ name }) => name), ['A', 'B', 'C']);
});

test('a peak is the first of the largest, and none where all is zero', () => {
  assert.equal(peakOf([0, 2, 5, 5, 1]), 2);
  assert.equal(peakOf([0, 0]), -1);
});

test('numbers are short', () => {
  assert.deepEqual([0, 1.2345, 12345, -1.5e6, 2.5e-5].map(short), ['0', '1.23', '12.3 k', '-1.5 M', '2.5e-5']);
});

test('a falling pyramid turns potential into kinetic energy before it touches, and sinks nowhere deep', async () => {
  const recording = await readRecording(html);
  const { kinetic, potential, penetration, contacts, awake, deepestA, deepestB } = recording.figures;
  assert.equal(kinetic.length, recording.frameCount);
  // Gaps of half a meter: the first 10 steps are free fall.
  const total = (i) => kinetic[i] + potential[i];
  assert.ok(kinetic[10] > 0 && Math.abs(total(10) - total(0)) < 1e-4 * Math.abs(total(0)));
  assert.equal(contacts[0], 0);
  assert.ok(contacts.at(-1) > 1000);
  assert.equal(awake[5], recording.bodies.motions.filter((motion) => motion === 2).length);
  const worst = peakOf(penetration);
  assert.ok(penetration[worst] > 0 && penetration[worst] < 0.5);
  assert.notEqual(deepestA[worst], deepestB[worst]);
});

test('springs that were drawn hold the energy at first: m (2 pi f x)^2 / 2 each', async () => {
  const { figures } = await readRecording(springsHtml);
  let expected = 0;
  for (const frequency of [0.5, 1, 2, 3, 5]) for (const mass of [1, 2, 3, 4, 5]) expected += 0.5 * mass * (2 * Math.PI * frequency * 0.5) ** 2;
  assert.ok(Math.abs(figures.springs[0] - expected) < 1e-4 * expected, `${figures.springs[0]}, not ${expected}`);
  assert.equal(figures.kinetic[0], 0);
  assert.ok(figures.springs.at(-1) < 0.1 * expected);
});

test('plots say nothing that is not there', async () => {
  const ids = (recording) => plotsOf(recording).map(({ id }) => id);
  assert.deepEqual(ids(await readRecording(html)), ['energy', 'momentum', 'angular', 'penetration', 'contacts', 'awake', 'ms']);
  assert.ok(ids(await readRecording(hingeHtml)).includes('joint-error'));
  assert.ok(!ids(await readRecording(springsHtml)).includes('contacts'));
  assert.deepEqual(plotsOf({ figures: {} }), []);
});
