// Fulcrum for JavaScript. What everything means, its units and ranges, stands in index.d.ts and in the engine's headers.
import { FulcrumError, Module } from './module.js';
import { WORLD, World } from './world.js';

export { FulcrumError, WORLD };

// Whether modules with threads can be loaded here: a page must be cross-origin isolated (Docs of the package).
export const canUseThreads = () =>
  typeof SharedArrayBuffer === 'function' && (typeof crossOriginIsolated === 'undefined' || crossOriginIsolated);

// `factory`: what dist/fulcrum.cjs or dist/fulcrum-threads.cjs exports; `wasm`: the bytes of the .wasm beside it. `threads`: the
// most that a world may have; more than one needs the module of the threads, `worker`: the address of
// fulcrum-threads.worker.js and `script`: that of fulcrum-threads.cjs, or its text as a Blob.
export async function instantiate({ factory, wasm, threads = 1, worker, script }) {
  const options = { wasmBinary: wasm, helpers: Math.max(0, threads - 1) };
  if (threads > 1) {
    options.wasmMemory = new WebAssembly.Memory({ initial: 512, maximum: 32768, shared: true });
    options.locateFile = (name) => (name.endsWith('.worker.js') ? String(worker) : name);
    options.mainScriptUrlOrBlob = script;
  }
  const instance = await factory(options);
  instance.memory = options.wasmMemory;
  return new Fulcrum(new Module(instance), threads);
}

// In a page or worker: fetches the module from `base`, the folder dist/ of this package.
export async function load({ base, threads = 1 } = {}) {
  if (!base) throw new FulcrumError('load needs { base }, the address of the folder dist/ of fulcrum-physics');
  const most = canUseThreads() ? threads : 1;
  const name = most > 1 ? 'fulcrum-threads' : 'fulcrum';
  const address = (file) => new URL(file, new URL(base, globalThis.location?.href)).href;
  const [script, wasm] = await Promise.all([
    fetch(address(`${name}.cjs`)).then((response) => response.text()),
    fetch(address(`${name}.wasm`)).then((response) => response.arrayBuffer()),
  ]);
  const factory = new Function(`${script}; return FulcrumModule;`)();
  return instantiate({ factory, wasm, threads: most, worker: address(`${name}.worker.js`), script: address(`${name}.cjs`) });
}

export class Fulcrum {
  #module;
  constructor(module, threads) {
    this.#module = module;
    this.threads = threads;
    module.must('version');
    Object.assign(this, module.json());
  }

  createWorld(settings = {}, { threads = this.threads } = {}) {
    this.#module.putJson(settings);
    return new World(this.#module, this.#module.must('createWorld', Math.min(threads, this.threads)));
  }

  get scenes() {
    this.#module.must('scenes');
    return this.#module.json();
  }
  createScene(scene, { threads = this.threads, ...options } = {}) {
    this.#module.putJson({ scene, ...options });
    return new World(this.#module, this.#module.must('createScene', Math.min(threads, this.threads)));
  }

  // A shape that several bodies may have. What they need of it lives as long as they do.
  createShape(description) {
    this.#module.putJson(description);
    return new Shape(this.#module, this.#module.must('createShape'));
  }

  // Ends the threads, which keep node running. After that nothing of this may be used.
  close() { this.#module.instance.PThread?.terminateAllThreads(); }
}

class Shape {
  #module;
  constructor(module, number) {
    this.#module = module;
    this.number = number;
  }
  toJSON() { return `#${this.number}`; }
  destroy() { this.#module.call('destroyShape', this.number); }
}
