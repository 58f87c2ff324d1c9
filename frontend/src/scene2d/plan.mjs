// Floor plan of a scene: grid, zones, walls, ground, doors and props.

export function trace(context, points, closed = true) {
  context.beginPath();
  points.forEach(([x, y], k) => (k ? context.lineTo(x, y) : context.moveTo(x, y)));
  if (closed) context.closePath();
}

export function drawGrid(context, view, look, pixel) {
  const { clientWidth: width, clientHeight: height } = view.canvas;
  const corners = [[0, 0], [width, 0], [width, height], [0, height]].map(([x, y]) => view.place(x, y));
  const [xs, ys] = [corners.map((one) => one[0]), corners.map((one) => one[1])];
  for (const [step, color] of [[1, look.line], [10, look.line10]]) {
    if (step / pixel < 9) continue;
    context.beginPath();
    for (let x = step * Math.floor(Math.min(...xs) / step); x <= Math.max(...xs); x += step) {
      context.moveTo(x, Math.min(...ys));
      context.lineTo(x, Math.max(...ys));
    }
    for (let y = step * Math.floor(Math.min(...ys) / step); y <= Math.max(...ys); y += step) {
      context.moveTo(Math.min(...xs), y);
      context.lineTo(Math.max(...xs), y);
    }
    context.strokeStyle = color;
    context.lineWidth = pixel;
    context.stroke();
  }
}

export function drawZones(context, { zones, robots }, look, pixel) {
  for (const zone of zones) {
    trace(context, zone.points);
    context.fillStyle = context.strokeStyle = look[zone.kind];
    context.globalAlpha = 0.12;
    context.fill();
    context.globalAlpha = 1;
    context.lineWidth = 1.5 * pixel;
    context.setLineDash(zone.kind === "goal" || zone.kind === "exit" ? [0.25, 0.15] : []);
    context.stroke();
    context.setLineDash([]);
  }
  context.strokeStyle = look.robotGoal;
  context.lineWidth = 2 * pixel;
  for (const { goal } of robots) {
    context.beginPath();
    context.arc(goal.x, goal.y, goal.tolerance, 0, 2 * Math.PI);
    context.moveTo(goal.x, goal.y);
    context.lineTo(goal.x, goal.y + 0.9);
    context.lineTo(goal.x + 0.5, goal.y + 0.7);
    context.lineTo(goal.x, goal.y + 0.5);
    context.stroke();
  }
}

export function drawStage(context, state, look, pixel, walls, props) {
  const { stage } = state.description;
  for (const part of stage.ground) drawGround(context, part, look, pixel);
  if (props) {
    stage.props.forEach((prop, number) => drawProp(context, prop, number, state, look, pixel));
    stage.doors.forEach((door, k) => drawDoor(context, door, state.frame?.arrays.doors?.[k] ?? 0, look, pixel));
  }
  if (!walls) return;
  for (const wall of stage.walls) {
    trace(context, wall.points, wall.solid);
    context.strokeStyle = look.wallTop;
    context.fillStyle = look.wall;
    context.lineWidth = Math.max(2 * pixel, wall.solid ? 0 : 0.06);
    if (wall.solid && !wall.inner) context.fill();
    context.stroke();
  }
}

function drawGround(context, { corners, heights }, look, pixel) {
  trace(context, corners);
  context.fillStyle = look.ground;
  context.globalAlpha = 0.35 + 0.5 * Math.min(1, Math.max(...heights));
  context.fill();
  context.globalAlpha = 1;
  context.strokeStyle = look.wallTop;
  context.lineWidth = pixel;
  context.stroke();
}

function drawDoor(context, door, share, look, pixel) {
  const turn = door.yaw + (door.kind === "hinged" ? share * door.angle : 0);
  const length = door.width * (door.kind === "sliding" ? 1 - share : 1);
  context.beginPath();
  context.moveTo(door.x, door.y);
  context.lineTo(door.x + length * Math.cos(turn), door.y + length * Math.sin(turn));
  context.strokeStyle = look.door;
  context.lineWidth = Math.max(3 * pixel, 0.06);
  context.stroke();
}

function drawProp(context, prop, number, state, look, pixel) {
  if (prop.kind === "none") return;
  let [x, y, turn] = [prop.x, prop.y, prop.heading];
  const at = state.frame?.arrays.propnum?.indexOf(number) ?? -1;
  if (at >= 0) {
    const [px, py, , w, a, b, c] = state.frame.arrays.props.subarray(7 * at, 7 * at + 7);
    [x, y, turn] = [px, py, Math.atan2(2 * (w * c + a * b), 1 - 2 * (b * b + c * c))];
  }
  const side = prop.size ?? 2 * prop.trunk;
  const [length, width] = [prop.length ?? side, prop.width ?? side];
  context.save();
  context.translate(x, y);
  context.rotate(turn);
  context.fillStyle = prop.kind === "tree" ? "#73543a" : look.prop;
  context.strokeStyle = look.wallTop;
  context.lineWidth = pixel;
  context.beginPath();
  if (prop.kind === "tree") context.arc(0, 0, prop.trunk, 0, 2 * Math.PI);
  else context.rect(-0.5 * length, -0.5 * width, length, width);
  context.fill();
  context.stroke();
  if (prop.kind === "chair") {
    context.beginPath();
    context.rect(-0.5 * length, -0.5 * width, 0.12 * length, width);
    context.stroke();
  }
  if (prop.kind === "tree") {
    context.beginPath();
    context.arc(0, 0, prop.crown, 0, 2 * Math.PI);
    context.fillStyle = "#5f8f4c";
    context.globalAlpha = 0.25;
    context.fill();
    context.globalAlpha = 1;
  }
  context.restore();
}
