// The picture of a window: a canvas that is moved, zoomed and clicked, with a sentence beside it.
import { fill, h } from "../ui/dom.mjs";
import { themeColour } from "../ui/plot.mjs";
import { drawWindow } from "./drawing.mjs";
import { CanvasPen, SvgPen, View } from "./pens.mjs";

const REACH = 18; // how far a click may miss a person [px]

export class PredictionScene {
  constructor(store) {
    this.store = store;
    this.view = new View();
    this.background = null;
    this.canvas = h("canvas", { tabindex: 0, role: "img", "aria-label": "Scene", class: "scene" });
    this.summary = h("p", { class: "summary", "aria-live": "polite" }, "");
    this.element = h("div", { class: "scene-place" }, this.canvas);
    new ResizeObserver(() => this._resize()).observe(this.element);
    store.on("board", (other) => this._board(other));
    store.on("frame person view", () => this.draw());
    store.on("frame", () => this._tell());
    document.addEventListener("theme", () => this.draw());
    this._listen();
  }

  fit() {
    if (!this.store.recording) return;
    this.view.fit(this.store.recording.bounds);
    this.draw();
  }

  draw() {
    this._waits ??= requestAnimationFrame(() => {
      this._waits = null;
      this._draw();
    });
  }

  /** The picture as PNG. */
  png() {
    this._draw();
    return new Promise((resolve) => this.canvas.toBlob(resolve, "image/png"));
  }

  /** The picture as SVG text. */
  svg() {
    const pen = new SvgPen(this.view, themeColour("--paper"));
    drawWindow(pen, this._content());
    return pen.toString();
  }

  /** Id of the person at a place of the canvas, or null. */
  pick(px, py) {
    let best = null;
    let least = REACH;
    for (const one of this.store.frame?.people ?? []) {
      const [x, y] = this.view.at(one.now);
      const away = Math.hypot(x - px, y - py);
      if (away < least) [best, least] = [one.id, away];
    }
    return best;
  }

  /** Chooses the next (1) or previous (-1) person. */
  step(by) {
    const ids = (this.store.frame?.people ?? []).map((one) => one.id);
    if (!ids.length) return;
    const at = ids.indexOf(this.store.person);
    this.store.choose(ids[at < 0 ? 0 : (at + by + ids.length) % ids.length]);
  }

  _content() {
    const { recording, frame, layers, person, input } = this.store;
    return { recording, frame, layers, selected: person, background: this.background, input };
  }

  _draw() {
    const ratio = devicePixelRatio || 1;
    const context = this.canvas.getContext("2d");
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.fillStyle = themeColour("--paper");
    context.fillRect(0, 0, this.view.width, this.view.height);
    if (this.store.recording) drawWindow(new CanvasPen(context, this.view), this._content());
    this.canvas.dataset.frame = this.store.frame?.index ?? "";
    this.canvas.dataset.forecasts = this.store.frame?.forecasts.length ?? 0;
  }

  _resize() {
    const { clientWidth: width, clientHeight: height } = this.element;
    if (!width || !height) return;
    const ratio = devicePixelRatio || 1;
    const first = this.view.width === 600 && this.view.height === 400;
    Object.assign(this.view, { width, height });
    this.canvas.width = width * ratio;
    this.canvas.height = height * ratio;
    if (first || !this._moved) this.fit();
    this._draw();
  }

  _board(other) {
    const { recording } = this.store;
    this.view.down = recording?.units === "px";
    const name = JSON.stringify(recording?.background ?? null);
    if (name !== this._backgroundName) this._loadBackground(name);
    if (other) {
      this._moved = false;
      this.fit();
    }
    this.draw();
  }

  _loadBackground(name) {
    this._backgroundName = name;
    this.background = null;
    if (name === "null") return;
    const image = new Image();
    image.onload = () => {
      this.background = image;
      this._moved = false;
      this.fit();
    };
    image.src = this.store.app.connection.address("prediction", "background.png", { name });
  }

  _tell() {
    const { frame, recording } = this.store;
    const scored = frame.people.filter((one) => one.scored).length;
    const robots = frame.people.filter((one) => one.robot).length;
    const words =
      `Frame ${recording.frames[frame.index]}, ${frame.time.toFixed(2)} s: ${frame.people.length - robots} people, ` +
      `${robots} ${robots === 1 ? "robot" : "robots"}, ${scored} scored, ${frame.forecasts.length} ${frame.forecasts.length === 1 ? "predictor" : "predictors"}`;
    this.canvas.setAttribute("aria-label", `Scene. ${words}`);
    clearTimeout(this._later);
    this._later = setTimeout(() => fill(this.summary, words), 400);
  }

  _listen() {
    let from = null;
    let moved = false;
    this.canvas.addEventListener("pointerdown", (event) => {
      from = [event.offsetX, event.offsetY];
      moved = false;
      this.canvas.setPointerCapture(event.pointerId);
    });
    this.canvas.addEventListener("pointermove", (event) => {
      if (!from) return;
      const [dx, dy] = [event.offsetX - from[0], event.offsetY - from[1]];
      if (!moved && Math.hypot(dx, dy) < 4) return;
      moved = this._moved = true;
      this._shift(-dx, -dy);
      from = [event.offsetX, event.offsetY];
    });
    this.canvas.addEventListener("pointerup", (event) => {
      if (from && !moved) this.store.choose(this.pick(event.offsetX, event.offsetY));
      from = null;
    });
    this.canvas.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        this._moved = true;
        this.view.zoom(Math.exp(-event.deltaY * 0.0015), event.offsetX, event.offsetY);
        this.draw();
      },
      { passive: false },
    );
  }

  _shift(dx, dy) {
    this.view.x += dx / this.view.scale;
    this.view.y += ((this.view.down ? 1 : -1) * dy) / this.view.scale;
    this.draw();
  }

  /** Zooms by a factor around the middle. */
  zoom(factor) {
    this._moved = true;
    this.view.zoom(factor);
    this.draw();
  }
}
