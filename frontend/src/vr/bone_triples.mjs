// Rotations of bones from three of the four parts of each quaternion; crowdbot.vr.pack_triples packs them.
const UNIT = 32767;
const HALF = 16383 * Math.SQRT2;
const OTHERS = [[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]];

/** Gives a frame the array "bones" of quaternions w, x, y, z. */
export function unpackBones(frame) {
  const { triples } = frame.arrays;
  if (!triples) return frame;
  const count = triples.length / 3;
  const bones = new Int16Array(4 * count);
  for (let k = 0; k < count; k++) {
    const largest = (triples[3 * k] & 1) | ((triples[3 * k + 1] & 1) << 1);
    let rest = 1;
    for (let c = 0; c < 3; c++) {
      const part = (triples[3 * k + c] >> 1) / HALF;
      rest -= part * part;
      bones[4 * k + OTHERS[largest][c]] = Math.round(part * UNIT);
    }
    bones[4 * k + largest] = Math.round(Math.sqrt(Math.max(0, rest)) * UNIT);
  }
  frame.arrays.bones = bones;
  return frame;
}
