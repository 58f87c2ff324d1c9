"""Stored starts of the checks and what makes them invalid; further cases of the guidelines; study of time steps."""

import json

import numpy as np
import pytest

from crowdbot.core import InputError
from crowdbot.models import ORCA, CollisionFreeSpeed, CrowdModel, GroupForce, SocialForce
from crowdbot.validation import CHECKS, ISO_CASES, RIMEA_CASES, STUDIES, validate, variant_of
from crowdbot.validation import code_digest as digest
from crowdbot.validation.bottleneck import bottleneck_flow
from crowdbot.validation.components import ASSIGNED_EXITS, COUNTER_FLOW, PREMOVEMENT, SLOW_MEMBER
from crowdbot.validation.corridor import corridor_crowd
from crowdbot.validation.crowd_motion import one_start, simulate_periodic
from crowdbot.validation.rimea import CORNER, CORRIDOR_TIME
from crowdbot.validation.run import ResultFile
from crowdbot.validation.scenario import CrowdTracks
from crowdbot.validation.statistics import bin_values, pool_bins
from crowdbot.validation.time_steps import TIME_STEPS


def _quiet(share):
    pass


class Straight(CrowdModel):
    """Walks as it wishes and sees nobody."""

    paper = ORCA.paper

    def velocity(self, scene, dt, rng=None):
        return scene.desired_velocity(dt)


class Pulled(Straight):
    """Walks away at once, whatever it wishes."""

    def velocity(self, scene, dt, rng=None):
        return np.broadcast_to([1.0, 0.0], scene.position.shape).copy()


def test_the_code_of_a_model_is_followed_through_folders_and_faces():
    files = {file.relative_to(digest.PACKAGE).as_posix() for file in digest.code_files(["crowdbot.models.presets"])}
    assert {"models/headway/layer.py", "models/speed_models/collision_free_speed.py", "core/scene.py"} <= files
    assert not any("vision" in name or "trials" in name for name in files)


def test_texts_and_judgements_do_not_count_as_code(tmp_path, monkeypatch):
    folder = tmp_path / "validation"
    folder.mkdir()
    monkeypatch.setattr(digest, "__file__", str(folder / "code_digest.py"))

    def code(name, text):
        file = folder / f"{name}.py"
        file.write_text(text, encoding="utf-8")
        return digest._code(file)

    first = code("a", '"""One."""\nX = 1  # why\nC = Check("a", "b")\n\ndef judge(row):\n    return 1\n')
    assert (
        code("b", '"""Two."""\nX = 1\nC = Check("a", "c")\n\ndef judge(row):\n    """Judge."""\n    return 2\n')
        == first
    )
    assert code("c", '"""One."""\nX = 2\nC = Check("a", "b")\n\ndef judge(row):\n    return 1\n') != first


def test_rows_are_valid_for_their_parameters_only(tmp_path):
    file = tmp_path / "csm.json"
    kept = ResultFile(file, CollisionFreeSpeed(), False)
    kept.add(CORNER, {0: {"out": 20}, 3: {"out": 19}}, 2.0)
    kept.add(CORNER, {1: {"out": 18}}, 1.5)
    again = ResultFile(file, CollisionFreeSpeed(), False)
    assert again.rows(CORNER) == {0: {"out": 20}, 1: {"out": 18}, 3: {"out": 19}}
    assert again.seconds(CORNER) == 3.5
    assert ResultFile(file, CollisionFreeSpeed(time_gap=1.1), False).rows(CORNER) == {}
    assert ResultFile(file, CollisionFreeSpeed(), True).rows(CORNER) == {}
    assert json.loads(file.read_text())["model"] == repr(CollisionFreeSpeed())


def test_more_starts_are_added_to_the_stored_ones(tmp_path, monkeypatch):
    asked = []

    def run(model, numbers, quick, report):
        asked.append(list(numbers))
        return [{"out": 20, "seconds": 20.0 + n, "outside": 0.0, "overlap": 0.0} for n in numbers]

    monkeypatch.setattr("crowdbot.validation.run.STUDIES", ())
    monkeypatch.setattr("crowdbot.validation.run.code_digest", lambda modules: "code")
    alone = CORRIDOR_TIME._replace(run=run, judge=lambda result: CORNER.judge({**result, "out": 20}))
    monkeypatch.setattr("crowdbot.validation.run.CHECKS", (CORNER._replace(run=run), alone))
    assert validate({"orca": ORCA()}, tmp_path, starts=3).outcomes["orca"]["rimea-6"].starts == 3
    found = validate({"orca": ORCA()}, tmp_path, starts=12).outcomes["orca"]
    assert asked == [[0, 1, 2], [0], [3, 4], [5, 6, 7, 8, 9], [10, 11]]
    assert (found["rimea-6"].starts, found["rimea-1"].starts) == (12, 1)
    assert found["rimea-6"].result["seconds"] == pytest.approx(25.5)
    assert validate({"vog": ORCA()}, tmp_path, starts=5, compute=False).outcomes["vog"] == {}
    with pytest.raises(InputError, match="at least 1 start, not 0"):
        validate({}, tmp_path, starts=0)


def test_bins_of_starts_pool_to_those_of_all_values():
    rng = np.random.default_rng(4)
    density, speed = rng.uniform(0.0, 3.0, (3, 200)), rng.uniform(0.2, 1.4, (3, 200))
    found = pool_bins([bin_values(density[k], speed[k], 0.5) for k in range(3)], 0.5, 5)
    number = np.floor(density / 0.5)
    assert found["density"] == [0.25, 0.75, 1.25, 1.75, 2.25, 2.75]
    assert found["speed"] == pytest.approx([speed[number == n].mean() for n in range(6)], abs=1e-5)
    assert found["spread"] == pytest.approx([speed[number == n].std() for n in range(6)], abs=1e-6)
    assert all(low <= mean <= high for low, mean, high in zip(found["low"], found["speed"], found["high"], strict=True))


def test_one_start_ends_when_its_last_person_leaves():
    present = np.ones((5, 2, 2), dtype=bool)
    present[3:, 0] = False
    walk = CrowdTracks(np.arange(5.0), np.zeros((5, 2, 2, 2)), present)
    assert one_start(walk, 0).times[-1] == 2.0
    assert one_start(walk, 1).times[-1] == 4.0


def _found(check, model):
    rows = check.run(model, (0, 1), True, _quiet)
    return check.summarize(rows), check.judge(check.summarize(rows))


def test_people_wait_for_their_premovement_time():
    result, verdict = _found(PREMOVEMENT, ORCA())
    assert verdict.passed, verdict
    assert result["delay"] < 2.0
    moved, wrong = _found(PREMOVEMENT, Pulled())
    assert not wrong.passed
    assert moved["drift"] > 1.0
    assert "pushed up to" in wrong.words


def test_everybody_leaves_by_the_assigned_exit():
    result, verdict = _found(ASSIGNED_EXITS, Straight())
    assert verdict == ("23 of 23", True, "")
    assert result["wrong"] == 0
    right_only = ASSIGNED_EXITS.judge({**result, "right": 20, "wrong": 3, "outside": 0.1})
    assert right_only.words.startswith("3 of 23 people leave twelve cabins by the wrong exit; 10 %")


def test_a_crowd_against_takes_time():
    result, _ = _found(COUNTER_FLOW, ORCA())
    assert result["against"] == [0, 10]
    assert result["stuck"] == 0
    faster = COUNTER_FLOW.judge({**result, "seconds": [30.0, 20.0]})
    assert not faster.passed
    assert "faster if more people" in faster.words


def test_only_a_model_with_cohesion_waits_for_a_slow_member():
    alone, _ = _found(SLOW_MEMBER, ORCA())
    together, _ = _found(SLOW_MEMBER, GroupForce())
    assert alone["gap"] > 5.0
    assert together["gap"] < 0.7 * alone["gap"]
    assert SLOW_MEMBER.judge({"gap": None, "interval": None}).value == "not all arrive"


def test_the_time_step_of_a_first_order_model_has_no_effect_on_a_lone_walker():
    result, _ = _found(TIME_STEPS, Straight())
    assert result["own"] == 0.05
    assert result["steps"] == [0.05, 0.1]
    assert result["walk"][0][0] == pytest.approx(result["walk"][1][0], abs=0.11)
    assert result["crowd"][0][0] == pytest.approx(result["crowd"][1][0], abs=0.01)
    different = TIME_STEPS.judge({**result, "flow": [[2.0, 1.9, 2.1], [1.5, 1.4, 1.6]]})
    assert different.value == "own 0.05 s, differs at 0.1 s"


class Counted(Straight):
    """Keeps the time steps it is asked for."""

    def velocity(self, scene, dt, rng=None):
        STEPS.append(round(dt, 9))
        return scene.desired_velocity(dt)


STEPS = []


@pytest.mark.parametrize("step", [0.01, 0.02, 0.05, 0.1])
def test_a_study_uses_its_time_step(step):
    STEPS.clear()
    flow = bottleneck_flow(Counted(), 1.2, 4, (0, 1), step)
    assert len(flow) == 2
    assert set(STEPS) == {step}
    STEPS.clear()
    crowd = corridor_crowd([("one-way", 0.25, 0)], 12.0, 3.0, two_way=False, spread=0.05)
    walk = simulate_periodic(Counted(), crowd, 12.0, 1.0, np.random.default_rng(0), _quiet, step)
    assert set(STEPS) == {step}
    assert walk.times.tolist() == pytest.approx([0.0, 0.2, 0.4, 0.6, 0.8, 1.0])


def test_every_case_of_the_guidelines_is_run_or_has_a_reason():
    known = {check.name for check in (*CHECKS, *STUDIES)}
    for case in (*RIMEA_CASES, *ISO_CASES):
        assert set(case.where) <= known
        assert case.where or case.why
    assert [case.name for case in RIMEA_CASES] == [str(number) for number in range(1, 16)]


def test_a_row_names_the_variant():
    assert variant_of(SocialForce()) == "variant gradient"
    assert variant_of(ORCA()) == ""
