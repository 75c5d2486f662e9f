// In node: reads the module from dist/ beside this folder.
import { readFile } from 'node:fs/promises';
import { createRequire } from 'node:module';
import { fileURLToPath } from 'node:url';
import { canUseThreads, instantiate } from './index.js';

export { Fulcrum, FulcrumError, WORLD, canUseThreads, instantiate } from './index.js';

export async function load({ threads = 1, base = new URL('../dist/', import.meta.url) } = {}) {
  const name = threads > 1 && canUseThreads() ? 'fulcrum-threads' : 'fulcrum';
  const pathOf = (ending) => fileURLToPath(new URL(`${name}${ending}`, base));
  const factory = createRequire(import.meta.url)(pathOf('.cjs'));
  return instantiate({ factory, wasm: await readFile(pathOf('.wasm')), threads, worker: pathOf('.worker.js'), script: pathOf('.cjs') });
}
