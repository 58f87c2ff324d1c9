// Inspector: the state of the chosen person or robot, and what can be done with it.
import { attempt } from "../ui/messages.mjs";
import { fill, h } from "../ui/dom.mjs";

/** Directions of a push: text, and angle in the world [rad]. */
const PUSHES = [["+x", 0], ["−x", Math.PI], ["+y", Math.PI / 2], ["−y", -Math.PI / 2]];

export class Inspector {
  /** @param {{chosen(kind, id), tool(name), drive(name), values(path)}} actions */
  constructor(app, actions) {
    this.app = app;
    this.actions = actions;
    this.chosen = null;
    this.live = false;
    this.navigators = [];
    this.list = h("select", { "aria-label": "Choose a person or robot", onchange: () => this._choose(), onfocus: () => this.refresh() });
    this.table = h("tbody");
    this.buttons = h("div", { class: "buttons" });
    this.x = h("input", { type: "number", step: "any", "aria-label": "x [m]" });
    this.y = h("input", { type: "number", step: "any", "aria-label": "y [m]" });
    this.force = h("input", { type: "number", min: 1, max: 5000, step: "any", value: 200, "aria-label": "Force of a push [N]" });
    this.duration = h("input", { type: "number", min: 0.01, max: 10, step: "any", value: 0.2, "aria-label": "Duration of a push [s]" });
    this.pushes = h("div", { class: "push" }, h("span", {}, "Push [N], [s]"), this.force, this.duration,
      PUSHES.map(([text, direction]) => h("button", { type: "button", "aria-label": `Push ${text}`, onclick: () => this.push(direction) }, text)));
    this.place = h("div", { class: "place" }, h("span", {}, "x, y [m]"), this.x, this.y,
      h("button", { type: "button", onclick: () => this.goal(this._point()) }, "Set goal"),
      h("button", { type: "button", onclick: () => this.move(this._point()) }, "Move there"));
    this.element = h("details", { open: true }, h("summary", {}, "Inspector"), h("div", { class: "chosen" }, this.list), h("table", {}, this.table), this.buttons, this.pushes, this.place);
    this._show(null);
  }

  async refresh() {
    const people = await this.app.connection.call("simulator.people").catch(() => []);
    const text = (one) => (one.name === one.kind ? one.name : `${one.kind} ${one.name || one.id}`);
    fill(this.list, h("option", { value: "" }, "nobody chosen"), people.map((one) => h("option", { value: `${one.kind} ${one.id}` }, text(one))));
    this.list.value = this.chosen ? `${this.chosen.kind} ${this.chosen.id}` : "";
  }

  /** Chooses a person or robot {kind, id}, or nobody. */
  async select(hit) {
    this.chosen = hit;
    this.actions.chosen(hit);
    await this.refresh();
    return this.update();
  }

  /** Asks for the state of the chosen one. */
  async update() {
    if (!this.chosen) this._show(null);
    if (!this.chosen || this._asking) return;
    this._asking = true;
    const { chosen } = this;
    try {
      const state = await this.app.connection.call("simulator.inspect", { id: chosen.id });
      if (this.chosen?.id === chosen.id) this._show(state);
    } catch {
      this._show(null);
    } finally {
      this._asking = false;
    }
  }

  goal(point) {
    if (!this.state || !point) return;
    const { kind, id, name } = this.state;
    this.order(kind === "robot" ? { order: "goal", robot: name, ...point } : { order: "redirect", person: id, ...point });
  }

  move(point) {
    if (this.state && point) this.order({ order: "move", person: this.state.id, ...point });
  }

  /** Pushes the chosen person with the force and duration of the fields. */
  push(direction) {
    if (this.state) this.order({ order: "push", person: this.state.id, force: Number(this.force.value), direction, duration: Number(this.duration.value) });
  }

  remove() {
    if (!this.state) return;
    const { kind, id, name } = this.state;
    this.order(kind === "robot" ? { order: "remove-element", path: `robot[${name}]` } : { order: "remove", person: id });
    this.select(null);
  }

  order(order) {
    return attempt(() => this.app.connection.call("simulator.order", { order })).then(() => this.update());
  }

  _choose() {
    const [kind, id] = this.list.value.split(" ");
    this.select(kind ? { kind, id: Number(id) } : null);
  }

  _point() {
    return this.x.value === "" || this.y.value === "" ? null : { x: Number(this.x.value), y: Number(this.y.value) };
  }

  _show(state) {
    const before = this.state && `${this.state.kind} ${this.state.id}`;
    this.state = state;
    fill(this.table, (state?.rows ?? []).map(([name, value, unit]) =>
      h("tr", {}, h("th", { scope: "row" }, name), h("td", {}, unit ? `${value} ${unit}` : String(value)))));
    this.place.hidden = !state || !this.live;
    this.pushes.hidden = this.place.hidden || state.kind !== "person";
    const now = state && `${state.kind} ${state.id} ${this.live}`;
    if (now === this._made) return;
    this._made = now;
    if (state && before !== `${state.kind} ${state.id}`) [this.x.value, this.y.value] = state.goal.map((one) => one.toFixed(2));
    fill(this.buttons, state && this.live ? this._buttons(state) : []);
  }

  _buttons({ kind, name, values }) {
    const button = (text, action) => h("button", { type: "button", onclick: action }, text);
    const found = [
      button("Goal by click", () => this.actions.tool("goal")),
      button("Move by click", () => this.actions.tool("move")),
      button("Parameters", () => this.actions.values(values)),
      button("Remove", () => this.remove()),
    ];
    if (kind === "person") {
      if (name) found.push(button("Walk as this person", () => this.actions.drive("avatar", name)));
      return found;
    }
    const choice = h("select", { "aria-label": "Navigator", onchange: () => this._navigator(choice.value) }, this.navigators.map((one) => h("option", {}, one)));
    const own = this.state.rows.find(([key]) => key === "navigator");
    choice.value = own ? own[1] : "";
    return [...found, button("Drive", () => this.actions.drive("robot", name)), h("label", { class: "field" }, h("span", {}, "Navigator"), choice)];
  }

  _navigator(type) {
    this.order({ order: "parameter", path: `robot[${this.state.name}]/navigator/type`, value: type });
  }
}
