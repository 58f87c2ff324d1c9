// ImageFigures: images of camera sensors beside or over a picture, each with its time and its scale.
import { fill, h } from "../ui/dom.mjs";

/** Time [ms] after which the text of an image is renewed; a screen reader should not read every image. */
const TELL = 2000;

export class ImageFigures {
  /** @param {(name: string) => void} close called when a person closes an image */
  constructor(close) {
    this._close = close;
    this._figures = new Map();
    this.element = h("div", { class: "camera-images", role: "group", "aria-label": "Camera images", hidden: true });
  }

  /** Shows figures for these images of a description; others are removed. */
  show(images) {
    const names = new Set(images.map((one) => one.name));
    for (const [name, figure] of this._figures) {
      const found = images.find((one) => one.name === name);
      if (!names.has(name) || JSON.stringify(found) !== figure.key) this._figures.delete(name);
    }
    for (const one of images) if (!this._figures.has(one.name)) this._figures.set(one.name, new ImageFigure(one, () => this._close(one.name)));
    fill(this.element, images.map((one) => this._figures.get(one.name).element));
    this.element.hidden = !images.length;
  }

  /** The figure of an image, or undefined. */
  figure(name) {
    return this._figures.get(name);
  }
}

class ImageFigure {
  constructor(image, close) {
    this.image = image;
    this.key = JSON.stringify(image);
    this.drawn = 0;
    this.time = null;
    this._told = -Infinity;
    this.canvas = h("canvas", { role: "img", width: image.width, height: image.height });
    this._clock = h("span", { class: "camera-time" });
    this._larger = h("button", { type: "button", "aria-pressed": "false", "aria-label": `Larger: ${image.title}`, onclick: () => this._grow() }, "Larger");
    this.element = h("figure", { class: "camera-image" },
      h("figcaption", {}, h("span", { class: "camera-title" }, image.title),
        this._larger, h("button", { type: "button", "aria-label": `Close: ${image.title}`, onclick: close }, "×")),
      h("div", { class: "camera-view" }, this.canvas, this._clock), scale(image.scale));
    this._tell(true);
  }

  /** Draws a file of an image; the promise is kept when it is drawn. A newer image that is drawn first stays. */
  async draw(bytes, type, time) {
    const order = (this._order = (this._order ?? 0) + 1);
    const bitmap = await createImageBitmap(new Blob([bytes], { type }));
    if (order >= (this._latest ?? 0)) {
      this._latest = order;
      if (this.canvas.width !== bitmap.width) Object.assign(this.canvas, { width: bitmap.width, height: bitmap.height });
      this.canvas.getContext("2d").drawImage(bitmap, 0, 0);
      this.time = time;
      this.drawn += 1;
      this._clock.textContent = `${time.toFixed(2)} s`;
      this._tell(this.drawn === 1 || performance.now() - this._told > TELL);
    }
    bitmap.close();
  }

  _tell(due) {
    if (!due) return;
    this._told = performance.now();
    const { title, width, height, rate } = this.image;
    const when = this.time === null ? "no image yet" : `measured at ${this.time.toFixed(1)} s`;
    this.canvas.setAttribute("aria-label", `${title}, ${width} by ${height} pixels, ${rate} Hz, ${when}`);
  }

  _grow() {
    const on = this.element.classList.toggle("large");
    this._larger.setAttribute("aria-pressed", String(on));
  }
}

/** What the colours of an image mean, or null. */
function scale({ colors, low, high, unit, nearer, beyond, names }) {
  if (colors) {
    const bar = h("i", { class: "camera-bar", "aria-hidden": "true" });
    bar.style.background = `linear-gradient(to right, ${colors.join(", ")})`;
    return h("p", { class: "camera-scale" }, `${low} ${unit}`, bar, `${high} ${unit}`, swatch(nearer, "nearer"), swatch(beyond, "beyond"));
  }
  if (names) return h("p", { class: "camera-scale" }, Object.entries(names).map(([name, color]) => swatch(color, name)));
  return null;
}

function swatch(color, text) {
  const mark = h("i", { class: "camera-swatch", "aria-hidden": "true" });
  mark.style.background = color;
  return h("span", {}, mark, text);
}
