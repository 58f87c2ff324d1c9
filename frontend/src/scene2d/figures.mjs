// People, robots and overlays of a scene seen from above.
import { leanOf } from "../scene/posing.mjs";
import { drawCollisions, drawDensity, drawPaths } from "./crowd_layers.mjs";
import { trace } from "./plan.mjs";

const FORCE = 0.004;
/** Sine of the tilt from which a person is drawn lying, and parts of the stature: head, shoulders, feet, half width. */
const LYING = 0.5;
const BODY = { head: 0.4, shoulders: 0.2, feet: -0.5, width: 0.1 };

/** A line between two points of the floor {x, y} that were measured, with its ends. */
export function drawMeasured(context, from, to, look, pixel) {
  line(context, from.x, from.y, to.x, to.y, look.mark, 2 * pixel);
  for (const { x, y } of [from, to]) ring(context, x, y, 4 * pixel, look.mark, 2 * pixel);
}

/** Shoulders and head in the colours of clothes and hair, on the disc of the person; a line is the velocity. */
export function drawPeople(context, state, look, pixel, mark) {
  const { who, ids, place, bones } = state.frame.arrays;
  const { people, regions } = state.description;
  const [top, hair] = [regions.indexOf("top"), regions.indexOf("hair")];
  for (let i = 0; i < state.people; i++) {
    const [x, y, heading, vx, vy] = place.subarray(5 * i, 5 * i + 5);
    const rider = people.rider[who[i]];
    const radius = rider ? 0.24 : people.radius[who[i]];
    const colors = people.colors[who[i]];
    const [leanX, leanY] = leanOf(bones, i);
    if (Math.hypot(leanX, leanY) > LYING) {
      const [clothes, head] = [top, hair].map((k) => `#${colors.slice(6 * k, 6 * k + 6)}`);
      drawLying(context, { x, y, leanX, leanY, height: people.height[who[i]], clothes, head }, look, pixel);
      if (mark?.kind === "person" && mark.id === ids[i]) ring(context, x, y, radius + 0.14, look.mark, 3 * pixel);
      continue;
    }
    context.beginPath();
    context.arc(x, y, radius, 0, 2 * Math.PI);
    context.fillStyle = look.ink;
    context.globalAlpha = 0.1;
    context.fill();
    context.globalAlpha = 1;
    context.strokeStyle = look.wallTop;
    context.lineWidth = pixel;
    context.stroke();
    context.save();
    context.translate(x, y);
    context.rotate(heading);
    context.fillStyle = `#${colors.slice(6 * top, 6 * top + 6)}`;
    context.strokeStyle = look.ink;
    context.beginPath();
    context.ellipse(0, 0, 0.55 * radius, 0.95 * radius, 0, 0, 2 * Math.PI);
    context.fill();
    context.stroke();
    context.fillStyle = `#${colors.slice(6 * hair, 6 * hair + 6)}`;
    context.beginPath();
    context.arc(0.08 * radius, 0, 0.42 * radius, 0, 2 * Math.PI);
    context.fill();
    context.restore();
    line(context, x, y, x + 0.6 * vx, y + 0.6 * vy, look.ink, 1.5 * pixel);
    if (!rider && mark?.kind === "person" && mark.id === ids[i]) ring(context, x, y, radius + 0.14, look.mark, 3 * pixel);
  }
}

/** A body on the floor, or on the way to it, seen from above: legs, shoulders and head along the trunk. */
function drawLying(context, { x, y, leanX, leanY, height, clothes, head }, look, pixel) {
  const length = height * Math.hypot(leanX, leanY);
  const half = BODY.width * height;
  context.save();
  context.translate(x, y);
  context.rotate(Math.atan2(leanY, leanX));
  context.strokeStyle = look.ink;
  context.lineWidth = pixel;
  context.fillStyle = look.wallTop;
  context.beginPath();
  context.roundRect(BODY.feet * length, -0.8 * half, (BODY.shoulders - BODY.feet) * length, 1.6 * half, 0.6 * half);
  context.fill();
  context.stroke();
  context.fillStyle = clothes;
  context.beginPath();
  context.ellipse(0.5 * BODY.shoulders * length, 0, 0.9 * BODY.shoulders * length, 1.3 * half, 0, 0, 2 * Math.PI);
  context.fill();
  context.stroke();
  context.fillStyle = head;
  context.beginPath();
  context.arc(BODY.head * length, 0, 0.6 * half, 0, 2 * Math.PI);
  context.fill();
  context.stroke();
  context.restore();
}

/** Footprint with an arrow ahead. */
export function drawRobots(context, state, look, pixel, mark) {
  const { bots, botplace } = state.frame.arrays;
  bots.forEach((row, k) => {
    const robot = state.description.robots[row];
    const [x, y, heading] = botplace.subarray(5 * k, 5 * k + 5);
    context.save();
    context.translate(x, y);
    context.rotate(heading);
    context.globalAlpha = robot.ghost ? 0.4 : 1;
    trace(context, robot.footprint);
    context.fillStyle = look.robotGoal;
    context.strokeStyle = look.ink;
    context.lineWidth = 1.5 * pixel;
    context.fill();
    context.stroke();
    const size = 0.55 * robot.radius;
    trace(context, [[size, 0], [-0.5 * size, 0.7 * size], [-0.5 * size, -0.7 * size]]);
    context.fillStyle = look.floor;
    context.fill();
    context.restore();
    if (mark?.kind === "robot" && mark.id === robot.id) ring(context, x, y, robot.radius + 0.14, look.mark, 3 * pixel);
  });
}

/** Names of robots, and numbers of people if they are asked for, over everything else. */
export function drawNames(context, state, look, pixel, robots, numbers) {
  const { who, ids, place, bots, botplace } = state.frame.arrays;
  const { people, robots: known } = state.description;
  for (let i = 0; numbers && i < state.people; i++) {
    if (people.rider[who[i]]) continue;
    write(context, String(ids[i]), place[5 * i], place[5 * i + 1] + people.radius[who[i]] + 4 * pixel, look, pixel);
  }
  for (let k = 0; robots && k < bots.length; k++) {
    const { name, radius } = known[bots[k]];
    write(context, name, botplace[5 * k], botplace[5 * k + 1] + radius + 6 * pixel, look, pixel);
  }
}

/** Overlays by name of the layer; those under people are drawn first. */
export const OVERLAYS = [
  { name: "density", under: true, draw: drawDensity },
  { name: "paths", under: true, draw: drawPaths },
  { name: "ttc", under: true, draw: drawCollisions },
  { name: "ranges", under: true, draw: drawCones },
  { name: "goals", under: true, draw: drawGoals },
  { name: "scans", under: false, draw: (...all) => drawScans("scan", 3, ...all) },
  { name: "clouds", under: false, draw: (...all) => drawScans("cloud", 1.5, ...all) },
  { name: "forces", under: false, draw: drawForces },
];

function drawScans(kind, size, context, state, look, pixel) {
  context.fillStyle = look[kind];
  const side = size * pixel;
  for (const { points } of state.scans(kind)) {
    for (let k = 0; k < points.length; k += 3) context.fillRect(points[k] - 0.5 * side, points[k + 1] - 0.5 * side, side, side);
  }
}

function drawCones(context, state, look) {
  const cones = state.frame.arrays.cones ?? [];
  const sensors = state.description.sensors.filter((one) => one.kind === "cone");
  context.fillStyle = look.cone;
  context.globalAlpha = 0.3;
  for (let k = 0; k < cones.length / 9; k++) {
    const [x, y, , w, a, b, c, reach] = cones.subarray(9 * k, 9 * k + 9);
    const yaw = Math.atan2(2 * (w * c + a * b), 1 - 2 * (b * b + c * c));
    const half = sensors[k]?.angle ?? 0.2;
    context.beginPath();
    context.moveTo(x, y);
    context.arc(x, y, reach, yaw - half, yaw + half);
    context.closePath();
    context.fill();
  }
  context.globalAlpha = 1;
}

function drawGoals(context, state, look, pixel) {
  const { goals, place } = state.frame.arrays;
  if (!goals) return;
  context.globalAlpha = 0.5;
  context.setLineDash([6 * pixel, 5 * pixel]);
  for (let i = 0; i < state.people; i++) {
    if (Number.isFinite(goals[2 * i])) line(context, place[5 * i], place[5 * i + 1], goals[2 * i], goals[2 * i + 1], look.goal, 1.5 * pixel);
  }
  context.setLineDash([]);
  context.globalAlpha = 1;
}

function drawForces(context, state, look, pixel) {
  const rows = state.frame.arrays.forces ?? [];
  for (let k = 0; k < rows.length / 6; k++) {
    const [x, y, , fx, fy] = rows.subarray(6 * k, 6 * k + 6);
    line(context, x, y, x + FORCE * fx, y + FORCE * fy, look.force, 3 * pixel);
    ring(context, x, y, 0.05, look.force, 2 * pixel);
  }
}

function line(context, x0, y0, x1, y1, color, width) {
  context.beginPath();
  context.moveTo(x0, y0);
  context.lineTo(x1, y1);
  context.strokeStyle = color;
  context.lineWidth = width;
  context.stroke();
}

function ring(context, x, y, radius, color, width) {
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.strokeStyle = color;
  context.lineWidth = width;
  context.stroke();
}

/** Writes a text with a rim in the colour of the floor, so that it is read over people and laser returns. */
function write(context, text, x, y, look, pixel) {
  context.save();
  const { a, b, e, f, c, d } = context.getTransform();
  const scale = Math.hypot(a, b) * pixel;
  context.setTransform(scale, 0, 0, scale, a * x + c * y + e, b * x + d * y + f);
  context.font = "12px system-ui, sans-serif";
  context.textAlign = "center";
  context.strokeStyle = look.floor;
  context.lineWidth = 3;
  context.lineJoin = "round";
  context.strokeText(text, 0, 0);
  context.fillStyle = look.ink;
  context.fillText(text, 0, 0);
  context.restore();
}
