"""Jobs on several processes."""

from __future__ import annotations

import os
import signal
from pathlib import Path

import pytest

from crowdbot.core import CrowdbotError, InputError, each


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


def test_every_job_is_done_once_whatever_the_number_of_workers() -> None:
    jobs = list(range(7))
    expected = [(number, number * number) for number in jobs]
    assert list(each(square, jobs)) == expected
    assert sorted(each(square, jobs, workers=2)) == expected
    assert list(each(square, [], workers=2)) == []


def test_a_killed_process_loses_its_own_job_only_and_that_is_tried_again(tmp_path: Path) -> None:
    jobs = [str(tmp_path / name) for name in ("one", "victim", "three")]
    assert sorted(each(dies_once, jobs, workers=2)) == [(0, "one"), (1, "victim"), (2, "three")]


def test_a_job_that_always_kills_is_given_up() -> None:
    with pytest.raises(CrowdbotError, match=r"2 of 2 jobs were lost: their processes died 3 times"):
        list(each(dies, [1, 2], workers=2))


def test_errors_of_jobs_arrive() -> None:
    for workers in (1, 2):
        with pytest.raises(InputError, match="is refused"):
            list(each(refuses, [1, 2], workers=workers))


def test_no_worker_is_refused() -> None:
    with pytest.raises(InputError, match="workers = 0 must be at least 1"):
        each(square, [1], workers=0)
