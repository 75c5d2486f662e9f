// The curves beside the picture, drawn by uPlot: what is plotted, the playhead, clicks that seek, and the bodies to blame.
import uPlot from 'uplot';
import { peakOf, stagesOf } from './decodeFigures.js';

const HEIGHT = 92; // pixels of a plot
const COLORS = ['#3b78c9', '#d9822b', '#3f9e66', '#c0504d', '#8163c1', '#8b97a4'];

const digits = (value) => Number(value.toPrecision(3));
export function short(value) {
  const size = Math.abs(value);
  if (size >= 1e9) return `${digits(value / 1e9)} G`;
  if (size >= 1e6) return `${digits(value / 1e6)} M`;
  if (size >= 1e4) return `${digits(value / 1e3)} k`;
  if (size > 0 && size < 1e-3) return value.toExponential(1);
  return String(digits(value));
}

// Whole decades around the values of a logarithmic plot, at most nine: what is below, such as rounding, is at its lower edge.
export function decadesOf(low, high) {
  if (!(high > 0)) return [0.1, 1];
  const top = Math.ceil(Math.log10(high) + 1e-9), bottom = Math.floor(Math.log10(Math.max(low, 1e-9 * high)));
  return [10 ** Math.min(bottom, top - 1), 10 ** top];
}
// Zeros have no place in it.
export const positive = (values) => Array.from(values, (value) => (value > 0 ? value : null));
// Whether a plot of these series may be logarithmic.
export const hasLogarithm = ({ series, stacked }) => !stacked && series.every(({ values }) => values.every((value) => value >= 0));

// A button in a plot's caption that makes its axis logarithmic.
export function logButton(isOn, toggle) {
  const button = Object.assign(document.createElement('button'), { type: 'button', className: 'log', textContent: 'log', title: 'Logarithmic axis' });
  button.setAttribute('aria-pressed', isOn);
  button.addEventListener('click', toggle);
  return button;
}
export const LOGARITHMIC = { distr: 3, range: (_, low, high) => decadesOf(low, high) };
// The numbers beside such an axis: powers of ten, at most five.
export function splitsOf(low, high) {
  const first = Math.round(Math.log10(low)), last = Math.round(Math.log10(high)), every = Math.ceil((last - first) / 4);
  return Array.from({ length: Math.floor((last - first) / every) + 1 }, (_, i) => 10 ** (first + i * every));
}
export const LOGARITHMIC_AXIS = { splits: (_, axis, low, high) => splitsOf(low, high), filter: (_, splits) => splits };

const isFlat = (values) => values.every((value) => value === 0);
const scaled = (values, factor) => Array.from(values, (value) => value * factor);

// [{ id, title, unit, series: [{ name, values }], stacked, culprit(frame) }]; those that say nothing are left out.
export function plotsOf({ figures, jointErrors, joints, frameCount }) {
  if (!figures.kinetic) return [];
  const { kinetic, springs, momentum, angularMomentum, penetration, contacts, awake } = figures;
  // Above its lowest value: the height of the origin would only hide what changes.
  const lowest = figures.potential.reduce((least, value) => Math.min(least, value), Infinity);
  const potential = figures.potential.map((value) => value - lowest);
  const total = kinetic.map((value, i) => value + potential[i] + springs[i]);
  const energy = [{ name: 'total', values: total }, { name: 'kinetic', values: kinetic }, { name: 'potential', values: potential }];
  if (!isFlat(springs)) energy.push({ name: 'springs', values: springs });
  const errors = joints.length > 0 ? jointErrors.slice(0, frameCount) : [];
  const plots = [
    { id: 'energy', title: 'Energy', unit: 'J, above the lowest potential', series: energy },
    { id: 'momentum', title: 'Momentum', unit: 'kg m/s', series: [{ name: 'linear', values: momentum }] },
    { id: 'angular', title: 'Angular momentum', unit: 'kg m²/s', series: [{ name: 'about the origin', values: angularMomentum }] },
    {
      id: 'penetration', title: 'Largest penetration', unit: 'mm', series: [{ name: 'of all contacts', values: scaled(penetration, 1000) }],
      culprit: (frame) => (penetration[frame] > 0 ? { bodies: [figures.deepestA[frame], figures.deepestB[frame]] } : undefined),
    },
    {
      id: 'joint-error', title: 'Largest joint error', unit: 'mm, mrad',
      series: [
        { name: 'gap', values: errors.map(({ distance }) => 1000 * distance) },
        { name: 'tilt', values: errors.map(({ angle }) => 1000 * angle) },
      ],
      culprit: (frame) => {
        const { distance, distanceJoint } = errors[frame] ?? {};
        return distance > 0 ? { joint: distanceJoint, bodies: [joints[distanceJoint].bodyA, joints[distanceJoint].bodyB] } : undefined;
      },
    },
    { id: 'contacts', title: 'Contacts', unit: '', series: [{ name: 'manifolds', values: contacts }] },
    { id: 'awake', title: 'Awake bodies', unit: '', series: [{ name: 'bodies', values: awake }] },
    { id: 'ms', title: 'A step by stage', unit: 'ms', series: stagesOf(figures), stacked: true },
  ];
  return plots.filter(({ series }) => series.some(({ values }) => values.length > 0 && !isFlat(values)));
}

// Sums from below, so that areas lie on each other. uPlot draws the last series on top: the largest sum comes first.
function stackedData(series) {
  let below = new Array(series[0].values.length).fill(0);
  return series.map(({ values }) => (below = below.map((sum, i) => sum + values[i]))).reverse();
}

export class Curves {
  // `actions`: { seek(frame), select(body), nameOf(body) }
  constructor(place, recording, actions) {
    this.place = place;
    this.times = Float64Array.from(recording.times);
    this.plots = plotsOf(recording);
    this.actions = actions;
    this.shown = [];
    this.logs = new Set(); // ids of plots that are logarithmic
    this.frame = 0;
  }
  get isEmpty() { return this.plots.length === 0; }

  // Builds the plots anew, in the colors of the page as it is.
  build() {
    this.clear();
    const style = getComputedStyle(document.documentElement);
    const ink = style.getPropertyValue('--muted').trim(), line = style.getPropertyValue('--line').trim();
    const width = Math.max(120, this.place.clientWidth);
    for (const plot of this.plots) this.shown.push(this.#make(plot, width, ink, line));
    this.update(this.frame);
  }
  clear() {
    for (const { chart } of this.shown) chart.destroy();
    this.shown = [];
    this.place.replaceChildren();
  }
  resize() {
    const width = Math.max(120, this.place.clientWidth);
    for (const { chart } of this.shown) if (chart.width !== width) chart.setSize({ width, height: HEIGHT });
    this.update(this.frame);
  }

  update(frame) {
    this.frame = frame;
    const whole = Math.floor(frame), fraction = frame - whole;
    const time = this.times[whole] + fraction * ((this.times[whole + 1] ?? this.times[whole]) - this.times[whole]);
    for (const { plot, chart, head, values, culprit } of this.shown) {
      head.style.transform = `translateX(${chart.valToPos(time, 'x')}px)`;
      plot.series.forEach((series, i) => (values[i].textContent = short(series.values[whole])));
      if (culprit) this.#showCulprit(plot, culprit, whole);
    }
  }

  #make(plot, width, ink, line) {
    const figure = Object.assign(document.createElement('figure'), { className: 'curve', id: `curve-${plot.id}` });
    const caption = document.createElement('figcaption');
    caption.append(Object.assign(document.createElement('b'), { textContent: plot.title }));
    if (plot.unit) caption.append(` ${plot.unit}`);
    const isLog = this.logs.has(plot.id);
    if (hasLogarithm(plot)) caption.append(logButton(isLog, () => this.#setLog(plot.id, !isLog)));
    const keys = Object.assign(document.createElement('span'), { className: 'keys' });
    const values = plot.series.map(({ name }, i) => {
      const value = document.createElement('output');
      const key = document.createElement('span');
      key.append(Object.assign(document.createElement('i'), { style: `background:${COLORS[i]}` }), `${name} `, value);
      keys.append(key);
      return value;
    });
    const box = document.createElement('div');
    figure.append(caption, keys, box);
    this.place.append(figure);

    const drawn = plot.stacked ? stackedData(plot.series) : plot.series.map(({ values: all }) => (isLog ? positive(all) : Array.from(all)));
    const colorOf = (i) => COLORS[plot.stacked ? plot.series.length - 1 - i : i];
    const axis = { stroke: ink, grid: { stroke: line, width: 1 }, ticks: { show: false }, font: '10px system-ui, sans-serif' };
    const chart = new uPlot({
      width, height: HEIGHT, legend: { show: false }, padding: [6, 6, 0, 0],
      cursor: { y: false, points: { show: false }, drag: { x: false, y: false }, sync: { key: 'fulcrum', setSeries: false } },
      scales: { x: { time: false }, y: isLog ? LOGARITHMIC : {
        range: (_, low, high) => (plot.stacked || low >= 0 ? [0, high > 0 ? 1.06 * high : 1] : uPlot.rangeNum(low, high, 0.06, true)),
      } },
      axes: [
        { ...axis, size: 18, gap: 2, space: 46, values: (_, splits) => splits.map((at) => `${digits(at)} s`) },
        { ...axis, size: 44, gap: 3, space: 22, values: (_, splits) => splits.map(short), ...(isLog ? LOGARITHMIC_AXIS : {}) },
      ],
      series: [{}, ...drawn.map((_, i) => ({ stroke: colorOf(i), width: 1.4, fill: plot.stacked ? colorOf(i) : undefined, points: { show: false } }))],
    }, [this.times, ...drawn], box);
    const head = Object.assign(document.createElement('div'), { className: 'playhead' });
    chart.over.append(head);
    this.#connect(chart);
    const culprit = plot.culprit && figure.appendChild(Object.assign(document.createElement('p'), { className: 'culprit' }));
    return { plot, chart, head, values, culprit };
  }

  #setLog(id, isLog) {
    if (isLog) this.logs.add(id);
    else this.logs.delete(id);
    this.build();
    requestAnimationFrame(() => this.update(this.frame)); // the plots know their places then
  }

  // A click, or dragging along the plot, goes to the moment under the pointer.
  #connect(chart) {
    const seekTo = (event) => {
      const left = event.clientX - chart.over.getBoundingClientRect().left;
      this.actions.seek(chart.posToIdx(Math.min(chart.over.clientWidth, Math.max(0, left))));
    };
    chart.over.addEventListener('pointerdown', (event) => {
      if (event.button !== 0) return;
      chart.over.setPointerCapture(event.pointerId);
      seekTo(event);
    });
    chart.over.addEventListener('pointermove', (event) => event.buttons === 1 && seekTo(event));
  }

  #showCulprit(plot, place, frame) {
    const now = plot.culprit(frame);
    const key = JSON.stringify(now ?? null);
    if (place.dataset.key === key) return;
    place.dataset.key = key;
    place.replaceChildren();
    const button = (text, action) => {
      const made = Object.assign(document.createElement('button'), { type: 'button', textContent: text });
      made.addEventListener('click', action);
      return made;
    };
    if (now) {
      if (now.joint !== undefined) place.append(`joint ${now.joint}: `);
      now.bodies.forEach((body, i) => place.append(i > 0 ? ' and ' : '', button(this.actions.nameOf(body), () => this.actions.select(body))));
    }
    const peak = peakOf(plot.series[0].values);
    if (peak >= 0) place.append(now ? ' · ' : '', button('go to the largest', () => {
      this.actions.seek(peak);
      const worst = plot.culprit(peak);
      if (worst) this.actions.select(worst.bodies[0]);
    }));
  }
}
