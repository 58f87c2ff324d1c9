// Strips: every run of an evaluation as a mark on the axis of one statistic, one strip for each row of the table.
const NS = "http://www.w3.org/2000/svg";
const WIDTH = 720;
const LEFT = 190;
const HEIGHT = 26;
const MARKS = { success: "circle", collision: "cross", timeout: "square", finished: "square" };

function s(tag, attributes, ...children) {
  const element = document.createElementNS(NS, tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else element.setAttribute(name, value);
  }
  element.append(...children);
  return element;
}

/** The picture of one statistic; `watch(cell, seed)` is called for a run that is chosen. */
export function makeStrips(cells, index, title, watch) {
  const values = cells.flatMap((cell) => cell.runs.map((run) => run.values[index])).filter((one) => one !== null);
  const low = Math.min(0, ...values);
  const high = Math.max(...values, low + 1e-9);
  const x = (value) => LEFT + ((WIDTH - LEFT - 20) * (value - low)) / (high - low);
  const height = cells.length * HEIGHT + 30;
  const picture = s("svg", { viewBox: `0 0 ${WIDTH} ${height}`, class: "strips", role: "group", "aria-label": `Runs by ${title}` });
  const name = namesOf(cells);
  cells.forEach((cell, row) => {
    const y = row * HEIGHT + HEIGHT / 2;
    picture.append(s("text", { x: LEFT - 10, y: y + 4, "text-anchor": "end" }, name(cell).slice(0, 30)));
    picture.append(s("line", { x1: LEFT, x2: WIDTH - 20, y1: y, y2: y, class: "axis" }));
    for (const run of cell.runs) if (run.values[index] !== null) picture.append(mark(cell, run, x(run.values[index]), y, watch));
  });
  for (const value of niceTicks(low, high)) {
    picture.append(s("line", { x1: x(value), x2: x(value), y1: 4, y2: height - 24, class: "tick" }));
    picture.append(s("text", { x: x(value), y: height - 8, "text-anchor": "middle" }, String(value)));
  }
  return picture;
}

/** The name of a row: with chosen robots what differs between the rows, otherwise trial and navigator. */
function namesOf(cells) {
  const differs = (key) => new Set(cells.map((cell) => cell[key])).size > 1;
  const keys = differs("named") ? ["trial", "navigator", "named"].filter(differs) : ["trial", "navigator"];
  return (cell) => keys.map((key) => cell[key] || "own").join(" ");
}

/** Round numbers between two bounds, about five. */
function niceTicks(low, high) {
  const raw = (high - low) / 4;
  const power = 10 ** Math.floor(Math.log10(raw));
  const step = power * ([1, 2, 5, 10].find((one) => one * power >= raw) ?? 10);
  const first = Math.ceil(low / step);
  const count = Math.floor(high / step) - first + 1;
  return Array.from({ length: Math.max(0, count) }, (_, i) => Number(((first + i) * step).toPrecision(6)));
}

function mark(cell, run, x, y, watch) {
  const kind = MARKS[run.outcome] ?? "cross";
  const shapes = {
    circle: () => s("circle", { cx: x, cy: y, r: 4 }),
    square: () => s("rect", { x: x - 4, y: y - 4, width: 8, height: 8 }),
    cross: () => s("path", { d: `M${x - 4} ${y - 4}L${x + 4} ${y + 4}M${x + 4} ${y - 4}L${x - 4} ${y + 4}` }),
  };
  const shape = shapes[kind]();
  shape.setAttribute("class", `mark ${kind}`);
  shape.addEventListener("click", () => watch(cell.number, run.seed));
  shape.append(s("title", {}, `seed ${run.seed}: ${run.outcome}`));
  return shape;
}
