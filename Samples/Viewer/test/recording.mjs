// The recording that the tests look at: FULCRUM_RECORDING names it without its ending, out/pyramid of the working folder
// by default. `./fulcrum run pyramid` makes it. Those of the scenes hinge, query_rays, sensors and springs are beside it.
import { existsSync, readFileSync } from 'node:fs';
import { dirname, join, resolve } from 'node:path';
import { unpack } from '../Page/decode.js';

const stem = resolve(process.env.FULCRUM_RECORDING ?? 'out/pyramid');
export const html = `${stem}.html`;
export const glb = `${stem}.glb`;
export const screenshot = `${stem}.png`;
export const hingeHtml = join(dirname(stem), 'hinge.html');
export const queryHtml = join(dirname(stem), 'query_rays.html');
export const sensorsHtml = join(dirname(stem), 'sensors.html');
export const springsHtml = join(dirname(stem), 'springs.html');

for (const file of [html, glb, hingeHtml, queryHtml, sensorsHtml, springsHtml]) {
  if (!existsSync(file)) throw new Error(`${file} is missing: run ./fulcrum run pyramid, hinge, query_rays, sensors and springs, or name a recording in FULCRUM_RECORDING`);
}

export async function readRecording(page = html) {
  const [, text] = readFileSync(page, 'utf8').match(/<script id="recording"[^>]*>([^<]*)<\/script>/);
  return unpack(text);
}
