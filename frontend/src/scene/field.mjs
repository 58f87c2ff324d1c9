// Fields and lines computed from a crowd: colours, classes and legends of density, time to collision and paths.

/** Density [1/m2] of one unit of the field, as in crowdbot.web.scene. */
const UNIT = 0.025;
/** Levels of service: upper limit [1/m2], colour (Okabe and Ito), opacity. */
export const DENSITIES = [
  { to: 0.3, color: [86, 180, 233], alpha: 0 },
  { to: 0.5, color: [86, 180, 233], alpha: 0.35 },
  { to: 1, color: [0, 158, 115], alpha: 0.4 },
  { to: 2, color: [240, 228, 66], alpha: 0.5 },
  { to: 4, color: [230, 159, 0], alpha: 0.6 },
  { to: Infinity, color: [213, 94, 0], alpha: 0.7 },
];
/** Times to collision: upper limit [s], colour, width [pixels]. */
export const TIMES = [
  { to: 1, color: "#d55e00", width: 4 },
  { to: 2, color: "#e69f00", width: 2.5 },
  { to: 3, color: "#56b4e9", width: 1.5 },
];

/** Returns {width, height, data, x, y, cell}: RGBA of a density field, its corner and its cell [m]; null without one. */
export function densityImage(frame) {
  const { density, densbox } = frame.arrays;
  if (!density) return null;
  const width = frame.columns.density;
  const height = density.length / width;
  const data = new Uint8ClampedArray(4 * density.length);
  density.forEach((units, k) => {
    const level = DENSITIES.find(({ to }) => units * UNIT < to);
    data.set(level.color, 4 * k);
    data[4 * k + 3] = 255 * level.alpha;
  });
  return { width, height, data, x: densbox[0], y: densbox[1], cell: densbox[2] };
}

/** Calls line(class, x0, y0, x1, y1) for each pair with a time to collision. */
export function eachCollision(frame, line) {
  const rows = frame.arrays.ttc ?? [];
  for (let k = 0; k < rows.length; k += 5) {
    const at = TIMES.findIndex(({ to }) => rows[k + 4] < to);
    line(at < 0 ? TIMES.length - 1 : at, rows[k], rows[k + 1], rows[k + 2], rows[k + 3]);
  }
}

/** Calls line(x0, y0, x1, y1) for each piece of the predicted paths. */
export function eachPathPiece(frame, line) {
  const { paths } = frame.arrays;
  const columns = frame.columns.paths;
  if (!paths || columns < 4) return;
  for (let row = 0; row < paths.length; row += columns) {
    for (let c = row; c + 3 < row + columns; c += 2) line(paths[c], paths[c + 1], paths[c + 2], paths[c + 3]);
  }
}

/** Rows of the legend of a layer: [{color, text, width}], or none. */
export function legend(name, look, predictor) {
  if (name === "paths") return [{ color: look.path, text: `${predictor}, next 4.8 s`, width: 2 }];
  if (name === "ttc") {
    return TIMES.map(({ to, color, width }) => ({ color, width, text: `collision within ${to} s` }));
  }
  if (name !== "density") return [];
  return DENSITIES.slice(1).map(({ to, color }, k) => ({
    color: `rgb(${color})`, width: 10,
    text: to === Infinity ? `above ${DENSITIES[k].to} people/m²` : `${DENSITIES[k].to} to ${to} people/m²`,
  }));
}
