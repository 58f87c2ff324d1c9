"use strict";
// Draws the recorded trial from the data that stands in this page; asks nothing from anywhere else.
const data = JSON.parse(document.getElementById("data").textContent);
const canvas = document.getElementById("stage");
const pen = canvas.getContext("2d");
const slider = document.getElementById("when");
const clock = document.getElementById("clock");
const play = document.getElementById("play");
const rate = document.getElementById("rate");
const shown = { lidar: true, truth: true };
let frame = 0;
let playing = false;
let last = 0;

const [left, bottom, right, top_] = data.bounds;
const ratio = (top_ - bottom) / (right - left);
canvas.width = 1200;
canvas.height = Math.max(240, Math.min(900, Math.round(1200 * ratio)));
const scale = Math.min(canvas.width / (right - left), canvas.height / (top_ - bottom));
const px = x => canvas.width / 2 + (x - (left + right) / 2) * scale;
const py = y => canvas.height / 2 - (y - (bottom + top_) / 2) * scale;

function line(points, color, width, dash) {
  pen.strokeStyle = color;
  pen.lineWidth = width;
  pen.setLineDash(dash || []);
  pen.beginPath();
  points.forEach(([x, y], k) => (k ? pen.lineTo(px(x), py(y)) : pen.moveTo(px(x), py(y))));
  pen.stroke();
  pen.setLineDash([]);
}

function disc(x, y, r, fill, edge) {
  pen.beginPath();
  pen.arc(px(x), py(y), Math.max(1, r * scale), 0, 2 * Math.PI);
  pen.fillStyle = fill;
  pen.fill();
  if (edge) {
    pen.strokeStyle = edge;
    pen.lineWidth = 1.5;
    pen.stroke();
  }
}

function walls() {
  for (const ring of data.walls) {
    const closed = ring.length > 2 ? [...ring, ring[0]] : ring;
    if (ring.length > 2 && area(ring) > 0) {
      pen.fillStyle = "#c9d0d8";
      pen.beginPath();
      ring.forEach(([x, y], k) => (k ? pen.lineTo(px(x), py(y)) : pen.moveTo(px(x), py(y))));
      pen.fill();
    }
    line(closed, "#59636f", 2.5);
  }
}

function area(ring) {
  return ring.reduce((sum, [x, y], k) => {
    const [u, v] = ring[(k + 1) % ring.length];
    return sum + (x * v - u * y) / 2;
  }, 0);
}

function latest(times, now) {
  let k = -1;
  while (k + 1 < times.length && times[k + 1] <= now + 1e-6) k += 1;
  return k;
}

function lidar(now) {
  const k = latest(data.scans.times, now);
  if (k < 0) return;
  const [x, y, h] = data.scans.poses[k];
  pen.fillStyle = "rgba(0,121,107,0.55)";
  data.scans.ranges[k].forEach((r, n) => {
    if (r === null) return;
    const a = h + data.scans.angles[n];
    pen.fillRect(px(x + r * Math.cos(a)) - 1.5, py(y + r * Math.sin(a)) - 1.5, 3, 3);
  });
}

function forecasts(now) {
  const k = latest(data.forecasts.times, now);
  if (k < 0 || now - data.forecasts.times[k] > data.forecasts.period + 1e-6) return;
  if (shown.truth) for (const path of data.forecasts.truth[k]) line(path, "#333", 1.5, [5, 4]);
  for (const one of data.forecasts.predictors) {
    if (shown[one.name]) for (const path of one.paths[k]) line(path, one.color, 2);
  }
}

function draw() {
  const now = data.times[frame];
  pen.clearRect(0, 0, canvas.width, canvas.height);
  walls();
  const { goal, radius } = data.robot;
  pen.strokeStyle = "#00796b";
  pen.lineWidth = 2;
  pen.beginPath();
  pen.arc(px(goal[0]), py(goal[1]), Math.max(6, goal[2] * scale), 0, 2 * Math.PI);
  pen.moveTo(px(goal[0]) - 5, py(goal[1]));
  pen.lineTo(px(goal[0]) + 5, py(goal[1]));
  pen.moveTo(px(goal[0]), py(goal[1]) - 5);
  pen.lineTo(px(goal[0]), py(goal[1]) + 5);
  pen.stroke();
  data.people.forEach((who, a) => {
    const x = who.x[frame];
    if (x === null) return;
    const y = who.y[frame];
    const right_ = Math.cos(who.h[frame]) >= 0;
    disc(x, y, who.r, right_ ? "#9ec5e8" : "#f0b3a6", right_ ? "#3c78b4" : "#c0573f");
    line([[x, y], [x + who.r * Math.cos(who.h[frame]), y + who.r * Math.sin(who.h[frame])]], "#37414d", 1.5);
  });
  if (shown.lidar) lidar(now);
  forecasts(now);
  const { x, y, h } = data.robot;
  line(x.slice(0, frame + 1).map((v, k) => [v, y[k]]), "rgba(0,121,107,0.5)", 2);
  disc(x[frame], y[frame], radius, "#00796b", "#004d40");
  line([[x[frame], y[frame]], [x[frame] + radius * Math.cos(h[frame]), y[frame] + radius * Math.sin(h[frame])]], "#fff", 2.5);
  slider.value = frame;
  clock.textContent = now.toFixed(1) + " s";
}

function step(by) {
  frame = Math.max(0, Math.min(data.times.length - 1, frame + by));
  draw();
}

function run(stamp) {
  if (!playing) return;
  const due = (data.times[1] - data.times[0]) * 1000 / Number(rate.value);
  if (stamp - last >= due) {
    last = stamp;
    if (frame >= data.times.length - 1) return toggle();
    step(1);
  }
  requestAnimationFrame(run);
}

function toggle() {
  playing = !playing;
  play.textContent = playing ? "Stop" : "Play";
  if (playing) {
    if (frame >= data.times.length - 1) frame = 0;
    requestAnimationFrame(run);
  }
}

function layer(name, words, color, on) {
  shown[name] = on;
  const label = document.createElement("label");
  const box = document.createElement("input");
  box.type = "checkbox";
  box.checked = on;
  box.addEventListener("change", () => { shown[name] = box.checked; draw(); });
  const mark = document.createElement("span");
  mark.className = "swatch";
  mark.style.background = color;
  label.append(box, mark, words);
  document.getElementById("layers").append(label);
}

layer("lidar", "LiDAR", "#00796b", true);
layer("truth", "what then happened", "#333333", true);
for (const one of data.forecasts.predictors) layer(one.name, one.name, one.color, one.shown);
slider.max = data.times.length - 1;
slider.addEventListener("input", () => { frame = Number(slider.value); draw(); });
play.addEventListener("click", toggle);
document.addEventListener("keydown", event => {
  if (event.target.tagName === "INPUT" || event.target.tagName === "SELECT" || event.target.tagName === "BUTTON") return;
  if (event.key === " ") { event.preventDefault(); toggle(); }
  if (event.key === "ArrowRight") step(1);
  if (event.key === "ArrowLeft") step(-1);
});
frame = Math.min(data.times.length - 1, data.opening);
draw();
document.documentElement.dataset.ready = "true";
