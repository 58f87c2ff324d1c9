// Journeys: ways of people through stops: their shape, how they are drawn, changed and given to people.
import { parsePoints, plain } from "./shapes.mjs";

const WALKERS = new Set(["spawner", "source", "agent"]);
const REACH = 10; // of a double click on a way [px]

const mean = (points) => [0, 1].map((axis) => points.reduce((sum, one) => sum + one[axis], 0) / points.length);

/** Place of a stop [m]; a direction has none. */
function placeOf(stop) {
  if (stop.tag === "zone") {
    const points = parsePoints(stop.attributes.points);
    return points.length ? mean(points) : null;
  }
  const place = [Number.parseFloat(stop.attributes.x), Number.parseFloat(stop.attributes.y)];
  return stop.tag === "point" && place.every(Number.isFinite) ? place : null;
}

/** The ways of a trial: {path, name, stops: [[index, place]], again, heading, starts}. */
export function waysOf(tree) {
  return tree.children.flatMap((node, i) => {
    if (node.tag !== "journey") return [];
    const { name, then } = node.attributes;
    const stops = node.children.map((stop, index) => [index, placeOf(stop)]).filter(([, place]) => place);
    const last = node.children.at(-1);
    const heading = last?.tag === "direction" ? Number.parseFloat(last.attributes.heading) || 0 : null;
    const users = tree.children.filter((one) => WALKERS.has(one.tag) && name && one.attributes.journey === name);
    return [{ path: [i], name, stops, again: then === "again", heading, starts: users.map(startOf).filter(Boolean) }];
  });
}

function startOf({ tag, attributes }) {
  if (tag === "agent") return [Number.parseFloat(attributes.x) || 0, Number.parseFloat(attributes.y) || 0];
  const zone = parsePoints(attributes.zone);
  return zone.length ? mean(zone) : null;
}

/** XML of a way through places, with a name that no other has. */
export function wayXml(places, tree) {
  const taken = new Set(tree.children.filter((one) => one.tag === "journey").map((one) => one.attributes.name));
  let i = 1;
  while (taken.has(`way${i}`)) i++;
  const stops = places.map(([x, y]) => `  <point x="${plain(x)}" y="${plain(y)}"/>`);
  return `<journey name="way${i}">\n${stops.join("\n")}\n</journey>`;
}

/** Changes after which chosen people follow a way instead of walking to a goal. */
export function followChanges(model, paths, name) {
  const walkers = paths.filter((path) => path.length === 1 && WALKERS.has(model.node(path)?.tag));
  return walkers.flatMap((path) => {
    const { attributes } = model.node(path);
    const goals = ["goal", "goal-zone"].filter((one) => one in attributes).map((one) => ({ path, name: one, value: null }));
    return [{ path, name: "journey", value: name }, ...goals];
  });
}

/** Changes that move all stops of a way. */
export function moveWay(node, path, dx, dy) {
  return node.children.flatMap((stop, i) => {
    const own = [...path, i];
    if (stop.tag === "zone") {
      const points = parsePoints(stop.attributes.points).map(([x, y]) => `${plain(x + dx)},${plain(y + dy)}`);
      return [{ path: own, name: "points", value: points.join(" ") }];
    }
    if (stop.tag !== "point") return [];
    const [x, y] = placeOf(stop) ?? [0, 0];
    return [{ path: own, name: "x", value: plain(x + dx) }, { path: own, name: "y", value: plain(y + dy) }];
  });
}

/** Where a new stop at a place belongs: {path, position} of the nearest leg of a way, or null if none is near. */
export function nearestLeg(ways, place, scale) {
  let best = { distance: REACH / scale, leg: null };
  for (const { path, stops } of ways) {
    for (let i = 1; i < stops.length; i++) {
      const distance = legDistance(place, stops[i - 1][1], stops[i][1]);
      if (distance < best.distance) best = { distance, leg: { path, position: stops[i][0] } };
    }
  }
  return best.leg;
}

/** Distance of a place from a leg. */
export function legDistance([x, y], [ax, ay], [bx, by]) {
  const [dx, dy] = [bx - ax, by - ay];
  const t = Math.max(0, Math.min(1, ((x - ax) * dx + (y - ay) * dy) / (dx * dx + dy * dy || 1)));
  return Math.hypot(x - ax - t * dx, y - ay - t * dy);
}

/** Draws the ways: legs with arrows, numbers at the stops, thin lines from where people start. */
export function drawWays(context, ways, { pixel, colour, chosen }) {
  for (const way of ways) {
    const picked = chosen.some((path) => path[0] === way.path[0]);
    context.strokeStyle = context.fillStyle = colour(picked ? "--focus" : "--data-4");
    const places = way.stops.map(([, place]) => pixel(place));
    const first = places[0];
    if (!first) continue;
    stroke(context, way.starts.map((start) => [pixel(start), first]), 1, [2, 4]);
    const legs = places.slice(1).map((place, i) => [places[i], place]);
    if (way.again && places.length > 1) legs.push([places.at(-1), first]);
    if (way.heading !== null) {
      const [x, y] = places.at(-1);
      legs.push([[x, y], [x + 60 * Math.cos(way.heading), y - 60 * Math.sin(way.heading)]]);
    }
    stroke(context, legs, picked ? 3 : 2, []);
    for (const leg of legs) arrow(context, leg);
    context.font = "bold 11px system-ui, sans-serif";
    context.strokeStyle = colour("--paper");
    context.lineWidth = 4;
    places.forEach(([x, y], i) => {
      const words = i ? String(i + 1) : `${way.name ?? ""} 1`;
      context.strokeText(words, x + 8, y - 8);
      context.fillText(words, x + 8, y - 8);
    });
  }
}

function stroke(context, legs, width, dash) {
  context.lineWidth = width;
  context.setLineDash(dash);
  context.beginPath();
  for (const [from, to] of legs) {
    context.moveTo(...from);
    context.lineTo(...to);
  }
  context.stroke();
  context.setLineDash([]);
}

function arrow(context, [[ax, ay], [bx, by]]) {
  const angle = Math.atan2(by - ay, bx - ax);
  const [x, y] = [(ax + bx) / 2, (ay + by) / 2];
  context.beginPath();
  context.moveTo(x + 7 * Math.cos(angle), y + 7 * Math.sin(angle));
  for (const turn of [2.6, -2.6]) context.lineTo(x + 7 * Math.cos(angle + turn), y + 7 * Math.sin(angle + turn));
  context.fill();
}
