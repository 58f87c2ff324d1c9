// ViewLink: camera, point of view and the chosen one in the address, so that a link shows the same.

const LATER = 300;
const CHOSEN = /^(person|robot)-(\d+)$/;

export class ViewLink {
  /** @param {{look(name), select(hit), chosen()}} actions chooses a camera by name, chooses {kind, id}, and returns the chosen one */
  constructor(app, picture, actions) {
    this.app = app;
    this.picture = picture;
    this.actions = actions;
    this._wanted = null;
    for (const name of ["pointerup", "wheel", "keyup"]) picture.place.addEventListener(name, () => this.note(), { passive: true });
  }

  /** Reads the address, for the scene that is loaded next. */
  read() {
    const { address } = this.app;
    const eye = (address.get("eye") ?? "").split(",").map(Number);
    const chosen = CHOSEN.exec(address.get("chosen") ?? "");
    this._wanted = {
      camera: address.get("camera"),
      eye: eye.length > 1 && eye.every(Number.isFinite) ? eye : null,
      chosen: chosen && { kind: chosen[1], id: Number(chosen[2]) },
    };
  }

  /** Shows what the address names. */
  restore() {
    if (!this._wanted) return this.note();
    const { camera, eye, chosen } = this._wanted;
    this._wanted = null;
    if (chosen) this.actions.select(chosen);
    if (camera) this.actions.look(camera);
    if (eye) this.picture.scene.setViewpoint(eye);
    this.picture.wake();
    return this.note();
  }

  /** Writes the address a moment later. */
  note() {
    clearTimeout(this._timer);
    this._timer = setTimeout(() => this._write(), LATER);
  }

  _write() {
    const { scene } = this.picture;
    if (this._wanted || !scene?.state.description || !this.picture.canvas.clientWidth) return;
    const chosen = this.actions.chosen();
    this.app.remember({
      camera: scene.camera,
      eye: scene.viewpoint().map((one) => Number(one.toFixed(2))).join(","),
      chosen: chosen && `${chosen.kind}-${chosen.id}`,
    });
  }
}
