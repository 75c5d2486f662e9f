// Where the runs of a scene are in its plot. No page is needed: the tests run it in node.

// Not finite, or without a number in the file: null.
const errorOf = (run, metric) => (metric === 'self_error' ? run.self_error : run.errors[metric]) ?? null;

const plain = new Intl.NumberFormat('en', { maximumSignificantDigits: 3 });
function number(value) {
  if (value === null || value === undefined) return '–';
  return value === 0 || Math.abs(value) >= 0.001 ? plain.format(value) : value.toExponential(2);
}

// A run of another engine has the engine's name.
function titleOf(run, metric) {
  const setting = run.engine
    ? [`${run.engine}${run.preset ? ', its default' : ''}`, `dt 1/${run.rate} s, ${run.velocity_iterations} iterations`]
    : [
      `${run.preset ? `${run.preset === 'balanced' ? 'balanced (the default)' : run.preset}: ` : ''}${run.family}`,
      `dt 1/${run.rate} s, ${run.substeps} substeps`,
      `${run.velocity_iterations} velocity, ${run.position_iterations} position iterations`,
    ];
  const lines = [
    ...setting,
    `${metric} ${number(errorOf(run, metric))}${run.blew_up ? ' (blew up)' : ''}`,
    `${number(run.us_per_second)} µs a second (of ${run.timed_runs})`,
  ];
  if (!run.engine) lines.push(`${number(run.traversals_per_second)} traversals a second`);
  if (run.failed_conditions.length > 0) lines.push(`fails: ${run.failed_conditions.join('; ')}`);
  lines.push(run.recording ? 'click: plays its recording' : `to record it: --record "${run.setting}"`);
  return lines.join('\n');
}

// Those that no other one beats in both, cheapest first.
export function envelopeOf(points) {
  const best = [];
  for (const point of points.filter(({ kind }) => kind !== 'blew up').sort((a, b) => a.cost - b.cost || a.error - b.error)) {
    if (best.length === 0 || point.error < best.at(-1).error) best.push(point);
  }
  return best;
}

// One label for lines that are too near for one each; `range` is the quotient of the plot's edges.
export function labelsOf(peers, range) {
  const near = range ** 0.045;
  const labels = [];
  for (const { error, engine } of [...peers].sort((a, b) => a.error - b.error)) {
    const name = engine.split(' ')[0], last = labels.at(-1);
    if (last && error < last.error * near) last.label += `, ${name}`;
    else labels.push({ error, label: name });
  }
  return labels;
}

// Errors of zero are drawn at the lower edge, runs that blew up at the upper one.
export function drawnOf(scene, { cost, metric, peers = [] }) {
  const runs = scene.runs.filter((run) => run[cost] !== null);
  const isBlown = (run) => run.blew_up || errorOf(run, metric) === null;
  const positive = runs.filter((run) => !isBlown(run)).map((run) => errorOf(run, metric)).filter((error) => error > 0).concat(peers);
  // Decades around what there is; where all is exact, any.
  let bottom = 10 ** (Math.floor(Math.log10(Math.min(...positive, Infinity))) - (runs.some((run) => errorOf(run, metric) === 0) ? 1 : 0));
  let top = 10 ** Math.ceil(Math.log10(Math.max(...positive, 0)) + 0.05);
  if (positive.length === 0) [bottom, top] = [1e-6, 1];
  if (runs.some(isBlown)) top *= 10;
  const points = runs.map((run) => {
    const error = errorOf(run, metric), kind = isBlown(run) ? 'blew up' : error === 0 ? 'exact' : 'run';
    return {
      cost: Math.max(run[cost], 1e-3),
      error: kind === 'blew up' ? top : kind === 'exact' ? bottom : error,
      kind,
      family: run.family,
      engine: run.engine,
      preset: run.preset,
      recording: run.recording ?? null,
      title: titleOf(run, metric),
    };
  });
  const families = [...new Set(points.map(({ family }) => family))];
  const costs = points.map((point) => point.cost);
  return {
    points,
    envelope: envelopeOf(points.filter(({ engine }) => !engine)),
    curves: families.map((family) => ({ family, points: envelopeOf(points.filter((point) => point.family === family)) })),
    top,
    bottom,
    left: Math.min(...costs) / 1.2,
    right: Math.max(...costs) * 1.2,
  };
}

// Of a plot in pixels: its size and what is beside its frame.
export const PLOT = { width: 580, height: 340, left: 58, right: 92, top: 26, bottom: 42 };
const LETTER = 6.6, LINE = 14, RING = 8; // pixels: of the labels' letters, upper bounds, and around a preset's dot

const boxOf = ({ x, y, textAnchor, dx, dy, text }) => {
  const width = LETTER * text.length, left = x + dx - { start: 0, middle: 0.5, end: 1 }[textAnchor] * width;
  return { left, right: left + width, top: y + dy - LINE / 2, bottom: y + dy + LINE / 2 };
};
const areaShared = (a, b) =>
  Math.max(0, Math.min(a.right, b.right) - Math.max(a.left, b.left)) * Math.max(0, Math.min(a.bottom, b.bottom) - Math.max(a.top, b.top));

// Beside which side of its dot each label stands: [{ point, text, textAnchor, dx, dy }], so that labels cover neither each other, nor the
// dots of others, nor what is beside the frame. `labels`: [{ point: { cost, error }, text }], the most important first.
export function placesOfLabels(labels, { left, right, top, bottom }) {
  const at = ({ cost, error }) => ({
    x: PLOT.left + (Math.log(cost / left) / Math.log(right / left)) * (PLOT.width - PLOT.left - PLOT.right),
    y: PLOT.top + (Math.log(top / error) / Math.log(top / bottom)) * (PLOT.height - PLOT.top - PLOT.bottom),
  });
  const around = [
    { textAnchor: 'middle', dx: 0, dy: -15 }, { textAnchor: 'middle', dx: 0, dy: 16 },
    { textAnchor: 'start', dx: 10, dy: 0 }, { textAnchor: 'end', dx: -10, dy: 0 },
    ...[-15, 16].flatMap((dy) => [{ textAnchor: 'start', dx: -4, dy }, { textAnchor: 'end', dx: 4, dy }]),
    ...[-29, 30].map((dy) => ({ textAnchor: 'middle', dx: 0, dy })),
  ];
  const rings = labels.map(({ point }) => {
    const { x, y } = at(point);
    return { left: x - RING, right: x + RING, top: y - RING, bottom: y + RING };
  });
  const placed = [];
  labels.forEach((label, i) => {
    const taken = rings.filter((_, k) => k !== i).concat(placed.map(boxOf));
    const cost = (place) => {
      const box = boxOf(place);
      const outside = Math.max(0, PLOT.left - box.left) + Math.max(0, box.right - (PLOT.width - PLOT.right)) + Math.max(0, PLOT.top - LINE / 2 - box.top) +
        Math.max(0, box.bottom - (PLOT.height - PLOT.bottom));
      return LINE * outside + taken.reduce((sum, other) => sum + areaShared(box, other), 0);
    };
    const places = around.map((side) => ({ ...label, ...at(label.point), ...side }));
    placed.push(places.reduce((best, place) => (cost(place) < cost(best) ? place : best)));
  });
  return placed;
}
