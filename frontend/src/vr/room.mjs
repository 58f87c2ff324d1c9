// Room: the real room of the participant in the virtual one: where the headset is, the limits, hands, and a veil.
import * as THREE from "three";
import { mergeGeometries } from "three/addons/utils/BufferGeometryUtils.js";
import { inside, Limits } from "./limits.mjs";

const AXES = new THREE.Matrix4().set(0, 0, -1, 0, -1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 1);
const SKIN = "#e0ac8a";

export class Room {
  constructor() {
    this.limits = new Limits("#ff5c00");
    this.group = this.limits.group;
    this.rig = new THREE.Group();
    this.rig.quaternion.setFromRotationMatrix(AXES);
    this.camera = new THREE.PerspectiveCamera(75, 1, 0.05, 300);
    this.rig.add(this.camera);
    this.group.add(this.rig);
    this.margin = Infinity;
    this._shapes = { fist: fist(), open: openHand() };
    this._hands = { left: hand(), right: hand() };
    for (const one of Object.values(this._hands)) this.rig.add(one);
    this._veil = veil();
    this.camera.add(this._veil, (this._panel = panel()));
  }

  /** Places the room; place has x, y, z, heading [m], [rad] and limits [[x, y], ...]. */
  set(place) {
    this.limits.set(place);
  }

  /** Shows hands where they are, and the limits before they are reached; `parts` are transforms of the headset. */
  update({ head, hands, fingers }) {
    for (const [side, mesh] of Object.entries(this._hands)) {
      const one = hands[side];
      mesh.visible = Boolean(one);
      if (!one) continue;
      mesh.geometry = fingers[side] ? this._shapes.open : this._shapes.fist;
      mesh.position.copy(one.position);
      mesh.quaternion.copy(one.orientation);
    }
    const points = [head, ...Object.values(hands)].filter(Boolean).map(({ position: p }) => [-p.z, -p.x]);
    this.margin = Math.min(Infinity, ...points.map((point) => inside(point, this.limits.corners)));
    this.limits.show(this.margin);
  }

  /** Draws no hands: the avatar of the participant has some. */
  hideHands() {
    for (const mesh of Object.values(this._hands)) mesh.visible = false;
  }

  /** Opacity of the limits, for tests. */
  get warning() {
    return this.limits.warning;
  }

  /** Fades the picture towards black: 0 shows it, 1 hides it. Returns the opacity that is reached. */
  fade(wish, seconds) {
    const material = this._veil.material;
    const step = seconds / 0.2;
    material.opacity += Math.max(-step, Math.min(step, wish - material.opacity));
    this._veil.visible = material.opacity > 0.001;
    return material.opacity;
  }

  /** Opacity of the black before the eyes, for tests. */
  get veil() {
    return Math.round(1000 * this._veil.material.opacity) / 1000;
  }

  /** Shows a sentence in front of the participant; an empty one shows nothing. */
  say(text) {
    if (this._said === text) return;
    this._said = text;
    this._panel.visible = Boolean(text);
    if (text) write(this._panel, text);
  }

  get said() {
    return this._said ?? "";
  }
}

function hand() {
  const mesh = new THREE.Mesh(new THREE.BufferGeometry(), new THREE.MeshStandardMaterial({ vertexColors: true, roughness: 0.8, transparent: true }));
  mesh.renderOrder = 6; // after the board, which clears the depth
  mesh.visible = false;
  return mesh;
}

/** Geometry with one colour; sizes scale it about its middle. */
function piece(geometry, color, [x, y, z], scale = [1, 1, 1]) {
  const { r, g, b } = new THREE.Color(color);
  const { count } = geometry.attributes.position;
  geometry.setAttribute("color", new THREE.Float32BufferAttribute(Array(count).fill([r, g, b]).flat(), 3));
  return geometry.scale(...scale).translate(x, y, z);
}

/** A fist about a controller, whose rod is along z and points to -z. */
function fist() {
  const rod = new THREE.CapsuleGeometry(0.016, 0.1, 4, 10).rotateX(0.5 * Math.PI);
  return mergeGeometries([
    piece(new THREE.SphereGeometry(0.045, 16, 12), SKIN, [0, 0, 0.005], [0.8, 0.85, 1]),
    piece(rod, "#2b3038", [0, 0, -0.02]),
  ]);
}

/** An open hand at its wrist, with the fingers along -z and the back along y. */
function openHand() {
  const finger = (x, reach) => piece(new THREE.CapsuleGeometry(0.008, 0.06, 4, 8).rotateX(0.5 * Math.PI), SKIN, [x, 0, -reach]);
  return mergeGeometries([
    piece(new THREE.SphereGeometry(0.05, 16, 12), SKIN, [0, 0, -0.05], [0.85, 0.32, 1.1]),
    ...[[-0.03, 0.125], [-0.01, 0.135], [0.01, 0.135], [0.03, 0.125]].map(([x, reach]) => finger(x, reach)),
  ]);
}

function veil() {
  const material = new THREE.MeshBasicMaterial({ color: "#000", side: THREE.BackSide, transparent: true, opacity: 0, depthTest: false, depthWrite: false, fog: false });
  const mesh = new THREE.Mesh(new THREE.SphereGeometry(0.5, 16, 12), material);
  mesh.renderOrder = 9;
  mesh.visible = false;
  return mesh;
}

function panel() {
  const map = new THREE.CanvasTexture(Object.assign(document.createElement("canvas"), { width: 1024, height: 256 }));
  map.colorSpace = THREE.SRGBColorSpace;
  const mesh = new THREE.Mesh(new THREE.PlaneGeometry(1, 0.25), new THREE.MeshBasicMaterial({ map, transparent: true, depthTest: false, fog: false, toneMapped: false }));
  mesh.position.set(0, -0.05, -1.2);
  mesh.renderOrder = 10;
  mesh.visible = false;
  return mesh;
}

function write(mesh, text) {
  const { image } = mesh.material.map;
  const pen = image.getContext("2d");
  pen.clearRect(0, 0, image.width, image.height);
  pen.fillStyle = "rgba(20, 28, 38, 0.92)";
  pen.beginPath();
  pen.roundRect(0, 0, image.width, image.height, 40);
  pen.fill();
  pen.fillStyle = "#fff";
  pen.font = "52px system-ui, sans-serif";
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  const lines = text.split("\n");
  lines.forEach((line, k) => pen.fillText(line, image.width / 2, image.height / 2 + 66 * (k - (lines.length - 1) / 2), image.width - 60));
  mesh.material.map.needsUpdate = true;
}
