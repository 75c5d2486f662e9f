// The recording that the tests look at: FULCRUM_RECORDING names it without its ending, out/pyramid of the working folder
// by default. `./fulcrum run pyramid` makes it.
import { existsSync, readFileSync } from 'node:fs';
import { resolve } from 'node:path';
import { unpack } from '../Page/decode.js';

const stem = resolve(process.env.FULCRUM_RECORDING ?? 'out/pyramid');
export const html = `${stem}.html`;
export const glb = `${stem}.glb`;
export const screenshot = `${stem}.png`;

for (const file of [html, glb]) {
  if (!existsSync(file)) throw new Error(`${file} is missing: run ./fulcrum run pyramid, or name a recording in FULCRUM_RECORDING`);
}

export async function readRecording() {
  const [, text] = readFileSync(html, 'utf8').match(/<script id="recording"[^>]*>([^<]*)<\/script>/);
  return unpack(text);
}
