// Outline: the elements as a list that works with the keyboard.
import { fill, h } from "../ui/dom.mjs";
import { same } from "./model.mjs";

export class Outline {
  constructor(root, model) {
    Object.assign(this, { root, model });
    root.setAttribute("role", "listbox");
    root.setAttribute("aria-label", "Elements");
    root.setAttribute("aria-multiselectable", "true");
    root.tabIndex = 0;
    root.addEventListener("keydown", (event) => this.press(event));
  }

  update() {
    const tree = this.model.state.tree;
    this.paths = tree ? rows(tree) : [];
    fill(this.root, this.paths.map((path, i) => this.row(path, i)));
    const chosen = this.paths.findIndex((path) => this.isChosen(path));
    if (chosen >= 0) {
      this.root.setAttribute("aria-activedescendant", `element-${chosen}`);
      this.root.children[chosen].scrollIntoView({ block: "nearest" });
    }
  }

  row(path, i) {
    const node = this.model.node(path);
    const { name, type, count } = node.attributes;
    const wrong = this.model.state.problems.some((one) => one.path && same(one.path, path));
    const words = [node.tag, name, type, count && `${count} people`, wrong && "has a problem"].filter(Boolean).join(" ");
    return h(
      "div",
      {
        role: "option",
        id: `element-${i}`,
        "aria-selected": String(this.isChosen(path)),
        class: wrong ? "wrong" : "",
        style: `padding-left:${8 + 14 * path.length}px`,
        onclick: (event) => this.choose(path, event.shiftKey || event.ctrlKey),
      },
      words,
    );
  }

  isChosen(path) {
    return this.model.chosen.some((one) => same(one, path));
  }

  choose(path, more) {
    const others = more ? this.model.chosen.filter((one) => !same(one, path)) : [];
    this.model.choose([...others, path]);
  }

  press(event) {
    const now = this.paths.findIndex((path) => this.isChosen(path));
    const next = { ArrowDown: now + 1, ArrowUp: now - 1, Home: 0, End: this.paths.length - 1 }[event.key];
    if (next !== undefined && this.paths[next]) {
      event.preventDefault();
      this.choose(this.paths[next], event.shiftKey);
    } else if (event.key === "Delete" && this.model.chosen.some((path) => path.length)) {
      event.preventDefault();
      this.model.edit("remove", { paths: this.model.chosen.filter((path) => path.length) });
    }
  }
}

function rows(node, path = []) {
  return [path, ...node.children.flatMap((one, i) => rows(one, [...path, i]))];
}
