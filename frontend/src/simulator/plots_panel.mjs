// PlotsPanel: live plots of values that the user chooses.
import { fill, h } from "../ui/dom.mjs";
import { makePlot } from "../ui/plot.mjs";

const MOST = 3000;
const COLOURS = ["--data-1", "--data-2", "--data-3", "--data-4", "--data-5", "--data-6"];
const DASHES = [[], [8, 4], [2, 3], [8, 3, 2, 3], [12, 4], [4, 4]];
const EVERY = 400;

export class PlotsPanel {
  constructor(app) {
    this.app = app;
    this.kinds = [];
    this.metrics = [];
    this.rows = [];
    this.chosen = new Set((app.address.get("plots") ?? "clearance,speed").split(",").filter(Boolean));
    this.plots = new Map();
    this._drawn = 0;
    this.choice = h("fieldset", { class: "choice" }, h("legend", {}, "Plots"));
    this.metric = h("select", { "aria-label": "Add a metric of the run", onchange: () => this._add() });
    this.area = h("div");
    this.element = h("details", { open: true }, h("summary", {}, "Plots"), this.area, this.choice, this.metric);
  }

  /** Sets the known values [{name, title, unit}]. */
  know(kinds) {
    this.kinds = kinds;
    this._listChoice();
  }

  /** Begins anew with rows [[time, values], ...]. */
  begin(rows) {
    this.rows = rows.map(([time, values]) => [time, values]);
    this._draw(true);
  }

  /** Shows series of a whole episode: {time, clearance, ...}. */
  whole(series) {
    const names = Object.keys(series).filter((name) => name !== "time");
    this.rows = series.time.map((time, k) => [time, Object.fromEntries(names.map((name) => [name, series[name][k]]))]);
    this._draw(true);
  }

  /** Adds the values of a status, or marks its time in an episode. */
  take(status) {
    const names = Object.keys(status.metrics ?? {}).sort();
    if (names.join() !== this.metrics.join()) {
      this.metrics = names;
      fill(this.metric, h("option", { value: "" }, "Add a metric of the run…"), names.map((one) => h("option", {}, one)));
    }
    if (status.kind === "episode") {
      for (const plot of this.plots.values()) plot.mark(status.time);
      return;
    }
    if (status.state === "preparing" || !Object.keys(status.values ?? {}).length) return;
    const last = this.rows.at(-1);
    if (last && last[0] >= status.time) return;
    const metrics = Object.fromEntries(Object.entries(status.metrics).filter(([name]) => this.chosen.has(name)));
    this.rows.push([status.time, { ...metrics, ...status.values }]);
    if (this.rows.length > MOST) this.rows = this.rows.filter((_, k) => k % 2 || k > MOST / 2);
    this._draw(false);
  }

  _listChoice() {
    const boxes = this.kinds.map(({ name, title }) => {
      const box = h("input", { type: "checkbox", checked: this.chosen.has(name), onchange: () => this._toggle(name, box.checked) });
      return h("label", {}, box, title);
    });
    fill(this.choice, h("legend", {}, "Show"), boxes);
  }

  _add() {
    if (this.metric.value) this._toggle(this.metric.value, !this.chosen.has(this.metric.value));
    this.metric.value = "";
  }

  _toggle(name, on) {
    if (on) this.chosen.add(name);
    else this.chosen.delete(name);
    this.app.remember({ plots: [...this.chosen].join(",") });
    this._draw(true);
  }

  _draw(now) {
    if (!this.element.open || !this.element.isConnected) return;
    if (!now && performance.now() - this._drawn < EVERY) return;
    this._drawn = performance.now();
    for (const [name, plot] of this.plots) {
      if (this.chosen.has(name)) continue;
      plot.destroy();
      this.plots.delete(name);
    }
    for (const name of this.chosen) {
      if (!this.plots.has(name)) this.plots.set(name, this._make(name));
      this.plots.get(name).set([this.rows.map(([time]) => time), this.rows.map(([, values]) => values[name] ?? null)]);
    }
  }

  _make(name) {
    const at = this.kinds.findIndex((one) => one.name === name);
    const { title, unit } = this.kinds[at] ?? { title: name.replaceAll("_", " "), unit: "" };
    const look = at < 0 ? 5 : at % COLOURS.length;
    const series = [{ label: title, unit, colour: COLOURS[look], dash: DASHES[look] }];
    return makePlot(this.area, { title, x: { label: "time", unit: "s" }, series, height: 110 });
  }
}
