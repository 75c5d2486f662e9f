// Puts the page together: the engine, a scene's world, its picture, hand, sliders and curves. The address may say what to run:
// #scene=drum&paused=1&threads=2&theme=dark. Scripts and tests use window.fulcrum, which is there once a scene is shown.
import { Bodies } from '../../Samples/Viewer/Page/bodies.js';
import { MODES, legend, setTheme } from '../../Samples/Viewer/Page/colors.js';
import { Drawings } from '../../Samples/Viewer/Page/drawings.js';
import { Joints, MOST_WITH_LIMITS, jointLegend } from '../../Samples/Viewer/Page/joints.js';
import { Labels } from '../../Samples/Viewer/Page/labels.js';
import { Stage } from '../../Samples/Viewer/Page/stage.js';
import { findSubject, groundHeight, isEnclosed } from '../../Samples/Viewer/Page/subject.js';
import { addWater } from '../../Samples/Viewer/Page/water.js';
import { Effort } from './effort.js';
import { loadEngine } from './engine.js';
import { Hand } from './hand.js';
import { Live } from './live.js';
import { Plots } from './plots.js';

const MOST_MS = 24;        // of steps between two pictures: beyond that the world is slower than real time
const MOST_BEHIND = 0.25;  // s that the world tries to catch up
const element = (id) => document.getElementById(id);

class Page {
  constructor(engine, wanted) {
    this.engine = engine;
    this.wanted = wanted;
    this.mode = 'island';
    this.isPlaying = false;
    this.plots = new Plots(element('plots'));
    this.effort = new Effort(element('sliders'), element('presets'), (settings) => this.#change(settings));
    this.hand = new Hand(element('stage'), () => ({ world: this.world, stage: this.stage, origin: this.live.origin, typical: this.stage.subject.typical }));
    this.theme = wanted.get('theme') ?? (matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light');
    this.#listScenes();
    this.#connect();
    const threads = engine.threads > 1 ? `${engine.threads} threads` : 'one thread (more where the page is cross-origin isolated: ./fulcrum web --serve)';
    element('engine').textContent = `Fulcrum ${engine.version}, WebAssembly, ${engine.simd}, ${threads}.`;
  }

  // Begins a scene anew. Chosen efforts stay only while the scene does.
  start(name) {
    const isSame = this.name === name;
    const settings = isSame ? this.world.settings : undefined;
    this.hand.release();
    this.world?.destroy();
    this.name = name;
    this.world = this.engine.createScene(name, { measuresErrors: true });
    if (settings) this.world.set({ solver: settings.solver, accuracy: settings.accuracy });
    else this.effort.rate = 60;
    this.effort.show(this.world.settings);
    this.time = this.steps = this.behind = 0;
    this.plots.clear();
    element('scene').value = name;
    document.title = `Fulcrum live: ${name}`;
    this.#show(isSame);
  }

  // The picture of the world as it is now. `keepsStage`: the scene is the same, only bodies came.
  #show(keepsStage) {
    this.live = new Live(this.world);
    const { recording } = this.live;
    if (keepsStage) {
      for (const object of this.drawn) {
        object.removeFromParent();
        object.geometry?.dispose();
        object.material?.map?.dispose();
      }
    } else {
      this.#newStage(findSubject(recording, this.live));
      const ground = groundHeight(recording, this.live, this.stage.subject);
      if (ground !== undefined) this.stage.addGround(ground);
      if (recording.view?.water) addWater(this.stage, recording.view.water);
      this.isSolid = !isEnclosed(recording, this.live, this.stage.subject);
    }
    const { scene } = this.stage, before = scene.children.length;
    this.bodies = new Bodies(recording, this.live, this.stage);
    this.joints = new Joints(recording, this.live, this.stage);
    this.labels = new Labels(recording, this.live, this.stage);
    this.drawings = new Drawings(recording, this.stage);
    this.drawn = scene.children.slice(before);
    this.bodies.theme = this.theme;
    this.bodies.setSolid(this.isSolid);
    if (!keepsStage) {
      this.shown = { joints: recording.view?.joints !== false && recording.joints.length <= MOST_WITH_LIMITS, labels: true, drawings: true };
    }
    for (const what of Object.keys(this.shown)) this.show(what, this.shown[what]);
    if (keepsStage) return;
    this.stage.resize();
    this.stage.frameSubject();
    element('title').textContent = recording.title.replaceAll('_', ' ');
    element('description').textContent = recording.description;
    this.setTheme(this.theme);
    this.#setMode(recording.view?.color ?? 'island');
  }

  // With a canvas of its own: what the one before left in its context would disturb it.
  #newStage(subject) {
    this.stage?.controls.dispose();
    this.stage?.renderer.dispose();
    this.stage?.renderer.forceContextLoss();
    const canvas = element('canvas').cloneNode();
    element('canvas').replaceWith(canvas);
    this.stage = new Stage(canvas, subject, this.wanted.has('fine') ? this.wanted.get('fine') === '1' : undefined);
  }

  // Joints, labels, or what the scene draws.
  show(what, isShown) {
    this.shown[what] = isShown;
    this[what].visible = isShown;
    const input = document.querySelector(`#toggles input[value=${what}]`);
    input.checked = isShown;
    const { joints, bodies } = this.live.recording;
    input.parentElement.hidden = { joints: joints.length === 0, labels: Object.keys(bodies.names).length === 0 }[what] ?? false;
    this.#showLegend();
    this.draw();
  }

  setTheme(theme) {
    this.theme = document.documentElement.dataset.theme = this.bodies.theme = theme;
    setTheme(theme);
    this.stage.setTheme(theme);
    this.plots.build();
    this.draw();
  }
  #setMode(mode) {
    this.mode = MODES.includes(mode) ? mode : 'island';
    document.querySelector(`input[name=color][value=${this.mode}]`).checked = true;
    this.#showLegend();
    this.draw();
  }
  #showLegend() {
    const withJoints = this.shown.joints && this.live.recording.joints.length > 0;
    element('legend').innerHTML = legend(this.mode, this.live.top) + (withJoints ? jointLegend() : '');
  }

  #change(settings) {
    this.world.set(settings);
    this.plots.mark();
  }

  setPlaying(isPlaying) {
    this.isPlaying = isPlaying;
    this.lastTick = undefined;
    this.behind = 0;
    element('play').setAttribute('aria-label', isPlaying ? 'Pause' : 'Play');
    element('play').querySelector('use').setAttribute('href', isPlaying ? '#icon-pause' : '#icon-play');
    this.draw();
  }

  step() {
    const dt = 1 / this.effort.rate;
    this.world.step(dt);
    this.time += dt;
    ++this.steps;
    this.report = this.world.report;
    this.plots.add(this.time, this.report, this.world);
  }
  shoot() {
    this.hand.shoot();
    this.isStale = true;
    this.draw();
  }

  // Draws with the browser's next picture, once however often it is asked for.
  draw() {
    this.pending ??= requestAnimationFrame((now) => this.#tick(now));
  }
  drawNow() {
    if (this.live.update() || this.isStale) {
      this.isStale = false;
      this.#show(true);
      this.live.update();
    }
    this.stage.clock.seconds.value = this.time;
    this.bodies.update(this.mode, this.live.top);
    this.joints.update(-1);
    this.labels.update();
    this.drawings.update(0);
    this.hand.draw();
    this.stage.render();
    this.plots.draw();
    this.#showNumbers();
  }

  #tick(now) {
    this.pending = undefined;
    if (this.isPlaying) {
      const passed = this.lastTick === undefined ? 0 : (now - this.lastTick) / 1000;
      this.lastTick = now;
      this.behind = Math.min(MOST_BEHIND, this.behind + passed);
      const dt = 1 / this.effort.rate, begin = performance.now();
      const before = this.time;
      while (this.behind >= dt) {
        this.step();
        this.behind -= dt;
        if (performance.now() - begin > MOST_MS) this.behind = 0;
      }
      if (passed > 0) this.pace = 0.95 * (this.pace ?? 1) + 0.05 * ((this.time - before) / passed);
    }
    this.drawNow();
    if (this.isPlaying) this.draw();
  }

  #showNumbers() {
    const pace = this.isPlaying && this.pace < 0.9 ? ` · ${Math.round(100 * this.pace)} % of real time` : '';
    element('clock').textContent = `${this.time.toFixed(2)} s · step ${this.steps}${pace}`;
    if (!this.report) return;
    const { plots, report } = this;
    const number = (value, unit) => `<b>${Number(value.toPrecision(3))} ${unit}</b>`;
    const most = report.mostEffort[0]?.substeps ?? this.world.settings.solver.substeps;
    element('summary').innerHTML = `<div>${number(plots.recent('ms'), 'ms')}<span>a step</span></div>` +
      `<div>${number(plots.recent('penetration'), 'mm')}<span>penetration</span></div>` +
      (report.joints > 0 ? `<div>${number(plots.recent('joint-error'), 'mm')}<span>joint error</span></div>` : `<div><b>${report.contacts}</b><span>contacts</span></div>`) +
      `<div><b>${report.awakeBodies}</b><span>awake of ${report.bodies}</span></div><div><b>${most}</b><span>substeps, at most</span></div>` +
      `<div><b>${report.islandsWithMoreEffort}</b><span>of ${report.islands} islands with more effort</span></div>`;
    element('curve-joint-error').hidden = report.joints === 0;
  }

  #listScenes() {
    for (const kind of ['Performance', 'Sample']) {
      const group = Object.assign(document.createElement('optgroup'), { label: kind === 'Sample' ? 'Samples' : kind });
      for (const { name } of this.engine.scenes.filter((scene) => scene.kind === kind))
        group.append(Object.assign(document.createElement('option'), { value: name, textContent: name.replaceAll('_', ' ') }));
      element('scene').append(group);
    }
  }

  #connect() {
    const actions = {
      again: () => this.start(this.name), play: () => this.setPlaying(!this.isPlaying), shoot: () => this.shoot(),
      theme: () => this.setTheme(this.theme === 'dark' ? 'light' : 'dark'),
      forward: () => { this.setPlaying(false); this.step(); this.draw(); },
    };
    for (const [id, act] of Object.entries(actions)) element(id).addEventListener('click', () => act());
    element('scene').addEventListener('change', (event) => {
      this.start(event.target.value);
      location.hash = `scene=${this.name}`;
      event.target.blur();
    });
    for (const input of document.querySelectorAll('input[name=color]')) input.addEventListener('change', () => this.#setMode(input.value));
    element('toggles').addEventListener('change', ({ target }) => this.show(target.value, target.checked));
    const keys = { ' ': actions.play, ArrowRight: actions.forward, r: actions.again, f: actions.shoot, d: actions.theme };
    addEventListener('keydown', (event) => {
      if (event.ctrlKey || event.metaKey || event.altKey || event.target.closest('select, input[type=range]')) return;
      const act = keys[event.key.length > 1 ? event.key : event.key.toLowerCase()];
      if (!act) return;
      event.preventDefault();
      act();
    });
    addEventListener('resize', () => { this.stage.resize(); this.plots.resize(); this.draw(); });
    for (const moved of ['pointermove', 'wheel']) element('stage').addEventListener(moved, () => this.draw());
  }
}

// What scripts and tests see.
function publish(page) {
  window.fulcrum = {
    engine: page.engine,
    get world() { return page.world; },
    get steps() { return page.steps; },
    get report() { return page.report; },
    get typical() { return page.stage.subject.typical; }, // radius of a body, m
    get isHolding() { return page.hand.isHolding; },
    // What the viewer's parts have of it: the joints' states, the labels, what the scene draws.
    get picture() { return { joints: page.joints, labels: page.labels, drawings: page.drawings, live: page.live }; },
    show(what, isShown) { page.show(what, isShown); page.drawNow(); },
    start(name) { page.start(name); page.drawNow(); },
    play(isPlaying = true) { page.setPlaying(isPlaying); },
    step(count = 1) {
      for (let i = 0; i < count; ++i) page.step();
      page.drawNow();
    },
    shoot() { page.shoot(); page.drawNow(); },
    // Where a place of the world is in the picture, pixels of the page.
    project(position) {
      const [x, y] = page.stage.project(...position.map((value, k) => value - page.live.origin[k]));
      const { left, top, width, height } = element('canvas').getBoundingClientRect();
      return [left + ((x + 1) / 2) * width, top + ((1 - y) / 2) * height];
    },
  };
}

async function start() {
  const wanted = new URLSearchParams(location.hash.slice(1));
  try {
    const data = element('engine-data');
    const engine = await loadEngine(data.textContent, wanted.has('threads') ? Number(wanted.get('threads')) : undefined);
    data.remove();
    const page = new Page(engine, wanted);
    const names = engine.scenes.map(({ name }) => name);
    page.start(names.includes(wanted.get('scene')) ? wanted.get('scene') : 'pyramid');
    page.drawNow();
    publish(page);
    element('message').textContent = '';
    page.setPlaying(wanted.get('paused') !== '1');
  } catch (error) {
    element('message').textContent = `The engine cannot run here: ${error.message}`;
    console.error(error);
  }
}

start();
