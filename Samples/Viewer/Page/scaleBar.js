// A bar of a round length in a corner of the picture: how large what one sees is, at the distance of what the camera looks at.
const MOST_PIXELS = 130;

// The largest of 1, 2 and 5 times a power of ten that is at most `most`.
export function roundBelow(most) {
  const decade = 10 ** Math.floor(Math.log10(most) + 1e-9);
  return [5, 2, 1].find((step) => step * decade <= most * (1 + 1e-9)) * decade;
}

export function lengthText(meters) {
  const digits = (value) => Number(value.toPrecision(3));
  if (meters >= 1000) return `${digits(meters / 1000)} km`;
  if (meters >= 1) return `${digits(meters)} m`;
  return meters >= 0.01 ? `${digits(100 * meters)} cm` : `${digits(1000 * meters)} mm`;
}

export class ScaleBar {
  // `place`: around the canvas.
  constructor(place) {
    place.querySelector('.scale-bar')?.remove(); // of the stage before
    this.bar = Object.assign(document.createElement('div'), { className: 'scale-bar', title: 'at the middle of the picture' });
    place.append(this.bar);
  }
  // `perPixel`: meters.
  update(perPixel) {
    if (!(perPixel > 0) || perPixel === this.shown) return;
    this.shown = perPixel;
    const length = roundBelow(MOST_PIXELS * perPixel);
    this.bar.style.width = `${length / perPixel}px`;
    this.bar.textContent = lengthText(length);
  }
}
