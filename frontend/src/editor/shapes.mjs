// Shapes: what the elements of a trial look like from above, and the attributes that change when they are moved.

const number = (text, otherwise = 0) => {
  const value = Number.parseFloat(text);
  return Number.isFinite(value) ? value : otherwise;
};

/** Points of "0,0 4,0", without those that are no numbers. */
export function parsePoints(text) {
  return (text ?? "")
    .trim()
    .replace(/\s*,\s*/g, ",")
    .split(/\s+/)
    .map((pair) => pair.split(",").map(Number))
    .filter((pair) => pair.length === 2 && pair.every(Number.isFinite));
}

/** A length or coordinate with at most millimetres. */
export const plain = (value) => String(Math.round(value * 1000) / 1000);

/** Text of points as trial files have it. */
export const formatPoints = (points) => points.map(([x, y]) => `${plain(x)},${plain(y)}`).join(" ");

const AREAS = {
  wall: [["points", false, "wall"]],
  obstacle: [["points", true, "solid"]],
  stage: [["walkable", true, "ground"]],
  door: [["points", false, "door"]],
  spawner: [["zone", true, "people"], ["goal", true, "goal"]],
  source: [["zone", true, "people"], ["goal", true, "goal"]],
  exit: [["zone", true, "exit"]],
  portal: [["zone", true, "exit"]],
  zone: [["points", true, "goal"]],
  agent: [["goal-zone", true, "goal"], ["goal", false, "target"]],
};
const BOXES = {
  cube: (a) => [number(a.size, 0.5), number(a.size, 0.5)],
  table: (a) => [number(a.length, 1.6), number(a.width, 0.8)],
  chair: (a) => [number(a.size, 0.44), number(a.size, 0.44)],
  ramp: (a) => [number(a.length, 1), number(a.width, 1.5)],
  platform: (a) => [number(a.length, 1), number(a.width, 1)],
  threshold: (a) => [number(a.depth, 0.1), number(a.width, 1)],
  stairs: (a) => [number(a.steps, 1) * number(a.tread, 0.29), number(a.width, 1.5)],
};
const DISCS = {
  tree: (a) => [number(a.trunk, 0.15), "solid"],
  light: () => [0.15, "light"],
  agent: (a) => [number(a.radius, 0.25), "person"],
  avatar: (a) => [number(a.radius, 0.25), "person"],
  robot: (a) => [number(a.radius, 0.3), "robot"],
  goal: (a) => [number(a.tolerance, 0.3), "target"],
  point: (a) => [number(a.tolerance, 0.3), "target"],
  camera: () => [0.2, "camera"],
};
const HEADINGS = new Set(["robot", "agent", "camera", "avatar", "ramp", "stairs", "cube", "table", "chair"]);

/**
 * Returns the shapes of a tree of elements in the order of drawing:
 * {path, tag, style, points, closed, attribute?, centre?, radius?, heading?}.
 */
export function shapesOf(node, path = []) {
  const shapes = [];
  const mounted = node.tag === "camera" && node.attributes.robot;
  for (const [attribute, closed, style] of AREAS[node.tag] ?? []) {
    const points = parsePoints(node.attributes[attribute]);
    if (points.length) shapes.push({ path, tag: node.tag, style, points, closed, attribute });
  }
  if (BOXES[node.tag]) shapes.push(box(node, path));
  else if (DISCS[node.tag] && "x" in node.attributes && !mounted) shapes.push(disc(node, path));
  const inner = node.children.flatMap((one, i) => shapesOf(one, [...path, i]));
  return [...shapes, ...inner];
}

function disc(node, path) {
  const [radius, style] = DISCS[node.tag](node.attributes);
  const heading = HEADINGS.has(node.tag) && "heading" in node.attributes ? number(node.attributes.heading) : null;
  return { path, tag: node.tag, style, centre: centre(node), radius, heading, points: [centre(node)], closed: false };
}

function box(node, path) {
  const [length, width] = BOXES[node.tag](node.attributes);
  const heading = number(node.attributes.heading);
  const [x, y] = centre(node);
  const [c, s] = [Math.cos(heading), Math.sin(heading)];
  const corners = [[1, 1], [-1, 1], [-1, -1], [1, -1]].map(([i, j]) => [
    x + (c * i * length - s * j * width) / 2,
    y + (s * i * length + c * j * width) / 2,
  ]);
  return { path, tag: node.tag, style: "prop", points: corners, closed: true, centre: [x, y], heading };
}

const centre = (node) => [number(node.attributes.x), number(node.attributes.y)];

/** Changes that move a whole element and what belongs to it by (dx, dy). */
export function moveChanges(node, path, dx, dy) {
  const rows = [];
  if ("x" in node.attributes || BOXES[node.tag] || node.tag === "robot" || node.tag === "agent") {
    const [x, y] = centre(node);
    rows.push({ path, name: "x", value: plain(x + dx) }, { path, name: "y", value: plain(y + dy) });
    return rows;
  }
  const [[attribute] = []] = AREAS[node.tag] ?? [];
  if (attribute) {
    const points = parsePoints(node.attributes[attribute]).map(([x, y]) => [x + dx, y + dy]);
    rows.push({ path, name: attribute, value: formatPoints(points) });
  }
  return rows;
}

/** Changes that move one area of an element, such as the goal zone of a spawner. */
export function areaChanges(node, path, attribute, dx, dy) {
  const points = parsePoints(node.attributes[attribute]).map(([x, y]) => [x + dx, y + dy]);
  return [{ path, name: attribute, value: formatPoints(points) }];
}

/** Changes that put one corner elsewhere. */
export function cornerChanges(node, path, attribute, index, point) {
  const points = parsePoints(node.attributes[attribute]);
  points[index] = point;
  return [{ path, name: attribute, value: formatPoints(points) }];
}

/** Smallest rectangle around all shapes: [left, low, right, high]. */
export function extent(shapes, people = []) {
  const points = [...shapes.flatMap((one) => one.points), ...people];
  if (!points.length) return [-5, -5, 5, 5];
  const xs = points.map((one) => one[0]);
  const ys = points.map((one) => one[1]);
  return [Math.min(...xs) - 1, Math.min(...ys) - 1, Math.max(...xs) + 1, Math.max(...ys) + 1];
}
