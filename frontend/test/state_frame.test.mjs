// The bytes of tests/web/state_frame.bin, which crowdbot.web.StateFrame writes.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { dirname, join } from "node:path";
import { fileURLToPath } from "node:url";
import { test } from "node:test";
import { decodeFrame } from "../src/net/state_frame.mjs";

const bytes = readFileSync(join(dirname(fileURLToPath(import.meta.url)), "..", "..", "tests", "web", "state_frame.bin"));

test("a frame of the server is read", () => {
  const frame = decodeFrame(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.length));
  assert.equal(frame.channel, "crowd");
  assert.equal(frame.sequence, 7);
  assert.equal(frame.time, 0.25);
  assert.deepEqual([...frame.arrays.people], [1, 2, 3, 4]);
  assert.equal(frame.columns.people, 2);
  assert.deepEqual([...frame.arrays.ids], [5, 6, 65535]);
});

test("other bytes are refused", () => {
  assert.throws(() => decodeFrame(new ArrayBuffer(64)), /not a state frame/);
});
