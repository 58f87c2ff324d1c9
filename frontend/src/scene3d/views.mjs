// Views: the cameras of a scene: free, overview, beside, follow, and from a robot.
import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";

const FIELD = 45;
const WIDE = 75;
/** Largest distance of the first view [m], so that people are seen. */
const FARTHEST = 15;
const NEARER = 13;
/** Height of the eyes, as a share of the stature; how far [rad] they look down, and to each side. */
const EYES = 0.93;
const DOWN = 0.12;
const NECK = 2.2;
/** Turn [rad] of the head for each pixel of the mouse. */
const DRAG = 0.005;

export class Views {
  constructor(canvas) {
    this.camera = new THREE.PerspectiveCamera(FIELD, 1, 0.1, 500);
    this.camera.up.set(0, 0, 1);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.maxPolarAngle = 0.495 * Math.PI;
    this.controls.minDistance = 0.6;
    this.controls.maxDistance = 250;
    this.controls.zoomToCursor = true;
    this.name = "free";
    this._target = null;
    this._last = null;
    this._gaze = [0, 0];
    canvas.addEventListener("keydown", (event) => this._key(event));
    canvas.addEventListener("pointermove", (event) => {
      if (this.firstPerson && event.buttons & 1) this._turnHead(-DRAG * event.movementX, -DRAG * event.movementY);
    });
  }

  /** Whether the camera is in the head of somebody. */
  get firstPerson() {
    return this.name === "eyes" || this.name.startsWith("robot:");
  }

  /** Cameras of a description. */
  list(description) {
    return [
      { name: "free", title: "Free" },
      { name: "overview", title: "Overview" },
      { name: "beside", title: "Beside" },
      { name: "follow", title: "Follow" },
      { name: "eyes", title: "Through the eyes" },
      ...description.robots.map((one) => ({ name: `robot:${one.name}`, title: `From ${one.name}` })),
    ];
  }

  /** Chooses a camera; target {kind, id} is whom it follows. */
  choose(name, description, target) {
    this.name = name;
    this._target = target ?? this._target;
    this.controls.enabled = !this.firstPerson;
    this.camera.fov = this.firstPerson ? WIDE : FIELD;
    this._gaze = [0, 0];
    this.camera.updateProjectionMatrix();
    if (name === "overview") this.overview(description, true);
    if (name === "follow") this._start = true;
    this._last = null;
  }

  set target(target) {
    this._target = target;
  }

  /** Whom the follow camera follows: the chosen one, or the first robot, or the first person. */
  followed(state) {
    if (this._target && state.place(this._target.kind, this._target.id)) return this._target;
    const { bots, ids } = state.frame.arrays;
    if (bots.length) return { kind: "robot", id: state.description.robots[bots[0]].id };
    return ids.length ? { kind: "person", id: ids[0] } : null;
  }

  /** Whose head the camera is in, {kind, id}, or null. */
  head(state) {
    if (this.name === "eyes") return state.frame ? this.followed(state) : null;
    const robot = state.description?.robots.find((one) => `robot:${one.name}` === this.name);
    return robot ? { kind: "robot", id: robot.id } : null;
  }

  /** Shows all of a description, from above or from the side. */
  overview({ bounds: [x0, y0, x1, y1], focus }, above = false) {
    const middle = new THREE.Vector3(0.5 * (x0 + x1), 0.5 * (y0 + y1), 0.6);
    const pitch = above ? 1.05 : 0.62;
    const yaw = x1 - x0 >= y1 - y0 ? -0.5 * Math.PI : Math.PI;
    const turn = above ? yaw : yaw + 0.35;
    const way = new THREE.Vector3(Math.cos(turn) * Math.cos(pitch), Math.sin(turn) * Math.cos(pitch), Math.sin(pitch));
    const corners = [];
    for (const x of [x0, x1]) for (const y of [y0, y1]) for (const z of [0, 1.8]) corners.push(new THREE.Vector3(x, y, z));
    for (let round = 0; round < 3; round++) {
      let [near, far] = [1, 400];
      for (let k = 0; k < 20; k++) {
        const away = 0.5 * (near + far);
        this._look(middle, way, away);
        if (corners.every((one) => this._sees(one))) far = away;
        else near = away;
      }
      this._look(middle, way, far);
      this._center(middle, corners);
      this._away = far;
    }
    if (!above && this._away > FARTHEST) {
      middle.set(focus[0], focus[1], 0.8);
      this._look(middle, way, NEARER);
    } else {
      this._look(middle, way, this._away);
    }
    this.controls.target.copy(middle);
    this.controls.update();
    this._last = null; // or the way from the robot of the trial before would be added
  }

  /** In the first person how the head is turned; beside somebody the way from the target to the camera; else also the target. */
  viewpoint() {
    if (this.firstPerson) return [...this._gaze];
    const { target } = this.controls;
    const way = this.camera.position.clone().sub(target).toArray();
    return this.name === "follow" || this.name === "beside" ? way : [...way, ...target.toArray()];
  }

  /** Moves the camera to numbers of viewpoint() of the same camera; others are ignored. */
  setViewpoint(numbers) {
    if (numbers.length !== this.viewpoint().length) return;
    if (this.firstPerson) {
      this._gaze = [0, 0];
      return this._turnHead(...numbers);
    }
    if (numbers.length > 3) this.controls.target.fromArray(numbers, 3);
    this.camera.position.fromArray(numbers).add(this.controls.target);
    this._start = false;
  }

  /** Moves the camera before a picture. */
  update(state) {
    if (!state.frame) return;
    if (this.name === "follow") this._follow(state);
    else if (this.name === "beside") this._accompany(state);
    else if (this.firstPerson) this._ride(state);
    else this.controls.update();
  }

  dispose() {
    this.controls.dispose();
  }

  _look(middle, way, away) {
    this.camera.position.copy(middle).addScaledVector(way, away);
    this.camera.lookAt(middle);
    this.camera.updateMatrixWorld();
    this.camera.matrixWorldInverse.copy(this.camera.matrixWorld).invert();
  }

  /** Moves a point of the floor to the middle of where points are in the picture. */
  _center(middle, points) {
    const at = points.map((one) => one.clone().project(this.camera));
    const middles = ["x", "y"].map((axis) => {
      const values = at.map((one) => one[axis]);
      return 0.5 * (Math.min(...values) + Math.max(...values));
    });
    const ray = new THREE.Raycaster();
    ray.setFromCamera(new THREE.Vector2(...middles), this.camera);
    const hit = ray.ray.intersectPlane(new THREE.Plane(new THREE.Vector3(0, 0, 1), -middle.z), new THREE.Vector3());
    if (hit) middle.copy(hit);
  }

  _sees(point) {
    const at = point.clone().project(this.camera);
    return Math.abs(at.x) < 0.97 && Math.abs(at.y) < 0.95 && at.z < 1;
  }

  _follow(state) {
    const target = this.followed(state);
    if (!target) return;
    const [x, y, heading] = state.place(target.kind, target.id);
    const goal = new THREE.Vector3(x, y, 0.75 * state.height(target.kind, target.id));
    if (this._start) {
      this.camera.position.set(x - 4.2 * Math.cos(heading - 0.4), y - 4.2 * Math.sin(heading - 0.4), 2.9);
      this._start = false;
    } else {
      this.camera.position.add(goal.clone().sub(this.controls.target));
    }
    this.controls.target.copy(goal);
    this.controls.update();
  }

  /** Moves with the robot and keeps the direction and the distance of the view. */
  _accompany(state) {
    const target = this.followed(state);
    if (target) {
      const [x, y] = state.place(target.kind, target.id);
      const way = new THREE.Vector3(x, y, 0).sub(this._last ?? new THREE.Vector3(this.controls.target.x, this.controls.target.y, 0));
      this.controls.target.add(way);
      this.camera.position.add(way);
      this._last = new THREE.Vector3(x, y, 0);
    }
    this.controls.update();
  }

  _ride(state) {
    const one = this.head(state);
    const place = one && state.place(one.kind, one.id);
    if (!place) return;
    const [x, y, heading] = place;
    const height = one.kind === "robot" ? Math.max(0.6, state.height("robot", one.id)) : EYES * state.height("person", one.id);
    const [yaw, pitch] = [heading + this._gaze[0], this._gaze[1] - DOWN];
    this.camera.position.set(x, y, height);
    this.camera.lookAt(x + Math.cos(yaw) * Math.cos(pitch), y + Math.sin(yaw) * Math.cos(pitch), height + Math.sin(pitch));
  }

  /** Looks around in the first person [rad]. */
  _turnHead(yaw, pitch) {
    this._gaze[0] = Math.max(-NECK, Math.min(NECK, this._gaze[0] + yaw));
    this._gaze[1] = Math.max(-1.2, Math.min(1.2, this._gaze[1] + pitch));
  }

  _key(event) {
    const step = { ArrowLeft: [1, 0], ArrowRight: [-1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (!step || !event.shiftKey) return;
    event.preventDefault();
    if (this.firstPerson) return this._turnHead(0.12 * step[0], -0.12 * step[1]);
    const away = this.camera.position.clone().sub(this.controls.target);
    const round = new THREE.Spherical().setFromCartesianCoords(away.x, away.z, -away.y);
    round.theta += 0.12 * step[0];
    round.phi = Math.min(this.controls.maxPolarAngle, Math.max(0.05, round.phi + 0.12 * step[1]));
    const turned = new THREE.Vector3().setFromSpherical(round);
    this.camera.position.copy(this.controls.target).add(new THREE.Vector3(turned.x, -turned.z, turned.y));
  }
}
