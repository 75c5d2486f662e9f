// Reads what PageData.cpp writes; the format is described in PageData.h. No page is needed: the tests run it in node.
//
// The result keeps, of every body, the list of its states ("samples"): those of body b have the indices starts[b] up to
// starts[b + 1], in the order of their frames. A body that rests has few of them however long the recording.

import { decodeDrawings } from './decodeDrawings.js';
import { decodeFigures } from './decodeFigures.js';
import { decodeJoints } from './decodeJoints.js';
import { presencesOf } from './presence.js';
import { Reader } from './reader.js';

function columnsOf(bytes) {
  const headerLength = new DataView(bytes.buffer, bytes.byteOffset).getUint32(0, true);
  const header = JSON.parse(new TextDecoder().decode(bytes.subarray(4, 4 + headerLength)));
  let at = 4 + headerLength;
  const readers = header.columns.map((length) => new Reader(bytes.subarray(at, (at += length))));
  return { header, readers };
}

// First pass: how many samples each body has, and each sample's frame and flags.
function layOut(reader, frameCount, bodyCount) {
  const bodies = [], frames = [], flags = [];
  const starts = new Uint32Array(bodyCount + 1);
  for (let frame = 0; frame < frameCount; ++frame) {
    const count = reader.unsigned();
    for (let i = 0, body = 0; i < count; ++i, ++body) {
      body += reader.unsigned();
      bodies.push(body);
      frames.push(frame);
      flags.push(reader.unsigned());
      ++starts[body + 1];
    }
  }
  for (let body = 0; body < bodyCount; ++body) starts[body + 1] += starts[body];
  return { bodies, frames, flags, starts };
}

function decodeStates(header, [states, positions, rotations, velocities, islands]) {
  const bodyCount = header.bodies.shapes.length;
  const { bodies, frames, flags, starts } = layOut(states, header.times.length, bodyCount);
  const count = bodies.length;
  const result = {
    starts,
    frames: new Uint32Array(count),
    positions: new Float32Array(3 * count),
    rotations: new Float32Array(4 * count),
    velocities: new Float32Array(3 * count),
    awake: new Uint8Array(count),
    gone: new Uint8Array(count),
    islands: new Int32Array(count),
  };
  const next = starts.slice(0, bodyCount);
  const frameBefore = new Int32Array(bodyCount).fill(-2);
  const island = new Int32Array(bodyCount).fill(-1);
  const position = new Float64Array(3 * bodyCount), moved = new Float64Array(3 * bodyCount);
  const rotation = new Int32Array(4 * bodyCount), velocity = new Float64Array(3 * bodyCount);
  for (let i = 0; i < count; ++i) {
    const body = bodies[i], sample = next[body]++;
    const isFirst = frameBefore[body] === -2, isGoingOn = frameBefore[body] + 1 === frames[i];
    for (let k = 0; k < 3; ++k) {
      const at = 3 * body + k;
      const change = positions.signed() + (isGoingOn ? moved[at] : 0);
      position[at] += change;
      moved[at] = isFirst ? 0 : change;
      velocity[at] += velocities.signed();
      result.positions[3 * sample + k] = position[at] * header.positionStep;
      result.velocities[3 * sample + k] = velocity[at] * header.velocityStep;
    }
    for (let k = 0; k < 4; ++k) {
      rotation[4 * body + k] += rotations.signed();
      result.rotations[4 * sample + k] = rotation[4 * body + k] / header.rotationSteps;
    }
    if (flags[i] & 2) island[body] += islands.signed();
    result.frames[sample] = frames[i];
    result.awake[sample] = flags[i] & 1;
    result.gone[sample] = flags[i] >> 2 & 1;
    result.islands[sample] = island[body];
    frameBefore[body] = frames[i];
  }
  return result;
}

function decodeContacts(header, reader) {
  return header.contactFrames.map((frame) => {
    const count = reader.unsigned();
    const contacts = {
      frame,
      count,
      bodies: new Uint32Array(2 * count),
      points: new Float32Array(3 * count),
      normals: new Float32Array(3 * count),
      separations: new Float32Array(count),
      impulses: new Float32Array(count),
    };
    const pair = [0, 0], point = [0, 0, 0];
    for (let i = 0; i < count; ++i) {
      for (let k = 0; k < 2; ++k) contacts.bodies[2 * i + k] = pair[k] += reader.signed();
      for (let k = 0; k < 3; ++k) contacts.points[3 * i + k] = (point[k] += reader.signed()) * header.contactPointStep;
      for (let k = 0; k < 3; ++k) contacts.normals[3 * i + k] = reader.signed() * header.normalStep;
      contacts.separations[i] = reader.signed() * header.separationStep;
      contacts.impulses[i] = (2 ** (reader.unsigned() / header.impulseSteps) - 1) * header.impulseUnit;
    }
    return contacts;
  });
}

// `bytes`: the recording, inflated. Lengths in meters, times in seconds.
export function decode(bytes) {
  const { header, readers } = columnsOf(bytes);
  const bodyCount = header.bodies.shapes.length;
  const samples = decodeStates(header, readers);
  const contacts = decodeContacts(header, readers[5]);
  const { joints, jointErrors } = decodeJoints(header, readers.slice(6));
  const drawings = decodeDrawings(header, readers[9]);
  const figures = decodeFigures(header, readers[10]?.bytes ?? new Uint8Array());
  const lookOf = new Map(header.looks ?? []);
  const recording = { ...header, figures, lookOf, bodyCount, frameCount: header.times.length, samples, contacts, joints, jointErrors, drawings };
  const presences = presencesOf(recording);
  const movers = [];
  for (let body = 0; body < bodyCount; ++body) if (samples.starts[body + 1] - samples.starts[body] > 1) movers.push(body);
  const isSensor = new Uint8Array(bodyCount);
  for (const body of header.bodies.sensors) isSensor[body] = 1;
  return { ...recording, movers, presences, isSensor };
}

// `text`: the recording as the page carries it, base64 of zlib's format.
export async function unpack(text) {
  const letters = atob(text);
  const packed = new Uint8Array(letters.length);
  for (let i = 0; i < letters.length; ++i) packed[i] = letters.charCodeAt(i);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  return decode(new Uint8Array(await new Response(stream).arrayBuffer()));
}
