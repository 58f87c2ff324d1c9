// Questions of a screen as controls, and their values.
import { h } from "../ui/dom.mjs";

/** Makes the controls of questions: {element, values()}; values leaves out what has no answer. */
export function makeQuestions(questions, answers) {
  const parts = questions.map((one) => [one, KINDS[one.kind](one, answers[one.name])]);
  const element = h("div", { class: "questions" }, parts.map(([, part]) => part.element));
  const values = () =>
    Object.fromEntries(parts.map(([one, part]) => [one.name, part.value()]).filter(([, value]) => value !== null));
  const missing = () => parts.filter(([one, part]) => one.required && part.value() === null).map(([one]) => one.text);
  return { element, values, missing };
}

const star = (one) => (one.required ? "" : " (optional)");

function group(one, inputs, ends = []) {
  return h(
    "fieldset",
    {},
    h("legend", {}, one.text + star(one)),
    ends[0] && h("span", { class: "end" }, ends[0]),
    inputs.map(([input, text]) => h("label", { class: "option" }, input, text)),
    ends[1] && h("span", { class: "end" }, ends[1]),
  );
}

const KINDS = {
  choice(one, answer) {
    const chosen = [answer ?? []].flat();
    const type = one.multiple ? "checkbox" : "radio";
    const inputs = one.options.map(({ value, text }) => [
      h("input", { type, name: one.name, value, checked: chosen.includes(value) }),
      text,
    ]);
    const value = () => {
      const found = inputs.filter(([input]) => input.checked).map(([input]) => input.value);
      return found.length ? (one.multiple ? found : found[0]) : null;
    };
    return { element: group(one, inputs), value };
  },
  scale(one, answer) {
    const inputs = one.steps.map((step) => [
      h("input", { type: "radio", name: one.name, value: step, checked: step === answer }),
      String(step),
    ]);
    const value = () => {
      const found = inputs.find(([input]) => input.checked);
      return found ? Number(found[0].value) : null;
    };
    const element = group(one, inputs, [one.low, one.high]);
    element.classList.add("scale");
    return { element, value };
  },
  number(one, answer) {
    const input = h("input", { type: "number", name: one.name, value: answer ?? "", min: one.min, max: one.max, step: one.step ?? "any" });
    const label = one.text + (one.unit ? ` [${one.unit}]` : "") + star(one);
    return { element: h("label", { class: "field" }, h("span", {}, label), input), value: () => (input.value === "" ? null : Number(input.value)) };
  },
  text(one, answer) {
    const input = h("textarea", { name: one.name, rows: 4, maxlength: one.most }, answer ?? "");
    return { element: h("label", { class: "field" }, h("span", {}, one.text + star(one)), input), value: () => input.value.trim() || null };
  },
};
