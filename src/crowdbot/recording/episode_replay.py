"""Replay: simulate a recorded episode again and compare the digests."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from crowdbot.core import EpisodeError, InputError
from crowdbot.simulation import EpisodeDigest, RunFailure, Simulation, catch_interrupt, run_to_end

from .attachments import unpack_attachments
from .episode_reader import read_metadata, recorded_failure
from .keyframes import KeyframeWarning
from .metadata import END_KEYS, versions
from .provenance import DigestComparison, OrderReplay, Provenance, digests
from .recorded_simulation import LATE, continue_from


@dataclass(frozen=True)
class Replay:
    """Result of a replay.

    Fields:
        path: the episode.
        trial, seed: the trial and its seed.
        recorded, replayed: digests of the recording and of the new run.
        outcomes: outcomes of the recording and of the new run.
        recorded_versions, versions: versions of crowdbot, Python, numpy and numba, and the processor, of both runs.
        differs: time [s] of the first recorded step that differs; None if equal or unknown.
        complete: whether the recording is complete; an incomplete one is compared up to its last step.
        failures: the exceptions that ended the recording and the new run.
        changed: trusted code files that differ from the recorded ones.
        begin: time [s] from which the episode was simulated again, that of a keyframe or 0.
    """

    path: Path
    trial: str
    seed: int
    recorded: str
    replayed: str
    outcomes: tuple[str, str]
    recorded_versions: dict[str, str]
    versions: dict[str, str]
    differs: float | None = None
    complete: bool = True
    changed: tuple[str, ...] = ()
    failures: tuple[RunFailure | None, RunFailure | None] = (None, None)
    begin: float = 0.0

    @property
    def software(self) -> str:
        """Software that made the episode, such as ``crowdbot 0.1.0``."""
        return f"crowdbot {self.recorded_versions['version']}"

    @property
    def equal(self) -> bool:
        """Whether both digests are equal."""
        return self.recorded == self.replayed

    def as_dict(self) -> dict[str, Any]:
        """Return the output of ``crowdbot replay --json``."""
        return {
            "episode": str(self.path),
            "trial": self.trial,
            "seed": self.seed,
            "equal": self.equal,
            "recorded": self.recorded,
            "replayed": self.replayed,
            "software": self.software,
            "outcome": self.outcomes[0],
            "replayed_outcome": self.outcomes[1],
            "recorded_versions": self.recorded_versions,
            "versions": self.versions,
            "differs": self.differs,
            "complete": self.complete,
            "changed": list(self.changed),
            "begin": self.begin,
            "error": None if self.failures[0] is None else str(self.failures[0]),
            "replayed_error": None if self.failures[1] is None else str(self.failures[1]),
        }

    def __str__(self) -> str:
        """Return a report in one or two sentences."""
        killed = "" if self.complete else ", killed before its end"
        what = f"{self.path}: {self.trial} with seed {self.seed} (made with {self.software}{killed})"
        told = f"; {', '.join(self.changed)} differs from the recorded code" if self.changed else ""
        recorded, replayed = self.failures
        if recorded is not None:
            told += f"; the recorded run ended with an error: {recorded}"
        if replayed is not None and replayed != recorded:
            told += f"; the replay ended with an error: {replayed}"
        told += f"; simulated from its keyframe at {self.begin:g} s on" if self.begin else ""
        if self.equal:
            return f"{what} replays with the same digest {self.recorded}{told}"
        pairs = ((name, then, self.versions[name]) for name, then in self.recorded_versions.items())
        other = [f"{name} {then} (now {now})" for name, then, now in pairs if then != now]
        why = f"it was recorded with {'; '.join(other)}" if other else "the versions and the processor are equal"
        since = "" if self.differs is None else f" from {self.differs:g} s on"
        return f"{what} does NOT replay{since}: recorded digest {self.recorded}, replayed {self.replayed}; {why}{told}"


def replay(
    path: Path | str,
    *,
    folder: Path | None = None,
    trust: bool = False,
    begin: float = 0.0,
    progress: Callable[[float], None] | None = None,
) -> Replay:
    """Simulate the trial of an episode file again, with its seed, and compare the digests.

    An episode that was interrupted or ended with an error is simulated for the recorded number of steps.

    Args:
        path: the episode.
        folder: folder of the files of the trial (default: the folder of the episode). Code runs from there if it is
            identical to the recorded code. Data files are taken from the episode.
        trust: whether to run other code, including code stored in the episode, and to use files outside that folder
            (which must be identical to the recorded ones).
        begin: time [s] from which the digests are compared. The latest keyframe up to this time is the start; what is
            before it is not simulated. Without such a keyframe, the whole episode is simulated.
        progress: called with the completed fraction, 0 to 1.

    Raises:
        InputError: ``begin`` is not a time from 0 on.
        EpisodeError: the file cannot be read, or a file of its trial is missing, differs from the recorded one, or is
            not trusted.
        TrialError: this version cannot read the trial in it.

    Warns:
        KeyframeWarning: there is no keyframe up to ``begin``, or it is damaged.

    >>> import tempfile
    >>> from crowdbot.recording import run
    >>> from crowdbot.trials import load_trial
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     episode = run(load_trial("frontal", duration=1.0), out=folder)
    ...     result = replay(f"{folder}/episode.mcap")
    >>> result.equal, result.replayed == episode.digest
    (True, True)
    """
    path = Path(path)
    if not 0.0 <= begin < math.inf:
        raise InputError(f"begin = {begin} s must be finite and at least 0")
    known, wanted = read_metadata(path), digests(path)
    complete = all(key in known for key in END_KEYS)
    if not (complete or wanted):
        raise EpisodeError(f"{path} has no recorded steps: the run was killed before the first one")
    recorded = known if complete else known | _ended(known, wanted)
    comparison = DigestComparison(EpisodeDigest(), wanted)
    with unpack_attachments(path, known, folder, trust) as place, catch_interrupt() as stop:
        course = Provenance.of(path, place.folder, trust)
        start = _start(path, course, known, begin, comparison)
        first = 0.0 if start is None else float(start.world.times[0])
        simulation = course.simulate_until(comparison, stop, start=start)
        ticks = int(recorded["steps"]) if recorded["outcome"] in ("interrupted", "error") else None
        steering = [OrderReplay(course.parts[-1].orders)]
        outcome = run_to_end(simulation, [comparison], stop, progress, ticks, steering)
        if stop.asked and simulation.tick != ticks:
            raise KeyboardInterrupt
    now = versions()
    return Replay(
        path,
        recorded["trial_name"],
        int(recorded["seed"]),
        recorded["digest"],
        comparison.digest.hexdigest(outcome),
        (recorded["outcome"], outcome),
        {name: recorded.get(name, "unknown") for name in now},
        now,
        comparison.differs,
        complete,
        place.changed,
        (recorded_failure(recorded), simulation.failures[0]),
        first,
    )


def _start(
    path: Path, course: Provenance, known: dict[str, str], begin: float, comparison: DigestComparison
) -> Simulation | None:
    """Return the simulation at the latest keyframe up to a time [s], None for the beginning."""
    if begin == 0.0:
        return None
    tick = int(begin * 1e9 + 0.5) // int(known["step_ns"])
    simulation = continue_from(path, course, known, tick, comparison)
    if simulation is None:
        sentence = f"{path} has no keyframe of this version from 0 s to {begin:g} s; {LATE}"
        warnings.warn(sentence, KeyframeWarning, stacklevel=3)
    return simulation


def _ended(known: dict[str, str], wanted: dict[int, str]) -> dict[str, str]:
    """Return the outcome of a replay that is interrupted at the last recorded step."""
    last = max(wanted)
    return {"digest": wanted[last], "outcome": "interrupted", "steps": str(last // int(known["step_ns"]))}
