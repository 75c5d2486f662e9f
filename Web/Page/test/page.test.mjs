// The live page in headless Chromium: a pile falls, a drag moves a body, a shot hits, the sliders act, and the hashes are those of the
// package in node, with one thread and with several. `./fulcrum test` builds the page.
import assert from 'node:assert/strict';
import { spawn } from 'node:child_process';
import { existsSync } from 'node:fs';
import { readFile } from 'node:fs/promises';
import { createServer } from 'node:http';
import test, { after, before } from 'node:test';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { load } from '../../Package/src/node.js';
import { PRESETS, SLIDERS } from '../effort.js';

// The viewer's tests have the browser.
const { launch, newPage } = await import(pathToFileURL(fileURLToPath(new URL('../../../Samples/Viewer/test/browser.mjs', import.meta.url))));
const pathOf = (name) => fileURLToPath(new URL(name, import.meta.url));
const html = pathOf('../../../build/webassembly/Web/web.html');

let browser, complaints = [], requests = [];
before(async () => {
  assert.ok(existsSync(html), `${html} is missing: ./fulcrum web builds it`);
  browser = await launch();
});
after(() => browser?.close());

async function open(address) {
  const page = await newPage(browser, { viewport: { width: 900, height: 500 } });
  page.on('console', (message) => ['error', 'warning'].includes(message.type()) && complaints.push(message.text()));
  page.on('pageerror', (error) => complaints.push(error.message));
  page.on('request', (request) => requests.push(request.url()));
  await page.goto(address);
  await page.waitForFunction(() => window.fulcrum || /cannot/.test(document.getElementById('message').textContent));
  assert.equal(await page.textContent('#message'), '');
  return page;
}
const hashIn = (page, scene, steps) => page.evaluate(([name, count]) => {
  window.fulcrum.start(name);
  window.fulcrum.step(count);
  return window.fulcrum.world.hashPoses().toString(16);
}, [scene, steps]);
async function hashInNode(scene, steps) {
  const world = (await load()).createScene(scene, { measuresErrors: true });
  for (let step = 0; step < steps; ++step) world.step(1 / 60);
  return world.hashPoses().toString(16);
}

test('a pile falls while the page plays, and hashes are those of node', { timeout: 600000 }, async () => {
  const page = await open(`${pathToFileURL(html)}#scene=pyramid&paused=1&theme=light`);
  const height = () => page.evaluate(() => {
    const { count, positions } = window.fulcrum.world.bodies.readAll();
    return positions[3 * (count - 1) + 1];
  });
  const before = await height();
  await page.evaluate(() => window.fulcrum.play());
  await page.waitForFunction(() => window.fulcrum.steps > 3);
  await page.evaluate(() => { window.fulcrum.play(false); window.fulcrum.step(40); });
  assert.ok(await height() < before - 1, 'the top of the pyramid fell');
  assert.match(await page.textContent('#clock'), /step \d+/);
  assert.match(await page.textContent('#summary'), /ms.*penetration/s);
  assert.equal(await hashIn(page, 'pyramid', 30), await hashInNode('pyramid', 30));
  await page.close();
});

test('a drag moves a body, and what is beside bodies turns the camera', { timeout: 600000 }, async () => {
  const page = await open(`${pathToFileURL(html)}#scene=dominoes&paused=1`);
  const target = await page.evaluate(() => {
    const { bodies } = window.fulcrum.world, all = bodies.readAll();
    for (let index = 0; index < all.count; ++index) {
      if ((all.flags[index] & 13) !== 1) continue;
      const id = all.idAt(index), at = bodies.read(id).position, [x, y] = window.fulcrum.project(at);
      if (document.elementFromPoint(x, y)?.id === 'canvas') return { id, at, x, y };
    }
    return undefined;
  });
  await page.mouse.move(target.x, target.y);
  await page.mouse.down();
  assert.equal(await page.evaluate(() => window.fulcrum.isHolding), true);
  await page.mouse.move(target.x, target.y - 80, { steps: 4 });
  await page.evaluate(() => window.fulcrum.step(45));
  // What is in front of the body that was meant is as good.
  const moved = await page.evaluate(() => {
    const all = window.fulcrum.world.bodies.readAll();
    return Math.max(...Array.from({ length: all.count }, (_, i) => all.positions[3 * i + 1]));
  });
  await page.mouse.up();
  assert.equal(await page.evaluate(() => window.fulcrum.isHolding), false);
  assert.ok(moved > target.at[1] + 0.05, `${moved} is above ${target.at[1]}`);
  await page.close();
});

test('a shot adds a body that is drawn and hits', { timeout: 600000 }, async () => {
  const page = await open(`${pathToFileURL(html)}#scene=card_house&paused=1`);
  const count = () => page.evaluate(() => window.fulcrum.world.report.bodies);
  await page.evaluate(() => window.fulcrum.step(2));
  const before = await count();
  const box = await page.locator('#canvas').boundingBox();
  await page.mouse.move(box.x + box.width / 2, box.y + box.height / 2);
  await page.evaluate(() => { window.fulcrum.shoot(); window.fulcrum.step(30); });
  assert.equal(await count(), before + 1);
  // One right after the other, in a standing world: none in another.
  const apart = await page.evaluate(() => {
    const { world } = window.fulcrum, first = world.bodies.readAll().count;
    for (let i = 0; i < 4; ++i) window.fulcrum.shoot();
    const { count: last, positions } = world.bodies.readAll();
    const places = Array.from({ length: last - first }, (_, i) => positions.slice(3 * (first + i), 3 * (first + i) + 3));
    const radius = 0.75 * window.fulcrum.typical;
    return places.flatMap((a, i) => places.slice(i + 1).map((b) => Math.hypot(...a.map((x, k) => x - b[k])) / radius));
  });
  assert.equal(apart.length, 6, 'each shot is a ball');
  assert.ok(Math.min(...apart) > 2, `${apart}`);
  await page.close();
});

// The share of the canvas' pixels that change as what the page shows of this kind is switched off.
const shareOf = (page, what) => page.evaluate((kind) => {
  const source = document.getElementById('canvas');
  const pixels = () => {
    const copy = Object.assign(document.createElement('canvas'), { width: source.width, height: source.height });
    const context = copy.getContext('2d', { willReadFrequently: true });
    context.drawImage(source, 0, 0);
    return context.getImageData(0, 0, copy.width, copy.height).data;
  };
  window.fulcrum.show(kind, true);
  const before = pixels();
  window.fulcrum.show(kind, false);
  const after = pixels();
  window.fulcrum.show(kind, true);
  const differs = (i) => [0, 1, 2].reduce((sum, k) => sum + Math.abs(before[i + k] - after[i + k]), 0) > 24;
  let changed = 0;
  for (let i = 0; i < before.length; i += 4) if (differs(i)) ++changed;
  return changed / (before.length / 4);
}, what);

test('joints, labels and what a scene draws are shown, and follow the world', { timeout: 600000 }, async () => {
  const page = await open(`${pathToFileURL(html)}#scene=springs&paused=1`);
  const labels = () => page.evaluate(() => window.fulcrum.picture.labels.labels.map(({ sprite }) => [sprite.visible, ...sprite.position.toArray()]));
  const before = await labels();
  assert.ok(before.length >= 9 && before.every(([visible]) => visible), 'five frequencies, four dampings');
  assert.ok(await shareOf(page, 'labels') > 0.005);
  assert.ok(await shareOf(page, 'joints') > 0.005);
  await page.evaluate(() => window.fulcrum.step(10));
  const moved = (await labels()).filter(([, x, y, z], i) => Math.hypot(x - before[i][1], y - before[i][2], z - before[i][3]) > 0.01).length;
  assert.ok(moved > 4, `${moved} labels moved with what they name`);

  await page.evaluate(() => { window.fulcrum.start('hinge'); window.fulcrum.step(60); });
  const gaps = await page.evaluate(() => {
    const { joints, live } = window.fulcrum.picture;
    return live.recording.joints.map((joint) => joints.error(joint, joint.states.at(-1).limits));
  });
  assert.equal(gaps.length, 5);
  for (const { distance, angle } of gaps) assert.ok(distance < 1e-3 && angle < 1e-3, 'both frames of each hinge are where its bodies are');

  // The winch shortens its rope in each step.
  await page.evaluate(() => window.fulcrum.start('pulley'));
  const ropes = () => page.evaluate(() => window.fulcrum.picture.live.recording.joints.map(({ states }) => states.at(-1).limits[0][1]));
  const long = await ropes();
  await page.evaluate(() => window.fulcrum.step(60));
  assert.equal((await ropes()).filter((length, i) => Math.abs(length - long[i]) > 0.01).length, 1);

  await page.evaluate(() => { window.fulcrum.start('query_rays'); window.fulcrum.step(2); });
  assert.ok(await shareOf(page, 'drawings') > 0.005);
  // A ball more, and with it the picture is made anew.
  await page.evaluate(() => { window.fulcrum.start('hinge'); window.fulcrum.show('joints', false); window.fulcrum.shoot(); window.fulcrum.step(1); });
  assert.equal(await page.evaluate(() => window.fulcrum.picture.joints.visible), false, 'what was switched off stays off');
  assert.equal(await page.isChecked('#toggles input[value=joints]'), false);
  await page.close();
});

test('the presets are those of the engine, and the sliders reach them', async () => {
  const header = await readFile(pathOf('../../../Physics/Settings.h'), 'utf8');
  const presets = [...header.matchAll(/static constexpr SolverSettings (\w+)\(\) \{[^{}]*return \{(?:\.substeps = (\d+))?\}/g)];
  const substepsOfDefault = Number(header.match(/int substeps = (\d+);/)[1]);
  assert.deepEqual(PRESETS.map(({ label, solver }) => [label, solver.substeps]), presets.map(([, name, substeps]) => [name, Number(substeps ?? substepsOfDefault)]));
  const { places } = SLIDERS.find(({ id }) => id === 'substeps');
  for (const { solver } of PRESETS) assert.ok(places.includes(solver.substeps), `no place for ${solver.substeps} substeps`);
});

test('the sliders act', { timeout: 600000 }, async () => {
  const page = await open(`${pathToFileURL(html)}#scene=pyramid&paused=1`);
  const set = (id, place) => page.evaluate(([name, value]) => {
    const input = document.getElementById(`slider-${name}`);
    input.value = value;
    input.dispatchEvent(new Event('input'));
  }, [id, place]);
  const settings = () => page.evaluate(() => window.fulcrum.world.settings);
  await set('substeps', 0);
  assert.equal((await settings()).solver.substeps, 1);
  await page.evaluate(() => window.fulcrum.step(150));
  const coarse = await page.evaluate(() => window.fulcrum.report.largestPenetration);
  await page.click('#presets button:nth-child(3)');
  assert.deepEqual((({ substeps, velocityIterations, positionIterations }) => [substeps, velocityIterations, positionIterations])((await settings()).solver), [16, 1, 1]);
  await page.evaluate(() => window.fulcrum.step(60));
  const fine = await page.evaluate(() => window.fulcrum.report.largestPenetration);
  assert.ok(fine < 0.7 * coarse, `${fine} m with 16 substeps, ${coarse} m with one`);
  await set('penetration', 17);
  await set('joint', 0);
  const { accuracy } = await settings();
  assert.equal(accuracy.penetration, Infinity);
  assert.ok(Math.abs(accuracy.jointError - 1e-4) < 1e-9);
  await set('rate', 9);
  const passed = await page.evaluate(() => {
    const text = () => Number(document.getElementById('clock').textContent.split(' ')[0]);
    const from = text();
    window.fulcrum.step(24);
    return text() - from;
  });
  assert.ok(Math.abs(passed - 0.1) < 0.011, `24 steps of 1/240 s are ${passed} s`);
  await page.close();
});

test('an isolated page has threads and the same hashes', { timeout: 600000 }, async () => {
  const server = spawn(process.execPath, [pathOf('../serve.mjs'), html, '0'], { stdio: ['ignore', 'pipe', 'inherit'] });
  try {
    const address = await new Promise((resolve) => server.stdout.on('data', (text) => resolve(String(text).match(/http\S+/)[0])));
    const page = await open(`${address}#scene=pyramid&paused=1&threads=2`);
    assert.equal(await page.evaluate(() => window.fulcrum.world.threads), 2);
    assert.equal(await hashIn(page, 'pyramid', 30), await hashInNode('pyramid', 30));
    await page.close();
  } finally {
    server.kill();
  }
});

test('the package loads in pages, isolated with threads, else without', { timeout: 600000 }, async () => {
  const types = { js: 'text/javascript', cjs: 'text/javascript', wasm: 'application/wasm' };
  const isolated = { 'Cross-Origin-Opener-Policy': 'same-origin', 'Cross-Origin-Embedder-Policy': 'require-corp' };
  const server = createServer(async (request, response) => {
    const [, kind, name] = request.url.match(/^\/(alone|open)\/(.*)$/) ?? [];
    response.writeHead(200, { 'Content-Type': types[name?.split('.').at(-1)] ?? 'text/html', ...(kind === 'alone' ? isolated : {}) });
    response.end(name ? await readFile(pathOf(`../../Package/${name}`)) : '<!doctype html><title>package</title><link rel="icon" href="data:,">');
  });
  await new Promise((resolve) => server.listen(0, '127.0.0.1', resolve));
  try {
    for (const [kind, threads] of [['alone', 2], ['open', 1]]) {
      const page = await newPage(browser);
      page.on('pageerror', (error) => complaints.push(error.message));
      await page.goto(`http://localhost:${server.address().port}/${kind}/`);
      const found = await page.evaluate(async () => {
        const { load } = await import('./src/index.js');
        const fulcrum = await load({ base: new URL('./dist/', location.href), threads: 2 });
        const world = fulcrum.createScene('hinge');
        for (let step = 0; step < 30; ++step) world.step();
        return [world.threads, world.hashPoses().toString(16)];
      });
      assert.deepEqual(found, [threads, await hashInNode('hinge', 30)]);
      await page.close();
    }
  } finally {
    server.close();
  }
});

// A step waits for the other threads on the page's own, some milliseconds: emscripten warns of that once.
const isWait = (complaint) => complaint.startsWith('Blocking on the main thread');

test('the page complains of nothing and asks no network', () => {
  assert.deepEqual(complaints.filter((complaint) => !isWait(complaint)), []);
  for (const request of requests) assert.match(request, /^(file:|blob:|data:|http:\/\/localhost:)/);
});
