// What the picture is about: the bodies that move, or those that could, or all; without the few that flew far away.
import { outerRadius } from './shapes.js';

const MOMENTS = [0, 0.25, 0.5, 0.75, 1];
const LEFT_OUT = 0.01; // of the bodies at either end of each axis

function middle(values) {
  const sorted = Float64Array.from(values).sort();
  const cut = Math.floor(LEFT_OUT * sorted.length);
  return [sorted[cut], sorted[sorted.length - 1 - cut]];
}

// { centre, radius, lowest } in metres, and `typical`: the radius of a body of middle size.
export function findSubject(recording, timeline) {
  const { motions, shapes } = recording.bodies;
  const dynamic = [...motions.keys()].filter((body) => motions[body] === 2);
  const moving = recording.movers.filter((body) => motions[body] === 2);
  const bodies = [moving, dynamic, [...motions.keys()]].find((list) => list.length > 0) ?? [];
  const radii = recording.shapes.map((_, index) => outerRadius(recording.shapes, index));
  const sizes = bodies.map((body) => radii[shapes[body]]).sort((a, b) => a - b);
  const typical = sizes[sizes.length >> 1] ?? 1;

  const places = [[], [], []];
  for (const moment of MOMENTS) {
    timeline.seek(moment * timeline.lastFrame);
    for (const body of bodies) {
      if (timeline.isThere(body)) for (let k = 0; k < 3; ++k) places[k].push(timeline.positions[3 * body + k]);
    }
  }
  timeline.seek(0);
  const ranges = places.map((values) => (values.length > 0 ? middle(values) : [0, 0]));
  const centre = ranges.map(([low, high]) => (low + high) / 2);
  const radius = Math.hypot(...ranges.map(([low, high]) => (high - low) / 2)) + typical;
  return { centre, radius, lowest: ranges[1][0] - typical, typical };
}

// Whether a static body offers a floor to the subject.
export function hasFloor(recording, subject) {
  const { motions, shapes } = recording.bodies;
  return motions.some((motion, body) => motion === 0 && !recording.isSensor[body] && outerRadius(recording.shapes, shapes[body]) > 0.8 * subject.radius);
}

// Whether what is fixed or driven stands around and above the subject, so that one would not see it.
export function isEnclosed(recording, timeline, subject) {
  return recording.bodies.motions.some((motion, body) => motion !== 2 && !recording.isSensor[body] &&
    timeline.positions[3 * body + 1] > subject.centre[1] + 0.7 * subject.radius &&
    Math.abs(timeline.positions[3 * body] - subject.centre[0]) < subject.radius &&
    Math.abs(timeline.positions[3 * body + 2] - subject.centre[2]) < subject.radius);
}
