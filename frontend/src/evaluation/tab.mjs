// Evaluation tab: compare navigators, see the table, watch a run.
import { copyText } from "../ui/copy.mjs";
import { attempt } from "../ui/messages.mjs";
import { field, fill, h } from "../ui/dom.mjs";
import { makePane } from "../ui/layout.mjs";
import { upload } from "../ui/upload.mjs";
import { RobotField, robotFacts } from "./robot_field.mjs";
import { makeStrips } from "./strips.mjs";

const GOOD = new Set(["success", "finished"]);

const INTERVALS = "In brackets: 95 % confidence intervals over the seeds.";
const COMPARISONS = "Runs with the same seed are compared in pairs; p-values are corrected for all comparisons (Holm).";

class EvaluationTab {
  constructor(root, app) {
    Object.assign(this, { app, table: null, chosen: null, onlyFailures: true, statistic: 3 });
    this.side = h("aside", { "aria-label": "Evaluations" });
    this.main = h("div", { class: "results" }, h(
      "div",
      { class: "first-steps" },
      h("h2", {}, "How well does a navigator do among people?"),
      h("p", {}, "Each navigator drives the robot of the chosen trials, with every seed; robots that you name take its place. The table compares success, time, clearance and comfort, with intervals; a click on a run opens it in the simulator, at the failure."),
      h("p", {}, "Choose trials and navigators on the left and press Run."),
    ));
    root.classList.add("evaluation", "panes");
    fill(root, makePane("evaluation", "Evaluations", this.side, "left"), this.main);
    app.connection.on("evaluation.state", (state) => this.update(state));
    app.connection.on("jobs.progress", (job) => job.kind === "evaluate" && job.title === this.state?.running && this.progress(job.share));
    this.form();
  }

  call(command, args = {}) {
    return attempt(() => this.app.connection.call(`evaluation.${command}`, args));
  }

  form() {
    this.trials = h("select", { multiple: true, size: 8, onchange: () => this.robots.check() });
    this.robots = new RobotField((robots) => this.app.connection.call("evaluation.robots", { trials: this.chosenTrials(), robots }));
    this.navigators = h("input", { type: "text", value: "straight, orca" });
    this.known = h("small", {});
    this.seeds = h("input", { type: "text", value: "0:20" });
    this.safety = h("input", { type: "checkbox" });
    this.label = h("input", { type: "text", value: "first" });
    this.runButton = h("button", { type: "submit", class: "main" }, "Run");
    this.cancel = h("button", { type: "button", hidden: true, onclick: () => this.call("cancel") }, "Cancel");
    this.bar = h("progress", { max: 1, value: 0, hidden: true, "aria-label": "Progress of the evaluation" });
    this.note = h("p", { class: "note", "aria-live": "polite" });
    this.list = h("ul", { class: "sources" });
    this.file = h("input", { type: "file", accept: ".json", onchange: () => this.add(this.file.files[0]) });
    const start = (event) => {
      event.preventDefault();
      this.start();
    };
    fill(
      this.side,
      h("h2", {}, "New evaluation"),
      h(
        "form",
        { onsubmit: start },
        field("Trials (several with Ctrl or Shift)", this.trials),
        field("Navigators", this.navigators),
        h("details", { class: "facts" }, h("summary", {}, "Parameters and built-in navigators"), this.known),
        this.robots.element,
        field("Seeds", this.seeds),
        h("p", { class: "note" }, "0:20 are the 20 seeds from 0 to 19."),
        h("label", { class: "option" }, this.safety, "Each also with a safety layer"),
        field("Name", this.label),
        h("div", { class: "row" }, this.runButton, this.cancel),
      ),
      this.bar,
      this.note,
      h("h2", {}, "Evaluations"),
      this.list,
      field("Open the result.json of crowdbot evaluate", this.file),
    );
  }

  /** Opens a result of the command line. */
  async add(file) {
    const name = file && (await attempt(async () => this.app.connection.call("evaluation.add", { file: await upload(this.app, file) })));
    this.file.value = "";
    if (name) await this.open(name);
  }

  /** Opens the result that the server was started with. */
  async openFirst(file) {
    const name = await this.call("add", { file });
    if (name) await this.open(name, true);
  }

  async greet(state) {
    this.update(state);
    const sources = await this.call("sources");
    if (!sources) return;
    const chosen = new Set([...this.trials.selectedOptions].map((one) => one.value));
    const names = [...sources.files, ...sources.trials.map((one) => one.name)];
    const shown = this.app.address.get("evaluation");
    if (!this.table && shown && state.evaluations.some((one) => one.name === shown && one.done)) await this.open(shown, true);
    else if (!this.table && !shown && state.first) await this.openFirst(state.first);
    fill(this.trials, names.map((one) => h("option", { selected: chosen.size ? chosen.has(one) : one === "frontal" }, one)));
    const [first] = this.trials.selectedOptions;
    if (first) this.trials.scrollTop = first.offsetTop - this.trials.firstElementChild.offsetTop;
    this.robots.offer(sources.robots);
    this.known.textContent = `With parameters, such as "orca safety=0.2". Built-in: ${sources.navigators.join(", ")}`;
  }

  chosenTrials() {
    return [...this.trials.selectedOptions].map((one) => one.value);
  }

  async start() {
    if (!(await this.robots.check())) return this.robots.input.focus();
    const args = {
      name: this.label.value,
      trials: this.chosenTrials(),
      navigators: this.navigators.value,
      robots: this.robots.value,
      seeds: this.seeds.value,
      safety: this.safety.checked,
    };
    const state = await this.call("run", args);
    if (state) this.update(state);
  }

  update(state) {
    const before = this.state;
    this.state = state;
    const running = Boolean(state.running);
    this.runButton.disabled = running;
    this.cancel.hidden = !running;
    this.bar.hidden = !running;
    this.bar.value = state.share;
    this.note.textContent = running ? `${state.running} is running` : state.problem;
    const row = ({ name, done }) =>
      h("li", {}, h("button", { type: "button", class: "link", disabled: !done, onclick: () => this.open(name) }, name), done ? null : h("small", {}, "not complete; run it again with the same name to continue"));
    fill(this.list, state.evaluations.map(row));
    if (before?.running && !running && !state.problem) this.open(before.running);
  }

  progress(share) {
    this.bar.value = share;
  }

  /** Shows an evaluation; `linked`: with the row that the address names. */
  async open(name, linked = false) {
    const table = await this.call("table", { name });
    if (!table) return;
    this.table = table;
    const row = Number.parseInt(linked ? this.app.address.get("row") : "", 10);
    this.chosen = table.cells[row] ? row : null;
    this.statistic = this.mostKnown();
    this.app.remember({ evaluation: name, row: this.chosen });
    this.show();
  }

  /** The statistic that is not a rate and that most runs have. */
  mostKnown() {
    const { statistics, cells } = this.table;
    const count = (i) => cells.flatMap((cell) => cell.runs).filter((run) => run.values[i] !== null).length;
    const known = statistics.map((name, i) => (name.endsWith("-rate") ? 0 : count(i)));
    return known.indexOf(Math.max(...known));
  }

  show() {
    const { table } = this;
    const choice = h(
      "select",
      { onchange: () => ((this.statistic = Number(choice.value)), this.show()) },
      table.titles.map((one, i) => h("option", { value: i, selected: i === this.statistic }, one)),
    );
    const report = this.app.connection.address("evaluation", `${table.name}/report.html`);
    fill(
      this.main,
      h("h2", {}, table.name),
      h("p", { class: "note" }, h("code", {}, table.command)),
      h(
        "div",
        { class: "row" },
        h("button", { type: "button", onclick: () => copyText(table.command, "Copy as command line") }, "Copy as command line"),
        table.python ? h("button", { type: "button", onclick: () => copyText(table.python, "Copy as Python") }, "Copy as Python") : null,
      ),
      robotFacts(table.robots, table.remarks, true),
      this.rows(),
      h("ul", { class: "comparisons" }, table.comparisons.map((one) => h("li", {}, one))),
      h("p", { class: "note" }, table.comparisons.length ? `${INTERVALS} ${COMPARISONS}` : INTERVALS),
      h("div", { class: "row" }, field("Picture of each run by", choice), table.report ? h("a", { href: report, target: "_blank", rel: "noopener" }, "Report") : null),
      makeStrips(table.cells, this.statistic, table.titles[this.statistic], (cell, seed) => this.watch(cell, seed)),
      h("p", { class: "note" }, "Circle: success. Cross: collision, fall or error. Square: timeout or planned end. Choose a mark to watch the run."),
      this.runs(),
    );
  }

  rows() {
    const { cells, statistics, titles } = this.table;
    const head = ["Trial", "Navigator", "Robot", "Visible", "Senses", ...titles, "Runs"];
    const row = (cell) =>
      h(
        "tr",
        { "aria-selected": String(cell.number === this.chosen) },
        [cell.trial, cell.navigator, cell.robot, cell.visible ? "yes" : "no", cell.senses.join(", ") || "true people"].map((one) => h("td", {}, one)),
        cell.estimates.map((one) => h("td", { class: "number" }, estimate(one))),
        h("td", {}, h("button", { type: "button", onclick: () => this.choose(cell.number) }, `${cell.runs.length} runs`)),
      );
    const numeric = (i) => (i >= 5 && i < 5 + statistics.length ? "number" : null);
    return h("div", { class: "scroll", tabindex: "0", role: "region", "aria-label": "Table" }, h("table", {}, h("thead", {}, h("tr", {}, head.map((one, i) => h("th", { scope: "col", class: numeric(i) }, one)))), h("tbody", {}, cells.map(row))));
  }

  choose(number) {
    this.chosen = number;
    this.app.remember({ row: number });
    this.show();
  }

  runs() {
    if (this.chosen === null) return null;
    const cell = this.table.cells[this.chosen];
    const failures = cell.runs.filter((run) => !GOOD.has(run.outcome));
    const shown = this.onlyFailures && failures.length ? failures : cell.runs;
    const toggle = h("input", { type: "checkbox", checked: this.onlyFailures, onchange: () => ((this.onlyFailures = toggle.checked), this.show()) });
    const head = ["Seed", "Outcome", ...this.table.titles, "Message", ""];
    const row = (run) =>
      h(
        "tr",
        {},
        h("td", { class: "number" }, String(run.seed)),
        h("td", {}, run.outcome),
        run.values.map((one) => h("td", { class: "number" }, one === null ? "-" : one.toPrecision(3))),
        h("td", {}, run.message),
        h("td", {}, h("button", { type: "button", onclick: () => this.watch(cell.number, run.seed) }, `Watch seed ${run.seed}`)),
      );
    return h(
      "div",
      {},
      h("h3", {}, [cell.trial, cell.navigator, cell.named].filter(Boolean).join(", ")),
      h("label", { class: "option" }, toggle, `Only the ${failures.length} failures`),
      h("table", {}, h("thead", {}, h("tr", {}, head.map((one) => h("th", { scope: "col" }, one || "Watch")))), h("tbody", {}, shown.slice(0, 500).map(row))),
    );
  }

  async watch(cell, seed) {
    if (this.watching) return;
    this.watching = true;
    this.note.textContent = `Recording the run with seed ${seed}`;
    const found = await this.call("watch", { name: this.table.name, cell, seed });
    this.watching = false;
    this.note.textContent = this.state.running ? `${this.state.running} is running` : "";
    if (found) await this.app.openInSimulator({ file: found.episode, at: found.at });
  }
}

/** An estimate with its interval below. */
function estimate(text) {
  const [value, ...interval] = text.split(" ");
  return interval.length ? [value, h("small", {}, interval.join(" "))] : [text];
}

export const evaluation = {
  name: "evaluation",
  title: "Evaluation",
  mount(root, app) {
    const tab = new EvaluationTab(root, app);
    return { tab, greet: (state) => tab.greet(state) };
  },
};
