// The page in headless Chromium: what a user does with it.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { launch, openPage } from './browser.mjs';
import { html, screenshot } from './recording.mjs';

let browser, page;
const complaints = [], requests = [];

before(async () => {
  browser = await launch();
  page = await openPage(browser, html, complaints, requests);
});

after(() => browser?.close());

const drawn = () => page.evaluate(() => window.drawn());
const keepPicture = () => page.evaluate(() => window.keepPicture());
const difference = () => page.evaluate(() => window.differenceToKept());
const frame = () => page.evaluate(() => window.fulcrum.frame);
const lastFrame = () => page.evaluate(() => window.fulcrum.frameCount - 1);
const seek = (wanted) => page.evaluate((value) => window.fulcrum.seek(value), wanted);

// Where a dynamic body is in sight, nearest to the middle of the picture.
const placeOfABody = () => page.evaluate(() => {
  const { clientWidth, clientHeight } = document.getElementById('canvas');
  const places = [];
  for (let x = 0.1; x < 0.9; x += 0.05) for (let y = 0.15; y < 0.85; y += 0.05) places.push([x, y]);
  places.sort((a, b) => Math.hypot(a[0] - 0.5, a[1] - 0.5) - Math.hypot(b[0] - 0.5, b[1] - 0.5));
  for (const [u, v] of places) {
    const x = Math.round(u * clientWidth), y = Math.round(v * clientHeight);
    const id = window.fulcrum.pick(x, y);
    if (id >= 0 && window.fulcrum.body(id).motion === 'dynamic') return { x, y, ...window.fulcrum.body(id) };
  }
  return null;
});

test('loads without a complaint and asks for nothing but itself', async () => {
  assert.deepEqual(complaints, []);
  assert.deepEqual(requests.filter((url) => !url.startsWith('file:') && !url.startsWith('data:') && !url.startsWith('blob:')), []);
  assert.equal(requests.filter((url) => url.startsWith('file:')).length, 1);
  assert.ok((await lastFrame()) > 0);
  assert.notEqual(await page.locator('#title').textContent(), '');
});

test('shows bodies in color before a pale ground', async () => {
  await seek(0);
  const share = await page.evaluate(() => {
    const pixels = window.pictureNow();
    let colored = 0;
    for (let i = 0; i < pixels.length; i += 4) {
      if (Math.max(pixels[i], pixels[i + 1], pixels[i + 2]) - Math.min(pixels[i], pixels[i + 1], pixels[i + 2]) > 40) ++colored;
    }
    return colored / (pixels.length / 4);
  });
  assert.ok(share > 0.02, `${share} of the picture is colored`);
});

test('the slider changes the frame and the picture', async () => {
  await seek(0);
  await keepPicture();
  await page.locator('#scrub').fill(String(await lastFrame()));
  assert.ok((await difference()) > 0.01);
  assert.equal(await frame(), await lastFrame());
  await page.locator('#scrub').fill('0');
  assert.equal(await difference(), 0);
});

test('buttons and arrow keys go one frame on and back', async () => {
  await seek(10);
  await page.locator('#forward').click();
  assert.equal(await frame(), 11);
  await page.locator('#back').click();
  await page.locator('#back').click();
  assert.equal(await frame(), 9);
  await page.keyboard.press('ArrowRight');
  assert.equal(await frame(), 10);
  // The clock follows with the next picture.
  await page.waitForFunction(() => / frame 10 /.test(document.querySelector('#clock').textContent));
});

test('the space bar plays and pauses', async () => {
  await seek(0);
  await page.locator('#canvas').click({ position: { x: 5, y: 200 } });
  await page.keyboard.press('Space');
  await page.waitForFunction(() => window.fulcrum.frame > 1);
  await page.keyboard.press('Space');
  assert.equal(await page.evaluate(() => window.fulcrum.playing), false);
});

test('slow motion shows moments between the frames', async () => {
  await seek(0);
  await page.locator('#speed').selectOption('0.05');
  await page.locator('#play').click();
  await page.waitForFunction(() => window.fulcrum.frame % 1 > 0);
  await seek(0);
  await page.locator('#speed').selectOption('1');
});

test('each way to color makes another picture', async () => {
  await seek(Math.floor((await lastFrame()) / 3));
  for (const [first, second] of [['plain', 'speed'], ['speed', 'awake'], ['awake', 'plain']]) {
    await page.locator(`#colors input[value=${first}]`).check();
    await keepPicture();
    await page.locator(`#colors input[value=${second}]`).check();
    assert.ok((await difference()) > 0.01, `${first} and ${second} look the same`);
  }
  await page.locator('#colors input[value=island]').check();
});

test('each switch changes the picture and changes it back', async () => {
  await seek(await lastFrame());
  for (const what of ['contacts', 'normals', 'bounds', 'grid']) {
    await keepPicture();
    await page.locator(`#toggles input[value=${what}]`).click();
    assert.ok((await difference()) > 0.001, `${what} shows nothing`);
    await page.locator(`#toggles input[value=${what}]`).click();
    assert.equal(await difference(), 0, `${what} leaves something behind`);
  }
});

test('a click on a body tells what it is', async () => {
  await seek(0);
  const body = await placeOfABody();
  assert.ok(body, 'no dynamic body in sight');
  await page.keyboard.press('Escape');
  await drawn();
  assert.match(await page.locator('#body').textContent(), /Click a body/);
  await keepPicture();
  await page.locator('#canvas').click({ position: { x: body.x, y: body.y } });
  assert.ok((await difference()) > 0.0002, 'the body is not marked');
  const value = (label) => page.locator(`#body dt:text-is("${label}") + dd`).textContent();
  assert.equal(await value('Id'), String(body.id));
  assert.equal(await value('Shape'), body.shape);
  assert.match(await value('Mass'), /^[\d,.]+ kg$/);
  assert.ok(body.mass > 0);
  assert.match(await value('Velocity'), /m\/s$/);
  assert.match(await value('State'), /^(awake|asleep)$/);
  await page.keyboard.press('Escape');
});

test('the report is beside the picture', async () => {
  assert.ok((await page.locator('#report dt').count()) > 0);
});

test('nothing is wider than the window, however small', async () => {
  for (const width of [360, 600, 820, 1280]) {
    await page.setViewportSize({ width, height: 540 });
    const overflow = await page.evaluate(() => document.documentElement.scrollWidth - window.innerWidth);
    assert.ok(overflow <= 0, `${overflow} pixels too wide at ${width}`);
  }
});

test('still no complaint after all that; a picture is kept', async () => {
  await page.setViewportSize({ width: 1280, height: 720 });
  await seek(Math.floor((await lastFrame()) / 2));
  await drawn();
  await page.screenshot({ path: screenshot });
  assert.deepEqual(complaints, []);
});
