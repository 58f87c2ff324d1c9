// Tools: what the next click on the floor does: add a person or robot, set a goal, move somebody, be a person, measure.
import { openDialog } from "../ui/dialog.mjs";
import { attempt } from "../ui/messages.mjs";
import { fill, h } from "../ui/dom.mjs";
import { makeForm } from "../ui/form.mjs";
import { makeExport } from "./export_menu.mjs";

const HINTS = {
  person: ["Click where the person starts", "Click the goal of the person"],
  robot: ["Click where the robot starts", "Click the goal of the robot"],
  goal: ["Click the goal"],
  move: ["Click the new place"],
  you: ["Click where you start; the run begins anew"],
  measure: ["Click the first point", "Click the second point"],
};

export class Tools {
  /** @param {{inspector, picture, became(name), prepared(action)}} parts prepared: does it as soon as the run takes orders */
  constructor(app, parts) {
    this.app = app;
    this.parts = parts;
    this.names = { navigators: [], robots: [] };
    this.tool = null;
    this.points = [];
    const button = (name, text) => h("button", { type: "button", "aria-pressed": "false", "data-tool": name, onclick: () => this.choose(this.tool === name ? null : name) }, text);
    this.buttons = [button("person", "Add person"), button("robot", "Add robot"), button("you", "Be a person"), button("measure", "Measure")];
    this.robot = h("select", { "aria-label": "Type of a new robot" });
    this.exact = h("button", { type: "button", onclick: () => this._dialog() }, "Add at x, y…");
    this.scene = h("span", { class: "tools", role: "group", "aria-label": "Change the scene" }, this.buttons.slice(0, 3), this.robot, this.exact);
    this.element = h("div", { class: "tools" }, this.scene, this.buttons[3], makeExport(app, parts.picture));
  }

  know(names) {
    this.names = names;
    fill(this.robot, names.robots.map((one) => h("option", {}, one)));
    if (names.robots.includes("turtlebot2")) this.robot.value = "turtlebot2";
  }

  set live(live) {
    this.scene.hidden = !live;
    if (!live) this.choose(null);
  }

  choose(name) {
    this.tool = name;
    this.points = [];
    for (const one of this.buttons) one.setAttribute("aria-pressed", String(one.dataset.tool === name));
    this.parts.picture.measure([]);
    this._hint();
  }

  /** Takes a point of the floor. */
  async place({ x, y }) {
    const point = { x: Number(x.toFixed(2)), y: Number(y.toFixed(2)) };
    const { tool } = this;
    this.points.push(point);
    if (this.points.length < HINTS[tool].length) return this._hint();
    const [start, goal] = this.points;
    this.choose(null);
    if (tool === "measure") return this._measure(start, goal);
    if (tool === "goal") return this.parts.inspector.goal(point);
    if (tool === "move") return this.parts.inspector.move(point);
    if (tool === "you") return this._become(point);
    return this.parts.prepared(() => this._add(tool, start, goal));
  }

  _hint() {
    this.parts.picture.placing = this.tool !== null;
    this.parts.picture.say(this.tool ? `${HINTS[this.tool][this.points.length]} (Escape cancels)` : "", "tool");
  }

  /** Shows the distance between two points until another tool is chosen. */
  _measure(from, to) {
    const [dx, dy] = [to.x - from.x, to.y - from.y];
    this.parts.picture.measure([from, to]);
    this.parts.picture.say(`${Math.hypot(dx, dy).toFixed(2)} m (${dx.toFixed(2)} m in x, ${dy.toFixed(2)} m in y; Escape removes it)`, "tool");
  }

  _add(kind, start, goal) {
    return attempt(async () => {
      if (kind === "person") {
        await this.app.connection.call("simulator.order", { order: { order: "add-person", ...start, goal_x: goal.x, goal_y: goal.y } });
      } else {
        await this.app.connection.call("simulator.add_robot", { type: this.robot.value, ...start, goal_x: goal.x, goal_y: goal.y });
      }
      await this.parts.inspector.refresh();
      return true;
    });
  }

  async _become(point) {
    const name = await attempt(() => this.app.connection.call("simulator.become_person", point));
    if (name) this.parts.became(name);
  }

  _dialog() {
    const number = (name, label, value) => ({ name, label, kind: "number", unit: "m", value });
    const kinds = [["person", "Person"], ["robot", `Robot (${this.robot.value})`], ["you", "Yourself"]];
    const form = makeForm([
      { name: "kind", label: "What", kind: "choice", value: "person", choices: kinds },
      number("x", "x", 0), number("y", "y", 0), number("goal_x", "goal x", 3), number("goal_y", "goal y", 0),
    ]);
    const add = async () => {
      const { kind, x, y, goal_x, goal_y } = form.values();
      if (kind === "you") return this._become({ x, y });
      return (await this._add(kind, { x, y }, { x: goal_x, y: goal_y })) === true;
    };
    openDialog("Add", form.element, [["Cancel", () => true], ["Add", add]]);
  }
}
