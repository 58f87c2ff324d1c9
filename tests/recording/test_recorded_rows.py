"""Rows of people by time: memory of an episode grows with what was recorded, not with the number of ids."""

import dataclasses
import tracemalloc
from pathlib import Path

import numpy as np
import pytest

from crowdbot.core import EpisodeError
from crowdbot.metrics import AgentStates, TableRobot, people_table
from crowdbot.recording import RecordedEpisode, RecordedRows, episode_reader, read_episode, record, recorded_rows, run
from crowdbot.simulation import log_of, tracks_of
from crowdbot.trials import Trial, parse_trial
from crowdbot.world import REACTIONS

PORTALS = """
<trial name="portals" duration="{duration}" step="0.05"><stage walkable="-4,-4 4,-4 4,4 -4,4"/><crowd type="orca"/>
<journey name="east"><direction heading="0"/></journey>
<spawner count="20" zone="-2,-3.5 2,-3.5 2,3.5 -2,3.5" journey="east"/>
<portal zone="2.5,-4 4,-4 4,4 2.5,4" dx="-5"/>
<robot x="-3" y="0"><goal x="3" y="0"/><drive type="differential-drive"/>
<navigator type="orca"/></robot><end goal="false" collision="false"/></trial>
"""
"""People who come in again at once, each time with a new id."""
ROW = 500
"""Largest memory of an opened episode for each agent at each time [B], with all that is kept besides its row."""


def portals(duration: float) -> Trial:
    return parse_trial(PORTALS.format(duration=duration))


@pytest.fixture(scope="module")
def episode(tmp_path_factory: pytest.TempPathFactory) -> RecordedEpisode:
    path = tmp_path_factory.mktemp("portals") / "e.mcap"
    record(portals(40.0), 1, path)
    return read_episode(path)


def opened(duration: float, folder: Path) -> tuple[int, int, int]:
    """Return rows, ids and the largest number of bytes [B] that were allocated while an episode was opened."""
    path = folder / f"{duration:g}.mcap"
    record(portals(duration), 1, path)
    read_episode(path)  # imports and caches
    tracemalloc.start()
    try:
        found = read_episode(path)
        return len(found.rows.ids), found.rows.count, tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


def test_memory_grows_with_the_rows_and_not_with_the_ids(tmp_path: Path) -> None:
    short, long = opened(10.0, tmp_path), opened(80.0, tmp_path)
    assert long[1] > 5 * short[1] > 250  # ids
    assert long[0] > 7 * short[0]  # rows
    assert (long[2] - short[2]) / (long[0] - short[0]) < ROW
    dense = 41 * 800 * long[1]  # position, velocity, heading and presence of each id at each time
    assert long[2] < dense


def test_the_arrays_are_bytes_of_the_rows(episode: RecordedEpisode) -> None:
    rows = episode.rows
    size = sum(part.nbytes for part in vars(rows).values() if isinstance(part, np.ndarray))
    assert size <= 56 * len(rows.ids) + 16 * len(rows.times) + 8


def test_the_dense_arrays_are_those_of_the_run(episode: RecordedEpisode) -> None:
    alone = run(portals(40.0), 1)
    assert len(episode.ids) > 150
    for name in ("times", "position", "velocity", "heading", "radius", "active", "ids"):
        np.testing.assert_allclose(getattr(episode, name), getattr(alone, name), rtol=0, atol=1e-12)
    assert episode.active.dtype == bool
    assert not episode.position[~episode.active].any()


def test_the_table_of_people_does_not_depend_on_its_parts(
    episode: RecordedEpisode, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = people_table(log_of(episode), [TableRobot(episode.robots[0], "robot")])
    monkeypatch.setattr(episode_reader, "TABLE_CELLS", 5000)
    table = dataclasses.replace(episode).people
    assert list(table) == list(whole)
    assert len(table["id"]) > 150
    for name, column in whole.items():
        assert table[name].tobytes() == column.tobytes(), name


def test_tracks_come_from_the_rows(episode: RecordedEpisode) -> None:
    fresh = dataclasses.replace(episode)
    tracks, expected = fresh.tracks(0.4), tracks_of(episode, episode.name, 0.4)
    assert "position" not in vars(fresh)
    for name in ("id", "frame", "position"):
        np.testing.assert_array_equal(getattr(tracks, name), getattr(expected, name))


def test_arrays_that_would_be_too_large_are_refused(episode: RecordedEpisode, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(recorded_rows, "DENSE_CELLS", 1000)
    fresh = dataclasses.replace(episode)
    with pytest.raises(EpisodeError, match=r"401 times and \d+ ids are too many .* may be 1000: use the rows by time"):
        _ = fresh.position
    assert fresh.rows.log([0, 1]).position.shape == (401, 2, 2)


def test_a_part_of_the_rows_is_that_part_of_the_arrays(episode: RecordedEpisode) -> None:
    rows, ids = episode.rows, episode.rows.present(100, 120)
    log = rows.log(ids, 100, 120)
    assert len(ids) < len(rows.every) / 2
    assert np.array_equal(log.times, episode.times[100:120])
    assert np.array_equal(log.position, episode.position[100:120][:, ids])
    assert np.array_equal(log.active, episode.active[100:120][:, ids])
    assert not np.delete(episode.active[100:120], ids, axis=1).any()
    found, there = rows.find(100, rows.every)
    assert np.array_equal(there, episode.active[100])
    assert np.array_equal(rows.position[found[there]], episode.position[100, there])


@pytest.mark.parametrize(
    ("ids", "said"), [([-1, 3], "has the id -1; ids are from 0 to 4"), ([3, 7], "id 7"), ([3, 3], "two agents")]
)
def test_impossible_ids_are_refused(ids: list[int], said: str) -> None:
    place = np.zeros((2, 2))
    states = AgentStates(0.0, np.array(ids), place, place, place[0], place[0])
    with pytest.raises(ValueError, match=said):
        RecordedRows.of([states], [[]], 5)


def test_somebody_absent_cannot_react() -> None:
    states = AgentStates(0.0, np.array([3]), np.zeros((1, 2)), np.zeros((1, 2)), np.zeros(1), np.zeros(1))
    with pytest.raises(ValueError, match="absent"):
        RecordedRows.of([states], [[]], 5, [{"curious": [4]}])
    codes = RecordedRows.of([states], [[]], 5, [{"curious": [3]}]).reactions
    assert codes is not None
    assert REACTIONS[codes[0]] == "curious"
