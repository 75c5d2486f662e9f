// What materials look like, in the order of Look (Samples/Scenes/SceneView.h), and the teeth of gears.
import { Color, ExtrudeGeometry, Shape } from 'three';

const LOOKS = [null, '#8dae66', '#cfe8f4', '#4b4d57', '#cfa552', '#c09a6b', '#b9b3a8', '#454b54', '#a4d4e0'].map((hex) => hex && new Color(hex));
const WHITE = new Color('#ffffff');
export const BRASS = 4, GLASS = 8; // with materials of their own

// The color of a body's material or of its surface's, undefined where it has none. A surface of several is painted itself.
export function lookColor(recording, body, shape) {
  if (recording.shapes[shape]?.looks) return WHITE;
  return LOOKS[recording.lookOf.get(body)?.look ?? 0] ?? undefined;
}
export const triangleColor = (look) => LOOKS[look] ?? WHITE;

// A gear about z with the pitch radius of the disk that the engine collides with; its teeth reach as far beyond it as they
// are cut into it, so that two gears mesh.
export function gearGeometry(vertices, teeth, phase) {
  const radius = Math.max(...vertices.map(([x, y]) => Math.hypot(x, y))), half = Math.max(...vertices.map(([, , z]) => Math.abs(z)));
  const module = (2 * radius) / teeth, outer = radius + 0.8 * module, root = radius - 0.9 * module;
  const outline = new Shape();
  for (let tooth = 0; tooth < teeth; ++tooth) {
    const at = (part) => phase + ((tooth + part) * 2 * Math.PI) / teeth;
    for (const [part, r] of [[-0.3, root], [-0.13, outer], [0.13, outer], [0.3, root]]) {
      const point = [r * Math.cos(at(part)), r * Math.sin(at(part))];
      if (tooth === 0 && part === -0.3) outline.moveTo(...point);
      else outline.lineTo(...point);
    }
  }
  outline.closePath();
  const bore = new Shape();
  bore.absarc(0, 0, 0.18 * radius, 0, 2 * Math.PI, true);
  outline.holes.push(bore);
  // Its edges are beveled, so that they catch the light.
  const bevel = Math.min(0.12 * module, 0.2 * half);
  return new ExtrudeGeometry(outline, {
    depth: 2 * (half - bevel), curveSegments: 24, bevelThickness: bevel, bevelSize: bevel, bevelOffset: -bevel, bevelSegments: 1,
  }).translate(0, 0, bevel - half);
}
