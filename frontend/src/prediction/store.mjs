// What the prediction tab shows: the board of the server, the frame, the chosen person, and what is drawn.
import { decodeFrame } from "../net/state_frame.mjs";
import { attempt } from "../ui/messages.mjs";

const NUMBERS = { frame: "index", person: "person" };
const LAYERS = { walls: true, background: true, observed: true, truth: true, predicted: true, ids: false, density: false, seen: true };

const words = (text) => (text ?? "").split(",").filter(Boolean);

export class Store extends EventTarget {
  constructor(app) {
    super();
    this.app = app;
    this.board = { recording: null, predictors: [], degradation: null, run: { active: false, share: 0 } };
    this.tables = null;
    this.index = 0;
    this.person = null;
    this.frame = null;
    this.hidden = new Set(words(app.address.get("hidden")));
    this.hiddenColumns = new Set(words(app.address.get("without")));
    this.layers = { ...LAYERS };
    for (const name of words(app.address.get("layers"))) if (name in LAYERS) this.layers[name] = !LAYERS[name];
    this.input = app.address.get("input") === "degraded" ? "degraded" : "clean";
    this._loading = null;
    for (const [word, name] of Object.entries(NUMBERS)) {
      const text = app.address.get(word);
      if (/^\d+$/.test(text ?? "")) this[name] = Number(text);
    }
  }

  /** Calls a command of the desk; shows its error and returns undefined. */
  call(name, args = {}) {
    return attempt(() => this.app.connection.call(`prediction.${name}`, args));
  }

  get recording() {
    return this.board.recording;
  }

  /** Takes the board of the server. */
  take(board) {
    const before = this.recording;
    this.board = board;
    const now = board.recording;
    const other = before?.file !== now?.file || JSON.stringify(before?.options) !== JSON.stringify(now?.options);
    if (now && !board.degradation) this.input = "clean";
    if (now) this.index = Math.min(this.index, now.windows - 1);
    if (other && before) {
      this.index = 0;
      this.person = null;
    }
    this.emit("board", other);
    if (now) this.load();
  }

  /** Goes to a frame; numbers beyond the ends stop there. */
  go(index) {
    if (!this.recording) return Promise.resolve();
    this.index = Math.max(0, Math.min(this.recording.windows - 1, Math.round(index)));
    this.app.remember({ frame: this.index });
    this.emit("index");
    return this.load();
  }

  /** Chooses a person, or nobody (null). */
  choose(id) {
    this.person = id;
    this.app.remember({ person: id });
    this.emit("person");
  }

  show(layer, visible) {
    this.layers[layer] = visible;
    const changed = Object.keys(LAYERS).filter((name) => this.layers[name] !== LAYERS[name]);
    this.app.remember({ layers: changed.join(",") || null });
    this.emit("view");
  }

  setInput(input) {
    this.input = input;
    this.app.remember({ input: input === "degraded" ? input : null });
    this.load();
    this.emit("view");
  }

  hide(key, hidden) {
    this._keep("hidden", this.hidden, key, hidden);
    this.load();
  }

  /** Leaves a column out of the table of metrics, or shows it again. */
  hideColumn(name, hidden) {
    this._keep("without", this.hiddenColumns, name, hidden);
  }

  _keep(word, names, name, inside) {
    if (inside) names.add(name);
    else names.delete(name);
    this.app.remember({ [word]: [...names].join(",") || null });
  }

  /** Fetches the frame that is shown; while one is on its way, only the newest is fetched after it. */
  load() {
    this._wanted = true;
    this._loading ??= this._fetch().finally(() => (this._loading = null));
    return this._loading;
  }

  async _fetch() {
    while (this._wanted) {
      this._wanted = false;
      const index = this.index;
      const query = { index, input: this.input, hide: [...this.hidden].join(",") };
      const answer = await fetch(this.app.connection.address("prediction", "window", query)).catch(() => null);
      if (!answer?.ok) return;
      this.frame = readWindow(decodeFrame(await answer.arrayBuffer()), this.recording, index);
      this.emit("frame");
    }
  }

  emit(name, detail) {
    this.dispatchEvent(new CustomEvent(name, { detail }));
  }

  on(names, action) {
    for (const name of names.split(" ")) this.addEventListener(name, (event) => action(event.detail));
  }
}

/** Sorts the arrays of a window by people and predictors. */
export function readWindow({ arrays, time }, recording, index) {
  const people = [...arrays.ids].map((id, i) => ({
    id,
    robot: (arrays.kind[i] & 1) === 1,
    scored: (arrays.kind[i] & 2) === 2,
    past: points(arrays.past, i * recording.observe, recording.observe),
    truth: points(arrays.truth, i * recording.predict, recording.predict),
  }));
  for (const one of people) one.now = one.past.at(-1);
  const forecasts = Object.keys(arrays)
    .filter((name) => name.startsWith("path."))
    .map((name) => readForecast(Number(name.slice(5)), arrays, recording.predict));
  const seen = arrays.seen ? tracks(arrays.seen, recording.observe) : null;
  return { index, time, people, forecasts, seen };
}

function readForecast(slot, arrays, steps) {
  const ids = [...arrays[`ids.${slot}`]];
  const mass = [...arrays[`mass.${slot}`]];
  const flat = arrays[`path.${slot}`];
  const paths = mass.map((weight, k) => ({
    weight,
    people: ids.map((id, a) => ({
      id,
      points: Array.from({ length: steps }, (_, t) => {
        const at = 2 * ((k * steps + t) * ids.length + a);
        return [flat[at], flat[at + 1]];
      }),
    })),
  }));
  return { slot, ids, paths };
}

function tracks(flat, rows) {
  return Array.from({ length: flat.length / 2 / rows }, (_, i) => points(flat, i * rows, rows));
}

function points(flat, first, rows) {
  const found = [];
  for (let row = first; row < first + rows; row++) {
    if (Number.isFinite(flat[2 * row])) found.push([flat[2 * row], flat[2 * row + 1]]);
  }
  return found;
}
