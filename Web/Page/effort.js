// The sliders: effort, time step and targets of accuracy, as settings of a world. No page is needed for what they mean.

const percent = (value) => (value === Infinity ? 'none' : `${Number((100 * value).toPrecision(2))} %`);
const millimeters = (value) => (value === Infinity ? 'none' : `${Number((1000 * value).toPrecision(2))} mm`);
// `count` places from `first` to `last`, each larger than the one before by the same factor, then none.
const geometric = (first, last, count) =>
  [...Array.from({ length: count }, (_, i) => first * (last / first) ** (i / (count - 1))), Infinity];

// `of` and `into`: from and to settings; a slider's places are the values that it can have.
export const SLIDERS = [
  { id: 'substeps', label: 'Substeps', places: [1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 255], text: String,
    of: (s) => s.solver.substeps, into: (value) => ({ solver: { substeps: value } }) },
  { id: 'velocity', label: 'Velocity iterations', places: [1, 2, 3, 4, 6, 8, 12, 16], text: String,
    of: (s) => s.solver.velocityIterations, into: (value) => ({ solver: { velocityIterations: value } }) },
  { id: 'position', label: 'Position iterations', places: [0, 1, 2, 3, 4, 6, 8, 12, 16], text: String,
    of: (s) => s.solver.positionIterations, into: (value) => ({ solver: { positionIterations: value } }) },
  { id: 'rate', label: 'Time step', places: [10, 15, 20, 30, 45, 60, 90, 120, 180, 240, 480], text: (rate) => `1/${rate} s` },
  { id: 'penetration', label: 'Target: penetration, of the body’s size', places: geometric(0.0005, 0.13, 17), text: percent,
    of: (s) => s.accuracy.penetration, into: (value) => ({ accuracy: { penetration: value } }) },
  { id: 'joint', label: 'Target: joint error', places: geometric(0.0001, 0.1, 13), text: millimeters,
    of: (s) => s.accuracy.jointError, into: (value) => ({ accuracy: { jointError: value } }) },
];

// Those of Physics/Settings.h.
export const PRESETS = [
  { label: 'Fast', solver: { substeps: 2, velocityIterations: 1, positionIterations: 1 } },
  { label: 'Balanced', solver: { substeps: 4, velocityIterations: 1, positionIterations: 1 } },
  { label: 'Accurate', solver: { substeps: 16, velocityIterations: 1, positionIterations: 1 } },
  { label: 'Reference', solver: { substeps: 128, velocityIterations: 1, positionIterations: 1 } },
];

export function nearestPlace(places, value) {
  if (value === Infinity) return places.length - 1;
  let best = 0;
  places.forEach((place, i) => {
    if (Math.abs(place - value) < Math.abs(places[best] - value)) best = i;
  });
  return best;
}

// Draws them into the page. `changed(settings or { rate })` is called with what to change.
export class Effort {
  constructor(place, presetPlace, changed) {
    this.inputs = new Map();
    this.changed = changed;
    this.rate = 60;
    for (const slider of SLIDERS) {
      const row = Object.assign(document.createElement('label'), { className: 'slider' });
      const input = Object.assign(document.createElement('input'), { type: 'range', id: `slider-${slider.id}`, min: 0, max: slider.places.length - 1, step: 1 });
      const value = document.createElement('output');
      row.append(Object.assign(document.createElement('span'), { textContent: slider.label }), value, input);
      place.append(row);
      this.inputs.set(slider.id, { slider, input, value });
      input.addEventListener('input', () => {
        const chosen = slider.places[Number(input.value)];
        value.textContent = slider.text(chosen);
        if (slider.id === 'rate') this.rate = chosen;
        else this.changed(slider.into(chosen));
        this.#markPreset();
      });
    }
    this.presets = PRESETS.map((preset) => {
      const button = Object.assign(document.createElement('button'), { type: 'button', textContent: preset.label });
      button.addEventListener('click', () => {
        this.changed({ solver: preset.solver });
        this.show({ solver: preset.solver });
      });
      presetPlace.append(button);
      return { preset, button };
    });
  }

  // Sets the sliders to settings, of which parts may be missing.
  show(settings) {
    for (const { slider, input, value } of this.inputs.values()) {
      const wanted = slider.id === 'rate' ? this.rate : (settings.solver && slider.into?.(0).solver) || (settings.accuracy && slider.into?.(0).accuracy) ? slider.of(settings) : undefined;
      if (wanted === undefined) continue;
      const place = nearestPlace(slider.places, wanted);
      input.value = place;
      value.textContent = slider.text(slider.places[place]);
    }
    this.#markPreset();
  }

  #markPreset() {
    const now = (id) => {
      const { slider, input } = this.inputs.get(id);
      return slider.places[Number(input.value)];
    };
    for (const { preset, button } of this.presets) {
      const { substeps, velocityIterations, positionIterations } = preset.solver;
      button.setAttribute('aria-pressed', now('substeps') === substeps && now('velocity') === velocityIterations && now('position') === positionIterations);
    }
  }
}
