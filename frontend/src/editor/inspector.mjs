// Inspector: the form of the chosen element, made from the table of trial files.
import { fill, h } from "../ui/dom.mjs";
import { followChanges } from "./journeys.mjs";

const number = (text) => (text === "" ? undefined : text);

export class Inspector {
  constructor(root, model) {
    Object.assign(this, { root, model });
  }

  update() {
    const { model } = this;
    const active = document.activeElement?.closest?.(".inspector") ? document.activeElement.name : null;
    const path = model.chosen[0] ?? [];
    const node = model.node(path);
    if (!node) return fill(this.root, h("p", {}, "The text is not well-formed XML; correct it in the XML pane."));
    if (model.chosen.length > 1) return this.several();
    const kind = model.kind(path);
    const rows = [...(kind?.attributes ?? []), ...(kind?.types?.[node.attributes.type]?.attributes ?? [])];
    fill(
      this.root,
      h("h3", {}, `<${node.tag}>`),
      h("p", { class: "note" }, kind?.about ?? ""),
      this.problems(path),
      kind?.types ? this.type(path, node, kind.types) : null,
      rows.map((row) => this.control(path, node, row)),
      this.children(path, kind),
      this.buttons(path, node),
    );
    if (active) this.root.querySelector(`[name="${CSS.escape(active)}"]`)?.focus();
  }

  problems(path) {
    const found = this.model.state.problems.filter((one) => one.path && one.path.join() === path.join());
    return found.length ? h("ul", { class: "problems" }, found.map((one) => h("li", {}, one.message))) : null;
  }

  several() {
    const { model } = this;
    const agents = model.chosen.every((path) => model.node(path)?.tag === "agent");
    fill(
      this.root,
      h("h3", {}, `${model.chosen.length} elements`),
      h(
        "div",
        { class: "row" },
        agents ? h("button", { type: "button", onclick: () => model.edit("gather", { paths: model.chosen }) }, "Make a spawner") : null,
        h("button", { type: "button", onclick: () => model.edit("remove", { paths: model.chosen }) }, "Remove"),
      ),
    );
  }

  type(path, node, types) {
    const own = node.attributes.type in types || !node.attributes.type ? [] : [node.attributes.type];
    const choices = ["", ...own, ...Object.keys(types)];
    const select = h(
      "select",
      { name: "type", onchange: () => this.set(path, "type", select.value) },
      choices.map((one) => h("option", { value: one, selected: one === (node.attributes.type ?? "") }, one || "default")),
    );
    return this.field("type", types[node.attributes.type]?.about, select);
  }

  control(path, node, row) {
    const value = node.attributes[row.name];
    const change = (text) => this.set(path, row.name, text === undefined || text === "" ? null : text);
    const label = `${row.label}${row.unit ? ` [${row.unit}]` : ""}${row.required ? " *" : ""}`;
    let control;
    const ways = row.name === "journey" ? this.model.state.tree.children.filter((one) => one.tag === "journey").map((one) => one.attributes.name) : null;
    if (ways) {
      const choices = ["", ...new Set([...ways, ...(value ? [value] : [])])];
      control = h("select", { name: row.name, onchange: () => this.follow(path, control.value) }, choices.map((one) => h("option", { value: one, selected: one === (value ?? "") }, one || "none: to the goal")));
    } else if (row.kind === "choice" || row.kind === "switch") {
      const choices = row.kind === "switch" ? ["true", "false"] : row.choices;
      const initial = value ?? "";
      control = h(
        "select",
        { name: row.name, onchange: () => change(control.value) },
        ["", ...choices].map((one) => h("option", { value: one, selected: one === initial }, one || (row.value === null ? "not given" : `default (${row.value})`))),
      );
    } else {
      const numeric = row.kind === "number" || row.kind === "whole";
      control = h("input", {
        name: row.name,
        type: "text",
        inputmode: numeric ? "decimal" : "text",
        value: value ?? "",
        placeholder: row.value === null || row.value === undefined ? "" : String(row.value),
        onchange: () => change(number(control.value)),
      });
    }
    return this.field(label, row.note, control);
  }

  field(label, note, control) {
    return h("label", { class: "field", title: note ?? "" }, h("span", {}, label), control);
  }

  /** Lets people follow a way instead of walking to a goal, or ends that. */
  follow(path, name) {
    if (!name) return this.set(path, "journey", null);
    return this.model.edit("change", { changes: followChanges(this.model, [path], name) });
  }

  set(path, name, value) {
    return this.model.edit("change", { changes: [{ path, name, value }] });
  }

  children(path, kind) {
    const names = Object.keys(kind?.children ?? {});
    if (!names.length) return null;
    const select = h("select", { name: "child", "aria-label": "Element to add" }, names.map((one) => h("option", {}, one)));
    const add = () => this.model.insert(path, this.blank(kind.children[select.value], select.value));
    return h("div", { class: "row" }, select, h("button", { type: "button", onclick: add }, "Add inside"));
  }

  /** An element with its required attributes and children. */
  blank(name, tag) {
    const kind = this.model.table[name];
    const words = (kind?.attributes ?? []).filter((row) => row.required).map((row) => ` ${row.name}="${sample(row)}"`);
    if (kind?.types && tag !== "crowd") words.push(` type="${Object.keys(kind.types)[0]}"`);
    if (tag === "crowd") words.push(' type="people"');
    if (tag === "robot") return `<robot${words.join("")}>\n  <goal x="0" y="0"/>\n  <drive type="differential-drive"/>\n  <navigator type="orca"/>\n</robot>`;
    return `<${tag}${words.join("")}/>`;
  }

  buttons(path, node) {
    if (!path.length) return null;
    const { model } = this;
    const seed = Number(model.state.tree.attributes.seed ?? 0);
    return h(
      "div",
      { class: "row" },
      node.tag === "spawner"
        ? h("button", { type: "button", onclick: () => model.edit("expand", { path, seed }) }, "Make single people")
        : null,
      h("button", { type: "button", onclick: () => model.edit("remove", { paths: [path] }) }, "Remove"),
    );
  }
}

const sample = (row) => {
  if (row.kind === "points") return "0,0 1,0 1,1 0,1";
  if (row.kind === "choice") return row.choices[0];
  if (row.kind === "number" || row.kind === "whole" || row.kind === "distribution") return Math.max(row.low ?? 1, 1);
  return row.name === "name" ? "new" : "";
};
