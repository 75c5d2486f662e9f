// The glTF file: valid, and of the same motion as the page, each decoded on its own.
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import { test } from 'node:test';
import validator from 'gltf-validator';
import { glb, readRecording } from './recording.mjs';
import { Timeline } from '../Page/timeline.js';

function readGlb() {
  const bytes = readFileSync(glb);
  const length = bytes.readUInt32LE(12);
  const json = JSON.parse(bytes.subarray(20, 20 + length).toString('utf8'));
  const binary = bytes.subarray(20 + length + 8);
  const sizes = { SCALAR: 1, VEC3: 3, VEC4: 4 };
  const floats = (index) => {
    const accessor = json.accessors[index];
    const start = binary.byteOffset + json.bufferViews[accessor.bufferView].byteOffset;
    return new Float32Array(binary.buffer.slice(start, start + 4 * sizes[accessor.type] * accessor.count));
  };
  return { json, floats };
}

// As a player of glTF does it, but for the rotation's slerp: between near rotations it is the same.
function valueAt(times, values, width, time) {
  let i = 0;
  while (i + 2 < times.length && times[i + 1] < time) ++i;
  const share = times.length === 1 ? 0 : Math.min(1, Math.max(0, (time - times[i]) / (times[i + 1] - times[i])));
  const at = (k) => values[width * i + k] + (times.length === 1 ? 0 : share * (values[width * (i + 1) + k] - values[width * i + k]));
  return Array.from({ length: width }, (_, k) => at(k));
}

test('the validator finds nothing wrong', async () => {
  const { issues } = await validator.validateBytes(new Uint8Array(readFileSync(glb)));
  assert.equal(issues.numErrors, 0, JSON.stringify(issues.messages, null, 2));
  assert.equal(issues.numWarnings, 0, JSON.stringify(issues.messages, null, 2));
});

test('a node for each body, an animation of those that moved', async () => {
  const recording = await readRecording();
  const { json } = readGlb();
  assert.equal(json.nodes.length, recording.bodyCount);
  assert.ok(json.animations[0].channels.length > 0);
  const animated = new Set(json.animations[0].channels.map(({ target }) => target.node));
  for (const node of animated) assert.notEqual(recording.bodies.motions[node], 0, `static body ${node} is animated`);
});

test('the animation goes where the page shows the bodies', async () => {
  const recording = await readRecording();
  const { json, floats } = readGlb();
  const timeline = new Timeline(recording);
  const { samplers, channels } = json.animations[0];
  const curves = channels.map(({ sampler, target }) => ({
    node: target.node,
    width: target.path === 'translation' ? 3 : 4,
    times: floats(samplers[sampler].input),
    values: floats(samplers[sampler].output),
  }));
  // The key frames left out may be off by 0.2 mm (or 0.0005), the page's steps and float's by 0.1 mm more (or 1/32768).
  for (let frame = 0; frame < recording.frameCount; frame += 7) {
    timeline.seek(frame);
    const time = recording.times[frame] - recording.times[0];
    for (const { node, width, times, values } of curves) {
      const expected = width === 3 ? timeline.positions.subarray(3 * node, 3 * node + 3) : timeline.rotations.subarray(4 * node, 4 * node + 4);
      const actual = valueAt(times, values, width, time);
      const dot = width === 4 ? actual.reduce((sum, part, k) => sum + part * expected[k], 0) : 1;
      const off = Math.max(...actual.map((part, k) => Math.abs(Math.sign(dot) * part - expected[k])));
      assert.ok(off < (width === 3 ? 4e-4 : 7e-4), `body ${node} is off by ${off} in frame ${frame}`);
    }
  }
});
