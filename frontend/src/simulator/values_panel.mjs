// ValuesPanel: every value of the trial by its path, as for --set; changed while it runs, or at a restart.
import { attempt, say } from "../ui/messages.mjs";
import { fill, h } from "../ui/dom.mjs";

const MOST = 40;

export class ValuesPanel {
  constructor(app) {
    this.app = app;
    this.live = false;
    this.rows = [];
    this.search = h("input", { type: "search", "aria-label": "Search values", placeholder: "robot/drive", oninput: () => this._list() });
    this.list = h("div", { class: "values" });
    this.element = h("details", { ontoggle: () => this.element.open && this.load() }, h("summary", {}, "Values of the trial"), this.search, this.list);
  }

  async load() {
    this.rows = await this.app.connection.call("simulator.values").catch(() => []);
    this._list();
  }

  /** Shows the values below a path. */
  async open(path) {
    this.element.open = true;
    this.search.value = path;
    await this.load();
    this.element.scrollIntoView({ block: "nearest" });
  }

  _list() {
    const words = this.search.value.toLowerCase().split(/\s+/).filter(Boolean);
    const found = this.rows.filter(({ path, note }) => words.every((word) => path.includes(word) || note.toLowerCase().includes(word)));
    fill(this.list, found.slice(0, MOST).map((row) => this._row(row)),
      found.length > MOST ? h("p", { class: "faint" }, `${found.length - MOST} more: type more letters`) : null);
  }

  _row(row) {
    const label = `${row.path}${row.unit ? ` [${row.unit}]` : ""}`;
    const shared = { "aria-label": label, disabled: !this.live, onchange: () => this._change(row, control) };
    const options = row.kind === "switch" ? ["true", "false"] : row.choices;
    const control = options
      ? h("select", shared, options.map((one) => h("option", { selected: one === row.text }, one)))
      : h("input", { ...shared, type: "text", inputmode: row.kind === "text" ? "text" : "decimal", value: row.text, size: 8 });
    return h("div", { class: "value", title: row.note }, h("span", {}, label), control, row.live ? null : h("small", {}, "at a restart"));
  }

  async _change(row, control) {
    const text = control.value;
    const done = await attempt(async () => {
      if (row.live) await this.app.connection.call("simulator.set_value", { path: row.path, text });
      else await this.app.connection.call("simulator.restart", { settings: { [row.path]: text } });
      say(`${row.path} = ${text}`);
      return true;
    });
    if (!done) control.value = row.text;
    else await this.load();
  }
}
