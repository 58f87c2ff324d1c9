"use strict";
// Plays the runs that stand in this page; asks nothing from anywhere else.
const runs = JSON.parse(document.getElementById("data").textContent);
const canvas = document.getElementById("stage");
const pen = canvas.getContext("2d");
const chosen = document.getElementById("run");
const slider = document.getElementById("when");
const clock = document.getElementById("clock");
const button = document.getElementById("play");
let run = null;
let frame = 0;
let playing = false;
let before = 0;

function scale() {
  const [left, bottom, right, top_] = run.bounds;
  return Math.min(canvas.width / (right - left), canvas.height / (top_ - bottom));
}
const px = x => canvas.width / 2 + (x - (run.bounds[0] + run.bounds[2]) / 2) * scale();
const py = y => canvas.height / 2 - (y - (run.bounds[1] + run.bounds[3]) / 2) * scale();

function path(points, closed) {
  pen.beginPath();
  points.forEach(([x, y], k) => (k ? pen.lineTo(px(x), py(y)) : pen.moveTo(px(x), py(y))));
  if (closed) pen.closePath();
}

function body(agent) {
  const place = agent.track[frame];
  if (!place) return;
  const reach = agent.radius * scale();
  pen.fillStyle = agent.robot ? "#2f9e5b" : "#5b8fd6";
  const heading = agent.heading[frame];
  if (agent.outline.length && Number.isFinite(heading)) {
    // The outline turns with the robot; the disc around it is what the planar world knows.
    const [c, s] = [Math.cos(heading), Math.sin(heading)];
    path(agent.outline.map(([x, y]) => [place[0] + c * x - s * y, place[1] + s * x + c * y]), true);
    pen.fill();
    pen.strokeStyle = "#2f9e5b88";
    pen.lineWidth = 1;
    pen.beginPath();
    pen.arc(px(place[0]), py(place[1]), reach, 0, 2 * Math.PI);
    pen.stroke();
  } else {
    pen.beginPath();
    pen.arc(px(place[0]), py(place[1]), Math.max(2, reach), 0, 2 * Math.PI);
    pen.fill();
  }
  pen.strokeStyle = "#fff";
  pen.lineWidth = 2;
  path([place, [place[0] + agent.radius * Math.cos(agent.heading[frame]),
    place[1] + agent.radius * Math.sin(agent.heading[frame])]]);
  pen.stroke();
}

function draw() {
  pen.clearRect(0, 0, canvas.width, canvas.height);
  for (const line of run.plan) {
    pen.strokeStyle = line.color;
    pen.lineWidth = 1.5 * line.width;
    path(line.points);
    pen.stroke();
  }
  pen.strokeStyle = "#59636f";
  pen.lineWidth = 2;
  for (const ring of run.walls) {
    path(ring, ring.length > 2);
    pen.stroke();
  }
  pen.strokeStyle = "#2f9e5b";
  for (const [x, y] of run.goals) {
    path([[x - 0.2, y], [x + 0.2, y]]);
    pen.stroke();
    path([[x, y - 0.2], [x, y + 0.2]]);
    pen.stroke();
  }
  for (const agent of run.agents.filter(one => one.robot)) {
    pen.strokeStyle = "#2f9e5b66";
    path(agent.track.slice(0, frame + 1).filter(Boolean));
    pen.stroke();
  }
  run.agents.forEach(body);
  slider.value = frame;
  clock.textContent = `${run.times[frame].toFixed(1)} s`;
}

function show(number) {
  run = runs[number];
  frame = 0;
  slider.max = run.times.length - 1;
  draw();
}

function tick(now) {
  if (!playing) return;
  const ahead = run.times[Math.min(frame + 1, run.times.length - 1)] - run.times[frame];
  if (now - before >= 1000 * ahead) {
    before = now;
    frame += 1;
    if (frame >= run.times.length - 1) stop();
    draw();
  }
  requestAnimationFrame(tick);
}

function stop() {
  playing = false;
  frame = Math.min(frame, run.times.length - 1);
  button.textContent = "Play";
}

function toggle() {
  if (playing) return stop();
  if (frame >= run.times.length - 1) frame = 0;
  playing = true;
  before = performance.now();
  button.textContent = "Stop";
  requestAnimationFrame(tick);
}

if (runs.length) {
  chosen.addEventListener("change", () => show(Number(chosen.value)));
  slider.addEventListener("input", () => {
    frame = Number(slider.value);
    draw();
  });
  button.addEventListener("click", toggle);
  document.addEventListener("keydown", event => {
    if (["INPUT", "SELECT", "BUTTON"].includes(event.target.tagName)) return;
    if (event.key === " ") toggle();
    else if (event.key === "ArrowRight") frame = Math.min(frame + 1, run.times.length - 1);
    else if (event.key === "ArrowLeft") frame = Math.max(frame - 1, 0);
    else return;
    event.preventDefault();
    draw();
  });
  show(0);
} else {
  document.getElementById("worst").remove();
}
