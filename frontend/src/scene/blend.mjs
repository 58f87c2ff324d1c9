// Blend: a frame between two frames of a scene, so that motion is smooth between recorded instants.

/** Values of people and of robots that are blended: columns, and columns before each quaternion. */
const PEOPLE = { place: 5, pelvis: 3, bones: 112 };

/**
 * Returns the frame at a share (0 to 1) between two frames of the same description. Who is only in the later one is
 * there as in it; arrays of layers are those of the earlier one.
 */
export function blendFrames(from, to, share) {
  if (share <= 0 || from.arrays.revision[0] !== to.arrays.revision[0]) return from;
  if (share >= 1) return to;
  const arrays = { ...to.arrays };
  const rows = matches(from.arrays.ids, to.arrays.ids);
  for (const [name, columns] of Object.entries(PEOPLE)) {
    arrays[name] = blendRows(from.arrays[name], to.arrays[name], rows, columns, share, name === "bones" ? 0 : -1);
  }
  turnHeadings(arrays.place, from.arrays.place, to.arrays.place, rows, share);
  if (same(from.arrays.bots, to.arrays.bots)) {
    const bots = Array.from(to.arrays.bots, (_, k) => k);
    arrays.botplace = blendRows(from.arrays.botplace, to.arrays.botplace, bots, 5, share, -1);
    turnHeadings(arrays.botplace, from.arrays.botplace, to.arrays.botplace, bots, share);
    const links = Array.from({ length: to.arrays.links.length / 7 }, (_, k) => k);
    arrays.links = blendRows(from.arrays.links, to.arrays.links, links, 7, share, 3);
  }
  if (arrays.props && same(from.arrays.propnum ?? [], arrays.propnum)) {
    const props = Array.from(arrays.propnum, (_, k) => k);
    arrays.props = blendRows(from.arrays.props, to.arrays.props, props, 7, share, 3);
  }
  for (const name of Object.keys(from.arrays)) {
    if (/^(scan|pose|cloud)\d+$/.test(name) || name === "cones" || name === "forces") arrays[name] = from.arrays[name];
  }
  return { ...to, time: from.time + share * (to.time - from.time), arrays };
}

/** Rows of the earlier frame with the ids of the later one, -1 where there is none. */
function matches(before, after) {
  const known = new Map(Array.from(before, (id, k) => [id, k]));
  return Array.from(after, (id) => known.get(id) ?? -1);
}

function same(a, b) {
  return a.length === b.length && a.every((one, k) => one === b[k]);
}

/** Blends rows; from the column `turn` on, each four values are a quaternion (-1: none). */
function blendRows(a, b, rows, columns, share, turn) {
  const out = b.slice();
  rows.forEach((row, k) => {
    if (row < 0) return;
    const [p, q] = [row * columns, k * columns];
    const plain = turn < 0 ? columns : turn;
    for (let c = 0; c < plain; c++) out[q + c] = a[p + c] + share * (b[q + c] - a[p + c]);
    for (let c = plain; c < columns; c += 4) {
      let dot = 0;
      for (let d = c; d < c + 4; d++) dot += a[p + d] * b[q + d];
      const side = dot < 0 ? -1 : 1;
      for (let d = c; d < c + 4; d++) out[q + d] = a[p + d] + share * (side * b[q + d] - a[p + d]);
    }
  });
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
