// Runs the predictors: button, progress, and a log with one line a frame.
import { say } from "../ui/messages.mjs";
import { fill, h } from "../ui/dom.mjs";
import { makeForm } from "../ui/form.mjs";

const MOST_LINES = 600;
const HEAD = " frame people cost [m]  iter. time [ms] error [m]";

export function makeRunPanel(store) {
  const form = makeForm([
    { name: "seed", label: "Seed", kind: "whole", value: 0, low: 0 },
    { name: "live", label: "Each fit starts from the frame before (live)", kind: "switch", value: false },
  ]);
  const follow = h("input", { type: "checkbox", checked: true });
  const run = h("button", { type: "button", class: "main", disabled: true, onclick: () => start() }, "Run");
  const cancel = h("button", { type: "button", disabled: true, onclick: () => store.call("cancel") }, "Cancel");
  const bar = h("progress", { max: 1, value: 0, "aria-label": "Progress of the run" });
  const status = h("span", { role: "status", class: "hint" }, "");
  const lines = h("pre", {});
  const log = h("div", { class: "log", tabindex: 0, role: "region", "aria-label": "Log, one line a frame" }, h("pre", { class: "head" }, HEAD), lines);
  let texts = [];
  let named = "";
  let told = 0;

  async function start() {
    const { seed, live } = form.values();
    await store.call("run", { seed: seed ?? 0, live });
  }

  function update({ active, share }) {
    run.disabled = active || !store.recording || !store.board.predictors.length;
    cancel.disabled = !active;
    bar.value = share;
  }

  function append(label, rows) {
    if (label !== named && rows.length) texts.push(label);
    named = rows.length ? label : named;
    texts = [...texts, ...rows.map(lineOf)].slice(-MOST_LINES);
    lines.textContent = texts.join("\n");
    log.scrollTop = log.scrollHeight;
  }

  const missing = h("p", { class: "hint" });
  store.on("board", () => {
    update(store.board.run);
    missing.hidden = Boolean(store.recording && store.board.predictors.length);
    missing.textContent = store.recording ? "Add a predictor to run it." : "Open a recording and add a predictor to run it.";
  });
  store.on("log", (found) => {
    texts = [];
    named = "";
    for (const { key, input, lines: rows } of found) append(labelOf(store, key, input), rows);
  });
  store.on("lines", ({ key, input, lines: rows }) => {
    append(labelOf(store, key, input), rows);
    if (follow.checked && rows.length) store.go(store.recording.frames.indexOf(rows.at(-1)[0]));
  });
  store.on("progress", ({ share }) => {
    update({ active: true, share });
    if (Date.now() - told > 1500) {
      told = Date.now();
      fill(status, `${Math.round(100 * share)} % done`);
    }
  });
  store.on("ended", ({ problem, cancelled }) => {
    fill(status, problem || (cancelled ? "cancelled; results so far are kept" : "done"));
    if (problem) say(problem, "error");
  });
  return h(
    "section",
    { "aria-label": "Run" },
    h("h2", {}, "Run"),
    form.element,
    h("div", { class: "buttons" }, run, cancel, h("label", {}, follow, "show the newest frame")),
    missing,
    bar,
    status,
    log,
  );
}

function labelOf(store, key, input) {
  const one = store.board.predictors.find((each) => each.key === key);
  return `${one?.label ?? key}${input === "degraded" ? " (degraded)" : ""}`;
}

/** A line of the log: frame, people, minimum cost, iterations, time, error. */
export function lineOf([frame, people, cost, evaluations, seconds, ade]) {
  const number = (value, digits, width) => (value === null ? "-" : value.toFixed(digits)).padStart(width);
  const whole = (value, width) => String(value).padStart(width);
  return `${whole(frame, 6)} ${whole(people, 6)} ${number(cost, 5, 8)} ${whole(evaluations, 6)} ${number(1e3 * seconds, 2, 9)} ${number(ade, 3, 9)}`;
}
