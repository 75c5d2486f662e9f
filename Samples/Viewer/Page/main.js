// Puts the page together: unpacks the recording, plays it, answers the controls.
//
// The address may say what to show: #frame=120&camera=x,y,z,tx,ty,tz&color=island&body=7&joints=1&drawings=1&contacts=1&normals=1&bounds=1&bare=1.
// Scripts and tests use window.fulcrum, which is there once the page is ready.
import { Raycaster, Vector2 } from 'three';
import { Bodies } from './bodies.js';
import { MODES, legend, topSpeed } from './colors.js';
import { unpack } from './decode.js';
import { Drawings } from './drawings.js';
import { Joints, MOST_WITH_LIMITS, jointLegend, jointSummary } from './joints.js';
import { BoundingBoxes, Contacts } from './overlays.js';
import { bodyInfo, showBody, showJoints, showMessage, showTexts } from './panel.js';
import { Stage } from './stage.js';
import { findSubject, hasFloor, isEnclosed } from './subject.js';
import { Timeline } from './timeline.js';

const element = (id) => document.getElementById(id);

class Viewer {
  constructor(recording) {
    this.recording = recording;
    this.timeline = new Timeline(recording);
    const subject = findSubject(recording, this.timeline);
    this.stage = new Stage(element('canvas'), subject);
    this.bodies = new Bodies(recording, this.timeline, this.stage);
    if (!hasFloor(recording, subject)) this.stage.addGround();
    this.contacts = new Contacts(recording, this.stage);
    this.boxes = new BoundingBoxes(recording, this.timeline, this.stage);
    this.joints = new Joints(recording, this.timeline, this.stage);
    this.drawings = new Drawings(recording, this.stage);
    this.top = topSpeed(recording);
    this.mode = 'island';
    this.selected = -1;
    this.isPlaying = false;
    this.hasPointed = false; // since the tabulator key was last pressed
    this.stage.resize();
    this.stage.frameSubject();
    showTexts(recording);
    this.#connect();
    this.setSolid(!isEnclosed(recording, this.timeline, subject));
    this.show('joints', recording.joints.length > 0 && recording.joints.length <= MOST_WITH_LIMITS);
    this.show('drawings', recording.drawings.length > 0);
    this.setMode(this.mode);
  }

  seek(frame) {
    this.setPlaying(false);
    this.timeline.seek(Math.round(frame));
    this.draw();
  }

  setMode(mode) {
    this.mode = MODES.includes(mode) ? mode : 'island';
    document.querySelector(`input[name=color][value=${this.mode}]`).checked = true;
    this.#showLegend();
    this.draw();
  }

  show(what, isShown) {
    const objects = { joints: this.joints, drawings: this.drawings, contacts: this.contacts.points, normals: this.contacts.normals, bounds: this.boxes.object };
    if (what === 'grid') this.stage.grid.gridStrength.value = isShown ? 1 : 0;
    else if (what === 'solid') this.bodies.setSolid(isShown);
    else objects[what].visible = isShown;
    document.querySelector(`#toggles input[value=${what}]`).checked = isShown;
    this.#showLegend();
    this.draw();
  }
  setSolid(isSolid) {
    this.show('solid', isSolid);
  }

  // -1, or what is no body: none.
  select(body) {
    this.selected = this.bodies.selected = Number.isInteger(body) && body < this.recording.bodyCount ? body : -1;
    this.draw();
  }

  // The body at a place in the picture, pixels from its upper left corner; selects it. -1: none.
  pick(x, y) {
    const { clientWidth, clientHeight } = this.stage.renderer.domElement;
    const raycaster = new Raycaster();
    raycaster.setFromCamera(new Vector2((2 * x) / clientWidth - 1, 1 - (2 * y) / clientHeight), this.stage.camera);
    this.select(this.bodies.pick(raycaster));
    return this.selected;
  }

  setPlaying(isPlaying) {
    if (isPlaying && this.timeline.frame >= this.timeline.lastFrame) this.timeline.seek(0);
    this.isPlaying = isPlaying && this.timeline.lastFrame > 0;
    this.lastTick = undefined;
    element('play').setAttribute('aria-label', this.isPlaying ? 'Pause' : 'Play');
    element('play').querySelector('use').setAttribute('href', this.isPlaying ? '#icon-pause' : '#icon-play');
    this.draw();
  }

  // Draws with the browser's next picture, once however often it is asked for.
  draw() {
    this.pending ??= requestAnimationFrame((now) => this.#tick(now));
  }

  // Draws at once: what a test reads from the canvas is then up to date.
  drawNow() {
    this.bodies.update(this.mode, this.top);
    this.contacts.update(this.timeline.contacts(), 1.2 * this.stage.subject.typical);
    this.boxes.update();
    this.joints.update(this.selected);
    this.drawings.update(this.timeline.frame);
    this.stage.render();
    showBody(this.selected < 0 ? undefined : bodyInfo(this.recording, this.timeline, this.selected));
    if (this.recording.joints.length > 0) showJoints(jointSummary(this.recording, this.timeline.frame));
    this.#showClock();
  }

  #tick(now) {
    this.pending = undefined;
    if (this.isPlaying) {
      const passed = this.lastTick === undefined ? 0 : Math.min(0.1, (now - this.lastTick) / 1000);
      this.lastTick = now;
      this.timeline.seek(this.timeline.frameAt(this.timeline.time + passed * Number(element('speed').value)));
      if (this.timeline.frame >= this.timeline.lastFrame) this.setPlaying(false);
    }
    this.drawNow();
    if (this.isPlaying) this.draw();
  }

  #showLegend() {
    element('legend').innerHTML = legend(this.mode, this.top) + (this.joints.visible ? jointLegend() : '');
  }

  #showClock() {
    const { frame, lastFrame, time } = this.timeline;
    const whole = Math.floor(frame);
    element('scrub').value = whole;
    element('clock').textContent = `${time.toFixed(2)} s · frame ${whole} / ${lastFrame}`;
  }

  #connect() {
    element('scrub').max = this.timeline.lastFrame;
    element('scrub').addEventListener('input', (event) => this.seek(Number(event.target.value)));
    element('play').addEventListener('click', () => this.setPlaying(!this.isPlaying));
    element('back').addEventListener('click', () => this.step(-1));
    element('forward').addEventListener('click', () => this.step(1));
    element('colors').addEventListener('change', (event) => this.setMode(event.target.value));
    element('toggles').addEventListener('change', (event) => this.show(event.target.value, event.target.checked));
    this.stage.controls.addEventListener('change', () => this.draw());
    new ResizeObserver(() => {
      this.stage.resize();
      this.draw();
    }).observe(element('view'));
    addEventListener('keydown', (event) => this.#onKey(event));
    addEventListener('pointerdown', () => (this.hasPointed = true), { capture: true });
    this.#connectClicks();
  }

  // A click is a press that hardly moves; else it was the camera that turned.
  #connectClicks() {
    const canvas = element('canvas');
    let press;
    canvas.addEventListener('pointerdown', (event) => (press = [event.clientX, event.clientY]));
    canvas.addEventListener('pointerup', (event) => {
      if (!press || event.button !== 0 || Math.hypot(event.clientX - press[0], event.clientY - press[1]) > 4) return;
      const box = canvas.getBoundingClientRect();
      this.pick(event.clientX - box.left, event.clientY - box.top);
    });
  }

  step(frames) {
    const frame = this.timeline.frame;
    this.seek(frames < 0 ? Math.ceil(frame) + frames : Math.floor(frame) + frames);
  }

  // A control that was reached by Tab keeps its own keys: space presses a button, arrows choose among radio buttons.
  // One that was clicked leaves them to the page, and lets go, so that the key's end is not its own either.
  #onKey(event) {
    if (event.key === 'Tab') this.hasPointed = false;
    const actions = {
      ' ': () => this.setPlaying(!this.isPlaying),
      ArrowLeft: () => this.step(-1),
      ArrowRight: () => this.step(1),
      Home: () => this.seek(0),
      End: () => this.seek(this.timeline.lastFrame),
      Escape: () => this.select(-1),
    };
    if (!actions[event.key] || event.ctrlKey || event.metaKey || event.altKey) return;
    const control = event.target.closest('button, input, select');
    if (control && this.hasPointed) control.blur();
    else if (control?.matches(event.key === ' ' ? 'button, input, select' : 'select, input[type=radio]')) return;
    event.preventDefault();
    actions[event.key]();
  }
}

function applyAddress(viewer) {
  const wanted = new URLSearchParams(location.hash.slice(1));
  if (wanted.get('bare') === '1') document.body.classList.add('bare');
  viewer.stage.resize();
  viewer.stage.frameSubject();
  const camera = (wanted.get('camera') ?? '').split(',').map(Number);
  if (camera.length === 6 && camera.every(Number.isFinite)) {
    viewer.stage.camera.position.set(...camera.slice(0, 3));
    viewer.stage.controls.target.set(...camera.slice(3));
    viewer.stage.controls.update();
  }
  if (wanted.has('color')) viewer.setMode(wanted.get('color'));
  for (const what of ['joints', 'drawings', 'contacts', 'normals', 'bounds', 'grid', 'solid']) if (wanted.has(what)) viewer.show(what, wanted.get(what) === '1');
  if (wanted.has('body')) viewer.select(Number(wanted.get('body')));
  if (wanted.has('frame')) viewer.seek(Number(wanted.get('frame')));
  else if (!matchMedia('(prefers-reduced-motion: reduce)').matches) viewer.setPlaying(true);
}

function publish(viewer) {
  const { recording, timeline, stage } = viewer;
  window.fulcrum = {
    frameCount: recording.frameCount,
    bodyCount: recording.bodyCount,
    get frame() { return timeline.frame; },
    get playing() { return viewer.isPlaying; },
    seek(frame) { viewer.seek(frame); viewer.drawNow(); },
    play() { viewer.setPlaying(true); },
    color(mode) { viewer.setMode(mode); viewer.drawNow(); },
    show(what, isShown) { viewer.show(what, isShown); viewer.drawNow(); },
    pick(x, y) { return viewer.pick(x, y); },
    body(id) { return bodyInfo(recording, timeline, id); },
    joints() { return jointSummary(recording, timeline.frame); },
    camera() { return [...stage.camera.position.toArray(), ...stage.controls.target.toArray()]; },
  };
}

async function start() {
  try {
    const recording = await unpack(element('recording').textContent);
    element('recording').remove();
    const viewer = new Viewer(recording);
    applyAddress(viewer);
    viewer.drawNow();
    publish(viewer);
    showMessage('');
  } catch (error) {
    showMessage(`This recording cannot be shown: ${error.message}`);
    console.error(error);
  }
}

start();
