"""The tabs of the app, in the order of the page."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from crowdbot.core import InputError, did_you_mean
from crowdbot.trials import builtin_trials

from .desk import Desk
from .editor import EditorDesk
from .evaluation import EvaluationDesk
from .experiments import ExperimentDesk, chosen_streams
from .jobs.job_desk import JobDesk
from .prediction import PredictionDesk
from .simulator import SimulatorDesk

__all__ = ["DESKS", "opened_first", "with_streams"]

DESKS: tuple[type[Desk], ...] = (SimulatorDesk, PredictionDesk, EditorDesk, EvaluationDesk, ExperimentDesk, JobDesk)


def opened_first(desks: tuple[type[Desk], ...], name: str) -> tuple[tuple[type[Desk], ...], tuple[Path, ...]]:
    """Return the desks of a server whose sessions first show a trial or an episode, and the folder to be readable.

    Args:
        desks: the tabs.
        name: trial file, episode file, or name of a built-in trial.

    Raises:
        InputError: there is no such file or trial.

    >>> opened_first(DESKS, "frontal")[0][0].first
    'frontal'
    """
    path = Path(name)
    if path.suffix in (".xml", ".mcap"):
        if not path.is_file():
            raise InputError(f"--open {name}: the file does not exist")
        first, readable = str(path.resolve()), [path.resolve().parent]
    elif name in builtin_trials():
        first, readable = name, list[Path]()
    else:
        raise InputError(f"--open {name}: no file and no built-in trial{did_you_mean(name, builtin_trials())}")
    own = type("SimulatorDesk", (SimulatorDesk,), {"first": first, "__doc__": SimulatorDesk.__doc__})
    return tuple(own if desk is SimulatorDesk else desk for desk in desks), tuple(readable)


def with_streams(desks: tuple[type[Desk], ...], send: bool, record: Sequence[str]) -> tuple[type[Desk], ...]:
    """Return the desks of a server whose sessions of experiments propose streams of the Lab Streaming Layer.

    Args:
        desks: the tabs.
        send: whether events and poses are sent.
        record: streams of other programs that are recorded.

    >>> with_streams((ExperimentDesk,), True, ["pulse"])[0].streams
    StreamChoice(send=True, record=('pulse',))
    """
    choice = chosen_streams(send, record)
    own = type("ExperimentDesk", (ExperimentDesk,), {"streams": choice, "__doc__": ExperimentDesk.__doc__})
    return tuple(own if desk is ExperimentDesk else desk for desk in desks)
