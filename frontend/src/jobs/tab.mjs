// Jobs tab: long work in worker processes: start it, see how far it is, cancel it, take its results.
import { openDialog } from "../ui/dialog.mjs";
import { attempt } from "../ui/messages.mjs";
import { fill, h } from "../ui/dom.mjs";
import { makeForm } from "../ui/form.mjs";
import { makePane } from "../ui/layout.mjs";
import { copyText } from "../ui/copy.mjs";
import { jobRow, units } from "./job_row.mjs";

class JobsTab {
  constructor(root, app) {
    Object.assign(this, { app, root, kind: null, made: null, typed: {}, rows: new Map(), state: { jobs: [] } });
    this.form = h("div", {});
    this.starters = h("div", { class: "starters" });
    this.list = h("ul", { class: "jobs-list", "aria-label": "List of jobs" });
    this.summary = h("p", { class: "note", "aria-live": "polite" });
    root.classList.add("jobs", "panes");
    fill(
      root,
      makePane("jobs", "New job", h("aside", { "aria-label": "New job" }, h("h2", {}, "New job"), this.starters, this.form), "left"),
      h("div", { class: "results" }, h("h2", {}, "Jobs"), this.summary, this.list),
    );
    app.connection.on("jobs.state", (state) => this.take(state));
    app.connection.on("jobs.progress", (job) => this.progress(job));
  }

  call(command, args = {}) {
    return attempt(() => this.app.connection.call(`jobs.${command}`, args));
  }

  async greet(state) {
    this.take(state);
    await this.refresh();
  }

  /** Fetches the forms anew, since their lists name the files of the session; what was typed stays. */
  async refresh() {
    const forms = await this.call("forms");
    if (!forms) return;
    this.forms = forms;
    fill(
      this.starters,
      forms.map((one) =>
        h("button", { type: "button", "aria-pressed": String(one.kind === this.kind), onclick: () => this.choose(one.kind) }, one.title),
      ),
    );
    this.choose(this.kind ?? this.app.address.get("job") ?? forms[0].kind);
  }

  /** Fetches the forms after a job has ended, since its results are choices of other forms; a form in use stays as it is. */
  async renew() {
    const forms = await this.call("forms");
    if (!forms) return;
    this.forms = forms;
    if (!this.form.contains(document.activeElement)) this.choose(this.kind);
  }

  choose(kind) {
    const form = this.forms.find((one) => one.kind === kind) ?? this.forms[0];
    if (this.made) this.typed[this.kind] = this.made.changed();
    this.kind = form.kind;
    if (this.app.keys.active === "jobs") this.app.remember({ job: form.kind });
    [...this.starters.children].forEach((one, i) => one.setAttribute("aria-pressed", String(this.forms[i] === form)));
    const made = (this.made = makeForm(form.rows, undefined, this.typed[form.kind]));
    const start = async (event) => {
      event.preventDefault();
      await this.call("begin", { kind: form.kind, values: made.values() });
    };
    const copy = async () => {
      const text = await this.call("words", { kind: form.kind, values: made.values() });
      if (text !== undefined) await copyText(text, "Copy as command line");
    };
    fill(
      this.form,
      h("p", { class: "note" }, form.about),
      h(
        "form",
        { onsubmit: start, "aria-label": form.title },
        made.element,
        h("div", { class: "row" }, h("button", { type: "submit", class: "main" }, "Start"), h("button", { type: "button", onclick: copy }, "Copy as command line")),
      ),
    );
  }

  take(state) {
    const ended = (jobs) => jobs.filter((one) => one.state === "done").length;
    const renewed = this.forms && ended(state.jobs) !== ended(this.state.jobs);
    this.state = state;
    if (renewed) this.renew();
    const actions = {
      cancel: (job) => this.call("cancel", { number: job.number }),
      again: (job) => this.call("again", { number: job.number }),
      log: (job) => this.showLog(job),
      results: (job) => this.showResults(job),
      remove: (job) => this.askRemove(job),
    };
    const focused = document.activeElement?.closest?.(".job")?.dataset.number;
    this.rows = new Map(state.jobs.map((job) => [job.number, jobRow(job, actions)]));
    const empty = h("li", { class: "empty" }, "No job yet. Training, generation, searches, evaluations and predictions that run are listed here, also after a reload.");
    fill(this.list, state.jobs.length ? [...this.rows.values()].map((one) => one.element) : empty);
    if (focused) this.rows.get(Number(focused))?.element.querySelector("button")?.focus();
    this.summarize();
  }

  progress(job) {
    this.rows.get(job.number)?.update(job);
    const known = this.state.jobs.find((one) => one.number === job.number);
    if (known) Object.assign(known, job);
  }

  summarize() {
    const { jobs, cpu, cpu_limit: cpuLimit, memory_limit: memoryLimit, disk, disk_limit: diskLimit, at_once: atOnce } = this.state;
    const count = (state) => jobs.filter((one) => one.state === state).length;
    const words = [`${count("running")} running, ${count("waiting")} waiting (at most ${atOnce} at once)`];
    words.push(`processor ${units.seconds(cpu ?? 0)}${cpuLimit ? ` of ${units.seconds(cpuLimit)}` : ""}`);
    if (memoryLimit) words.push(`memory of a job at most ${units.bytes(memoryLimit)}`);
    words.push(`folder ${units.bytes(disk ?? 0)}${diskLimit ? ` of ${units.bytes(diskLimit)}` : ""}`);
    this.summary.textContent = words.join(" · ");
  }

  async showLog(job) {
    const text = await this.call("log", { number: job.number });
    if (text === undefined) return;
    const body = h("pre", { class: "log", tabindex: "0", role: "region", "aria-label": "Log" }, text || "The log is empty.");
    openDialog(`Log of ${job.title}`, body, [["Copy", () => (copyText(text, "Log"), false)], ["Close", () => true]]);
    body.scrollTop = body.scrollHeight;
  }

  async showResults(job) {
    const files = await this.call("files", { number: job.number });
    if (!files) return;
    const address = (path) => this.app.connection.address("jobs", `${job.number}/${path}`);
    const row = (one) => {
      const page = one.name.endsWith(".html");
      const link = h("a", { href: address(`files/${one.name}`), ...(page ? { target: "_blank", rel: "noopener" } : { download: one.name.split("/").at(-1) }) }, one.name);
      return h("tr", {}, h("td", {}, link), h("td", { class: "number" }, units.bytes(one.bytes)));
    };
    openDialog(
      `Results of ${job.title}`,
      h("div", {}, h("p", { class: "note" }, `In the folder ${job.results} of the app. `, h("a", { href: address("all.zip"), download: `${job.title}.zip` }, "All as one file")), h("table", {}, h("thead", {}, h("tr", {}, h("th", { scope: "col" }, "File"), h("th", { scope: "col", class: "number" }, "Size"))), h("tbody", {}, files.map(row)))),
    );
  }

  askRemove(job) {
    const buttons = [["Keep it", () => true]];
    if (job.results) buttons.push(["Remove with results", () => void this.call("remove", { number: job.number, results: true })]);
    buttons.push(["Remove from the list", () => void this.call("remove", { number: job.number })]);
    openDialog(`Remove ${job.title}?`, h("p", {}, job.results ? `Its results are in ${job.results}.` : "It has no results of its own."), buttons);
  }
}

export const jobs = {
  name: "jobs",
  title: "Jobs",
  mount(root, app) {
    const tab = new JobsTab(root, app);
    return { tab, greet: (state) => tab.greet(state), show: () => tab.forms && tab.refresh() };
  },
};
