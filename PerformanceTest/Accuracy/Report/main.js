// The report of the accuracy lab: a plot per scene. Plots are drawn when they come into view: a full grid has 10^5 runs.
import * as Plot from '@observablehq/plot';
import { PLOT, drawnOf, labelsOf, placesOfLabels } from './points.mjs';

const data = JSON.parse(document.getElementById('runs').textContent);
// report.html?scenes=tower,pendulum&cost=traversals_per_second: these plots alone, for pictures.
const asked = new URLSearchParams(location.search), chosen = asked.get('scenes')?.split(',');
if (asked.has('cost')) document.getElementById('cost').value = asked.get('cost');
if (chosen) {
  data.scenes = data.scenes.filter(({ name }) => chosen.includes(name));
  document.body.classList.add('picture');
}
const FAMILIES = [
  { name: 'soft', label: 'soft rows (default)', color: '#0072b2' },
  { name: 'baumgarte', label: 'Baumgarte', color: '#d55e00' },
  { name: 'libccd', label: 'contacts by libccd', color: '#009e73' },
  { name: 'no_trees', label: 'no trees of joints', color: '#b0499b' },
  { name: 'fixed', label: 'fixed effort', color: '#4a5563' },
  { name: 'target', label: 'AccuracyTarget', color: '#c8102e' },
  ...(data.peer ? [{ name: data.peer.family, label: data.peer.engine, color: '#7a5c00' }] : []),
].filter(({ name }) => data.scenes.some(({ runs }) => runs.some(({ family }) => family === name)));
// What the runs of presets are called, the first with the best place.
const PRESETS = {
  balanced: () => 'default',
  fast: () => 'fast',
  accurate: () => 'accurate',
  reference: () => 'reference',
  default: ({ engine }) => firstWordOf(engine),  // another engine's
};
const firstWordOf = (text) => text.split(' ')[0];
const colorOf = (family) => FAMILIES.find(({ name }) => name === family).color;

const element = (tag, content, properties = {}) => {
  const made = Object.assign(document.createElement(tag), properties);
  made.append(...[content].flat());
  return made;
};

function peerLines(scene, metric) {
  const peer = data.peers?.scenes?.[scene.name];
  if (!peer?.[metric]) return [];
  const isMeasured = (engine) => scene.runs.some((run) => run.engine && firstWordOf(run.engine) === firstWordOf(engine));
  return peer[metric].flatMap((error, i) => (error > 0 && !isMeasured(data.peers.engines[i]) ? [{ error, engine: data.peers.engines[i], cost: peer.cost[i] }] : []));
}

function draw(card, scene) {
  const cost = document.getElementById('cost').value, isSelf = document.getElementById('reference').value === 'self';
  const metric = isSelf ? 'self_error' : card.querySelector('.metric').value;
  const peers = isSelf ? [] : peerLines(scene, metric);
  const { points, envelope, curves, top, bottom, left, right } = drawnOf(scene, { cost, metric, peers: peers.map(({ error }) => error) });
  const at = { x: 'cost', y: 'error' };
  const presets = Object.entries(PRESETS).flatMap(([name, textOf]) =>
    points.filter(({ preset }) => preset === name).map((point) => ({ point, text: textOf(point) })));
  const isMain = !isSelf && metric === Object.keys(scene.runs[0].errors)[0];
  const plot = Plot.plot({
    width: PLOT.width,
    height: PLOT.height,
    marginLeft: PLOT.left,
    marginRight: PLOT.right,
    marginTop: PLOT.top,
    marginBottom: PLOT.bottom,
    style: { fontSize: '11.5px', background: 'transparent' },
    x: { type: 'log', domain: [left, right], grid: true, label: cost === 'us_per_second' ? 'µs of work per simulated second →' : 'traversals per simulated second →', ticks: 5, tickFormat: '~s' },
    y: { type: 'log', domain: [bottom, top], grid: true, label: isSelf ? '↑ difference from the finest setting' : `↑ ${metric}`, ticks: 6, tickFormat: (y) => y.toExponential(0).replace('e+', 'e') },
    marks: [
      Plot.frame({ stroke: '#c9d0d9' }),
      Plot.ruleY(peers, { y: 'error', stroke: '#6b7684', strokeDasharray: '4 4' }),
      Plot.text(labelsOf(peers, top / bottom), { y: 'error', text: 'label', frameAnchor: 'right', dx: 6, textAnchor: 'start', fill: '#4a5563' }),
      Plot.line(envelope, { ...at, stroke: '#aab2bd', strokeWidth: 9, strokeOpacity: 0.45, strokeLinejoin: 'round', className: 'envelope' }),
      curves.map(({ family, points: best }) => Plot.line(best, { ...at, stroke: colorOf(family), strokeWidth: 1.6, className: `curve ${family}` })),
      Plot.dot(points, { ...at, fill: ({ family }) => colorOf(family), r: points.length > 200 ? 2 : 3.6, symbol: 'kind', fillOpacity: points.length > 200 ? 0.5 : 0.9, className: 'runs' }),
      Plot.dot(points.filter(({ preset }) => preset), { ...at, r: 6.5, stroke: '#1d2733', strokeWidth: 1.4, className: 'presets' }),
      placesOfLabels(presets, { left, right, top, bottom }).map(({ point, text, textAnchor, dx, dy }) => Plot.text([point], {
        ...at, text: [text], textAnchor, dx, dy, fill: '#1d2733', stroke: 'white', strokeWidth: 3, fontWeight: point.preset === 'balanced' ? 'bold' : undefined,
        className: 'preset-label',
      })),
      Plot.tip(points, Plot.pointer({ ...at, title: 'title', maxRadius: 30, lineHeight: 1.3, className: 'hover' })),
      // Above what hovering shows, which a click makes stay.
      Plot.dot(points.filter(({ recording }) => recording), { ...at, r: 6.5, fill: 'transparent', href: 'recording', target: '_blank', className: 'recordings' }),
    ],
    // Kinds of points, not families, have symbols.
    symbol: { domain: ['run', 'blew up', 'exact'], range: ['circle', 'times', 'triangle'] },
  });
  card.querySelector('.plot').replaceChildren(plot);
  card.querySelector('.what-error').textContent = isMain ? `Error: ${scene.error}` : '';
}

function makeCard(scene) {
  const metrics = Object.keys(scene.runs[0].errors);
  const choice = element('select', metrics.map((name) => element('option', name, { value: name })), { className: 'metric', ariaLabel: 'Metric' });
  const conditions = scene.is_extreme ? scene.runs.find(({ preset }) => preset === 'balanced')?.failed_conditions ?? [] : [];
  const card = element('section', [
    element('div', [element('h2', scene.name), choice], { className: 'top' }),
    element('p', scene.what),
    element('p', '', { className: 'what-error' }),
    scene.peer_lacks ? element('p', `Not run in ${data.peer.engine}, where the lab has no counterpart of ${scene.peer_lacks}`, { className: 'lacking' }) : '',
    conditions.length > 0 ? element('p', `The default fails: ${conditions.join('; ')}`, { className: 'failed' }) : '',
    element('div', '', { className: 'plot' }),
  ], { className: 'scene', id: scene.name });
  choice.addEventListener('change', () => draw(card, scene));
  return card;
}

function contentsOf(title, isExtreme) {
  const links = data.scenes.filter((scene) => scene.is_extreme === isExtreme).map(({ name }) => element('a', name, { href: `#${name}` }));
  return links.length > 0 ? element('div', [element('h2', title), ...links]) : '';
}

const { machine, compiler, lanes, commit, date, quick } = data;
document.getElementById('circumstances').textContent =
  `${data.scenes.length} ${data.scenes.length === 1 ? 'scene' : 'scenes'}, ${quick ? 'short grid' : 'full grid'}; ${date}; commit ${commit ?? 'not known'}; ${machine}; compiler ${compiler}, ${lanes} lanes`;
document.getElementById('legend').append(...FAMILIES.map(({ label, color }) => {
  const mark = element('i', '');
  mark.style.background = color;
  return element('span', [mark, label]);
}));
document.getElementById('contents').append(contentsOf('Accuracy', false), contentsOf('Extremes', true));

const drawn = new Map();
const watcher = new IntersectionObserver((entries) => {
  for (const { isIntersecting, target } of entries) {
    if (!isIntersecting || drawn.has(target)) continue;
    const scene = data.scenes.find(({ name }) => name === target.id);
    drawn.set(target, scene);
    draw(target, scene);
  }
}, { rootMargin: '400px' });
for (const scene of data.scenes) {
  const card = makeCard(scene);
  document.getElementById('scenes').append(card);
  watcher.observe(card);
}
document.getElementById('controls').addEventListener('change', () => drawn.forEach((scene, card) => draw(card, scene)));
