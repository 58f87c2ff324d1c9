"""What is learned from: every scene once, masks that are true, scenes left out by name, splits that share no row."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from crowdbot.core import DataError, InputError, stream
from crowdbot.data import NoWindowError, Recording
from crowdbot.prediction.training.samples import (
    Samples,
    leave_out,
    recordings_with_windows,
    short_recordings,
    split_in_time,
)


@pytest.fixture(scope="module")
def files(recordings: Path) -> dict[str, Recording]:
    folder = recordings / "eth_ucy_splits" / "train"
    return {path.stem: Recording(str(path), fps=25) for path in sorted(folder.glob("*.txt"))}


@pytest.fixture(scope="module")
def two(files: dict[str, Recording]) -> Samples:
    return Samples.of([files["biwi_eth_train"], files["biwi_hotel_train"]])


def test_scenes_hold_what_the_windows_hold(files: dict[str, Recording], two: Samples) -> None:
    past, future = files["biwi_hotel_train"].windows
    begin = int(np.argmax(two.source == 1))
    batch = two.batch(np.arange(begin, len(two)))
    assert len(two) - begin == len(past)
    assert two.people == sum(int(files[f"biwi_{n}_train"].windows[1].scored.sum()) for n in ("eth", "hotel"))
    for scene in range(0, len(past), 17):
        people = past.present[scene, -1]
        n = int(people.sum())
        assert batch.here[scene].sum() == n
        assert np.array_equal(batch.position[scene, :8, :n], past.position[scene][:, people])
        assert np.array_equal(batch.scored[scene, :n], future.scored[scene, people])
        assert not batch.there[scene, :, n:].any()


def test_batches_hold_every_scene_once_and_are_of_about_the_wanted_size(two: Samples) -> None:
    batches = two.batches(stream(3, "order"), 64)
    together = np.concatenate(batches)
    counted = np.array([two.scored[a:b].sum() for a, b in zip(two.first[:-1], two.first[1:], strict=True)])
    assert sorted(together) == np.flatnonzero(counted).tolist()
    sizes = np.array([counted[batch].sum() for batch in batches])
    assert sizes.max() < 64 + counted.max()
    assert np.median(sizes) > 48
    again = two.batches(stream(3, "order"), 64)
    assert all(np.array_equal(a, b) for a, b in zip(batches, again, strict=True))


def test_some_scenes_can_be_chosen(two: Samples) -> None:
    odd = two.select(np.arange(1, len(two), 2))
    one, other = odd.batch(np.arange(len(odd))), two.batch(np.arange(1, len(two), 2))
    assert all(np.array_equal(a, b) for a, b in zip(one, other, strict=True))
    assert len(two.subsample(10)) == 10
    assert odd.digest != two.digest == two.select(np.arange(len(two))).digest


@pytest.mark.parametrize(
    ("name", "out"),
    [("eth", ["biwi_eth_train"]), ("hotel", ["biwi_hotel_train"]), ("univ", ["students001_train", "students003_train"]),
     ("zara1", ["crowds_zara01_train"]), ("zara2", ["crowds_zara02_train"]), ("zara03", ["crowds_zara03_train"])],
)  # fmt: skip
def test_scenes_are_left_out_by_name(files: dict[str, Recording], name: str, out: list[str]) -> None:
    kept, left = leave_out([*files.values()], name)
    assert [Path(item.path).stem for item in left] == out
    assert len(kept) == 8 - len(out)


def test_folders_have_names_too_and_unknown_ones_are_said(recordings: Path, files: dict[str, Recording]) -> None:
    obsmat = [Recording(str(recordings / "eth_biwi" / f"seq_{name}" / "obsmat.txt")) for name in ("eth", "hotel")]
    assert leave_out(obsmat, "hotel")[1] == obsmat[1:]
    with pytest.raises(InputError, match="no recording matches 'hotl', did you mean 'hotel'"):
        leave_out([*files.values()], "hotl")
    with pytest.raises(InputError, match="excludes all 1 recordings"):
        leave_out([files["biwi_eth_train"]], "eth")


def test_a_split_in_time_shares_no_row(files: dict[str, Recording], tmp_path: Path) -> None:
    one = files["biwi_hotel_train"]
    early, late, *_ = split_in_time([one], 0.25)
    assert 0.15 < len(late) / len(one.windows[0]) < 0.26
    file = tmp_path / "clock.txt"
    file.write_text("".join(f"{10 * t} {who} {t} {who}\n" for t in range(100) for who in (1, 2)))
    early, late, *_ = split_in_time([Recording(str(file), fps=25)], 0.25)
    assert early.position[..., 0].max() < late.position[..., 0].min()
    assert (len(early), len(late)) == (41, 21)
    with pytest.raises(InputError, match=r"share 1.5 must be above 0 and below 1"):
        split_in_time([one], 1.5)
    file = tmp_path / "short.txt"
    file.write_text("".join(f"{10 * t} 1 {t} 0\n" for t in range(30)))
    with pytest.raises(DataError, match="11 windows are too few for a validation share of 25%"):
        split_in_time([Recording(str(file), fps=25)], 0.25)


def test_recordings_too_short_to_cut_are_used_whole(tmp_path: Path) -> None:
    every = []
    for name, rows in zip("abcdefghij", (12, *[30] * 9), strict=True):
        file = tmp_path / f"{name}.txt"
        file.write_text("".join(f"{10 * t} 1 {t} 0\n" for t in range(rows)))
        every.append(Recording(str(file), fps=25))
    kept, left = recordings_with_windows(every)
    assert [item.name for item in left] == ["a.txt"]
    split = split_in_time(kept, 0.25)
    assert split.whole_validation == ("e.txt", "i.txt")
    assert split.whole_training == tuple(f"{name}.txt" for name in "bcdfghj")
    assert (len(split.training), len(split.validation)) == (7 * 11, 2 * 11)
    assert split_in_time(kept[:2], 0.25).whole_validation == ("c.txt",)
    with pytest.raises(NoWindowError, match=r"a\.txt: no window of 8 observed and 12 predicted rows was found"):
        recordings_with_windows(every[:1])


def test_what_does_not_fit_together_is_said(files: dict[str, Recording], recordings: Path) -> None:
    fine = files["biwi_eth_train"]
    corridor = Recording(str(recordings / "hermes" / "Corridor-1D" / "uo-050-180-180.txt"), fps=16, units="cm")
    with pytest.raises(
        InputError, match="has a row every 0.4 s, .* every 0.0625 s; resample them to the same time step"
    ):
        Samples.of([fine, corridor])
    with pytest.raises(InputError, match="there is no training recording"):
        Samples.of([])
    assert short_recordings([fine]) == []
    assert "s; more than 3 minutes are recommended for training" in short_recordings([corridor])[0]
