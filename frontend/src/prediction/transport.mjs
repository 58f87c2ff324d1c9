// Plays and steps through the frames.
import { fill, h } from "../ui/dom.mjs";

const SPEEDS = [0.25, 0.5, 1, 2, 4, 8];

export class Transport {
  constructor(store) {
    this.store = store;
    this.playing = false;
    this.speed = h("select", { "aria-label": "Speed" }, SPEEDS.map((one) => h("option", { value: one, selected: one === 1 }, `${one}×`)));
    this.slider = h("input", { type: "range", min: 0, max: 0, value: 0, "aria-label": "Frame", oninput: () => store.go(Number(this.slider.value)) });
    this.button = this._button("Play", () => this.toggle());
    this.jump = h("input", { type: "number", "aria-label": "Jump to frame", step: 1, onchange: () => this.jumpTo(Number(this.jump.value)) });
    this.words = h("span", { class: "position" }, "");
    this.element = h(
      "div",
      { class: "transport", role: "group", "aria-label": "Playback" },
      this._button("First", () => store.go(0)),
      this._button("Back", () => this.step(-1)),
      this.button,
      this._button("Step", () => this.step(1)),
      this._button("Last", () => store.go(Infinity)),
      this.slider,
      this.words,
      h("label", {}, "Jump to", this.jump),
      this.speed,
    );
    store.on("board index frame", () => this._update());
  }

  step(by) {
    this.pause();
    return this.store.go(this.store.index + by);
  }

  /** Goes to the window whose last observed row is nearest to a frame number. */
  jumpTo(frame) {
    const frames = this.store.recording?.frames ?? [];
    let best = 0;
    frames.forEach((one, i) => {
      if (Math.abs(one - frame) < Math.abs(frames[best] - frame)) best = i;
    });
    return this.store.go(best);
  }

  toggle() {
    if (this.playing) this.pause();
    else this.play();
  }

  pause() {
    this.playing = false;
    clearTimeout(this._timer);
    fill(this.button, "Play");
  }

  async play() {
    const { store } = this;
    if (!store.recording) return;
    this.playing = true;
    fill(this.button, "Pause");
    if (store.index >= store.recording.windows - 1) await store.go(0);
    this._next();
  }

  _next() {
    const { frames, fps } = this.store.recording;
    const gap = (frames[this.store.index + 1] - frames[this.store.index]) / fps;
    const wait = (1000 * Math.min(2, gap || 0)) / Number(this.speed.value);
    this._timer = setTimeout(async () => {
      if (!this.playing) return;
      await this.store.go(this.store.index + 1);
      if (this.store.index >= this.store.recording.windows - 1) this.pause();
      else if (this.playing) this._next();
    }, wait);
  }

  _update() {
    const { recording, index } = this.store;
    const off = !recording;
    for (const one of this.element.querySelectorAll("button, input, select")) one.disabled = off;
    if (off) return;
    this.slider.max = recording.windows - 1;
    this.slider.value = index;
    this.slider.setAttribute("aria-valuetext", `frame ${recording.frames[index]}`);
    const seconds = (recording.frames[index] - recording.frames[0]) / recording.fps;
    fill(this.words, `frame ${recording.frames[index]}, ${seconds.toFixed(2)} s, ${index + 1} of ${recording.windows}`);
  }

  _button(text, action) {
    return h("button", { type: "button", onclick: action }, text);
  }
}
