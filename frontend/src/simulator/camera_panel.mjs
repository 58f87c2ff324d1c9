// CameraPanel: chooses images of camera sensors in the display list, and shows them over the picture as they come.
import { ImageFigures } from "../scene/image_figures.mjs";
import { fill, h } from "../ui/dom.mjs";

export class CameraPanel {
  constructor(app, picture) {
    this.picture = picture;
    this.app = app;
    this.figures = new ImageFigures((name) => this._toggle(name, false));
    this.boxes = h("fieldset", { class: "choice cameras", hidden: true });
    this._images = [];
    this._revision = null;
    const words = (app.address.get("images") ?? "").split(",").filter(Boolean);
    this._chosen = new Set(words);
    this._asked = words.length > 0;
    picture.element.append(this.figures.element);
    app.connection.on("simulator.cameras", (names) => this.take(names));
  }

  /** Takes the names that the server sends; those of the address come first when the page opens. */
  take(names) {
    if (this._asked) {
      this._asked = false;
      this._ask();
      return;
    }
    this._chosen = new Set(names);
    this._remember();
    this._show();
  }

  /** Takes a description that was loaded. */
  loaded({ images = [], revision }) {
    this._images = images;
    this._revision = revision;
    images.forEach((one, number) => this.app.connection.draw(`cam${number}`, (frame) => this._draw(one.name, frame), () => this.picture.visible));
    this._show();
  }

  _show() {
    this.boxes.hidden = !this._images.length;
    const focus = this.boxes.contains(document.activeElement) ? document.activeElement.name : null;
    fill(this.boxes, h("legend", {}, "Camera images"), this._images.map(({ name, title, rate }) => {
      const box = h("input", { type: "checkbox", name, checked: this._chosen.has(name), onchange: () => this._toggle(name, box.checked) });
      return h("label", { title: `${rate} Hz` }, box, title);
    }));
    if (focus) [...this.boxes.querySelectorAll("input")].find((one) => one.name === focus)?.focus();
    this.figures.show(this._images.filter((one) => this._chosen.has(one.name)));
  }

  _toggle(name, on) {
    this._chosen[on ? "add" : "delete"](name);
    this._remember();
    this._show();
    this._ask();
  }

  _remember() {
    this.app.remember({ images: [...this._chosen].join(",") || null });
  }

  _ask() {
    this.app.connection.call("simulator.cameras", { names: [...this._chosen] }).catch(() => {});
  }

  _draw(name, { arrays, time }) {
    const figure = this.figures.figure(name);
    if (!figure || arrays.revision[0] !== this._revision) return undefined;
    return arrays.jpeg ? figure.draw(arrays.jpeg, "image/jpeg", time) : figure.draw(arrays.png, "image/png", time);
  }
}
