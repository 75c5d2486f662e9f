// What the picture is about: the bodies that move, or those that could, or all, and what stands among them; without the few that
// flew far away, or left the ground.
import { Quaternion, Vector3 } from 'three';
import { includeLeaf, leavesOf, outerRadius } from './shapes.js';

const MOMENTS = [0, 0.25, 0.5, 0.75, 1];
const LEFT_OUT = 0.01; // of the bodies at either end of each axis
const AMONG = 3;       // of the radius: what stands farther away from the middle is not meant

function middle(values) {
  const sorted = Float64Array.from(values).sort();
  const cut = Math.floor(LEFT_OUT * sorted.length);
  return [sorted[cut], sorted[sorted.length - 1 - cut]];
}

// The box around all static bodies.
function boundsOfGround({ bodies, shapes, isSensor }, timeline) {
  const lower = new Vector3().setScalar(Infinity), upper = new Vector3().setScalar(-Infinity);
  const place = new Vector3(), turn = new Quaternion(), leafPlace = new Vector3(), leafTurn = new Quaternion(), scratch = new Vector3();
  bodies.motions.forEach((motion, body) => {
    if (motion !== 0 || isSensor[body]) return;
    place.fromArray(timeline.positions, 3 * body);
    turn.fromArray(timeline.rotations, 4 * body).normalize();
    for (const { shape, position, rotation } of leavesOf(shapes, bodies.shapes[body])) {
      leafPlace.copy(position).applyQuaternion(turn).add(place);
      includeLeaf(shape, leafPlace, leafTurn.copy(turn).multiply(rotation), lower, upper, scratch);
    }
  });
  return { lower, upper };
}

// Those of the places that are over the ground; all, where they did not begin there.
function keepOverGround(places, countAtStart, { lower, upper }) {
  const isOver = ([x, y, z]) => x >= lower.x && x <= upper.x && z >= lower.z && z <= upper.z && y >= lower.y;
  const over = places.filter(isOver);
  return 2 * places.slice(0, countAtStart).filter(isOver).length > countAtStart ? over : places;
}

const rangesOf = (places) => [0, 1, 2].map((k) => (places.length > 0 ? middle(places.map((place) => place[k])) : [0, 0]));

// { center, half, radius, lowest } in meters, and `typical`: the radius of a body of middle size.
export function findSubject(recording, timeline) {
  const { motions, shapes } = recording.bodies;
  const dynamic = [...motions.keys()].filter((body) => motions[body] === 2);
  const moving = recording.movers.filter((body) => motions[body] === 2);
  const bodies = [moving, dynamic, [...motions.keys()]].find((list) => list.length > 0) ?? [];
  const radii = recording.shapes.map((_, index) => outerRadius(recording.shapes, index));
  const sizes = bodies.map((body) => radii[shapes[body]]).sort((a, b) => a - b);
  const typical = sizes[sizes.length >> 1] ?? 1;
  const placeOf = (body) => [...timeline.positions.subarray(3 * body, 3 * body + 3)];

  const placesAt = (moment) => {
    timeline.seek(moment * timeline.lastFrame);
    return bodies.filter((body) => timeline.isThere(body)).map(placeOf);
  };
  const byMoment = MOMENTS.map(placesAt);
  timeline.seek(0);
  const places = keepOverGround(byMoment.flat(), byMoment[0].length, boundsOfGround(recording, timeline));
  const frame = (ranges) => ({
    center: ranges.map(([low, high]) => (low + high) / 2),
    half: ranges.map(([low, high]) => (high - low) / 2),
    radius: Math.hypot(...ranges.map(([low, high]) => (high - low) / 2)) + typical,
  });
  const mobile = frame(rangesOf(places));
  const isAmong = (body) => radii[shapes[body]] < mobile.radius &&
    Math.hypot(...placeOf(body).map((x, k) => x - mobile.center[k])) < AMONG * mobile.radius;
  const standing = [...motions.keys()].filter((body) => motions[body] !== 2 && isAmong(body)).map(placeOf);
  const ranges = rangesOf(places.concat(standing));
  return { ...frame(ranges), lowest: ranges[1][0] - typical, typical };
}

// Whether a static body offers a floor to the subject.
export function hasFloor(recording, subject) {
  const { motions, shapes } = recording.bodies;
  return motions.some((motion, body) => motion === 0 && !recording.isSensor[body] && outerRadius(recording.shapes, shapes[body]) > 0.8 * subject.radius);
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
