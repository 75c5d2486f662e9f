// The engine out of the page: two modules, deflated and base64. That with threads where the page is cross-origin isolated.
import { canUseThreads, instantiate } from '../Package/src/index.js';

async function inflate(text) {
  const letters = atob(text);
  const packed = new Uint8Array(letters.length);
  for (let i = 0; i < letters.length; ++i) packed[i] = letters.charCodeAt(i);
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
  return new Response(stream).arrayBuffer();
}

// `threads`: the most that worlds may have; 1 where the page may start none.
export async function loadEngine(text, wanted = Math.min(8, navigator.hardwareConcurrency ?? 1)) {
  const parts = JSON.parse(text);
  const threads = canUseThreads() ? Math.max(1, wanted) : 1;
  const chosen = threads > 1 ? parts.threads : parts.single;
  const [script, wasm, worker] = await Promise.all([chosen.script, chosen.wasm, chosen.worker ?? ''].map((part) => (part ? inflate(part) : undefined)));
  const source = new TextDecoder().decode(script);
  const factory = new Function(`${source}; return FulcrumModule;`)();
  const blob = (bytes) => new Blob([bytes], { type: 'text/javascript' });
  return instantiate({
    factory, wasm, threads, script: threads > 1 ? blob(script) : undefined,
    worker: threads > 1 ? URL.createObjectURL(blob(worker)) : undefined,
  });
}
