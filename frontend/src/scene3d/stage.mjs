// Stage: floor, walls, uneven ground, doors, props and zones.
import * as THREE from "three";
import { doorMesh, propMesh } from "./props.mjs";

export const CUT = 1.1;
const THIN = 0.06;

export class Stage {
  constructor() {
    this.group = new THREE.Group();
    this.parts = {};
    for (const name of ["floor", "walls", "props", "zones"]) {
      this.parts[name] = new THREE.Group();
      this.group.add(this.parts[name]);
    }
    this._doors = [];
    this._props = new Map();
    this._height = 2.5;
    this._full = false;
  }

  /** Draws the stage of a description with the colours of a look. */
  build(description, look) {
    this._clear();
    const { stage, zones, bounds } = description;
    this._floor(bounds, look);
    this._walls(stage, look);
    this._height = stage.height;
    this.full = this._full;
    for (const part of stage.ground) this.parts.floor.add(groundMesh(part, look));
    this._doors = stage.doors.map((door) => {
      const mesh = doorMesh(door, look);
      this.parts.props.add(mesh);
      return { door, mesh };
    });
    stage.props.forEach((prop, number) => {
      const mesh = propMesh(prop, look);
      if (!mesh) return;
      this.parts.props.add(mesh);
      this._props.set(number, mesh);
    });
    for (const zone of zones) this.parts.zones.add(...zoneMeshes(zone, look));
    for (const robot of description.robots) if (!robot.ghost) this.parts.zones.add(...goalMeshes(robot, look));
  }

  /** Whether walls have their full height; otherwise they are cut so that people behind them are seen. */
  set full(full) {
    this._full = full;
    this.parts.walls.scale.z = full ? 1 : Math.min(1, CUT / this._height);
  }

  /** Moves doors and props. */
  update(arrays) {
    if (arrays.doors) this._doors.forEach(({ door, mesh }, k) => turnDoor(door, mesh, arrays.doors[k]));
    if (!arrays.props) return;
    arrays.propnum.forEach((number, k) => {
      const mesh = this._props.get(number);
      if (!mesh) return;
      const [x, y, z, w, a, b, c] = arrays.props.subarray(7 * k, 7 * k + 7);
      mesh.position.set(x, y, z - mesh.userData.rise);
      mesh.quaternion.set(a, b, c, w);
      const up = new THREE.Vector3(0, 0, -mesh.userData.rise).applyQuaternion(mesh.quaternion);
      mesh.position.set(x + up.x, y + up.y, z + up.z);
    });
  }

  set grid(on) {
    if (this._grid) this._grid.shown.value = on ? 1 : 0;
  }

  set shadows(on) {
    this.group.traverse((one) => {
      if (one.userData.casts) one.castShadow = on;
    });
  }

  dispose() {
    this._clear();
  }

  _clear() {
    for (const part of Object.values(this.parts)) {
      part.traverse((one) => {
        one.geometry?.dispose();
        one.material?.map?.dispose();
        one.material?.dispose();
      });
      part.clear();
    }
    this._doors = [];
    this._props.clear();
  }

  _floor([x0, y0, x1, y1], look) {
    const size = 120 + 2 * Math.max(x1 - x0, y1 - y0);
    this._grid = floorMaterial(look);
    const floor = new THREE.Mesh(new THREE.PlaneGeometry(size, size), this._grid.material);
    floor.position.set(0.5 * (x0 + x1), 0.5 * (y0 + y1), 0);
    floor.receiveShadow = true;
    this.parts.floor.add(floor);
  }

  _walls({ walls, height }, look) {
    const sides = [];
    const caps = [];
    const lines = [];
    for (const wall of walls) {
      const ring = wall.solid ? wall.points : boardRing(wall.points);
      const n = ring.length;
      for (let k = 0; k < n; k++) {
        const [a, b] = [ring[k], ring[(k + 1) % n]];
        sides.push(a[0], a[1], 0, b[0], b[1], 0, b[0], b[1], height, a[0], a[1], 0, b[0], b[1], height, a[0], a[1], height);
        lines.push(a[0], a[1], height, b[0], b[1], height);
        if (wall.inner) lines.push(a[0], a[1], 0.01, b[0], b[1], 0.01);
      }
      if (!wall.inner) caps.push(...flat(ring, height));
    }
    if (!sides.length) return;
    this.parts.walls.add(surface(sides, new THREE.MeshLambertMaterial({ color: look.wall }), true));
    if (caps.length) this.parts.walls.add(surface(caps, new THREE.MeshLambertMaterial({ color: look.wallTop }), false));
    const edges = new THREE.BufferGeometry();
    edges.setAttribute("position", new THREE.Float32BufferAttribute(lines, 3));
    this.parts.walls.add(new THREE.LineSegments(edges, new THREE.LineBasicMaterial({ color: look.wallTop })));
  }
}

/** Triangles of a polygon at a height. */
export function flat(points, height) {
  const contour = points.map(([x, y]) => new THREE.Vector2(x, y));
  if (THREE.ShapeUtils.isClockWise(contour)) contour.reverse();
  return THREE.ShapeUtils.triangulateShape(contour, []).flatMap((face) =>
    face.flatMap((k) => [contour[k].x, contour[k].y, height]),
  );
}

export function surface(positions, material, casts) {
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(positions, 3));
  geometry.computeVertexNormals();
  const mesh = new THREE.Mesh(geometry, material);
  mesh.castShadow = mesh.userData.casts = casts;
  mesh.receiveShadow = true;
  return mesh;
}

function boardRing([[ax, ay], [bx, by]]) {
  const length = Math.hypot(bx - ax, by - ay) || 1;
  const [nx, ny] = [(-0.5 * THIN * (by - ay)) / length, (0.5 * THIN * (bx - ax)) / length];
  return [[ax - nx, ay - ny], [bx - nx, by - ny], [bx + nx, by + ny], [ax + nx, ay + ny]];
}

/** A floor with smooth lines every metre and every ten metres. */
function floorMaterial(look) {
  const material = new THREE.MeshLambertMaterial({
    color: look.floor, polygonOffset: true, polygonOffsetFactor: 2, polygonOffsetUnits: 8,
  });
  const shown = { value: 1 };
  material.onBeforeCompile = (shader) => {
    Object.assign(shader.uniforms, {
      gridShown: shown, gridLine: { value: new THREE.Color(look.line) }, gridLine10: { value: new THREE.Color(look.line10) },
    });
    shader.vertexShader = shader.vertexShader
      .replace("#include <common>", "#include <common>\nvarying vec2 vPlace;")
      .replace("#include <begin_vertex>", "#include <begin_vertex>\nvPlace = (modelMatrix * vec4(position, 1.0)).xy;");
    shader.fragmentShader = shader.fragmentShader
      .replace("#include <common>", `#include <common>
        varying vec2 vPlace;
        uniform float gridShown;
        uniform vec3 gridLine, gridLine10;
        float gridAt(float step, float width) {
          vec2 at = vPlace / step;
          vec2 slope = fwidth(at);
          vec2 near = abs(fract(at - 0.5) - 0.5) / max(slope, vec2(1e-6));
          vec2 line = clamp(width - near, 0.0, 1.0) * clamp(0.45 / max(slope, vec2(1e-6)) - 0.8, 0.0, 1.0);
          return max(line.x, line.y);
        }`)
      .replace("#include <color_fragment>", `#include <color_fragment>
        diffuseColor.rgb = mix(diffuseColor.rgb, gridLine, gridShown * gridAt(1.0, 1.0));
        diffuseColor.rgb = mix(diffuseColor.rgb, gridLine10, gridShown * gridAt(10.0, 1.4));`);
  };
  return { material, shown };
}

function groundMesh({ corners, heights }, look) {
  const at = corners.map(([x, y], k) => [x, y, heights[k]]);
  const faces = [...at[0], ...at[1], ...at[2], ...at[0], ...at[2], ...at[3]];
  for (let k = 0; k < 4; k++) {
    const [a, b] = [at[k], at[(k + 1) % 4]];
    faces.push(a[0], a[1], 0, b[0], b[1], 0, ...b, a[0], a[1], 0, ...b, ...a);
  }
  return surface(faces, new THREE.MeshLambertMaterial({ color: look.ground }), true);
}

function zoneMeshes(zone, look) {
  const color = look[zone.kind];
  const fill = surface(
    flat(zone.points, 0.006),
    new THREE.MeshBasicMaterial({ color, transparent: true, opacity: zone.kind === "start" ? 0.05 : 0.14, depthWrite: false }),
    false,
  );
  fill.receiveShadow = false;
  const edge = new THREE.BufferGeometry().setFromPoints(zone.points.map(([x, y]) => new THREE.Vector3(x, y, 0.012)));
  const line = new THREE.LineLoop(
    edge,
    zone.kind === "goal" || zone.kind === "exit"
      ? new THREE.LineDashedMaterial({ color, dashSize: 0.25, gapSize: 0.15 })
      : new THREE.LineBasicMaterial({ color }),
  );
  line.computeLineDistances();
  return [fill, line];
}

function goalMeshes({ goal }, look) {
  const ring = new THREE.Mesh(
    new THREE.RingGeometry(Math.max(0.05, goal.tolerance - 0.05), goal.tolerance, 48),
    new THREE.MeshBasicMaterial({ color: look.robotGoal, transparent: true, opacity: 0.9 }),
  );
  ring.position.set(goal.x, goal.y, 0.014);
  const pole = new THREE.Mesh(
    new THREE.CylinderGeometry(0.018, 0.018, 1.5, 10).rotateX(Math.PI / 2),
    new THREE.MeshLambertMaterial({ color: look.ink }),
  );
  pole.position.set(goal.x, goal.y, 0.75);
  const flag = surface([0, 0, 1.5, 0, 0, 1.15, 0.5, 0, 1.32], new THREE.MeshBasicMaterial({ color: look.robotGoal, side: THREE.DoubleSide }), true);
  flag.position.set(goal.x, goal.y, 0);
  return [ring, pole, flag];
}

function turnDoor(door, mesh, share) {
  if (door.kind === "sliding") {
    mesh.position.set(
      door.x - share * door.width * Math.cos(door.yaw), door.y - share * door.width * Math.sin(door.yaw), 0,
    );
  } else {
    mesh.rotation.z = door.yaw + share * door.angle;
  }
}
