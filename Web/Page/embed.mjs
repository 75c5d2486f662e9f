// Puts the modules of the engine into the bundled page: node embed.mjs BUNDLED DIST OUTPUT. Called by CMake.
import { readFileSync } from 'node:fs';
import { join } from 'node:path';
import { deflateSync } from 'node:zlib';

import { writeWholeFile } from '../../Docs/wholeFile.mjs';

const [bundled, dist, output] = process.argv.slice(2);
if (!output) {
  console.error('usage: node embed.mjs BUNDLED DIST OUTPUT');
  process.exit(2);
}
const packed = (name) => deflateSync(readFileSync(join(dist, name)), { level: 9 }).toString('base64');
const data = JSON.stringify({
  single: { script: packed('fulcrum.cjs'), wasm: packed('fulcrum.wasm') },
  threads: { script: packed('fulcrum-threads.cjs'), wasm: packed('fulcrum-threads.wasm'), worker: packed('fulcrum-threads.worker.js') },
});
writeWholeFile(output, readFileSync(bundled, 'utf8').replace('@@FULCRUM_ENGINE@@', () => data));
