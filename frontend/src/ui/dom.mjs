// Small functions that make elements of the page. Text is never parsed as HTML.

const isShown = (one) => one !== null && one !== undefined && one !== false;

/** Makes an element: h("button", {class: "main", onclick: f, "aria-label": "Run"}, "Run", child, ...). */
export function h(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (value === true) element.setAttribute(name, "");
    else if (value !== false && value !== null && value !== undefined) element.setAttribute(name, value);
  }
  element.append(...children.flat().filter(isShown));
  return element;
}

/** Replaces the children of an element. */
export function fill(element, ...children) {
  element.replaceChildren(...children.flat().filter(isShown));
  return element;
}

/** Makes a labelled control: field("Speed [m/s]", h("input", ...)). */
export function field(label, control, note = null) {
  return h("label", { class: "field" }, h("span", {}, label), control, note && h("small", {}, note));
}
