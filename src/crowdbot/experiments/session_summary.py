"""Summary of sessions: trials and answers of all participants, one row per trial."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from crowdbot.core import EpisodeError, InputError
from crowdbot.trials import read_trial_bytes

from .log import event_of, read_log
from .parser import parse_experiment
from .question import questionnaire_scores
from .session import Session
from .session_folder import COPY, LOG

Row = dict[str, Any]


def session_of(folder: Path) -> tuple[int, Session]:
    """Return the participant number and the session recorded in a folder.

    Raises:
        EpisodeError: the folder has no session, or a damaged one.
        TrialError: the copy of the experiment is damaged.
    """
    path = folder / LOG
    records = read_log(path)
    experiment = parse_experiment(read_trial_bytes(folder / COPY), place=str(folder / COPY), folder=folder, whole=False)
    participant = records[0].get("participant")
    try:
        session = Session.of(experiment, participant if isinstance(participant, int) else 0)
    except InputError as error:
        raise EpisodeError(f"{path}:1: {error}") from None
    for number, record in enumerate(records[1:], 2):
        if "event" in record:
            try:
                session = session.after(event_of(record))
            except InputError as error:
                raise EpisodeError(f"{path}:{number}: {error}") from None
    assert isinstance(participant, int)
    return participant, session


def summary(folder: Path | str) -> list[Row]:
    """Return a row for each trial of each participant in a folder, in session order.

    Each row contains ``participant``, ``session`` (``done``, ``aborted`` or ``unfinished``), ``number``, ``block``,
    ``repetition`` (from 1), ``trial``, ``source``, ``attempt``, ``seed``, ``outcome`` (of the episode; ``failed``,
    ``running`` or ``not run``), ``digest``, ``folder``, the metrics of the episode, and the answers as
    ``screen.question``, with the scores of questionnaires as ``screen.sickness_total``, ``screen.presence`` and so on.
    Answers without a trial are repeated in all rows of the participant.

    Raises:
        EpisodeError: there is no session, or one is damaged.
    """
    folders = sorted(path.parent for path in Path(folder).glob(f"*/{LOG}"))
    if not folders and (Path(folder) / LOG).is_file():
        folders = [Path(folder)]
    if not folders:
        raise EpisodeError(f"{folder} contains no sessions; give the output folder of 'experiment run' (--out)")
    found = [session_of(folder) for folder in folders]
    rows = [
        row for participant, session in sorted(found, key=lambda one: one[0]) for row in _rows(participant, session)
    ]
    columns = list(dict.fromkeys(key for row in rows for key in row))
    fixed = [c for c in columns if "." not in c and c in _FIRST]
    metrics = sorted({key for row in rows for key in row if key.startswith("metric ")})
    rest = [c for c in columns if c not in fixed and c not in metrics]
    plain = {name: name.removeprefix("metric ") for name in metrics}
    names = {name: plain[name] if plain.get(name, name) not in columns and name in plain else name for name in columns}
    return [{names[name]: row.get(name) for name in (*fixed, *metrics, *rest)} for row in rows]


_FIRST = (
    "participant", "session", "number", "block", "repetition", "trial", "source", "attempt", "seed", "outcome",
    "reason", "digest", "folder",
)  # fmt: skip


def _rows(participant: int, session: Session) -> Iterator[Row]:
    """Yield rows; names of metrics are marked for the order of columns."""
    general = dict(_answers(session, 0))
    state = session.phase if session.over else "unfinished"
    for index, step in enumerate(session.steps):
        if step.entry is None or step.screen is not None:
            continue
        result = session.results.get(index)
        row: Row = {
            "participant": participant,
            "session": state,
            "number": step.number,
            "block": step.block,
            "repetition": step.repetition + 1,
            "trial": step.name,
            "source": step.entry.source,
            "attempt": result.attempt if result else None,
            "seed": result.seed if result else None,
            "outcome": (result.outcome or "running") if result else "not run",
            "reason": result.reason if result else "",
            "digest": result.digest if result else "",
            "folder": result.folder if result else "",
        }
        row |= {f"metric {name}": _number(value) for name, value in (result.metrics if result else {}).items()}
        yield row | general | dict(_answers(session, step.number))


def _answers(session: Session, number: int) -> Iterator[tuple[str, Any]]:
    for index, step in enumerate(session.steps):
        if step.number == number and step.screen is not None:
            given: Mapping[str, Any] = session.answers.get(index, {})
            for question in step.screen.questions:
                value = given.get(question.name)
                yield f"{step.name}.{question.name}", "; ".join(value) if isinstance(value, tuple) else value
            for name, score in questionnaire_scores(given).items():
                yield f"{step.name}.{name}", score


def _number(value: Any) -> float | None:
    return math.inf if value == "inf" else -math.inf if value == "-inf" else value


def save_summary(rows: Sequence[Row], path: Path) -> None:
    """Write a summary as ``.csv``, ``.parquet`` or ``.json``, by file extension.

    Raises:
        InputError: the extension is not supported, or the file cannot be written.
    """
    import pandas as pd

    writers = {".csv": "to_csv", ".parquet": "to_parquet", ".json": "to_json"}
    if path.suffix not in writers:
        raise InputError(f"{path.name} must end in {', '.join(writers)}")
    table = pd.DataFrame(rows).convert_dtypes()
    for name in table.columns:
        if table[name].dtype == object:
            table[name] = table[name].map(str, na_action="ignore")
    options: dict[str, Any] = {"orient": "records", "indent": 2} if path.suffix == ".json" else {"index": False}
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        getattr(table, writers[path.suffix])(path, **options)
    except OSError as error:
        raise InputError(f"cannot write {path}: {error.strerror or error}") from None
