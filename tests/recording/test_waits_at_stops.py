"""People who wait at the stops of a journey: when they go on, and the same in files, batches, replays and restores."""

import numpy as np
import pytest

from crowdbot.core import InputError
from crowdbot.recording import branch, record, replay
from crowdbot.simulation import (
    Simulation,
    decode_state,
    encode_state,
    restore_state,
    simulate,
    simulate_seeds,
    state_of,
)
from crowdbot.trials import check_trial, parse_trial

HALL = """<trial name="kiosk" duration="16" step="0.1" substeps="10">
  <crowd type="collision-free-speed"/>
  <journey name="way" then="{then}">
    <point x="4" y="0" wait="3"/>
    <zone points="8,-2 10,-2 10,2 8,2" aim="{aim}" wait="1.5"/>
    <point x="{end}" y="0"/>
  </journey>
  <agent name="ann" x="0" y="0" speed="1" journey="way"/>
  <agent name="bob" x="-6" y="1" speed="1" journey="way"/>
  <source name="door" zone="-4,-3 -2,-3 -2,-2 -4,-2" journey="way" timing="regular" rate="0.5" max-count="2"/>
  <end goal="false"/>
</trial>"""


def hall(then="stay", aim="nearest", end=13):
    return parse_trial(HALL.format(then=then, aim=aim, end=end).encode(), place="kiosk.xml", folder=None, trust=False)


def rests(episode, person):
    """Return begin, length [s] and place of the rests of a person, of at least 0.5 s."""
    k = list(episode.ids).index(person)
    there = episode.active[:, k]
    place, times = episode.position[there, k], episode.times[there]
    still = np.hypot(*np.diff(place, axis=0).T) < 0.01
    edges = np.flatnonzero(np.diff(np.concatenate([[False], still, [False]]).astype(int)))
    pairs = [(a, b) for a, b in edges.reshape(-1, 2).tolist() if times[b] - times[a] > 0.5]
    return [(times[a], times[b] - times[a], place[a]) for a, b in pairs]


@pytest.mark.parametrize("aim", ["nearest", "random"])
def test_people_stay_at_a_stop_for_its_time_and_go_on(aim):
    trial = hall(aim=aim)
    check_trial(trial)
    first, *others = rests(simulate(trial, 0), 0)
    assert first[0] == pytest.approx(3.9, abs=0.4)  # 4 m at 1 m/s, less the tolerance of 0.3 m
    assert first[1] == pytest.approx(3.0, abs=0.4)
    assert np.hypot(*(first[2] - [4.0, 0.0])) < 0.31
    if aim == "nearest":  # with a random point, people walk on to it while they wait
        assert others[0][1] == pytest.approx(1.5, abs=0.3)
        assert others[0][2] == pytest.approx([8.0, 0.0], abs=0.3)


def test_people_of_a_source_wait_too_and_all_go_on():
    episode = simulate(hall(), 0)
    came = [person for person in episode.ids if person > 1]
    assert len(came) == 2
    for person in came:
        k = list(episode.ids).index(person)
        near = np.hypot(*(episode.position[:, k] - [4.0, 0.0]).T) < 0.5
        assert near[episode.active[:, k]].sum() * 0.1 > 3.0


def test_who_leaves_at_the_last_stop_waits_there_first():
    trial = hall(then="leave")
    last = trial.journeys[0].stops[1]
    stays = parse_trial(
        HALL.format(then="leave", aim="nearest", end=13).replace('<point x="13" y="0"/>', "").encode(),
        place="kiosk.xml", folder=None, trust=False,
    )  # fmt: skip
    assert last.wait == 1.5
    episode = simulate(stays, 0)
    k = list(episode.ids).index(0)
    gone = episode.times[np.flatnonzero(episode.active[:, k])[-1]]
    reached = episode.times[np.flatnonzero(episode.position[:, k, 0] > 7.65)[0]]
    assert gone - reached == pytest.approx(1.5, abs=0.3)


def test_a_journey_that_begins_again_waits_each_time():
    trial = parse_trial(
        HALL.format(then="again", aim="nearest", end=2).replace('duration="16"', 'duration="40"').encode(),
        place="kiosk.xml", folder=None, trust=False,
    )  # fmt: skip
    at_kiosk = [rest for rest in rests(simulate(trial, 0), 0) if np.hypot(*(rest[2] - [4.0, 0.0])) < 0.6]
    assert len(at_kiosk) >= 2
    assert [rest[1] for rest in at_kiosk[:2]] == pytest.approx([3.0, 3.0], abs=0.5)


def test_environments_wait_as_alone():
    for seed, episode in zip([3, 1, 8], simulate_seeds(hall(aim="random"), [3, 1, 8]), strict=True):
        assert episode.digest == simulate(hall(aim="random"), seed).digest


@pytest.mark.parametrize("tick", [10, 50, 60, 75, 110])
def test_a_run_restored_within_a_wait_continues_to_the_last_bit(tick):
    first = Simulation(hall(), [1, 2])
    for _ in range(tick):
        first.advance()
    second = Simulation(hall(), [1, 2])
    restore_state(second, decode_state(encode_state(state_of(first))))
    for _ in range(40):
        first.advance()
        second.advance()
    assert encode_state(state_of(first)) == encode_state(state_of(second))


def test_replays_and_branches_wait_as_the_run(tmp_path):
    record(hall(), seed=1, out=tmp_path / "run")
    file = tmp_path / "run" / "episode.mcap"
    assert replay(file).equal
    assert branch(file, at=5.0, out=tmp_path / "branch").digest == simulate(hall(), 1).digest


@pytest.mark.parametrize("wait", ["-1", "1e9", "soon"])
def test_a_time_that_is_not_allowed_is_refused(wait):
    text = HALL.format(then="stay", aim="nearest", end=13).replace('wait="3"', f'wait="{wait}"')
    with pytest.raises(InputError, match="wait"):
        parse_trial(text.encode(), place="kiosk.xml", folder=None, trust=False)
