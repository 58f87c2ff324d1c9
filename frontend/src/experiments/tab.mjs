// Experiments tab: the screens for the participant, and the controls of the operator beside them.
import { openDialog } from "../ui/dialog.mjs";
import { attempt, say } from "../ui/messages.mjs";
import { field, fill, h } from "../ui/dom.mjs";
import { makePane } from "../ui/layout.mjs";
import { pageNodes } from "./page_nodes.mjs";
import { makeQuestions } from "./questions.mjs";
import { Picture } from "../simulator/picture.mjs";

/** Says which streams of the Lab Streaming Layer a session sends and records. */
function streamsNote({ send, record = [] }) {
  const parts = [send ? "events and poses are sent" : "", record.length ? `recorded: ${record.join(", ")}` : ""].filter(Boolean);
  return parts.length ? h("p", { class: "note" }, `Lab Streaming Layer: ${parts.join("; ")}`) : null;
}

const PHASES = {
  ready: "not begun",
  screen: "at a page with text or questions",
  trial: "a trial is about to begin",
  running: "a trial runs",
  pause: "paused",
  done: "complete",
  aborted: "ended early",
};

class ExperimentsTab {
  constructor(root, app) {
    Object.assign(this, { root, app, state: { open: false }, form: null });
    this.participant = app.address.get("role") === "participant";
    this.trial = new Picture(app, { select() {}, place() {} }, "experiments");
    this.screen = h("div", { class: "screen", "aria-live": "polite" });
    this.side = h("aside", { "aria-label": "Operator" });
    this.late = h("p", { class: "late", role: "status" });
    root.classList.add("experiments", "panes");
    if (this.participant) document.body.classList.add("participant");
    fill(root, this.screen, this.participant ? null : makePane("experiments", "Operator", this.side, "right"));
    app.connection.on("experiments.state", (state) => this.update(state));
    app.connection.on("experiments.progress", (share) => this.progress(share));
    app.connection.draw("trial", (frame) => this.trial.take(frame), () => this.trial.visible);
  }

  async call(command, args = {}) {
    const state = await attempt(() => this.app.connection.call(`experiments.${command}`, args));
    if (state && "open" in state) this.update(state);
    return state;
  }

  update(state) {
    const same = JSON.stringify(state) === JSON.stringify(this.state) && this.drawn;
    const goesOn = [state, this.state].every((one) => one.open && one.phase === "running" && one.index === state.index);
    this.state = state;
    if (same) return;
    this.drawn = true;
    this.form = null;
    if (!state.open) this.showStart();
    else if (state.phase === "screen") this.showScreen();
    else if (state.phase === "running") {
      if (!goesOn) this.showTrial();
    }
    else if (state.phase === "pause") this.showPause();
    else this.showEnd();
    if (!this.participant) this.showOperator();
  }

  async showStart() {
    if (this.participant) return fill(this.screen, h("h2", {}, "The experiment has not started yet."));
    const sources = await this.call("sources");
    if (!sources) return;
    const about = h("p", { class: "about" });
    const explain = () => (about.textContent = sources.find((one) => one.name === choice.value)?.about ?? "");
    const choice = h("select", { onchange: () => explain() }, sources.map((one) => h("option", { value: one.name }, one.name)));
    explain();
    const number = h("input", { type: "number", min: 1, value: 1 });
    const rate = h("input", { type: "number", min: 0.1, max: 100, step: "any", value: 1 });
    const resume = h("input", { type: "checkbox" });
    const { send, record } = this.state.streams ?? {};
    const sends = h("input", { type: "checkbox", checked: Boolean(send) });
    const records = h("input", { type: "text", value: (record ?? []).join(", "), placeholder: "pulse, type=EEG" });
    const start = () => {
      const streams = records.value.split(",").map((one) => one.trim()).filter(Boolean);
      return this.call("open", {
        experiment: choice.value, participant: Number(number.value), resume: resume.checked, rate: Number(rate.value),
        send_streams: sends.checked, record_streams: streams,
      });
    };
    fill(
      this.screen,
      h("h2", {}, "Start a session"),
      field("Experiment", choice),
      about,
      field("Participant", number),
      field("Speed of the trials (1: real time)", rate),
      h("label", { class: "option" }, resume, "Continue an interrupted session"),
      h("label", { class: "option" }, sends, "Send events and poses (Lab Streaming Layer)"),
      field("Streams to record (Lab Streaming Layer)", records),
      h("p", {}, h("button", { type: "button", class: "main", onclick: start }, "Start")),
    );
  }

  showScreen() {
    const { html, questions, answers } = this.state;
    this.form = makeQuestions(questions, answers);
    const next = h("button", { type: "submit", class: "main" }, "Continue");
    const form = h("form", { onsubmit: (event) => this.submit(event) }, pageNodes(html), this.form.element, h("p", {}, next));
    fill(this.screen, form);
  }

  async submit(event) {
    event.preventDefault();
    const missing = this.form.missing();
    if (missing.length) return say(`Please answer: ${missing.join("; ")}`, "error");
    const answers = this.form.values();
    if (Object.keys(answers).length && !(await this.call("answer", { answers }))) return undefined;
    return this.call("next");
  }

  showTrial() {
    this.bar = h("progress", { max: 1, value: 0, "aria-label": "Progress of the trial" });
    fill(this.screen, h("h2", {}, "Watch the trial"), h("div", { class: "trial" }, this.trial.element), this.bar);
    this.trial.wake();
  }

  progress(share) {
    if (this.bar) this.bar.value = share;
  }

  showPause() {
    const failed = this.state.waiting === "failed";
    const why = failed ? `The trial has failed: ${this.state.reason}` : "The experiment is paused.";
    fill(this.screen, h("h2", {}, this.participant ? "Please wait." : why));
  }

  showEnd() {
    const text = this.state.phase === "done" ? "The session is complete. Thank you." : `The session has ended${this.state.reason ? `: ${this.state.reason}` : "."}`;
    fill(this.screen, h("h2", {}, text));
  }

  showOperator() {
    const { state } = this;
    if (!state.open) return fill(this.side, h("h2", {}, "Operator"), h("p", { class: "note" }, "Start a session. A second window for the participant can be opened then."));
    const can = (name) => state.possible.includes(name);
    const button = (text, name, args) => (can(name) ? h("button", { type: "button", onclick: () => this.call(name, args) }, text) : null);
    const skip = state.phase === "pause" && can("next") ? h("button", { type: "button", onclick: () => this.call("next") }, "Continue without this trial") : null;
    const over = state.phase === "done" || state.phase === "aborted";
    return fill(
      this.side,
      h("h2", {}, `${state.experiment}, participant ${state.participant}`),
      h("p", {}, `State: ${PHASES[state.phase]}${state.reason ? ` (${state.reason})` : ""}`),
      h("ol", { class: "steps" }, state.steps.map((one, i) => this.step(one, i))),
      this.lateness(),
      h("div", { class: "row" }, button("Pause", "pause"), button("Resume", "resume"), button("Repeat the trial", "repeat"), skip),
      h(
        "div",
        { class: "row" },
        can("abort") ? h("button", { type: "button", onclick: () => this.askAbort() }, "Abort") : null,
        h("button", { type: "button", onclick: () => this.call("leave") }, over ? "New session" : "Leave for now"),
        h("button", { type: "button", onclick: () => this.showAnswers() }, "Answers"),
      ),
      h("p", {}, h("a", { href: this.participantAddress(), target: "_blank", rel: "noopener" }, "Window for the participant")),
      h("p", { class: "note" }, `Files: ${state.folder}`),
      streamsNote(state.streams),
    );
  }

  /** What the operator must know of trials that could not keep up with their speed. */
  lateness() {
    const { late, steps } = this.state;
    const text = Object.entries(late).map(([index, remark]) => `${steps[index].name}: ${remark}.`).join("\n");
    if (this.late.textContent !== text) this.late.textContent = text;
    return this.late;
  }

  step(one, i) {
    const { index, outcomes, phase } = this.state;
    const over = phase === "done" || i < index;
    const words = `${one.name} (${one.role})${outcomes[i] ? `: ${outcomes[i]}` : ""}`;
    return h("li", { "aria-current": i === index && !over ? "step" : null, class: over ? "over" : "" }, words);
  }

  participantAddress() {
    const address = new URLSearchParams(this.app.address);
    address.set("role", "participant");
    address.set("tab", "experiments");
    return `?window=participant#${address}`;
  }

  askAbort() {
    const reason = h("input", { type: "text" });
    openDialog("End the session permanently?", field("Reason", reason), [
      ["Cancel", () => true],
      ["Abort the session", () => void this.call("abort", { reason: reason.value || "operator" })],
    ]);
  }

  async showAnswers() {
    const rows = await this.call("answers");
    if (!rows) return;
    const names = [...new Set(rows.flatMap(Object.keys))];
    const cell = (value) => h("td", {}, value === null || value === undefined ? "" : String(value));
    const table = h(
      "table",
      {},
      h("thead", {}, h("tr", {}, names.map((one) => h("th", { scope: "col" }, one)))),
      h("tbody", {}, rows.map((row) => h("tr", {}, names.map((one) => cell(row[one]))))),
    );
    openDialog("Answers", rows.length ? table : h("p", {}, "No answers yet."));
  }
}

export const experiments = {
  name: "experiments",
  title: "Experiments",
  mount(root, app) {
    const tab = new ExperimentsTab(root, app);
    return {
      tab,
      greet: (state) => tab.update(state),
      show: () => (tab.trial.shown = true),
      hide: () => (tab.trial.shown = false),
    };
  },
};
