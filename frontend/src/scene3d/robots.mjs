// Robots: meshes of links, moved by the link poses of a frame.
import * as THREE from "three";
import { toCreasedNormals } from "three/addons/utils/BufferGeometryUtils.js";

const CREASE = 0.6;

export class Robots {
  constructor() {
    this.group = new THREE.Group();
    this._robots = [];
    this._geometries = new Map();
    this._material = new THREE.MeshStandardMaterial({ vertexColors: true, roughness: 0.62, metalness: 0.05 });
    this._ghost = new THREE.MeshStandardMaterial({ vertexColors: true, roughness: 0.6, transparent: true, opacity: 0.45 });
  }

  /** Sets the robots of a description; meshes are decoded frames by key. */
  build(robots, meshes) {
    this.group.clear();
    this._robots = robots.map((robot) => {
      const links = this._links(robot.key, meshes.get(robot.key)).map((geometry) => {
        const mesh = new THREE.Mesh(geometry, robot.ghost ? this._ghost : this._material);
        mesh.castShadow = !robot.ghost;
        mesh.receiveShadow = true;
        return mesh;
      });
      const group = new THREE.Group();
      if (links.length) group.add(...links);
      this.group.add(group);
      return { id: robot.id, group, links };
    });
  }

  /** Moves the links to those of a state. */
  update(state, hidden = null) {
    const { bots, links } = state.frame.arrays;
    for (const robot of this._robots) robot.group.visible = false;
    let at = 0;
    for (const row of bots) {
      const robot = this._robots[row];
      robot.group.visible = robot.id !== hidden;
      for (const mesh of robot.links) {
        mesh.position.set(links[at], links[at + 1], links[at + 2]);
        mesh.quaternion.set(links[at + 4], links[at + 5], links[at + 6], links[at + 3]).normalize();
        at += 7;
      }
    }
  }

  set shadows(on) {
    for (const robot of this._robots) for (const mesh of robot.links) mesh.castShadow = on;
  }

  dispose() {
    for (const links of this._geometries.values()) for (const geometry of links) geometry.dispose();
    this._material.dispose();
    this._ghost.dispose();
  }

  _links(key, mesh) {
    if (!this._geometries.has(key)) this._geometries.set(key, linkGeometries(mesh.arrays));
    return this._geometries.get(key);
  }
}

/** Returns a geometry for each link, with creased normals and a colour for each triangle. */
function linkGeometries({ vertices, faces, color, first }) {
  const count = faces.length / 3;
  const shade = new THREE.Color();
  return Array.from(first, (begin, k) => {
    const end = k + 1 < first.length ? first[k + 1] : count;
    const positions = new Float32Array(9 * (end - begin));
    const colors = new Float32Array(9 * (end - begin));
    for (let f = begin; f < end; f++) {
      shade.setRGB(color[4 * f] / 255, color[4 * f + 1] / 255, color[4 * f + 2] / 255, THREE.SRGBColorSpace);
      for (let c = 0; c < 3; c++) {
        const at = 9 * (f - begin) + 3 * c;
        positions.set(vertices.subarray(3 * faces[3 * f + c], 3 * faces[3 * f + c] + 3), at);
        colors.set([shade.r, shade.g, shade.b], at);
      }
    }
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
    geometry.setAttribute("color", new THREE.BufferAttribute(colors, 3));
    return toCreasedNormals(geometry, CREASE);
  });
}
