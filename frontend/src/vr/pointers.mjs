// Pointers: rays of controllers and hands, what they point at on a board, and their triggers or pinches.
import * as THREE from "three";

const FREE = 1.2;
const HELD = 0.7;

export class Pointers {
  /** @param {Board} board */
  constructor(board) {
    this.board = board;
    this.group = new THREE.Group();
    this.held = 0;
    this._rays = { left: ray(), right: ray() };
    this._before = { left: false, right: false };
    for (const one of Object.values(this._rays)) this.group.add(one.line, one.dot);
  }

  /**
   * Shows rays and presses what they point at; returns whether both triggers have just been held for long enough.
   * @param {{rays, pressed}} poses rays and pressed hands in the frame of the headset
   */
  update({ rays, pressed }, seconds) {
    const points = [];
    for (const [side, shape] of Object.entries(this._rays)) {
      const one = rays[side];
      const hit = one && this._aim(shape, one);
      shape.line.visible = Boolean(one && this.board.shown);
      shape.dot.visible = Boolean(hit);
      const begins = pressed.includes(side) && !this._before[side];
      this._before[side] = pressed.includes(side);
      if (!hit) continue;
      points.push(hit);
      if (begins) this.board.press(hit);
    }
    if (this.board.shown) this.board.hover(points);
    return this._hold(pressed, seconds);
  }

  /** Whether nothing is pressed. */
  get free() {
    return !this._before.left && !this._before.right;
  }

  _aim(shape, { position: p, orientation: q }) {
    const origin = new THREE.Vector3(p.x, p.y, p.z);
    const direction = new THREE.Vector3(0, 0, -1).applyQuaternion(new THREE.Quaternion(q.x, q.y, q.z, q.w));
    const hit = this.board.hit(origin, direction);
    const end = origin.clone().addScaledVector(direction, hit ? hit.away : FREE);
    shape.line.position.copy(origin);
    shape.line.lookAt(shape.line.parent.localToWorld(end.clone()));
    shape.line.scale.set(1, 1, hit ? hit.away : FREE);
    shape.dot.position.copy(end);
    return hit;
  }

  _hold(pressed, seconds) {
    const before = this.held;
    this.held = pressed.length === 2 ? before + seconds : 0;
    return before < HELD && this.held >= HELD;
  }
}

function ray() {
  const geometry = new THREE.CylinderGeometry(0.002, 0.004, 1, 8, 1, true).rotateX(-0.5 * Math.PI).translate(0, 0, 0.5);
  const line = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ color: "#0b62b8", transparent: true, opacity: 0.8, fog: false }));
  const dot = new THREE.Mesh(new THREE.SphereGeometry(0.012, 12, 8), new THREE.MeshBasicMaterial({ color: "#ff5c00", transparent: true, depthTest: false, fog: false }));
  line.renderOrder = dot.renderOrder = 6; // after the board
  line.visible = dot.visible = false;
  return { line, dot };
}
