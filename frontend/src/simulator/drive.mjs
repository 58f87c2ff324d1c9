// Drive: a robot is driven, or a person walked, by keyboard, on-screen joystick or gamepad. Every input is an order.
import { attempt } from "../ui/messages.mjs";
import { h } from "../ui/dom.mjs";

const REPEAT = 100;
const DEAD = 0.12;
const KEYS = {
  ArrowUp: [1, 0, 0], w: [1, 0, 0], ArrowDown: [-1, 0, 0], s: [-1, 0, 0],
  ArrowLeft: [0, 1, 0], a: [0, 1, 0], ArrowRight: [0, -1, 0], d: [0, -1, 0], q: [0, 0, 1], e: [0, 0, -1],
};

/**
 * Forward, turn and sideways of a gamepad. Two sticks (mapping "standard"): the left one walks and steps aside, the
 * right one turns. With one stick, it walks and turns. The cross of buttons does as the arrow keys.
 */
export function gamepadInput(pad) {
  const axis = (k) => {
    const size = Math.abs(pad.axes[k] ?? 0);
    return size > DEAD ? (Math.sign(pad.axes[k]) * Math.min(1, size - DEAD)) / (1 - DEAD) : 0;
  };
  const pressed = (k) => (pad.mapping === "standard" && pad.buttons[k]?.pressed ? 1 : 0);
  const two = pad.mapping === "standard" || pad.axes.length > 2;
  return [
    -axis(1) + pressed(12) - pressed(13),
    -axis(two ? 2 : 0) + pressed(14) - pressed(15),
    two ? -axis(0) : 0,
  ];
}

export class Drive {
  constructor(app, actions) {
    this.app = app;
    this.actions = actions;
    this.subject = null;
    this.limits = { speed: 0.6, turn: 1.2 };
    this._down = new Set();
    this._stick = [0, 0];
    this._sent = "";
    this.knob = h("div", { class: "knob" });
    this.pad = h("div", { class: "joystick", role: "img", "aria-label": "Joystick: drag to drive; the keys W A S D or arrows do the same" }, this.knob);
    this.text = h("p", { role: "status" });
    this.stopButton = h("button", { type: "button", onclick: () => this.stop() }, "Give back");
    this.element = h("div", { class: "drive", hidden: true }, this.text, this.pad, this.stopButton);
    this._listen();
  }

  /** Begins to drive a robot or to walk an avatar. */
  async start(kind, name) {
    await this.stop();
    if (kind === "robot" && (await attempt(() => this.app.connection.call("simulator.take_over", { robot: name }).then(() => true))) !== true) return;
    this.subject = { kind, name };
    this.element.hidden = false;
    this.text.textContent = `You move ${name}: arrows or W A S D${kind === "robot" ? "" : ", Q and E sideways"}, the joystick, or a gamepad. Escape gives back.`;
    this.stopButton.textContent = kind === "robot" ? "Give back" : "Stand still";
    this._sent = "";
    document.activeElement?.blur?.();
    this._timer = setInterval(() => this._send(), REPEAT);
    this.actions.started(this.subject);
  }

  /** Ends driving: the robot gets its navigator back. */
  async stop() {
    const { subject } = this;
    if (!subject) return;
    this.forget();
    if (subject.kind === "robot") await attempt(() => this.app.connection.call("simulator.release", { robot: subject.name }));
    else await attempt(() => this.app.connection.call("simulator.walk", { avatar: subject.name, forward: 0 }));
  }

  /** Forgets the subject, because the run is over. */
  forget() {
    clearInterval(this._timer);
    this.subject = null;
    this._down.clear();
    this.element.hidden = true;
    this.actions.stopped();
  }

  /** Forward, turn and sideways, each from -1 to 1. */
  input() {
    const sum = [0, 0, 0];
    for (const key of this._down) KEYS[key].forEach((one, k) => (sum[k] += one));
    const [x, y] = this._stick;
    sum[0] -= y;
    sum[1] -= x;
    for (const pad of navigator.getGamepads?.() ?? []) if (pad) gamepadInput(pad).forEach((one, k) => (sum[k] += one));
    return sum.map((one) => Math.max(-1, Math.min(1, one)));
  }

  _send() {
    if (!this.subject || !this.app.connection.open) return;
    const { kind, name } = this.subject;
    const [forward, turn, left] = this.input();
    const [address, args] = kind === "robot"
      ? ["drive", { robot: name, forward: this.limits.speed * forward, turn: this.limits.turn * turn, left: this.limits.speed * left }]
      : ["walk", { avatar: name, forward: 1.5 * forward, turn: 2 * turn, left: 1.2 * left }];
    this.app.connection.call(`simulator.${address}`, args).catch(() => this.forget());
  }

  _listen() {
    const busy = (event) => !this.subject || event.target.closest?.("input, textarea, select, dialog");
    document.addEventListener("keydown", (event) => {
      if (event.key === "Escape" && this.subject) this.stop();
      const key = event.key.length === 1 ? event.key.toLowerCase() : event.key;
      if (busy(event) || !(key in KEYS) || event.ctrlKey || event.metaKey || event.altKey || event.shiftKey) return;
      event.preventDefault();
      this._down.add(key);
    }, true);
    document.addEventListener("keyup", (event) => this._down.delete(event.key.length === 1 ? event.key.toLowerCase() : event.key), true);
    addEventListener("blur", () => this._down.clear());
    const move = (event) => {
      const { left, top, width, height } = this.pad.getBoundingClientRect();
      const [x, y] = [(2 * (event.clientX - left)) / width - 1, (2 * (event.clientY - top)) / height - 1];
      const size = Math.max(1, Math.hypot(x, y));
      this._place(x / size, y / size);
    };
    this.pad.addEventListener("pointerdown", (event) => {
      this.pad.setPointerCapture(event.pointerId);
      move(event);
    });
    this.pad.addEventListener("pointermove", (event) => this.pad.hasPointerCapture(event.pointerId) && move(event));
    for (const name of ["pointerup", "pointercancel"]) this.pad.addEventListener(name, () => this._place(0, 0));
  }

  _place(x, y) {
    this._stick = [x, y];
    this.knob.style.transform = `translate(${38 * x}px, ${38 * y}px)`;
  }
}
