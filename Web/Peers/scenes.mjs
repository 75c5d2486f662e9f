// Performance scenes as plain numbers, so that every engine builds the same ones; Samples/Scenes has them for Fulcrum alone.
// A scene: shapes { box: half extents } | { sphere: radius } | { hull: points }, bodies [shape, position, isStatic?], joints
// [body, body, point], and how far a run is off. Gravity 9.81, 1000 kg/m3, friction 0.5, no restitution, no sleeping, 1/60 s.

const floor = (x, z) => [{ box: [x, 1, z] }, [0, -1, 0], true];
const CUBE = { box: [0.5, 0.5, 0.5] };

function pyramid() {
  const bodies = [floor(50, 50)], shape = { box: [1, 1, 1] };
  for (let i = 0; i < 15; ++i)
    for (let j = i >> 1; j < 15 - ((i + 1) >> 1); ++j)
      for (let k = i >> 1; k < 15 - ((i + 1) >> 1); ++k)
        bodies.push([shape, [-15 + 2 * j + (i & 1), 1 + 2.5 * i, -15 + 2 * k + (i & 1)]]);
  return { steps: 300, bodies, meaning: 'top box, m', off: (run) => run.position(bodies.length - 1)[1] - 29 };
}

function flatPyramid(bodies, base, x, z) {
  for (let i = 0; i < base; ++i) for (let j = i; j < base; ++j) bodies.push([CUBE, [x + (i + 1) / 2 + (j - i) - base / 2, i + 0.5, z]]);
  return bodies.length - 1;
}

function largePyramid() {
  const bodies = [floor(400, 400)], top = flatPyramid(bodies, 100, 0, 0);
  return { steps: 200, bodies, meaning: 'top box, m', off: (run) => run.position(top)[1] - 99.5 };
}

function manyPyramids() {
  const bodies = [floor(100, 100)], tops = [];
  for (let row = 0; row < 14; ++row) for (let column = 0; column < 14; ++column) tops.push(flatPyramid(bodies, 10, 12 * (column - 6.5), 10 * (row - 6.5)));
  return { steps: 100, bodies, meaning: 'top box, m', off: (run) => Math.max(...tops.map((top) => Math.abs(run.position(top)[1] - 9.5))) };
}

function hullPile() {
  const points = Array.from({ length: 32 }, (_, n) => {
    const y = 1 - (2 * n + 1) / 32, angle = n * Math.PI * (3 - Math.sqrt(5)), r = Math.sqrt(1 - y * y);
    return [2 * r * Math.cos(angle), 2 * y, 2 * r * Math.sin(angle)];
  });
  const shape = { hull: points }, bodies = [floor(250, 250)];
  for (let layer = 0; layer < 40; ++layer) for (let x = 0; x < 8; ++x) for (let z = 0; z < 8; ++z) bodies.push([shape, [4 * (x - 4), 2 + 4 * layer, 4 * (z - 4)]]);
  const lowest = (run) => Math.min(...bodies.slice(1).map((_, i) => run.position(i + 1)[1]));
  return { steps: 300, bodies, meaning: 'lowest body, m', off: (run) => Math.min(0, lowest(run) - 1.8) };
}

function jointGrid() {
  const bodies = [], joints = [], shape = { sphere: 0.4 };
  for (let i = 0; i < 100; ++i)
    for (let k = 0; k < 100; ++k) {
      bodies.push([shape, [k, -i, 0], i === 0]);
      const body = bodies.length - 1;
      if (i > 0) joints.push([body - 100, body, [k, -i + 0.5, 0]]);
      if (k > 0 && i > 0) joints.push([body - 1, body, [k - 0.5, -i, 0]]);
    }
  // Where the two bodies have the point that they share, from their poses; the bodies begin unturned.
  const at = (run, body, point) => {
    const [x, y, z, w] = run.rotation(body), p = point.map((value, k) => value - bodies[body][1][k]);
    const t = [2 * (y * p[2] - z * p[1]), 2 * (z * p[0] - x * p[2]), 2 * (x * p[1] - y * p[0])];
    const turned = [p[0] + w * t[0] + y * t[2] - z * t[1], p[1] + w * t[1] + z * t[0] - x * t[2], p[2] + w * t[2] + x * t[1] - y * t[0]];
    return turned.map((value, k) => value + run.position(body)[k]);
  };
  const gap = (run, [a, b, point]) => {
    const from = at(run, a, point), to = at(run, b, point);
    return Math.hypot(...from.map((value, k) => to[k] - value));
  };
  return { steps: 100, bodies, joints, collides: false, meaning: 'largest gap, m', off: (run) => Math.max(...joints.map((joint) => gap(run, joint))) };
}

export const SCENES = { pyramid, large_pyramid: largePyramid, many_pyramids: manyPyramids, hull_pile: hullPile, joint_grid: jointGrid };
