// Lines and points that the scene drew: what is decoded of them, and what the page shows.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { launch, openPage } from './browser.mjs';
import { html, queryHtml, readRecording } from './recording.mjs';
import { decodeDrawings } from '../Page/decodeDrawings.js';
import { Reader } from '../Page/reader.js';

// The bytes that the writer's own test expects (UnitTests/Samples/ViewerDrawingsTest.cpp).
test('columns are decoded as they are encoded', () => {
  const header = { times: [0, 1], drawings: { step: 1, mostLines: 2, mostPoints: 1 } };
  const bytes = [2, 6, 2, 0, 0, 2, 4, 0, 0, 0, 0, 1, 1, 0, 0, 1, 2, 0, 10, 0, 1, 1, 0, 0, 0, 0, 2, 0, 0];
  const reader = new Reader(new Uint8Array(bytes));
  const [first, second] = decodeDrawings(header, reader);
  assert.equal(reader.at, bytes.length);
  assert.deepEqual([...first.lines.places], [1, 0, 0, 1, 2, 0, 1, 0, -1, 0, 0, 0]);
  assert.deepEqual([...first.lines.colors], [3, 3]);
  assert.deepEqual([...first.points.places], [0, 5, 0]);
  assert.deepEqual([...second.lines.places], [1, 0, 0, 1, 3, 0]);
  assert.deepEqual([...second.lines.colors], [2]);
  assert.equal(second.points.count, 0);
});

test('a recording of a scene that draws has lines in every frame after the first', async () => {
  const { drawings, frameCount } = await readRecording(queryHtml);
  assert.equal(drawings.length, frameCount);
  assert.equal(drawings[0].lines.count, 0);
  assert.ok(drawings.slice(1).every(({ lines, points }) => lines.count > 0 && points.count > 0));
  assert.ok(drawings[1].lines.places.every((x) => Math.abs(x) < 30));
  assert.deepEqual((await readRecording(html)).drawings, []);
});

let browser;
before(async () => (browser = await launch()));
after(() => browser?.close());

test('drawings are shown from the start and can be switched off', async () => {
  const complaints = [];
  const page = await openPage(browser, queryHtml, complaints);
  await page.evaluate(() => window.fulcrum.seek(30));
  const toggle = page.locator('#toggles input[value=drawings]');
  assert.ok(await toggle.isChecked());
  await page.evaluate(() => window.keepPicture());
  await toggle.click();
  assert.ok((await page.evaluate(() => window.differenceToKept())) > 0.005, 'the drawings show nothing');
  await toggle.click();
  assert.equal(await page.evaluate(() => window.differenceToKept()), 0);
  assert.deepEqual(complaints, []);
  await page.close();
});

test('a page without drawings does not offer them', async () => {
  const page = await openPage(browser, html);
  assert.ok(!(await page.locator('#toggles input[value=drawings]').isVisible()));
  await page.close();
});
