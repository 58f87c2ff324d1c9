// Words and values of plots.
const DIGITS = 4;

/** Label of an axis or a line: "Error [m]". */
export function labelOf({ label, unit }) {
  return unit ? `${label} [${unit}]` : label;
}

/** Values that uPlot can draw: numbers, and null for gaps. */
export function drawable(values) {
  return Array.from(values, (one) => (Number.isFinite(one) ? one : null));
}

/** One sentence about the newest values, for people who do not see the plot. */
export function describeData(title, x, series, [xs, ...rows]) {
  const last = xs.length - 1;
  if (last < 0) return `${title}: no data yet`;
  const words = series.map((one, i) => {
    const found = rows[i]?.findLast((value) => Number.isFinite(value));
    return `${labelOf(one)} ${found === undefined ? "without value" : Number(found.toPrecision(DIGITS))}`;
  });
  return `${title}, ${labelOf(x)} ${Number(xs[0].toPrecision(DIGITS))} to ${Number(xs[last].toPrecision(DIGITS))}: ${words.join(", ")}`;
}
