"""The validation page: its measures against slow twins, its runs, its cache and its files."""

import argparse
import json
import re
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.cli import validate as command
from crowdbot.core import DataError, InputError, Scene, UnknownName, stream
from crowdbot.models import ORCA, CollisionFreeSpeed, CrowdModel
from crowdbot.validation import CHECKS, select_models, validate, write_page
from crowdbot.validation.bottleneck import BOTTLENECK, _flow, crossings
from crowdbot.validation.corridor import CORRIDOR, corridor_crowd
from crowdbot.validation.crowd_motion import deepest_overlap, simulate_periodic
from crowdbot.validation.lanes import LANES, NARROW
from crowdbot.validation.recording import measure_recordings
from crowdbot.validation.rimea import CORRIDOR_TIME
from crowdbot.validation.run import ResultFile
from crowdbot.validation.scenario import (
    BOTTLENECK_FLOWS,
    RADIUS,
    STEP,
    CrowdTracks,
    corridor_walls,
    gate,
    inside_solids,
    line_speed,
    opening,
    share,
    starts,
    weidmann_speed,
)
from crowdbot.validation.single_file import SINGLE_FILE, _overtakings
from samples import sizes


def _quiet(share):
    pass


class Straight(CrowdModel):
    """Walks as it wishes and sees nobody."""

    paper = ORCA.paper

    def velocity(self, scene, dt, rng=None):
        return scene.desired_velocity(dt)


class Lost(CrowdModel):
    """Has no idea where to go."""

    paper = ORCA.paper

    def velocity(self, scene, dt, rng=None):
        return np.full(scene.position.shape, np.nan)


# Places and ways


@settings(deadline=None, max_examples=25)
@given(st.integers(1, 140), st.integers(0, 10**6))
def test_nobody_starts_in_another_or_outside(count, seed):
    place = starts(count, (0.0, 0.25), (12.0, 2.75), stream(seed, "starts"))
    away = np.hypot(*np.moveaxis(place[:, None] - place[None], -1, 0)) + 9.0 * np.eye(count)
    assert away.min() >= 2.0 * RADIUS - 1e-9
    assert np.all((place >= (0.0, 0.25)) & (place <= (12.0, 2.75)))


def test_too_many_bodies_are_refused():
    with pytest.raises(InputError, match=r"100 bodies of radius 0.2 m do not fit into 2.00 x 2.00 m"):
        starts(100, (0.0, 0.0), (2.0, 2.0), stream(0, "starts"))


def _file(x, length):
    wish = np.broadcast_to([1.34, 0.0], (1, len(x), 2))
    place = np.stack([np.asarray(x), np.full(len(x), 0.35)], axis=1)
    return Scene.of(
        place, radius=RADIUS, preferred_speed=1.34, preferred_velocity=wish, walls=corridor_walls(length, 0.7)
    )


def test_the_way_round_goes_on_growing():
    walk = simulate_periodic(Straight(), _file([1.0], 20.0), 20.0, 40.0, stream(0), _quiet)
    assert walk.times[-1] == pytest.approx(40.0)
    assert walk.position[-1, 0, 0, 0] == pytest.approx(1.0 + 40.0 * 1.34)


def test_people_see_each_other_across_the_seam():
    walk = simulate_periodic(CollisionFreeSpeed(), _file([19.6, 0.4], 20.0), 20.0, STEP * 4, stream(0), _quiet)
    moved = walk.position[1, 0, :, 0] - walk.position[0, 0, :, 0]
    assert moved[0] < 0.5 * moved[1]


def test_a_closed_track_has_no_seam():
    x = np.arange(12) * 20.0 / 12.0 + stream(3, "x").uniform(-0.3, 0.3, 12)
    ways = []
    for shift in (0.0, 7.3):
        walk = simulate_periodic(CollisionFreeSpeed(), _file((x + shift) % 20.0, 20.0), 20.0, 6.0, stream(0), _quiet)
        ways.append(walk.position[-1, 0, :, 0] - walk.position[0, 0, :, 0])
    assert ways[0] == pytest.approx(ways[1], abs=1e-6)


def test_a_gate_lets_around_a_corner():
    place = np.array([[[0.0, 1.0], [9.0, 0.3], [11.0, 4.0]]])
    point, passed = gate(place, (10.0, 2.0), (12.0, 0.0))
    assert passed.tolist() == [[False, False, True]]
    assert np.all((point[..., 0] >= 10.0) & (point[..., 1] <= 2.0))
    assert point[0, 0].tolist() == pytest.approx([10.0 + 0.25 / np.sqrt(2.0), 2.0 - 0.25 / np.sqrt(2.0)])


def test_an_opening_is_aimed_at_where_a_body_fits():
    point = opening(np.array([[[-3.0, 2.0], [-3.0, 0.1], [-3.0, -2.0]]]), 0.3, 0.0, 1.0)
    assert point[0, :, 1].tolist() == pytest.approx([0.25, 0.1, -0.25])


def test_shares_overlaps_and_walls_are_counted():
    place = np.array([[[[0.0, 0.0], [0.3, 0.0], [5.0, 5.0]]], [[[0.0, 0.0], [0.3, 0.0], [5.5, 5.0]]]])
    walk = CrowdTracks(np.array([0.0, 1.0]), place, np.ones((2, 1, 3), dtype=bool))
    assert deepest_overlap(walk) == pytest.approx(0.1)
    assert deepest_overlap(walk, length=5.2) == pytest.approx(0.1)
    assert inside_solids(walk, [(5.2, 4.0, 6.0, 6.0)]) == pytest.approx(1.0 / 3.0)
    assert [share(0.0), share(0.004), share(0.333)] == ["0 %", "less than 1 %", "33 %"]


def test_overtaking_is_changing_order_or_lapping():
    before = np.array([0.0, 5.0, 10.0])
    assert _overtakings(before, before + 7.0) == 0
    assert _overtakings(before, np.array([6.0, 5.5, 12.0])) == 1
    assert _overtakings(before, np.array([0.0, 5.0, 21.0])) == 1


def test_flow_is_persons_over_time():
    x = np.array([[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [3.0, 2.0, 0.0], [3.0, 3.0, 2.0]])
    walk = CrowdTracks(np.arange(4.0), np.stack([x, 0.0 * x], axis=-1)[:, None], np.ones((4, 1, 3), dtype=bool))
    times = crossings(walk, 1.0)
    assert times.tolist() == [1.0, 2.0, 3.0]
    assert _flow(times, 3, 60.0) == (1.0, 3)
    assert _flow(times, 4, 41.0) == (0.05, 3)
    assert _flow(times[:1], 4, 41.0) == (0.0, 1)


def test_published_curves_have_their_known_values():
    assert weidmann_speed([0.1, 5.4, 9.0]).round(3).tolist() == [1.34, 0.0, 0.0]
    assert line_speed([1.0 / (0.36 + 1.06 * 0.5)]).tolist() == pytest.approx([0.5])
    specific = [flow / width for width, flow in BOTTLENECK_FLOWS]
    assert min(specific) > 1.85
    assert max(specific) < 2.25


# Verdicts


def test_the_published_line_passes_and_a_free_file_does_not():
    density = [0.5, 1.0, 2.0]
    right = {"density": density, "speed": line_speed(density).tolist(), "overtakings": 0, "outside": 0.0}
    assert SINGLE_FILE.judge(right) == ("0.00 m/s", True, "")
    free = SINGLE_FILE.judge({**right, "speed": [1.34, 1.34, 1.34]})
    assert not free.passed
    assert free.words == "people in single file walk at 1.34 m/s even at 2 people per metre"
    through = SINGLE_FILE.judge({**right, "overtakings": 3, "outside": 0.001})
    assert not through.passed
    assert "3 overtakings" in through.words
    assert "less than 1 %" in through.words


def test_jams_clogs_and_walls_are_said_in_words():
    jam = NARROW.judge({"density": [0.5, 1.5], "speeds": [[1.0, 1.1], [0.01, 0.5]], "outside": 0.0})
    assert (jam.value, jam.passed) == ("1 of 4 jam", False)
    assert jam.words == "jams in a two-way corridor 2 m wide, at 1.5 people/m2 or more (1 of 4 runs)"
    clog = {"width": [0.8, 1.2], "flows": [[0.1], [2.3]], "passed": [[12], [60]], "people": 60, "outside": 0.0}
    assert "clogs bottlenecks up to 0.8 m wide (1 of 2 runs)" in BOTTLENECK.judge(clog).words
    fine = {"width": [1.0], "flows": [[1.9]], "passed": [[60]], "people": 60, "outside": 0.0}
    assert BOTTLENECK.judge(fine) == ("1.90 /(m s)", True, "")
    assert "30 %" in CORRIDOR.judge({"density": [3.0], "speed": [0.36], "outside": 0.3}).words
    assert "order 0.10" in LANES.judge({"last_order": 0.1, "speed": 1.0, "outside": 0.0}).words


def test_a_model_that_sees_nobody_walks_forty_metres_in_time():
    rows = CORRIDOR_TIME.run(Straight(), (0,), True, _quiet)
    assert CORRIDOR_TIME.judge(CORRIDOR_TIME.summarize(rows)) == ("30.1 s", True, "")


def test_two_way_crowds_are_half_and_half():
    crowd = corridor_crowd([("two-way", 1.0, 0), ("two-way", 0.5, 0)], 12.0, 4.0, two_way=True, spread=0.26)
    side = np.sign(crowd.preferred_velocity[..., 0]) * crowd.active
    assert crowd.active.sum(axis=1).tolist() == [48, 24]
    assert side.sum(axis=1).tolist() == [0.0, 0.0]


# Recordings


def test_recordings_say_what_is_published(recordings):
    people = measure_recordings(recordings, _quiet)
    assert people["missing"] == []
    assert people["single-file"]["distance"] < 0.10
    flows = {door["width"]: door["flow"] for door in people["bottleneck"]}
    assert flows == pytest.approx({0.5: 1.15, 0.7: 1.61, 0.8: 2.83, 1.2: 2.30}, abs=0.01)
    dense = people["corridor"]["runs"]["uo-180-180-070"]
    assert dict(zip(dense["density"], dense["speed"], strict=True))[3.25] == pytest.approx(0.30, abs=0.02)
    assert people["lanes"]["bi_corr_400_b_03.txt"]["density"] == pytest.approx(1.0, abs=0.05)
    assert people["lanes"]["bo-360-090-090.txt"]["mean"] > 0.9


def test_a_folder_without_recordings_is_refused(tmp_path):
    with pytest.raises(DataError, match="contains none of the reference recordings: .*n56_cam1.csv"):
        measure_recordings(tmp_path, _quiet)
    with pytest.raises(DataError, match="is not a folder; give the folder of the recordings"):
        measure_recordings(tmp_path / "nowhere", _quiet)


# The page


@pytest.mark.parametrize("text", ["", '{"checks": {"single-fi', "[1, 2]", '{"checks": 7}'])
def test_half_a_file_is_no_result(tmp_path, text):
    file = tmp_path / "orca.json"
    file.write_text(text, encoding="utf-8")
    assert ResultFile(file, ORCA(), True).rows(CORRIDOR_TIME) == {}
    assert ResultFile(tmp_path / "none.json", ORCA(), True).rows(CORRIDOR_TIME) == {}


@pytest.fixture(scope="module")
def done(tmp_path_factory):
    out = tmp_path_factory.mktemp("page")
    said = []
    models, _ = select_models(["orca"])
    found = validate({**models, "lost": Lost()}, out / "validation", None, True, lambda *what: said.append(what))
    return out, found, said


def test_every_model_that_can_be_is_chosen():
    models, skipped = select_models()
    assert {"orca", "social-force", "collision-free-speed"} <= set(models)
    assert "models" in skipped["mixture"]
    assert set(models).isdisjoint(skipped)
    with pytest.raises(UnknownName, match="did you mean 'orca'"):
        select_models(["orcaa"])
    with pytest.raises(InputError, match="mixture has no default for models"):
        select_models(["mixture"])


def test_progress_is_told_for_each_model(done):
    _, _, said = done
    assert [said[0][0], said[-1]] == ["orca", ("lost", 1.0)]
    shares = [part for what, part in said if what == "orca"]
    assert shares == sorted(shares)


def test_a_model_that_fails_is_told_not_hidden(done):
    verdicts = [item.verdict for item in done[1].outcomes["lost"].values()]
    assert not any(verdict.passed for verdict in verdicts)
    words = [item.verdict.words for name, item in done[1].outcomes["lost"].items() if name != "time-step"]
    assert all("positions are not finite after 0.1 s" in text for text in words)
    assert done[1].outcomes["lost"]["time-step"].verdict.words == "the model is unstable at every time step"


@pytest.mark.parametrize("count", sizes(4, len(CHECKS)))
def test_a_rerun_reads_and_a_fresh_run_finds_the_same(done, tmp_path, monkeypatch, count):
    out, found, _ = done
    models, _ = select_models(["orca"])
    before = (out / "validation" / "orca.json").stat().st_mtime_ns
    again = validate(models, out / "validation", None, True)
    assert (out / "validation" / "orca.json").stat().st_mtime_ns == before
    assert again.outcomes["orca"] == found.outcomes["orca"]
    monkeypatch.setattr("crowdbot.validation.run.CHECKS", CHECKS[:count])
    monkeypatch.setattr("crowdbot.validation.run.STUDIES", ())
    fresh = validate(models, tmp_path, None, True)
    for check in CHECKS[:count]:
        assert fresh.outcomes["orca"][check.name].result == found.outcomes["orca"][check.name].result


def test_an_interrupted_run_goes_on(tmp_path, monkeypatch):
    monkeypatch.setattr("crowdbot.validation.run.CHECKS", CHECKS[:5])
    monkeypatch.setattr("crowdbot.validation.run.STUDIES", ())
    models, _ = select_models(["orca"])

    def interrupted(what, part):
        if part > 3.5 / 5:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        validate(models, tmp_path, None, True, interrupted)
    kept = json.loads((tmp_path / "orca.json").read_text())
    assert list(kept["checks"]) == [check.name for check in CHECKS[:3]]
    seconds = kept["checks"]["single-file"]["seconds"]
    assert validate(models, tmp_path, None, True).outcomes["orca"]["single-file"].seconds == seconds


def test_the_page_holds_table_words_and_plots(done):
    out, found, _ = done
    page = write_page(found, out, "crowdbot validate --quick")
    text = page.read_text(encoding="utf-8")
    for picture in re.findall(r"\]\((validation/[^)]+)\)", text):
        assert 1_000 < (out / picture).stat().st_size < 80_000
    rows = [line for line in text.splitlines() if line.startswith("| orca |")]
    assert rows[0].count("|") == len(CHECKS) + 6
    assert "* **orca**: people in single file walk at" in text
    assert "Runs (starts and densities) with a steady state" in text
    assert all(check.criterion in text for check in CHECKS)
    links = re.findall(r"(?<!!)\[[^]]+\]\(([^)]+)\)", text)
    assert [link.rpartition("/")[2] for link in links] == ["around-robots.md", "trial-crowds.md"]
    for link in links:  # each leads somewhere from any folder, to a page that exists
        assert link.startswith("https://github.com/crowdbot/crowdbot/blob/main/docs/")
        assert (Path(__file__).parents[2] / link.partition("/blob/main/")[2]).is_file()
    assert "The verdicts mean little" in text
    assert "compares with published curves only" in text
    assert "| anticipation-velocity" not in text
    assert re.search(r"\| orca \| 0.05 \| single file, 1 person/m \[m/s\] \| [\d.]+ \| [\d.]+ \| 1 \|", text)


def test_the_command_writes_the_page(done, capsys):
    out = done[0]
    parser = argparse.ArgumentParser()
    command.arguments(parser)
    options = parser.parse_args(["--models", "orca", "--quick", "--out", str(out)])
    assert command.main(options) == 0
    shown = capsys.readouterr()
    assert str(out / "validation.md").replace("\n", "") in shown.out.replace("\n", "")
    assert "of 11" in shown.out
    options.json = True
    assert command.main(options) == 0
    document = json.loads(capsys.readouterr().out)
    assert document["models"]["orca"]["single-file"]["passed"] is False
