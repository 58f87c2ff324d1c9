// Transport: run, pause, step, speed, time, and the status line.
import { attempt } from "../ui/messages.mjs";
import { fill, h } from "../ui/dom.mjs";

const SPEEDS = [0.1, 0.25, 0.5, 1, 2, 5, 10, null];

export const speedText = (speed) => (speed === null ? "no limit" : `${speed}x`);

export class Transport {
  constructor(app, actions) {
    this.app = app;
    this.status = { state: "none" };
    const button = (text, label, action, key) =>
      h("button", { type: "button", title: key ? `${label} (${key})` : label, onclick: action }, text);
    this.run = button("Run", "Run", () => this.toggle(), "Space");
    this.run.classList.add("main");
    this.stepButton = button("Step", "Step", () => this.step(), ".");
    this.again = button("Restart", "Restart", () => actions.restart(false), "r");
    this.seed = button("New seed", "Restart with another seed", () => actions.restart(true), "n");
    this.save = button("Save", "Save the recording", actions.save);
    this.speed = h("select", { "aria-label": "Speed relative to real time", onchange: () => this._chooseSpeed() },
      SPEEDS.map((one) => h("option", { value: String(one) }, speedText(one))));
    this.scrubber = h("input", { type: "range", "aria-label": "Time [s]", min: 0, max: 1, step: "any", hidden: true, oninput: () => this._seek() });
    this.progress = h("progress", { "aria-label": "Simulated time", max: 1, value: 0 });
    this.ticks = h("div", { class: "event-ticks", "aria-hidden": "true" });
    this.clock = h("output", { class: "clock", "aria-label": "Time" }, "0.0 s");
    this.line = h("p", { class: "status-line" });
    const track = h("div", { class: "track" }, this.ticks, this.scrubber, this.progress);
    this.element = h("div", { class: "transport", role: "group", "aria-label": "Run" },
      this.run, this.stepButton, track, this.clock, this.speed, this.again, this.seed, this.save);
    this._target = null;
    this._seeking = false;
    this._speeds = 0; // changes of the speed that the server has not confirmed
  }

  toggle() {
    return this._call(this.status.state === "running" || this.status.state === "preparing" ? "pause" : "play");
  }

  step(count = 1) {
    return this._call("step", { count });
  }

  /** Changes the speed to the next one of the list. */
  change(by) {
    const at = SPEEDS.findIndex((one) => one === this.status.speed);
    const next = SPEEDS[Math.min(SPEEDS.length - 1, Math.max(0, (at < 0 ? 3 : at) + by))];
    return this._setSpeed(next);
  }

  /** Jumps by a time [s] in an episode. */
  jump(by) {
    this.seek((this._target ?? this.status.time) + by);
  }

  /** Jumps to a time [s]; only the newest wish is sent while one is on its way. */
  async seek(time) {
    if (this.status.kind !== "episode") return;
    this._target = Math.min(this.status.duration, Math.max(this.status.begin, time));
    if (this._seeking) return;
    this._seeking = true;
    try {
      while (this._target !== null) {
        const wish = this._target;
        await attempt(() => this.app.connection.call("simulator.seek", { time: wish }));
        if (this._target === wish) this._target = null;
      }
    } finally {
      this._seeking = false;
    }
  }

  show(status) {
    this.status = this._speeds ? { ...status, speed: this.status.speed } : status;
    const episode = status.kind === "episode";
    const goes = status.state === "running" || status.state === "preparing";
    this.run.textContent = goes ? "Pause" : "Run";
    const over = ["failed", "none"].includes(status.state) || (status.state === "ended" && !episode);
    this.run.disabled = this.stepButton.disabled = over;
    for (const one of [this.again, this.seed, this.save]) one.hidden = episode;
    this.scrubber.hidden = !episode;
    this.progress.hidden = episode;
    const time = status.time ?? 0;
    if (episode) {
      this.scrubber.min = status.begin;
      this.scrubber.max = status.duration;
      if (this._target === null && document.activeElement !== this.scrubber) this.scrubber.value = time;
      this.scrubber.setAttribute("aria-valuetext", `${time.toFixed(1)} s`);
    } else this.progress.value = status.duration ? Math.min(1, time / status.duration) : 0;
    this.clock.textContent = `${time.toFixed(1)} / ${(status.duration ?? 0).toFixed(0)} s`;
    if (document.activeElement !== this.speed) this.speed.value = String(this.status.speed);
  }

  /** Marks events on the scrubber. */
  mark(events) {
    const { begin = 0, duration = 1 } = this.status;
    fill(this.ticks, events.slice(0, 300).map((one) => {
      const tick = h("i", { class: one.kind.replace(" ", "-") });
      tick.style.left = `${(100 * (one.time - begin)) / Math.max(1e-9, duration - begin)}%`;
      return tick;
    }));
  }

  _chooseSpeed() {
    this._setSpeed(this.speed.value === "null" ? null : Number(this.speed.value));
  }

  /** Shows a speed at once and keeps it until the server has confirmed the newest change. */
  async _setSpeed(speed) {
    this.status.speed = speed;
    this.speed.value = String(speed);
    this._speeds += 1;
    try {
      await this._call("speed", { speed });
    } finally {
      this._speeds -= 1;
    }
  }

  _seek() {
    this.seek(Number(this.scrubber.value));
  }

  _call(name, args = {}) {
    return attempt(() => this.app.connection.call(`simulator.${name}`, args));
  }
}
