// The texts beside the picture.
import { stateAt } from './jointPose.js';
import { MOST_WITH_FRAMES, MOST_WITH_LIMITS } from './joints.js';
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
  element('joints').hidden = recording.joints.length === 0;
  document.querySelector('#toggles input[value=joints]').parentElement.hidden = recording.joints.length === 0;
  document.querySelector('#toggles input[value=labels]').parentElement.hidden = Object.keys(recording.bodies.names).length === 0;
  document.querySelector('#toggles input[value=drawings]').parentElement.hidden = recording.drawings.length === 0;
  element('joint-note').textContent = jointNote(recording.joints.length);
}

function contactNote({ contacts, contactInterval, largestContactCut }) {
  if (contacts.every(({ count }) => count === 0)) return 'The recording has no contacts.';
  const parts = [];
  if (contactInterval > 1) parts.push(`Contacts are recorded every ${contactInterval} frames.`);
  if (largestContactCut > 0) parts.push(`Up to ${largestContactCut.toLocaleString('en')} contacts of a frame are left out.`);
  return parts.join(' ');
}

function jointNote(count) {
  if (count <= MOST_WITH_LIMITS) return '';
  return `${count > MOST_WITH_FRAMES ? 'Frames and limits' : 'Limits'} are drawn of the selected body’s joints.`;
}

// `summary`: what jointSummary returns.
export function showJoints({ count, enabled, distance, distanceJoint, angle, angleJoint }) {
  const worst = (error, joint, text) => (error > 0 ? `${text(error)}, joint ${joint}` : 'none');
  const digits = (value) => Number(value.toPrecision(3));
  const length = (meters) => (meters < 0.1 ? `${digits(1000 * meters)} mm` : `${digits(meters)} m`);
  const angleText = (radians) => (radians < 0.1 ? `${digits(1000 * radians)} mrad` : `${digits(radians)} rad`);
  const number = (value) => value.toLocaleString('en');
  element('joint-errors').replaceChildren(list([
    ['Number', enabled === count ? number(count) : `${number(enabled)} of ${number(count)} hold`],
    ['Largest gap', worst(distance, distanceJoint, length)],
    ['Largest tilt', worst(angle, angleJoint, angleText)],
  ]));
}

const MOTIONS = ['static', 'kinematic', 'dynamic'];

// "box 12", or the name that the scene gave it.
export function nameOf({ bodies, shapes }, body) {
  const shape = shapes[bodies.shapes[body]];
  return `${shape.name || shape.kind} ${body}${bodies.names[body] ? ` (${bodies.names[body]})` : ''}`;
}

// What is known of a body at the timeline's moment; also what tests read.
export function bodyInfo(recording, timeline, body) {
  const presence = timeline.presence(body);
  const shape = recording.shapes[presence?.shape ?? recording.bodies.shapes[body]];
  const motion = MOTIONS[recording.bodies.motions[body]];
  return {
    id: body,
    name: recording.bodies.names[body] ?? '',
    shape: shape.name && shape.name !== shape.kind ? `${shape.name}: ${describe(shape)}` : describe(shape),
    motion,
    sensor: recording.isSensor[body] === 1,
    there: presence !== undefined,
    mass: motion === 'dynamic' ? recording.bodies.masses[body] : null,
    position: [...timeline.positions.subarray(3 * body, 3 * body + 3)],
    velocity: [...timeline.velocity(body)],
    speed: timeline.speed(body),
    awake: motion === 'dynamic' ? timeline.isAwake(body) : null,
    island: timeline.island(body),
    joints: jointsOf(recording, timeline, body),
  };
}

// Those that hold at the timeline's moment.
function jointsOf({ joints }, timeline, body) {
  return joints.filter((joint) => (joint.bodyA === body || joint.bodyB === body) && stateAt(joint, Math.floor(timeline.frame))?.enabled)
    .map(({ id, kind }) => `${kind} ${id}`);
}

const vector = (values, digits) => values.map((value) => value.toFixed(digits)).join(', ').replaceAll('-', '−');

export function showBody(info) {
  if (!info) {
    element('body').replaceChildren(Object.assign(document.createElement('p'), { className: 'note', textContent: 'Click a body in the picture.' }));
    return;
  }
  const lines = [['Id', String(info.id)]];
  if (info.name) lines.push(['Name', info.name]);
  lines.push(['Shape', info.shape], ['Motion', info.sensor ? `${info.motion}, a sensor` : info.motion]);
  if (!info.there) lines.push(['State', 'not there']);
  if (info.mass !== null) lines.push(['Mass', `${Number(info.mass.toPrecision(4)).toLocaleString('en')} kg`]);
  lines.push(['Position', `${vector(info.position, 3)} m`]);
  if (info.motion !== 'static') lines.push(['Velocity', `${vector(info.velocity, 2)} m/s`], ['Speed', `${info.speed.toFixed(3)} m/s`]);
  if (info.there && info.awake !== null) lines.push(['State', info.awake ? 'awake' : 'asleep']);
  lines.push(['Island', info.island < 0 ? 'none' : String(info.island)]);
  const named = info.joints.slice(0, 8).join(', ');
  if (named) lines.push(['Joints', info.joints.length > 8 ? `${named}, and ${info.joints.length - 8} more` : named]);
  element('body').replaceChildren(list(lines));
}

export function showMessage(text) {
  element('message').textContent = text;
}
