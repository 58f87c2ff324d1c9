"""Followers in a headset, of known gain and delay, are recovered from the recorded trial and its measured latencies."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest
from headset_messages import message

from crowdbot.experiments import STUDIES, RecordedTrial, builtin_experiments, read_trial_latency
from crowdbot.recording import open_run, read_episode, replay
from crowdbot.trials import load_trial, parse_trial
from crowdbot.vr import (
    RigidTransform,
    RobotStop,
    SharedRooms,
    StreamSettings,
    TrialSeats,
    VrParticipant,
    read_headset_latency,
)
from samples import sample

WHOLE = load_trial(str(builtin_experiments()["leader-follower"] / "robot-leads-vr.xml"))
LEADER = dataclasses.replace(WHOLE.robots[0], navigator=dataclasses.replace(WHOLE.robots[0].navigator, cycles=2))
TRIAL = dataclasses.replace(WHOLE, duration=17.0, robots=(LEADER,))
OFFSET = -731.25  # clock of the headset minus that of the server [s]
SHOWN = 0.062  # age of a state when the headset draws it, without an added delay [s]


class Follower:
    """A participant with a headset at 72 Hz on a network with jitter and losses; all clocks are simulated.

    The participant sees the robot as late as the picture, and repeats its motion with a gain after a delay.
    """

    def __init__(self, trial, folder, gain, delay, settings, loss, seed):
        self.trial, self.gain, self.delay, self.loss = trial, gain, delay, loss
        self.random = np.random.default_rng(seed)
        self.now, self.number, self.exchange, self.waiting = 500.0, 0, None, []
        self.seen, self.start = [(500.0, 0.0)], None
        spec = trial.avatars[0]
        rooms = SharedRooms()
        rooms.rooms["person"].place = RigidTransform.at(spec.x, spec.y, spec.heading)
        self.late = SHOWN + settings.picture_delay + spec.picture_delay
        self.person = VrParticipant(spec.name, rooms, settings, clock=lambda: self.now)
        self.seats = TrialSeats(trial, folder, RobotStop(), lambda _: False)
        self.seats.seat(self.person)

    def network(self):
        return 0.003 + self.random.exponential(0.002) + (0.03 if self.random.random() < 0.05 else 0.0)

    def robot(self, time):
        """Return how far the robot has come towards the participant, at a time of the server."""
        times, ways = np.array(self.seen).T
        return float(np.interp(time, times, ways))

    def send(self, time):
        """Send the pose at a time, which arrives later or not at all."""
        self.number += 1
        if self.random.random() < self.loss:
            return
        back = self.gain * self.robot(time - self.late - self.delay)
        more = {"pictures": np.array([[time - self.late, time + OFFSET]])}
        if self.exchange is not None:
            more["clock"] = np.array(self.exchange)
        data = message(time + OFFSET, (-back, 0.0, 1.6), number=self.number, **more)
        self.waiting.append((time + self.network(), time, data))

    def step(self, run):
        simulation = run.simulation
        place = simulation.world.scene.position[0, simulation.agent_of(self.trial.robots[0].name)]
        self.start = place.copy() if self.start is None else self.start
        begin = 500.0 + float(simulation.world.times[0])
        self.seen.append((begin, float(place[0] - self.start[0])))
        for time in np.arange(np.ceil(begin * 72.0), np.ceil((begin + self.trial.step) * 72.0)) / 72.0:
            self.send(float(time))
        end = begin + self.trial.step
        self.waiting.sort(key=lambda one: one[0])
        while self.waiting and self.waiting[0][0] <= end:
            self.now, time, data = self.waiting.pop(0)
            self.person.take(data)
            self.exchange = (time + OFFSET, self.now, self.now, self.now + self.network() + OFFSET)
        self.now = end
        return run.step(self.seats.orders(simulation))


@pytest.mark.parametrize(
    ("gain", "delay", "added", "factors"),
    sample(
        [
            (0.7, 0.25, {"motion_delay": 0.1, "picture_delay": 0.1, "noise": 0.01}, {}),  # settings of the operator
            (0.9, 0.4, {}, {}),
            (1.1, 0.6, {}, {"delay": 0.15, "picture_delay": 0.2, "noise": 0.01}),  # factors of the trial
        ],
        1,
        rows=True,
    ),
)
def test_gain_and_delay_of_a_follower_are_recovered_under_latency_noise_and_losses(
    gain, delay, added, factors, tmp_path
):
    avatar = dataclasses.replace(TRIAL.avatars[0], **{"delay": 0.0, **factors})
    trial = dataclasses.replace(TRIAL, avatars=(avatar,))
    follower = Follower(trial, tmp_path, gain, delay, StreamSettings(**added), loss=0.1, seed=4)
    with open_run(trial, out=tmp_path) as run:
        while run.outcome is None:
            follower.step(run)
    follower.seats.close()
    episode = read_episode(tmp_path / "episode.mcap")
    recorded = RecordedTrial(parse_trial(episode.xml), episode, tmp_path, 2.0)
    values, labels, _ = STUDIES["leader-follower"].evaluate(recorded)
    motion = 0.02 + added.get("motion_delay", 0.0) + factors.get("delay", 0.0)
    picture = SHOWN + added.get("picture_delay", 0.0) + factors.get("picture_delay", 0.0)
    measured = read_trial_latency(tmp_path, trial.avatars[0])
    assert labels["leader"] == "robot"
    assert measured.motion == pytest.approx(motion, abs=0.005)
    assert measured.picture == pytest.approx(picture, abs=0.005)
    assert 0.1 < measured.lost / follower.number < 0.2  # a tenth is lost, and a twentieth is overtaken by others
    print(
        f"delay {1e3 * delay:.0f} ms, gain {gain:.2f}: lag {1e3 * values['lag']:.1f} ms, motion"
        f" {1e3 * measured.motion:.1f} ms, picture {1e3 * measured.picture:.1f} ms, own lag"
        f" {1e3 * values['own_lag']:.1f} ms, gain {values['gain']:.4f}"
    )
    assert abs(values["own_lag"] - delay) < 0.01
    assert abs(values["gain"] / gain - 1.0) < 0.02
    raw = read_headset_latency([tmp_path / "participant.headset"])
    assert len(raw.motion) > 310  # each step of the trial but the first ones
    assert replay(tmp_path / "episode.mcap").equal
