"""StoredResults: results of the prediction tab in the folder of the session, so that a new server shows them."""

from __future__ import annotations

import contextlib
import dataclasses
import hashlib
import io
import json
import zipfile
import zlib
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.data import Windows
from crowdbot.evaluation import FrameResults
from crowdbot.metrics import PersonErrors, Score
from crowdbot.web.workspace import Workspace

from .prediction_board import BoardMember, PredictionBoard
from .prediction_results import PredictorResults
from .prediction_worker import WindowPart

Arrays = dict[str, NDArray[Any]]
FILE = ".crowdbot-drafts/prediction-results.npz"
ABOUT = "about"
ENDED = ("done", "cancelled", "failed")
DAMAGED = (
    OSError, EOFError, ValueError, KeyError, TypeError, IndexError, AttributeError, zlib.error, zipfile.BadZipFile,
)  # fmt: skip
"""Exceptions of a file that was not written by this program, or not to its end."""


class StoredResults:
    """A file of arrays and JSON; it holds no code, because users can write into the folder of a session.

    Results belong to the settings of their predictor and to the windows that were predicted: what fits to neither is
    left out when the file is read.

    Args:
        workspace: folder of the session.
    """

    def __init__(self, workspace: Workspace) -> None:
        self._workspace, self._path = workspace, workspace.folder / FILE

    def save(self, board: PredictionBoard) -> None:
        """Write the results of all predictors; a full disk must not stop the tab."""
        rows, arrays = list[dict[str, Any]](), Arrays()
        for member in board.members:
            for name, results in member.results.items():
                own = _packed(results) if results.state in ENDED else None
                if own is not None:
                    arrays |= {f"{len(rows)}.{key}": values for key, values in own.items()}
                    rows.append(_facts(member, name, results))
        fits = [
            {"settings": member.choice.settings, "fit": member.fit}
            for member in board.members
            if member.fit is not None
        ]
        about = json.dumps({"results": rows, "fits": fits}).encode()
        buffer = io.BytesIO()
        np.savez_compressed(buffer, **{ABOUT: np.frombuffer(about, dtype=np.uint8)}, **arrays)  # type: ignore[arg-type]
        with contextlib.suppress(OSError, InputError):
            self._workspace.check_space(len(buffer.getvalue()))
            self._path.parent.mkdir(exist_ok=True)
            part = self._path.with_suffix(".part")
            part.write_bytes(buffer.getvalue())
            part.replace(self._path)

    def load(self, board: PredictionBoard) -> None:
        """Give the predictors of a board the results that fit; a file that is damaged has none."""
        try:
            with np.load(io.BytesIO(self._path.read_bytes()), allow_pickle=False) as file:
                about = json.loads(file[ABOUT].tobytes())
                for number, row in enumerate(about["results"]):
                    self._give(board, number, row, file)
                for row in about["fits"]:
                    for member in board.members:
                        if _same(member, row["settings"]):
                            member.fit = row["fit"]
        except DAMAGED:
            return

    def _give(self, board: PredictionBoard, number: int, row: dict[str, Any], file: Any) -> None:
        member = next((member for member in board.members if _same(member, row["settings"])), None)
        try:
            windows = board.windows(row["input"])
        except InputError:  # the input is not degraded now
            return
        if member is None or row["windows"] != _fingerprint(windows):
            return
        keys = [name for name in file.files if name.startswith(f"{number}.")]
        own = {name.partition(".")[2]: file[name] for name in keys}
        member.results[row["input"]] = _unpacked(windows, row, own)


def _same(member: BoardMember, settings: Any) -> bool:
    return bool(json.loads(json.dumps(member.choice.settings)) == settings)


def _facts(member: BoardMember, name: str, results: PredictorResults) -> dict[str, Any]:
    score = results.score
    return {
        "settings": member.choice.settings,
        "input": name,
        "windows": _fingerprint((results.past, results.future)),
        "state": results.state,
        "problem": results.problem,
        "note": results.note,
        "score": None if score is None else [score.predictor, score.samples, score.best_of],
    }


def _fingerprint(windows: tuple[Windows, Windows]) -> str:
    """Return a text that differs for other windows."""
    found = hashlib.blake2b(digest_size=16)
    for window in windows:
        for array in (window.frame, window.id, window.position, window.present):
            found.update(repr(array.shape).encode() + np.ascontiguousarray(array).tobytes())
    return found.hexdigest()


def _packed(results: PredictorResults) -> Arrays | None:
    """Return the windows with results as arrays, None if there are none."""
    part = results.whole()
    if part is None:
        return None
    arrays: Arrays = {
        "first": np.array([part.first]),
        "shapes": np.array([path.shape[:3] for path in part.paths], dtype=np.int64).reshape(-1, 3),
        "ids": np.concatenate(part.ids),
        "paths": np.concatenate([path.ravel() for path in part.paths]),
        "weight": np.concatenate(part.weight),
        "names": np.array(part.names, dtype=np.str_).reshape(-1, 2),
        "fit": np.concatenate([np.stack(item, axis=1) for item in part.fit]) if part.fit else np.zeros((0, 2, 0)),
    }
    for name, values in (("frames", part.frames), ("errors", part.errors)):
        arrays |= {f"{name}.{field.name}": getattr(values, field.name) for field in dataclasses.fields(values)}
    return arrays


def _unpacked(windows: tuple[Windows, Windows], row: dict[str, Any], arrays: Arrays) -> PredictorResults:
    shapes = arrays["shapes"]
    futures, people = shapes[:, 0], shapes[:, 2]
    counts, sizes = np.cumsum(people)[:-1], np.cumsum(2 * shapes.prod(axis=1))[:-1]
    paths = np.split(arrays["paths"], sizes)
    fit = np.split(arrays["fit"], counts) if arrays["fit"].size else []
    part = WindowPart(
        int(arrays["first"][0]),
        FrameResults(**{field.name: arrays[f"frames.{field.name}"] for field in dataclasses.fields(FrameResults)}),
        PersonErrors(**{field.name: arrays[f"errors.{field.name}"] for field in dataclasses.fields(PersonErrors)}),
        np.split(arrays["ids"], counts),
        [path.reshape(*shape, 2) for path, shape in zip(paths, shapes.tolist(), strict=True)],
        np.split(arrays["weight"], np.cumsum(futures)[:-1]),
        [(item[:, 0], item[:, 1]) for item in fit],
        tuple((str(name), str(unit)) for name, unit in arrays["names"]),
    )
    predictor_results = PredictorResults(*windows)
    predictor_results.add(part)
    predictor_results.state, predictor_results.problem, predictor_results.note = (
        str(row[name]) for name in ("state", "problem", "note")
    )
    if row["score"] is not None:
        name, samples, rule = row["score"]
        score = Score.of(part.errors, name, samples, predictor_results.future, rule)
        predictor_results.score = dataclasses.replace(score, seconds_per_window=float(part.frames.seconds.mean()))
    return predictor_results
