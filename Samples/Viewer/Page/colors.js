// The colors of bodies, by what the user wants to see in them.
import { Color } from 'three';
import { lookColor } from './looks.js';

// The same number for the same id, with neighboring ids far apart: the fractions of the golden ratio.
const scattered = (id) => (id * 0.6180339887498949) % 1;

const VARIANTS = 16;
// Of one color: neighbors are told apart by a little light and tone. `hue`: by how much of a turn at most, half of it to each side.
function variantsOf(hex, hue) {
  return Array.from({ length: VARIANTS }, (_, i) => {
    const light = scattered(i + 1) - 0.5, turn = scattered(5 * i + 2) - 0.5;
    return new Color(hex).offsetHSL(hue * turn, 0.04 * turn, 0.13 * light);
  });
}
const PLAIN = ['#4f86d9', '#ef9f4a', '#52b080', '#de6f8d', '#8a78dd'].map((hex) => variantsOf(hex, 0.055));
const ISLANDS = ['#4484dc', '#ef8d4f', '#4fb178', '#df6464', '#8a74dc', '#e3b53c', '#3fb3bd', '#d77bb5'].map((hex) => variantsOf(hex, 0.03));
const SPEEDS = ['#86a3c8', '#4fa3cc', '#4fb890', '#dccb4c', '#f0963a', '#d63c2c'].map((hex) => new Color(hex));
const ALONE = variantsOf('#aab2ba', 0);
const FIXED = new Color(), DRIVEN = new Color();
const GLASS = new Color('#3aa7c2');
const AWAKE = variantsOf('#f2a45c', 0.03);
const ASLEEP = variantsOf('#7d93aa', 0.03);
export const GROUND = { light: '#d9dcde', dark: '#4a545f' };
const DRIVEN_OF = { light: '#9aa7b4', dark: '#6d7a88' };
// Of what does not move by itself; colors of bodies that do are the same by day and night.
export function setTheme(theme) {
  FIXED.set(GROUND[theme]);
  DRIVEN.set(DRIVEN_OF[theme]);
}
export const SELECTED = new Color('#ff4d1c');

function ramp(colors, fraction, out) {
  const at = Math.min(1, Math.max(0, fraction)) * (colors.length - 1);
  const low = Math.min(colors.length - 2, Math.floor(at));
  return out.lerpColors(colors[low], colors[low + 1], at - low);
}

const variant = (variants, body) => variants[Math.floor(VARIANTS * scattered(body + 1))];

// The speed that the scale ends at: 99 % of the moving samples are slower.
export function topSpeed({ samples }) {
  const speeds = [];
  const step = Math.max(1, Math.floor(samples.frames.length / 50000));
  for (let i = 0; i < samples.frames.length; i += step) {
    const speed = Math.hypot(samples.velocities[3 * i], samples.velocities[3 * i + 1], samples.velocities[3 * i + 2]);
    if (speed > 0.05) speeds.push(speed);
  }
  speeds.sort((a, b) => a - b);
  const top = speeds[Math.floor(0.99 * speeds.length)] ?? 1;
  const magnitude = 10 ** Math.floor(Math.log10(top));
  return Math.ceil(top / magnitude) * magnitude;
}

const byMode = {
  plain: (timeline, body, recording, top, out) => out.copy(variant(PLAIN[recording.bodies.shapes[body] % PLAIN.length], body)),
  island: (timeline, body, recording, top, out) => {
    const island = timeline.island(body);
    return out.copy(variant(island < 0 ? ALONE : ISLANDS[Math.floor(scattered(island + 1) * ISLANDS.length)], body));
  },
  speed: (timeline, body, recording, top, out) => ramp(SPEEDS, timeline.speed(body) / top, out),
  awake: (timeline, body, recording, top, out) => out.copy(variant(timeline.isAwake(body) ? AWAKE : ASLEEP, body)),
};
export const MODES = Object.keys(byMode);

// `top`: what topSpeed returns. Static and kinematic bodies and sensors keep a color of their own.
export function colorOf(mode, timeline, body, top, out) {
  const { recording } = timeline;
  if (recording.isSensor[body]) return out.copy(GLASS);
  const motion = recording.bodies.motions[body];
  const look = motion === 2 && mode !== 'plain' ? undefined : lookColor(recording, body, timeline.presence(body)?.shape ?? recording.bodies.shapes[body]);
  if (look && mode !== 'speed') return out.copy(look);
  if (motion === 0) return out.copy(look ?? FIXED);
  if (motion === 1 && mode !== 'speed') return out.copy(DRIVEN);
  return byMode[mode](timeline, body, recording, top, out);
}

const key = ([color], text) => `<div class="key"><i style="background:#${color.getHexString()}"></i>${text}</div>`;

export function legend(mode, top) {
  if (mode === 'speed') {
    const stops = SPEEDS.map((color) => `#${color.getHexString()}`).join(',');
    return `<div class="scale" style="background:linear-gradient(90deg,${stops})"></div>` +
      `<div class="ends"><span>0</span><span>${Number(top.toPrecision(3))} m/s</span></div>`;
  }
  if (mode === 'awake') return key(AWAKE, 'awake') + key(ASLEEP, 'asleep');
  if (mode === 'island') return key(ALONE, 'in no island') + 'one color an island';
  return '';
}
