// What is between the bodies and a picture to show: ambient occlusion, labels that make room, round and sharp hulls, the ground.
import assert from 'node:assert/strict';
import { after, before, test } from 'node:test';
import { raises } from '../Page/labels.js';
import { GeometryChoice } from '../Page/shapes.js';
import { launch, openPage } from './browser.mjs';
import { html } from './recording.mjs';

let browser;
const complaints = [];
before(async () => (browser = await launch()));
after(() => browser?.close());

// A page at its last frame, whose picture is kept.
async function pageWith(settings) {
  const page = await openPage(browser, html, complaints, [], settings);
  await page.evaluate(() => window.fulcrum.seek(window.fulcrum.frameCount - 1));
  await page.evaluate(() => window.keepPicture());
  return page;
}
const pixelsOf = (page) => page.evaluate(() => Array.from(window.kept));

test('ambient occlusion darkens places between bodies, and nothing else gets another light', async () => {
  const plain = await pageWith('occlusion=0'), occluded = await pageWith('occlusion=1');
  const before = await pixelsOf(plain), after = await pixelsOf(occluded);
  let darker = 0, lighter = 0, sky = 0;
  for (let i = 0; i < before.length; i += 4) {
    const change = after[i] + after[i + 1] + after[i + 2] - before[i] - before[i + 1] - before[i + 2];
    if (change < -12) ++darker;
    if (change > 6) ++lighter;
    if (i < before.length / 20 && Math.abs(change) > 3) ++sky; // the uppermost rows
  }
  const pixels = before.length / 4;
  assert.ok(darker > 0.01 * pixels, `only ${darker} of ${pixels} pixels are darker`);
  assert.ok(darker < 0.5 * pixels, `${darker} of ${pixels} pixels are darker`);
  assert.ok(lighter < 0.002 * pixels, `${lighter} pixels are lighter`);
  assert.equal(sky, 0, 'the sky has changed');
  assert.deepEqual(complaints, []);
  await plain.close();
  await occluded.close();
});

test('bodies that are far away do not vanish', async () => {
  // From 15 km the whole pyramid, 36 m high, is less than two pixels high, a box a tenth of one.
  const page = await openPage(browser, html, complaints, [], 'camera=0,15,15000,0,15,0&color=plain');
  const colored = await page.evaluate(() => {
    const pixels = window.pictureNow();
    let count = 0;
    for (let i = 0; i < pixels.length; i += 4) {
      if (Math.max(pixels[i], pixels[i + 1], pixels[i + 2]) - Math.min(pixels[i], pixels[i + 1], pixels[i + 2]) > 40) ++count;
    }
    return count;
  });
  assert.ok(colored >= 6, `${colored} pixels are colored`);
  await page.close();
});

test('labels that would be over each other stand on top of each other', () => {
  const label = (x, y) => ({ x, y, width: 40, height: 16 });
  assert.deepEqual(raises([label(0, 0), label(50, 0), label(100, 3)]), [0, 0, 0]);
  const [first, second, third] = raises([label(0, 0), label(10, 2), label(20, 4)]);
  assert.equal(first, 0);
  assert.ok(2 + second >= 16 && 4 + third >= 2 + second + 16);
  // No two of many at random places overlap.
  let seed = 1;
  const random = () => (seed = (seed * 48271) % 2147483647) / 2147483647;
  const many = Array.from({ length: 10 }, () => label(120 * random(), 40 * random())).sort((a, b) => a.y - b.y);
  const placed = many.map((each, i, all) => ({ ...each, y: each.y + raises(all)[i] }));
  placed.forEach((a, i) => placed.slice(i + 1).forEach((b) => assert.ok(Math.abs(a.x - b.x) >= 40 || Math.abs(a.y - b.y) >= 16, `${a.x},${a.y} is over ${b.x},${b.y}`)));
});

// The largest angle between a corner's normal and its face's, degrees.
function bendOf(shape) {
  const geometry = new GeometryChoice(1, [shape]).of(shape, true).make(), { position, normal } = geometry.attributes;
  let largest = 0;
  for (let face = 0; face < position.count; face += 3) {
    const corner = (k, of) => [of.getX(face + k), of.getY(face + k), of.getZ(face + k)];
    const [a, b, c] = [0, 1, 2].map((k) => corner(k, position)), u = b.map((x, i) => x - a[i]), v = c.map((x, i) => x - a[i]);
    const own = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]], length = Math.hypot(...own);
    for (const k of [0, 1, 2]) {
      const cosine = corner(k, normal).reduce((sum, x, i) => sum + (x * own[i]) / length, 0);
      largest = Math.max(largest, (Math.acos(Math.min(1, cosine)) * 180) / Math.PI);
    }
  }
  return largest;
}

test('hulls have edges where they bend, and are round elsewhere', () => {
  const cube = {
    kind: 'hull', vertices: [0, 1, 2, 3, 4, 5, 6, 7].map((i) => [i & 1, (i >> 1) & 1, i >> 2]),
    triangles: [[0, 2, 1], [1, 2, 3], [4, 5, 6], [5, 7, 6], [0, 1, 4], [1, 5, 4], [2, 6, 3], [3, 6, 7], [0, 4, 2], [2, 4, 6], [1, 3, 5], [3, 7, 5]],
  };
  assert.ok(bendOf(cube) < 0.1);
  const sides = 24, ring = (y) => Array.from({ length: sides }, (_, i) => [Math.cos((2 * Math.PI * i) / sides), y, -Math.sin((2 * Math.PI * i) / sides)]);
  const tube = {
    kind: 'hull', vertices: [...ring(0), ...ring(1)],
    triangles: Array.from({ length: sides }, (_, i) => [[i, (i + 1) % sides, sides + i], [(i + 1) % sides, sides + ((i + 1) % sides), sides + i]]).flat(),
  };
  assert.ok(Math.abs(bendOf(tube) - 7.5) < 2.6, `${bendOf(tube)}`);
});
