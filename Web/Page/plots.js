// Live curves of the last steps: cost and errors, with a mark where settings were changed.
import uPlot from 'uplot';
import { LOGARITHMIC, LOGARITHMIC_AXIS, logButton, positive, short } from '../../Samples/Viewer/Page/curves.js';

const HEIGHT = 92; // pixels of a plot
const MOST = 600;  // steps that are shown
export const PLOTS = [
  { id: 'ms', title: 'Cost', unit: 'ms a step', color: '#3b78c9', of: (report) => report.totalMs },
  { id: 'penetration', title: 'Largest penetration', unit: 'mm', color: '#c0504d', of: (report) => 1000 * report.largestPenetration },
  { id: 'joint-error', title: 'Largest joint error', unit: 'mm', color: '#d9822b', of: (report) => 1000 * report.largestJointError },
  { id: 'energy', title: 'Energy', unit: 'J', color: '#3f9e66', isSigned: true, of: (report, world) => world.energy },
  { id: 'momentum', title: 'Momentum error', unit: 'kg m/s', color: '#8163c1', of: (report) => report.errors.momentumError },
];

const median = (values) => [...values].sort((a, b) => a - b)[values.length >> 1] ?? 0;

// The top of a plot: few single steps, as the first, are far above all others, and would make these a flat line.
function topOf(values) {
  const sorted = values.filter(Number.isFinite).sort((a, b) => a - b);
  return Math.min(sorted.at(-1) ?? 0, 3 * (sorted[Math.floor(0.97 * sorted.length)] ?? 0)) || 1;
}

export class Plots {
  constructor(place) {
    this.place = place;
    this.logs = new Set(); // ids of plots that are logarithmic
    this.clear();
  }

  clear() {
    this.times = [];
    this.values = PLOTS.map(() => []);
    this.marks = [];
    this.isStale = true;
  }
  add(time, report, world) {
    this.times.push(time);
    PLOTS.forEach((plot, i) => this.values[i].push(plot.of(report, world)));
    if (this.times.length > MOST) {
      this.times.shift();
      for (const values of this.values) values.shift();
      while (this.marks[0] < this.times[0]) this.marks.shift();
    }
    this.isStale = true;
  }
  // The settings changed now.
  mark() {
    const now = this.times.at(-1);
    if (now !== undefined && this.marks.at(-1) !== now) this.marks.push(now);
  }
  // Of the last half second of steps at 60 a second, so that one change is seen soon.
  recent(id) {
    const i = PLOTS.findIndex((plot) => plot.id === id);
    return median(this.values[i].slice(-30));
  }

  build() {
    for (const { chart } of this.charts ?? []) chart.destroy();
    this.place.replaceChildren();
    const style = getComputedStyle(document.documentElement);
    const ink = style.getPropertyValue('--muted').trim(), line = style.getPropertyValue('--line').trim();
    this.charts = PLOTS.map((plot) => this.#make(plot, ink, line));
    this.isStale = true;
  }
  resize() {
    for (const { chart } of this.charts ?? []) chart.setSize({ width: this.#width, height: HEIGHT });
  }
  get #width() { return Math.max(120, this.place.clientWidth); }

  draw() {
    if (!this.isStale || !this.charts) return;
    this.isStale = false;
    this.charts.forEach(({ chart, value }, i) => {
      chart.setData([this.times, this.logs.has(PLOTS[i].id) ? positive(this.values[i]) : this.values[i]]);
      value.textContent = this.values[i].length > 0 ? short(this.values[i].at(-1)) : '';
    });
  }

  #make(plot, ink, line) {
    const figure = Object.assign(document.createElement('figure'), { className: 'curve', id: `curve-${plot.id}` });
    const caption = document.createElement('figcaption');
    const value = document.createElement('output');
    const isLog = this.logs.has(plot.id);
    caption.append(Object.assign(document.createElement('b'), { textContent: plot.title }), ` ${plot.unit} `, value);
    if (!plot.isSigned) caption.append(logButton(isLog, () => this.#setLog(plot.id, !isLog)));
    const box = document.createElement('div');
    figure.append(caption, box);
    this.place.append(figure);
    const axis = { stroke: ink, grid: { stroke: line, width: 1 }, ticks: { show: false }, font: '10px system-ui, sans-serif' };
    const chart = new uPlot({
      width: this.#width, height: HEIGHT, legend: { show: false }, padding: [6, 6, 0, 0], cursor: { show: false },
      scales: { x: { time: false }, y: isLog ? LOGARITHMIC : {
        range: ({ data }, low, high) => (low >= 0 ? [0, 1.06 * topOf(data[1])] : uPlot.rangeNum(low, high, 0.06, true)),
      } },
      axes: [
        { ...axis, size: 18, gap: 2, space: 46, values: (_, splits) => splits.map((at) => `${short(at)} s`) },
        { ...axis, size: 44, gap: 3, space: 22, values: (_, splits) => splits.map(short), ...(isLog ? LOGARITHMIC_AXIS : {}) },
      ],
      series: [{}, { stroke: plot.color, width: 1.4, points: { show: false } }],
      hooks: { draw: [(drawn) => this.#drawMarks(drawn, ink)] },
    }, [[], []], box);
    return { chart, value };
  }

  #setLog(id, isLog) {
    if (isLog) this.logs.add(id);
    else this.logs.delete(id);
    this.build();
    this.draw();
  }

  #drawMarks({ ctx, bbox, valToPos }, ink) {
    ctx.save();
    ctx.strokeStyle = ink;
    ctx.setLineDash([3, 3]);
    for (const mark of this.marks) {
      const x = Math.round(valToPos(mark, 'x', true));
      ctx.beginPath();
      ctx.moveTo(x, bbox.top);
      ctx.lineTo(x, bbox.top + bbox.height);
      ctx.stroke();
    }
    ctx.restore();
  }
}
