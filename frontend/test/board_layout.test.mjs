import assert from "node:assert/strict";
import { test } from "node:test";
import { boardPages, footer, HEIGHT, WIDTH } from "../src/vr/board_layout.mjs";
import { unpackBones } from "../src/vr/bone_triples.mjs";
import { emptyRoom, experimentScreen, pauseText } from "../src/vr/screens.mjs";

const measure = (text, size) => 0.55 * size * text.length;
const scale = (name) => ({ name, kind: "scale", text: `How strong is ${name}?`, required: true, steps: [0, 1, 2, 3], low: "none", high: "severe" });
const inside = (box) => box.x >= 0 && box.y >= 0 && box.x + (box.w ?? 0) <= WIDTH && box.y + (box.h ?? box.size) <= HEIGHT;
const overlap = (a, b) => a.x < b.x + b.w && b.x < a.x + a.w && a.y < b.y + b.h && b.y < a.y + a.h;

function check(pages, words) {
  pages.forEach((page, k) => {
    const boxes = footer(page, k, pages.length, words);
    assert.ok(boxes.every(inside), JSON.stringify(boxes.find((box) => !inside(box))));
    const buttons = boxes.filter((box) => box.kind === "button");
    buttons.forEach((a, i) => buttons.slice(i + 1).forEach((b) => assert.ok(!overlap(a, b), `${a.text} ${b.text}`)));
  });
}

test("sixteen scales are on several pages, each once", () => {
  const questions = [...Array(16).keys()].map((k) => scale(`symptom${k}`));
  const pages = boardPages({ text: "How do you feel now?", questions }, { symptom3: 2 }, measure);
  assert.ok(pages.length > 1 && pages.length < 6);
  check(pages, "Continue");
  const actions = pages.flat().filter((box) => box.action).map((box) => `${box.action[1]} ${box.action[2]}`);
  assert.equal(new Set(actions).size, 64);
  assert.deepEqual(pages.flat().filter((box) => box.chosen).map((box) => box.action), [["set", "symptom3", 2]]);
});

test("long texts are wrapped and continue on the next page", () => {
  const text = "Please read this carefully and take your time. ".repeat(60);
  const pages = boardPages({ text, questions: [] }, {}, measure);
  check(pages, "Continue");
  assert.equal(pages.flat().map((box) => box.text).join(" ").replace(/\s+/g, " ").trim(), text.trim());
  const last = footer(pages.at(-1), pages.length - 1, pages.length, "Continue").at(-1);
  assert.deepEqual([last.text, last.action], ["Continue", ["finish"]]);
  assert.deepEqual(footer(pages[0], 0, pages.length, "Continue").at(-1).action, ["page", 1]);
});

test("bold titles are wrapped by their own width, and a screen without a text begins at the top", () => {
  const wide = (text, size, strong = false) => (strong ? 1.2 : 1) * measure(text, size);
  const question = { ...scale("it"), text: "I remember the room as a place where I have been rather than as pictures that I have seen." };
  const [page] = boardPages({ text: "", questions: [question] }, {}, wide);
  const titles = page.filter((box) => box.strong);
  assert.equal(titles.map((box) => box.text).join(" "), question.text);
  assert.ok(titles.length > 1 && titles.every((box) => box.x + wide(box.text, box.size, true) <= WIDTH - box.x));
  assert.equal(titles[0].y, 64);
});

test("choices and keys are buttons", () => {
  const options = [{ value: "a", text: "one" }, { value: "b", text: "two" }];
  const several = { name: "many", kind: "choice", text: "Which?", required: false, multiple: true, options };
  const number = { name: "age", kind: "number", text: "How old?", required: true, unit: "years" };
  const pages = boardPages({ text: "", questions: [several, number] }, { many: ["b"] }, measure);
  check(pages, "Continue");
  const boxes = pages.flat().filter((box) => box.action);
  assert.deepEqual(boxes.map((box) => [box.action[0], Boolean(box.chosen)]), [["toggle", false], ["toggle", true], ["write", false]]);
  for (const question of [number, { ...number, kind: "text" }]) {
    const keys = boardPages({ text: "", questions: [question] }, {}, measure, { name: "age", typed: "3" });
    check(keys.map((page) => page), "");
    assert.ok(keys[0].some((box) => box.action?.[0] === "written"));
    assert.ok(keys[0].filter((box) => box.action?.[0] === "key").length >= 11);
  }
});

test("a screen is shown between trials only", () => {
  assert.equal(experimentScreen({ open: false }), null);
  assert.equal(experimentScreen({ open: true, phase: "running" }), null);
  assert.equal(experimentScreen({ open: true, phase: "pause" }, "Paused by the experimenter.").text, "Paused by the experimenter.");
  const screen = { open: true, phase: "screen", index: 3, text: "Hello", questions: [], answers: {} };
  assert.deepEqual(experimentScreen(screen), { key: "screen 3", text: "Hello", questions: [], answers: {}, button: "Continue" });
});

test("a participant reads why everything stands still", () => {
  assert.equal(pauseText(null, "guest", "operator"), "Paused by the operator.");
  assert.equal(pauseText({ kind: "tracking", avatar: "guest" }, "guest", "operator"), "Tracking of your headset was lost.\nPlease wait for the operator.");
  assert.match(pauseText({ kind: "gone", avatar: "visitor" }, "guest", "experimenter"), /^Another participant has left.\nPlease wait for the experimenter.$/);
  assert.match(pauseText({ kind: "asked", avatar: "guest" }, "guest", "operator"), /^You asked for a pause./);
});

test("the room is empty between trials, and not in a pause, after which the trial goes on", () => {
  for (const phase of ["screen", "done", "aborted"]) assert.ok(emptyRoom({ open: true, phase }), phase);
  for (const phase of ["pause", "running", "trial", "ready"]) assert.ok(!emptyRoom({ open: true, phase }), phase);
  assert.ok(!emptyRoom({ open: false, phase: "screen" }));
  assert.ok(!emptyRoom(null));
});

test("bones come back from triples", () => {
  const triples = new Int16Array([0 | 1, 0, 0, 2 * 11585, 2 * 0, 2 * 0]);
  const frame = unpackBones({ arrays: { triples } });
  assert.deepEqual([...frame.arrays.bones.slice(0, 4)], [0, 32767, 0, 0]);
  const [w, x, y, z] = frame.arrays.bones.slice(4, 8);
  assert.ok(Math.abs(w - 28377) < 3 && Math.abs(x - 16384) < 3 && y === 0 && z === 0);
  assert.equal(unpackBones({ arrays: {} }).arrays.bones, undefined);
});
