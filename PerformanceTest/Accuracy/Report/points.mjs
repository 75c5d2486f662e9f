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
