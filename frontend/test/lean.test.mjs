// The lean of a person in the plan, from the quaternion of the pelvis.
import assert from "node:assert/strict";
import test from "node:test";
import { BONES, BONE_UNIT, leanOf } from "../src/scene/posing.mjs";

function person(w, x, y, z) {
  const bones = new Int16Array(8 * BONES);
  bones.set([w, x, y, z].map((one) => Math.round(BONE_UNIT * one)), 4 * BONES);
  return bones;
}

function near(found, expected) {
  found.forEach((one, k) => assert.ok(Math.abs(one - expected[k]) < 1e-3, `${found} is not ${expected}`));
}

test("an upright person does not lean, at any heading", () => {
  for (const yaw of [0, 1, -2.5]) near(leanOf(person(Math.cos(yaw / 2), 0, 0, Math.sin(yaw / 2)), 1), [0, 0]);
});

test("a person who lies ahead, behind or aside points there", () => {
  const half = Math.SQRT1_2;
  near(leanOf(person(half, 0, half, 0), 1), [1, 0]);
  near(leanOf(person(half, 0, -half, 0), 1), [-1, 0]);
  near(leanOf(person(half, -half, 0, 0), 1), [0, 1]);
});

test("the length is the sine of the tilt", () => {
  near(leanOf(person(Math.cos(0.2), 0, Math.sin(0.2), 0), 1), [Math.sin(0.4), 0]);
});
