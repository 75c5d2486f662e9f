// Writes the meshes of this folder: node make.mjs [FOLDER]. Each part is a closed, convex solid of its own (`o` in the file), so
// that ./fulcrum drop, which makes a hull of each part, keeps the shape of the whole.
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';

import { writeWholeFile } from '../../Docs/wholeFile.mjs';

// A solid between rings of the same number of corners, each in a plane, counterclockwise seen from its end; flat at both ends.
function solidBetween(rings) {
  const corners = rings[0].length, vertices = rings.flat(), faces = [];
  for (let ring = 0; ring + 1 < rings.length; ++ring) {
    for (let i = 0; i < corners; ++i) {
      const next = (i + 1) % corners, below = ring * corners, above = below + corners;
      faces.push([below + i, below + next, above + next, above + i]);
    }
  }
  const all = [...Array(corners).keys()];
  faces.push([...all].reverse(), all.map((i) => (rings.length - 1) * corners + i));
  return { vertices, faces };
}

// About the y axis, through points (radius, height) from below to above.
function turned(profile, corners) {
  return solidBetween(profile.map(([radius, height]) => [...Array(corners).keys()].map((i) => {
    const angle = (-2 * Math.PI * i) / corners;
    return [radius * Math.cos(angle), height, radius * Math.sin(angle)];
  })));
}

// Pieces of a tube in the plane z = 0 along points (x, y, radius across, radius along z), each piece a solid.
function tube(points, corners) {
  const rings = points.map(([x, y, across, along], i) => {
    const before = points[Math.max(0, i - 1)], after = points[Math.min(points.length - 1, i + 1)];
    const length = Math.hypot(after[0] - before[0], after[1] - before[1]);
    const normal = [-(after[1] - before[1]) / length, (after[0] - before[0]) / length];
    return [...Array(corners).keys()].map((k) => {
      const angle = (-2 * Math.PI * k) / corners, out = across * Math.cos(angle);
      return [x + out * normal[0], y + out * normal[1], -along * Math.sin(angle)];
    });
  });
  return rings.slice(1).map((ring, i) => solidBetween([rings[i], ring]));
}

// 1.1 m wide with spout and handle.
function teapot() {
  const along = (count, point) => [...Array(count + 1).keys()].map((i) => point(i / count));
  const spout = along(4, (t) => [0.3 + 0.34 * t, 0.16 + 0.12 * t + 0.2 * t * t, 0.1 - 0.045 * t, 0.09 - 0.035 * t]);
  const handle = along(8, (t) => {
    const angle = (0.42 + 1.16 * t) * Math.PI;
    return [-0.34 + 0.24 * Math.cos(angle), 0.27 + 0.17 * Math.sin(angle), 0.042, 0.055];
  });
  const named = (name, solids) => solids.map((solid, i) => [solids.length > 1 ? `${name}${i + 1}` : name, solid]);
  return [
    ['foot', turned([[0.24, 0], [0.22, 0.05]], 24)],
    ['lower', turned([[0.25, 0.04], [0.37, 0.14], [0.4, 0.25]], 21)],
    ['upper', turned([[0.4, 0.25], [0.35, 0.38], [0.25, 0.46]], 21)],
    ['lid', turned([[0.24, 0.46], [0.23, 0.49], [0.1, 0.53]], 21)],
    ['knob', turned([[0.03, 0.52], [0.065, 0.57], [0.055, 0.61], [0.02, 0.63]], 12)],
    ...named('spout', tube(spout, 12)),
    ...named('handle', tube(handle, 8)),
  ];
}

// A profile that crosses itself would turn into a surface without an inside.
function requireSimple(profile) {
  const side = ([ax, ay], [bx, by], [x, y]) => Math.sign((bx - ax) * (y - ay) - (by - ay) * (x - ax));
  for (let i = 0; i + 1 < profile.length; ++i) {
    for (let k = i + 2; k + 1 < profile.length; ++k) {
      const [a, b, c, d] = [profile[i], profile[i + 1], profile[k], profile[k + 1]];
      if (side(a, b, c) !== side(a, b, d) && side(c, d, a) !== side(c, d, b)) throw new Error(`the profile crosses itself between points ${i} and ${k}`);
    }
  }
}

// A fountain of three basins, one surface: hollow, so it is for --onto.
function fountain() {
  const wall = 0.15, profile = [[0, 0], [4.9, 0], [5, 0.2], [5, 1]];
  for (const [radius, rim, next] of [[5, 1, 0.5], [2.9, 2.6, 0.38], [1.5, 3.8, 0.2]]) {
    profile.push([radius - wall, rim], [radius - 2 * wall, rim - 0.45], [next + 0.15, rim - 0.55]);
    if (next > 0.3) {
      const [wide, top] = next === 0.5 ? [2.9, 2.6] : [1.5, 3.8];
      profile.push([next, rim + 0.25], [next, top - 0.75], [wide - 0.25, top - 0.6], [wide, top - 0.2], [wide, top]);
    }
  }
  profile.push([0.14, 4.1], [0, 4.25]);
  requireSimple(profile);
  const corners = 48, vertices = [[0, profile[0][1], 0]], faces = [];
  const ringAt = (k, i) => 1 + (k - 1) * corners + (i % corners);
  for (const [radius, height] of profile.slice(1, -1)) {
    for (let i = 0; i < corners; ++i) {
      const angle = (-2 * Math.PI * i) / corners;
      vertices.push([radius * Math.cos(angle), height, radius * Math.sin(angle)]);
    }
  }
  const top = vertices.push([0, profile.at(-1)[1], 0]) - 1, last = profile.length - 2;
  for (let i = 0; i < corners; ++i) {
    faces.push([0, ringAt(1, i + 1), ringAt(1, i)], [top, ringAt(last, i), ringAt(last, i + 1)]);
    for (let k = 1; k < last; ++k) faces.push([ringAt(k, i), ringAt(k, i + 1), ringAt(k + 1, i + 1), ringAt(k + 1, i)]);
  }
  return [['fountain', { vertices, faces }]];
}

function objOf(comment, parts) {
  const lines = [`# ${comment}, meters. Written by make.mjs.`];
  const digits = (value) => String(Number(value.toFixed(4)));
  let first = 1;
  for (const [name, { vertices, faces }] of parts) {
    lines.push(`o ${name}`, ...vertices.map((vertex) => `v ${vertex.map(digits).join(' ')}`));
    lines.push(...faces.map((face) => `f ${face.map((corner) => corner + first).join(' ')}`));
    first += vertices.length;
  }
  return `${lines.join('\n')}\n`;
}

const folder = process.argv[2] ?? dirname(fileURLToPath(import.meta.url));
writeWholeFile(join(folder, 'teapot.obj'), objOf('A teapot', teapot()));
writeWholeFile(join(folder, 'fountain.obj'), objOf('A fountain of three basins', fountain()));
