// Preview: people on straight lines, drawn while the simulation is prepared.
const ROUND = 12;

/** Scale [px/m] and origin [px] with which bounds [m] lie in a picture [px]. */
function fit([x0, y0, x1, y1], width, height) {
  const scale = 0.92 * Math.min(width / (x1 - x0), height / (y1 - y0));
  return { scale, x: 0.5 * (width - scale * (x0 + x1)), y: 0.5 * (height + scale * (y0 + y1)) };
}

/** The place of the floor {x, y} [m] at a place of the canvas [px]. */
export function previewFloor(canvas, { bounds }, px, py) {
  const { scale, x, y } = fit(bounds, canvas.clientWidth, canvas.clientHeight);
  return { x: (px - x) / scale, y: (y - py) / scale };
}

/** Draws a preview {bounds, walls, discs, since} at the current time. */
export function drawPreview(canvas, { bounds, walls, discs, since }, theme) {
  const ratio = Math.min(2, devicePixelRatio || 1);
  const [width, height] = [canvas.clientWidth * ratio, canvas.clientHeight * ratio];
  if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
  const context = canvas.getContext("2d");
  const dark = theme === "dark";
  const { scale, x: left, y: top } = fit(bounds, width, height);
  const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
  const time = still ? 0 : ((performance.now() - since) / 1000) % ROUND;
  context.setTransform(1, 0, 0, 1, 0, 0);
  context.fillStyle = dark ? "#141a21" : "#e3e9f0";
  context.fillRect(0, 0, width, height);
  context.setTransform(scale, 0, 0, -scale, left, top);
  context.lineWidth = 2 / scale;
  context.strokeStyle = dark ? "#a9b7c4" : "#6c7884";
  for (const ring of walls) {
    context.beginPath();
    ring.forEach(([x, y], k) => (k ? context.lineTo(x, y) : context.moveTo(x, y)));
    if (ring.length > 2) context.closePath();
    context.stroke();
  }
  for (const [x, y, vx, vy, radius, robot] of discs) {
    context.beginPath();
    context.fillStyle = robot ? "#d55e00" : "#0072b2";
    context.arc(x + vx * time, y + vy * time, radius, 0, 2 * Math.PI);
    context.fill();
  }
}
