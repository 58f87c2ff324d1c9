"""PredictionBoard: the recording, the predictors, the degradation and the results of a session."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from crowdbot.core import InputError
from crowdbot.data import FILE_OPTIONS, FORMATS, Recording, Trajectories, Windows, detect_format
from crowdbot.prediction import PredictorSpec
from crowdbot.web.plain_json import clean_json

from .background_picture import BackgroundPicture
from .prediction_results import PredictorResults
from .prediction_setup import WINDOW_OPTIONS, DegradationChoice, PredictionSetup, open_setup
from .prediction_worker import PredictionTask, TaskMember, input_windows
from .predictor_choice import PredictorChoice
from .scene_frame import recording_bounds

MOST_PREDICTORS = 12
MOST_WINDOWS = 20_000
CLEAN, DEGRADED = "clean", "degraded"
INPUTS = (CLEAN, DEGRADED)


@dataclass
class BoardMember:
    """A predictor on the board.

    Fields:
        key: its name in commands.
        slot: number that gives its colour and dash.
        choice: the settings of its dialog.
        spec: the predictor.
        results: by input, ``clean`` and ``degraded``.
        fit: result of a calibration over the whole recording, JSON, or None.
    """

    key: str
    slot: int
    choice: PredictorChoice
    spec: PredictorSpec
    results: dict[str, PredictorResults] = field(default_factory=dict)
    fit: dict[str, Any] | None = None

    @property
    def label(self) -> str:
        """Short name, with the number of futures."""
        many = f", {self.choice.samples} futures" if self.choice.samples > 1 else ""
        return self.spec.label + many

    def facts(self, labels: list[str]) -> dict[str, Any]:
        """Return the member as JSON; the full name is the label where short ones would be ambiguous."""
        label = self.label if labels.count(self.label) == 1 else f"{self.spec.name}"
        return {
            "key": self.key,
            "slot": self.slot,
            "label": label,
            "name": self.spec.name,
            "settings": self.choice.settings,
            "calibrated": self.choice.calibrated,
            "results": {name: result.summary() for name, result in self.results.items()},
            "fit": clean_json(self.fit),
        }


class PredictionBoard:
    """What the prediction tab shows; has no windows and no processes.

    Attributes:
        setup: recording, seed and mode; None while no recording is open.
        members: the predictors, in the order of the list.
        degradation: degradation of the observed rows, or None.
        background: picture behind the scene, or None.
    """

    def __init__(self) -> None:
        self.setup: PredictionSetup | None = None
        self.members: list[BoardMember] = []
        self.degradation: DegradationChoice | None = None
        self.background: BackgroundPicture | None = None
        self._number = 0
        self._format = ""
        self._facts: dict[str, Any] = {}
        self._inputs: dict[str, tuple[Windows, Windows]] = {}

    @property
    def recording(self) -> Recording:
        """The open recording.

        Raises:
            InputError: none is open.
        """
        if self.setup is None:
            raise InputError("no recording is open; open one first")
        return self.setup.recording

    @property
    def tracks(self) -> Trajectories:
        """The tracks of the open recording."""
        return self.recording.rest

    def open(self, path: Path, options: Mapping[str, Any], name: str, find: Callable[[str], Path] = Path) -> None:
        """Open a recording; results of the recording before are dropped, the predictors stay.

        Args:
            path: the file.
            options: options of the recording; None or an empty word takes the default.
            name: name of the file in the folder of the session.
            find: returns the path of another file of the session by its name.

        Raises:
            InputError: the file cannot be read, an option is not allowed, or there is no window.
        """
        setup = open_setup(path, options, find)
        recording = setup.recording
        found = recording.format or detect_format(path, bool(recording.columns))
        windows = recording.windows
        if len(windows[0]) > MOST_WINDOWS:
            raise InputError(f"{path.name} has {len(windows[0])} windows, more than {MOST_WINDOWS}; use every n-th one")
        same = self.setup is not None and self.setup.recording.path == recording.path
        self.setup, self._format, self._inputs = setup, found, {CLEAN: windows}
        given = {option: options.get(option) for option in FILE_OPTIONS}
        windows_of = {option: getattr(recording, option) for option in WINDOW_OPTIONS}
        self._facts = {**self._fixed_facts(), "path": name, "options": {**given, **windows_of}}
        if not same:
            self.background, self.degradation = None, None
        for member in self.members:
            member.results, member.fit = {}, None

    def add(self, settings: Mapping[str, Any]) -> BoardMember:
        """Add a predictor.

        Raises:
            InputError: a setting is not allowed, or the same predictor is there.
        """
        choice = PredictorChoice.of(settings)
        spec = choice.spec()
        if self.setup is not None:
            spec.check(self.recording, self.setup.live)
        if len(self.members) >= MOST_PREDICTORS:
            raise InputError(f"there are {MOST_PREDICTORS} predictors; remove one first")
        if any((member.spec.name, member.choice.samples) == (spec.name, choice.samples) for member in self.members):
            raise InputError(f"the predictor {spec.name} is in the list already")
        self._number += 1
        slots = {member.slot for member in self.members}
        slot = next(number for number in range(MOST_PREDICTORS) if number not in slots)
        member = BoardMember(f"p{self._number}", slot, choice, spec)
        self.members.append(member)
        return member

    def member(self, key: str) -> BoardMember:
        """Return a predictor by its key.

        Raises:
            InputError: there is none.
        """
        board_member = next((member for member in self.members if member.key == key), None)
        if board_member is None:
            raise InputError(f"predictor {key!r:.40} is not in the list")
        return board_member

    def degrade(self, choice: DegradationChoice | None) -> None:
        """Set the degradation of the observed rows; results of the one before are dropped.

        Raises:
            InputError: the recording cannot be degraded so.
        """
        windows = None
        if choice is not None:
            windows = input_windows(self.recording, choice.degradation, self._setup.seed)
        self.degradation = choice
        self._inputs.pop(DEGRADED, None)
        if windows is not None:
            self._inputs[DEGRADED] = windows
        for member in self.members:
            member.results.pop(DEGRADED, None)

    def resume(self, seed: int, live: bool, degradation: Mapping[str, Any] | None) -> None:
        """Set what the latest run had: seed, mode, and name and values of the degradation.

        Raises:
            InputError: the recording cannot be degraded so.
        """
        self.setup = dataclasses.replace(self._setup, seed=seed, live=live)
        if degradation is not None:
            self.degrade(DegradationChoice.of(degradation["name"], degradation["values"]))

    def windows(self, name: str = CLEAN) -> tuple[Windows, Windows]:
        """Return past and future of an input, ``clean`` or ``degraded``."""
        if name not in self._inputs:
            raise InputError("no recording is open; open one first" if name == CLEAN else "the input is not degraded")
        return self._inputs[name]

    def index(self, index: int) -> int:
        """Return the index of a window, checked."""
        count = len(self.windows()[0])
        if not 0 <= index < count:
            raise InputError(f"window {index} does not exist; there are {count}")
        return index

    def prepare(self, seed: int, live: bool) -> list[tuple[PredictionTask, dict[str, PredictorResults]]]:
        """Return the tasks of a run, one for each input, and empty results of their members.

        Raises:
            InputError: there is no recording or no predictor, or a predictor cannot be used with the recording.
        """
        if not self.members:
            raise InputError("there is no predictor; add one first")
        if live and self.degradation is not None:
            raise InputError("frame-by-frame prediction of degraded rows is not supported; remove the degradation")
        self.setup = dataclasses.replace(self._setup, seed=seed, live=live)
        if self.degradation is not None:
            self._inputs[DEGRADED] = input_windows(self.recording, self.degradation.degradation, seed)
        for member in self.members:
            member.spec.check(self.recording, live)
        result = []
        for name, windows in self._inputs.items():
            task = dataclasses.replace(
                self.task(self.members),
                degradation=None if name == CLEAN or self.degradation is None else self.degradation.degradation,
            )
            results = {}
            for member in self.members:
                results[member.key] = member.results[name] = PredictorResults(*windows)
            result.append((task, results))
        return result

    def task(self, members: list[BoardMember]) -> PredictionTask:
        """Return the task of some predictors on the recording as it is."""
        setup = self._setup
        parts = tuple(TaskMember(member.key, member.spec, member.choice.samples) for member in members)
        return PredictionTask(setup.recording, parts, None, setup.seed, setup.best_of, setup.live)

    def facts(self) -> dict[str, Any]:
        """Return the board as JSON."""
        labels = [member.label for member in self.members]
        own = self.degradation
        return {
            "recording": None if self.setup is None else self._recording_facts(),
            "predictors": [member.facts(labels) for member in self.members],
            "degradation": None
            if own is None
            else {"name": own.name, "values": dict(own.values), "text": str(own.degradation)},
        }

    @property
    def _setup(self) -> PredictionSetup:
        _ = self.recording
        assert self.setup is not None
        return self.setup

    def _recording_facts(self) -> dict[str, Any]:
        background = None if self.background is None else self.background.facts
        own = {"seed": self._setup.seed, "live": self._setup.live, "background": background}
        return self._facts | own | {"bounds": recording_bounds(self.recording.tracks, background)}

    def _fixed_facts(self) -> dict[str, Any]:
        recording, tracks, past = self.recording, self.recording.tracks, self.windows()[0]
        return {
            "file": Path(recording.path).name,
            "format": self._format,
            "about": str(FORMATS[self._format]),
            "fps": tracks.fps,
            "frame_step": tracks.frame_step,
            "dt": tracks.dt,
            "units": tracks.units,
            "note": tracks.note,
            "summary": clean_json(tracks.summary()),
            "robots": len(tracks.robots),
            "walls": [ring.tolist() for ring in tracks.walls],
            "windows": len(past),
            "frames": past.frame[:, -1].tolist(),
            "observe": recording.observe,
            "predict": recording.predict,
            "protocol": recording.protocol,
        }
