// Simulator tab: a trial that runs or an episode that plays, and everything that can be done with it.
import { attempt, say } from "../ui/messages.mjs";
import { h } from "../ui/dom.mjs";
import { keepOpen, makePane } from "../ui/layout.mjs";
import { DisplayPanel } from "./display_panel.mjs";
import { Drive } from "./drive.mjs";
import { EpisodePanel } from "./episode_panel.mjs";
import { Inspector } from "./inspector.mjs";
import { Library } from "./library.mjs";
import { Picture } from "./picture.mjs";
import { PlotsPanel } from "./plots_panel.mjs";
import { Tools } from "./tools.mjs";
import { Transport, speedText } from "./transport.mjs";
import { ValuesPanel } from "./values_panel.mjs";
import { ViewLink } from "./view_link.mjs";

const SUMMARY = 5000;
const PING = 2000;
/** Time [ms] after which a change of the run is in the address. */
const ADDRESS = 500;
/** Longest time [ms] that the lists wait for the first picture. */
const LATER = 2000;

/** What is shown until a run is prepared. */
function preparation({ compiling, recorded }) {
  if (!compiling) return recorded ? "" : "Preparing the simulation";
  const meanwhile = recorded ? "you see a recording of the same run" : "everybody walks straight";
  return `Compiling for the first run on this computer; until then ${meanwhile}`;
}

class SimulatorView {
  constructor(root, app) {
    this.app = app;
    this.status = { state: "none" };
    this.source = {};
    this._pending = []; // what is done as soon as the run is prepared
    this.latency = null;
    this.fps = 0;
    this._make();
    root.classList.add("simulator", "panes");
    root.append(
      ...makePane("simulator", "Trials and episodes", this.library.element, "left"),
      h("div", { class: "middle" },
        this.tools.element, this.picture.element, keepOpen(this.display.legend, "simulator/legend"), this.drive.element, this.transport.element, this.late, this.line, this.summary),
      ...makePane("simulator", "Inspector, display and plots", this.side, "right"),
    );
    this._listen();
    this._keys();
    setInterval(() => this._measure(), PING);
    setInterval(() => this._summarize(), SUMMARY);
  }

  show() {
    this.picture.shown = true;
  }

  hide() {
    this.picture.shown = false;
  }

  /** Takes the state of the server, when the page opens or connects again. */
  greet(state) {
    if (this.status.orders && ["none", "preparing"].includes(state.status.state))
      say(`The server was started again: the run comes from its seed and its values, without the ${this.status.orders} orders that were given.`);
    this.plots.know(state.plots);
    this.display.predicts(state.predictor);
    this.display.images.take(state.cameras);
    this.link.read();
    this._opened(state.source, state.status);
    this.plots.begin(state.history);
    this._take(state.status);
    if (state.status.state !== "none") this.picture.renew();
    clearTimeout(this._listing);
    this._listing = setTimeout(() => this._list(), LATER);
  }

  /** Asks for the lists; the picture comes first, because the server answers in turn. */
  _list() {
    clearTimeout(this._listing);
    this._listing = null;
    this.library.load().catch((error) => say(error.message, "error"));
    this.app.connection.call("simulator.names").then((names) => {
      this.tools.know(names);
      this.inspector.navigators = names.navigators;
      this.display.know(names.predictors);
    }, () => {});
  }

  _make() {
    const { app } = this;
    this.library = new Library(app);
    this.picture = new Picture(app, {
      select: (hit) => this.inspector.select(hit),
      place: (point) => this.tools.place(point),
      loaded: () => this._loaded(),
    });
    this.transport = new Transport(app, { restart: (fresh) => this._restart(fresh), save: () => this._save() });
    this.values = new ValuesPanel(app);
    this.drive = new Drive(app, { started: (subject) => this._driving(subject), stopped: () => this.display.look("free") });
    this.inspector = new Inspector(app, {
      chosen: (hit) => {
        this.picture.mark(hit?.kind ?? null, hit?.id);
        this.link.note();
      },
      tool: (name) => this.tools.choose(name),
      drive: (kind, name) => this.drive.start(kind, name),
      values: (path) => this.values.open(path),
    });
    this.tools = new Tools(app, { inspector: this.inspector, picture: this.picture, became: (name) => this._became(name), prepared: (action) => this._whenPrepared(action) });
    this.display = new DisplayPanel(app, this.picture, () => this.link.note());
    this.link = new ViewLink(app, this.picture, {
      look: (name) => this.display.look(name),
      select: (hit) => this.inspector.select(hit),
      chosen: () => this.inspector.chosen,
    });
    this.plots = new PlotsPanel(app);
    this.episode = new EpisodePanel(app, { transport: this.transport, library: this.library, names: () => this.tools.names });
    this.late = h("p", { class: "late", role: "status" });
    this.line = h("p", { class: "status-line" });
    this.summary = h("p", { class: "summary", role: "status", "aria-label": "Summary of the picture" });
    this.side = h("aside", { class: "side", "aria-label": "Inspector, display and plots" },
      this.episode.element,
      ["inspector", "display", "plots"].map((name) => keepOpen(this[name].element, `simulator/${name}`)),
      this.values.element);
  }

  _listen() {
    const { connection } = this.app;
    connection.on("simulator.status", (status) => this._take(status));
    connection.on("simulator.opened", ({ source, status }) => {
      this._opened(source, status);
      this.plots.begin([]);
      this._take(status);
    });
    connection.draw("scene", (frame) => this.picture.take(frame), () => this.picture.visible);
    connection.on("lost", () => this.drive.subject && this.drive.forget());
  }

  _opened(source, status) {
    this.source = source;
    this._drop("another run was opened");
    this.picture.forget();
    this.picture.preview(status.state === "preparing" ? source.preview ?? null : null);
    this.library.mark(source.name);
    this._remember(status);
    const live = source.kind === "run";
    this.tools.live = this.inspector.live = this.values.live = live;
    this.episode.element.hidden = live || !source.kind;
    this.transport.mark([]);
    this._readEpisode = !live;
    if (!this._waiting) this.inspector.select(null);
    if (this.drive.subject) this.drive.forget();
  }

  async _take(status) {
    const before = this.status;
    this.status = status;
    this.transport.show(status);
    this.plots.take(status);
    this._showLine();
    this._showLateness();
    this._remembering ??= setTimeout(() => this._remember(this.status), ADDRESS);
    if (status.problems?.length && status.problems.join() !== before.problems?.join()) say(status.problems.join("\n"), "error");
    if (status.state === "preparing" || before.state === "preparing") this.picture.sparing = status.state === "preparing" && status.compiling;
    if (status.state === "preparing") this.picture.say(preparation(status));
    else if (before.state === "preparing" || status.state === "failed") this.picture.say("");
    // the recorded beginning has the same description as the run, so that nothing else asks for the people of the run
    if (before.state === "preparing" && status.state !== "preparing") this.inspector.refresh();
    if (status.state === "failed") {
      this.picture.preview(null);
      this._drop("the run failed");
    } else if (status.state !== "preparing") for (const action of this._pending.splice(0)) action();
    if (status.state === "paused") this._summarize();
    if (status.state === "ended" && before.state !== "ended" && this.drive.subject) this.drive.forget();
    if (this._readEpisode && status.kind === "episode" && !["preparing", "failed"].includes(status.state)) {
      this._readEpisode = false;
      await attempt(() => this._showEpisode());
    }
    if (this.inspector.element.open) this.inspector.update();
  }

  /** Does something with the run, at once or as soon as it is prepared. */
  _whenPrepared(action) {
    if (this.status.state !== "preparing") return action();
    this._pending.push(action);
    return say("The simulation is being prepared; this is done as soon as it runs.");
  }

  /** Forgets what waits for a run that will not come. */
  _drop(reason) {
    if (this._pending.splice(0).length) say(`What waited for the simulation is not done: ${reason}.`, "error");
  }

  /** Writes what is open, and its time, into the address; a server that is started again opens it from there. */
  _remember({ state, time }) {
    clearTimeout(this._remembering);
    this._remembering = null;
    const { kind, name, seed, variant, settings } = this.source;
    if (!kind) return;
    const run = kind === "run";
    const open = {
      trial: run ? name : null, episode: run ? null : name, seed: run ? seed : null,
      variant: variant > 1 ? variant : null, values: run && Object.keys(settings).length ? JSON.stringify(settings) : null,
    };
    if (["running", "paused", "ended"].includes(state))
      Object.assign(open, { time: Number(time.toFixed(2)), paused: state === "paused" ? "yes" : null });
    else if (!Object.entries(open).every(([key, value]) => this.app.address.get(key) === (value === null ? null : String(value))))
      Object.assign(open, { time: null, paused: null }); // another run, which is still prepared
    this.app.remember(open);
  }

  async _showEpisode() {
    const { events, series } = await this.app.connection.call("simulator.episode");
    this.episode.show(events);
    this.transport.mark(events);
    this.plots.whole(series);
  }

  _loaded() {
    if (this._listing) this._list();
    this.display.loaded();
    this.link.restore();
    this.inspector.refresh();
    if (this._waiting) {
      const name = this._waiting;
      this._waiting = null;
      this._walk(name);
    }
  }

  _driving({ kind, name }) {
    const robots = this.picture.scene.state.description?.robots ?? [];
    if (kind === "robot") this.inspector.select({ kind, id: robots.find((one) => one.name === name)?.id });
    this.display.look("follow");
    if (kind === "avatar") this.display.look("eyes");
  }

  _became(name) {
    this._waiting = name;
    if (this.status.trial && this.picture.scene.state.frame && this.status.state === "running") this.picture.wake();
  }

  async _walk(name) {
    const people = await this.app.connection.call("simulator.people");
    const own = people.find((one) => one.name === name);
    if (own) await this.inspector.select({ kind: "person", id: own.id });
    await this.drive.start("avatar", name);
  }

  _restart(fresh) {
    if (this.status.kind !== "run") return undefined;
    const seed = fresh ? Math.floor(Math.random() * 1e6) : null;
    return attempt(() => this.app.connection.call("simulator.restart", { seed }));
  }

  async _save() {
    const name = await attempt(() => this.app.connection.call("simulator.save"));
    if (!name) return;
    say(`Saved as ${name}`);
    await this.library.loadEpisodes();
  }

  async _measure() {
    const drawn = this.picture.frames;
    this.fps = (drawn - (this._drawn ?? drawn)) / (PING / 1000);
    this._drawn = drawn;
    if (!this.app.connection.open) return;
    const begin = performance.now();
    await this.app.connection.call("simulator.ping").catch(() => {});
    this.latency = performance.now() - begin;
    this._showLine();
  }

  _showLine() {
    const { state, trial, seed, time, factor, values, outcome, orders, speed, problems } = this.status;
    if (!trial) {
      this.line.textContent = problems?.length ? problems[0] : "Nothing is open";
      return;
    }
    const word = state === "ended" && outcome ? (outcome === "finished" ? "ended as planned" : `ended: ${outcome}`) : state;
    const parts = [`${trial}, seed ${seed}: ${word}`, `${(time ?? 0).toFixed(1)} s`, `speed ${speedText(speed)}`];
    if (state === "running" && factor) parts.push(`real-time factor ${factor.toFixed(2)}`);
    if (values?.people !== undefined) parts.push(`${values.people} people`);
    parts.push(`${orders} orders`);
    if (state === "running") parts.push(`${this.fps.toFixed(0)} pictures/s`);
    if (this.latency !== null) parts.push(`latency ${this.latency.toFixed(0)} ms`);
    this.line.textContent = parts.join("  ·  ");
  }

  /** Says that the run is behind; in one text without numbers, so that a screen reader reads it once. */
  _showLateness() {
    const { state, late, speed } = this.status;
    const text = late && state === "running" ? `This computer cannot keep up with speed ${speedText(speed)}: the run is slower. Choose a lower speed or a simpler trial.` : "";
    if (this.late.textContent !== text) this.late.textContent = text;
  }

  _summarize() {
    const { state, values, time } = this.status;
    if (!values || !["running", "paused"].includes(state) || values.people === undefined || this.picture.element.offsetParent === null) return;
    const near = values.clearance === null || values.clearance === undefined ? "" : `; the nearest person is ${values.clearance.toFixed(1)} m from the robot`;
    const text = `At ${time.toFixed(1)} s: ${values.people} people${near}.`;
    if (this.summary.textContent !== text) this.summary.textContent = text;
  }

  _keys() {
    const { transport } = this;
    const episode = () => this.status.kind === "episode";
    const arrow = (way) => () => !this.drive.subject && (episode() ? transport.jump(way) : way > 0 && transport.step());
    this.app.keys.add("simulator", [
      [" ", "Run or pause", () => transport.toggle()],
      [".", "One step", () => transport.step()],
      ["ArrowRight", "One step; in an episode: 1 s ahead", arrow(1)],
      ["ArrowLeft", "In an episode: 1 s back", arrow(-1)],
      ["[", "Slower", () => transport.change(-1)],
      ["]", "Faster", () => transport.change(1)],
      ["r", "Restart", () => this._restart(false)],
      ["n", "Restart with another seed", () => this._restart(true)],
      ["j", "Event before", () => this.episode.jump(-1)],
      ["k", "Event after", () => this.episode.jump(1)],
      ["+", "Add a person by two clicks", () => this.tools.choose("person")],
      ["m", "Measure a distance by two clicks", () => this.tools.choose("measure")],
      ["g", "Goal of the chosen one by a click", () => this.inspector.state && this.tools.choose("goal")],
      ["Delete", "Remove the chosen one", () => this.inspector.remove()],
      ["f", "Follow", () => this.display.look("follow")],
      ["i", "Through the eyes of the chosen one; Shift and arrows look around", () => this.display.look("eyes")],
      ["o", "Overview", () => this.display.reset()],
      ["v", "In space or from above", () => this._turnView()],
      ["Escape", "Cancel; give a robot back", () => this.tools.choose(null)],
    ]);
  }

  _turnView() {
    this.display.view.value = this.picture.view === "3d" ? "2d" : "3d";
    this.picture.setView(this.display.view.value);
  }
}

export const simulator = {
  name: "simulator",
  title: "Simulator",
  opens: ["trial", "seed", "variant", "values", "episode", "time", "paused"],
  mount: (root, app) => new SimulatorView(root, app),
};
