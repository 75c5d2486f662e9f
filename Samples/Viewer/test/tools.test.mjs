// What the page offers beside playing: curves that seek and name the bodies to blame, labels, following, loop, themes, saving; the
// camera that has all in the picture; texts that are never over it.
import assert from 'node:assert/strict';
import { statSync } from 'node:fs';
import { after, before, test } from 'node:test';
import { launch, openPage } from './browser.mjs';
import { hingeHtml, html, springsHtml } from './recording.mjs';

let browser, page;
const complaints = [];
before(async () => {
  browser = await launch();
  page = await openPage(browser, html, complaints);
  await page.setViewportSize({ width: 1000, height: 560 });
  await page.evaluate(() => window.drawn());
});
after(() => browser?.close());

const fulcrum = (expression) => page.evaluate(`window.fulcrum.${expression}`);
const seek = (frame) => page.evaluate((wanted) => window.fulcrum.seek(wanted), frame);
const boxOf = (on, selector) => on.locator(selector).boundingBox();
const press = (key) => page.keyboard.press(key);
const overlap = (a, b) => Math.min(a.x + a.width, b.x + b.width) - Math.max(a.x, b.x) > 0.5 && Math.min(a.y + a.height, b.y + b.height) - Math.max(a.y, b.y) > 0.5;

test('a click on a curve goes to its moment', async () => {
  await page.locator('#curve-energy').scrollIntoViewIfNeeded();
  const over = await boxOf(page, '#curve-energy .u-over');
  const last = (await fulcrum('frameCount')) - 1;
  for (const part of [0.25, 0.75]) {
    await page.mouse.click(over.x + part * over.width, over.y + over.height / 2);
    const frame = await fulcrum('frame');
    assert.ok(Math.abs(frame - part * last) <= 2, `frame ${frame} of ${last} at ${part}`);
    await page.evaluate(() => window.drawn());
    const head = await boxOf(page, '#curve-energy .playhead');
    assert.ok(Math.abs(head.x - over.x - part * over.width) < 4, 'the playhead is elsewhere');
  }
});

test('the worst penetration is a click away, and its bodies another', async () => {
  await seek(0);
  await page.evaluate(() => window.drawn());
  await page.locator('#curve-penetration .culprit button', { hasText: 'go to the largest' }).click();
  assert.ok((await fulcrum('frame')) > 0);
  const selected = await fulcrum('selected');
  assert.ok(selected >= 0);
  await page.evaluate(() => window.drawn());
  const names = await page.locator('#curve-penetration .culprit button').allTextContents();
  assert.equal(names.length, 3);
  assert.match(names[0], new RegExp(`^box ${selected}$`));
  await page.locator('#curve-penetration .culprit button').nth(1).click();
  assert.match(names[1], new RegExp(` ${await fulcrum('selected')}$`));
  await press('Escape');
  assert.equal(await fulcrum('selected'), -1);
});

test('the camera has every body in the picture over the whole run', async () => {
  for (const width of [1000, 420]) {
    const other = await openPage(browser, html);
    await other.setViewportSize({ width, height: 560 });
    await other.evaluate(() => window.drawn());
    await other.keyboard.press('r');
    const outside = await other.evaluate(() => {
      const { fulcrum } = window;
      let count = 0, most = 0;
      for (const part of [0, 0.3, 0.6, 1]) {
        fulcrum.seek(part * (fulcrum.frameCount - 1));
        for (let body = 0; body < fulcrum.bodyCount; ++body) {
          const { motion, position } = fulcrum.body(body);
          if (motion !== 'dynamic') continue;
          const [x, y] = fulcrum.project(...position);
          if (Math.abs(x) > 1 || Math.abs(y) > 1) ++count;
          most = Math.max(most, Math.abs(x), Math.abs(y));
        }
      }
      return { count, most };
    });
    assert.equal(outside.count, 0, `${outside.count} are outside`);
    assert.ok(outside.most > 0.5, `the picture is nearly empty: ${outside.most}`);
    await other.close();
  }
});

test('a moment by itself fills the picture, too', async () => {
  // The pyramid sinks by the gaps between its layers: at the end it leaves room above.
  const heights = await page.evaluate(() => {
    const { fulcrum } = window, top = () => Math.max(...[...Array(fulcrum.bodyCount).keys()].map((body) => fulcrum.project(...fulcrum.body(body).position)[1]));
    fulcrum.seek(fulcrum.frameCount - 1);
    const whole = top();
    fulcrum.fit();
    return { whole, fitted: top(), frame: fulcrum.frame, last: fulcrum.frameCount - 1 };
  });
  assert.equal(heights.frame, heights.last);
  assert.ok(heights.fitted > heights.whole + 0.05 && heights.fitted < 1, JSON.stringify(heights));
  await press('r');
});

test('no text is over the picture, on a desk and on a phone', async () => {
  await page.evaluate(() => window.fulcrum.color('island'));
  for (const width of [1280, 820, 390]) {
    await page.setViewportSize({ width, height: 700 });
    const canvas = await boxOf(page, '#canvas');
    for (const text of ['#heading', '#transport', '#legend']) {
      const box = await boxOf(page, text);
      assert.ok(box && !overlap(canvas, box), `${text} is over the picture at ${width}`);
    }
    assert.ok(canvas.height > 250, `the picture is only ${canvas.height} pixels high at ${width}`);
  }
  // On a phone the slider has a row of its own, and buttons are large enough for a finger.
  const [slider, play] = [await boxOf(page, '#scrub'), await boxOf(page, '#play')];
  assert.ok(slider.y + slider.height <= play.y + 1 && slider.width > 340);
  assert.ok(play.width >= 40 && play.height >= 40);
  await page.setViewportSize({ width: 1000, height: 560 });
});

test('the camera goes with the body that it follows, and stays when it is let go', async () => {
  await seek(0);
  await page.evaluate(() => window.fulcrum.select(window.fulcrum.bodyCount - 1));
  await press('f');
  assert.equal(await page.locator('#follow').getAttribute('aria-pressed'), 'true');
  const offset = () => page.evaluate(() => {
    const { position } = window.fulcrum.body(window.fulcrum.selected), target = window.fulcrum.camera().slice(3);
    return Math.hypot(...target.map((x, k) => x - position[k]));
  });
  assert.ok((await offset()) < 1e-3);
  await seek(60);
  assert.ok((await offset()) < 1e-3, 'the body left the camera behind');
  await press('f');
  const before = await fulcrum('camera()');
  await seek(0);
  assert.deepEqual(await fulcrum('camera()'), before);
  await press('Escape');
  await press('r');
});

test('a run that loops begins again', async () => {
  await press('l');
  assert.equal(await page.locator('#loop').getAttribute('aria-pressed'), 'true');
  await seek((await fulcrum('frameCount')) - 3);
  await page.evaluate(() => window.fulcrum.play());
  await page.waitForFunction(() => window.fulcrum.frame < 60);
  assert.equal(await fulcrum('playing'), true);
  await press('Space');
  await press('l');
});

test('the keys are a key away', async () => {
  await press('?');
  assert.ok(await page.locator('#keys').isVisible());
  assert.match(await page.locator('#keys').textContent(), /full screen/);
  await press('Escape');
  assert.ok(!(await page.locator('#keys').isVisible()));
  const mode = await fulcrum('mode');
  await press('c');
  assert.notEqual(await fulcrum('mode'), mode);
});

test('dark is dark, and light again', async () => {
  const brightness = () => page.evaluate(async () => {
    await window.drawn();
    const pixels = window.pictureNow();
    let sum = 0;
    for (let i = 0; i < pixels.length; i += 4) sum += pixels[i] + pixels[i + 1] + pixels[i + 2];
    const [r] = getComputedStyle(document.body).backgroundColor.match(/\d+/g).map(Number);
    return { picture: sum / (0.75 * pixels.length), paper: r };
  });
  const light = await brightness();
  await press('d');
  const dark = await brightness();
  assert.ok(dark.picture < 0.6 * light.picture && dark.paper < 60 && light.paper > 200, JSON.stringify({ light, dark }));
  await press('d');
  assert.deepEqual(await brightness(), light);
});

test('a picture and a video are saved', async () => {
  const picture = page.waitForEvent('download');
  await press('s');
  const saved = await picture;
  assert.match(saved.suggestedFilename(), /^pyramid_\d+\.png$/);
  assert.ok(statSync(await saved.path()).size > 2000);
  await page.locator('#speed').selectOption('4');
  const video = page.waitForEvent('download');
  await press('v');
  assert.equal(await page.locator('#video').getAttribute('aria-pressed'), 'true');
  const film = await video;
  assert.equal(film.suggestedFilename(), 'pyramid.webm');
  assert.ok(statSync(await film.path()).size > 1000);
  assert.equal(await page.locator('#video').getAttribute('aria-pressed'), 'false');
  await page.locator('#speed').selectOption('1');
});

test('labels stand beside bodies, where the scene gave them', async () => {
  const springs = await openPage(browser, springsHtml, complaints);
  const toggle = springs.locator('#toggles input[value=labels]');
  assert.ok(await toggle.isChecked());
  await springs.evaluate(() => window.keepPicture());
  await toggle.click();
  assert.ok((await springs.evaluate(() => window.differenceToKept())) > 0.002, 'labels show nothing');
  await springs.close();
  const hinge = await openPage(browser, hingeHtml, complaints);
  assert.ok(!(await hinge.locator('#toggles input[value=labels]').isVisible()));
  assert.ok(await hinge.locator('#curve-joint-error').count());
  await hinge.close();
});

test('a scene says how it is colored at first', async () => {
  const plain = await openPage(browser, springsHtml);
  assert.equal(await plain.evaluate(() => window.fulcrum.mode), 'plain');
  await plain.close();
});

test('none of it was complained of', () => assert.deepEqual(complaints, []));
