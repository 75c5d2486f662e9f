// Reads the lines and points that PageDrawings.cpp writes; the format is described in PageDrawings.h.

// `places` numbers of the frame before become those of this one; further ones follow the one before in this frame.
function decodeKind(reader, places, latest, step) {
  const count = reader.unsigned();
  latest.length = Math.min(latest.length, count);
  const result = { count, places: new Float32Array(places * count), colors: new Uint32Array(count) };
  for (let i = 0; i < count; ++i) {
    if (i === latest.length) {
      const before = latest[i - 1] ?? { color: 0, steps: new Float64Array(places) };
      latest.push({ color: before.color, steps: before.steps.map((_, k) => before.steps[k % 3]) });
    }
    const item = latest[i];
    item.color += reader.signed();
    for (let k = 0; k < places; ++k) result.places[places * i + k] = (item.steps[k] += reader.signed()) * step;
    result.colors[i] = item.color;
  }
  return result;
}

// One of each frame: lines (six numbers a place) and points (three), meters, with colors 0xRRGGBB. Empty where nothing is
// drawn in any frame.
export function decodeDrawings(header, reader) {
  const { step, mostLines, mostPoints } = header.drawings;
  if (mostLines + mostPoints === 0) return [];
  const lines = [], points = [];
  return header.times.map(() => ({ lines: decodeKind(reader, 6, lines, step), points: decodeKind(reader, 3, points, step) }));
}
