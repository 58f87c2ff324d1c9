// Player: plays the frames of an episode in a page of its own.
import { fill, h } from "../ui/dom.mjs";
import { BlendBuffer, blendFrames } from "../scene/blend.mjs";
import { Scene2D } from "../scene2d/scene2d.mjs";
import { Scene3D } from "../scene3d/scene3d.mjs";
import { ImageFigures } from "../scene/image_figures.mjs";
import { readJson } from "./pack.mjs";

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 4];
/** Age of an image [s], or of two intervals if these are longer, after which it is not shown any more. */
const OLD = 1;
/** Largest number of events in the list. */
const EVENTS = 300;
/** Time [s] before an event to which the keys J and K jump. */
const AHEAD = 0.5;

export class Player {
  constructor(root, { files, frames }) {
    this.root = root;
    this.files = files;
    this.frames = frames;
    this.index = readJson(files.get("index.json"));
    this.time = frames[0].time;
    this.end = frames.at(-1).time;
    this.playing = false;
    this.speed = 1;
    this._urls = new Map();
    this._blend = new BlendBuffer();
    this._chosen = new Set();
    this._drawn = new Map();
    this.images = new ImageFigures((name) => this._chooseImage(name, false));
    this._theme = matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
    document.documentElement.dataset.theme = this._theme;
    this._layout();
  }

  /** Loads the scene in 3-D or 2-D. */
  async show(flat = false) {
    this.scene?.dispose();
    const canvas = h("canvas", { tabindex: "0", role: "img", "aria-label": `${this.index.name}, seen ${flat ? "from above" : "in space"}` });
    fill(this._stage, canvas);
    canvas.addEventListener("click", (event) => this._pick(event));
    this.flat = flat;
    this.scene = new (flat ? Scene2D : Scene3D)(canvas, (path) => this._url(path));
    this.scene.setTheme(this._theme);
    this._revision = null;
    await this.seek(this.time);
    this._choices();
    this._flatButton.setAttribute("aria-pressed", String(flat));
  }

  /** Shows the instant at a time [s]. */
  async seek(time) {
    this.time = Math.min(this.end, Math.max(this.frames[0].time, time));
    const at = this._before(this.time);
    const from = this.frames[at];
    const to = this.frames[Math.min(at + 1, this.frames.length - 1)];
    const share = to === from ? 0 : (this.time - from.time) / (to.time - from.time);
    const frame = blendFrames(from, to, share, this._blend);
    if (this._revision !== frame.arrays.revision[0]) {
      this._revision = frame.arrays.revision[0];
      await this.scene.load(readJson(this.files.get(`description/${this._revision}.json`)));
    }
    this.scene.apply(frame);
    this.scene.render();
    this._tell();
    await this._drawImages();
  }

  play(on = !this.playing) {
    if (on && this.time >= this.end) this.time = this.frames[0].time;
    this.playing = on;
    this._playButton.textContent = on ? "Pause" : "Play";
    this._last = null;
    if (on) requestAnimationFrame((now) => this._tick(now));
  }

  async _tick(now) {
    if (!this.playing) return;
    if (this._last !== null) await this.seek(this.time + (0.001 * this.speed * Math.min(250, now - this._last)));
    this._last = now;
    if (this.time >= this.end) return this.play(false);
    requestAnimationFrame((next) => this._tick(next));
  }

  _before(time) {
    let [low, high] = [0, this.frames.length - 1];
    while (low < high) {
      const middle = Math.ceil((low + high) / 2);
      if (this.frames[middle].time <= time + 1e-9) low = middle;
      else high = middle - 1;
    }
    return low;
  }

  _url(path) {
    if (!this._urls.has(path)) {
      const bytes = this.files.get(path) ?? this.files.get("bodies/1.bin");
      this._urls.set(path, URL.createObjectURL(new Blob([bytes])));
    }
    return this._urls.get(path);
  }

  _layout() {
    const button = (text, action, more = {}) => h("button", { type: "button", onclick: action, ...more }, text);
    this._stage = h("div", { class: "player-stage" });
    this._playButton = button("Play", () => this.play(), { class: "main" });
    this._scrubber = h("input", {
      type: "range", min: this.frames[0].time, max: this.end, step: "any", value: this.time, "aria-label": "Time [s]",
      oninput: () => this.seek(Number(this._scrubber.value)),
    });
    this._clock = h("span", { class: "player-clock" });
    this._speeds = h(
      "select", { "aria-label": "Speed", onchange: () => (this.speed = Number(this._speeds.value)) },
      SPEEDS.map((one) => h("option", { value: one, selected: one === 1 }, `${one} x`)),
    );
    this._cameras = h("select", { "aria-label": "Camera", onchange: () => this._look() });
    this._flatButton = button("From above", () => this.show(!this.flat), { "aria-pressed": "false" });
    this._layers = h("div", { class: "player-layers" });
    const events = this.index.events ?? [];
    this._events = h(
      "select", { "aria-label": "Event", hidden: !events.length, onchange: () => this._events.value && this.seek(Number(this._events.value)) },
      h("option", { value: "" }, `${events.length} ${events.length === 1 ? "event" : "events"}`),
      events.slice(0, EVENTS).map(({ time, kind, about }) => h("option", { value: time }, `${time.toFixed(1)} s: ${kind}, ${about}`)),
    );
    this._summary = h("p", { class: "player-summary", role: "status", "aria-live": "polite" });
    fill(
      this.root,
      h("header", {}, h("h1", {}, this.index.name), h("span", { class: "player-about" }, this.index.about),
        h("details", {}, h("summary", {}, "Layers"), this._layers), this._cameras, this._flatButton,
        button("Theme", () => this._turnTheme())),
      h("main", {}, this._stage, this.images.element),
      h("footer", {}, this._playButton, this._scrubber, this._clock, this._speeds, this._events, this._summary),
    );
    document.addEventListener("keydown", (event) => this._key(event));
    new ResizeObserver(() => this.scene && this.scene.render()).observe(this._stage);
    this._stage.addEventListener("pointermove", (event) => event.buttons && !this.playing && this.scene.render());
    this._stage.addEventListener("wheel", () => !this.playing && requestAnimationFrame(() => this.scene.render()));
  }

  /** Goes to the event before or after, half a second before it happens. */
  _jump(way) {
    const times = (this.index.events ?? []).map(({ time }) => Math.max(this.frames[0].time, time - AHEAD));
    const next = way > 0 ? times.find((time) => time > this.time + 0.01) : times.findLast((time) => time < this.time - 0.01);
    if (next !== undefined) this.seek(next);
  }

  _choices() {
    fill(this._cameras, this.scene.cameras().map(({ name, title }) => h("option", { value: name }, title)));
    const asked = new Set(this.index.layers);
    const own = this.scene.layers().filter((one) => !this.index.optional.includes(one.name) || asked.has(one.name));
    fill(this._layers, own.map(({ name, title, visible }) => {
      const box = h("input", { type: "checkbox", checked: visible, onchange: () => this._switch(name, box.checked) });
      return h("label", {}, box, ` ${title}`);
    }), (this.index.images ?? []).map(({ image: { name, title } }) => {
      const box = h("input", { type: "checkbox", name, checked: this._chosen.has(name), onchange: () => this._chooseImage(name, box.checked) });
      return h("label", {}, box, ` ${title}`);
    }));
  }

  _chooseImage(name, on) {
    this._chosen[on ? "add" : "delete"](name);
    for (const box of this._layers.querySelectorAll("input")) if (box.name === name) box.checked = on;
    this.images.show(this.index.images.map((one) => one.image).filter((one) => this._chosen.has(one.name)));
    this._drawn.delete(name);
    return this._drawImages();
  }

  /** Draws the newest recorded image of each camera that is chosen, if it is another one than before. */
  async _drawImages() {
    await Promise.all((this.index.images ?? []).map(async ({ image, type, times }, number) => {
      const figure = this.images.figure(image.name);
      const at = times.findLastIndex((time) => time <= this.time + 1e-9);
      const old = Math.max(OLD, 2 / image.rate);
      if (!figure || at < 0 || this.time - times[at] > old || this._drawn.get(image.name) === at) return;
      this._drawn.set(image.name, at);
      await figure.draw(this.files.get(`image/${number}/${at}`), type, times[at]);
    }));
  }

  _switch(name, visible) {
    this.scene.setLayer(name, visible);
    this.seek(this.time);
  }

  _look() {
    this.scene.setCamera(this._cameras.value);
    this.seek(this.time);
  }

  _pick(event) {
    const box = event.target.getBoundingClientRect();
    const found = this.scene.pick(event.clientX - box.left, event.clientY - box.top);
    this.scene.highlight(found?.kind ?? null, found?.id);
    this.seek(this.time);
  }

  _turnTheme() {
    this._theme = this._theme === "dark" ? "light" : "dark";
    document.documentElement.dataset.theme = this._theme;
    this.scene.setTheme(this._theme);
    this.seek(this.time);
  }

  _tell() {
    this._scrubber.value = this.time;
    this._clock.textContent = `${this.time.toFixed(1)} of ${this.end.toFixed(1)} s`;
    const { people, robots } = this.scene.info();
    const count = (n, one, many) => `${n} ${n === 1 ? one : many}`;
    const text = `${count(people, "person", "people")}, ${count(robots, "robot", "robots")}`;
    if (this._summary.textContent !== text) this._summary.textContent = text;
  }

  _key(event) {
    if (event.target.closest?.("input, select, summary, button") && event.key === " ") return;
    if (event.target.closest?.("input, select") || event.shiftKey) return;
    const action = {
      " ": () => this.play(),
      ArrowRight: () => this.seek(this.time + 1),
      ArrowLeft: () => this.seek(this.time - 1),
      Home: () => this.seek(this.frames[0].time),
      End: () => this.seek(this.end),
      j: () => this._jump(-1),
      k: () => this._jump(1),
    }[event.key];
    if (!action) return;
    event.preventDefault();
    action();
  }
}
