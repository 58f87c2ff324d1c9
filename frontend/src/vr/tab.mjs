// The tab of the operator: who is in virtual reality, latency, rooms, and what makes it safe.
import { attempt, say } from "../ui/messages.mjs";
import { fill, h } from "../ui/dom.mjs";
import { makeForm } from "../ui/form.mjs";
import { capturesPanel } from "./captures_panel.mjs";
import { roomPanel } from "./room_panel.mjs";

const SETTINGS = [
  { name: "motion_delay", label: "Added delay of motion", unit: "ms", factor: 1000 },
  { name: "picture_delay", label: "Added delay of the picture", unit: "ms", factor: 1000 },
  { name: "noise", label: "Added noise of positions", unit: "mm", factor: 1000 },
  { name: "buffer", label: "Age of poses that are used", unit: "ms", factor: 1000 },
  { name: "timeout", label: "Tracking is lost after", unit: "s", factor: 1 },
];
const COLUMNS = ["Participant", "Motion to simulation", "State to picture", "Round trip", "Clock offset", "Lost", "Dropped", "Limits", "Tracking", ""];

const milliseconds = (median, p95) => (median === null ? "–" : `${median.toFixed(1)} ms (p95 ${p95.toFixed(1)})`);

export const vr = {
  name: "vr",
  title: "VR",
  mount: (root, app) => new VrTab(root, app),
};

class VrTab {
  constructor(root, app) {
    this.app = app;
    this.state = null;
    this.root = root;
    root.classList.add("vr-tab");
    this._layout();
    app.connection.on("vr.state", (state) => this._take(state));
    app.connection.on("vr.problem", (text) => say(text, "error"));
    app.connection.on("vr.measured", (found) => this._tellMeasure(found));
  }

  greet(state) {
    this.known = Boolean(state?.settings);
    this.main.hidden = !this.known;
    this.none.hidden = this.known;
    if (this.known) this._take(state);
  }

  show() {
    if (this.known) this._call("state").then((state) => state && this._take(state));
  }

  _call(command, args = {}) {
    return attempt(() => this.app.connection.call(`vr.${command}`, args));
  }

  _layout() {
    const button = (text, command, kind = "") => h("button", { type: "button", class: kind, onclick: () => this._call(command) }, text);
    const toggle = (name, text) => {
      const input = h("input", { type: "checkbox", onchange: () => this._call("show", { [name]: input.checked }) });
      return [name, h("label", { class: "vr-switch" }, input, text), input];
    };
    this.switches = [toggle("mirror", "Virtual mirror"), toggle("own_body", "Participants see their own body")];
    this.rows = h("tbody");
    this.warnings = h("p", { class: "vr-warnings", role: "status" });
    this.link = h("a", { target: "_blank", rel: "noopener", class: "vr-enter" }, "Enter VR");
    this.words = h("code", { class: "vr-address" });
    this.picture = h("img", { alt: "QR code of the address for the headset", width: 180, height: 180 });
    this.settings = h("div");
    this.rooms = { person: roomPanel("person", this), robot: roomPanel("robot", this) };
    this.captures = capturesPanel(this);
    this.others = h("div", { class: "vr-others" });
    this.file = h("input", { type: "text", value: "rooms", "aria-label": "Name of the file of rooms" });
    const file = (text, command, told) => h("button", { type: "button", onclick: () => this._call(command, { name: this.file.value }).then((done) => done !== undefined && say(told)) }, text);
    this.files = h("section", { "aria-label": "File of the rooms" }, h("h2", {}, "File of the rooms"), h("p", {}, "Places, calibration points and limits of both rooms."), h("div", { class: "vr-buttons" }, this.file, file("Save rooms", "save_rooms", "The rooms are saved."), file("Load rooms", "load_rooms", "The rooms are loaded.")));
    this.none = h("p", {}, "This server has no virtual reality.");
    this.main = h(
      "div",
      { class: "vr-columns" },
      h(
        "section",
        { "aria-label": "Participants", class: "vr-wide vr-top" },
        h("h2", {}, "Participants"),
        this.warnings,
        h("div", { class: "vr-buttons" }, button("Pause for everybody", "pause"), button("Continue", "resume"), button("Stop robots", "stop_robots", "vr-stop"), button("Release robots", "release_robots"), h("button", { type: "button", onclick: () => this._save() }, "Save recording")),
        h("div", { class: "vr-buttons" }, this.switches.map(([, element]) => element)),
        h("div", { class: "vr-scroll", tabindex: "0", role: "region", "aria-label": "Latency of participants" }, h("table", {}, h("thead", {}, h("tr", {}, COLUMNS.map((one) => h("th", { scope: "col" }, one || h("span", { class: "vr-quiet" }, "Actions"))))), this.rows)),
      ),
      h("section", { "aria-label": "Headset" }, h("h2", {}, "Headset"), h("p", {}, this.link), h("p", {}, "Open this address in the browser of the headset:"), this.words, h("p", {}, this.picture)),
      h("section", { "aria-label": "Delay and noise" }, h("h2", {}, "Delay and noise"), this.settings),
      this.rooms.person.element,
      this.rooms.robot.element,
      this.others,
      this.files,
      this.captures.element,
    );
    fill(this.root, this.none, this.main);
  }

  _take(state) {
    const before = this.state;
    this.state = state;
    if (state.address && before?.address !== state.address) {
      this.link.href = `vr${location.hash}`;
      this.words.textContent = state.address;
      this.picture.src = this.app.connection.address("vr", "link.svg");
    }
    const where = state.experiment ? ["participants are in the session of the tab Experiments"] : [];
    this.warnings.textContent = [...state.warnings, ...where].join("; ");
    for (const [name, , input] of this.switches) input.checked = state[name];
    fill(this.rows, state.participants.length ? state.participants.map((one) => this._row(one)) : h("tr", {}, h("td", { colspan: COLUMNS.length }, "Nobody is in virtual reality.")));
    if (JSON.stringify(before?.settings) !== JSON.stringify(state.settings)) this._showSettings(state.settings);
    this.captures.take(state.captures);
    for (const name of Object.keys(state.rooms)) {
      if (this.rooms[name]) continue;
      this.rooms[name] = roomPanel(name, this);
      this.others.append(this.rooms[name].element);
    }
    for (const [name, panel] of Object.entries(this.rooms)) panel.take(state.rooms[name], state.participants, name === "robot" ? state.robot_margin : null);
  }

  _row(one) {
    const cells = [
      one.avatar, milliseconds(one.motion_median, one.motion_p95), milliseconds(one.picture_median, one.picture_p95),
      one.round_trip === null ? "–" : `${one.round_trip.toFixed(1)} ms`, one.offset === null ? "–" : `${one.offset.toFixed(4)} s`,
      one.lost, one.dropped, one.margin === null || one.margin === undefined ? "–" : `${one.margin.toFixed(2)} m`,
      one.lost_tracking ? "lost" : ["head", ...one.hands, ...(one.suit ? ["suit"] : [])].join(", "),
    ];
    const measure = h("button", { type: "button", "aria-label": `Measure body of ${one.avatar}`, onclick: () => this._measure(one.avatar) }, "Measure body");
    const pose = h("button", { type: "button", "aria-label": `Calibration pose of ${one.avatar}`, onclick: () => this._call("calibrate_pose", { avatar: one.avatar }) }, "Calibration pose");
    return h("tr", {}, cells.map((text, k) => h(k ? "td" : "th", k ? {} : { scope: "row" }, String(text))), h("td", { class: "vr-buttons" }, measure, pose));
  }

  async _save() {
    const stamp = new Date().toISOString().slice(0, 19).replace(/[:T]/g, "-");
    const saved = await this._call("save", { name: `vr-${stamp}` });
    if (saved) say(`Saved: ${saved.join(", ")}`);
  }

  _tellMeasure({ avatar, stature, arm, body, difference, pose }) {
    const fit = `${Math.abs(100 * difference).toFixed(0)} cm ${difference < 0 ? "shorter" : "longer"} in the avatar`;
    say(`${avatar}, ${pose} pose: stature ${stature.toFixed(2)} m, arms ${arm.toFixed(2)} m (${fit}), body ${body}.`);
  }

  async _measure(avatar) {
    const stature = await this._call("measure_body", { avatar });
    if (stature) say(`${avatar} is ${stature.toFixed(2)} m tall; the trial runs from its start.`);
  }

  _showSettings(settings) {
    const rows = [
      ...SETTINGS.map((one) => ({ ...one, kind: "number", value: Math.round(settings[one.name] * one.factor * 1000) / 1000, low: 0 })),
      { name: "pause_when_lost", label: "Pause when tracking is lost", kind: "switch", value: settings.pause_when_lost },
    ];
    const form = makeForm(rows, () => {
      const values = form.values();
      for (const { name, factor } of SETTINGS) values[name] = (values[name] ?? 0) / factor;
      this._call("set", { settings: values });
    });
    fill(this.settings, form.element);
  }
}

