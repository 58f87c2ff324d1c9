// Draws a window with a pen: ground, walls, people, observed, true and predicted paths.
import { themeColour } from "../ui/plot.mjs";
import { colourOf, styleOf } from "./style.mjs";

const PERSON = 0.25; // radius [m]
const CELL = 0.15; // side of a cell of the density [m]

/** Draws everything; `selected` is the id of a person or null, `background` a loaded picture or null. */
export function drawWindow(pen, { recording, frame, layers, selected, background, input }) {
  const ink = themeColour("--ink");
  const faint = themeColour("--faint");
  if (background && layers.background) pen.picture(background, recording.background.bounds);
  drawScale(pen, recording, faint);
  if (layers.walls) for (const ring of recording.walls) pen.line(ring, { colour: ink, width: 2, closed: true });
  if (!frame) return;
  if (layers.predicted && layers.density) for (const one of frame.forecasts) drawDensity(pen, one, selected);
  for (const person of frame.people) {
    if (layers.observed) pen.line(person.past, { colour: faint, width: 1.5 });
    if (layers.truth) drawTruth(pen, person, ink);
  }
  if (frame.seen && layers.seen && input === "degraded") {
    for (const track of frame.seen) drawSeen(pen, track, themeColour("--data-5"));
  }
  if (layers.predicted && !layers.density) for (const one of frame.forecasts) drawFan(pen, one, frame, selected, input);
  drawPeople(pen, frame, layers, selected, { ink, faint });
}

function drawTruth(pen, person, colour) {
  if (!person.truth.length) return;
  pen.line([person.now, ...person.truth], { colour, width: 1.2, dash: [1, 3] });
  pen.square(person.truth.at(-1), 2.5, { stroke: colour });
}

function drawSeen(pen, track, colour) {
  pen.line(track, { colour, width: 1, dash: [1, 2] });
  for (const point of track) pen.square(point, 1.2, { fill: colour });
}

function drawFan(pen, { slot, paths }, frame, selected, input) {
  const colour = colourOf(slot);
  const { dash } = styleOf(slot);
  const most = Math.max(...paths.map((one) => one.weight));
  const starts = new Map(frame.people.map((one) => [one.id, one.now]));
  for (const { weight, people } of paths) {
    if (weight <= 0) continue;
    const share = paths.length > 1 ? 0.35 + (0.5 * weight) / most : 1;
    for (const { id, points } of people) {
      const opacity = selected === null || selected === id ? share : 0.35 * share;
      const start = input === "clean" ? starts.get(id) : null;
      pen.line(start ? [start, ...points] : points, { colour, width: paths.length > 1 ? 1 : 2, dash, opacity });
      if (paths.length === 1) pen.disc(points.at(-1), 2.5, { fill: colour, opacity });
    }
  }
}

function drawDensity(pen, { slot, paths }, selected) {
  const cells = new Map();
  for (const { weight, people } of paths) {
    for (const { id, points } of people) {
      if (selected !== null && selected !== id) continue;
      for (const [x, y] of points) {
        const key = `${Math.floor(x / CELL)} ${Math.floor(y / CELL)}`;
        cells.set(key, (cells.get(key) ?? 0) + weight);
      }
    }
  }
  const most = Math.max(1e-9, ...cells.values());
  const half = 0.5 * CELL * pen.view.scale + 0.5;
  const fill = colourOf(slot);
  for (const [key, mass] of cells) {
    const [i, j] = key.split(" ").map(Number);
    pen.square([(i + 0.5) * CELL, (j + 0.5) * CELL], half, { fill, opacity: 0.1 + 0.7 * Math.sqrt(mass / most) });
  }
}

function drawPeople(pen, frame, layers, selected, { ink, faint }) {
  const radius = Math.max(3, Math.min(14, PERSON * pen.view.scale));
  for (const person of frame.people) {
    const chosen = person.id === selected;
    const look = { fill: person.scored ? themeColour("--person") : themeColour("--panel"), stroke: chosen ? themeColour("--focus") : ink, width: chosen ? 3 : 1 };
    if (person.robot) pen.square(person.now, radius, { ...look, fill: themeColour("--robot") });
    else pen.disc(person.now, chosen ? radius + 1.5 : radius, look);
    if (layers.ids || chosen) pen.text(person.now, String(person.id), { colour: layers.ids ? ink : faint, dx: radius + 3, dy: -radius });
  }
}

function drawScale(pen, recording, colour) {
  const wide = pen.view.width / pen.view.scale;
  const length = 10 ** Math.floor(Math.log10(wide / 3));
  const from = pen.view.place(14, pen.view.height - 14);
  const to = [from[0] + length, from[1]];
  pen.line([from, to], { colour, width: 2 });
  pen.text(from, `${length} ${recording.units}`, { colour, dy: -6 });
}
