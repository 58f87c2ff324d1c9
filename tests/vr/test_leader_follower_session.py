"""A whole session of the leader-follower experiment with a headset: consent, four conditions, report."""

from __future__ import annotations

import contextlib
import re
import shutil
import threading
import time

import numpy as np
import pytest
from headset_messages import message
from headset_sessions import open_session, phase, until

from crowdbot.cli import main
from crowdbot.experiments import analyse_sessions, builtin_experiments, read_trial_latency, summary
from crowdbot.recording import read_episode, replay
from crowdbot.trials import parse_trial
from crowdbot.vr import read_headset_clock

GAIN, DELAY = 0.85, 0.3
SHOWN = 0.05  # age of the picture [s]


class EmulatedFollower:
    """A headset whose wearer follows the robot, or leads as a sinusoid; the clock is 5 s ahead of the server."""

    def __init__(self, desk, experiments):
        self.told, self.experiments = [], experiments
        self.person = desk.arrive(self.told.append)
        self._ends, self._desk, self._seen = threading.Event(), desk, [(0.0, 0.0)]
        self._run, self._start, self._begin = None, None, 0.0
        self._thread = threading.Thread(target=self._move, daemon=True)
        self._thread.start()

    def _way(self, now):
        """Return how far the wearer stands back [m]."""
        run = self.experiments._run
        simulation = None if run is None else run.simulation
        if simulation is None:
            return 0.0
        robot = simulation.trial.robots[0]
        place = simulation.world.environment_scene(0).position[0, simulation.agent_of(robot.name), 0]
        if run is not self._run:
            self._run, self._start, self._begin, self._seen = run, float(place), now, [(now, 0.0)]
        self._seen.append((now, float(place) - self._start))
        if type(robot.navigator).__name__ == "FollowerNavigator":
            return 0.3 * (1.0 - np.cos(2.0 * np.pi * (now - self._begin) / 4.0))
        times, ways = np.array(self._seen[-2000:]).T
        return GAIN * float(np.interp(now - SHOWN - DELAY, times, ways))

    def _move(self):
        number, exchange = 0, None
        while not self._ends.wait(0.014):
            number, now = number + 1, time.monotonic()
            more = {"pictures": np.array([[now - SHOWN, now + 5.0]])}
            more |= {} if exchange is None else {"clock": np.array(exchange)}
            data = message(now + 5.0, head=(-self._way(now), 0.0, 1.6), number=number, **more)
            exchange = (*self.person.take(data)["clock"], time.monotonic() + 5.0)

    def stop(self):
        self._ends.set()
        self._thread.join()
        self._desk.depart(self.person, False)


def answers_of(questions):
    """Return an answer to each question of a screen."""
    result = {}
    for question in questions:
        kind = question["kind"]
        if kind == "choice":
            result[question["name"]] = question["options"][0]["value"]
        elif kind == "scale":
            result[question["name"]] = question["steps"][-1]
        elif kind == "number":
            result[question["name"]] = 30
    return result


@pytest.mark.live
def test_a_participant_in_a_headset_goes_from_consent_to_the_report(tmp_path, capsys):
    folder = tmp_path / "files"
    with contextlib.ExitStack() as stack:
        session = stack.enter_context(open_session(folder, {"meet.xml": _first()}))
        shutil.copytree(builtin_experiments()["leader-follower"], folder / "study")
        for path in (folder / "study").glob("*.xml"):
            text = path.read_text().replace('duration="48"', 'duration="10"').replace('cycles="6"', 'cycles="2"')
            text = text.replace('amplitude="0.4" period="8"', 'amplitude="0.3" period="4"')
            path.write_text(text.replace(' headset="false"', ""))  # the headset moves the avatar in all trials
        desk, vr = session.desk("experiments"), session.desk("vr")
        vr.set({"timeout": 8.0, "pause_when_lost": False})
        desk.open("study/experiment.xml", 1)
        guest = EmulatedFollower(vr, desk)
        state = desk.greet()
        while state["phase"] not in ("done", "aborted"):
            assert state["phase"] == "screen", state["reason"]
            desk.finish_screen(state["index"], answers_of(state["questions"]))
            until(lambda: desk.greet()["phase"] != "running")
            state = phase(desk, "screen", "done", "aborted", "pause")
        guest.stop()
        desk.leave()
    assert state["phase"] == "done"
    data = next((folder / "experiments").iterdir())
    rows = summary(data)
    assert [row["outcome"] for row in rows] == ["timeout"] * 4
    assert {row["consent.agree"] for row in rows} == {"yes"}
    assert all(1.0 <= row["presence.presence"] <= 7.0 for row in rows)
    assert all(row["sickness_after.sickness_total"] > 0.0 for row in rows)
    found = analyse_sessions(data)
    assert [trial.reason for trial in found.trials if trial.reason] == []
    assert len(found.conditions) == 4
    for trial in found.trials:
        home = next((data / "participant-001").glob(f"*-{trial.condition}"))
        orders = [order for _, order in read_episode(home / "episode.mcap").orders]
        assert {getattr(order, "avatar", "participant") for order in orders} == {"participant"}
        latency = read_trial_latency(home, read_trial(home).avatars[0])
        assert latency.motion == trial.values["motion_latency"]
        assert replay(home / "episode.mcap").equal
        assert read_headset_clock(home / "participant.headset").offset[-1] == pytest.approx(-5.0, abs=0.05)
        values = trial.values
        assert values["picture_latency"] == pytest.approx(SHOWN, abs=0.02)
        assert values["motion_latency"] > (0.1 if trial.condition.endswith("vr") else 0.02) - 1e-6
        if trial.labels["leader"] == "robot":
            with capsys.disabled():
                print(
                    f"{trial.condition}: lag {1e3 * values['lag']:.0f} ms,"
                    f" motion {1e3 * values['motion_latency']:.0f} ms,"
                    f" picture {1e3 * values['picture_latency']:.0f} ms, own lag {1e3 * values['own_lag']:.0f} ms,"
                    f" gain {values['gain']:.3f}"
                )
            assert values["own_lag"] == pytest.approx(values["lag"] - values["motion_latency"] - SHOWN, abs=0.02)
    report = tmp_path / "report.html"
    assert main(["experiment", "analyse", str(data), "--out", str(report)]) == 0
    assert "participants: 1, trials: 4" in capsys.readouterr().out
    page = report.read_text()
    assert "age of the state in the headset" in page
    assert page.count("<svg") == 2
    assert not re.search(r"""(src|href)=["']?https?:""", page)


def read_trial(home):
    return parse_trial(read_episode(home / "episode.mcap").xml)


def _first():
    return """<trial name="meet" duration="600"><stage/><crowd type="orca"/>
<avatar name="participant" source="external" x="1" y="0.5"/><agent x="4" y="1.2" goal="-5,1.2"/></trial>"""
