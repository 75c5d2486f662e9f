// The documents say what Docs/figures.json says, and whoever changes the one without the other is told so.
import assert from 'node:assert/strict';
import { spawnSync } from 'node:child_process';
import { cpSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { dirname, join } from 'node:path';
import { after, beforeEach, test } from 'node:test';
import { fileURLToPath } from 'node:url';

const source = join(dirname(fileURLToPath(import.meta.url)), '../..');
const copy = mkdtempSync(join(tmpdir(), 'fulcrum-figures-'));
after(() => rmSync(copy, { recursive: true }));

const file = (name) => join(copy, name);
const read = (name) => readFileSync(file(name), 'utf8');
const figures = (root, ...options) => spawnSync(process.execPath, [join(root, 'Docs/figures.mjs'), ...options], { encoding: 'utf8' });

function change(name, from, to) {
  const text = read(name);
  assert.ok(text.includes(from), `${name} has no '${from}'`);
  writeFileSync(file(name), text.replace(from, to));
}

beforeEach(() => {
  cpSync(join(source, 'README.md'), file('README.md'));
  cpSync(join(source, 'Docs'), file('Docs'), { recursive: true });
});

test('the documents of this tree agree with the JSON', () => {
  const { status, stderr } = figures(source, '--check');
  assert.equal(status, 0, stderr);
});

test('a figure that was edited in a document is found, and mended', () => {
  for (const [name, from, to] of [['Docs/Performance.md', '| `drum` | ', '| `drum` | 1'], ['Docs/drawings/speed.svg', '>drum<', '>drums<']]) {
    change(name, from, to);
    const { status, stderr } = figures(copy, '--check');
    assert.equal(status, 1);
    assert.match(stderr, new RegExp(`^${name}:\\d+ does not say what Docs/figures.json says`));
    assert.equal(figures(copy).status, 0);
    assert.equal(figures(copy, '--check').status, 0);
    assert.equal(read(name), readFileSync(join(source, name), 'utf8'));
  }
});

test('a figure that was edited in the JSON is found, in the tables and the picture', () => {
  const json = JSON.parse(read('Docs/figures.json'));
  const drum = json.scenes.find(({ name }) => name === 'drum');
  drum.threads[1] = { ...drum.threads[1], ms: 77.7, ratio: 0.777 };
  writeFileSync(file('Docs/figures.json'), JSON.stringify(json));
  const { status, stderr } = figures(copy, '--check');
  assert.equal(status, 1);
  assert.match(stderr, /Docs\/drawings\/speed\.svg/);
  assert.match(stderr, /Docs\/Performance\.md/);
  assert.equal(figures(copy).status, 0);
  assert.match(read('Docs/Performance.md'), /drum.*77\.7/);
  assert.match(read('Docs/drawings/speed.svg'), /drum<[\s\S]*>77\.7 ms</);
});

test('a mark that is lost or misspelt is an error', () => {
  change('Docs/Performance.md', '<!-- figures: scenes -->', '<!-- figures: scene -->');
  assert.match(figures(copy, '--check').stderr, /there are no figures 'scene'/);
  change('Docs/Performance.md', '<!-- figures: scene -->', '');
  assert.match(figures(copy, '--check').stderr, /no document has the figures 'scenes'/);
});

const run = (scene, threads, values) => ({
  scene, threads, median_ms: 10, accuracy: 2, stages_ms: { Solve: 4, Sleep: 0 },
  settings: { substeps: 4, velocity_iterations: 1, position_iterations: 1 }, ...values,
});
function take(runs, bullet) {
  writeFileSync(file('runs.json'), JSON.stringify(runs));
  writeFileSync(file('bullet.json'), JSON.stringify(bullet));
  return figures(copy, '--take', file('runs.json'), '--bullet', file('bullet.json'));
}

test('what the benchmark wrote is taken over', () => {
  const ten = { median_ms: 30, accuracy: 5, settings: { substeps: 1, velocity_iterations: 10, position_iterations: 2 } };
  const { status, stderr } = take([run('drum', 1), run('drum', 2, { median_ms: 6 }), run('drum', 1, ten)], { drum: 40 });
  assert.equal(status, 0, stderr);
  const [picture, performance] = [read('Docs/drawings/speed.svg'), read('Docs/Performance.md')];
  assert.match(picture, /drum<[^]*?>10\.0 ms<[^]*?>Bullet 40 ms<[^]*?>2 through the wall</);
  assert.match(performance, /`drum` \|.*\| 10\.0 \| 6\.00 \| 0\.250 \| 0\.150 \|.*\| 2 through the wall \|/);
  assert.match(performance, /`drum` \| 1 \| – \| – \| – \| – \| – \| – \| 4\.00 \| – \| – \| 10\.0 \|/);
  assert.match(performance, /`drum` \| 0\.250, 0\.150; 2 through the wall \| 0\.750, 0\.\d+; 5 through the wall/);
  assert.equal(figures(copy, '--check').status, 0);
});

test('what the benchmark says of rest is taken over', () => {
  const still = { largest_drift_m: 0.1234, mean_drift_m: 0.0456, end_speed_m_s: 0.0321, asleep_s: 1.25, energy_rise: 0.00078 };
  const driven = { largest_drift_m: null, mean_drift_m: null, end_speed_m_s: 12.5, asleep_s: 'never', energy_rise: null };
  const { status, stderr } = take([run('pyramid', 1, still), run('drum', 1, driven), run('pyramid', 2, driven),
    run('rays', 1, { single_query_ns: 1234.4 })], { pyramid: 40, drum: 40, rays: 40 });
  assert.equal(status, 0, stderr);
  assert.match(read('Docs/Performance.md'), /`pyramid` \| 120, 46 mm \| 0\.032 m\/s \| 1\.3 s \| 0\.00078 \|/);
  assert.match(read('Docs/Performance.md'), /`drum` \| – \| 13 m\/s \| never \| – \|/);
  assert.match(read('Docs/Queries.md'), /1,234<!--/);
});

test('ratios to Bullet are taken from the runs where they are there', () => {
  const peer = { engine: 'bullet', version: '3.24', median_ms: 40.04, ratio: 0.251 };
  writeFileSync(file('document.json'), JSON.stringify({ schema: 2, runs: [run('drum', 1, { peer }), run('drum', 2, { peer: { ...peer, ratio: 0.148 } })] }));
  const { status, stderr } = figures(copy, '--take', file('document.json'));
  assert.equal(status, 0, stderr);
  assert.match(read('Docs/Performance.md'), /`drum` \|.*\| 10\.0 \| 10\.0 \| 0\.251 \| 0\.148 \|/);
  assert.equal(JSON.parse(read('Docs/figures.json')).scenes.find(({ name }) => name === 'drum').bullet_ms, 40);
});

test('a figure that is the median of several runs is not taken from one', () => {
  const { status, stderr } = take([run('ragdolls', 1)], { ragdolls: 10 });
  assert.equal(status, 1);
  assert.match(stderr, /ragdolls: its accuracy figure is the median of 8 runs/);
  assert.equal(take([run('ragdolls', 1, { accuracy: 0.0155, accuracy_of_runs: Array(8).fill(0.0155) })], { ragdolls: 10 }).status, 0);
  assert.match(read('Docs/drawings/speed.svg'), /ragdolls<[^]*?>largest gap 16 mm</);
});

test('what has no place is refused, and nothing is written', () => {
  const known = JSON.parse(read('Docs/figures.json'));
  delete known.scenes.find(({ name }) => name === 'drum').bullet_ms;
  writeFileSync(file('Docs/figures.json'), JSON.stringify(known));
  const before = read('Docs/figures.json');
  for (const [runs, bullet, message] of [
    [[run('drums', 1)], {}, /no scene 'drums'/],
    [[run('drum', 1)], {}, /the ratio needs "bullet_ms"/],
    [[run('drum', 4)], { drum: 40 }, /4 threads/],
    [[run('drum', 1, { settings: { substeps: 3 } })], { drum: 40 }, /no table has the settings/],
    [[run('drum', 1, { settings: { substeps: 4, velocity_iterations: 1, position_iterations: 1, narrow_phase: 'libccd' } })],
      { drum: 40 }, /no table has the settings/],
  ]) {
    const { status, stderr } = take(runs, bullet);
    assert.equal(status, 1);
    assert.match(stderr, message);
    assert.equal(read('Docs/figures.json'), before);
  }
});

test('what suites took becomes their shares', () => {
  writeFileSync(file('seconds'), '100 release\n7 a new suite\n');
  assert.equal(figures(copy, '--seconds', file('seconds')).status, 0);
  const shares = JSON.parse(read('Docs/figures.json')).processor_seconds;
  assert.equal(shares.release, 110);
  assert.equal(shares['a new suite'], 8);
  assert.ok(shares.asan > 0);
  writeFileSync(file('seconds'), 'release 100\n');
  assert.match(figures(copy, '--seconds', file('seconds')).stderr, /is no line of/);
});
