// Posing: from the quaternions of a frame to the transforms of bones.
export const BONES = 28;
export const BONE_UNIT = 32767;

/**
 * Writes for each person i and bone k, from out[i * stride + 8 * k] on: the unit quaternion x, y, z, w and the shift
 * x, y, z, 0, so that a vertex v of the scaled rest shape is at R v + shift.
 *
 * A bone starts at the end of its parent: P[k] = P[p] + R[p] (head[k] - head[p]), and its shift is P[k] - R[k] head[k].
 */
export function poseBones({ count, who, pelvis, bones, body, scale, heads, parents }, out, stride) {
  const place = new Float64Array(3 * BONES);
  for (let i = 0; i < count; i++) {
    const first = 3 * BONES * body[who[i]];
    const size = scale[who[i]];
    for (let k = 0; k < BONES; k++) {
      const at = i * stride + 8 * k;
      const from = 4 * (i * BONES + k);
      let w = bones[from], x = bones[from + 1], y = bones[from + 2], z = bones[from + 3];
      const unit = 1 / Math.hypot(w, x, y, z);
      w *= unit; x *= unit; y *= unit; z *= unit;
      out[at] = x; out[at + 1] = y; out[at + 2] = z; out[at + 3] = w;
      const p = parents[k];
      if (p < 0) {
        place[0] = pelvis[3 * i]; place[1] = pelvis[3 * i + 1]; place[2] = pelvis[3 * i + 2];
      } else {
        const q = i * stride + 8 * p;
        turn(
          out[q], out[q + 1], out[q + 2], out[q + 3],
          size * (heads[first + 3 * k] - heads[first + 3 * p]),
          size * (heads[first + 3 * k + 1] - heads[first + 3 * p + 1]),
          size * (heads[first + 3 * k + 2] - heads[first + 3 * p + 2]),
        );
        for (let c = 0; c < 3; c++) place[3 * k + c] = place[3 * p + c] + turned[c];
      }
      turn(x, y, z, w, size * heads[first + 3 * k], size * heads[first + 3 * k + 1], size * heads[first + 3 * k + 2]);
      for (let c = 0; c < 3; c++) out[at + 4 + c] = place[3 * k + c] - turned[c];
      out[at + 7] = 0;
    }
  }
}

/** Where the trunk of person i points in the plan, x and y; its length is 0 upright and 1 lying. */
export function leanOf(bones, i) {
  const at = 4 * BONES * i;
  const [w, x, y, z] = [bones[at], bones[at + 1], bones[at + 2], bones[at + 3]];
  const unit = 2 / (w * w + x * x + y * y + z * z);
  return [unit * (x * z + w * y), unit * (y * z - w * x)];
}

const turned = new Float64Array(3);

/** Writes the vector a, b, c turned by the quaternion x, y, z, w into `turned`. */
function turn(x, y, z, w, a, b, c) {
  const tx = 2 * (y * c - z * b), ty = 2 * (z * a - x * c), tz = 2 * (x * b - y * a);
  turned[0] = a + w * tx + y * tz - z * ty;
  turned[1] = b + w * ty + z * tx - x * tz;
  turned[2] = c + w * tz + x * ty - y * tx;
}
