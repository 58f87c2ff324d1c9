// OwnBody: participants see the body of their avatar, without its head, since the eyes are inside; mirrors show all.
import * as THREE from "three";

const HALF = 0.2;
const ABOVE = 0.3;
const BELOW = 0.2;
const FAR = 1e6;
const NORMALS = [[1, 0, 0], [-1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [0, 0, -1]].map((one) => new THREE.Vector3(...one));

export class OwnBody {
  /** @param {{renderer: THREE.WebGLRenderer, scene: THREE.Scene}} engine */
  constructor({ renderer, scene }) {
    this._scene = scene;
    this._planes = NORMALS.map((normal) => new THREE.Plane(normal.clone(), FAR));
    this._dressed = new Set();
    renderer.localClippingEnabled = true;
  }

  /** Hides everything of people within a box about the eyes, z up; an eye of null hides nothing. */
  hideHead(eye) {
    this._dress();
    this._planes.forEach((plane, k) => {
      const reach = k < 4 ? HALF : k === 4 ? ABOVE : BELOW;
      plane.constant = eye ? -plane.normal.dot(eye) - reach : FAR;
    });
  }

  /** Runs a function while heads are drawn. */
  withHeads(draw) {
    const before = this._planes.map((plane) => plane.constant);
    for (const plane of this._planes) plane.constant = FAR;
    draw();
    this._planes.forEach((plane, k) => {
      plane.constant = before[k];
    });
  }

  /** Gives the planes to the materials of people, which are made when the first scene is loaded. */
  _dress() {
    if (this._dressed.size) return;
    this._scene.traverse(({ geometry, material }) => {
      if (!geometry?.attributes.boneIndex) return;
      material.clippingPlanes = this._planes;
      material.clipIntersection = true;
      material.needsUpdate = true;
      this._dressed.add(material);
    });
  }
}
