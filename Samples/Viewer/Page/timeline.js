// The states of all bodies at a moment between frames: what the page draws and what it says of a body.
import { presenceAt } from './presence.js';

export class Timeline {
  constructor(recording) {
    this.recording = recording;
    const count = recording.bodyCount;
    this.frame = 0; // with a fraction while playing slowly
    this.sample = recording.samples.starts.slice(0, count); // of each body, the last at or before the frame
    this.positions = new Float32Array(3 * count);
    this.rotations = new Float32Array(4 * count);
    for (let body = 0; body < count; ++body) this.#place(body, this.sample[body]);
    this.#seekMovers();
  }

  get lastFrame() {
    return Math.max(0, this.recording.frameCount - 1);
  }

  get time() {
    const { times } = this.recording;
    const whole = Math.floor(this.frame), fraction = this.frame - whole;
    const start = times[whole] ?? 0;
    return start + fraction * ((times[whole + 1] ?? start) - start);
  }

  // The frame, with its fraction, at a time in seconds.
  frameAt(time) {
    const { times } = this.recording;
    let low = 0, high = this.lastFrame;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (times[middle] <= time) low = middle;
      else high = middle - 1;
    }
    const span = (times[low + 1] ?? Infinity) - times[low];
    return Math.min(this.lastFrame, low + Math.max(0, time - times[low]) / span);
  }

  seek(frame) {
    this.frame = Math.min(this.lastFrame, Math.max(0, Number(frame) || 0));
    this.#seekMovers();
  }

  isThere(body) {
    return this.presence(body) !== undefined;
  }
  presence(body) {
    return presenceAt(this.recording.presences[body], this.frame);
  }
  isAwake(body) {
    return this.recording.samples.awake[this.sample[body]] === 1;
  }
  island(body) {
    return this.recording.samples.islands[this.sample[body]];
  }
  velocity(body) {
    return this.recording.samples.velocities.subarray(3 * this.sample[body], 3 * this.sample[body] + 3);
  }
  speed(body) {
    const { velocities } = this.recording.samples, at = 3 * this.sample[body];
    return Math.sqrt(velocities[at] ** 2 + velocities[at + 1] ** 2 + velocities[at + 2] ** 2); // a view and hypot take fifty times as long
  }

  // The body's last sample at or before a whole frame.
  sampleAt(body, frame) { return this.#search(body, frame); }

  // Those of the last frame at or before this one that recorded them; undefined where there is none.
  contacts() {
    let found;
    for (const contacts of this.recording.contacts) {
      if (contacts.frame > this.frame) break;
      found = contacts;
    }
    return found;
  }

  // A body that never moves was placed once and for all.
  #seekMovers() {
    const { starts, frames } = this.recording.samples;
    const whole = Math.floor(this.frame), fraction = this.frame - whole;
    for (const body of this.recording.movers) {
      let sample = this.sample[body];
      const end = starts[body + 1];
      // Playing forwards, the next sample is the one after or the same; anything else is searched.
      if (frames[sample] > whole || (sample + 2 < end && frames[sample + 2] <= whole)) sample = this.#search(body, whole);
      else if (sample + 1 < end && frames[sample + 1] <= whole) ++sample;
      this.sample[body] = sample;
      this.#place(body, sample);
      if (fraction > 0 && sample + 1 < end && frames[sample + 1] === whole + 1) this.#blend(body, sample + 1, fraction);
    }
  }

  #search(body, frame) {
    const { starts, frames } = this.recording.samples;
    let low = starts[body], high = starts[body + 1] - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (frames[middle] <= frame) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  #place(body, sample) {
    const { positions, rotations } = this.recording.samples;
    for (let k = 0; k < 3; ++k) this.positions[3 * body + k] = positions[3 * sample + k];
    for (let k = 0; k < 4; ++k) this.rotations[4 * body + k] = rotations[4 * sample + k];
  }

  // Straight lines between frames, for rotations too: they are made unit again where they are drawn.
  #blend(body, sample, fraction) {
    const { positions, rotations } = this.recording.samples;
    for (let k = 0; k < 3; ++k) {
      const at = 3 * body + k;
      this.positions[at] += (positions[3 * sample + k] - this.positions[at]) * fraction;
    }
    for (let k = 0; k < 4; ++k) {
      const at = 4 * body + k;
      this.rotations[at] += (rotations[4 * sample + k] - this.rotations[at]) * fraction;
    }
  }
}
