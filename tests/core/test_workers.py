"""Jobs on several processes."""

from __future__ import annotations

import os
import signal
import sys
from pathlib import Path

import pytest

from crowdbot.core import CrowdbotError, InputError, MissingExtra, each, run_saved_jobs, workers


def square(number: int) -> int:
    return number * number


def dies_once(mark: str) -> str:
    """Kill this process, unless it was killed here before."""
    file = Path(mark)
    if file.name.startswith("victim") and not file.exists():
        file.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    return file.name


def dies(number: int) -> int:
    os.kill(os.getpid(), signal.SIGKILL)
    return number


def refuses(number: int) -> int:
    raise InputError(f"{number} is refused")


@pytest.mark.program
def test_every_job_is_done_once_whatever_the_number_of_workers() -> None:
    jobs = list(range(7))
    expected = [(number, number * number) for number in jobs]
    assert list(each(square, jobs)) == expected
    assert sorted(each(square, jobs, workers=2)) == expected
    assert list(each(square, [], workers=2)) == []


@pytest.mark.live
def test_a_killed_process_loses_its_own_job_only_and_that_is_tried_again(tmp_path: Path) -> None:
    jobs = [str(tmp_path / name) for name in ("one", "victim", "three")]
    assert sorted(each(dies_once, jobs, workers=2)) == [(0, "one"), (1, "victim"), (2, "three")]


@pytest.mark.live
def test_a_job_that_always_kills_is_given_up() -> None:
    with pytest.raises(CrowdbotError, match=r"2 of 2 jobs were lost: their processes died 3 times"):
        list(each(dies, [1, 2], workers=2))


@pytest.mark.live
def test_errors_of_jobs_arrive() -> None:
    for count in (1, 2):
        with pytest.raises(InputError, match="is refused"):
            list(each(refuses, [1, 2], workers=count))


def test_no_worker_is_refused() -> None:
    with pytest.raises(InputError, match="workers = 0 must be at least 1"):
        each(square, [1], workers=0)


def test_processes_share_the_processor(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(os, "cpu_count", lambda: 8)
    monkeypatch.delenv("NUMBA_NUM_THREADS", raising=False)
    for count, threads in ((2, "4"), (3, "2"), (16, "1")):
        with workers._share_threads(count):
            assert os.environ["NUMBA_NUM_THREADS"] == threads
        assert "NUMBA_NUM_THREADS" not in os.environ
    monkeypatch.setenv("NUMBA_NUM_THREADS", "5")
    with workers._share_threads(2):
        assert os.environ["NUMBA_NUM_THREADS"] == "4"
    assert os.environ["NUMBA_NUM_THREADS"] == "5"


def save(result: int, file: Path) -> None:
    file.write_text(str(result), encoding="utf-8")


def load(file: Path) -> int:
    return int(file.read_text(encoding="utf-8")) + 1000


def test_saved_jobs_are_loaded_and_the_others_run(tmp_path: Path) -> None:
    files = [tmp_path / "results" / f"{number}.txt" for number in range(4)]
    assert list(run_saved_jobs(square, [1, 2, 3, 4], files, save, load)) == [(0, 1), (1, 4), (2, 9), (3, 16)]
    assert [file.read_text() for file in files] == ["1", "4", "9", "16"]
    assert sorted(file.name for file in files[0].parent.iterdir()) == [file.name for file in files]
    files[1].unlink()
    assert list(run_saved_jobs(square, [1, 2, 3, 4], files, save, load)) == [(0, 1001), (2, 1009), (3, 1016), (1, 4)]


def test_without_files_nothing_is_saved(tmp_path: Path) -> None:
    assert list(run_saved_jobs(square, [5, 6], [], save, load)) == [(0, 25), (1, 36)]
    assert list(tmp_path.iterdir()) == []


def test_an_interrupted_run_keeps_its_results(tmp_path: Path) -> None:
    files = [tmp_path / f"{number}.txt" for number in range(3)]
    results = run_saved_jobs(square, [1, 2, 3], files, save, load)
    assert next(results) == (0, 1)
    results.close()
    assert [file.exists() for file in files] == [True, False, False]


def test_a_cluster_needs_ray(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "ray", None)
    with pytest.raises(MissingExtra, match=r"a cluster needs the extra \[cluster\]"):
        list(each(square, [1], cluster="auto"))
