// Overlays: laser returns, cones of sonar and infrared sensors, contact forces and goals.
import * as THREE from "three";
import { densityImage, eachCollision, eachPathPiece, TIMES } from "../scene/field.mjs";

const FORCE = 0.004;
const SIDES = 14;

/** Overlays by name of the layer: each {object, update(state, look)}. */
export function overlays() {
  return { scans: scans("scan", 5), clouds: scans("cloud", 2.5), ranges: ranges(), forces: forces(), goals: goals(), paths: paths(), density: density(), ttc: collisions() };
}

function lines(width = 1) {
  const geometry = new THREE.BufferGeometry();
  const object = new THREE.LineSegments(geometry, new THREE.LineBasicMaterial({ transparent: true, opacity: 0.9, linewidth: width }));
  object.frustumCulled = false;
  return object;
}

/** Sets the positions of a geometry, with room to grow. */
function fill(geometry, points, size) {
  const known = geometry.getAttribute("position");
  if (!known || known.array.length < size) {
    const array = new Float32Array(Math.max(96, 2 * size));
    array.set(points.subarray ? points.subarray(0, size) : points);
    geometry.setAttribute("position", new THREE.BufferAttribute(array, 3).setUsage(THREE.DynamicDrawUsage));
  } else {
    known.array.set(points.subarray ? points.subarray(0, size) : points);
    known.needsUpdate = true;
  }
  geometry.setDrawRange(0, size / 3);
}

function scans(kind, size) {
  const object = new THREE.Points(new THREE.BufferGeometry(), roundPoints(size));
  object.frustumCulled = false;
  return {
    object,
    update(state, look) {
      const parts = state.scans(kind).map((one) => one.points);
      const total = parts.reduce((sum, one) => sum + one.length, 0);
      const points = new Float32Array(total);
      let at = 0;
      for (const part of parts) {
        points.set(part, at);
        at += part.length;
      }
      object.material.color.set(look[kind]);
      fill(object.geometry, points, total);
    },
  };
}

/** Points that are discs. */
function roundPoints(size) {
  const material = new THREE.PointsMaterial({ size, sizeAttenuation: false, alphaTest: 0.5 });
  material.onBeforeCompile = (shader) => {
    shader.fragmentShader = shader.fragmentShader.replace(
      "#include <alphatest_fragment>",
      "if (length(gl_PointCoord - 0.5) > 0.5) discard;",
    );
  };
  return material;
}

function ranges() {
  const geometry = new THREE.BufferGeometry();
  const object = new THREE.Mesh(
    geometry,
    new THREE.MeshBasicMaterial({ transparent: true, opacity: 0.22, depthWrite: false, side: THREE.DoubleSide }),
  );
  object.frustumCulled = false;
  const turn = new THREE.Quaternion();
  const rim = new THREE.Vector3();
  return {
    object,
    update(state, look) {
      const cones = state.frame.arrays.cones ?? new Float32Array(0);
      const sensors = state.description.sensors.filter((one) => one.kind === "cone");
      const points = [];
      for (let k = 0; k < cones.length / 9; k++) {
        const [x, y, z, w, a, b, c, reach] = cones.subarray(9 * k, 9 * k + 9);
        const angle = sensors[k]?.angle ?? 0.2;
        turn.set(a, b, c, w);
        const edge = (side) => {
          const around = (2 * Math.PI * side) / SIDES;
          rim.set(reach * Math.cos(angle), reach * Math.sin(angle) * Math.cos(around), reach * Math.sin(angle) * Math.sin(around));
          rim.applyQuaternion(turn);
          return [x + rim.x, y + rim.y, z + rim.z];
        };
        for (let side = 0; side < SIDES; side++) points.push(x, y, z, ...edge(side), ...edge(side + 1));
      }
      object.material.color.set(look.cone);
      fill(geometry, points, points.length);
    },
  };
}

function forces() {
  const object = new THREE.Group();
  const arrows = [];
  return {
    object,
    update(state, look) {
      const rows = state.frame.arrays.forces ?? new Float32Array(0);
      const count = rows.length / 6;
      while (arrows.length < count) {
        const arrow = new THREE.ArrowHelper(new THREE.Vector3(1, 0, 0), new THREE.Vector3(), 1, look.force);
        arrow.line.material.depthTest = arrow.cone.material.depthTest = false;
        arrow.renderOrder = 5;
        arrows.push(arrow);
        object.add(arrow);
      }
      arrows.forEach((arrow, k) => {
        arrow.visible = k < count;
        if (!arrow.visible) return;
        const [x, y, z, fx, fy, fz] = rows.subarray(6 * k, 6 * k + 6);
        const size = Math.hypot(fx, fy, fz);
        const length = Math.min(1.6, Math.max(0.15, FORCE * size));
        arrow.position.set(x, y, z);
        if (size > 1e-6) arrow.setDirection(new THREE.Vector3(fx / size, fy / size, fz / size));
        arrow.setLength(length, 0.25 * length, 0.14 * length);
        arrow.setColor(look.force);
      });
    },
  };
}

function goals() {
  const object = lines();
  return {
    object,
    update(state, look) {
      const { goals: aims, place } = state.frame.arrays;
      const points = [];
      for (let i = 0; aims && i < state.people; i++) {
        const [x, y] = [aims[2 * i], aims[2 * i + 1]];
        if (Number.isFinite(x) && Number.isFinite(y)) points.push(place[5 * i], place[5 * i + 1], 0.02, x, y, 0.02);
      }
      object.material.color.set(look.goal);
      object.material.opacity = 0.5;
      fill(object.geometry, points, points.length);
    },
  };
}

function paths() {
  const object = lines();
  return {
    object,
    update(state, look) {
      const points = [];
      eachPathPiece(state.frame, (x0, y0, x1, y1) => points.push(x0, y0, 0.035, x1, y1, 0.035));
      object.material.color.set(look.path);
      object.material.opacity = 0.75;
      fill(object.geometry, points, points.length);
    },
  };
}

/** Bands on the floor, because lines of more than a pixel do not exist in WebGL. */
function collisions() {
  const object = new THREE.Group();
  const bands = TIMES.map(({ color }) => {
    const material = new THREE.MeshBasicMaterial({ color, transparent: true, opacity: 0.9, depthWrite: false, side: THREE.DoubleSide });
    const mesh = new THREE.Mesh(new THREE.BufferGeometry(), material);
    mesh.frustumCulled = false;
    object.add(mesh);
    return mesh;
  });
  return {
    object,
    update(state) {
      const points = TIMES.map(() => []);
      eachCollision(state.frame, (at, x0, y0, x1, y1) => {
        const length = Math.hypot(x1 - x0, y1 - y0) || 1;
        const half = 0.011 * TIMES[at].width;
        const [nx, ny] = [(-half * (y1 - y0)) / length, (half * (x1 - x0)) / length];
        const corner = (x, y) => [x, y, 0.04];
        const [a, b, c, d] = [corner(x0 + nx, y0 + ny), corner(x0 - nx, y0 - ny), corner(x1 - nx, y1 - ny), corner(x1 + nx, y1 + ny)];
        points[at].push(...a, ...b, ...c, ...a, ...c, ...d);
      });
      bands.forEach((mesh, at) => fill(mesh.geometry, points[at], points[at].length));
    },
  };
}

function density() {
  const material = new THREE.MeshBasicMaterial({ transparent: true, depthWrite: false });
  const object = new THREE.Mesh(new THREE.PlaneGeometry(1, 1), material);
  return {
    object,
    update(state) {
      const image = densityImage(state.frame);
      object.scale.setScalar(image ? 1 : 0);
      if (!image) return;
      const { width, height, data, x, y, cell } = image;
      const known = material.map?.image;
      if (known?.width !== width || known?.height !== height) {
        material.map?.dispose();
        material.map = new THREE.DataTexture(new Uint8Array(data.length), width, height, THREE.RGBAFormat);
        material.map.colorSpace = THREE.SRGBColorSpace;
        material.map.magFilter = THREE.LinearFilter;
        material.needsUpdate = true;
      }
      material.map.image.data.set(data);
      material.map.needsUpdate = true;
      object.position.set(x + 0.5 * width * cell, y + 0.5 * height * cell, 0.02);
      object.scale.set(width * cell, height * cell, 1);
    },
  };
}
