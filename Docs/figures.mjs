// Writes the measured figures of Docs/figures.json into README.md and Docs/*.md, between the marks
// <!-- figures: NAME --> and <!-- /figures -->, and into Docs/drawings/speed.svg. ./fulcrum figures starts it; Docs/Performance.md says how figures get here.
//   figures.mjs                                writes the documents
//   figures.mjs --check                        fails where a document does not say what the JSON says
//   figures.mjs --take BENCH.json ... [--bullet MS.json]
//                                              first puts what `fulcrum bench --json` wrote into the JSON; with --peer bullet
//                                              it has Bullet's times, else MS.json has them, ms with one thread by scene
import { existsSync, readFileSync, readdirSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

import { writeWholeFile } from './wholeFile.mjs';

const root = join(dirname(fileURLToPath(import.meta.url)), '..');
const jsonFile = join(root, 'Docs', 'figures.json');
const WORDS = ['one thread', 'two threads'];

// ---- Numbers as text --------------------------------------------------------------------------------------------------

const minus = (text) => text.replace('-', '−');
const ratio = (value) => value.toFixed(3);
const milliseconds = (value) => value.toFixed(value < 0.1 ? 3 : value < 10 ? 2 : 1);
const stageTime = (value) => (value >= 0.01 ? value.toFixed(2) : '–');
const twoDigits = (value) => minus(String(Number(value.toPrecision(2))));
const accuracyNumber = ({ scale }, value) => (Number.isFinite(value) ? twoDigits(value * scale) : 'none');
const accuracyText = (scene, value = scene.accuracy.value) => scene.accuracy.text.replace('#', accuracyNumber(scene.accuracy, value));
const thousands = (value) => value.toLocaleString('en');
const listed = (words) => (words.length < 2 ? words.join('') : `${words.slice(0, -1).join(', ')} and ${words.at(-1)}`);

function table(heading, rows) {
  return [heading, heading.map(() => '---'), ...rows].map((cells) => `| ${cells.join(' | ')} |`).join('\n');
}

// ---- What the marks name ----------------------------------------------------------------------------------------------

function sceneTable({ scenes }) {
  const hasPenetration = scenes.some((scene) => scene.penetration !== undefined);
  const rows = scenes.map((scene) => {
    const [one, two] = [scene.threads[1], scene.threads[2]];
    const cells = [`\`${scene.name}\``, scene.what.replace('#', thousands(scene.joints ?? 0)), milliseconds(one.ms), milliseconds(two.ms),
      ratio(one.ratio), ratio(two.ratio), scene.aim.map(ratio).join(', '), accuracyText(scene)];
    return hasPenetration ? [...cells, scene.penetration === undefined ? '–' : twoDigits(scene.penetration)] : cells;
  });
  const heading = ['scene', 'what', '1 thread', '2 threads', 'ratio, 1 thread', 'ratio, 2 threads', 'aim', 'accuracy figure'];
  return table(hasPenetration ? [...heading, 'largest penetration'] : heading, rows);
}

// Speed and accuracy in one picture: of each scene the time of a step as a part of Bullet's, and how exact the result is.
function speedPicture({ scenes }) {
  const WIDTH = 900, TOP = 44, ROW = 36, LEFT = 298, BARS = 330, RIGHT = LEFT + BARS + 24;
  const escape = (text) => text.replaceAll('&', '&amp;').replaceAll('<', '&lt;').replaceAll('`', '');
  const rows = scenes.map((scene, i) => {
    const y = TOP + i * ROW, { ms, ratio: part } = scene.threads[1], end = LEFT + Math.max(2, BARS * part), isInside = part > 0.45;
    const [what] = scene.what.replace('#', thousands(scene.joints ?? 0)).split(', as one batch');
    return `<g>
<text x="16" y="${y + 13}" class="name">${scene.name}</text>
<text x="16" y="${y + 28}" class="small">${escape(what)}</text>
<rect x="${LEFT}" y="${y + 5}" width="${BARS}" height="20" rx="3" fill="#e4e8ec"/>
<rect x="${LEFT}" y="${y + 5}" width="${(end - LEFT).toFixed(1)}" height="20" rx="3" fill="#4f86d9"/>
<text x="${(isInside ? end - 6 : end + 6).toFixed(1)}" y="${y + 19}"${isInside ? ' text-anchor="end" fill="#fff"' : ''}>${milliseconds(ms)} ms</text>
${part > 0.74 ? '' : `<text x="${LEFT + BARS - 6}" y="${y + 19}" text-anchor="end" class="small">Bullet ${scene.bullet_ms} ms</text>
`}<text x="${RIGHT}" y="${y + 19}">${escape(accuracyText(scene))}</text>
</g>`;
  });
  const height = TOP + scenes.length * ROW + 12;
  return `<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 ${WIDTH} ${height}" width="${WIDTH}" height="${height}">
<title>Milliseconds a step with one thread beside Bullet 3.24, and how exact the result is</title>
<style>text { font: 13px system-ui, "Segoe UI", "DejaVu Sans", sans-serif; } .name { font-weight: 600; } .small { font-size: 11px; fill: #66727f; } .head { fill: #66727f; }</style>
<rect width="${WIDTH}" height="${height}" fill="#fff"/>
<g fill="#1b2530">
<text x="16" y="26" class="head">scene</text><text x="${LEFT}" y="26" class="head">a step with one thread; the whole bar: Bullet 3.24</text><text x="${RIGHT}" y="26" class="head">accuracy figure</text>
${rows.join('\n')}
</g>
</svg>
`;
}

// Of the scenes' ends: Samples/Scenes/RestMeters.h.
function restTable({ scenes }) {
  const rows = scenes.filter((scene) => scene.rest).map(({ name, rest }) => [
    `\`${name}\``,
    rest.drift_m ? `${rest.drift_m.map((meters) => twoDigits(1000 * meters)).join(', ')} mm` : '–',
    `${twoDigits(rest.speed)} m/s`,
    typeof rest.asleep_s === 'number' ? `${rest.asleep_s.toFixed(1)} s` : rest.asleep_s ?? '–',
    typeof rest.energy_rise === 'number' ? twoDigits(rest.energy_rise) : '–',
  ]);
  return table(['scene', 'drift: largest, mean', 'speed in the last second', 'all asleep after', 'energy from nothing'], rows);
}

// Which scenes are slower than the aim, and by how much.
function missedAims({ scenes }) {
  const missed = scenes.map((scene) => {
    const over = [1, 2].map((threads) => scene.threads[threads].ratio / scene.aim[threads - 1] - 1);
    const parts = over.map((share, i) => (share > 0 ? `${Math.max(1, Math.round(100 * share))} % with ${WORDS[i]}` : '')).filter(Boolean);
    return parts.length > 0 ? `\`${scene.name}\` (${parts.join(', ')})` : '';
  }).filter(Boolean);
  return missed.length > 0 ? `Over their aims are ${listed(missed)}.` : 'Every scene reaches its aims.';
}

function bulletTimes({ scenes }) {
  return listed(scenes.filter((scene) => scene.bullet_ms).map((scene) => `${scene.bullet_ms} ms in \`${scene.name}\``));
}

function stageTable({ stages, scenes }) {
  const rows = scenes.flatMap((scene) => Object.entries(scene.threads).filter(([, run]) => run.stages_ms).map(([threads, run], i) => [
    i === 0 ? `\`${scene.name}\`` : '', threads, ...stages.map((stage) => stageTime(run.stages_ms[stage] ?? 0)), milliseconds(run.ms),
  ]));
  return table(['scene', 'threads', ...stages, 'all'], rows);
}

function settingsTable({ scenes }) {
  const rows = scenes.filter((scene) => scene.ten_iterations).map((scene) => {
    const { ratio: ratios, accuracy, remark } = scene.ten_iterations;
    const usual = [1, 2].map((threads) => ratio(scene.threads[threads].ratio)).join(', ');
    return [`\`${scene.name}\``, `${usual}; ${accuracyText(scene)}`,
      `${ratios.map(ratio).join(', ')}; ${accuracyText(scene, accuracy)}${remark ? `, ${remark}` : ''}`];
  });
  return table(['scene', '(4, 1, 1), the default', '(1, 10, 2)'], rows);
}

const BLOCKS = { scenes: sceneTable, rest: restTable, stages: stageTable, settings: settingsTable, 'missed aims': missedAims };
const INLINE = {
  'ns of a single ray': ({ scenes }) => thousands(Math.round(scenes.find(({ name }) => name === 'rays').single_ns)),
  'times of Bullet': bulletTimes,
  'joints of joint_grid': ({ scenes }) => thousands(scenes.find(({ name }) => name === 'joint_grid').joints),
};

// ---- Documents --------------------------------------------------------------------------------------------------------

export function written(text, figures, file) {
  const opened = text.split('<!-- figures: ').length - 1;
  let closed = 0;
  const result = text.replace(/<!-- figures: ([^>]*?) -->[\s\S]*?<!-- \/figures -->/g, (_, name) => {
    ++closed;
    const [open, close] = [`<!-- figures: ${name} -->`, '<!-- /figures -->'];
    if (BLOCKS[name]) return `${open}\n${BLOCKS[name](figures)}\n${close}`;
    if (INLINE[name]) return `${open}${INLINE[name](figures)}${close}`;
    throw new Error(`${file}: there are no figures '${name}'; there are ${[...Object.keys(BLOCKS), ...Object.keys(INLINE)].join(', ')}`);
  });
  if (opened !== closed) throw new Error(`${file}: a mark of figures has no end`);
  return result;
}

const documents = () => ['README.md', ...readdirSync(join(root, 'Docs')).filter((name) => name.endsWith('.md')).map((name) => `Docs/${name}`)];

// Of what is written whole.
const DRAWINGS = { 'Docs/drawings/speed.svg': speedPicture };

function writeDocuments(figures, isCheck) {
  let wrong = 0;
  const used = new Set();
  for (const file of [...documents(), ...Object.keys(DRAWINGS)]) {
    const text = existsSync(join(root, file)) ? readFileSync(join(root, file), 'utf8') : '';
    for (const [, name] of text.matchAll(/<!-- figures: ([^>]*?) -->/g)) used.add(name);
    const wanted = DRAWINGS[file]?.(figures) ?? written(text, figures, file);
    if (wanted === text) continue;
    if (!isCheck) {
      writeWholeFile(join(root, file), wanted);
      console.log(`Wrote ${file}`);
      continue;
    }
    const [is, should] = [text.split('\n'), wanted.split('\n')];
    const line = should.findIndex((content, i) => content !== is[i]);
    console.error(`${file}:${line + 1} does not say what Docs/figures.json says; ./fulcrum figures writes it\n  is:     ${is[line]}\n  should: ${should[line]}`);
    ++wrong;
  }
  const unused = [...Object.keys(BLOCKS), ...Object.keys(INLINE)].filter((name) => !used.has(name));
  if (unused.length > 0) throw new Error(`no document has the figures '${unused.join("', '")}'`);
  return wrong;
}

// ---- New figures ------------------------------------------------------------------------------------------------------

const isSetting = ({ settings: s }, substeps, velocity, position) =>
  s.substeps === substeps && s.velocity_iterations === velocity && s.position_iterations === position &&
  (s.narrow_phase ?? 'automatic') === 'automatic';

function takeAccuracy(scene, run) {
  if (scene.accuracy.runs && run.accuracy_of_runs?.length !== scene.accuracy.runs)
    throw new Error(`${run.scene}: its accuracy figure is the median of ${scene.accuracy.runs} runs, which --steps and --only-timed leave out`);
  scene.accuracy.value = run.accuracy;
  if (run.single_query_ns) scene.single_ns = Math.round(run.single_query_ns);
  if (run.end_speed_m_s === undefined) return;
  scene.rest = {
    drift_m: run.largest_drift_m === null ? null : [run.largest_drift_m, run.mean_drift_m],
    speed: run.end_speed_m_s,
    asleep_s: run.asleep_s,
    energy_rise: run.energy_rise,
  };
}

// One of the runs that fulcrum bench writes.
export function take(figures, run) {
  const scene = figures.scenes.find(({ name }) => name === run.scene);
  if (!scene) throw new Error(`Docs/figures.json has no scene '${run.scene}': add it with "what", "aim" and "accuracy"`);
  if (run.threads !== 1 && run.threads !== 2) throw new Error(`${run.scene}: a run with ${run.threads} threads; the tables have 1 and 2`);
  const bullet = run.peer?.engine === 'bullet' ? run.peer : undefined;
  if (bullet && run.threads === 1) scene.bullet_ms = Number(bullet.median_ms.toPrecision(3));
  if (!scene.bullet_ms && !bullet) throw new Error(`${run.scene}: the ratio needs "bullet_ms" (--bullet MS.json)`);
  const quotient = Number((bullet?.ratio ?? run.median_ms / scene.bullet_ms).toFixed(4));
  if (isSetting(run, 4, 1, 1)) {
    const stages = Object.entries(run.stages_ms).map(([stage, ms]) => [stage, Number(ms.toFixed(4))]).filter(([, ms]) => ms > 0);
    scene.threads[run.threads] = { ms: Number(run.median_ms.toFixed(4)), ratio: quotient };
    if (!scene.is_batch) scene.threads[run.threads].stages_ms = Object.fromEntries(stages);
    if (run.threads === 1) takeAccuracy(scene, run);
    if (run.threads === 1 && run.largest_relative_penetration !== undefined) scene.penetration = run.largest_relative_penetration;
  } else if (isSetting(run, 1, 10, 2) && scene.ten_iterations) {
    scene.ten_iterations.ratio[run.threads - 1] = quotient;
    if (run.threads === 1) scene.ten_iterations.accuracy = run.accuracy;
  } else {
    throw new Error(`${run.scene}: no table has the settings ${JSON.stringify(run.settings)}`);
  }
}

// What the suites of ./fulcrum test took, "seconds name" a line: from now on each may take a tenth more.
export function takeSeconds(figures, text) {
  for (const line of text.trim().split('\n')) {
    const [, seconds, name] = /^(\d+) (\S.*)$/.exec(line) ?? [];
    if (!name) throw new Error(`'${line}' is no line of build/logs/seconds`);
    figures.processor_seconds[name] = Math.ceil((11 * Number(seconds)) / 10);
  }
}

// JSON whose small lists and objects have a line each.
function laidOut(value, indent = '') {
  const flat = JSON.stringify(value).replaceAll(/("[^"]*")|([,:])/g, (_, text, sign) => text ?? `${sign} `);
  if (typeof value !== 'object' || value === null || flat.length + indent.length <= 128) return flat;
  const deeper = `${indent}  `;
  const parts = Array.isArray(value) ? value.map((item) => laidOut(item, deeper)) : Object.entries(value).map(([key, item]) => `"${key}": ${laidOut(item, deeper)}`);
  const [open, close] = Array.isArray(value) ? '[]' : '{}';
  return `${open}\n${parts.map((part) => deeper + part).join(',\n')}\n${indent}${close}`;
}

function main(options) {
  const figures = JSON.parse(readFileSync(jsonFile, 'utf8'));
  const [verb, ...files] = options;
  if (verb === '--take') {
    const bullet = files.indexOf('--bullet');
    if (bullet >= 0) {
      const times = JSON.parse(readFileSync(files[bullet + 1], 'utf8'));
      for (const scene of figures.scenes) if (scene.name in times) scene.bullet_ms = times[scene.name];
      files.splice(bullet, 2);
    }
    for (const file of files) {
      const written = JSON.parse(readFileSync(file, 'utf8'));
      for (const run of written.runs ?? written) take(figures, run);
    }
    writeWholeFile(jsonFile, `${laidOut(figures)}\n`);
  } else if (verb === '--seconds') {
    takeSeconds(figures, readFileSync(files[0], 'utf8'));
    writeWholeFile(jsonFile, `${laidOut(figures)}\n`);
  } else if (verb !== undefined && verb !== '--check') {
    throw new Error(`unknown option '${verb}'; there are --check, --take and --seconds`);
  }
  return writeDocuments(figures, verb === '--check') === 0 ? 0 : 1;
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  try {
    process.exitCode = main(process.argv.slice(2));
  } catch (error) {
    console.error(`fulcrum: ${error.message}`);
    process.exitCode = 1;
  }
}
