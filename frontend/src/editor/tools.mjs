// Tools: what can be drawn, and the XML of what was drawn.
import { followChanges, wayXml } from "./journeys.mjs";
import { formatPoints, plain } from "./shapes.mjs";

const xy = ([x, y]) => `x="${plain(x)}" y="${plain(y)}"`;

/** The corners of the rectangle between two points. */
export const rectangle = ([a, b], [c, d]) => [[Math.min(a, c), Math.min(b, d)], [Math.max(a, c), Math.min(b, d)], [Math.max(a, c), Math.max(b, d)], [Math.min(a, c), Math.max(b, d)]];

const freeName = (tree, tag, base) => {
  const taken = new Set(tree.children.filter((one) => one.tag === tag).map((one) => one.attributes.name || base));
  if (!taken.has(base)) return base;
  let i = 2;
  while (taken.has(`${base}${i}`)) i++;
  return `${base}${i}`;
};

const angle = ([a, b]) => plain(Math.atan2(b[1] - a[1], b[0] - a[0]));
const middle = ([a, b]) => [(a[0] + b[0]) / 2, (a[1] + b[1]) / 2];
const length = ([a, b]) => plain(Math.max(0.1, Math.hypot(b[0] - a[0], b[1] - a[1])));

/** Tools that are needed less often; they are in a list beside the buttons. */
const MORE = [
  { name: "chair", title: "Chair", key: "6", more: true, mode: "arrow", into: "stage", xml: (p) => `<chair ${xy(p[0])} heading="${angle(p)}"/>` },
  { name: "ramp", title: "Ramp", key: "1", more: true, mode: "arrow", into: "stage", xml: (p) => `<ramp ${xy(middle(p))} heading="${angle(p)}" length="${length(p)}" height="0.3"/>` },
  { name: "stairs", title: "Stairs", key: "2", more: true, mode: "arrow", into: "stage", xml: (p) => `<stairs ${xy(middle(p))} heading="${angle(p)}" steps="${Math.max(1, Math.round(length(p) / 0.29))}"/>` },
  {
    name: "platform",
    title: "Platform",
    key: "3",
    more: true,
    mode: "area",
    into: "stage",
    xml: ([a, b, c]) => `<platform ${xy(middle([a, c]))} length="${plain(b[0] - a[0])}" width="${plain(c[1] - b[1])}"/>`,
  },
  { name: "threshold", title: "Threshold", key: "4", more: true, mode: "arrow", into: "stage", xml: (p) => `<threshold ${xy(middle(p))} heading="${plain(Math.atan2(p[1][1] - p[0][1], p[1][0] - p[0][0]) - Math.PI / 2)}" width="${length(p)}"/>` },
  {
    name: "avatar",
    title: "Avatar",
    key: "5",
    more: true,
    mode: "arrow",
    xml: (p, tree) => `<avatar name="${freeName(tree, "avatar", "you")}" source="external" ${xy(p[0])} heading="${angle(p)}"/>`,
  },
];

/**
 * Each tool: name, title, key, mode ("line": corners one by one, "area": two opposite corners, "two-areas": two areas,
 * "point", "arrow": two points), into: the parent ("stage" or the trial), and xml(points, tree).
 */
export const TOOLS = [
  { name: "wall", title: "Wall", key: "w", mode: "line", into: "stage", xml: (p) => `<wall points="${formatPoints(p)}"/>` },
  { name: "obstacle", title: "Obstacle", key: "o", mode: "area", into: "stage", xml: (p) => `<obstacle points="${formatPoints(p)}"/>` },
  { name: "walkable", title: "Walkable area", key: "g", mode: "area", attribute: ["stage", "walkable"] },
  { name: "spawner", title: "People", key: "p", mode: "two-areas", xml: (p) => `<spawner count="5" zone="${formatPoints(p[0])}" goal="${formatPoints(p[1])}"/>` },
  { name: "source", title: "Source", key: "s", mode: "two-areas", xml: (p) => `<source rate="0.5" zone="${formatPoints(p[0])}" goal="${formatPoints(p[1])}"/>` },
  { name: "agent", title: "Person", key: "a", mode: "arrow", xml: ([a, b]) => `<agent ${xy(a)} goal="${formatPoints([b])}"/>` },
  { name: "way", title: "Way", key: "j", mode: "line", least: 1, way: true, xml: wayXml },
  {
    name: "robot",
    title: "Robot",
    key: "r",
    mode: "arrow",
    xml: ([a, b], tree) =>
      `<robot name="${freeName(tree, "robot", "robot")}" ${xy(a)} heading="${plain(Math.atan2(b[1] - a[1], b[0] - a[0]))}">\n` +
      `  <goal ${xy(b)}/>\n  <drive type="differential-drive"/>\n  <navigator type="orca"/>\n  <sensor type="lidar2d"/>\n</robot>`,
  },
  { name: "exit", title: "Exit", key: "e", mode: "area", xml: (p) => `<exit zone="${formatPoints(p)}"/>` },
  {
    name: "portal",
    title: "Portal",
    key: "b",
    mode: "two-areas",
    xml: ([from, to]) => `<portal zone="${formatPoints(from)}" dx="${plain(to[0][0] - from[0][0])}" dy="${plain(to[0][1] - from[0][1])}"/>`,
  },
  { name: "cube", title: "Cube", key: "c", mode: "point", into: "stage", xml: ([a]) => `<cube ${xy(a)}/>` },
  { name: "table", title: "Table", key: "t", mode: "point", into: "stage", xml: ([a]) => `<table ${xy(a)}/>` },
  { name: "tree", title: "Tree", key: "v", mode: "point", into: "stage", xml: ([a]) => `<tree ${xy(a)}/>` },
  { name: "light", title: "Light", key: "l", mode: "point", into: "stage", xml: ([a]) => `<light ${xy(a)}/>` },
  { name: "door", title: "Door", key: "d", mode: "arrow", into: "stage", xml: (p, tree) => `<door name="${freeName(stageOf(tree) ?? tree, "door", "door")}" points="${formatPoints(p)}"/>` },
  {
    name: "camera",
    title: "Camera",
    key: "m",
    mode: "arrow",
    xml: ([a, b], tree) => `<camera name="${freeName(tree, "camera", "camera")}" ${xy(a)} heading="${plain(Math.atan2(b[1] - a[1], b[0] - a[0]))}"/>`,
  },
  ...MORE,
];

const stageOf = (tree) => tree.children.find((one) => one.tag === "stage");

/** Number of clicks that a tool needs; Infinity for lines, which end with Enter or a double click. */
export const clicks = (tool) => ({ line: Infinity, area: 2, "two-areas": 4, point: 1, arrow: 2 })[tool.mode];

/** What a tool shows while it is used. */
export function help(tool, count) {
  if (tool.way) return count ? "Click the next stop, or press Enter" : "Click the first stop; chosen people will follow the way";
  if (tool.mode === "line") return count < 2 ? "Click the corners of the line" : "Click more corners, or press Enter";
  if (tool.mode === "point") return "Click the place";
  if (tool.mode === "arrow") return count ? "Click where it goes or looks" : "Click the place";
  if (tool.mode === "area") return count ? "Click the opposite corner" : "Click a corner";
  return ["Click a corner of the first zone", "Click its opposite corner", "Click a corner of the second zone", "Click its opposite corner"][count];
}

/** Finishes a drawing: adds the element or sets the attribute. */
export async function finish(tool, points, model) {
  const stage = model.state.tree.children.findIndex((one) => one.tag === "stage");
  if (tool.into === "stage" && stage < 0) {
    await model.edit("insert", { path: [], xml: "<stage/>", position: 0 });
    return finish(tool, points, model);
  }
  const area = tool.mode === "area" ? rectangle(points[0], points[1]) : points;
  const areas = tool.mode === "two-areas" ? [rectangle(points[0], points[1]), rectangle(points[2], points[3])] : area;
  if (tool.attribute) {
    if (stage < 0) await model.edit("insert", { path: [], xml: "<stage/>", position: 0 });
    const path = [Math.max(stage, 0)];
    return model.edit("change", { changes: [{ path, name: tool.attribute[1], value: formatPoints(area) }] });
  }
  if (tool.way) return addWay(tool.xml(points, model.state.tree), model);
  return model.insert(tool.into === "stage" ? [stage] : [], tool.xml(areas, model.state.tree));
}

/** Adds a way and lets the people that were chosen follow it. */
async function addWay(xml, model) {
  const people = model.chosen;
  await model.insert([], xml);
  const [path] = model.chosen;
  const changes = followChanges(model, people, model.node(path)?.attributes.name);
  if (changes.length) await model.edit("change", { changes });
}
