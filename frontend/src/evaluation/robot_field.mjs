// The field of the robots that an evaluation puts into its trials.
import { field, fill, h } from "../ui/dom.mjs";

/** What robots bring and replace, in the lines of the command line, and remarks on them; an empty list shows nothing. */
export function robotFacts(lines, remarks, open = false) {
  return [
    lines.length ? h("details", { class: "facts", open }, h("summary", {}, "Drive and sensors of the robots"), h("ul", {}, lines.map((one) => h("li", {}, one)))) : null,
    remarks.map((one) => h("p", { class: "remark" }, one)),
  ].flat();
}

/** A text field for names of robots, separated by commas. `describe(text)` asks the server what they are. */
export class RobotField {
  constructor(describe) {
    Object.assign(this, { describe, names: [], asked: 0 });
    this.known = h("datalist", { id: "known-robots" });
    this.facts = h("div", { id: "robot-facts", "aria-live": "polite" });
    this.input = h("input", {
      type: "text",
      list: "known-robots",
      placeholder: "robot of the trial",
      autocomplete: "off",
      "aria-describedby": "robot-facts",
      oninput: () => this.complete(),
      onchange: () => this.check(),
    });
    const note = "Types or robot folders, separated by commas, each with its own shape, drive and sensors.";
    this.element = h("div", { class: "robot-field" }, field("Robots", this.input), this.known, h("small", {}, note), this.facts);
  }

  get value() {
    return this.input.value.trim();
  }

  /** Takes the names that are offered as completions. */
  offer(names) {
    this.names = names;
    this.complete();
  }

  /** Offers the names that the list does not have yet, for its last name. */
  complete() {
    const given = this.input.value.split(",").map((one) => one.trim());
    const before = given.slice(0, -1);
    const rest = this.names.filter((one) => !before.includes(one));
    fill(this.known, rest.map((one) => h("option", { value: [...before, one].join(", ") })));
  }

  /** Shows what the robots are, or why they cannot be; returns whether they can. */
  async check() {
    const number = ++this.asked;
    const none = { problem: "", lines: [], remarks: [] };
    const found = this.value ? await this.describe(this.value).catch(() => none) : none; // another field is wrong
    if (number !== this.asked) return !found.problem;
    this.input.setAttribute("aria-invalid", String(Boolean(found.problem)));
    fill(this.facts, found.problem ? h("p", { class: "problem" }, found.problem) : null, robotFacts(found.lines, found.remarks));
    return !found.problem;
  }
}
