// The WebAssembly module and how to talk with it: text and bytes through buffers, and a row of numbers (Bindings/Exchange.h).

const encoder = new TextEncoder(), decoder = new TextDecoder();

export class FulcrumError extends Error {
  name = 'FulcrumError';
}

export class Module {
  constructor(instance) {
    this.instance = instance;
    this.memory = instance.memory;
  }

  // Memory may have grown since the last call: views are made anew.
  get bytes() { return new Uint8Array(this.#buffer); }
  get #buffer() { return this.memory ? this.memory.buffer : this.instance.HEAPU8.buffer; }
  numbers(count = 32) { return new Float64Array(this.#buffer, this.instance._fulcrum_numbers(), count); }
  view(Type, address, length) { return new Type(this.#buffer, address, length); }

  call(name, ...values) {
    return this.instance[`_fulcrum_${name}`](...values);
  }
  // For functions that give 0 where they fail.
  must(name, ...values) {
    const result = this.call(name, ...values);
    if (result === 0) throw new FulcrumError(this.text());
    return result;
  }
  put(bytes) {
    const address = this.call('input', bytes.length);
    this.bytes.set(bytes, address);
  }
  putJson(value) { this.put(encoder.encode(JSON.stringify(value, withInfinity))); }
  putText(text) { this.put(encoder.encode(text)); }
  putNumbers(...values) { this.numbers().set(values); }

  // A copy: what is shared between threads cannot be decoded.
  answerBytes() {
    const address = this.call('answer');
    return this.bytes.slice(address, address + this.call('answerSize'));
  }
  text() { return decoder.decode(this.answerBytes()); }
  json() { return JSON.parse(this.text(), toInfinity); }

  hash(name, world) {
    this.call(name, world);
    const [high, low] = this.numbers(2);
    return (BigInt(high) << 32n) | BigInt(low);
  }
}

// JSON has no infinity; the engine's files write it as a word.
const withInfinity = (key, value) => (value === Infinity ? 'infinity' : value === -Infinity ? '-infinity' : value);
const toInfinity = (key, value) => (value === 'infinity' ? Infinity : value === '-infinity' ? -Infinity : value);
