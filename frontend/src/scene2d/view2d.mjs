// View2D: part of the plane that a canvas shows; dragged, zoomed, or led by somebody.
const LEAST = 2;
const MOST = 400;

export class View2D {
  constructor(canvas, changed) {
    this.canvas = canvas;
    this.x = 0;
    this.y = 0;
    this.scale = 30;
    this.turn = 0;
    this._changed = changed;
    this._listeners = new AbortController();
    const listen = (type, handler, options) =>
      canvas.addEventListener(type, handler, { signal: this._listeners.signal, ...options });
    listen("pointerdown", (event) => this._press(event));
    listen("pointermove", (event) => this._drag(event));
    listen("pointerup", () => (this._from = null));
    listen("wheel", (event) => this._wheel(event), { passive: false });
    listen("keydown", (event) => this._key(event));
  }

  /** Shows a box [m]. */
  fit([x0, y0, x1, y1]) {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    this.x = 0.5 * (x0 + x1);
    this.y = 0.5 * (y0 + y1);
    this.scale = 0.96 * Math.min((width || 800) / (x1 - x0), (height || 600) / (y1 - y0));
    this.turn = 0;
  }

  /** Point of the canvas [CSS pixels] of a point of the plane [m]. */
  point(x, y) {
    const [a, b] = [x - this.x, y - this.y];
    const [c, s] = [Math.cos(this.turn), Math.sin(this.turn)];
    return [
      0.5 * this.canvas.clientWidth + this.scale * (c * a - s * b),
      0.5 * this.canvas.clientHeight - this.scale * (s * a + c * b),
    ];
  }

  /** Point of the plane [m] at a point of the canvas [CSS pixels]. */
  place(px, py) {
    const a = (px - 0.5 * this.canvas.clientWidth) / this.scale;
    const b = -(py - 0.5 * this.canvas.clientHeight) / this.scale;
    const [c, s] = [Math.cos(this.turn), Math.sin(this.turn)];
    return [this.x + c * a + s * b, this.y - s * a + c * b];
  }

  /** Sets the transform of a context to metres, y up. */
  enter(context, ratio) {
    const k = ratio * this.scale;
    const [c, s] = [Math.cos(this.turn), Math.sin(this.turn)];
    const [e, f] = this.point(0, 0);
    context.setTransform(k * c, -k * s, -k * s, -k * c, ratio * e, ratio * f);
  }

  dispose() {
    this._listeners.abort();
  }

  _press(event) {
    this._from = [event.clientX, event.clientY];
    this.canvas.setPointerCapture(event.pointerId);
  }

  _drag(event) {
    if (!this._from) return;
    const [px, py] = this._from;
    this._move(event.clientX - px, event.clientY - py);
    this._from = [event.clientX, event.clientY];
  }

  _move(dx, dy) {
    const before = this.place(0, 0);
    const after = this.place(dx, dy);
    this.x -= after[0] - before[0];
    this.y -= after[1] - before[1];
    this._changed();
  }

  _wheel(event) {
    event.preventDefault();
    const box = this.canvas.getBoundingClientRect();
    this._zoom(Math.exp(-0.0015 * event.deltaY), event.clientX - box.left, event.clientY - box.top);
  }

  _zoom(factor, px, py) {
    const before = this.place(px, py);
    this.scale = Math.min(MOST, Math.max(LEAST, this.scale * factor));
    const after = this.place(px, py);
    this.x += before[0] - after[0];
    this.y += before[1] - after[1];
    this._changed();
  }

  _key(event) {
    if (!event.shiftKey) return;
    const step = { ArrowLeft: [60, 0], ArrowRight: [-60, 0], ArrowUp: [0, 60], ArrowDown: [0, -60] }[event.key];
    const zoom = { "+": 1.25, "*": 1.25, _: 0.8 }[event.key];
    if (!step && !zoom) return;
    event.preventDefault();
    if (step) this._move(...step);
    else this._zoom(zoom, 0.5 * this.canvas.clientWidth, 0.5 * this.canvas.clientHeight);
  }
}
