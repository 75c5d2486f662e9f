// What the buttons, the keys and the pointer do.
import { canSaveVideo } from './saving.js';

const element = (id) => document.getElementById(id);

export class Controls {
  constructor(viewer) {
    this.viewer = viewer;
    this.hasPointed = false; // since the tabulator key was last pressed
    const toggle = (id, action) => element(id).addEventListener('click', action);
    element('scrub').max = viewer.timeline.lastFrame;
    element('scrub').addEventListener('input', (event) => viewer.seek(Number(event.target.value)));
    toggle('play', () => viewer.setPlaying(!viewer.isPlaying));
    toggle('back', () => viewer.step(-1));
    toggle('forward', () => viewer.step(1));
    toggle('loop', () => viewer.setLooping(!viewer.isLooping));
    toggle('follow', () => viewer.setFollowing(!viewer.isFollowing));
    toggle('picture', () => viewer.savePicture());
    toggle('video', () => viewer.saveVideo());
    toggle('theme', () => this.#switchTheme());
    toggle('full', () => this.#switchFullScreen());
    toggle('help', () => element('keys').showModal());
    element('video').hidden = !canSaveVideo(element('canvas'));
    element('full').hidden = !document.fullscreenEnabled;
    element('colors').addEventListener('change', (event) => viewer.setMode(event.target.value));
    element('toggles').addEventListener('change', (event) => viewer.show(event.target.value, event.target.checked));
    viewer.stage.controls.addEventListener('change', () => viewer.draw());
    new ResizeObserver(() => viewer.resize()).observe(element('stage'));
    addEventListener('keydown', (event) => this.#onKey(event));
    addEventListener('pointerdown', () => (this.hasPointed = true), { capture: true });
    this.#connectClicks();
  }

  #switchTheme() {
    this.viewer.setTheme(this.viewer.theme === 'dark' ? 'light' : 'dark');
  }
  #switchFullScreen() {
    if (document.fullscreenElement) document.exitFullscreen();
    else element('view').requestFullscreen();
  }

  // A click is a press that hardly moves; else it was the camera that turned.
  #connectClicks() {
    const canvas = element('canvas');
    let press;
    canvas.addEventListener('pointerdown', (event) => (press = [event.clientX, event.clientY]));
    canvas.addEventListener('pointerup', (event) => {
      if (!press || event.button !== 0 || Math.hypot(event.clientX - press[0], event.clientY - press[1]) > 4) return;
      const box = canvas.getBoundingClientRect();
      this.viewer.pick(event.clientX - box.left, event.clientY - box.top);
    });
  }

  // A control that was reached by Tab keeps its own keys: space and Enter press a button, arrows choose among radio buttons.
  // One that was clicked leaves them to the page, and lets go, so that the key's end is not its own either.
  #onKey(event) {
    const { viewer } = this;
    if (event.key === 'Tab') this.hasPointed = false;
    if (element('keys').open) return;
    const actions = {
      ' ': () => viewer.setPlaying(!viewer.isPlaying),
      ArrowLeft: () => viewer.step(-1),
      ArrowRight: () => viewer.step(1),
      Home: () => viewer.seek(0),
      End: () => viewer.seek(viewer.timeline.lastFrame),
      Escape: () => viewer.select(-1),
      Enter: () => this.#switchFullScreen(),
      '?': () => element('keys').showModal(),
      l: () => viewer.setLooping(!viewer.isLooping),
      f: () => viewer.setFollowing(!viewer.isFollowing),
      r: () => viewer.stage.frameSubject(),
      c: () => viewer.nextMode(),
      s: () => viewer.savePicture(),
      v: () => viewer.saveVideo(),
      d: () => this.#switchTheme(),
    };
    const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
    if (!actions[key] || event.ctrlKey || event.metaKey || event.altKey) return;
    const control = event.target.closest('button, input, select');
    if (control && this.hasPointed) control.blur();
    else if (control?.matches(key === ' ' || key === 'Enter' ? 'button, input, select' : 'select, input[type=radio]')) return;
    event.preventDefault();
    actions[key]();
  }
}
