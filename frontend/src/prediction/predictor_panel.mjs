// The list of predictors with their colours and dashes, and the input they get.
import { openDialog } from "../ui/dialog.mjs";
import { copyText } from "../ui/copy.mjs";
import { fill, h } from "../ui/dom.mjs";
import { openBaseDialog, openDegradeDialog, openSimDialog } from "./predictor_dialogs.mjs";
import { styleOf } from "./style.mjs";

const SVG = "http://www.w3.org/2000/svg";

export function makePredictorPanel(store) {
  const list = h("ul", { class: "predictors", "aria-label": "List of predictors" });
  const input = h("div", {});
  const notes = new Map();
  store.on("progress", ({ key, input: name, ...state }) => {
    if (!name || state.state === "done" || !notes.has(key)) return;
    fill(notes.get(key), name === "degraded" ? `degraded: ${stateOf(state)}` : stateOf(state));
  });
  store.on("board", () => {
    fill(list, store.board.predictors.length ? store.board.predictors.map((one) => row(store, one, notes)) : h("li", { class: "hint" }, "none yet"));
    fill(input, inputRow(store));
  });
  return h(
    "section",
    { "aria-label": "Predictors" },
    h("h2", {}, "Predictors"),
    h(
      "div",
      { class: "buttons" },
      h("button", { type: "button", onclick: () => openSimDialog(store) }, "Add sim predictor…"),
      h("button", { type: "button", onclick: () => openBaseDialog(store) }, "Add base predictor…"),
    ),
    list,
    input,
  );
}

/** A short line in the colour and dash of a predictor. */
export function sample(slot, input = "clean") {
  const { name, dash } = styleOf(slot, input);
  const svg = document.createElementNS(SVG, "svg");
  const line = document.createElementNS(SVG, "line");
  for (const [key, value] of Object.entries({ width: 34, height: 10, "aria-hidden": "true" })) svg.setAttribute(key, value);
  for (const [key, value] of Object.entries({ x1: 1, y1: 5, x2: 33, y2: 5, "stroke-width": 2.5, "stroke-dasharray": dash.join(" ") })) line.setAttribute(key, value);
  line.style.stroke = `var(${name})`;
  svg.append(line);
  return svg;
}

function row(store, one, notes) {
  const { clean, degraded } = one.results;
  const words = [clean && stateOf(clean), degraded && `degraded: ${stateOf(degraded)}`].filter(Boolean);
  const shown = h("input", { type: "checkbox", checked: !store.hidden.has(one.key), "aria-label": `Draw ${one.label}` });
  shown.addEventListener("change", () => store.hide(one.key, !shown.checked));
  notes.set(one.key, h("small", {}, words.join("; ") || "not run yet"));
  const remarks = [...new Set([clean?.note, degraded?.note].filter(Boolean))];
  return h(
    "li",
    {},
    shown,
    sample(one.slot),
    h("span", { class: "name", title: [one.name, ...words, ...remarks].join("\n") }, one.label, notes.get(one.key)),
    one.calibrated && h("button", { type: "button", "aria-label": `Fit… of ${one.label}`, onclick: () => openParameters(store, one.key) }, "Fit…"),
    h("button", { type: "button", "aria-label": `Remove ${one.label}`, onclick: () => store.call("remove", { key: one.key }) }, "×"),
    remarks.map((text) => h("small", { class: "remark" }, text)),
  );
}

function stateOf({ state, done, windows, problem, score }) {
  const best = score?.samples > 1 ? ` (best of ${score.samples})` : "";
  if (state === "done") return `ADE ${score.ade.toFixed(3)} ${score.units}${best}`;
  if (state === "failed") return problem;
  return state === "waits" ? "waits" : `${state === "runs" ? "running" : state}: ${done} of ${windows} frames`;
}

function inputRow(store) {
  const { degradation } = store.board;
  const degrade = h("button", { type: "button", disabled: !store.recording, onclick: () => openDegradeDialog(store) }, "Degrade input…");
  if (!degradation) return h("div", { class: "buttons" }, degrade);
  const select = h("select", { "aria-label": "Input that is drawn" }, [
    h("option", { value: "clean", selected: store.input === "clean" }, "as recorded"),
    h("option", { value: "degraded", selected: store.input === "degraded" }, "degraded"),
  ]);
  select.addEventListener("change", () => store.setInput(select.value));
  const end = h("button", { type: "button", onclick: () => store.call("degrade", { name: "", values: {} }) }, "As recorded only");
  return h("div", {}, h("div", { class: "buttons" }, degrade, end), h("p", { class: "hint" }, `Input also: ${degradation.text}`), h("label", { class: "field" }, h("span", {}, "Drawn input"), select));
}

/** Parameters calibrated over the whole recording, as `crowdbot calibrate` prints them. */
async function openParameters(store, key) {
  const find = () => store.board.predictors.find((one) => one.key === key);
  const body = h("div", {});
  const show = () => {
    const one = find();
    if (!one) return;
    fill(body, one.fit ? fitTable(one.fit) : h("p", {}, "Each frame has its own fit; click a person to see it. Calibrate fits all frames and shows the spread over people."));
  };
  show();
  const listen = () => show();
  store.addEventListener("board", listen);
  const line = async () => {
    const text = await store.call("calibrate_line", { key });
    if (text !== undefined) await copyText(text);
    return false;
  };
  const start = async () => (await store.call("calibrate", { key }), false);
  const dialog = openDialog(`Parameters of ${find().label}`, body, [["Copy as command line", line], ["Close", () => true], ["Calibrate", start]]);
  dialog.addEventListener("close", () => store.removeEventListener("board", listen));
}

function fitTable(fit) {
  const number = (value) => h("td", { class: "number" }, value.toPrecision(4));
  const head = ["parameter", "median", "sd over people", "unit"].map((one) => h("th", { scope: "col" }, one));
  const rows = fit.parameters.map((one) => h("tr", {}, h("td", {}, one.name), number(one.median), number(one.sd), h("td", {}, one.unit)));
  const words = `${fit.scheme}: mean cost ${fit.cost.toFixed(4)} m, ${fit.given_cost.toFixed(4)} m before; ${fit.persons} persons in ${fit.windows} windows, ${fit.evaluations} evaluations, ${fit.seconds.toFixed(1)} s`;
  return h("table", { class: "fit" }, h("caption", {}, words), h("thead", {}, h("tr", {}, head)), h("tbody", {}, rows));
}
