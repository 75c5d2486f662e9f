// What the scene drew into a frame: lines and points with colors of their own.
import { Color, Vector3 } from 'three';
import { Dots, Lines } from './strokes.js';

export class Drawings {
  constructor(recording, stage) {
    this.recording = recording;
    this.lines = new Lines(stage, 8, 1.6);
    this.dots = new Dots(stage, 10, 8);
    this.visible = false;
  }
  get visible() { return this.lines.visible; }
  set visible(isVisible) { this.lines.visible = this.dots.visible = isVisible; }

  update(frame) {
    const drawing = this.recording.drawings[Math.floor(frame)];
    if (!this.visible || !drawing || drawing === this.shown) return;
    this.shown = drawing;
    this.lines.begin();
    this.dots.begin();
    const from = new Vector3(), to = new Vector3(), color = new Color();
    const { lines, points } = drawing;
    for (let i = 0; i < lines.count; ++i)
      this.lines.line(from.fromArray(lines.places, 6 * i), to.fromArray(lines.places, 6 * i + 3), color.set(lines.colors[i]));
    for (let i = 0; i < points.count; ++i) this.dots.dot(from.fromArray(points.places, 3 * i), color.set(points.colors[i]));
    this.lines.end();
    this.dots.end();
  }
}
