"""``people`` of a robot: true states of those seen, of everybody, or tracked in its laser scans."""

import numpy as np
import pytest

from crowdbot.core import TrialError
from crowdbot.recording import record, replay
from crowdbot.simulation import Simulation, simulate, simulate_seeds
from crowdbot.trials import apply_values, load_trial, parse_trial, trial_xml


def trial_with(people, **values):
    return apply_values(load_trial("crossing-flows", duration=4.0), {"robot/people": people, **values})


def observed(people, steps=40):
    simulation = Simulation(trial_with(people), 3)
    simulation.begin()
    for _ in range(steps):
        simulation.advance()
    robot = simulation.robots[0]
    return simulation, robot.observation(simulation.around, 0)


def test_true_people_are_everybody_and_seen_people_are_some():
    _, everybody = observed("true")
    _, some = observed("seen")
    assert len(everybody.people.ids) == 40
    assert 0 < len(some.people.ids) < 40
    assert set(some.people.ids.tolist()) <= set(everybody.people.ids.tolist())


def test_tracked_people_are_near_the_true_ones_but_not_equal():
    simulation, observation = observed("tracked")
    scene = simulation.around.flat
    true = scene.position[0][scene.active[0]]
    away = observation.people.position[:, None] - true[None]
    nearest = np.hypot(away[..., 0], away[..., 1]).min(axis=1)
    assert len(nearest) > 5
    assert np.median(nearest) < 0.1
    assert nearest.max() > 0.0
    assert (observation.people.radius == 0.25).all()


def test_tracked_people_feed_the_track_history():
    simulation = Simulation(trial_with("tracked", **{"robot/tracks": 2.0}), 3)
    simulation.begin()
    for _ in range(60):
        simulation.advance()
    observation = simulation.robots[0].observation(simulation.around, 0)
    assert set(observation.people.ids.tolist()) <= set(observation.tracks.ids.tolist())
    assert len(observation.tracks.times) > 10


def test_a_run_is_equal_alone_and_with_others():
    trial = trial_with("tracked")
    both = simulate_seeds(trial, [3, 4])
    assert [item.digest for item in both] == [simulate(trial, seed).digest for seed in (3, 4)]
    assert both[0].digest != simulate(trial_with("seen"), 3).digest


def test_a_recorded_run_replays_from_its_keyframes(tmp_path):
    trial = apply_values(load_trial("crossing-flows", duration=12.0), {"robot/people": "tracked"})
    done = record(trial, 3, tmp_path / "episode.mcap")
    assert replay(tmp_path / "episode.mcap").equal
    assert done.outcome == "timeout"
    assert replay(tmp_path / "episode.mcap", begin=11.0).equal


def test_tracking_needs_a_laser_scanner():
    text = trial_xml(load_trial("crossing-flows")).replace("<robot ", '<robot people="tracked" ')
    begin, end = text.index("<sensor"), text.index("</robot>")
    with pytest.raises(TrialError, match="no laser scanner"):
        parse_trial(text[:begin] + text[end:])


def test_a_rolling_scanner_replays_from_its_keyframes(tmp_path):
    text = trial_xml(load_trial("crossing-flows", duration=12.0))
    rolling = text.replace('type="lidar2d"', 'type="pulsed-lidar2d" scan-time="0.05" beam-width="0.01"')
    assert rolling != text
    record(parse_trial(rolling), 3, tmp_path / "episode.mcap")
    assert replay(tmp_path / "episode.mcap", begin=11.0).equal
