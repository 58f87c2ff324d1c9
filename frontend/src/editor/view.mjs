// EditorView: the trial from above on a canvas: pan, zoom, grid, snapping, drawing, dragging.
import { drawWays, legDistance, moveWay, nearestLeg, waysOf } from "./journeys.mjs";
import { areaChanges, cornerChanges, extent, moveChanges, plain, shapesOf } from "./shapes.mjs";
import { same } from "./model.mjs";
import { clicks, finish, rectangle } from "./tools.mjs";

const STYLES = {
  ground: { fill: "--panel", stroke: "--line", dash: [] },
  wall: { stroke: "--ink", width: 3, dash: [] },
  solid: { fill: "--line", stroke: "--ink", dash: [] },
  prop: { fill: "--line", stroke: "--faint", dash: [] },
  door: { stroke: "--data-5", width: 4, dash: [] },
  people: { stroke: "--data-1", dash: [] },
  goal: { stroke: "--data-3", dash: [6, 4] },
  target: { stroke: "--data-3", dash: [2, 3] },
  exit: { stroke: "--data-4", dash: [10, 4] },
  person: { fill: "--data-1", stroke: "--ink", dash: [] },
  robot: { fill: "--data-2", stroke: "--ink", dash: [] },
  camera: { stroke: "--data-4", dash: [] },
  light: { fill: "--data-5", stroke: "--ink", dash: [] },
};
const REACH = 9;
/** Shortest line [pixels] whose length is written beside it. */
const LEGIBLE = 30;

export class EditorView {
  /** @param {(text: string) => void} tell shows dimensions and what to do next */
  constructor(canvas, model, tell) {
    Object.assign(this, { canvas, model, tell, tool: null, points: [], pointer: null, drag: null, snap: 0.1 });
    this.scale = 30;
    this.origin = [0, 0];
    this.shapes = [];
    this.ways = [];
    this.fitted = false;
    new ResizeObserver(() => this.resize()).observe(canvas);
    canvas.addEventListener("pointerdown", (event) => this.press(event));
    canvas.addEventListener("pointermove", (event) => this.move(event));
    canvas.addEventListener("pointerup", (event) => this.release(event));
    canvas.addEventListener("dblclick", (event) => (this.tool ? this.end() : this.addStop(this.place(event))));
    canvas.addEventListener("wheel", (event) => this.zoom(event), { passive: false });
    document.addEventListener("theme", () => this.draw());
  }

  /** Takes the shapes of the present trial. */
  update() {
    const { tree } = this.model.state;
    this.shapes = tree ? shapesOf(tree) : this.shapes;
    this.ways = tree ? waysOf(tree) : this.ways;
    if (!this.fitted && this.canvas.clientWidth) this.fit();
    this.draw();
  }

  fit() {
    const [left, low, right, high] = extent([...this.shapes, ...this.model.state.rings.map((points) => ({ points }))]);
    const { clientWidth: w, clientHeight: h } = this.canvas;
    this.scale = Math.min(w / (right - left), h / (high - low), 200);
    this.origin = [w / 2 - ((left + right) / 2) * this.scale, h / 2 + ((low + high) / 2) * this.scale];
    this.fitted = true;
    this.moved = false;
    this.draw();
  }

  resize() {
    const ratio = window.devicePixelRatio || 1;
    this.canvas.width = Math.round(this.canvas.clientWidth * ratio);
    this.canvas.height = Math.round(this.canvas.clientHeight * ratio);
    if (this.model.state && (!this.fitted || !this.moved)) this.fit();
    else this.draw();
  }

  use(tool) {
    this.tool = tool;
    this.points = [];
    this.draw();
  }

  pixel([x, y]) {
    return [this.origin[0] + x * this.scale, this.origin[1] - y * this.scale];
  }

  place(event) {
    const bounds = this.canvas.getBoundingClientRect();
    const [px, py] = [event.clientX - bounds.left, event.clientY - bounds.top];
    return [(px - this.origin[0]) / this.scale, (this.origin[1] - py) / this.scale];
  }

  /** The nearest corner of another shape, or the nearest point of the grid. */
  snapped([x, y], without = null) {
    const near = REACH / this.scale;
    for (const shape of this.shapes) {
      if (without && same(shape.path, without)) continue;
      const corner = shape.points.find((one) => Math.hypot(one[0] - x, one[1] - y) < near);
      if (corner && shape.style !== "target") return corner;
    }
    return this.snap ? [x, y].map((one) => Math.round(one / this.snap) * this.snap) : [x, y];
  }

  press(event) {
    if (!this.model.state?.tree) return;
    this.canvas.setPointerCapture(event.pointerId);
    const at = this.place(event);
    if (event.button === 1 || event.button === 2) {
      this.drag = { kind: "pan", from: [event.clientX, event.clientY], origin: this.origin };
    } else if (this.tool) {
      this.points.push(this.snapped(at));
      if (this.points.length >= clicks(this.tool)) this.end();
    } else if (event.shiftKey && !this.grab(at)) {
      this.drag = { kind: "band", from: at, at };
    } else {
      this.drag = this.grab(at) ?? { kind: "pan", from: [event.clientX, event.clientY], origin: this.origin };
      if (this.drag.shape) {
        const more = event.shiftKey ? this.model.chosen.filter((one) => !same(one, this.drag.shape.path)) : [];
        this.model.choose([...more, this.drag.shape.path]);
      } else this.model.choose([]);
    }
    this.draw();
  }

  /** What is under a point: a corner of a chosen shape, or a shape. */
  grab(at) {
    const near = REACH / this.scale;
    for (const shape of this.shapes) {
      if (!this.isChosen(shape) || !shape.attribute) continue;
      const index = shape.points.findIndex((one) => Math.hypot(one[0] - at[0], one[1] - at[1]) < near);
      if (index >= 0) return { kind: "corner", shape, index, from: at, at };
    }
    for (const shape of [...this.shapes].reverse()) {
      if (this.touches(shape, at, near)) return { kind: "move", shape, from: at, at };
    }
    for (const { path, stops } of this.ways) {
      const hit = stops.some(([, place], i) => i && legDistance(at, stops[i - 1][1], place) < near);
      if (hit) return { kind: "move", shape: { path, points: [] }, from: at, at };
    }
    return null;
  }

  /** Puts a stop into the leg of a way at a place. */
  async addStop(at) {
    const leg = nearestLeg(this.ways, at, this.scale);
    if (!leg) return;
    const [x, y] = this.snapped(at);
    await this.model.edit("insert", { path: leg.path, xml: `<point x="${plain(x)}" y="${plain(y)}"/>`, position: leg.position });
    this.model.choose([[...leg.path, leg.position]]);
  }

  /** Chooses the single elements inside a rectangle. */
  chooseInside([ax, ay], [bx, by]) {
    const within = ([x, y]) => (x - ax) * (x - bx) <= 0 && (y - ay) * (y - by) <= 0;
    const found = this.shapes.filter((shape) => shape.centre && shape.path.length === 1 && within(shape.centre));
    this.model.choose(found.map((shape) => shape.path));
  }

  touches(shape, [x, y], near) {
    if (shape.radius) return Math.hypot(shape.centre[0] - x, shape.centre[1] - y) < Math.max(shape.radius, near);
    const ends = shape.closed ? [...shape.points, shape.points[0]] : shape.points;
    for (let i = 1; i < ends.length; i++) if (legDistance([x, y], ends[i - 1], ends[i]) < near) return true;
    if (ends.length === 1) return Math.hypot(ends[0][0] - x, ends[0][1] - y) < near;
    return shape.closed && shape.style !== "ground" && inside([x, y], shape.points);
  }

  isChosen(shape) {
    return this.model.chosen.some((path) => same(path, shape.path));
  }

  move(event) {
    if (!this.model.state?.tree) return;
    const at = this.place(event);
    this.pointer = this.snapped(at, this.drag?.shape?.path);
    if (this.drag?.kind === "pan") {
      const [x, y] = this.drag.from;
      this.moved = true;
      this.origin = [this.drag.origin[0] + event.clientX - x, this.drag.origin[1] + event.clientY - y];
    } else if (this.drag) this.drag.at = this.drag.kind === "corner" ? this.pointer : at;
    this.tell(this.words());
    this.draw();
  }

  /** Dimensions of what is drawn or moved. */
  words() {
    const last = this.points.at(-1);
    if (this.tool && last) {
      const [dx, dy] = [this.pointer[0] - last[0], this.pointer[1] - last[1]];
      const area = this.tool.mode.includes("area") && this.points.length % 2;
      return area ? `${plain(Math.abs(dx))} m x ${plain(Math.abs(dy))} m` : `${plain(Math.hypot(dx, dy))} m`;
    }
    if (this.drag?.kind === "band") return "Choose the people and robots in this rectangle";
    if (this.drag?.shape) return `moved by ${this.offset().map(plain).join(", ")} m`;
    return `x ${plain(this.pointer[0])} m, y ${plain(this.pointer[1])} m`;
  }

  offset() {
    const raw = [this.drag.at[0] - this.drag.from[0], this.drag.at[1] - this.drag.from[1]];
    return this.snap && this.drag.kind === "move" ? raw.map((one) => Math.round(one / this.snap) * this.snap) : raw;
  }

  async release() {
    const drag = this.drag;
    this.drag = null;
    if (drag?.kind === "band") this.chooseInside(drag.from, drag.at);
    if (!drag?.shape) return;
    this.drag = drag;
    const [dx, dy] = this.offset();
    this.drag = null;
    if (!dx && !dy) return this.draw();
    await this.model.edit("change", { changes: this.changes(drag, dx, dy) });
    this.draw();
  }

  changes({ kind, shape, index, at }, dx, dy) {
    const node = this.model.node(shape.path);
    if (kind === "corner") return cornerChanges(node, shape.path, shape.attribute, index, at);
    const others = this.model.chosen.length > 1 && this.isChosen(shape);
    if (others) return this.model.chosen.flatMap((path) => moveChanges(this.model.node(path), path, dx, dy));
    if (node.tag === "journey") return moveWay(node, shape.path, dx, dy);
    if (shape.attribute) return areaChanges(node, shape.path, shape.attribute, dx, dy);
    return moveChanges(node, shape.path, dx, dy);
  }

  /** Ends a drawing; a line needs two corners. */
  async end() {
    const { tool, points } = this;
    if (!tool) return;
    const kept = points.filter((one, i) => i === 0 || Math.hypot(one[0] - points[i - 1][0], one[1] - points[i - 1][1]) > 1e-9);
    const enough = tool.mode === "line" ? kept.length >= (tool.least ?? 2) : points.length >= clicks(tool);
    if (!enough) return;
    this.points = [];
    await finish(tool, tool.mode === "line" ? kept : points, this.model);
  }

  cancel() {
    this.points = [];
    this.draw();
  }

  zoom(event) {
    event.preventDefault();
    const at = this.place(event);
    const before = this.pixel(at);
    this.scale = Math.min(400, Math.max(1, this.scale * Math.exp(-event.deltaY / 600)));
    const after = this.pixel(at);
    this.moved = true;
    this.origin = [this.origin[0] + before[0] - after[0], this.origin[1] + before[1] - after[1]];
    this.draw();
  }

  draw() {
    const context = this.canvas.getContext("2d");
    const style = getComputedStyle(document.documentElement);
    this.colour = (name) => style.getPropertyValue(name).trim();
    const ratio = window.devicePixelRatio || 1;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, this.canvas.clientWidth, this.canvas.clientHeight);
    const step = this.drawGrid(context);
    for (const ring of this.model.state?.rings ?? []) this.line(context, ring, true, STYLES.solid);
    for (const shape of this.shapes) this.drawShape(context, shape);
    drawWays(context, this.ways, { pixel: (one) => this.pixel(one), colour: this.colour, chosen: this.model.chosen });
    this.drawPeople(context);
    this.drawPoints(context);
    this.drawScale(context, step);
    if (!this.shapes.length && !this.points.length) this.drawHint(context);
    if (this.drag?.kind === "band") this.line(context, rectangle(this.drag.from, this.drag.at), true, { stroke: "--focus", dash: [4, 3] });
  }

  /** Tells a new user how to begin. */
  drawHint(context) {
    context.font = "15px system-ui, sans-serif";
    context.textAlign = "center";
    context.fillStyle = this.colour("--faint");
    const lines = ["Choose a tool above and click into the plan,", "or press Open to start with a built-in trial."];
    const { clientWidth: width, clientHeight: height } = this.canvas;
    lines.forEach((text, k) => context.fillText(text, width / 2, height / 2 + 22 * (k - 0.5)));
    context.textAlign = "start";
  }

  drawGrid(context) {
    const step = [0.1, 0.5, 1, 5, 10, 50].find((one) => one * this.scale >= 18) ?? 100;
    context.strokeStyle = this.colour("--line");
    context.globalAlpha = 0.35;
    context.lineWidth = 1;
    context.beginPath();
    const { clientWidth: w, clientHeight: h } = this.canvas;
    for (let x = this.origin[0] % (step * this.scale); x < w; x += step * this.scale) context.rect(x, 0, 0, h);
    for (let y = this.origin[1] % (step * this.scale); y < h; y += step * this.scale) context.rect(0, y, w, 0);
    context.stroke();
    context.globalAlpha = 1;
    return step;
  }

  /** Shows the length of a cell of the grid. */
  drawScale(context, step) {
    const [x, y, size] = [14, this.canvas.clientHeight - 14, step * this.scale];
    context.strokeStyle = context.fillStyle = this.colour("--ink");
    context.lineWidth = 1.5;
    context.beginPath();
    context.moveTo(x, y - 5);
    context.lineTo(x, y);
    context.lineTo(x + size, y);
    context.lineTo(x + size, y - 5);
    context.stroke();
    context.font = "12px system-ui, sans-serif";
    context.fillText(`${step} m`, x + size + 6, y + 1);
  }

  drawShape(context, shape) {
    const chosen = this.isChosen(shape);
    const wrong = this.model.state.problems.some((one) => one.path && same(one.path, shape.path));
    const style = { ...STYLES[shape.style] };
    if (wrong) style.stroke = "--danger";
    if (chosen) Object.assign(style, { width: (style.width ?? 1.5) + 2, stroke: wrong ? "--danger" : "--focus" });
    const [dx, dy] = chosen && this.drag?.kind === "move" ? this.offset() : [0, 0];
    if (shape.radius) {
      this.disc(context, [shape.centre[0] + dx, shape.centre[1] + dy], shape, style);
      return;
    }
    const points = shape.points.map(([x, y]) => [x + dx, y + dy]);
    if (this.drag?.kind === "corner" && this.drag.shape === shape) points[this.drag.index] = this.drag.at;
    this.line(context, points, shape.closed, style);
    if (chosen && shape.attribute) for (const one of points) this.handle(context, one);
    if (chosen && shape.style === "wall") this.drawLengths(context, points);
  }

  line(context, points, closed, style) {
    context.beginPath();
    points.forEach((one, i) => context[i ? "lineTo" : "moveTo"](...this.pixel(one)));
    if (closed) context.closePath();
    this.paint(context, style, closed);
    if (points.length === 1) this.handle(context, points[0]);
  }

  disc(context, centre, shape, style) {
    const [x, y] = this.pixel(centre);
    const radius = Math.max(shape.radius * this.scale, 4);
    context.beginPath();
    context.arc(x, y, radius, 0, 2 * Math.PI);
    this.paint(context, style, true);
    if (shape.heading === null) return;
    context.beginPath();
    context.moveTo(x, y);
    context.lineTo(x + 2 * radius * Math.cos(shape.heading), y - 2 * radius * Math.sin(shape.heading));
    context.stroke();
  }

  paint(context, style, closed) {
    context.setLineDash(style.dash ?? []);
    context.lineWidth = style.width ?? 1.5;
    context.strokeStyle = this.colour(style.stroke);
    if (closed && style.fill) {
      context.fillStyle = this.colour(style.fill);
      context.globalAlpha = 0.7;
      context.fill();
      context.globalAlpha = 1;
    }
    context.stroke();
    context.setLineDash([]);
  }

  handle(context, point) {
    const [x, y] = this.pixel(point);
    context.fillStyle = this.colour("--focus");
    context.fillRect(x - 4, y - 4, 8, 8);
  }

  drawPeople(context) {
    const people = this.model.people;
    if (!people) return;
    context.globalAlpha = 0.6;
    for (const way of people.ways) this.line(context, way, false, { stroke: "--data-3", width: 1, dash: [3, 3] });
    people.people.forEach((centre, i) =>
      this.disc(context, centre, { radius: people.radii[i], heading: null }, { fill: "--data-1", stroke: "--ink" }),
    );
    context.globalAlpha = 1;
  }

  drawPoints(context) {
    if (!this.tool || !this.pointer) return;
    const style = { stroke: "--focus", width: 2, dash: [4, 3] };
    const all = [...this.points, this.pointer];
    if (!this.tool.mode.includes("area")) {
      this.line(context, all, false, style);
      this.drawLengths(context, all);
      return;
    }
    for (let i = 0; i < all.length; i += 2) {
      if (!all[i + 1]) continue;
      const corners = rectangle(all[i], all[i + 1]);
      this.line(context, corners, true, style);
      this.drawLengths(context, corners.slice(0, 3));
    }
  }

  /** Writes the length of each leg of a line beside its middle. */
  drawLengths(context, points) {
    context.font = "12px system-ui, sans-serif";
    context.textAlign = "center";
    context.lineWidth = 4;
    context.strokeStyle = this.colour("--paper");
    context.fillStyle = this.colour("--ink");
    for (let i = 1; i < points.length; i++) {
      const [[ax, ay], [bx, by]] = [points[i - 1], points[i]];
      const length = Math.hypot(bx - ax, by - ay);
      if (length * this.scale < LEGIBLE) continue;
      const [x, y] = this.pixel([(ax + bx) / 2, (ay + by) / 2]);
      context.strokeText(`${plain(length)} m`, x, y - 6);
      context.fillText(`${plain(length)} m`, x, y - 6);
    }
    context.textAlign = "start";
  }
}

function inside([x, y], points) {
  let odd = false;
  for (let i = 0, j = points.length - 1; i < points.length; j = i++) {
    const [[ax, ay], [bx, by]] = [points[i], points[j]];
    if (ay > y !== by > y && x < ((bx - ax) * (y - ay)) / (by - ay) + ax) odd = !odd;
  }
  return odd;
}
