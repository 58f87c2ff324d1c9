// Limits: the free floor of a real room as a fence in the virtual one, which appears before it is reached.
import * as THREE from "three";

const NEAR = 0.9;
const FULL = 0.3;
const HIGH = 2.2;
const GAP = 0.25;
const FILL = 0.16;

export class Limits {
  /** @param {string} color of the fence */
  constructor(color) {
    this.group = new THREE.Group();
    this.corners = [];
    this._lines = new THREE.LineSegments(new THREE.BufferGeometry(), new THREE.LineBasicMaterial({ color, transparent: true, opacity: 0, depthTest: false }));
    this._lines.renderOrder = 8;
    this._walls = new THREE.Mesh(new THREE.BufferGeometry(), new THREE.MeshBasicMaterial({ color, transparent: true, opacity: 0, side: THREE.DoubleSide, depthTest: false, depthWrite: false, fog: false }));
    this._walls.renderOrder = 7;
    this._lines.visible = this._walls.visible = false;
    this.group.add(this._walls, this._lines);
  }

  /** Places the room; place has x, y, z, heading [m], [rad] and limits [[x, y], ...]. */
  set(place) {
    this.group.position.set(place.x, place.y, place.z);
    this.group.rotation.z = place.heading;
    if (JSON.stringify(place.limits) === JSON.stringify(this.corners)) return;
    this.corners = place.limits;
    this._lines.geometry.dispose();
    this._lines.geometry = fence(place.limits);
    this._walls.geometry.dispose();
    this._walls.geometry = sides(place.limits);
  }

  /** Shows the fence for a distance [m] from it: faint at 0.9 m, full at 0.3 m. */
  show(margin) {
    const { material } = this._lines;
    material.opacity = this.corners.length ? Math.max(0, Math.min(1, (NEAR - margin) / (NEAR - FULL))) : 0;
    this._walls.material.opacity = FILL * material.opacity;
    this._lines.visible = this._walls.visible = material.opacity > 0;
  }

  /** Opacity of the fence, for tests. */
  get warning() {
    return this._lines.visible ? this._lines.material.opacity : 0;
  }
}

/** Distance [m] of a point from the sides of a polygon, negative outside; infinite without a polygon. */
export function inside([x, y], corners) {
  if (corners.length < 3) return Infinity;
  let gap = Infinity;
  let within = false;
  corners.forEach(([ax, ay], k) => {
    const [bx, by] = corners[(k + 1) % corners.length];
    const [dx, dy] = [bx - ax, by - ay];
    const share = Math.max(0, Math.min(1, ((x - ax) * dx + (y - ay) * dy) / Math.max(dx * dx + dy * dy, 1e-12)));
    gap = Math.min(gap, Math.hypot(x - ax - share * dx, y - ay - share * dy));
    if (ay > y !== by > y && x < ax + ((y - ay) / dy) * dx) within = !within;
  });
  return within ? gap : -gap;
}

function fence(corners) {
  const points = [];
  corners.forEach(([ax, ay], k) => {
    const [bx, by] = corners[(k + 1) % corners.length];
    const count = Math.max(1, Math.round(Math.hypot(bx - ax, by - ay) / GAP));
    for (let i = 0; i < count; i++) {
      const [x, y] = [ax + ((bx - ax) * i) / count, ay + ((by - ay) * i) / count];
      points.push(x, y, 0, x, y, HIGH);
    }
    for (let z = 0; z <= HIGH + 0.01; z += HIGH / 8) points.push(ax, ay, z, bx, by, z);
  });
  return new THREE.BufferGeometry().setAttribute("position", new THREE.Float32BufferAttribute(points, 3));
}

function sides(corners) {
  const points = corners.flatMap(([ax, ay], k) => {
    const [bx, by] = corners[(k + 1) % corners.length];
    return [ax, ay, 0, bx, by, 0, bx, by, HIGH, ax, ay, 0, bx, by, HIGH, ax, ay, HIGH];
  });
  return new THREE.BufferGeometry().setAttribute("position", new THREE.Float32BufferAttribute(points, 3));
}
