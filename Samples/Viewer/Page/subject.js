// What the picture is about: what the scene says, or the bodies that move, or those that could, or all, and what stands among
// them; without the few that flew far away, or left the ground. And where a ground without an end may be drawn.
import { Quaternion, Vector3 } from 'three';
import { includeLeaf, leavesOf, outerRadius } from './shapes.js';

const MOMENTS = [0, 0.12, 0.25, 0.38, 0.5, 0.62, 0.75, 0.88, 1];
const STRAYS = 0.01;   // of the places at either end of each axis
const FAR_STRAY = 0.4; // of the others' extent: strays nearer than this are shown
const MOST = 3000;     // bodies that are asked where they are: of more, evenly chosen ones
const AMONG = 1.3;     // of the radius: what stands farther away from the middle is not meant

// The range of values, without strays.
function rangeOf(lower, upper) {
  const low = Float64Array.from(lower).sort(), high = Float64Array.from(upper).sort();
  const cut = Math.floor(STRAYS * low.length), last = high.length - 1;
  const extent = high[last - cut] - low[cut];
  return [
    low[cut] - low[0] > FAR_STRAY * extent ? low[cut] : low[0],
    high[last] - high[last - cut] > FAR_STRAY * extent ? high[last - cut] : high[last],
  ];
}

// Widens `lower` and `upper` by a body as it stands.
function includeBody({ bodies, shapes }, timeline, body, lower, upper) {
  const place = new Vector3().fromArray(timeline.positions, 3 * body), turn = new Quaternion().fromArray(timeline.rotations, 4 * body).normalize();
  const leafPlace = new Vector3(), leafTurn = new Quaternion(), scratch = new Vector3();
  for (const { shape, position, rotation } of leavesOf(shapes, bodies.shapes[body])) {
    leafPlace.copy(position).applyQuaternion(turn).add(place);
    includeLeaf(shape, leafPlace, leafTurn.copy(turn).multiply(rotation), lower, upper, scratch);
  }
}

// The box around all static bodies.
function boundsOfGround(recording, timeline) {
  const lower = new Vector3().setScalar(Infinity), upper = new Vector3().setScalar(-Infinity);
  recording.bodies.motions.forEach((motion, body) => {
    if (motion === 0 && !recording.isSensor[body]) includeBody(recording, timeline, body, lower, upper);
  });
  return { lower, upper };
}

// [x, y, z, 0] of a box, whose ranges are given.
export const cornersOf = (ranges) => [0, 1, 2, 3, 4, 5, 6, 7].map((corner) => [...ranges.map((range, k) => range[(corner >> k) & 1]), 0]);

// Those of the places that are over the ground; all, where they did not begin there.
function keepOverGround(places, countAtStart, { lower, upper }) {
  const isOver = ([x, y, z]) => x >= lower.x && x <= upper.x && z >= lower.z && z <= upper.z && y >= lower.y;
  const over = places.filter(isOver);
  return 2 * places.slice(0, countAtStart).filter(isOver).length > countAtStart ? over : places;
}

// { center, half, radius, lowest } in meters, the box of what the picture is about; `places`: [x, y, z, radius], balls that are to be in
// the picture; `typical`: the radius of a body of middle size; `from`: towards the camera, undefined where the scene does not say;
// `isLabelled`: whether room is needed for labels. `moments`: when the bodies are looked at, parts of the run. The timeline is at its
// beginning afterwards.
export function findSubject(recording, timeline, moments = MOMENTS) {
  const { motions, shapes } = recording.bodies;
  const dynamic = [...motions.keys()].filter((body) => motions[body] === 2);
  const moving = recording.movers.filter((body) => motions[body] === 2);
  const all = [moving, dynamic, [...motions.keys()]].find((list) => list.length > 0) ?? [];
  const every = Math.ceil(all.length / MOST);
  const bodies = all.filter((_, i) => i % every === 0 || i === all.length - 1);
  const radii = recording.shapes.map((_, index) => outerRadius(recording.shapes, index));
  const sizes = bodies.map((body) => radii[shapes[body]]).sort((a, b) => a - b);
  const typical = sizes[sizes.length >> 1] ?? 1;
  const placeOf = (body) => [...timeline.positions.subarray(3 * body, 3 * body + 3), radii[shapes[body]]];

  const placesAt = (moment) => {
    timeline.seek(moment * timeline.lastFrame);
    return bodies.filter((body) => timeline.isThere(body)).map(placeOf);
  };
  const placesIn = (list) => {
    const byMoment = list.map(placesAt);
    timeline.seek(0);
    return keepOverGround(byMoment.flat(), byMoment[0].length, boundsOfGround(recording, timeline));
  };
  const places = placesIn(moments);
  const rangesOf = (list) => [0, 1, 2].map((k) => (list.length > 0
    ? rangeOf(list.map((place) => place[k] - place[3]), list.map((place) => place[k] + place[3])) : [0, 0]));
  const frame = (ranges) => {
    const half = ranges.map(([low, high]) => (high - low) / 2);
    return { center: ranges.map(([low, high]) => (low + high) / 2), half, radius: Math.max(1e-3, Math.hypot(...half)) };
  };
  // What is driven belongs to the run, what is fixed to the moments.
  const mobile = frame(rangesOf(places)), ofRun = moments === MOMENTS ? mobile : frame(rangesOf(placesIn(MOMENTS)));
  const isAmong = (body) => {
    const { center, radius } = motions[body] === 1 ? ofRun : mobile;
    return radii[shapes[body]] < radius && Math.hypot(...placeOf(body).slice(0, 3).map((x, k) => x - center[k])) < AMONG * radius;
  };
  const boxAround = (body) => {
    const lower = new Vector3().setScalar(Infinity), upper = new Vector3().setScalar(-Infinity);
    includeBody(recording, timeline, body, lower, upper);
    return Number.isFinite(lower.x) ? cornersOf(['x', 'y', 'z'].map((axis) => [lower[axis], upper[axis]])) : [];
  };
  const among = [...motions.keys()].filter((body) => motions[body] !== 2 && isAmong(body));
  const standing = among.flatMap(boxAround), driven = among.filter((body) => motions[body] === 1 && recording.movers.includes(body));
  // What is driven is in the picture wherever it goes among the others.
  for (const moment of driven.length > 0 ? moments : []) {
    timeline.seek(moment * timeline.lastFrame);
    standing.push(...driven.filter((body) => timeline.isThere(body) && isAmong(body)).flatMap(boxAround));
  }
  timeline.seek(0);
  const overPulleys = recording.joints.flatMap(({ isRope, points }) => (isRope ? points.map((point) => [...point, 0]) : []));
  const seen = places.concat(standing, overPulleys);
  let ranges = rangesOf(seen), shown;
  const { lower, upper, from } = recording.view ?? {};
  const isLabelled = !lower && Object.keys(recording.bodies.names ?? {}).length > 0;
  if (lower) {
    ranges = [0, 1, 2].map((k) => [lower[k], upper[k]]);
    shown = cornersOf(ranges);
  } else {
    shown = seen.filter((place) => ranges.every(([low, high], k) => place[k] + place[3] >= low && place[k] - place[3] <= high));
  }
  return { ...frame(ranges), lowest: ranges[1][0], places: shown, typical, from, isLabelled };
}

// The height of a ground without an end that contradicts nothing: that of a floor which nothing falls off, under what is static and
// holds all that moves, or, where nothing static is below the subject, just under all that moves. Undefined where there is none.
export function groundHeight(recording, timeline, subject) {
  const { motions, shapes } = recording.bodies, { samples } = recording;
  let lowestEver = Infinity;
  motions.forEach((motion, body) => {
    if (motion !== 2) return;
    for (let i = samples.starts[body]; i < samples.starts[body + 1]; ++i) lowestEver = Math.min(lowestEver, samples.positions[3 * i + 1]);
  });
  let floor = -Infinity, hasGround = false;
  motions.forEach((motion, body) => {
    const shape = recording.shapes[shapes[body]];
    if (motion !== 0 || recording.isSensor[body] || outerRadius(recording.shapes, shapes[body]) < 0.6 * subject.radius) return;
    hasGround = true;
    const turn = Math.abs(timeline.rotations[4 * body + 3]);
    if (shape.kind === 'box' && turn > 0.99999 && Math.min(shape.halfExtents[0], shape.halfExtents[2]) > 0.3 * subject.radius)
      floor = Math.max(floor, timeline.positions[3 * body + 1] + shape.halfExtents[1]);
  });
  if (floor > -Infinity) return lowestEver > floor - 0.5 * subject.typical ? floor - 2e-3 * subject.radius : undefined;
  if (hasGround) {
    const { y } = boundsOfGround(recording, timeline).lower;
    return y > -1e3 * subject.radius && lowestEver > y ? y : undefined;
  }
  if (lowestEver < subject.lowest - 0.3 * subject.radius) return undefined;
  return subject.lowest - 0.02 * subject.radius;
}

// Whether what is fixed or driven stands around and above the subject, so that one would not see it: a roof, or what is high up.
export function isEnclosed(recording, timeline, { center, half, radius }) {
  const { motions, shapes } = recording.bodies;
  return motions.some((motion, body) => {
    if (motion === 2 || recording.isSensor[body]) return false;
    const [x, y, z] = [0, 1, 2].map((k) => timeline.positions[3 * body + k] - center[k]);
    const isRoof = y > 0.8 * half[1] && Math.max(Math.abs(x), Math.abs(z)) < 0.5 * radius && outerRadius(recording.shapes, shapes[body]) > 0.8 * radius;
    return isRoof || (y > 0.7 * radius && Math.abs(x) < radius && Math.abs(z) < radius);
  });
}
