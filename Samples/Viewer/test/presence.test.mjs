// Bodies that come and go, shapes that change, and sensors, which are glass.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { launch, openPage } from './browser.mjs';
import { readRecording, sensorsHtml } from './recording.mjs';
import { isAlwaysTheSame, presenceAt, presencesOf } from '../Page/presence.js';

test('a body is there from its first state until it is gone, with the shapes that it is given', () => {
  const presences = presencesOf({
    bodies: { shapes: [0, 0, 1] },
    bodyCount: 3,
    frameCount: 5,
    samples: { starts: [0, 2, 3, 4], frames: [0, 3, 1, 0], gone: [0, 1, 0, 0] },
    shapeChanges: [[1, 1, 4], [2, 1, 5], [3, 0, 6]],
  });
  assert.deepEqual(presences, [
    [{ shape: 0, from: 0, until: 3 }],
    [{ shape: 4, from: 1, until: 2 }, { shape: 5, from: 2, until: 5 }],
    [{ shape: 1, from: 0, until: 5 }],
  ]);
  assert.equal(presenceAt(presences[0], 2.9).shape, 0);
  assert.equal(presenceAt(presences[0], 3), undefined);
  assert.equal(presenceAt(presences[1], 0.5), undefined);
  assert.deepEqual(presences.map((own) => isAlwaysTheSame(own, 5)), [false, false, true]);
});

test('the recording knows its sensors and what they took away', async () => {
  const { bodies, frameCount, isSensor, presences } = await readRecording(sensorsHtml);
  assert.deepEqual(bodies.sensors, [1, 2, 3, 4]);
  assert.equal(isSensor.reduce((sum, is) => sum + is, 0), 4);
  const gone = presences.filter((own) => own[0].until < frameCount);
  assert.equal(gone.length, 12); // eight balls, four bullets
});

let browser, page;
const complaints = [];
before(async () => {
  browser = await launch();
  page = await openPage(browser, sensorsHtml, complaints);
});
after(() => browser?.close());

test('what was taken away is neither there nor drawn', async () => {
  const presences = (await readRecording(sensorsHtml)).presences;
  const ball = presences.findIndex((own, body) => body > 4 && own[0].until > 20 && own[0].until < 200);
  const { until } = presences[ball][0];
  const isThere = (frame) => page.evaluate(([at, id]) => {
    window.fulcrum.seek(at);
    return window.fulcrum.body(id).there;
  }, [frame, ball]);
  assert.equal(await isThere(until - 1), true);
  assert.equal(await isThere(until), false);
  assert.equal(await isThere(0), true);
  // At the end no ball is left where they rolled, z = 0: the only things to pick there are the gate and the floor.
  const last = await page.evaluate(() => window.fulcrum.frameCount - 1);
  const picked = await page.evaluate((at) => {
    window.fulcrum.seek(at);
    const { clientWidth, clientHeight } = document.getElementById('canvas');
    const ids = new Set();
    for (let x = 2; x < clientWidth; x += 9) for (let y = 2; y < clientHeight; y += 9) ids.add(window.fulcrum.pick(x, y));
    return [...ids];
  }, last);
  assert.ok(picked.length > 5, `${picked}`);
  for (const id of picked.filter((body) => body >= 0)) assert.equal(presences[id][0].until, last + 1, `body ${id} is gone`);
});

test('one sees through a sensor, and clicks what is in it', async () => {
  const info = await page.evaluate(() => [1, 0].map((id) => window.fulcrum.body(id).sensor));
  assert.deepEqual(info, [true, false]);
  // Crates float in the field, body 1, at the end.
  const found = await page.evaluate(() => {
    const { clientWidth, clientHeight } = document.getElementById('canvas');
    const ids = [];
    for (let x = 2; x < clientWidth; x += 6) for (let y = 2; y < clientHeight; y += 6) ids.push(window.fulcrum.pick(x, y));
    return [1, 5, 6, 7, 8, 9, 10].map((id) => ids.includes(id));
  });
  assert.equal(found[0], true, 'the field is not to be clicked');
  assert.ok(found.slice(1).filter(Boolean).length >= 4, `${found}`);
  assert.deepEqual(complaints, []);
});
