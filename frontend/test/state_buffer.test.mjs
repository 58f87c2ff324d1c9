// The added delay of the picture in the age of what the headset shows; the frames come at 20 Hz over a busy network.
import assert from "node:assert/strict";
import { test } from "node:test";
import { StateBuffer } from "../src/vr/state_buffer.mjs";

const COUNT = 200;
const still = { revision: [1], who: [0], ids: [7], pelvis: new Float32Array(3), bones: new Int16Array(112), bots: [], botplace: new Float32Array(0), links: new Float32Array(0) };

/** Random numbers from 0 to 1, the same in each run (Park and Miller). */
function numbers(seed) {
  let state = seed;
  return () => (state = (state * 48271) % 2147483647) / 2147483647;
}

/** Ages [s] of what is drawn at 72 Hz, and the largest step of a place that moves at 1 m/s [m]. */
function play(delay, seed) {
  const random = numbers(seed);
  const buffer = new StateBuffer();
  buffer.delay = delay;
  const waiting = [];
  const ages = [];
  let last = null;
  let step = 0;
  for (let k = 0; k < 20 * 20; k++) {
    const stamp = k / 20;
    waiting.push({ arrival: stamp + 0.003 + 0.004 * random(), stamp });
  }
  for (let time = 1; time < 19; time += 1 / 72) {
    while (waiting.length && waiting[0].arrival <= time) {
      const { arrival, stamp } = waiting.shift();
      buffer.add({ time: stamp, arrays: { ...still, stamp: [stamp], place: new Float32Array([stamp, 0, 0, 1, 0]) } }, arrival);
    }
    const found = buffer.at(time);
    if (time < 4 || !found) continue;
    if (found.stamp !== null) ages.push(time - found.stamp);
    const x = found.frame.arrays.place[0];
    if (last !== null) step = Math.max(step, Math.abs(x - last - 1 / 72));
    last = x;
  }
  return { ages: ages.slice(-COUNT), step };
}

const median = (values) => [...values].sort((a, b) => a - b)[values.length >> 1];

test("an added delay of 0, 50, 100 and 200 ms is in the age of the picture within 5 ms", () => {
  const plain = median(play(0, 1).ages);
  assert.ok(plain > 0.04 && plain < 0.07, `age without a delay ${plain}`); // one interval late
  for (const added of [0, 0.05, 0.1, 0.2]) {
    const { ages } = play(added, 2);
    assert.equal(ages.length, COUNT);
    assert.ok(Math.abs(median(ages) - plain - added) < 0.005, `${added}: ${median(ages) - plain}`);
  }
});

test("places between two states are interpolated", () => {
  assert.ok(play(0.1, 3).step < 0.006);
});
