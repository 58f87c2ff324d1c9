// TrialCanvas: the people and robots of the running trial from above.
import { h } from "../ui/dom.mjs";

export class TrialCanvas {
  constructor() {
    this.canvas = h("canvas", { role: "img", "aria-label": "The running trial from above" });
    this.element = h("div", { class: "trial" }, this.canvas);
    this.stage = { rings: [], goals: [] };
    this.frame = null;
    new ResizeObserver(() => this.draw()).observe(this.canvas);
  }

  setStage(stage) {
    this.stage = { rings: stage.rings ?? [], goals: stage.goals ?? [] };
    this.box = null;
    this.draw();
  }

  show(frame) {
    this.frame = frame;
    this.draw();
  }

  /** The area that has been seen so far. */
  extent() {
    const points = [...this.stage.rings.flat(), ...this.stage.goals];
    for (const name of ["people", "robots"]) {
      const rows = this.frame?.arrays[name] ?? [];
      for (let i = 0; i < rows.length; i += 4) points.push([rows[i], rows[i + 1]]);
    }
    const [a, b, c, d] = this.box ?? [Infinity, Infinity, -Infinity, -Infinity];
    const xs = points.map((one) => one[0]);
    const ys = points.map((one) => one[1]);
    this.box = [Math.min(a, ...xs), Math.min(b, ...ys), Math.max(c, ...xs), Math.max(d, ...ys)];
    return points.length ? this.box : [-5, -5, 5, 5];
  }

  draw() {
    const { canvas } = this;
    const ratio = window.devicePixelRatio || 1;
    const [w, hgt] = [canvas.clientWidth, canvas.clientHeight];
    if (!w || !hgt) return;
    canvas.width = w * ratio;
    canvas.height = hgt * ratio;
    const context = canvas.getContext("2d");
    const style = getComputedStyle(document.documentElement);
    const colour = (name) => style.getPropertyValue(name).trim();
    const [left, low, right, high] = this.extent();
    const scale = Math.min(w / (right - left + 2), hgt / (high - low + 2));
    const place = (x, y) => [w / 2 + (x - (left + right) / 2) * scale, hgt / 2 - (y - (low + high) / 2) * scale];
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.lineWidth = 2;
    context.strokeStyle = colour("--ink");
    for (const ring of this.stage.rings) {
      context.beginPath();
      ring.forEach(([x, y], i) => context[i ? "lineTo" : "moveTo"](...place(x, y)));
      context.stroke();
    }
    const disc = (x, y, radius, fill, heading) => {
      const [px, py] = place(x, y);
      context.beginPath();
      context.arc(px, py, radius * scale, 0, 2 * Math.PI);
      context.fillStyle = colour(fill);
      context.fill();
      context.beginPath();
      context.moveTo(px, py);
      context.lineTo(px + 1.6 * radius * scale * Math.cos(heading), py - 1.6 * radius * scale * Math.sin(heading));
      context.stroke();
    };
    for (const [name, fill] of [["people", "--data-1"], ["robots", "--data-2"]]) {
      const rows = this.frame?.arrays[name] ?? [];
      for (let i = 0; i < rows.length; i += 4) disc(rows[i], rows[i + 1], rows[i + 3], fill, rows[i + 2]);
    }
  }
}
