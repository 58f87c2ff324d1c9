"""The tabs of the app, in the order of the page."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from crowdbot.core import InputError, did_you_mean
from crowdbot.data import detect_format
from crowdbot.trials import builtin_trials

from .desk import Desk
from .editor import EditorDesk
from .evaluation import RESULT, EvaluationDesk
from .experiments import ExperimentDesk, chosen_streams
from .jobs.job_desk import JobDesk
from .prediction import PredictionDesk
from .simulator import SimulatorDesk

DESKS: tuple[type[Desk], ...] = (SimulatorDesk, PredictionDesk, EditorDesk, EvaluationDesk, ExperimentDesk, JobDesk)


class FirstView(NamedTuple):
    """What a server shows first.

    Fields:
        desks: the tabs.
        readable: folders that may be read besides the folder of the app.
        tab: name of the tab; empty for the one that every page shows first.
    """

    desks: tuple[type[Desk], ...]
    readable: tuple[Path, ...]
    tab: str


def opened_first(desks: tuple[type[Desk], ...], name: str) -> FirstView:
    """Return the desks of a server whose sessions first show a trial, an episode, a recording or an evaluation.

    Args:
        desks: the tabs.
        name: trial file, episode file, recording of people, ``result.json`` of an evaluation or its folder, or name of
            a built-in trial.

    Raises:
        InputError: there is no such file or trial, or the file is none of these.

    >>> opened_first(DESKS, "frontal").desks[0].first
    'frontal'
    """
    path = Path(name)
    if path.is_dir() and (path / RESULT).is_file():
        path /= RESULT
    if path.is_file():
        own: type[Desk] = _desk_of(path)
        first, readable = str(path.resolve()), [path.resolve().parent]
    elif name in builtin_trials():
        own, first, readable = SimulatorDesk, name, list[Path]()
    elif path.suffix:
        raise InputError(f"--open {name}: the file does not exist")
    else:
        raise InputError(f"--open {name}: no file and no built-in trial{did_you_mean(name, builtin_trials())}")
    shown = type(own.__name__, (own,), {"first": first, "__doc__": own.__doc__})
    return FirstView(
        tuple(shown if desk is own else desk for desk in desks), tuple(readable), "" if own is desks[0] else own.name
    )


def _desk_of(path: Path) -> type[Desk]:
    """Return the tab that shows a file."""
    if path.suffix in (".xml", ".mcap"):
        return SimulatorDesk
    if path.name == RESULT:
        return EvaluationDesk
    try:
        detect_format(path)
    except InputError as error:
        kinds = "a trial (.xml), an episode (.mcap), the result.json of an evaluation"
        raise InputError(f"--open {path}: neither {kinds} nor a recording of people: {error}") from None
    return PredictionDesk


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
