// Robots: meshes of links, moved by the link poses of a frame.
import * as THREE from "three";
import { toCreasedNormals } from "three/addons/utils/BufferGeometryUtils.js";
import { imageOfFaces } from "./textures.mjs";

const CREASE = 0.6;

export class Robots {
  constructor() {
    this.group = new THREE.Group();
    this._robots = [];
    this._parts = new Map();
    this._materials = new Map();
  }

  /** Sets the robots of a description; meshes by key are {arrays, textures}: a decoded frame and its images. */
  build(robots, meshes) {
    this._disposeArrows();
    this.group.clear();
    this._robots = robots.map((robot) => {
      const links = this._links(robot.key, meshes.get(robot.key)).map((parts) => {
        const link = new THREE.Group();
        for (const { geometry, texture } of parts) {
          const mesh = new THREE.Mesh(geometry, this._material(robot.ghost, texture));
          mesh.castShadow = !robot.ghost;
          mesh.receiveShadow = true;
          link.add(mesh);
        }
        return link;
      });
      const group = new THREE.Group();
      if (links.length) group.add(...links);
      const arrow = robot.type === "cylinder" ? aheadArrow(robot) : null;
      if (arrow) group.add(arrow);
      this.group.add(group);
      return { id: robot.id, group, links, arrow };
    });
  }

  /** Moves the links to those of a state. */
  update(state, hidden = null) {
    const { bots, botplace, links } = state.frame.arrays;
    for (const robot of this._robots) robot.group.visible = false;
    let at = 0;
    bots.forEach((row, k) => {
      const robot = this._robots[row];
      if (robot.arrow) {
        robot.arrow.position.set(botplace[5 * k], botplace[5 * k + 1], robot.arrow.position.z);
        robot.arrow.rotation.z = botplace[5 * k + 2];
      }
      robot.group.visible = robot.id !== hidden;
      for (const mesh of robot.links) {
        mesh.position.set(links[at], links[at + 1], links[at + 2]);
        mesh.quaternion.set(links[at + 4], links[at + 5], links[at + 6], links[at + 3]).normalize();
        at += 7;
      }
    });
  }

  set shadows(on) {
    for (const robot of this._robots) for (const link of robot.links) for (const mesh of link.children) mesh.castShadow = on;
  }

  dispose() {
    for (const links of this._parts.values()) {
      for (const { geometry, texture } of links.flat()) {
        geometry.dispose();
        texture?.dispose();
      }
    }
    for (const material of this._materials.values()) material.dispose();
    this._disposeArrows();
  }

  _disposeArrows() {
    for (const { arrow } of this._robots) {
      arrow?.geometry.dispose();
      arrow?.material.dispose();
    }
  }

  _material(ghost, texture) {
    const key = `${ghost} ${texture?.uuid}`;
    if (!this._materials.has(key)) {
      const look = ghost ? { roughness: 0.6, transparent: true, opacity: 0.45 } : { roughness: 0.62, metalness: 0.05 };
      this._materials.set(key, new THREE.MeshStandardMaterial({ vertexColors: true, map: texture, ...look }));
    }
    return this._materials.get(key);
  }

  _links(key, mesh) {
    if (!this._parts.has(key)) this._parts.set(key, linkParts(mesh));
    return this._parts.get(key);
  }
}

/** Arrow on a robot that is a plain cylinder, so that its heading is seen. */
function aheadArrow({ radius, height }) {
  const size = 0.6 * radius;
  const geometry = new THREE.BufferGeometry();
  const corners = [size, 0, 0, -0.5 * size, 0.7 * size, 0, -0.5 * size, -0.7 * size, 0];
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(corners, 3));
  const arrow = new THREE.Mesh(geometry, new THREE.MeshBasicMaterial({ color: "#e66a1f" }));
  arrow.position.z = height + 0.006;
  return arrow;
}

/** Returns for each link its parts {geometry, texture}: one for each image, and one for the faces without. */
function linkParts({ arrays, textures }) {
  const { faces, first } = arrays;
  const image = imageOfFaces(arrays);
  return Array.from(first, (begin, k) => {
    const end = k + 1 < first.length ? first[k + 1] : faces.length / 3;
    const groups = new Map();
    for (let f = begin; f < end; f++) {
      const at = textures[image[f]] ? image[f] : -1;
      if (!groups.has(at)) groups.set(at, []);
      groups.get(at).push(f);
    }
    return [...groups].map(([at, rows]) => ({ geometry: partGeometry(arrays, rows, at >= 0), texture: textures[at] ?? null }));
  });
}

/** Returns the geometry of some triangles, with creased normals and a colour for each triangle. */
function partGeometry({ vertices, faces, color, uv }, rows, textured) {
  const positions = new Float32Array(9 * rows.length);
  const colors = new Float32Array(9 * rows.length);
  const places = textured ? new Float32Array(6 * rows.length) : null;
  const shade = new THREE.Color();
  rows.forEach((f, row) => {
    shade.setRGB(color[4 * f] / 255, color[4 * f + 1] / 255, color[4 * f + 2] / 255, THREE.SRGBColorSpace);
    for (let c = 0; c < 3; c++) {
      const vertex = faces[3 * f + c];
      positions.set(vertices.subarray(3 * vertex, 3 * vertex + 3), 9 * row + 3 * c);
      colors.set([shade.r, shade.g, shade.b], 9 * row + 3 * c);
      if (places) places.set([uv[2 * vertex], 1 - uv[2 * vertex + 1]], 6 * row + 2 * c);
    }
  });
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
  geometry.setAttribute("color", new THREE.BufferAttribute(colors, 3));
  if (places) geometry.setAttribute("uv", new THREE.BufferAttribute(places, 2));
  return toCreasedNormals(geometry, CREASE);
}
