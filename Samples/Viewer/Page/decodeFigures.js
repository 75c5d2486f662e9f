// Reads the series that PageFigures.cpp writes: { name: Float32Array, one number a frame }, and the series that the page makes
// of them. Times of stages are those named "ms ...".

export function decodeFigures(header, bytes) {
  const names = header.figures ?? [], count = header.times.length;
  const view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  return Object.fromEntries(names.map((name, k) => [
    name, Float32Array.from({ length: count }, (_, i) => view.getFloat32(4 * (k * count + i), true)),
  ]));
}

// The stages' times, the most expensive ones by themselves and the others as one: [{ name, values }], ms a step.
export function stagesOf(figures, most = 5) {
  const mean = (values) => values.reduce((sum, x) => sum + x, 0) / Math.max(1, values.length);
  const stages = Object.entries(figures).filter(([name]) => name.startsWith('ms '))
    .map(([name, values]) => ({ name: name.slice(3), values, mean: mean(values) }));
  const byCost = [...stages].sort((a, b) => b.mean - a.mean);
  const alone = new Set(byCost.slice(0, most));
  const rest = stages.filter((stage) => !alone.has(stage));
  const shown = stages.filter((stage) => alone.has(stage));
  if (rest.length > 0) shown.push({ name: 'other', values: rest[0].values.map((_, i) => rest.reduce((sum, { values }) => sum + values[i], 0)) });
  return shown.map(({ name, values }) => ({ name, values }));
}

// Where a series is largest; -1 where it is zero all over.
export function peakOf(values) {
  let at = -1;
  for (let i = 0; i < values.length; ++i) if (values[i] > (at < 0 ? 0 : values[at])) at = i;
  return at;
}
