// Blend: a frame between two frames of a scene, so that motion is smooth between recorded instants.

/** Arrays that are written again and again, so that a picture makes no garbage. */
export class BlendBuffer {
  constructor() {
    this._arrays = new Map();
  }

  /** Returns an array like another one, with its values. */
  copy(name, like) {
    let found = this._arrays.get(name);
    if (!found || found.buffer.byteLength < like.byteLength || found.constructor !== like.constructor) {
      found = new like.constructor(Math.ceil(1.25 * like.length) + 16);
      this._arrays.set(name, found);
    }
    const part = found.subarray(0, like.length);
    part.set(like);
    return part;
  }
}

/** Values of people and of robots that are blended: columns, and columns before each quaternion. */
const PEOPLE = { place: 5, pelvis: 3, bones: 112 };

/**
 * Returns the frame at a share (0 to 1) between two frames of the same description. Who is only in the later one is
 * there as in it; arrays of layers are those of the earlier one.
 * @param {BlendBuffer} buffer where the arrays are written
 */
export function blendFrames(from, to, share, buffer = new BlendBuffer()) {
  if (share <= 0 || from.arrays.revision[0] !== to.arrays.revision[0]) return from;
  if (share >= 1) return to;
  const arrays = { ...to.arrays };
  const rows = matches(from.arrays.ids, to.arrays.ids);
  for (const [name, columns] of Object.entries(PEOPLE)) {
    arrays[name] = blendRows(buffer.copy(name, to.arrays[name]), from.arrays[name], to.arrays[name], rows, columns, share, name === "bones" ? 0 : -1);
  }
  turnHeadings(arrays.place, from.arrays.place, to.arrays.place, rows, share);
  if (same(from.arrays.bots, to.arrays.bots)) {
    const bots = Array.from(to.arrays.bots, (_, k) => k);
    arrays.botplace = blendRows(buffer.copy("botplace", to.arrays.botplace), from.arrays.botplace, to.arrays.botplace, bots, 5, share, -1);
    turnHeadings(arrays.botplace, from.arrays.botplace, to.arrays.botplace, bots, share);
    const links = Array.from({ length: to.arrays.links.length / 7 }, (_, k) => k);
    arrays.links = blendRows(buffer.copy("links", to.arrays.links), from.arrays.links, to.arrays.links, links, 7, share, 3);
  }
  if (arrays.props && same(from.arrays.propnum ?? [], arrays.propnum)) {
    const props = Array.from(arrays.propnum, (_, k) => k);
    arrays.props = blendRows(buffer.copy("props", to.arrays.props), from.arrays.props, to.arrays.props, props, 7, share, 3);
  }
  for (const name of Object.keys(from.arrays)) {
    if (/^(scan|pose|cloud)\d+$/.test(name) || name === "cones" || name === "forces") arrays[name] = from.arrays[name];
  }
  return { ...to, time: from.time + share * (to.time - from.time), arrays };
}

/** Rows of the earlier frame with the ids of the later one, -1 where there is none. */
function matches(before, after) {
  if (same(before, after)) return Array.from(after, (_, k) => k);
  const known = new Map(Array.from(before, (id, k) => [id, k]));
  return Array.from(after, (id) => known.get(id) ?? -1);
}

function same(a, b) {
  return a.length === b.length && a.every((one, k) => one === b[k]);
}

/** Blends rows; from the column `turn` on, each four values are a quaternion (-1: none). */
function blendRows(out, a, b, rows, columns, share, turn) {
  for (let k = 0; k < rows.length; k++) {
    const row = rows[k];
    if (row < 0) continue;
    const [p, q] = [row * columns, k * columns];
    const plain = turn < 0 ? columns : turn;
    for (let c = 0; c < plain; c++) out[q + c] = a[p + c] + share * (b[q + c] - a[p + c]);
    for (let c = plain; c < columns; c += 4) {
      let dot = 0;
      for (let d = c; d < c + 4; d++) dot += a[p + d] * b[q + d];
      const side = dot < 0 ? -1 : 1;
      for (let d = c; d < c + 4; d++) out[q + d] = a[p + d] + share * (side * b[q + d] - a[p + d]);
    }
  }
  return out;
}

/** Blends headings on the shorter arc. */
function turnHeadings(out, a, b, rows, share) {
  rows.forEach((row, k) => {
    if (row < 0) return;
    const from = a[5 * row + 2];
    const turn = b[5 * k + 2] - from;
    out[5 * k + 2] = from + share * Math.atan2(Math.sin(turn), Math.cos(turn));
  });
}
