// When bodies are there, and with which shape. A body may come after the first frame, go before the last, and change its shape
// in between.

// Of each body, in the order of time: [{ shape, from, until }], frames from <= frame < until.
export function presencesOf({ bodies, bodyCount, frameCount, samples, shapeChanges }) {
  const changes = new Map();
  for (const [frame, body, shape] of shapeChanges) {
    if (!changes.has(body)) changes.set(body, []);
    changes.get(body).push({ frame, shape });
  }
  return Array.from({ length: bodyCount }, (_, body) => {
    const first = samples.starts[body], end = samples.starts[body + 1];
    if (first === end) return [];
    const gone = samples.gone[end - 1] ? samples.frames[end - 1] : Math.max(1, frameCount);
    const result = [{ shape: bodies.shapes[body], from: samples.frames[first], until: gone }];
    for (const { frame, shape } of changes.get(body) ?? []) {
      const last = result.at(-1);
      if (frame <= last.from) last.shape = shape;
      else if (frame < gone) {
        last.until = frame;
        result.push({ shape, from: frame, until: gone });
      }
    }
    return result;
  });
}

// The one of a body at a frame, undefined where it is not there.
export function presenceAt(presences, frame) {
  const whole = Math.floor(frame);
  return presences.find(({ from, until }) => from <= whole && whole < until);
}

// Whether what is drawn of a body never changes because of these.
export const isAlwaysTheSame = (presences, frameCount) =>
  presences.length === 1 && presences[0].from === 0 && presences[0].until >= frameCount;
