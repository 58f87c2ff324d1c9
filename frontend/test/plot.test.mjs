import assert from "node:assert/strict";
import test from "node:test";
import { describeData, drawable, labelOf } from "../src/ui/plot_text.mjs";

test("labels carry their unit", () => {
  assert.equal(labelOf({ label: "Error", unit: "m" }), "Error [m]");
  assert.equal(labelOf({ label: "People" }), "People");
});

test("values that are not finite are gaps", () => {
  assert.deepEqual(drawable([1, NaN, Infinity, null, 2]), [1, null, null, null, 2]);
});

test("the sentence about a plot names the newest values", () => {
  const series = [{ label: "ADE", unit: "m" }, { label: "FDE", unit: "m" }];
  const text = describeData("Error", { label: "frame" }, series, [[10, 20], [0.123456, NaN], [NaN, NaN]]);
  assert.equal(text, "Error, frame 10 to 20: ADE [m] 0.1235, FDE [m] without value");
  assert.equal(describeData("Error", { label: "frame" }, series, [[], [], []]), "Error: no data yet");
});
