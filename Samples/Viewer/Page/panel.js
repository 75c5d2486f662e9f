// The texts beside the picture.
import { describe } from './shapes.js';

const element = (id) => document.getElementById(id);

function list(lines) {
  const dl = document.createElement('dl');
  for (const [label, value] of lines) {
    dl.append(Object.assign(document.createElement('dt'), { textContent: label }), Object.assign(document.createElement('dd'), { textContent: value }));
  }
  return dl;
}

export function showTexts(recording) {
  document.title = `${recording.title} · Fulcrum`;
  element('title').textContent = recording.title;
  element('description').textContent = recording.description;
  const sections = new Map();
  for (const [section, label, value] of recording.report) {
    if (!sections.has(section)) sections.set(section, []);
    sections.get(section).push([label, value]);
  }
  for (const [name, lines] of sections) {
    const section = document.createElement('section');
    section.append(Object.assign(document.createElement('h2'), { textContent: name }), list(lines));
    element('report').append(section);
  }
  element('contact-note').textContent = contactNote(recording);
}

function contactNote({ contacts, contactInterval, largestContactCut }) {
  if (contacts.every(({ count }) => count === 0)) return 'The recording has no contacts.';
  const parts = [];
  if (contactInterval > 1) parts.push(`Contacts are recorded every ${contactInterval} frames.`);
  if (largestContactCut > 0) parts.push(`Up to ${largestContactCut.toLocaleString('en')} contacts of a frame are left out.`);
  return parts.join(' ');
}

const MOTIONS = ['static', 'kinematic', 'dynamic'];

// What is known of a body at the timeline's moment; also what tests read.
export function bodyInfo(recording, timeline, body) {
  const shape = recording.shapes[recording.bodies.shapes[body]];
  const motion = MOTIONS[recording.bodies.motions[body]];
  return {
    id: body,
    name: recording.bodies.names[body] ?? '',
    shape: shape.name && shape.name !== shape.kind ? `${shape.name}: ${describe(shape)}` : describe(shape),
    motion,
    mass: motion === 'dynamic' ? recording.bodies.masses[body] : null,
    position: [...timeline.positions.subarray(3 * body, 3 * body + 3)],
    velocity: [...timeline.velocity(body)],
    speed: timeline.speed(body),
    awake: motion === 'dynamic' ? timeline.isAwake(body) : null,
    island: timeline.island(body),
  };
}

const vector = (values, digits) => values.map((value) => value.toFixed(digits)).join(', ').replaceAll('-', '−');

export function showBody(info) {
  if (!info) {
    element('body').replaceChildren(Object.assign(document.createElement('p'), { className: 'note', textContent: 'Click a body in the picture.' }));
    return;
  }
  const lines = [['Id', String(info.id)]];
  if (info.name) lines.push(['Name', info.name]);
  lines.push(['Shape', info.shape], ['Motion', info.motion]);
  if (info.mass !== null) lines.push(['Mass', `${Number(info.mass.toPrecision(4)).toLocaleString('en')} kg`]);
  lines.push(['Position', `${vector(info.position, 3)} m`]);
  if (info.motion !== 'static') lines.push(['Velocity', `${vector(info.velocity, 2)} m/s`], ['Speed', `${info.speed.toFixed(3)} m/s`]);
  if (info.awake !== null) lines.push(['State', info.awake ? 'awake' : 'asleep']);
  lines.push(['Island', info.island < 0 ? 'none' : String(info.island)]);
  element('body').replaceChildren(list(lines));
}

export function showMessage(text) {
  element('message').textContent = text;
}
