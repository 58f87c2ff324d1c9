// DisplayPanel: view, camera, and what the picture shows.
import { fill, h } from "../ui/dom.mjs";

export class DisplayPanel {
  constructor(app, picture) {
    this.app = app;
    this.picture = picture;
    const views = [["3d", "In space"], ["2d", "From above"]];
    this.view = h("select", { "aria-label": "View", onchange: () => this._chooseView() }, views.map(([value, text]) => h("option", { value, selected: value === picture.view }, text)));
    this.camera = h("select", { "aria-label": "Camera", onchange: () => this.look(this.camera.value) });
    this.boxes = h("div", { class: "choice" });
    this.element = h("details", { open: true }, h("summary", {}, "Display"), h("div", { class: "row" }, this.view, this.camera), this.boxes);
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
    this._want();
  }

  /** Chooses a camera by its name. */
  look(name) {
    const { scene } = this.picture;
    if (!scene.cameras().some((one) => one.name === name)) return;
    scene.setCamera(name);
    this.camera.value = name;
    this.picture.wake();
  }

  reset() {
    this.picture.scene.reset();
    this.camera.value = this.picture.scene.camera;
    this.picture.wake();
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
    this.app.connection.call("simulator.layers", { names: this.picture.scene.wanted() }).catch(() => {});
  }
}
