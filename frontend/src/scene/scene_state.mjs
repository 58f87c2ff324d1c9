// SceneState: the description of a scene and its latest frame, read for drawing. crowdbot.web.scene makes both.
import { poseBones } from "./posing.mjs";

export const NOTHING = 65535;

export class SceneState {
  constructor() {
    this.description = null;
    this.frame = null;
    this.people = 0;
    this.heads = null;
    this.parents = null;
  }

  /** Sets the description and the skeletons (frame "bodies/LEVEL.bin"). */
  describe(description, bodies) {
    this.description = description;
    this.heads = bodies.arrays.heads;
    this.parents = bodies.arrays.parents;
    this.frame = null;
    this.people = 0;
  }

  /** Sets the frame; false if it belongs to another description. */
  apply(frame) {
    if (!this.description || frame.arrays.revision[0] !== this.description.revision) return false;
    this.frame = frame;
    this.people = frame.arrays.who.length;
    return true;
  }

  /** Number of people who are present, without riders of robots. */
  get walkers() {
    return this.frame ? this.frame.arrays.who.filter((row) => !this.description.people.rider[row]).length : 0;
  }

  get time() {
    return this.frame ? this.frame.time : 0;
  }

  /** Row of x, y, heading, vx, vy of a person or robot with this id, or null. */
  place(kind, id) {
    if (!this.frame) return null;
    const { ids, place, bots, botplace } = this.frame.arrays;
    if (kind === "robot") {
      const at = bots.findIndex((row) => this.description.robots[row].id === id);
      return at < 0 ? null : botplace.subarray(5 * at, 5 * at + 5);
    }
    const at = ids.indexOf(id);
    return at < 0 ? null : place.subarray(5 * at, 5 * at + 5);
  }

  /** Height [m] of what has this id. */
  height(kind, id) {
    if (kind === "robot") return this.description.robots.find((one) => one.id === id)?.height ?? 1;
    const at = this.frame ? this.frame.arrays.ids.indexOf(id) : -1;
    return at < 0 ? 1.7 : this.description.people.height[this.frame.arrays.who[at]];
  }

  /** Writes quaternions and shifts of the bones of all people; see poseBones. */
  pose(out, stride) {
    const { who, pelvis, bones } = this.frame.arrays;
    const { body, scale } = this.description.people;
    poseBones({ count: this.people, who, pelvis, bones, body, scale, heads: this.heads, parents: this.parents }, out, stride);
  }

  /** Returns [{number, sensor, points}] with the end points x, y, z of the beams of scanners; kind "scan" or "cloud". */
  scans(kind) {
    if (!this.frame) return [];
    const found = [];
    this.description.sensors.forEach((sensor, number) => {
      if (sensor.kind !== kind) return;
      const ranges = this.frame.arrays[`scan${number}`];
      const cloud = this.frame.arrays[`cloud${number}`];
      if (ranges) found.push({ number, sensor, points: scanPoints(ranges, this.frame.arrays[`pose${number}`], sensor) });
      else if (cloud) found.push({ number, sensor, points: cloud });
    });
    return found;
  }
}

/** End points [x, y, z, ...] of beams with a return. */
export function scanPoints(ranges, pose, sensor) {
  const points = new Float32Array(3 * ranges.length);
  const [px, py, pz, w, x, y, z] = pose;
  let size = 0;
  for (let k = 0; k < ranges.length; k++) {
    if (ranges[k] === NOTHING) continue;
    const angle = sensor.first + k * sensor.step;
    const reach = ranges[k] / 1000;
    const a = reach * Math.cos(angle);
    const b = reach * Math.sin(angle);
    points[size++] = px + (1 - 2 * (y * y + z * z)) * a + 2 * (x * y - w * z) * b;
    points[size++] = py + 2 * (x * y + w * z) * a + (1 - 2 * (x * x + z * z)) * b;
    points[size++] = pz + 2 * (x * z - w * y) * a + 2 * (y * z + w * x) * b;
  }
  return points.subarray(0, size);
}
