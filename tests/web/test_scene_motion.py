"""Frames that come at 20 Hz are shown smoothly at the rate of the screen; jumps are shown at once."""

import itertools
import json
import subprocess
from pathlib import Path

import pytest

pytestmark = pytest.mark.live
SOURCES = Path(__file__).parents[2] / "frontend" / "src"

SCRIPT = """
const [sources] = process.argv.slice(2);
const { Motion } = await import(`${sources}/scene/motion.mjs`);
const frame = (time, x = time, revision = 1) => ({ time, sequence: Math.round(20 * time), arrays: {
  revision: new Uint32Array([revision]), ids: new Int32Array([7]), place: new Float32Array([x, 0, 0, 0, 0]),
  pelvis: new Float32Array(3), bones: new Int16Array(112).fill(100), who: new Uint16Array([0]),
  bots: new Uint16Array(0), botplace: new Float32Array(0), links: new Float32Array(0) } });
const motion = new Motion(), shown = [], found = {};
found.empty = motion.at(0);
let next = 0;
for (let now = 0; now < 3000; now += 1000 / 60) {
  while (50 * next <= now) { motion.push(frame(next / 20), 50 * next + 8 * Math.sin(next)); next += 1; }
  const one = motion.at(now);
  shown.push([now, one.time, one.arrays.place[0]]);
}
found.shown = shown.slice(30);
found.moving = motion.moving;
motion.at(3200);
found.rest = [motion.at(3300).time, motion.moving];
motion.push(frame(1.0), 3350);
found.back = [motion.at(3350).time, motion.at(3350).arrays.place[0], motion.moving];
motion.push(frame(1.05, 1.05, 2), 3400);
found.described = motion.at(3400).time;
motion.push(frame(9.0, 9, 2), 3450);
found.far = motion.at(3450).time;
for (let k = 1; k <= 50; k++) motion.push(frame(9 + 0.05 * k, 9, 2), 3450 + 0.1 * k);
found.held = motion._frames.length;
motion.clear();
found.cleared = motion.at(4000);
console.log(JSON.stringify(found));
"""


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """What is shown at 60 pictures a second, of a stream of 20 frames a second with jitter."""
    script = tmp_path_factory.mktemp("motion") / "script.mjs"
    script.write_text(SCRIPT)
    done = subprocess.run(["node", script, str(SOURCES)], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout)


def test_a_stream_of_20_hz_moves_in_every_picture_and_stays_near(found):
    times = [row[1] for row in found["shown"]]
    steps = [b - a for a, b in itertools.pairwise(times)]
    assert min(steps) > 0.004
    assert max(steps) < 0.035  # a picture is 1/60 s; without blending, steps are 0 or 0.05 s
    assert all(abs(row[2] - row[1]) < 1e-4 for row in found["shown"])  # people are where they were at this time
    delays = [row[0] / 1000 - row[1] for row in found["shown"]]
    assert max(delays) < 0.11
    assert found["moving"]


def test_the_newest_frame_is_reached_and_jumps_are_shown_at_once(found):
    assert found["empty"] is None
    assert found["rest"] == [pytest.approx(2.95), False]
    assert found["back"] == [1.0, 1.0, False]
    assert (found["described"], found["far"]) == (1.05, 9.0)
    assert found["cleared"] is None


def test_frames_do_not_pile_up(found):
    assert found["held"] <= 3
