"""The adapter of Stone Soup: known walks, states that are not changed, and the command line."""

import json
import sys
from pathlib import Path

import numpy as np
import pytest

from crowdbot.cli import main
from crowdbot.core import InputError
from crowdbot.perception import Detections

FILE = Path(__file__).parents[2] / "examples" / "public_tracker" / "stone_soup.py"
sys.path.insert(0, str(FILE.parent))
from stone_soup import StoneSoup  # noqa: E402


def rows(count):
    return [[[0.12 * k, 1.0], [3.0 - 0.1 * k, -1.0]] for k in range(count)]


def follow(places, state=None, begin=0):
    tracker = StoneSoup()
    state, found = tracker.begin() if state is None else state, []
    for k, row in enumerate(places, begin):
        tracks, state = tracker.update(Detections.of(0.1 * k, row, 0.05), 0.1 * k, state)
        found.append(tracks)
    return found, state


def test_people_keep_their_identities_and_get_velocities():
    found, _ = follow(rows(20))
    assert all(one.ids.tolist() == [0, 1] for one in found[5:])
    last = found[-1]
    assert last.position == pytest.approx(np.array(rows(20)[-1]), abs=0.1)
    assert last.velocity == pytest.approx(np.array([[1.2, 0.0], [-1.0, 0.0]]), abs=0.3)
    assert last.detected.all()


def test_a_stored_state_continues_with_the_same_tracks():
    whole, _ = follow(rows(16))
    _, state = follow(rows(8))
    follow([[[9.0, 9.0]]] * 5, state, 8)
    branch, _ = follow(rows(16)[8:], state, 8)
    assert branch[-1].position == pytest.approx(whole[-1].position)
    assert branch[-1].ids.tolist() == whole[-1].ids.tolist()


def test_nobody_and_wrong_times():
    found, state = follow([np.zeros((0, 2))] * 3)
    assert [len(one) for one in found] == [0, 0, 0]
    with pytest.raises(InputError, match="not before the last update"):
        StoneSoup().update(Detections.of(0.0, [[0.0, 0.0]], 0.05), 0.0, state)


def test_it_is_scored_beside_the_built_in_tracker_on_a_recorded_episode(tmp_path, capsys):
    assert main(["run", "crossing-flows", "--set", "duration=2", "--out", str(tmp_path / "out")]) == 0
    capsys.readouterr()
    words = ["--tracker", "global-nearest-neighbor", f"{FILE}:StoneSoup", "--json"]
    assert main(["track", str(tmp_path / "out" / "episode.mcap"), *words]) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["source"] == "episode.mcap"
    assert list(document["scores"]) == ["global-nearest-neighbor", f"{FILE}:StoneSoup"]
    assert document["scores"][f"{FILE}:StoneSoup"]["mota"]["value"] > 0.4
