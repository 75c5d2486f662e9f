// What is shown of a recording, and at which moment: the parts of the picture, and the texts that follow it.
import { Raycaster, Vector2, Vector3 } from 'three';
import { Bodies } from './bodies.js';
import { MODES, legend, setTheme, topSpeed } from './colors.js';
import { contactsNow } from './contactsNow.js';
import { Curves } from './curves.js';
import { Drawings } from './drawings.js';
import { Joints, MOST_WITH_LIMITS, jointLegend, jointSummary } from './joints.js';
import { Labels } from './labels.js';
import { BoundingBoxes, Contacts } from './overlays.js';
import { bodyInfo, nameOf, showBody, showJoints, showTexts } from './panel.js';
import { VideoRecorder, savePicture } from './saving.js';
import { Stage } from './stage.js';
import { findSubject, groundHeight, isEnclosed } from './subject.js';
import { Timeline } from './timeline.js';
import { addWater } from './water.js';

const element = (id) => document.getElementById(id);

export class Viewer {
  // `isFine`, `isOccluded`: as Stage.
  constructor(recording, isFine, isOccluded) {
    this.recording = recording;
    this.timeline = new Timeline(recording);
    const subject = findSubject(recording, this.timeline);
    this.stage = new Stage(element('canvas'), subject, isFine, isOccluded);
    this.bodies = new Bodies(recording, this.timeline, this.stage);
    const ground = groundHeight(recording, this.timeline, subject);
    if (ground !== undefined) this.stage.addGround(ground);
    if (recording.view?.water) addWater(this.stage, recording.view.water);
    this.contacts = new Contacts(recording, this.stage);
    this.boxes = new BoundingBoxes(recording, this.timeline, this.stage);
    this.joints = new Joints(recording, this.timeline, this.stage);
    this.drawings = new Drawings(recording, this.stage);
    this.labels = new Labels(recording, this.timeline, this.stage);
    this.curves = new Curves(element('plots'), recording, {
      seek: (frame) => this.seek(frame), select: (body) => this.select(body), nameOf: (body) => nameOf(recording, body),
    });
    this.top = topSpeed(recording);
    this.selected = -1;
    this.isPlaying = this.isLooping = false;
    showTexts(recording);
    element('curves').hidden = this.curves.isEmpty;
    this.resize();
    this.stage.frameSubject();
    const view = recording.view ?? {};
    this.#follow(view.follows ?? -1);
    this.setTheme(matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light');
    this.show('solid', !isEnclosed(recording, this.timeline, subject));
    this.show('joints', view.joints !== false && recording.joints.length > 0 && recording.joints.length <= MOST_WITH_LIMITS);
    this.show('drawings', recording.drawings.length > 0);
    this.show('labels', this.labels.labels.length > 0);
    this.setMode(view.color ?? 'island');
  }

  seek(frame) {
    this.setPlaying(false);
    this.#goTo(Math.round(frame));
    this.draw();
  }
  step(frames) {
    const frame = this.timeline.frame;
    this.seek(frames < 0 ? Math.ceil(frame) + frames : Math.floor(frame) + frames);
  }

  // The camera goes with the body that it follows.
  #goTo(frame) {
    const before = this.followed >= 0 ? this.#placeOf(this.followed) : undefined;
    this.timeline.seek(frame);
    if (before && this.timeline.isThere(this.followed)) this.stage.moveBy(this.#placeOf(this.followed).sub(before));
  }
  #placeOf(body) {
    return new Vector3().fromArray(this.timeline.positions, 3 * body);
  }

  // The camera has what is there now in the picture, not what was or will be, where the whole run is at least `least` times as large; not
  // where it goes with a body.
  frameMoment(least = 1) {
    if (this.isFollowing) return;
    const { frame, lastFrame } = this.timeline;
    const now = findSubject(this.recording, this.timeline, [frame / Math.max(1, lastFrame)]);
    this.timeline.seek(frame);
    if (this.stage.subject.radius < least * now.radius) return;
    this.stage.frameSubject(now);
    this.draw();
  }

  setMode(mode) {
    this.mode = MODES.includes(mode) ? mode : 'island';
    document.querySelector(`input[name=color][value=${this.mode}]`).checked = true;
    this.#showLegend();
    this.draw();
  }
  nextMode() {
    this.setMode(MODES[(MODES.indexOf(this.mode) + 1) % MODES.length]);
  }

  show(what, isShown) {
    const objects = {
      joints: this.joints, drawings: this.drawings, labels: this.labels,
      contacts: this.contacts.points, normals: this.contacts.normals, bounds: this.boxes.object,
    };
    if (what === 'grid') this.stage.grid.gridStrength.value = isShown ? 1 : 0;
    else if (what === 'solid') this.bodies.setSolid(isShown);
    else objects[what].visible = isShown;
    document.querySelector(`#toggles input[value=${what}]`).checked = isShown;
    this.#showLegend();
    this.draw();
  }

  setTheme(theme) {
    document.documentElement.dataset.theme = this.bodies.theme = theme;
    setTheme(theme);
    this.stage.setTheme(theme);
    if (this.curves.shown.length > 0) this.curves.build();
    this.draw();
  }
  get theme() { return this.stage.theme; }

  // -1, or what is no body: none.
  select(body) {
    this.selected = this.bodies.selected = Number.isInteger(body) && body >= 0 && body < this.recording.bodyCount ? body : -1;
    this.draw();
  }
  // The camera goes with the selected body, or with none. Without a body that is selected there is none to follow.
  setFollowing(isFollowing) {
    this.#follow(isFollowing ? this.selected : -1);
    if (this.isFollowing) this.stage.moveBy(this.#placeOf(this.followed).sub(this.stage.controls.target));
    this.draw();
  }
  #follow(body) {
    this.followed = body;
    element('follow').setAttribute('aria-pressed', this.isFollowing);
  }
  get isFollowing() { return this.followed >= 0; }
  setLooping(isLooping) {
    this.isLooping = isLooping;
    element('loop').setAttribute('aria-pressed', isLooping);
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
    if (isPlaying && this.timeline.frame >= this.timeline.lastFrame) this.#goTo(0);
    this.isPlaying = isPlaying && this.timeline.lastFrame > 0;
    this.lastTick = undefined;
    element('play').setAttribute('aria-label', this.isPlaying ? 'Pause' : 'Play');
    element('play').querySelector('use').setAttribute('href', this.isPlaying ? '#icon-pause' : '#icon-play');
    if (!this.isPlaying) this.stopVideo();
    this.draw();
  }

  async savePicture() {
    this.drawNow();
    await savePicture(element('canvas'), this.recording.title, this.timeline.frame);
  }
  // From the first frame to the last, at the speed that is chosen; a second call ends it before.
  saveVideo() {
    if (this.video) {
      this.setPlaying(false);
      return;
    }
    this.seek(0);
    this.drawNow();
    this.video = new VideoRecorder(element('canvas'), this.recording.title);
    element('video').setAttribute('aria-pressed', true);
    this.setPlaying(true);
  }
  async stopVideo() {
    const video = this.video;
    if (!video) return;
    this.video = undefined;
    element('video').setAttribute('aria-pressed', false);
    this.videoSize = await video.stop();
  }

  resize() {
    this.stage.resize();
    if (!this.curves.isEmpty) {
      if (this.curves.shown.length === 0 && !document.body.classList.contains('bare')) this.curves.build();
      else this.curves.resize();
    }
    this.draw();
  }

  // Draws with the browser's next picture, once however often it is asked for.
  draw() {
    this.pending ??= requestAnimationFrame((now) => this.#tick(now));
  }

  // Draws at once: what a test reads from the canvas is then up to date.
  drawNow() {
    this.stage.clock.seconds.value = this.timeline.time;
    this.bodies.update(this.mode, this.top);
    const { typical } = this.stage.subject;
    if (this.contacts.isVisible) this.contacts.update(contactsNow(this.timeline.contacts(), this.timeline, typical), 1.2 * typical);
    this.boxes.update();
    this.joints.update(this.selected);
    this.drawings.update(this.timeline.frame);
    this.labels.update();
    this.stage.render();
    this.curves.update(this.timeline.frame);
    showBody(this.selected < 0 ? undefined : bodyInfo(this.recording, this.timeline, this.selected));
    if (this.recording.joints.length > 0) showJoints(jointSummary(this.recording, this.timeline.frame));
    this.#showClock();
  }

  #tick(now) {
    this.pending = undefined;
    if (this.isPlaying) {
      const passed = this.lastTick === undefined ? 0 : Math.min(0.1, (now - this.lastTick) / 1000);
      this.lastTick = now;
      this.#goTo(this.timeline.frameAt(this.timeline.time + passed * Number(element('speed').value)));
      if (this.timeline.frame >= this.timeline.lastFrame) {
        if (this.isLooping && !this.video) this.#goTo(0);
        else this.setPlaying(false);
      }
    }
    this.drawNow();
    if (this.isPlaying) this.draw();
  }

  #showLegend() {
    element('legend').innerHTML = legend(this.mode, this.top) + (this.joints?.visible ? jointLegend() : '');
  }

  #showClock() {
    const { frame, lastFrame, time } = this.timeline;
    const whole = Math.floor(frame);
    element('scrub').value = whole;
    element('clock').innerHTML = `${time.toFixed(2)} s · <span>frame </span>${whole} / ${lastFrame}`;
  }
}
