// Editor tab: tools, view from above, outline, form of the chosen element, XML, problems, files.
import { openDialog } from "../ui/dialog.mjs";
import { say } from "../ui/messages.mjs";
import { fill, h } from "../ui/dom.mjs";
import { makePane } from "../ui/layout.mjs";
import { Inspector } from "./inspector.mjs";
import { EditorModel } from "./model.mjs";
import { Outline } from "./outline.mjs";
import { openSources, saveAs } from "./sources.mjs";
import { TOOLS, help } from "./tools.mjs";
import { EditorView } from "./view.mjs";
import { XmlPane } from "./xml_pane.mjs";

const GRID = [["0.1", "0.1 m"], ["0.25", "0.25 m"], ["0.5", "0.5 m"], ["1", "1 m"], ["0", "off"]];

class EditorTab {
  constructor(root, app) {
    this.app = app;
    this.model = new EditorModel(app.connection);
    this.layout(root);
    this.model.on("state", () => this.update());
    this.model.on("chosen", () => this.updateChosen());
    this.model.on("people", () => this.view.draw());
    this.model.on("conflict", () => this.askConflict());
    this.addKeys();
  }

  layout(root) {
    const canvas = h("canvas", { tabindex: "0", "aria-label": "Trial from above; the list of elements has the same content" });
    this.words = h("span", { class: "words" });
    this.summary = h("p", { class: "note", "aria-live": "polite" });
    this.view = new EditorView(canvas, this.model, (text) => (this.words.textContent = text));
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener("pointerup", () => this.view.tool && this.tellTool());
    const panes = { outline: h("div", { class: "outline" }), inspector: h("div", { class: "inspector" }), xml: h("div", { class: "xml" }) };
    this.outline = new Outline(panes.outline, this.model);
    this.inspector = new Inspector(panes.inspector, this.model);
    this.xml = new XmlPane(panes.xml, this.model);
    this.problems = h("ul", { class: "problems", "aria-label": "Problems" });
    const xml = h("div", { class: "text" }, h("h2", {}, "XML"), panes.xml);
    root.classList.add("editor");
    fill(
      root,
      h("div", { class: "bar" }, this.fileButtons(), this.grid(), this.tools()),
      h("div", { class: "panes" },
        makePane("editor", "Elements", h("div", { class: "left" }, h("h2", {}, "Elements"), panes.outline, this.summary), "left"),
        h("div", { class: "panes rows" },
          h("div", { class: "view" }, canvas, this.words),
          makePane("editor", "Problems and XML", h("div", { class: "below" }, this.problems, xml), "below")),
        makePane("editor", "Chosen element", h("div", { class: "right" }, h("h2", {}, "Chosen element"), panes.inspector), "right")),
    );
  }

  fileButtons() {
    const button = (text, action, more = {}) => h("button", { type: "button", onclick: action, ...more }, text);
    this.undo = button("Undo", () => this.model.step("undo"));
    this.redo = button("Redo", () => this.model.step("redo"));
    this.places = button("Places", () => this.togglePlaces(), { title: "Show where people start and walk", "aria-pressed": "false" });
    this.run = button("Run", () => this.runTrial(), { class: "main" });
    return h(
      "span",
      { class: "row" },
      button("Open", () => openSources(this.model, this.app, () => (this.view.fitted = false))),
      button("Save", () => saveAs(this.model)),
      this.undo,
      this.redo,
      this.places,
      button("Whole view", () => this.view.fit()),
      this.run,
    );
  }

  togglePlaces() {
    const places = !this.model.places;
    this.places.setAttribute("aria-pressed", String(places));
    return this.model.showPlaces(places);
  }

  tools() {
    this.toolButtons = new Map();
    const add = (name, title, key, tool) => {
      const one = h("button", { type: "button", title: `${title} (${key})`, "aria-pressed": String(!tool), onclick: () => this.use(tool) }, title);
      this.toolButtons.set(name, one);
      return one;
    };
    const rare = TOOLS.filter((one) => one.more);
    const choose = (event) => this.use(rare.find((one) => one.name === event.target.value) ?? null);
    this.more = h("select", { "aria-label": "More tools", onchange: choose }, h("option", { value: "" }, "More…"), rare.map((one) => h("option", { value: one.name }, `${one.title} (${one.key})`)));
    const buttons = TOOLS.filter((one) => !one.more).map((one) => add(one.name, one.title, one.key, one));
    return h("span", { class: "row", role: "toolbar", "aria-label": "Tools" }, add("select", "Select", "Esc", null), buttons, this.more);
  }

  grid() {
    const select = h("select", { onchange: () => (this.view.snap = Number(select.value)) }, GRID.map(([value, text]) => h("option", { value }, text)));
    return h("label", { class: "row" }, "Grid", select);
  }

  use(tool) {
    this.view.use(tool);
    for (const [name, one] of this.toolButtons) one.setAttribute("aria-pressed", String(name === (tool?.name ?? "select")));
    this.more.value = tool?.more ? tool.name : "";
    this.tellTool();
  }

  tellTool() {
    if (!this.view.tool) this.words.textContent = "";
    else this.words.textContent = help(this.view.tool, this.view.points.length);
  }

  addKeys() {
    const { keys } = this.app;
    keys.add("editor", [
      ["Escape", "Select; cancel a drawing", () => (this.view.points.length ? this.view.cancel() : this.use(null))],
      ["Enter", "End a line", () => this.view.end()],
      ["Delete", "Remove the chosen elements", () => this.model.chosen.length && this.model.edit("remove", { paths: this.model.chosen })],
      ["u", "Undo", () => this.model.step("undo")],
      ["U", "Redo", () => this.model.step("redo")],
      ["f", "Whole view", () => this.view.fit()],
      ...TOOLS.map((one) => [one.key, `Draw: ${one.title}`, () => this.use(one)]),
    ]);
  }

  update() {
    const { state } = this.model;
    this.undo.disabled = !state.undo;
    this.redo.disabled = !state.redo;
    this.run.disabled = state.problems.length > 0;
    this.outline.update();
    this.inspector.update();
    this.xml.update();
    this.view.update();
    this.updateProblems(state);
    this.summarize(state);
  }

  updateChosen() {
    const [path] = this.model.chosen;
    this.app.remember({ element: path?.length ? path.join(".") : null });
    this.outline.update();
    this.inspector.update();
    this.view.draw();
  }

  updateProblems(state) {
    const go = (one) => {
      if (one.path) this.model.choose([one.path]);
      if (one.line) this.xml.show(one.line);
    };
    const row = (one) => h("li", {}, h("button", { type: "button", class: "link", onclick: () => go(one) }, one.message));
    const good = state.problems.length ? [] : [h("li", { class: "good" }, "No errors")];
    fill(this.problems, state.problems.map(row), good, state.remarks.map((text) => h("li", { class: "note" }, text)));
  }

  summarize({ tree, file, problems }) {
    const count = (tag) => tree?.children.filter((one) => one.tag === tag).length ?? 0;
    const people = tree?.children.filter((one) => one.tag === "spawner").reduce((sum, one) => sum + (Number(one.attributes.count) || 0), count("agent")) ?? 0;
    const some = (n, word, more) => `${n} ${n === 1 ? word : more}`;
    const who = `${some(people, "person", "people")}, ${some(count("robot"), "robot", "robots")}`;
    this.summary.textContent = `${file || "not saved"}: ${who}, ${some(problems.length, "problem", "problems")}`;
  }

  async runTrial() {
    const name = this.model.state.file || "new-trial.xml";
    const saved = await this.model.call("save", { file: name });
    if (!saved) return;
    this.model.take(saved);
    await this.app.openInSimulator({ file: saved.file });
  }

  askConflict() {
    openDialog("The trial was changed in another window", h("p", {}, "Your text is still in the XML pane. Which one stays?"), [
      ["The other one", () => void this.xml.resolve(false)],
      ["My text", () => void this.xml.resolve(true)],
    ]);
  }

  /** Chooses the element that the address names. */
  chooseLinked() {
    const text = this.app.address.get("element") ?? "";
    const path = text.split(".").map(Number);
    if (/^\d+(\.\d+)*$/.test(text) && !this.model.chosen.length && this.model.node(path)) this.model.choose([path]);
  }

  async greet(state) {
    if (!this.model.table) this.model.table = await this.model.call("table");
    this.model.state = null; // a server that was started anew counts from 0
    if ("revision" in state) {
      this.model.take(state);
      this.chooseLinked();
    } else say("the editor has no state", "error");
  }
}

export const editor = {
  name: "editor",
  title: "Editor",
  mount(root, app) {
    const tab = new EditorTab(root, app);
    return { tab, greet: (state) => tab.greet(state), show: () => tab.view.resize() };
  },
};
