// Keys: shortcuts of the page and of the tab in front, and the list that `?` shows.
export class Keys {
  constructor() {
    this._sets = new Map();
    this.active = null;
    document.addEventListener("keydown", (event) => this._press(event));
  }

  /** Adds keys for a tab (null: everywhere): add("simulator", [[" ", "Run or pause", action], ...]). */
  add(tab, keys) {
    this._sets.set(tab, [...(this._sets.get(tab) ?? []), ...keys]);
  }

  /** Keys that work now: [[key, text, action], ...]. */
  list() {
    return [...(this._sets.get(this.active) ?? []), ...(this._sets.get(null) ?? [])];
  }

  _press(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const target = event.target;
    if (target.closest("input, textarea, select, dialog, [contenteditable]")) return;
    if ((event.key === " " || event.key === "Enter") && target.closest("button, summary, a")) return;
    if (event.key.startsWith("Arrow") && target.closest("[role=tab], [role=slider], [role=listbox]")) return;
    const found = this.list().find(([key]) => key === event.key);
    if (!found) return;
    event.preventDefault();
    found[2](event);
  }
}

/** Name of a key for people. */
export function keyName(key) {
  return { " ": "Space", ArrowRight: "→", ArrowLeft: "←", ArrowUp: "↑", ArrowDown: "↓" }[key] ?? key;
}
