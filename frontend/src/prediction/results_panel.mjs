// The table of metrics with its protocol and the choice of its columns, and the person that was clicked.
import { fill, h } from "../ui/dom.mjs";
import { sample } from "./predictor_panel.mjs";

const HINT = "No results yet: add a predictor and press Run.";

export function makeResultsPanel(store) {
  const place = h("div", { class: "table-place", tabindex: 0, role: "region", "aria-label": "Table of metrics" }, h("p", { class: "hint" }, HINT));
  const choice = h("div", { class: "checks", role: "group", "aria-label": "Columns that are shown" });
  const menu = h("details", { class: "columns", hidden: true }, h("summary", {}, "Columns"), choice);
  let table = { rows: [] };

  function draw() {
    fill(place, table.rows.length ? metricTable(table, columnsOf(table).filter((one) => !store.hiddenColumns.has(one.name))) : h("p", { class: "hint" }, HINT));
  }

  function box({ name, head }) {
    const control = h("input", { type: "checkbox", checked: !store.hiddenColumns.has(name) });
    control.addEventListener("change", () => {
      store.hideColumn(name, !control.checked);
      draw();
    });
    return h("label", {}, control, head);
  }

  store.on("results", (results) => {
    const before = columnsOf(table).map(({ head }) => head).join();
    table = results.table;
    const columns = columnsOf(table);
    menu.hidden = !columns.length;
    if (columns.map(({ head }) => head).join() !== before) fill(choice, columns.map(box)); // a box that is focused stays
    draw();
  });
  return h("section", { "aria-label": "Metrics", class: "metrics" }, h("div", { class: "title" }, h("h2", {}, "Metrics"), menu), place);
}

/** The columns of the server, and the difference to the input as recorded; the name is the head without its unit. */
function columnsOf({ heads, rows, unit }) {
  if (!rows.length) return [];
  const columns = heads.map((head, i) => ({ head, words: rows.map((row) => row.cells[i]) }));
  const difference = (value) => (value === null ? "-" : `${value > 0 ? "+" : ""}${value.toFixed(3)}`);
  if (rows.some((row) => row.difference !== null))
    columns.push({ head: `ADE minus as recorded [${unit}]`, words: rows.map((row) => difference(row.difference)) });
  return columns.map((one) => ({ ...one, name: one.head.split(" [")[0] }));
}

function metricTable({ rows, caption }, columns) {
  const head = h("tr", {}, h("th", { scope: "col" }, "predictor"), columns.map((one) => h("th", { scope: "col", class: "number" }, one.head)));
  const body = rows.map((row, i) =>
    h(
      "tr",
      { "data-key": row.key, "data-input": row.input },
      h("th", { scope: "row" }, sample(row.slot, row.input), " ", row.label, row.input === "degraded" ? " (degraded)" : "", row.note && h("small", {}, ` ${row.note}`)),
      columns.map((one) => h("td", { class: "number" }, cell(one.words[i]))),
    ),
  );
  return h("table", {}, h("caption", {}, caption), h("thead", {}, head), h("tbody", {}, body));
}

/** A value and what stands in brackets behind it; a narrow table breaks between them and nowhere else. */
function cell(words) {
  const [value, ...more] = words.split(/ (?=\()/);
  return [h("span", {}, value), ...more.flatMap((one) => [" ", h("span", {}, one)])];
}

export function makePersonPanel(store) {
  const place = h("div", { "aria-live": "polite" });
  let asked = 0;

  async function update() {
    const number = ++asked;
    if (store.person === null || !store.recording) {
      fill(place, h("p", { class: "hint" }, "Click a person in the scene, or press n."));
      return;
    }
    if (!store.frame?.people.some((one) => one.id === store.person)) {
      fill(place, h("p", {}, `Person ${store.person} is not in this frame.`));
      return;
    }
    const found = await store.call("person", { index: store.index, id: store.person });
    if (found && number === asked) fill(place, personFacts(store, found));
  }

  let timer = null;
  store.on("frame person ended", () => {
    timer ??= setTimeout(() => {
      timer = null;
      update();
    }, 60);
  });
  update();
  return h("section", { "aria-label": "Person" }, h("h2", {}, "Person"), place);
}

const word = (value, digits = 3) => (value === null ? "-" : Number(value).toFixed(digits));

function personFacts(store, one) {
  const { units } = store.recording;
  const kind = one.robot ? "Robot" : "Person";
  const scored = one.scored ? "scored" : "not scored, since their future is not known for all rows";
  const words = `${kind} ${one.id} at (${one.place.map((value) => value.toFixed(2)).join(", ")}) ${units}, ${word(one.speed, 2)} ${units}/s, ${one.rows} observed rows, ${scored}`;
  const cells = (row) => [row.ade, row.fde, row.mean_ade].map((value) => h("td", { class: "number" }, word(value)));
  const name = (row) => h("th", { scope: "row" }, sample(row.slot, row.input), " ", row.label, row.input === "degraded" ? " (degraded)" : "");
  const heads = ["predictor", `ADE [${units}]`, `FDE [${units}]`, "mean ADE"].map((text, i) => h("th", { scope: "col", class: i ? "number" : "" }, text));
  const errors = one.results.length && h("table", { class: "person-errors" }, h("caption", {}, "Errors in this frame, and over all frames of this person"), h("thead", {}, h("tr", {}, heads)), h("tbody", {}, one.results.map((row) => h("tr", {}, name(row), cells(row)))));
  const plot = (variable, text) => h("button", { type: "button", onclick: () => store.emit("plot", { variable, person: one.id }) }, text);
  const fits = one.results.filter((row) => row.parameters.length).map((row) => fitTable(row));
  return [
    h("p", {}, words),
    errors || null,
    h("div", { class: "buttons" }, plot("ade", "Plot the error of this person")),
    ...fits,
  ];
}

function fitTable(row) {
  const heads = ["parameter", "fit", "before", "unit"].map((text, i) => h("th", { scope: "col", class: i === 1 || i === 2 ? "number" : "" }, text));
  const rows = row.parameters.map((one) =>
    h("tr", {}, h("th", { scope: "row" }, one.name.replaceAll("_", " ")), h("td", { class: "number" }, word(one.value)), h("td", { class: "number" }, word(one.given)), h("td", {}, one.unit)),
  );
  return h("table", { class: "fit" }, h("caption", {}, `${row.label}: fit of this frame, cost ${word(row.cost, 4)} m`), h("thead", {}, h("tr", {}, heads)), h("tbody", {}, rows));
}
