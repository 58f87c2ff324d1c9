// Scene2D: a scene seen from above, on a 2-D canvas, with the interface of Scene3D.
import { fetchMesh } from "../net/state_frame.mjs";
import { LOOKS, OWN_LAYERS } from "../scene/look.mjs";
import { SceneState } from "../scene/scene_state.mjs";
import { drawGrid, drawStage, drawZones } from "./plan.mjs";
import { drawMeasured, drawNames, drawPeople, drawRobots, OVERLAYS } from "./figures.mjs";
import { View2D } from "./view2d.mjs";

const ZOOM = 70;

export class Scene2D {
  /**
   * @param {HTMLCanvasElement} canvas
   * @param {(path: string, query?: object) => string} resource address of a mesh
   */
  constructor(canvas, resource) {
    this.canvas = canvas;
    this.state = new SceneState();
    this._resource = resource;
    this._context = canvas.getContext("2d");
    this._layers = new Map(OWN_LAYERS.filter((one) => one.name !== "shadows").map((one) => [one.name, { ...one }]));
    this._camera = "free";
    this._mark = null;
    this._frames = 0;
    this._look = LOOKS.light;
    this._theme = "light";
    this._view = new View2D(canvas, () => {
      if (this._camera !== "follow") this._camera = "free";
      this.render();
    });
  }

  /** Loads what stands still. Keeps the view if the scene has the same bounds. */
  async load(description) {
    this._bodies ??= await fetchMesh(this._resource, "bodies/2.bin");
    const moved = JSON.stringify(this.state.description?.bounds) !== JSON.stringify(description.bounds);
    this.state.describe(description, this._bodies);
    for (const { name, title } of description.layers) {
      if (!this._layers.has(name)) this._layers.set(name, { name, title, visible: name === "scans" });
    }
    if (moved) this._view.fit(description.bounds);
  }

  /** Takes a frame of the channel "scene"; false if the description must be loaded again first. */
  apply(frame) {
    return this.state.apply(frame);
  }

  layers() {
    return [...this._layers.values()].map((one) => ({ ...one }));
  }

  /** Names of the visible layers that a frame must be asked for. */
  wanted() {
    const own = new Set(OWN_LAYERS.map((one) => one.name));
    return this.layers().filter((one) => one.visible && !own.has(one.name)).map((one) => one.name);
  }

  setLayer(name, visible) {
    if (!this._layers.has(name)) throw new Error(`the scene has no layer ${name}`);
    this._layers.get(name).visible = visible;
  }

  cameras() {
    if (!this.state.description) return [];
    return [
      { name: "free", title: "Free" },
      { name: "overview", title: "Overview" },
      { name: "follow", title: "Follow" },
      ...this.state.description.robots.map((one) => ({ name: `robot:${one.name}`, title: `From ${one.name}` })),
    ];
  }

  get camera() {
    return this._camera;
  }

  /** Chooses a camera by its name; target {kind, id} is whom "follow" follows. From a robot, ahead is up. */
  setCamera(name, target = null) {
    this._camera = name;
    if (target) this._mark = target;
    this._view.turn = 0;
    if (name === "overview") this._view.fit(this.state.description.bounds);
    if (name === "follow" || name.startsWith("robot:")) this._view.scale = ZOOM;
  }

  /** Shows everything. */
  reset() {
    this._camera = "free";
    this._view.fit(this.state.description.bounds);
  }

  /** Middle x, y [m] and scale [pixel/m] of the view, for setViewpoint(). */
  viewpoint() {
    return [this._view.x, this._view.y, this._view.scale];
  }

  /** Shows a viewpoint(); other numbers are ignored. */
  setViewpoint(numbers) {
    if (numbers.length === 3 && numbers[2] > 0) [this._view.x, this._view.y, this._view.scale] = numbers;
  }

  /** Person or robot at a point of the canvas [CSS pixels], or null. */
  pick(px, py) {
    if (!this.state.frame) return null;
    const [x, y] = this._view.place(px, py);
    const { ids, place, bots, botplace } = this.state.frame.arrays;
    let best = null;
    const offer = (kind, id, cx, cy, radius) => {
      const away = Math.hypot(cx - x, cy - y) / radius;
      if (away <= 1 && (!best || away < best.away)) best = { kind, id, away };
    };
    bots.forEach((row, k) => {
      const robot = this.state.description.robots[row];
      offer("robot", robot.id, botplace[5 * k], botplace[5 * k + 1], robot.radius + 0.05);
    });
    ids.forEach((id, i) => offer("person", id, place[5 * i], place[5 * i + 1], 0.35));
    return best && { kind: best.kind, id: best.id };
  }

  /** Point x, y [m] of the floor at a point of the canvas [CSS pixels]. */
  floor(px, py) {
    const [x, y] = this._view.place(px, py);
    return { x, y };
  }

  /** Marks one person or robot; kind null marks nobody. */
  highlight(kind, id) {
    this._mark = kind === null || kind === undefined ? null : { kind, id };
  }

  setTheme(name) {
    this._theme = name === "dark" ? "dark" : "light";
    this._look = LOOKS[this._theme];
  }

  /** Draws a line between two points of the floor {x, y} [m], or none. */
  measure(points) {
    this._measured = points;
  }

  /** Numbers of the last picture, for tests and for a text beside the canvas. */
  info() {
    return {
      people: this.state.walkers,
      robots: this.state.frame ? this.state.frame.arrays.bots.length : 0,
      levels: [0, 0, 0],
      time: this.state.time,
      sequence: this.state.frame ? this.state.frame.sequence : 0,
      calls: 0,
      triangles: 0,
      frames: this._frames,
      milliseconds: this._spent ?? 0,
      camera: this._camera,
      eye: [this._view.x, this._view.y, this._view.scale],
      theme: this._theme,
    };
  }

  render() {
    const begin = performance.now();
    const ratio = this._resize();
    const { _context: context, _look: look, state } = this;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.fillStyle = look.floor;
    context.fillRect(0, 0, this.canvas.width, this.canvas.height);
    if (state.description) {
      this._lead();
      this._view.enter(context, ratio);
      const shown = (name) => this._layers.get(name)?.visible ?? false;
      const pixel = 1 / this._view.scale;
      if (shown("grid")) drawGrid(context, this._view, look, pixel);
      if (shown("zones")) drawZones(context, state.description, look, pixel);
      drawStage(context, state, look, pixel, shown("walls"), shown("props"));
      if (state.frame) this._figures(shown, pixel);
      const [from, to] = this._measured ?? [];
      if (to) drawMeasured(context, from, to, look, pixel);
    }
    this._frames += 1;
    this._spent = performance.now() - begin;
  }

  dispose() {
    this._view.dispose();
  }

  _figures(shown, pixel) {
    const { _context: context, _look: look, state } = this;
    for (const { name, under, draw } of OVERLAYS) if (under && shown(name)) draw(context, state, look, pixel);
    if (shown("robots")) drawRobots(context, state, look, pixel, this._mark);
    if (shown("people")) drawPeople(context, state, look, pixel, this._mark);
    for (const { name, under, draw } of OVERLAYS) if (!under && shown(name)) draw(context, state, look, pixel);
    drawNames(context, state, look, pixel, shown("robots"), shown("people") && shown("ids"));
  }

  /** Moves the view with the person or robot that it follows. */
  _lead() {
    const { state } = this;
    if (!state.frame || this._camera === "free" || this._camera === "overview") return;
    let target = this._mark;
    if (this._camera.startsWith("robot:")) {
      const robot = state.description.robots.find((one) => `robot:${one.name}` === this._camera);
      target = robot && { kind: "robot", id: robot.id };
    } else if (!target && state.frame.arrays.bots.length) {
      target = { kind: "robot", id: state.description.robots[state.frame.arrays.bots[0]].id };
    }
    const place = target && state.place(target.kind, target.id);
    if (!place) return;
    [this._view.x, this._view.y] = place;
    this._view.turn = this._camera === "follow" ? 0 : 0.5 * Math.PI - place[2];
  }

  _resize() {
    const ratio = Math.min(2, devicePixelRatio || 1);
    const [width, height] = [Math.round(ratio * this.canvas.clientWidth), Math.round(ratio * this.canvas.clientHeight)];
    if (width && height && (this.canvas.width !== width || this.canvas.height !== height)) {
      this.canvas.width = width;
      this.canvas.height = height;
    }
    return ratio;
  }
}
