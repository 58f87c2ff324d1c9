// The dialogs "Add sim predictor" and "Add base predictor", made from the tables of the server.
import { openDialog } from "../ui/dialog.mjs";
import { fill, h } from "../ui/dom.mjs";
import { makeForm } from "../ui/form.mjs";

const NONE = ["", "none"];

/** Simulation model, cost function, search, goal, budget and parameters. */
export function openSimDialog(store) {
  const { models, costs, searches, goals, crowd } = store.tables;
  const names = (rows) => rows.map((one) => [one.name, one.name]);
  const scheme = makeForm(
    [
      { name: "model", label: "Simulation model", kind: "choice", value: "orca", choices: names(models) },
      { name: "cost", label: "Cost function", kind: "choice", value: "progressive", choices: [NONE, ...names(costs)] },
      { name: "search", label: "Search (calibrator)", kind: "choice", value: "genetic", choices: [NONE, ...names(searches)], note: "without cost and search, the parameters below are used" },
      { name: "goal", label: "Goals of the people", kind: "choice", value: "", choices: [["", "current-direction"], ...names(goals).filter(([name]) => name !== "current-direction")] },
      { name: "budget", label: "Budget: candidate crowds per frame", kind: "whole", value: 500, low: 1, high: 100000 },
      { name: "tolerance", label: "Stop at a cost of", unit: "m", kind: "number", low: 0, note: "empty: never" },
      { name: "patience", label: "Stop after evaluations without improvement", kind: "whole", low: 1, note: "empty: never" },
      { name: "samples", label: "Futures per person", kind: "whole", value: 1, low: 1, high: 100, note: "more than one only for goals with several destinations" },
      { name: "learnt", label: "From the learning part of the recording", kind: "choice", value: "", choices: [["", "nothing"], ["prior", "a prior of the parameters"], ["shared", "one set of parameters for everybody"]] },
    ],
    () => update(),
  );
  const about = h("p", { class: "hint" });
  const place = h("fieldset", {});
  let form = null;
  let free = [];
  let shown = null;

  function update() {
    const { model, cost, search, goal } = scheme.values();
    const row = models.find((one) => one.name === model);
    const words = [row, find(costs, cost), find(searches, search), find(goals, goal || "current-direction")];
    fill(about, words.filter(Boolean).map((one) => h("span", { class: "about" }, `${one.name}: ${one.about}`)));
    if (shown === model) return;
    shown = model;
    const rows = [...row.parameters, ...crowd.filter((one) => !row.parameters.some((own) => own.name === one.name))];
    form = makeForm(rows);
    free = row.free.map((name) => h("input", { type: "checkbox", value: name }));
    fill(
      place,
      h("legend", {}, `Parameters of ${model}`),
      form.element,
      h("p", {}, "Calibrated parameters (none chosen: all)"),
      h("div", { class: "checks" }, free.map((one) => h("label", {}, one, one.value.replaceAll("_", " ")))),
    );
  }

  update();
  const add = async () => {
    const { goal, ...own } = scheme.values();
    const chosen = free.filter((one) => one.checked).map((one) => one.value);
    const settings = { predictor: "simulated", ...own, goal, free: chosen, values: form.values(), samples: own.samples ?? 1 };
    return (await store.call("add", { settings })) !== undefined;
  };
  openDialog("Add sim predictor", [scheme.element, about, place], [["Cancel", () => true], ["OK", add]]);
}

/** A baseline or a learned predictor, its parameters, and the number of futures. */
export async function openBaseDialog(store) {
  const trained = (await store.call("weights")) ?? [];
  const { predictors } = store.tables;
  const groups = [
    ["Baselines", predictors.filter((one) => !one.learned)],
    ["Learned", predictors.filter((one) => one.learned)],
  ];
  const select = h(
    "select",
    { name: "predictor" },
    groups.map(([label, rows]) => h("optgroup", { label }, rows.map((one) => h("option", { value: one.name, selected: one.name === "constant-velocity" }, one.name)))),
  );
  const about = h("p", { class: "hint" });
  const place = h("div", {});
  let form = null;

  function update() {
    const row = find(predictors, select.value);
    const samples = { name: "samples", label: "Futures per person", kind: "whole", value: 20, low: 1, high: 100, note: "drawn as a fan of paths, or as a density" };
    fill(about, row.about);
    const own = trained.map((one) => [one, one.split("/").at(-2)]);
    const weights = { name: "weights", label: "Weights", kind: "choice", value: "", choices: [["", "those that ship"], ...own], note: "Jobs, Train a predictor makes more" };
    form = makeForm([...(row.weights ? [weights] : []), ...(row.samples ? [samples] : []), ...row.parameters]);
    fill(place, form.element);
  }

  select.addEventListener("change", update);
  update();
  const add = async () => {
    const { samples = 1, weights = "", ...values } = form.values();
    const settings = { predictor: select.value, samples: samples ?? 1, values, weights };
    return (await store.call("add", { settings })) !== undefined;
  };
  openDialog("Add base predictor", [h("label", { class: "field" }, h("span", {}, "Predictor"), select), about, place], [["Cancel", () => true], ["OK", add]]);
}

/** A degradation of the observed rows. */
export function openDegradeDialog(store) {
  const { degradations } = store.tables;
  const select = h("select", { name: "degradation" }, degradations.map((one) => h("option", { value: one.name, selected: one.name === "gaussian-noise" }, one.name)));
  const about = h("p", { class: "hint" });
  const place = h("div", {});
  let form = null;

  function update() {
    const row = find(degradations, select.value);
    fill(about, `${row.about} Usual levels of ${row.level.replaceAll("_", " ")}: ${row.levels.join(", ")}.`);
    form = makeForm(row.parameters);
    fill(place, form.element);
  }

  select.addEventListener("change", update);
  update();
  const set = async () => (await store.call("degrade", { name: select.value, values: form.values() })) !== undefined;
  openDialog("Degrade the input", [h("label", { class: "field" }, h("span", {}, "Degradation"), select), about, place], [["Cancel", () => true], ["OK", set]]);
}

const find = (rows, name) => rows.find((one) => one.name === name);
