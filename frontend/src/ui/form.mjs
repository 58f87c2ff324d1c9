// Forms made from the tables of the server.
import { field, h } from "./dom.mjs";

/**
 * Makes the fields of a form. Each row of the table is
 * {name, label, kind: "number"|"whole"|"text"|"choice"|"several"|"switch", value, unit?, low?, high?, step?, choices?, note?}.
 * `typed` holds values that are shown in place of those of the table, by name.
 * Returns {element, values(), changed()}: all values, and those that differ from the table.
 */
export function makeForm(rows, onchange = () => {}, typed = {}) {
  const controls = rows.map((row) => [row, control(row.name in typed ? { ...row, value: typed[row.name] } : row)]);
  const given = Object.fromEntries(rows.map((row) => [row.name, JSON.stringify(read(row, control(row)))]));
  for (const [, one] of controls) one.addEventListener("change", onchange);
  const element = h(
    "div",
    { class: "form" },
    controls.map(([row, one]) => field(row.unit ? `${row.label} [${row.unit}]` : row.label, one, row.note)),
  );
  const values = () => Object.fromEntries(controls.map(([row, one]) => [row.name, read(row, one)]));
  const changed = () => Object.fromEntries(Object.entries(values()).filter(([name, value]) => JSON.stringify(value) !== given[name]));
  return { element, values, changed };
}

function control(row) {
  if (row.kind === "choice" || row.kind === "several") {
    const several = row.kind === "several";
    return h(
      "select",
      { name: row.name, multiple: several, size: several ? Math.min(8, Math.max(3, row.choices.length)) : null },
      row.choices.map((one) => {
        const [value, text] = Array.isArray(one) ? one : [one, one];
        return h("option", { value, selected: several ? row.value.includes(value) : value === row.value }, text);
      }),
    );
  }
  if (row.kind === "switch") return h("input", { name: row.name, type: "checkbox", checked: row.value === true });
  if (row.kind === "text") return h("input", { name: row.name, type: "text", value: row.value ?? "" });
  const step = row.step ?? (row.kind === "whole" ? 1 : "any");
  return h("input", { name: row.name, type: "number", value: row.value ?? "", min: row.low, max: row.high, step });
}

function read(row, one) {
  if (row.kind === "switch") return one.checked;
  if (row.kind === "several") return [...one.selectedOptions].map((option) => option.value);
  if (row.kind === "number" || row.kind === "whole") return one.value === "" ? null : Number(one.value);
  return one.value;
}
