// Layout: panes that are resized and folded, and parts that are folded; the browser keeps both over a reload.
import { h } from "./dom.mjs";

const KEY = "layout";
const STEP = 16;

/** What is kept, by names; a text that something else wrote counts as nothing. */
function kept() {
  try {
    const found = JSON.parse(localStorage.getItem(KEY));
    return found instanceof Object ? found : {};
  } catch {
    return {};
  }
}

function keep(name, values) {
  localStorage.setItem(KEY, JSON.stringify({ ...kept(), [name]: values })); // read anew: another window may have written
}

/** Keeps whether a <details> is open; the name is that of its tab and its own. */
export function keepOpen(details, name) {
  const { folded } = kept()[name] ?? {};
  if (folded !== undefined) details.open = folded !== true;
  details.addEventListener("toggle", () => keep(name, { folded: !details.open }));
  return details;
}

/**
 * Makes a part of a tab a pane, and returns it with its divider, in the order of the page.
 *
 * The parent has the class "panes", and "rows" too where panes lie below each other. CSS gives the first size of a pane
 * (--size), its least [px] and its largest [%].
 * @param {string} tab name of the tab
 * @param {string} title what is in it
 * @param {HTMLElement} pane
 * @param {"left"|"right"|"below"} side where it lies, seen from what stays
 */
export function makePane(tab, title, pane, side) {
  const name = `${tab}/${title}`;
  const across = side !== "below"; // the size is a width
  const id = (pane.id ||= `pane-${name.replace(/\W+/g, "-").toLowerCase()}`);
  const line = h("div", { role: "separator", tabindex: 0, "aria-orientation": across ? "vertical" : "horizontal", "aria-label": `Size of ${title}`, "aria-controls": id, title: "Drag, or press arrow keys; a double click resets, Enter folds" });
  const button = h("button", { type: "button", class: "fold", "aria-controls": id, onclick: () => fold(!pane.hidden) }, h("span", {}, title));
  const divider = h("div", { class: "divider", "data-side": side }, line, button);
  const limits = () => {
    const style = getComputedStyle(pane);
    const [low, share] = [style[across ? "minWidth" : "minHeight"], style[across ? "maxWidth" : "maxHeight"]].map(parseFloat);
    return { now: across ? pane.offsetWidth : pane.offsetHeight, low, high: (share / 100) * (across ? pane.parentElement.clientWidth : pane.parentElement.clientHeight) };
  };
  let size = null;

  function tell() {
    button.setAttribute("aria-expanded", String(!pane.hidden));
    button.setAttribute("aria-label", `${pane.hidden ? "Unfold" : "Fold"} ${title}`);
    line.hidden = pane.hidden;
    if (!pane.offsetParent || pane.hidden) return;
    const { now, low, high } = limits();
    for (const [key, value] of [["now", now], ["min", low], ["max", Math.max(now, high)]]) line.setAttribute(`aria-value${key}`, Math.round(value));
    line.setAttribute("aria-valuetext", `${Math.round(now)} pixels`);
  }

  function fold(folded) {
    pane.hidden = folded;
    tell();
    keep(name, { size, folded });
  }

  /** Sets the size [px], or the first one for null. */
  function resize(wish) {
    const { low, high } = limits();
    size = wish === null ? null : Math.round(Math.max(low, Math.min(high, wish)));
    if (size === null) pane.style.removeProperty("--size");
    else pane.style.setProperty("--size", `${size}px`);
    tell();
    keep(name, { size, folded: pane.hidden });
  }

  const grows = side === "left" ? 1 : -1;
  let from = null;
  line.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    line.setPointerCapture(event.pointerId);
    from = (across ? event.clientX : event.clientY) - grows * limits().now;
  });
  line.addEventListener("pointermove", (event) => from !== null && resize(grows * ((across ? event.clientX : event.clientY) - from)));
  for (const end of ["pointerup", "pointercancel"]) line.addEventListener(end, () => (from = null));
  line.addEventListener("dblclick", () => resize(null));
  line.addEventListener("keydown", (event) => {
    const { now, low, high } = limits();
    const step = STEP * (event.shiftKey ? 4 : 1);
    const [less, more] = across ? ["ArrowLeft", "ArrowRight"] : ["ArrowUp", "ArrowDown"];
    const action = {
      [less]: () => resize(now - grows * step), [more]: () => resize(now + grows * step),
      Home: () => resize(low), End: () => resize(high),
      Enter: () => {
        fold(true);
        button.focus();
      },
    }[event.key];
    if (!action) return;
    event.preventDefault();
    event.stopPropagation(); // the keys of the tab do something else
    action();
  });

  const found = kept()[name] ?? {};
  pane.classList.add("pane");
  if (Number.isFinite(found.size) && found.size > 0) pane.style.setProperty("--size", `${(size = found.size)}px`);
  pane.hidden = found.folded === true;
  new ResizeObserver(tell).observe(pane);
  tell();
  return side === "left" ? [pane, divider] : [divider, pane];
}
