// Online plots: error, execution time, and any variable that is added, also of one person; error by horizon.
import { openDialog } from "../ui/dialog.mjs";
import { h } from "../ui/dom.mjs";
import { makeForm } from "../ui/form.mjs";
import { makePlot } from "../ui/plot.mjs";
import { styleOf } from "./style.mjs";

const FIRST = [
  { variable: "ade", person: null },
  { variable: "time", person: null },
];
const PAUSE = 400; // between two updates while a run goes on [ms]

export function makePlots(store) {
  const place = h("div", {});
  const shown = [...FIRST, ...linked(store)].map((one) => ({ ...one }));
  const horizon = { key: "", plot: null };
  let timer = null;

  async function update() {
    timer = null;
    if (!store.recording) return;
    for (const one of [...shown]) await draw(one);
    const found = await store.call("results");
    if (found) {
      drawHorizon(found.horizon);
      store.emit("results", found);
    }
  }

  async function draw(one) {
    const known = await store.call("variables");
    if (!known?.some((row) => row.name === one.variable)) return;
    const found = await store.call("series", { variable: one.variable, person: one.person });
    if (!found || !shown.includes(one)) return;
    const rows = found.rows.filter((row) => row.values.some((value) => value !== null));
    const title = one.person === null ? found.label : `${found.label} of person ${one.person}`;
    redraw(one, title, { label: "Frame" }, rows, found.unit, found.frames);
    one.plot?.mark(found.frames[store.index]);
  }

  function redraw(one, title, x, rows, unit, xs, points = false) {
    const key = JSON.stringify([title, unit, rows.map((row) => [row.slot, row.input, row.label])]);
    if (key !== one.key) {
      one.plot?.destroy();
      one.box?.remove();
      one.key = key;
      one.box = h("div", { class: "plot-box" });
      if (one.variable && !FIRST.some((each) => each.variable === one.variable && one.person === null)) {
        one.box.append(h("button", { type: "button", class: "close", "aria-label": `Remove plot ${title}`, onclick: () => remove(one) }, "×"));
      }
      place.insertBefore(one.box, one === horizon ? null : (horizon.box ?? null));
      const series = rows.map((row) => {
        const { name, dash } = styleOf(row.slot, row.input);
        return { label: row.label + (row.input === "degraded" ? " (degraded)" : ""), unit, colour: name, dash };
      });
      one.plot = makePlot(one.box, { title, x, series, points, legend: false, height: 150, log: one.variable === "time" });
    }
    one.plot.set([xs, ...rows.map((row) => row.values)]);
  }

  function drawHorizon({ seconds, rows, unit }) {
    redraw(horizon, "Error by horizon", { label: "Time ahead", unit: "s" }, rows, unit, seconds, true);
  }

  function remove(one) {
    shown.splice(shown.indexOf(one), 1);
    one.plot?.destroy();
    one.box?.remove();
    remember();
  }

  const remember = () => {
    const own = shown.slice(FIRST.length).map(({ variable, person }) => (person === null ? variable : `${variable}@${person}`));
    store.app.remember({ curves: own.join(",") || null });
  };
  const later = () => {
    timer ??= setTimeout(update, PAUSE);
  };
  store.on("board lines ended", later);
  store.on("index", () => {
    for (const one of shown) one.plot?.mark(store.recording?.frames[store.index] ?? null);
  });
  store.on("plot", (one) => {
    shown.push({ ...one });
    remember();
    later();
  });
  const add = h("button", { type: "button", onclick: () => openVariables(store) }, "Add plot…");
  return h("section", { "aria-label": "Plots" }, h("div", { class: "heading" }, h("h2", {}, "Plots"), add), place);
}

/** The plots that the address names. */
function linked(store) {
  const found = (store.app.address.get("curves") ?? "").split(",").filter(Boolean);
  return found.map((one) => {
    const [variable, person] = one.split("@");
    return { variable, person: /^\d+$/.test(person ?? "") ? Number(person) : null };
  });
}

async function openVariables(store) {
  const known = await store.call("variables");
  if (!known) return;
  const form = makeForm([
    { name: "variable", label: "Variable", kind: "choice", value: "cost", choices: known.map((one) => [one.name, one.unit ? `${one.label} [${one.unit}]` : one.label]) },
    { name: "person", label: "Person", kind: "whole", value: store.person, low: 0, note: "empty: everybody; parameters are then medians over people" },
  ]);
  openDialog("Add plot", form.element, [["Cancel", () => true], ["Add", () => (store.emit("plot", form.values()), true)]]);
}
