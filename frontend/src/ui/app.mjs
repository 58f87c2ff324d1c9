// App: the frame of the page: header, tabs, theme, connection state, keys, address.
import { Connection } from "../net/connection.mjs";
import { openDialog } from "./dialog.mjs";
import { attempt, messageRegion, placeMessages, say } from "./messages.mjs";
import { fill, h } from "./dom.mjs";
import { Keys, keyName } from "./keys.mjs";

export class App {
  /**
   * @param {Array} tabs modules with {name, title, opens?, mount(root, app)}: `opens` names the values of the address from
   *   which a server that shows nothing yet opens something; mount returns {show?, hide?, greet?}, and greet takes the
   *   present state of the server, at each connection and when the tab is mounted later
   */
  constructor(root, tabs) {
    this.tabs = tabs;
    this.keys = new Keys();
    this.address = new URLSearchParams(location.hash.slice(1));
    this.connection = new Connection(this.address.get("session") ?? "main", "socket", () => this._opened());
    this._views = new Map();
    this._layout(root);
    this._listen();
    this.select(this.address.get("tab") ?? tabs[0].name);
  }

  /** What a tab has returned from mount, such as its scene for the tests; undefined before it was shown. */
  tab(name) {
    return this._views.get(name);
  }

  /** Shows a tab. */
  select(name) {
    const tab = this.tabs.find((one) => one.name === name) ?? this.tabs[0];
    for (const one of this.tabs) {
      const chosen = one === tab;
      const button = this._buttons.get(one.name);
      button.setAttribute("aria-selected", String(chosen));
      button.tabIndex = chosen ? 0 : -1;
      this._panels.get(one.name).hidden = !chosen;
      if (!chosen) this._views.get(one.name)?.hide?.();
    }
    if (!this._views.has(tab.name)) {
      this._views.set(tab.name, tab.mount(this._panels.get(tab.name), this));
      this._greet(tab.name);
    }
    this.keys.active = tab.name;
    this.remember({ tab: tab.name });
    this._views.get(tab.name).show?.();
  }

  /** Shows the simulator, where a trial runs, or an episode plays from an instant [s]. */
  async openInSimulator({ file, seed = null, at = null }) {
    const episode = file.endsWith(".mcap");
    const found = await attempt(() =>
      episode
        ? this.connection.call("simulator.open_episode", { name: file, at, paused: false })
        : this.connection.call("simulator.open", { name: file, seed }),
    );
    if (found === undefined) return;
    for (const remark of found?.remarks ?? []) say(remark);
    this.select("simulator");
    this.tab("simulator").picture.canvas.focus();
  }

  /** Writes values into the address of the page, so that a link shows the same; null removes one. */
  remember(values) {
    for (const [name, value] of Object.entries(values)) {
      if (value === null || value === undefined) this.address.delete(name);
      else this.address.set(name, String(value));
    }
    history.replaceState(null, "", `#${this.address}`);
  }

  /** The part of the address that names what the server opens. */
  _opened() {
    const names = this.tabs.flatMap((one) => one.opens ?? []);
    return Object.fromEntries([...this.address].filter(([name]) => names.includes(name)));
  }

  /** Hands the present state of the server to a tab that was mounted after the greeting of the connection. */
  async _greet(name) {
    if (!this._desks) return;
    const state = this._desks.has(name) ? await attempt(() => this.connection.call(`${name}.greet`)) : {};
    if (state) this._views.get(name).greet?.(state);
  }

  /** "dark" or "light". */
  get theme() {
    return document.documentElement.dataset.theme;
  }

  _layout(root) {
    this._buttons = new Map();
    this._panels = new Map();
    for (const { name, title } of this.tabs) {
      this._buttons.set(
        name,
        h("button", { role: "tab", id: `tab-${name}`, "aria-controls": `panel-${name}`, onclick: () => this.select(name) }, title),
      );
      this._panels.set(name, h("section", { role: "tabpanel", id: `panel-${name}`, "aria-labelledby": `tab-${name}`, hidden: true }));
    }
    this._status = h("span", { class: "connection", role: "status" }, "connecting");
    const bar = h("nav", { role: "tablist", "aria-label": "Tabs" }, [...this._buttons.values()]);
    bar.addEventListener("keydown", (event) => this._moveTab(event));
    fill(
      root,
      h(
        "header",
        {},
        h("h1", {}, "crowdbot"),
        bar,
        this._status,
        h("button", { type: "button", onclick: () => this._toggleTheme() }, "Theme"),
        h("button", { type: "button", "aria-label": "Keys", onclick: () => this._showKeys() }, "?"),
      ),
      h("main", {}, [...this._panels.values()]),
      messageRegion,
    );
    placeMessages();
    const stored = this.address.get("theme") ?? localStorage.getItem("theme");
    const system = matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
    document.documentElement.dataset.theme = stored ?? system;
    this.keys.add(null, [["?", "Show the keys", () => this._showKeys()]]);
  }

  _listen() {
    this.connection.on("lost", () => {
      this._desks = null;
      this._tellConnection("not connected, trying again", "lost");
    });
    this.connection.on("hello", ({ desks }) => {
      this._desks = new Set(Object.keys(desks));
      if (desks.jobs) this._countJobs(desks.jobs);
      for (const [name, view] of this._views) view.greet?.(desks[name] ?? {});
      this._tellConnection("connected", "");
    });
    this.connection.on("jobs.state", (state) => this._countJobs(state));
  }

  /** Shows the number of jobs that wait or run in the title of their tab. */
  _countJobs({ jobs }) {
    const active = jobs.filter((one) => one.state === "running" || one.state === "waiting").length;
    const { title } = this.tabs.find((one) => one.name === "jobs");
    this._buttons.get("jobs").textContent = active ? `${title} (${active})` : title;
  }

  _tellConnection(text, kind) {
    this._status.textContent = text;
    this._status.className = `connection ${kind}`;
  }

  _moveTab(event) {
    const step = { ArrowRight: 1, ArrowLeft: -1 }[event.key];
    if (!step) return;
    const names = this.tabs.map((one) => one.name);
    const next = names[(names.indexOf(this.keys.active) + step + names.length) % names.length];
    this.select(next);
    this._buttons.get(next).focus();
  }

  _toggleTheme() {
    const theme = this.theme === "dark" ? "light" : "dark";
    document.documentElement.dataset.theme = theme;
    localStorage.setItem("theme", theme);
    document.dispatchEvent(new CustomEvent("theme", { detail: theme }));
  }

  _showKeys() {
    const rows = this.keys.list().map(([key, text]) => h("tr", {}, h("td", {}, h("kbd", {}, keyName(key))), h("td", {}, text)));
    openDialog("Keys", h("table", {}, h("tbody", {}, rows)));
  }
}
