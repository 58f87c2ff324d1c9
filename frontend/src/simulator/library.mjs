// Library: built-in trials with thumbnails, files of the folder, recorded episodes.
import { openDialog } from "../ui/dialog.mjs";
import { attempt, say } from "../ui/messages.mjs";
import { fill, h } from "../ui/dom.mjs";
import { makeForm } from "../ui/form.mjs";
import { upload } from "../ui/upload.mjs";

/** Height [px] that the heading of a group covers. */
const HEAD = 30;

export class Library {
  constructor(app) {
    this.app = app;
    this.trials = h("div", { class: "trials" });
    this.episodes = h("ul", { class: "episodes" });
    this.search = h("input", { type: "search", "aria-label": "Search trials", placeholder: "Search trials", oninput: () => this._filter() });
    this.file = h("input", { type: "file", accept: ".xml,.mcap", "aria-label": "Open a trial or an episode from a file", onchange: () => this._upload() });
    this.element = h("aside", { class: "library", "aria-label": "Trials and episodes" },
      h("h2", {}, "Trials"), this.search, this.trials,
      h("h2", {}, "Episodes"), this.episodes,
      h("label", { class: "field" }, h("span", {}, "Open a file (.xml, .mcap)"), this.file));
  }

  async load() {
    const [trials] = await Promise.all([this.app.connection.call("simulator.trials"), this.loadEpisodes()]);
    const groups = [...new Set(trials.map((one) => one.group))];
    fill(this.trials, groups.map((group) => {
      const own = trials.filter((one) => one.group === group);
      return h("section", { "aria-label": group }, h("h3", {}, group), h("ul", {}, own.map((trial) => this._trial(trial))));
    }));
    this._filter();
    this.mark(this._current);
  }

  async loadEpisodes() {
    const names = await this.app.connection.call("simulator.episodes");
    fill(this.episodes, names.length
      ? names.map((name) => h("li", {}, h("button", { type: "button", onclick: () => this.openEpisode(name) }, name)))
      : h("li", { class: "faint" }, "None yet: save a run"));
  }

  openEpisode(name, at = null) {
    return attempt(() => this.app.connection.call("simulator.open_episode", { name, at }));
  }

  async open(name, settings = {}, seed = null) {
    const found = await attempt(() => this.app.connection.call("simulator.open", { name, settings, seed }));
    for (const remark of found?.remarks ?? []) say(remark);
    return found;
  }

  /** Marks what is open. */
  mark(name) {
    for (const one of this.element.querySelectorAll("button[aria-current]")) one.removeAttribute("aria-current");
    this._current = name ?? "";
    const found = this.trials.querySelector(`button[data-name="${CSS.escape(this._current)}"]`);
    found?.setAttribute("aria-current", "true");
    if (found) this.trials.scrollTop += found.getBoundingClientRect().top - this.trials.getBoundingClientRect().top - HEAD;
  }

  _trial({ name, title, parameters }) {
    const picture = h("img", { src: this.app.connection.address("simulator", `thumbnail/${encodeURIComponent(name)}.svg`), alt: "", loading: "lazy" });
    const button = h("button", { type: "button", "data-name": name, title, onclick: () => this.open(name) }, picture,
      h("span", {}, h("strong", {}, name), h("small", {}, title)));
    const more = parameters.length
      ? h("button", { type: "button", class: "more", title: "Settings", "aria-label": `Settings of ${name}`, onclick: () => this._settings(name, parameters) }, "…")
      : null;
    return h("li", { "data-words": `${name} ${title}`.toLowerCase() }, button, more);
  }

  _settings(name, parameters) {
    const form = makeForm([...parameters, { name: "world", label: "World", kind: "choice", value: "", choices: [["", "as in the trial"], "planar", "physics"] }]);
    const run = async () => {
      const defaults = Object.fromEntries(parameters.map((one) => [one.name, one.value]));
      const values = form.values();
      const settings = Object.fromEntries(Object.entries(values).filter(([key, value]) => value !== "" && value !== null && value !== defaults[key]));
      return (await this.open(name, settings)) !== undefined;
    };
    openDialog(`Settings of ${name}`, form.element, [["Cancel", () => true], ["Run", run]]);
  }

  _filter() {
    const words = this.search.value.toLowerCase().split(/\s+/).filter(Boolean);
    for (const one of this.trials.querySelectorAll("li")) one.hidden = !words.every((word) => one.dataset.words.includes(word));
    for (const group of this.trials.children) group.hidden = !group.querySelector("li:not([hidden])");
  }

  async _upload() {
    const file = this.file.files[0];
    if (!file) return;
    await attempt(async () => {
      const name = await upload(this.app, file);
      await (name.endsWith(".mcap") ? this.openEpisode(name) : this.open(name));
      await this.load();
    });
    this.file.value = "";
  }
}
