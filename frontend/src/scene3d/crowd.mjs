// Crowd: all people of a scene, as instances of the bodies of the asset at three levels of detail.
import * as THREE from "three";
import { BONES } from "../scene/posing.mjs";
import { drawPeople } from "./crowd_shader.mjs";

export const LEVELS = 3;
const REST_WIDTH = 2048;
const ROW = 4 * (2 * BONES + 3);
const PIXELS = [190, 64];
const MOST = [16, 80];
const UNIT = 1e-4;
/** Bones of the feet. */
const FEET = [22, 26];

export class Crowd {
  /** @param {Array} meshes decoded frames "bodies/LEVEL.bin", from the finest */
  constructor(meshes) {
    this.group = new THREE.Group();
    this.counts = [0, 0, 0];
    this.capacity = 0;
    this._boneMap = { value: null };
    this._headless = { value: -1 };
    this._colorMap = { value: null };
    this._stature = meshes[0].arrays.stature[0];
    this._levels = meshes.map((mesh) => this._level(mesh.arrays));
    this._shade = blobs();
    this.group.add(this._shade);
    this.reserve(64);
  }

  /** Sets clothes and bodies of all people of a description. */
  dress(people, regions) {
    const count = Math.max(1, people.colors?.length ?? 0);
    const data = new Uint8Array(4 * regions * count);
    (people.colors ?? []).forEach((hex, k) => {
      for (let r = 0; r < regions; r++) {
        const at = 4 * (k * regions + r);
        for (let c = 0; c < 3; c++) data[at + c] = parseInt(hex.slice(6 * r + 2 * c, 6 * r + 2 * c + 2), 16);
        data[at + 3] = 255;
      }
    });
    this._colorMap.value?.dispose();
    const map = new THREE.DataTexture(data, regions, count, THREE.RGBAFormat);
    map.colorSpace = THREE.SRGBColorSpace;
    map.needsUpdate = true;
    this._colorMap.value = map;
  }

  /** Makes room for a number of people. */
  reserve(count) {
    if (count <= this.capacity) return;
    while (this.capacity < count) this.capacity = Math.max(64, 2 * this.capacity);
    this._boneMap.value?.dispose();
    this.bones = new Float32Array(ROW * this.capacity);
    const map = new THREE.DataTexture(this.bones, ROW / 4, this.capacity, THREE.RGBAFormat, THREE.FloatType);
    this._boneMap.value = map;
    for (const mesh of this._levels) {
      mesh.geometry.setAttribute("slot", instanced(this.capacity));
      mesh.geometry._maxInstanceCount = undefined;
    }
    this._shade.geometry.setAttribute("spot", new THREE.InstancedBufferAttribute(new Float32Array(4 * this.capacity), 4));
    this._shade.geometry._maxInstanceCount = undefined;
  }

  /** Takes the people of a state; marked is a set of ids drawn in the colour of marks. */
  update(state, marked, markColor, shade) {
    const count = state.people;
    this.reserve(count);
    this.shadeDepth = shade;
    state.pose(this.bones, ROW);
    const { who, ids } = state.frame.arrays;
    const { body, scale, parts, height, cuts } = state.description.people;
    for (let i = 0; i < count; i++) {
      const at = i * ROW + 8 * BONES;
      this.bones[at] = body[who[i]];
      this.bones[at + 1] = scale[who[i]];
      this.bones[at + 2] = parts[who[i]];
      this.bones[at + 3] = who[i];
      const tint = marked.has(ids[i]) ? 0.55 : 0;
      this.bones[at + 4] = markColor.r;
      this.bones[at + 5] = markColor.g;
      this.bones[at + 6] = markColor.b;
      this.bones[at + 7] = tint;
      this.bones.set(cuts[who[i]], at + 8);
      this.bones[at + 11] = height[who[i]] / this._stature;
    }
    this._boneMap.value.needsUpdate = true;
    this._state = state;
    this._raised = state.description.stage.ground.length > 0;
  }

  /** Height [m] of the ground under a person: that of the lower ankle, less its height at rest. */
  _ground(i) {
    if (!this._raised) return 0;
    const state = this._state;
    const { body, scale } = state.description.people;
    const who = state.frame.arrays.who[i];
    let low = Infinity;
    for (const bone of FEET) {
      const at = i * ROW + 8 * bone;
      const head = 3 * (BONES * body[who] + bone);
      const [a, b, c] = state.heads.subarray(head, head + 3);
      const [x, y, z, w, , , shift] = this.bones.subarray(at, at + 7);
      const size = scale[who];
      const height = 2 * (x * z - w * y) * a + 2 * (y * z + w * x) * b + (1 - 2 * (x * x + y * y)) * c;
      low = Math.min(low, shift + size * (height - c));
    }
    return Math.max(0, low);
  }

  /**
   * Chooses the level of detail of everybody for a camera.
   * @param {number|null} hidden id of who is not drawn
   * @param {number|null} headless id of who is drawn without neck and head, since the camera is inside
   */
  choose(camera, height, hidden = null, headless = null) {
    this.counts = [0, 0, 0];
    const state = this._state;
    if (!state?.frame) return;
    const { pelvis, ids } = state.frame.arrays;
    this._headless.value = headless === null ? -1 : ids.indexOf(headless);
    const focal = height / (2 * Math.tan(0.5 * THREE.MathUtils.degToRad(camera.fov)));
    const eye = camera.position;
    const order = [];
    for (let i = 0; i < state.people; i++) {
      if (ids[i] === hidden) continue;
      const away = Math.hypot(pelvis[3 * i] - eye.x, pelvis[3 * i + 1] - eye.y, pelvis[3 * i + 2] - eye.z);
      order.push([away, i]);
    }
    order.sort((a, b) => a[0] - b[0]);
    const shade = this._shade.geometry.attributes.spot;
    order.forEach(([away, i], rank) => {
      const pixels = (1.7 * focal) / Math.max(away, 0.1);
      const level = pixels > PIXELS[0] && rank < MOST[0] ? 0 : pixels > PIXELS[1] && rank < MOST[1] ? 1 : 2;
      this._levels[level].geometry.attributes.slot.array[this.counts[level]++] = i;
      shade.array.set([pelvis[3 * i], pelvis[3 * i + 1], this._ground(i), 0.42], 4 * rank);
    });
    this._levels.forEach((mesh, level) => {
      mesh.geometry.instanceCount = this.counts[level];
      mesh.visible = this.counts[level] > 0;
      mesh.geometry.attributes.slot.needsUpdate = true;
    });
    this._shade.geometry.instanceCount = order.length;
    this._shade.material.uniforms.depth.value = this.shadeDepth;
    shade.needsUpdate = true;
  }

  /** Runs a function that draws everybody with a head. */
  withHeads(draw) {
    const { value } = this._headless;
    this._headless.value = -1;
    draw();
    this._headless.value = value;
  }

  set shadows(on) {
    for (const mesh of this._levels) mesh.castShadow = on;
    this._shade.visible = on;
  }

  dispose() {
    for (const mesh of [...this._levels, this._shade]) {
      mesh.geometry.dispose();
      mesh.material.dispose();
      mesh.customDepthMaterial?.dispose();
    }
    this._boneMap.value?.dispose();
    this._colorMap.value?.dispose();
    for (const map of this._rests ?? []) map.dispose();
  }

  _level(arrays) {
    const bodies = arrays.heads.length / (3 * BONES);
    const vertices = arrays.rest.length / (3 * bodies);
    const geometry = new THREE.InstancedBufferGeometry();
    geometry.setIndex(new THREE.BufferAttribute(arrays.faces, 1));
    geometry.setAttribute("position", new THREE.BufferAttribute(new Float32Array(arrays.normal.length), 3));
    geometry.setAttribute("normal", new THREE.BufferAttribute(arrays.normal, 3));
    geometry.setAttribute("source", new THREE.BufferAttribute(Float32Array.from(arrays.source), 1));
    geometry.setAttribute("boneIndex", new THREE.BufferAttribute(arrays.bones, 4));
    geometry.setAttribute("boneWeight", new THREE.BufferAttribute(arrays.weights, 4, true));
    const kinds = new Uint8Array(3 * arrays.region.length);
    arrays.region.forEach((region, k) => kinds.set([region, arrays.part[k], arrays.group[k]], 3 * k));
    geometry.setAttribute("regionPartGroup", new THREE.BufferAttribute(kinds, 3));
    for (const cut of ["long", "short"]) {
      geometry.setAttribute(`${cut}Cut`, new THREE.BufferAttribute(Float32Array.from(arrays[cut], (one) => UNIT * one), 3));
    }
    const map = restTexture(arrays.rest);
    (this._rests ??= []).push(map);
    const uniforms = {
      restMap: { value: map }, boneMap: this._boneMap, colorMap: this._colorMap, vertices: { value: vertices },
      headless: this._headless,
    };
    const mesh = new THREE.Mesh(geometry, drawPeople(new THREE.MeshLambertMaterial({ side: THREE.DoubleSide }), uniforms, true));
    mesh.customDepthMaterial = drawPeople(new THREE.MeshDepthMaterial(), uniforms, false);
    mesh.frustumCulled = false;
    mesh.castShadow = true;
    this.group.add(mesh);
    return mesh;
  }
}

function instanced(count) {
  const found = new THREE.InstancedBufferAttribute(new Float32Array(count), 1);
  found.setUsage(THREE.DynamicDrawUsage);
  return found;
}

function restTexture(rest) {
  const count = rest.length / 3;
  const rows = Math.ceil(count / REST_WIDTH);
  const data = new Float32Array(4 * REST_WIDTH * rows);
  for (let k = 0; k < count; k++) for (let c = 0; c < 3; c++) data[4 * k + c] = UNIT * rest[3 * k + c];
  const map = new THREE.DataTexture(data, REST_WIDTH, rows, THREE.RGBAFormat, THREE.FloatType);
  map.needsUpdate = true;
  return map;
}

/** Soft dark spots on the floor under people. */
function blobs() {
  const geometry = new THREE.InstancedBufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute([-1, -1, 0, 1, -1, 0, 1, 1, 0, -1, 1, 0], 3));
  geometry.setIndex([0, 1, 2, 0, 2, 3]);
  const material = new THREE.ShaderMaterial({
    transparent: true,
    depthWrite: false,
    polygonOffset: true,
    polygonOffsetFactor: -4,
    uniforms: { depth: { value: 0.4 } },
    vertexShader: `attribute vec4 spot; varying vec2 at;
      void main() { at = position.xy;
        gl_Position = projectionMatrix * viewMatrix * vec4(spot.xyz + vec3(position.xy * spot.w, 0.012), 1.0); }`,
    fragmentShader: `uniform float depth; varying vec2 at;
      void main() { float r = length(at); gl_FragColor = vec4(0.0, 0.0, 0.0, depth * pow(max(0.0, 1.0 - r), 1.6)); }`,
  });
  const mesh = new THREE.Mesh(geometry, material);
  mesh.frustumCulled = false;
  mesh.renderOrder = 1;
  return mesh;
}
