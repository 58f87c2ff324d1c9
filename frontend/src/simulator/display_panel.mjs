// DisplayPanel: view, camera, and what the picture shows.
import { legend } from "../scene/field.mjs";
import { LOOKS, sceneLegend } from "../scene/look.mjs";
import { attempt } from "../ui/messages.mjs";
import { fill, h } from "../ui/dom.mjs";
import { CameraPanel } from "./camera_panel.mjs";

/** The panel `element`, and the `legend` that stands below the picture. */
export class DisplayPanel {
  /** @param {() => void} looked called after another camera was chosen */
  constructor(app, picture, looked = () => {}) {
    this.app = app;
    this.looked = looked;
    this.picture = picture;
    const views = [["3d", "In space"], ["2d", "From above"]];
    this.view = h("select", { "aria-label": "View", onchange: () => this._chooseView() }, views.map(([value, text]) => h("option", { value, selected: value === picture.view }, text)));
    this.camera = h("select", { "aria-label": "Camera", onchange: () => this.look(this.camera.value) });
    this.boxes = h("div", { class: "choice" });
    this.predictor = h("select", { "aria-label": "Predictor of the paths", onchange: () => this._predict() });
    this.colours = h("ul", { "aria-label": "Legend" });
    this.legend = h("details", { class: "picture-legend", open: true, hidden: true }, h("summary", {}, "Legend"), this.colours);
    this.paths = h("label", { class: "row", hidden: true }, "Predictor", this.predictor);
    app.connection.on("simulator.predictor", (name) => this.predicts(name));
    document.addEventListener("theme", () => this._explain());
    this.images = new CameraPanel(app, picture);
    this.element = h("details", { open: true }, h("summary", {}, "Display"), h("div", { class: "row" }, this.view, this.camera), this.boxes, this.paths, this.images.boxes);
    this._hidden = new Set((app.address.get("hide") ?? "").split(",").filter(Boolean));
    this._extra = new Set((app.address.get("show") ?? "").split(",").filter(Boolean));
  }

  /** Lists the cameras and layers of a scene that was loaded. */
  loaded() {
    const { scene } = this.picture;
    fill(this.camera, scene.cameras().map((one) => h("option", { value: one.name, selected: one.name === scene.camera }, one.title)));
    for (const { name, visible } of scene.layers()) {
      if (visible && this._hidden.has(name)) scene.setLayer(name, false);
      if (!visible && this._extra.has(name)) scene.setLayer(name, true);
    }
    fill(this.boxes, scene.layers().map(({ name, title, visible }) => {
      const box = h("input", { type: "checkbox", checked: visible, onchange: () => this._toggle(name, box.checked) });
      return h("label", {}, box, title);
    }));
    this.images.loaded(scene.state.description);
    this._want();
  }

  /** Takes the names of the predictors. */
  know(names) {
    const chosen = this.predictor.value || this._chosen;
    fill(this.predictor, names.map((name) => h("option", { value: name, selected: name === chosen }, name)));
    this._explain();
  }

  /** Takes the predictor that the server uses. */
  predicts(name) {
    this._chosen = name;
    this.predictor.value = name;
    this._explain();
  }

  _predict() {
    return attempt(() => this.app.connection.call("simulator.predictor", { name: this.predictor.value }));
  }

  /** Shows what colours mean. */
  _explain() {
    const { scene } = this.picture;
    const shown = scene.wanted();
    const look = LOOKS[this.app.theme === "dark" ? "dark" : "light"];
    const { description } = scene.state;
    const own = description ? sceneLegend(description, scene.layers(), look) : [];
    const rows = shown.flatMap((name) => legend(name, look, this._chosen ?? "constant-velocity"));
    rows.unshift(...own);
    this.paths.hidden = !shown.includes("paths");
    this.legend.hidden = !rows.length;
    fill(this.colours, rows.map(({ color, text, width, dotted }) => {
      const mark = h("i", { "aria-hidden": "true" });
      mark.style.background = dotted ? `repeating-linear-gradient(90deg, ${color} 0 3px, transparent 3px 6px)` : color;
      mark.style.height = `${width}px`;
      return h("li", {}, mark, text);
    }));
  }

  /** Chooses a camera by its name. */
  look(name) {
    const { scene } = this.picture;
    if (!scene.cameras().some((one) => one.name === name)) return;
    scene.setCamera(name);
    this.camera.value = name;
    this.picture.wake();
    this.looked();
  }

  reset() {
    this.picture.scene.reset();
    this.camera.value = this.picture.scene.camera;
    this.picture.wake();
    this.looked();
  }

  _chooseView() {
    this.picture.setView(this.view.value);
  }

  _toggle(name, on) {
    this.picture.scene.setLayer(name, on);
    this._hidden[on ? "delete" : "add"](name);
    this._extra[on ? "add" : "delete"](name);
    this.app.remember({ hide: [...this._hidden].join(",") || null, show: [...this._extra].join(",") || null });
    this.picture.wake();
    this._want();
  }

  _want() {
    this._explain();
    this.app.connection.call("simulator.layers", { names: this.picture.scene.wanted() }).catch(() => {});
  }
}
