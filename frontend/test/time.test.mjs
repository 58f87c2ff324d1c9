import assert from "node:assert/strict";
import test from "node:test";
import { dayAndTime } from "../src/ui/time.mjs";

test("dates are named as a person names them", () => {
  const now = new Date(2026, 10, 30, 9, 15);
  const words = (...parts) => dayAndTime(new Date(...parts), now, "en-GB");
  assert.equal(words(2026, 10, 30, 8, 5), "today at 08:05");
  assert.equal(words(2026, 10, 29, 23, 59), "yesterday at 23:59");
  assert.equal(words(2026, 10, 28, 14, 31), "28 Nov at 14:31");
  assert.equal(words(2025, 11, 31, 14, 31), "31 Dec 2025 at 14:31");
  assert.equal(words(2026, 11, 1, 14, 31), "1 Dec at 14:31"); // a clock that was set back
});
