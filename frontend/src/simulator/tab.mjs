// Simulator tab.
import { h } from "../ui/dom.mjs";

export const simulator = {
  name: "simulator",
  title: "Simulator",
  mount(root) {
    root.append(h("p", {}, "Simulator"));
    return {};
  },
};
