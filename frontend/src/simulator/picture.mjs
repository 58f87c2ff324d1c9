// Picture: the canvas of the simulator: the scene, the preview while it is prepared, clicks.
import { SceneGone } from "../net/state_frame.mjs";
import { Scene2D } from "../scene2d/scene2d.mjs";
import { Scene3D } from "../scene3d/scene3d.mjs";
import { Motion } from "../scene/motion.mjs";
import { h } from "../ui/dom.mjs";
import { say } from "../ui/messages.mjs";
import { drawPreview, previewFloor } from "./preview.mjs";

const AWAKE = 800;
const DRAG = 5;

export class Picture {
  /**
   * @param {object} app the page
   * @param {{select(hit), place(point)}} actions what clicks do: hit {kind, id} or null; place x, y [m] of the floor
   * @param {string} desk the desk that sends the frames
   */
  constructor(app, actions, desk = "simulator") {
    this.app = app;
    this.desk = desk;
    this.actions = actions;
    this.placing = false;
    this.frames = 0;
    this.motion = new Motion();
    this._measured = [];
    this._waiting = null;
    this._loading = null;
    this._awake = 0;
    this._sparing = this._owed = false;
    this._shown = true;
    this._seen = this.visible;
    this.place = h("div", { class: "stage-place" });
    this.overlay = h("canvas", { class: "preview", "aria-hidden": "true", hidden: true });
    this._words = {};
    this.note = h("p", { class: "picture-note", role: "status" });
    this.element = h("div", { class: "picture" }, this.place, this.overlay, this.note);
    this._make(app.address.get("view") ?? "3d");
    this._listen();
    requestAnimationFrame(() => this._tick());
  }

  /** Takes a frame of the channel "scene"; the promise is kept until it is drawn. */
  take(frame) {
    if (!this.visible || !this.scene) return undefined;
    this._finish();
    this.motion.push(frame, performance.now());
    return new Promise((resolve) => {
      this._waiting = resolve;
    });
  }

  /** Shows people on straight lines until the first frame comes. */
  preview(preview) {
    this._preview = preview && { ...preview, since: performance.now() };
    this.overlay.hidden = !preview;
    if (preview) this.forget();
  }

  /** The newest frame of the server, or null. */
  get newest() {
    return this.motion.newest;
  }

  /** Forgets the frames, because something else is shown. */
  forget() {
    this.motion.clear();
  }

  /** Asks for what stands still, and for the newest frame. */
  renew() {
    this._loading ??= this._load();
  }

  /** Text over the picture, of the "run" or of a "tool", which is more urgent. */
  say(text, of = "run") {
    this._words[of] = text;
    const shown = this._words.tool || this._words.run || "";
    if (this.note.textContent !== shown) this.note.textContent = shown;
    this.note.hidden = !shown;
  }

  /** The picture as a PNG file, null while there is none. */
  png() {
    if (!this.scene?.state.frame) return null;
    this.scene.render(); // a canvas in space keeps its pixels until the end of the task only
    return new Promise((resolve) => this.canvas.toBlob(resolve, "image/png"));
  }

  /** Whether it is seen: its tab is shown, and the page is not hidden behind another window or page of the browser. */
  get visible() {
    return this._shown && !document.hidden;
  }

  set shown(shown) {
    this._shown = shown;
    this._turn();
  }

  /** Gets the frames of the server while it is seen, beginning with the present one. */
  _turn() {
    const { connection } = this.app;
    this.wake();
    if (this.visible === this._seen) return;
    this._seen = this.visible;
    connection.tellWants();
    this.forget();
    if (this._seen) connection.call(`${this.desk}.show_frame`).catch(() => {});
    else this._finish();
  }

  /** Whether the picture leaves the processor to others, such as a compiler, where no graphics card draws. */
  set sparing(sparing) {
    this._sparing = this.scene.sparing = sparing;
    this.wake();
  }

  /** Draws for a while, because the camera moves. */
  wake() {
    this._awake = performance.now() + AWAKE;
  }

  /** Draws a line between two points of the floor {x, y} [m], or none. */
  measure(points) {
    this._measured = points;
    this.scene?.measure(points);
    this.wake();
  }

  mark(kind, id) {
    if (this.scene?.state.frame) this.scene.highlight(kind, id);
    this.wake();
  }

  /** Shows the scene in space ("3d") or from above ("2d"). */
  setView(view) {
    if (view === this.view) return;
    this.scene.dispose();
    this._make(view);
    this.app.remember({ view });
    this.app.connection.call(`${this.desk}.show_frame`).catch(() => {});
  }

  _make(view) {
    this.canvas = h("canvas", { class: "stage", tabindex: "0", role: "img", "aria-label": "Picture of the simulation" });
    this.place.replaceChildren(this.canvas);
    const resource = (path, query) => this.app.connection.address(this.desk, path, query);
    this.view = view === "2d" ? "2d" : "3d";
    try {
      this.scene = this.view === "2d" ? new Scene2D(this.canvas, resource) : new Scene3D(this.canvas, resource);
    } catch (error) {
      say(`The picture in space needs WebGL, so the one from above is shown: ${error.message}`, "error");
      return this._make("2d");
    }
    this.scene.setTheme(this.app.theme);
    this.scene.sparing = this._sparing;
    this.scene.measure(this._measured);
    this._listenCanvas();
    return this.wake();
  }

  _listen() {
    document.addEventListener("theme", (event) => {
      this.scene?.setTheme(event.detail);
      this.wake();
    });
    document.addEventListener("visibilitychange", () => this._turn());
    new ResizeObserver(() => this.wake()).observe(this.element);
  }

  _listenCanvas() {
    let down = null;
    for (const name of ["pointermove", "wheel", "keydown"]) this.canvas.addEventListener(name, () => this.wake(), { passive: true });
    this.canvas.addEventListener("pointerdown", (event) => {
      down = [event.offsetX, event.offsetY];
      this.wake();
    });
    this.canvas.addEventListener("pointerup", (event) => {
      if (!down || Math.hypot(event.offsetX - down[0], event.offsetY - down[1]) > DRAG || event.button !== 0) return;
      this._click(event.offsetX, event.offsetY);
    });
  }

  _click(x, y) {
    const frame = this.scene?.state.frame;
    if (!this.placing) return frame && this.actions.select(this.scene.pick(x, y));
    if (!frame && !this._preview) return say("The picture does not show the floor yet: click again when it does.");
    const point = this._preview ? previewFloor(this.canvas, this._preview, x, y) : this.scene.floor(x, y);
    return point ? this.actions.place(point) : say("There is no floor at this place of the picture: click on the floor.");
  }

  _finish() {
    this._waiting?.();
    this._waiting = null;
  }

  _tick() {
    requestAnimationFrame(() => this._tick());
    if (!this._shown || !this.scene || !this.canvas.clientWidth) return this._finish();
    if (this._preview) drawPreview(this.overlay, this._preview, this.app.theme);
    if (this._waiting === null && !this.motion.moving && performance.now() > this._awake && !this._owed) return undefined;
    this._owed = Boolean(this.scene.busy || this.scene.rests);
    if (this._owed) return undefined; // what waits is drawn afterwards
    if (this._waiting !== null) this.frames += 1;
    this._apply();
    if (this.scene.state.frame) this.scene.render();
    return this._finish();
  }

  _apply() {
    const frame = this._loading ? null : this.motion.at(performance.now());
    if (!frame) return;
    if (this.scene.apply(frame)) this.preview(null);
    else this._loading = this._load();
  }

  async _load() {
    try {
      const description = await this.app.connection.call(`${this.desk}.description`);
      const { scene } = this;
      if (description.revision !== undefined) {
        await scene.load(description);
        if (scene === this.scene) this.actions.loaded?.(description); // another view loads with its first frame
      }
      if (this.motion.newest && this.scene?.apply(this.motion.newest)) this.preview(null);
      this.wake();
    } catch (error) {
      if (!(error instanceof SceneGone)) say(error.message, "error");
      return;
    } finally {
      this._loading = null;
    }
    this.app.connection.call(`${this.desk}.show_frame`).catch(() => {});
  }
}
