// Scene3D: a scene in space. Frames are applied as they come; render() draws the newest.
import * as THREE from "three";
import { fetchMesh } from "../net/state_frame.mjs";
import { LOOKS, OWN_LAYERS } from "../scene/look.mjs";
import { SceneState } from "../scene/scene_state.mjs";
import { Crowd, LEVELS } from "./crowd.mjs";
import { overlays } from "./overlays.mjs";
import { Robots } from "./robots.mjs";
import { Stage } from "./stage.mjs";
import { readTextures } from "./textures.mjs";
import { Views } from "./views.mjs";

const SUN = new THREE.Vector3(-0.42, -0.55, 1);
const SHADED = 22;
const SHADOW_PIXELS = 2048;
/** Time [ms] above which a picture is one without a graphics card: it holds up the page, which then gets a share of it. */
const SLOW = 100;
const BREATH = 0.5;
/** Of such pictures, while a scene is sparing: the resolution, and the pauses after each. */
const COARSE = 0.5;
const PAUSE = 3;
const LONGEST_PAUSE = 1000;

export class Scene3D {
  /**
   * @param {HTMLCanvasElement} canvas
   * @param {(path: string, query?: object) => string} resource address of a mesh, such as "bodies/1.bin"
   */
  constructor(canvas, resource) {
    this.canvas = canvas;
    this.state = new SceneState();
    this._resource = resource;
    this._renderer = new THREE.WebGLRenderer({ canvas, antialias: true, powerPreference: "high-performance" });
    this._renderer.shadowMap.enabled = true;
    this._renderer.shadowMap.type = THREE.PCFShadowMap;
    this._renderer.info.autoReset = false;
    this._scene = new THREE.Scene();
    this._views = new Views(canvas);
    this._layers = new Map(OWN_LAYERS.map((one) => [one.name, { ...one }]));
    this._marked = new Map();
    this._frames = this._applied = this._work = 0;
    this._empty = false;
    this._sparing = this._coarse = this._slow = false;
    this._timed = this._resting = 0;
    this._theme = "light";
    this._build();
    this.setTheme(this._theme);
  }

  /** Loads what stands still: meshes, walls, robots. Keeps the camera if the scene has the same bounds. */
  async load(description) {
    const bodies = this._bodies ?? Promise.all([...Array(LEVELS).keys()].map((level) => fetchMesh(this._resource, `bodies/${level}.bin`)));
    this._bodies = bodies;
    bodies.catch(() => (this._bodies = null));
    const meshes = new Map();
    const robots = description.robots.map(async (one) => {
      const mesh = await fetchMesh(this._resource, one.mesh, { key: one.key });
      meshes.set(one.key, { arrays: mesh.arrays, textures: await readTextures(mesh) });
    });
    const [levels] = await Promise.all([bodies, ...robots]);
    if (!this._crowd) {
      this._crowd = new Crowd(levels);
      this._scene.add(this._crowd.group);
    }
    const moved = JSON.stringify(this.state.description?.bounds) !== JSON.stringify(description.bounds);
    this.state.describe(description, levels[LEVELS - 1]);
    this._crowd.dress(description.people, description.regions.length);
    this._robots.build(description.robots, meshes);
    this._stage.build(description, this._look);
    for (const { name, title } of description.layers) {
      if (!this._layers.has(name)) this._layers.set(name, { name, title, visible: name === "scans" });
    }
    this._showLayers();
    this._resize();
    if (moved) {
      this._views.overview(description);
      if (this._views.name === "free" && description.robots.length) this._views.choose("beside", description, null);
    }
  }

  /** Takes a frame of the channel "scene"; false if the description must be loaded again first. */
  apply(frame) {
    const begin = performance.now();
    if (!this.state.apply(frame)) return false;
    this._crowd.update(this.state, new Set(this._marks("person")), this._markColor, this._look.shade);
    this._robots.update(this.state, this._hidden("robot"));
    this._stage.update(frame.arrays);
    for (const [name, one] of Object.entries(this._overlays)) {
      if (one.object.visible) one.update(this.state, this._look, name);
    }
    this._applied = performance.now() - begin;
    return true;
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
    this._showLayers();
  }

  cameras() {
    return this.state.description ? this._views.list(this.state.description) : [];
  }

  get camera() {
    return this._views.name;
  }

  /** Chooses a camera by its name; target {kind, id} is whom "follow" follows. */
  setCamera(name, target = null) {
    this._views.choose(name, this.state.description, target);
    this._stage.full = name === "follow" || this._views.firstPerson;
    if (this.state.frame) this._robots.update(this.state, this._hidden("robot"));
  }

  /** Shows everything with the free camera. */
  reset() {
    this.setCamera("free");
    this._views.overview(this.state.description);
  }

  /** Where the camera is, as numbers for setViewpoint(). */
  viewpoint() {
    return this._views.viewpoint();
  }

  /** Moves the camera to a viewpoint() of the same camera. */
  setViewpoint(numbers) {
    this._views.setViewpoint(numbers);
  }

  /** Person or robot at a point of the canvas [CSS pixels], or null. */
  pick(x, y) {
    if (!this.state.frame) return null;
    const { clientWidth, clientHeight } = this.canvas;
    const ray = new THREE.Raycaster();
    ray.setFromCamera(new THREE.Vector2((2 * x) / clientWidth - 1, 1 - (2 * y) / clientHeight), this._views.camera);
    let best = null;
    for (const one of this._targets()) {
      const from = new THREE.Vector3(one.x, one.y, one.z);
      const to = new THREE.Vector3(one.x, one.y, one.z + one.height);
      const hit = new THREE.Vector3();
      if (ray.ray.distanceSqToSegment(from, to, hit) > one.radius ** 2) continue;
      const away = hit.distanceTo(ray.ray.origin);
      if (!best || away < best.away) best = { kind: one.kind, id: one.id, away };
    }
    return best && { kind: best.kind, id: best.id };
  }

  /** Point x, y [m] of the floor at a point of the canvas [CSS pixels], or null. */
  floor(x, y) {
    const { clientWidth, clientHeight } = this.canvas;
    const ray = new THREE.Raycaster();
    ray.setFromCamera(new THREE.Vector2((2 * x) / clientWidth - 1, 1 - (2 * y) / clientHeight), this._views.camera);
    const hit = ray.ray.intersectPlane(new THREE.Plane(new THREE.Vector3(0, 0, 1), 0), new THREE.Vector3());
    return hit && { x: hit.x, y: hit.y };
  }

  /** Marks one person or robot, which the follow camera then follows; kind null marks nobody. */
  highlight(kind, id) {
    this._marked = new Map(kind === null || kind === undefined ? [] : [[`${kind} ${id}`, { kind, id }]]);
    this._views.target = this._marked.size ? { kind, id } : null;
    if (this.state.frame) this.apply(this.state.frame);
  }

  /** Draws a line between two points of the floor {x, y} [m], or none. */
  measure(points) {
    this._measured.geometry.dispose();
    this._measured.geometry = new THREE.BufferGeometry().setFromPoints(points.map(({ x, y }) => new THREE.Vector3(x, y, 0.03)));
    this._measured.visible = points.length === 2;
  }

  setTheme(name) {
    this._theme = name === "dark" ? "dark" : "light";
    this._look = LOOKS[this._theme];
    this._markColor = new THREE.Color(this._look.mark);
    this._scene.background = new THREE.Color(this._look.sky);
    this._scene.fog = new THREE.Fog(this._look.sky, 45, 170);
    this._sun.intensity = this._look.sun;
    this._dome.intensity = this._look.dome;
    for (const one of [this._ring, this._measured]) one.material.color.set(this._look.mark);
    if (!this.state.description) return;
    this._stage.build(this.state.description, this._look);
    this._showLayers();
    if (this.state.frame) this.apply(this.state.frame);
  }

  /** Numbers of the last picture, for tests and for a text beside the canvas. */
  info() {
    const { render, memory } = this._renderer.info;
    const { position } = this._views.camera;
    return {
      people: this.state.walkers,
      robots: this.state.frame ? this.state.frame.arrays.bots.length : 0,
      levels: this._crowd ? [...this._crowd.counts] : [0, 0, 0],
      time: this.state.time,
      sequence: this.state.frame ? this.state.frame.sequence : 0,
      calls: render.calls,
      triangles: render.triangles,
      geometries: memory.geometries,
      textures: memory.textures,
      frames: this._frames,
      milliseconds: this._spent,
      work: this._work,
      camera: this._views.name,
      eye: [position.x, position.y, position.z],
      theme: this._theme,
    };
  }

  render() {
    const begin = performance.now();
    this._resize();
    this._views.update(this.state);
    this._crowd?.choose(this._views.camera, this._renderer.domElement.height, this._hidden("person"));
    this._light();
    this._mark();
    this._renderer.info.reset();
    this._work = this._applied + performance.now() - begin; // without the calls that draw
    this._applied = 0;
    this._renderer.render(this._scene, this._views.camera);
    this._frames += 1;
    this._spent = performance.now() - begin;
    if (!this._fence) this._time(begin);
  }

  /**
   * Whether others need the processor, such as a compiler. Where no graphics card draws, pictures are then coarse, and
   * "rests" asks for pauses between them.
   */
  set sparing(sparing) {
    if (sparing === this._sparing) return;
    this._sparing = sparing;
    this._coarse = false;
    this._timed = this._resting = 0;
    this._forgetTime();
  }

  /**
   * Whether the page comes first, where no graphics card draws: the picture before is not finished, or has just held up
   * clicks and messages. Also until the first two pictures have told how long they take.
   */
  get busy() {
    this._noteTime();
    const pending = Boolean(this._fence) && (this._slow || this._timed < 2);
    return pending || (this._slow && performance.now() < this._resting);
  }

  /** Whether no picture may be drawn now: the one before is not finished, or a pause follows it. */
  get rests() {
    this._noteTime();
    return this._sparing && (Boolean(this._fence) || performance.now() < this._resting);
  }

  /** Notes the time of the latest picture if it is finished. */
  _noteTime() {
    const gl = this._renderer.getContext();
    if (!this._fence || gl.getSyncParameter(this._fence, gl.SYNC_STATUS) === gl.UNSIGNALED) return;
    this._forgetTime();
    const now = performance.now();
    const cost = now - this._begun;
    this._slow = this._timed > 0 && cost > SLOW; // the first picture compiles shaders
    this._coarse ||= this._sparing && this._slow;
    this._timed += 1;
    this._resting = now + Math.min(LONGEST_PAUSE, (this._coarse ? PAUSE : this._slow ? BREATH : 0) * cost);
  }

  /** Renderer and scene, for who draws with a camera of his own, such as a headset. */
  get engine() {
    return { renderer: this._renderer, scene: this._scene };
  }

  /** Whether only the floor is drawn, without walls, things, people and robots. */
  get empty() {
    return this._empty;
  }

  set empty(value) {
    if (value === this._empty) return;
    this._empty = value;
    this._showLayers();
  }

  /** Runs a function that draws everybody with a head, as a mirror shows them. */
  withHeads(draw) {
    if (this._crowd) this._crowd.withHeads(draw);
    else draw();
  }

  /**
   * Draws with the camera of a headset whose eyes are at a point.
   * @param {number|null} own id of the person in whose head the camera is
   * @param {boolean} body whether the body of this person is drawn, without neck and head
   */
  renderFrom(camera, eye, own, body) {
    const begin = performance.now();
    this._stage.full = true;
    this._views.camera.position.copy(eye);
    this._views.controls.target.set(eye.x, eye.y, 0);
    this._crowd?.choose({ position: eye, fov: 90 }, 2000, body ? null : own, body ? own : null);
    this._light();
    this._mark();
    this._renderer.info.reset();
    this._renderer.render(this._scene, camera);
    this._frames += 1;
    this._spent = performance.now() - begin;
  }

  dispose() {
    this._views.dispose();
    this._crowd?.dispose();
    this._robots.dispose();
    this._stage.dispose();
    this._renderer.dispose();
  }

  _build() {
    this._sun = new THREE.DirectionalLight("#fff8ef", 2);
    this._sun.castShadow = true;
    this._sun.shadow.mapSize.set(SHADOW_PIXELS, SHADOW_PIXELS);
    this._sun.shadow.bias = -0.0006;
    this._sun.shadow.normalBias = 0.03;
    this._sun.shadow.radius = 4;
    this._dome = new THREE.HemisphereLight("#f6f9ff", "#b9bcc0", 1.4);
    this._stage = new Stage();
    this._robots = new Robots();
    this._overlays = overlays();
    this._ring = new THREE.Mesh(new THREE.RingGeometry(0.85, 1, 56), new THREE.MeshBasicMaterial({ depthTest: false, transparent: true, opacity: 0.95 }));
    this._ring.visible = false;
    this._measured = new THREE.Line(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ depthTest: false, transparent: true }));
    this._measured.visible = this._measured.frustumCulled = false;
    this._measured.renderOrder = 1;
    this._scene.add(this._sun, this._sun.target, this._dome, this._stage.group, this._robots.group, this._ring, this._measured);
    for (const one of Object.values(this._overlays)) this._scene.add(one.object);
  }

  /** Notes when a picture began, and how its end is noticed: its calls return before it is drawn. */
  _time(begin) {
    const gl = this._renderer.getContext();
    this._forgetTime();
    this._begun = begin;
    this._fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
    gl.flush();
  }

  _forgetTime() {
    if (this._fence) this._renderer.getContext().deleteSync(this._fence);
    this._fence = null;
  }

  /** Id of the person or robot in whose head the camera is, or null. */
  _hidden(kind) {
    const one = this._views.head(this.state);
    return one?.kind === kind ? one.id : null;
  }

  _marks(kind) {
    return [...this._marked.values()].filter((one) => one.kind === kind).map((one) => one.id);
  }

  _mark() {
    const [one] = this._marked.values();
    const place = one && this.state.place(one.kind, one.id);
    this._ring.visible = Boolean(place) && this._hidden(one.kind) !== one.id;
    if (!place) return;
    const radius = one.kind === "robot" ? this.state.description.robots.find((bot) => bot.id === one.id).radius + 0.12 : 0.42;
    this._ring.position.set(place[0], place[1], 0.02);
    this._ring.scale.setScalar(radius);
  }

  _targets() {
    const { ids, pelvis, bots, botplace } = this.state.frame.arrays;
    const people = Array.from(ids, (id, i) => ({
      kind: "person", id, x: pelvis[3 * i], y: pelvis[3 * i + 1], z: pelvis[3 * i + 2] - 0.9, height: this.state.height("person", id), radius: 0.3,
    }));
    const robots = Array.from(bots, (row, k) => {
      const { id, radius, height } = this.state.description.robots[row];
      return { kind: "robot", id, x: botplace[5 * k], y: botplace[5 * k + 1], z: 0, height, radius };
    });
    return [...robots, ...people];
  }

  _showLayers() {
    const shown = (name) => !this._empty && (this._layers.get(name)?.visible ?? false);
    for (const name of ["walls", "props", "zones"]) this._stage.parts[name].visible = shown(name);
    this._stage.grid = shown("grid");
    this._robots.group.visible = shown("robots");
    for (const [name, one] of Object.entries(this._overlays)) one.object.visible = shown(name);
    if (this._crowd) {
      this._crowd.group.visible = shown("people");
      this._crowd.shadows = shown("shadows");
    }
    this._stage.shadows = this._robots.shadows = this._sun.castShadow = shown("shadows");
  }

  _light() {
    const middle = this._views.controls.target;
    const eye = this._views.camera.position;
    const reach = Math.min(SHADED, Math.max(7, 0.75 * eye.distanceTo(middle)));
    const around = this._views.firstPerson ? eye : middle;
    const shadow = this._sun.shadow.camera;
    shadow.left = shadow.bottom = -reach;
    shadow.right = shadow.top = reach;
    shadow.near = 1;
    shadow.far = 4 * SHADED;
    shadow.updateProjectionMatrix();
    const step = (2 * reach) / SHADOW_PIXELS;
    this._sun.target.position.set(step * Math.round(around.x / step), step * Math.round(around.y / step), 0);
    this._sun.position.copy(this._sun.target.position).addScaledVector(SUN.clone().normalize(), 2 * SHADED);
  }

  _resize() {
    if (this._renderer.xr.isPresenting) return;
    const ratio = (this._coarse ? COARSE : 1) * Math.min(2, devicePixelRatio || 1);
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (!width || !height || (width === this._width && height === this._height && ratio === this._ratio)) return;
    Object.assign(this, { _width: width, _height: height, _ratio: ratio });
    this._renderer.setPixelRatio(ratio);
    this._renderer.setSize(width, height, false);
    this._views.camera.aspect = width / height;
    this._views.camera.updateProjectionMatrix();
  }
}
