"""The simulator desk: runs equal those of the command line, every change is an order that replays, episodes play."""

import itertools
import json
import math
import re
import shlex
import time

import numpy as np
import pytest
from simulator_session import ended, ready, simulator, wait_until

from crowdbot.cli import main
from crowdbot.core import PERSON_COLOR, ROBOT_COLOR, InputError, TrialError
from crowdbot.recording import branch, read_episode, record, replay
from crowdbot.trials import load_trial, trial_groups
from crowdbot.web import call_command, opened_first
from crowdbot.web.simulator.paced_loop import PacedLoop
from crowdbot.web.simulator.trial_preview import thumbnail
from crowdbot.web.tabs import DESKS

TRIAL = "circle-crossing"


def opened(desk, name=TRIAL, paused=True, **options):
    call_command(desk, "open", {"name": name, "paused": paused, **options})
    assert ready(desk)["state"] == ("paused" if paused else "running"), desk._status()["problems"]
    return desk


def test_an_unsteered_run_is_that_of_the_command_line(tmp_path):
    with simulator(tmp_path) as desk:
        opened(desk, seed=3)
        desk.speed(None)
        desk.play()
        status = ended(desk)
        saved = desk.save("own.mcap")
    alone = record(load_trial(TRIAL), 3)
    episode = read_episode(tmp_path / saved)
    assert (episode.digest, status["outcome"]) == (alone.digest, alone.outcome)
    assert episode.metrics["path_length"] == alone.metrics["path_length"] == status["metrics"]["path_length"]
    assert not list((tmp_path / ".running").iterdir())  # the recording of a closed run is gone


def test_everything_a_user_does_is_an_order_and_replays(tmp_path):
    with simulator(tmp_path) as desk:
        opened(desk, seed=1)
        desk.step(5)
        robot = next(person for person in desk.people() if person["kind"] == "robot")
        before = len(desk.people())
        desk.order({"order": "add-person", "x": 0.0, "y": 6.0, "goal_x": 0.0, "goal_y": -6.0})
        people = desk.people()
        assert len(people) == before + 1
        new = max(person["id"] for person in people)
        desk.order({"order": "redirect", "person": new, "x": 5.0, "y": 5.0})
        assert desk.inspect(new)["goal"] == [5.0, 5.0]
        desk.order({"order": "move", "person": new, "x": 1.0, "y": 6.5})
        assert abs(desk.inspect(new)["x"] - 1.0) < 0.1
        desk.order({"order": "remove", "person": 0})
        desk.order({"order": "goal", "robot": robot["name"], "x": 3.0, "y": 1.0})
        desk.set_value("robot/drive/max-speed", "0.4")
        assert desk.inspect(robot["id"])["goal"] == [3.0, 1.0]
        desk.set_value("crowd/time-horizon", "3")
        name = desk.add_robot("turtlebot2", -5.0, 5.0, 5.0, 5.0)
        assert name in {person["name"] for person in desk.people()}
        desk.take_over("robot")
        desk.drive("robot", 0.3, 0.5)
        desk.step(20)
        wait_until(lambda: desk._status()["orders"] >= 12)
        desk.release("robot")
        rows = {row[0]: row[1] for row in desk.inspect(robot["id"])["rows"]}
        desk.step(30)
        wait_until(lambda: desk._player.loop._steps == 0)
        saved = desk.save()
    episode = read_episode(tmp_path / saved)
    assert rows["navigator"] == "orca"
    assert len(episode.orders) >= 12
    assert replay(tmp_path / saved).equal


@pytest.mark.live
def test_a_driven_robot_moves_as_it_is_told_and_stops_when_let_go(tmp_path):
    with simulator(tmp_path) as desk:
        opened(desk, paused=False)
        desk.take_over("robot")
        desk.drive("robot", 0.4, 0.0)
        robot = next(person["id"] for person in desk.people() if person["kind"] == "robot")
        wait_until(lambda: "0.40 m/s" in str(desk.inspect(robot)["rows"]))
        wait_until(lambda: "command', '0.00 m/s" in str(desk.inspect(robot)["rows"]))  # nobody repeats it
        with pytest.raises(InputError, match="there is no robot 'robo', did you mean 'robot'"):
            desk.take_over("robo")
        desk.release("robot")
        with pytest.raises(InputError, match="take it over first"):
            desk.drive("robot", 0.4, 0.0)


@pytest.mark.live
def test_a_person_walks_is_recorded_and_stops_at_walls(tmp_path):
    with simulator(tmp_path) as desk:
        opened(desk, "frontal", paused=False)
        name = desk.become_person(0.0, 0.5)
        ready(desk)
        start = next(person for person in desk.people() if person["name"] == name)
        desk.speed(None)
        for _ in range(200):
            if desk._status()["state"] == "ended":
                break
            desk.walk(name, 1.4, 0.7)
            time.sleep(0.02)
        status = desk._status()
        saved = desk.save()
    assert replay(tmp_path / saved).equal
    episode = read_episode(tmp_path / saved)
    column = int(np.flatnonzero(episode.ids == start["id"])[0])
    path = episode.position[:, column]
    assert np.hypot(*(path[-1] - path[0])) > 0.5
    assert status["orders"] > 10
    corners = np.concatenate([np.asarray(ring) for ring in episode.walls])
    beside = path[path[:, 0] < corners[:, 0].max() - 0.3]
    assert 1.0 < beside[:, 1].max() < corners[:, 1].max()  # it has come to the wall, and not through it


def test_an_episode_plays_seeks_and_branches_like_the_command_line(tmp_path):
    record(load_trial(TRIAL), 2, tmp_path / "long.mcap")
    other = {"robot/navigator/type": "straight"}
    with simulator(tmp_path) as desk:
        desk.open_episode("long.mcap")
        assert ready(desk)["state"] == "paused"
        for seconds in (6.0, 1.0, 7.5, 99.0):
            desk.seek(seconds)
            time_now = desk._status()["time"]
            assert time_now == pytest.approx(min(seconds, desk._status()["duration"]))
            assert desk.session.frames[-1].time == pytest.approx(time_now)
        desk.seek(2.0)
        desk.step(10)
        wait_until(lambda: desk._status()["time"] == pytest.approx(2.5))
        found = desk.episode()
        assert len(found["series"]["time"]) == len(found["series"]["clearance"]) > 20
        name = desk.branch(2.0, other, "branch.mcap")
        desk._branching.join()
        assert desk.session.latest("simulator.branch")["done"]
        desk.open_episode(name)
        assert ready(desk)["begin"] == 2.0
        with pytest.raises(InputError, match="cannot be steered"):
            desk.order({"order": "remove", "person": 0})
    alone = branch(tmp_path / "long.mcap", 2.0, changes=other)
    assert read_episode(tmp_path / "branch.mcap").digest == alone.digest


def test_errors_of_a_trial_are_those_of_check(tmp_path):
    text = '<trial name="bad" duration="-1"><crowd type="orka"/></trial>'
    with simulator(tmp_path) as desk:
        (tmp_path / "bad.xml").write_text(text)
        with pytest.raises(TrialError) as shown:
            desk.open("bad.xml")
        with pytest.raises(TrialError) as checked:
            load_trial(tmp_path / "bad.xml")
        assert shown.value.problems == checked.value.problems
        assert next(trial["name"] for trial in desk.trials()) == "bad.xml"
        with pytest.raises(InputError, match="outside the folder of the app"):
            desk.open("../bad.xml")
        with pytest.raises(InputError, match="nothing is open"):
            desk.play()


@pytest.mark.live
def test_a_new_window_gets_the_state_and_the_history(tmp_path):
    with simulator(tmp_path) as desk:
        desk._visited = True  # no first trial
        opened(desk, paused=False)
        wait_until(lambda: len(desk._history) > 3)
        desk.pause()
        desk.layers(["scans", "no-such-layer"])
        state = desk.greet()
        assert state["status"]["state"] == "paused"
        assert state["source"]["name"] == TRIAL
        assert state["layers"] == ["scans"]
        assert [row[0] for row in state["history"]] == sorted({row[0] for row in state["history"]})
        assert desk.session.latest("simulator.layers") == ["scans"]
        assert "scan0" in desk.session.frames[-1].arrays


def test_one_run_at_a_time_and_a_restart_has_another_seed(tmp_path):
    with simulator(tmp_path) as desk:
        opened(desk)
        first = desk._player
        desk.restart(seed=77)
        assert ready(desk)["seed"] == 77
        wait_until(lambda: not first.loop._thread.is_alive())
        desk.restart(settings={"robot/drive/max-speed": "0.2"})
        ready(desk)
        rows = {row["path"]: row for row in desk.values()}
        assert rows["robot/drive/max-speed"]["text"] == "0.2"
        assert rows["robot/drive/max-speed"]["live"]
        assert not rows["step"]["live"]
        for speed in (0.0, -1.0, 1e9, float("nan")):
            with pytest.raises(InputError, match="expected 0.1 to 100"):
                desk.speed(speed)


@pytest.mark.live
def test_a_pause_is_not_made_up_for():
    ticks = []
    loop = PacedLoop(0.02, lambda: not ticks.append(time.monotonic()), paused=False)
    loop.start()
    wait_until(lambda: len(ticks) > 5)
    loop.pause()
    count = loop.do(lambda: len(ticks))
    time.sleep(0.5)
    assert loop.do(lambda: len(ticks)) == count
    loop.resume()
    wait_until(lambda: len(ticks) > count + 10)
    loop.close(5.0)
    assert ticks[count + 10] - ticks[count] > 0.1  # not all at once
    with pytest.raises(InputError, match="has been closed"):
        loop.do(lambda: None)


@pytest.mark.parametrize(("seconds", "late"), [(1e-4, False), (0.02, True)])
def test_a_loop_that_cannot_keep_its_speed_is_late_until_another_speed_is_chosen(seconds, late):
    """A step of 0.04 s at the speed of 100 has 0.4 ms; each look at the clock takes ``seconds``."""
    now, seen = itertools.count(0.0, seconds), []
    loop = PacedLoop(0.04, lambda: len(seen) < 100 and not seen.append(loop.late), monotonic=lambda: next(now))
    loop.speed = 100.0
    loop.start()
    loop.resume()
    assert loop.ended.wait(60.0)
    assert (seen[3], loop.late) == (False, late)  # a short delay is caught up
    loop.speed = 10.0
    assert not loop.late
    loop.close(5.0)


def test_a_window_that_is_busy_costs_nothing_and_sees_the_end_of_a_pause(tmp_path):
    with simulator(tmp_path) as desk:
        opened(desk)
        desk._player.do(lambda: None)  # the first frame has been sent
        desk.session.is_open = False  # it has not yet drawn what was sent
        desk.session.frames.clear()
        desk.play()
        wait_until(lambda: desk._status()["time"] > 0.3)
        assert desk.session.frames == []
        desk.pause()
        wait_until(lambda: desk.session.frames)
        desk._player.do(lambda: None)
        assert desk.session.frames[-1].time == desk._status()["time"]
        assert len(desk.session.frames) == 1


def test_open_names_a_file_or_a_builtin_trial(tmp_path):
    (tmp_path / "one.xml").write_text("<trial/>")
    desks, readable, tab = opened_first(DESKS, str(tmp_path / "one.xml"))
    assert desks[0].first == str(tmp_path / "one.xml")
    assert readable == (tmp_path,)
    assert tab == ""
    with pytest.raises(InputError, match="did you mean 'frontal'"):
        opened_first(DESKS, "fronta")
    with pytest.raises(InputError, match="does not exist"):
        opened_first(DESKS, "none.mcap")
    (tmp_path / "two.csv").write_text("0 1 0.0 0.0\n10 1 0.5 0.0\n")
    found = opened_first(DESKS, str(tmp_path / "two.csv"))
    assert found.tab == "prediction"
    assert [desk.first for desk in found.desks if desk.name == "prediction"] == [str(tmp_path / "two.csv")]
    (tmp_path / "words.txt").write_text("no tracks")
    with pytest.raises(InputError, match=r"words\.txt: neither a trial .* nor a recording of people"):
        opened_first(DESKS, str(tmp_path / "words.txt"))
    (tmp_path / "result.json").write_text("{}")
    assert opened_first(DESKS, str(tmp_path)).tab == "evaluation"


def test_the_copied_command_and_program_give_the_same_run(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    with simulator(tmp_path / "files") as desk:
        opened(desk, seed=3, settings={"duration": "2", "robot/drive/max-speed": "0.5"})
        command, program = desk.command_line(), desk.python()
        assert command == f"crowdbot run {TRIAL} --seed 3 --set duration=2 --set robot/drive/max-speed=0.5"
        desk.speed(None)
        desk.play()
        ended(desk)
        digest = read_episode(desk.session.workspace.folder / desk.save("own.mcap")).digest
        desk.restart()
        ready(desk)
        desk.pause()
        desk.order({"order": "add-person", "x": 0.0, "y": 6.0, "goal_x": 0.0, "goal_y": -6.0})
        wait_until(lambda: desk._player.given == 1)
        note = "# without 1 order: save the run and use crowdbot replay for the same run"
        assert desk.command_line() == f"{note}\n{command}"
        desk.open_episode("own.mcap")
        ready(desk)
        replay, again = desk.command_line(), desk.python()
    assert main([*shlex.split(command)[1:], "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["digest"] == digest
    exec(program, {})
    assert capsys.readouterr().out.split()[1] == digest
    assert replay == "crowdbot replay files/own.mcap"
    assert main(shlex.split(replay)[1:]) == 0
    capsys.readouterr()
    exec(again, {})
    assert capsys.readouterr().out.split()[1:] == [digest, "True"]


def test_thumbnails_are_pictures_of_the_trials(tmp_path):
    for name, crowd in (("own", "orca"), ("code", "mine.py:Mine")):
        agent = '<agent x="0" y="0" goal="3,0"/>'
        text = f'<trial name="{name}" duration="5"><crowd type="{crowd}"/>{agent}</trial>'
        (tmp_path / f"{name}.xml").write_text(text)
    (tmp_path / "mine.py").write_text(f"open({str(tmp_path / 'ran')!r}, 'w')")
    with simulator(tmp_path) as desk:
        assert desk.resource("thumbnail/own.xml.svg", {}).data.count(b"<circle") == 1
        assert desk.resource("thumbnail/code.xml.svg", {}).data.startswith(b"<svg")
        assert not (tmp_path / "ran").exists()  # a list runs no code
        found = desk.resource("thumbnail/frontal.svg", {})
        assert found.kind == "image/svg+xml"
        assert found.data.startswith(b"<svg")
        assert b'xmlns="http://www.w3.org/2000/svg"' in found.data
        with pytest.raises(KeyError):
            desk.resource("thumbnail/../../x.svg", {})


@pytest.mark.parametrize("name", sorted(trial_groups()))
def test_people_and_robots_of_a_thumbnail_are_seen_at_its_size(name):
    text = thumbnail(name, None).decode()
    width, height = (float(item) for item in re.search(r'viewBox="0 0 (\S+) (\S+)"', text).groups())
    scale = min(72.0 / width, 48.0 / height)  # pixels of the list for a unit of the drawing
    found = re.findall(r'<circle cx="(\S+)" cy="(\S+)" r="(\S+)" fill="(\S+)"', text)
    discs = [(scale * float(x), scale * float(y), scale * float(r), color) for x, y, r, color in found]
    people = [disc for disc in discs if disc[3] == PERSON_COLOR]
    assert {disc[3] for disc in discs} <= {PERSON_COLOR, ROBOT_COLOR}
    trial = load_trial(name)
    assert len(discs) - len(people) == len(trial.robots)
    assert bool(people) == bool(trial.agents or trial.spawners or trial.sources)
    for x, y, radius, _ in discs:
        assert radius > 2.0
        assert radius < x < scale * width - radius
        assert radius < y < scale * height - radius
    for (x, y, radius, _), (u, v, other, _) in itertools.combinations(people, 2):
        assert math.hypot(x - u, y - v) > 0.8 * (radius + other)  # each is told from the next one
