// The report of the accuracy lab: a plot a scene, its curves, what hovering says; and where its points are.
// FULCRUM_RECORDING's folder has accuracy/report.html, of `./fulcrum accuracy --quick --scene incline --record "soft 1/60 4 1 1"`.
import assert from 'node:assert/strict';
import { existsSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { after, before, test } from 'node:test';
import { pathToFileURL } from 'node:url';
import { PLOT, drawnOf, envelopeOf, labelsOf, placesOfLabels } from '../../../PerformanceTest/Accuracy/Report/points.mjs';
import { launch, newPage } from './browser.mjs';
import { html } from './recording.mjs';

const report = join(dirname(html), 'accuracy', 'report.html');
if (!existsSync(report)) throw new Error(`${report} is missing: run ./fulcrum accuracy --quick --scene incline --record "soft 1/60 4 1 1"`);

let browser, page;
const complaints = [], requests = [];
before(async () => {
  browser = await launch();
  page = await newPage(browser, { viewport: { width: 1320, height: 900 } });
  page.on('console', (message) => ['error', 'warning'].includes(message.type()) && complaints.push(message.text()));
  page.on('pageerror', (error) => complaints.push(error.message));
  page.on('request', (request) => requests.push(request.url()));
  await page.goto(pathToFileURL(report).href);
});
after(() => browser?.close());

const plotOf = (scene) => page.locator(`[id="${scene}"] svg`);

test('every scene has one plot with its runs, curves and presets', async () => {
  const scenes = await page.evaluate(() => JSON.parse(document.getElementById('runs').textContent).scenes);
  assert.deepEqual(scenes.map(({ name }) => name), ['incline.slide', 'incline.stick']);
  for (const { name, runs } of scenes) {
    await page.locator(`[id="${name}"]`).scrollIntoViewIfNeeded();
    const plot = plotOf(name);
    await plot.waitFor();
    assert.equal(await plot.count(), 1);
    assert.equal(await plot.locator('.runs path, .runs circle').count(), runs.length);
    assert.equal(await plot.locator('.presets circle').count(), 4);
    for (const family of ['soft', 'baumgarte', 'libccd']) assert.equal(await plot.locator(`.curve.${family}`).count(), 1, family);
    assert.equal(await plot.locator('.envelope path').count(), 1);
    for (const label of ['fast', 'default', 'accurate', 'reference', 'Box3D', 'Bullet']) {
      assert.ok(await plot.getByText(label, { exact: true }).isVisible(), `${name} has no ${label}`);
    }
  }
});

test('no label of a plot covers another', async () => {
  for (const name of ['incline.slide', 'incline.stick']) {
    const labels = await plotOf(name).locator('text').evaluateAll((all) => all.map((label) => {
      const { left, right, top, bottom } = label.getBoundingClientRect();
      return { text: label.textContent, left, right, top, bottom };
    }));
    const overlaps = (a, b) => Math.min(a.right, b.right) - Math.max(a.left, b.left) > 1 && Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top) > 1;
    for (const [i, a] of labels.entries()) for (const b of labels.slice(i + 1)) assert.ok(!overlaps(a, b), `${name}: ${a.text} on ${b.text}`);
  }
});

test('labels find places beside crowded dots and at the edges', () => {
  const edges = { left: 100, right: 10000, top: 1, bottom: 1e-4 };
  const places = (points) => placesOfLabels(points.map(([cost, error, text]) => ({ point: { cost, error }, text })), edges);
  // In the middle, above its dot.
  assert.deepEqual(places([[1000, 1e-2, 'default']]).map(({ textAnchor, dx, dy }) => [textAnchor, dx, dy]), [['middle', 0, -15]]);
  // At the left edge its label is not over the numbers of the axis, at the upper edge not over the frame's.
  const [fast] = places([[101, 1e-3, 'fast']]);
  assert.ok(fast.x + fast.dx - (fast.textAnchor === 'middle' ? 3.3 * 4 : 0) >= PLOT.left && fast.textAnchor !== 'end', JSON.stringify(fast));
  const [high] = places([[1000, 0.99, 'default']]);
  assert.ok(high.dy >= 0, JSON.stringify(high));
  // Four at one place are all apart.
  const four = places(['default', 'fast', 'accurate', 'reference'].map((text) => [1000, 1e-2, text]));
  assert.equal(new Set(four.map(({ textAnchor, dx, dy }) => `${textAnchor} ${dx} ${dy}`)).size, 4);
});

test('hovering a run names its setting', async () => {
  const dot = await page.locator('[id="incline.slide"] .presets circle').nth(1).boundingBox();
  await page.mouse.move(dot.x + dot.width / 2, dot.y + dot.height / 2);
  const tip = page.locator('[id="incline.slide"] .hover');
  await tip.locator('text').first().waitFor();
  assert.match((await tip.textContent()).replaceAll('\u200b', '\n'), /dt 1\/60 s, 4 substeps\s+1 velocity, 1 position/);
});

test('a run that was recorded is played by a click, others say how to record them', async () => {
  const tip = page.locator('[id="incline.slide"] .hover');
  const hover = async (nth) => {
    const dot = await page.locator('[id="incline.slide"] .presets circle').nth(nth).boundingBox();
    await page.mouse.move(dot.x + dot.width / 2, dot.y + dot.height / 2);
    await tip.locator('text').first().waitFor();
    return (await tip.textContent()).replaceAll('\u200b', '\n');
  };
  const titles = [];
  for (const nth of [0, 1, 2, 3]) titles.push(await hover(nth));
  assert.ok(titles.some((title) => title.includes('click: plays its recording')), titles.join());
  assert.ok(titles.some((title) => /to record it: --record "soft 1\/60 \d+ 1 1"/.test(title)), titles.join());
  const links = plotOf('incline.slide').locator('.recordings a');
  assert.equal(await links.count(), 1);
  const [played] = await Promise.all([page.waitForEvent('popup'), links.click()]);
  await played.waitForFunction(() => window.fulcrum);
  assert.match(played.url(), /accuracy\/recordings\/incline\.slide_soft_1-60_4_1_1\.html$/);
  assert.match(await played.textContent('body'), /incline\.slide/);
  await played.close();
});

test('other errors, other costs', async () => {
  const label = () => plotOf('incline.slide').locator('[aria-label="y-axis label"], [aria-label="x-axis label"]').allTextContents();
  await page.locator('[id="incline.slide"] .metric').selectOption('way');
  assert.ok((await label()).includes('↑ way'), await label());
  await page.locator('#cost').selectOption('traversals_per_second');
  assert.ok((await label()).includes('traversals per simulated second →'));
  await page.locator('#reference').selectOption('self');
  assert.ok((await label()).includes('↑ difference from the finest setting'));
});

test('the page needs nothing else and complains of nothing', () => {
  assert.deepEqual(complaints, []);
  assert.deepEqual(requests.filter((url) => !url.startsWith('data:')), [pathToFileURL(report).href]);
});

const run = (cost, error, more = {}) => ({
  us_per_second: cost, traversals_per_second: 2 * cost, errors: { way: error }, self_error: null, blew_up: false, family: 'soft',
  preset: '', rate: 60, substeps: 4, velocity_iterations: 1, position_iterations: 1, timed_runs: 5, failed_conditions: [], ...more,
});

test('runs that blew up are at the upper edge, exact ones at the lower', () => {
  const runs = [run(100, 0.2), run(300, 0.3), run(200, 0.05), run(50, null, { blew_up: true }), run(900, 0)];
  const { points, envelope, top, bottom } = drawnOf({ runs }, { cost: 'us_per_second', metric: 'way' });
  assert.deepEqual(points.map(({ kind }) => kind), ['run', 'run', 'run', 'blew up', 'exact']);
  assert.equal(points[3].error, top);
  assert.equal(points[4].error, bottom);
  assert.ok(bottom < 0.05 && top > 0.3);
  assert.deepEqual(envelope.map(({ cost }) => cost), [100, 200, 900]);
  assert.match(points[3].title, /blew up/);
  assert.deepEqual(drawnOf({ runs }, { cost: 'traversals_per_second', metric: 'way' }).envelope.map(({ cost }) => cost), [200, 400, 1800]);
});

test('each family has its own curve', () => {
  const runs = [run(100, 0.2), run(200, 0.1), run(90, 0.5, { family: 'baumgarte' })];
  const { curves } = drawnOf({ runs }, { cost: 'us_per_second', metric: 'way' });
  assert.deepEqual(curves.map(({ family, points }) => [family, points.length]), [['soft', 2], ['baumgarte', 1]]);
  assert.deepEqual(envelopeOf([]), []);
});

test('runs in another engine have a curve, and are in no envelope', () => {
  const peer = { engine: 'Bullet 3.24', family: 'bullet', velocity_iterations: 10, traversals_per_second: null };
  const runs = [run(100, 0.2), run(50, 0.01, { ...peer, preset: 'default' }), run(40, 0.1, { ...peer, rate: 30 })];
  const drawn = drawnOf({ runs }, { cost: 'us_per_second', metric: 'way' });
  assert.deepEqual(drawn.envelope.map(({ cost }) => cost), [100]);
  assert.deepEqual(drawn.curves.map(({ family, points }) => [family, points.length]), [['soft', 1], ['bullet', 2]]);
  assert.match(drawn.points[1].title, /^Bullet 3\.24, its default\ndt 1\/60 s, 10 iterations\nway 0\.01\n50 µs a second \(of 5\)\n/);
  assert.match(drawn.points[2].title, /^Bullet 3\.24\ndt 1\/30 s/);
  assert.equal(drawnOf({ runs }, { cost: 'traversals_per_second', metric: 'way' }).points.length, 1);
});

test('lines of other engines that are near each other share a label', () => {
  const peers = [{ error: 1, engine: 'Jolt 5.5.1' }, { error: 0.01, engine: 'Box3D 0.2.0' }, { error: 1.1, engine: 'Bullet 3.24' }];
  assert.deepEqual(labelsOf(peers, 1e4), [{ error: 0.01, label: 'Box3D' }, { error: 1, label: 'Jolt, Bullet' }]);
});
