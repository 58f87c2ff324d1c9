// Robots: all links of all robots of a kind in one draw call for each texture, moved by the link poses of a frame.
import * as THREE from "three";
import { mergeGeometries, toCreasedNormals } from "three/addons/utils/BufferGeometryUtils.js";
import { moveLinks } from "./robot_shader.mjs";
import { imageOfFaces } from "./textures.mjs";

const CREASE = 0.6;
/** Numbers of a link in the texture of poses: position and a spare one, quaternion x, y, z, w. */
const POSE = 8;

export class Robots {
  constructor() {
    this.group = new THREE.Group();
    this._robots = [];
    this._kinds = [];
    this._parts = new Map();
  }

  /** Sets the robots of a description; meshes by key are {arrays, textures}: a decoded frame and its images. */
  build(robots, meshes) {
    this._clear();
    const kinds = new Map();
    this._robots = robots.map((robot) => {
      const name = `${robot.ghost} ${robot.key}`;
      if (!kinds.has(name)) kinds.set(name, { robots: [], key: robot.key, ghost: robot.ghost });
      const kind = kinds.get(name);
      const arrow = robot.type === "cylinder" ? aheadArrow(robot) : null;
      if (arrow) this.group.add(arrow);
      return { id: robot.id, kind, slot: kind.robots.push(robot) - 1, arrow };
    });
    this._kinds = [...kinds.values()];
    for (const kind of this._kinds) {
      const { parts, links } = this._mesh(kind.key, meshes.get(kind.key));
      kind.links = links;
      kind.poses = new THREE.DataTexture(new Float32Array(POSE * Math.max(1, links) * kind.robots.length), 2 * Math.max(1, links), kind.robots.length, THREE.RGBAFormat, THREE.FloatType);
      kind.meshes = parts.map((part) => instances(part, kind));
      if (kind.meshes.length) this.group.add(...kind.meshes);
    }
  }

  /** Moves the links to those of a state. */
  update(state, hidden = null) {
    const { bots, botplace, links } = state.frame.arrays;
    const drawn = new Map(this._kinds.map((kind) => [kind, []]));
    for (const { arrow } of this._robots) if (arrow) arrow.visible = false;
    let at = 0;
    bots.forEach((row, k) => {
      const { id, kind, slot, arrow } = this._robots[row];
      if (arrow) {
        arrow.position.set(botplace[5 * k], botplace[5 * k + 1], arrow.position.z);
        arrow.rotation.z = botplace[5 * k + 2];
        arrow.visible = id !== hidden;
      }
      if (id !== hidden) drawn.get(kind).push(slot);
      for (let link = 0; link < kind.links; link++, at += 7) {
        const [x, y, z, w, a, b, c] = links.subarray(at, at + 7);
        const size = Math.hypot(w, a, b, c) || 1;
        kind.poses.image.data.set([x, y, z, 0, a / size, b / size, c / size, w / size], POSE * (slot * kind.links + link));
      }
    });
    for (const [kind, slots] of drawn) {
      kind.poses.needsUpdate = true;
      for (const mesh of kind.meshes) {
        mesh.geometry.attributes.slot.array.set(slots);
        mesh.geometry.attributes.slot.needsUpdate = true;
        mesh.geometry.instanceCount = slots.length;
        mesh.visible = slots.length > 0;
      }
    }
  }

  set shadows(on) {
    for (const { meshes, ghost } of this._kinds) for (const mesh of meshes) mesh.castShadow = on && !ghost;
  }

  dispose() {
    this._clear();
    for (const { parts } of this._parts.values()) {
      for (const { geometry, texture } of parts) {
        geometry.dispose();
        texture?.dispose();
      }
    }
  }

  _clear() {
    for (const { arrow } of this._robots) {
      arrow?.geometry.dispose();
      arrow?.material.dispose();
    }
    for (const { meshes, poses } of this._kinds) {
      poses.dispose();
      for (const mesh of meshes) for (const one of [mesh.geometry, mesh.material, mesh.customDepthMaterial]) one.dispose();
    }
    this._robots = this._kinds = [];
    this.group.clear();
  }

  _mesh(key, mesh) {
    if (!this._parts.has(key)) this._parts.set(key, robotParts(mesh));
    return this._parts.get(key);
  }
}

/** Draws one part of all robots of a kind. */
function instances({ geometry, texture }, { ghost, robots, poses }) {
  const shared = new THREE.InstancedBufferGeometry();
  for (const [name, one] of Object.entries(geometry.attributes)) shared.setAttribute(name, one);
  const slot = new THREE.InstancedBufferAttribute(new Float32Array(robots.length), 1);
  shared.setAttribute("slot", slot.setUsage(THREE.DynamicDrawUsage));
  shared.instanceCount = 0;
  const look = ghost ? { roughness: 0.6, transparent: true, opacity: 0.45 } : { roughness: 0.62, metalness: 0.05 };
  const mesh = new THREE.Mesh(shared, moveLinks(new THREE.MeshStandardMaterial({ vertexColors: true, map: texture, ...look }), poses));
  mesh.customDepthMaterial = moveLinks(new THREE.MeshDepthMaterial(), poses);
  mesh.frustumCulled = false; // its place is in the texture of poses
  mesh.castShadow = !ghost;
  mesh.receiveShadow = true;
  return mesh;
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

/** Returns the number of links, and parts {geometry, texture}: one for each image, and one for the faces without. */
function robotParts({ arrays, textures }) {
  const { faces, first } = arrays;
  const image = imageOfFaces(arrays);
  const pieces = new Map();
  first.forEach((begin, link) => {
    const end = link + 1 < first.length ? first[link + 1] : faces.length / 3;
    const groups = new Map();
    for (let f = begin; f < end; f++) {
      const at = textures[image[f]] ? image[f] : -1;
      if (!groups.has(at)) groups.set(at, []);
      groups.get(at).push(f);
    }
    for (const [at, rows] of groups) pieces.set(at, [...(pieces.get(at) ?? []), linkGeometry(arrays, rows, at >= 0, link)]);
  });
  const parts = [...pieces].map(([at, own]) => {
    const geometry = mergeGeometries(own);
    for (const one of own) one.dispose();
    return { geometry, texture: textures[at] ?? null };
  });
  return { parts, links: first.length };
}

/** Returns the geometry of some triangles of a link, which all its vertices name. */
function linkGeometry(arrays, rows, textured, link) {
  const geometry = partGeometry(arrays, rows, textured);
  const count = geometry.attributes.position.count;
  return geometry.setAttribute("link", new THREE.BufferAttribute(new Float32Array(count).fill(link), 1));
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
