// Times scenes in Fulcrum and in other engines, side by side in one process: each step of all engines in turn, so that what else
// the machine does meets all of them. Medians of the steps, and those over Fulcrum's. node compare.mjs [--steps N] [SCENE...]
import { ENGINES } from './engines.mjs';
import { SCENES } from './scenes.mjs';

const names = process.argv.slice(2);
const at = names.indexOf('--steps');
const most = at >= 0 ? Number(names.splice(at, 2)[1]) : Infinity;
for (const name of names) {
  if (SCENES[name]) continue;
  console.error(`unknown scene '${name}'; there are ${Object.keys(SCENES).join(', ')}`);
  process.exit(2);
}
const median = (values) => [...values].sort((a, b) => a - b)[values.length >> 1];
const digits = (value) => String(Number(value.toPrecision(3)));

// Each scene has engines of its own: what one has in its memory is not freed, and one that ran out of it is of no more use.
const loadAll = () => Promise.all(Object.values(ENGINES).map((make) => make()));
let engines = await loadAll();
console.log(`node ${process.version}, one thread; ms a step, and that over Fulcrum's; in brackets how exact the run was\n`);
console.log(`| scene | bodies | figure | ${engines.map(({ name }) => name).join(' | ')} |`);
console.log(`|${' --- |'.repeat(3 + engines.length)}`);
for (const name of names.length > 0 ? names : Object.keys(SCENES)) {
  engines ??= await loadAll();
  const scene = SCENES[name](), runs = engines.map((engine) => {
    const run = { times: [], ratios: [] };
    try {
      Object.assign(run, engine.build(scene));
    } catch (error) {
      run.failed = error;
    }
    return run;
  });
  engines = undefined;
  const steps = Math.min(most, scene.steps);
  // An engine whose memory does not suffice ends here for this scene.
  const advance = (run) => {
    if (run.failed) return;
    try {
      run.step();
    } catch (error) {
      run.failed = error;
    }
  };
  for (const run of runs) advance(run); // untimed
  for (let step = 0; step < steps; ++step) {
    // Who comes first changes, since a cache is warmer for who comes after a small one.
    for (let i = 0; i < runs.length; ++i) {
      const run = runs[(step + i) % runs.length], begin = performance.now();
      advance(run);
      run.times.push(performance.now() - begin);
    }
    for (const run of runs) run.ratios.push(run.times[step] / runs[0].times[step]);
  }
  const cells = runs.map((run, i) => run.failed ? '–' : `${digits(median(run.times))}${i > 0 ? ` (${digits(median(run.ratios))} ×)` : ''} [${digits(scene.off(run))}]`);
  console.log(`| \`${name}\` | ${scene.bodies.length} | ${scene.meaning} | ${cells.join(' | ')} |`);
}
process.exit(0);
