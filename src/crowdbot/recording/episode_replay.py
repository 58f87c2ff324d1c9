"""Replay: simulate a recorded episode again and compare the digests."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from crowdbot.core import EpisodeError
from crowdbot.simulation import EpisodeDigest, RunFailure, catch_interrupt, run_to_end

from .attachments import unpack_attachments
from .episode_reader import read_metadata, recorded_failure
from .metadata import END_KEYS, versions
from .provenance import DigestComparison, OrderReplay, Provenance, digests

__all__ = ["Replay", "replay"]


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
        progress: called with the completed fraction, 0 to 1.

    Raises:
        EpisodeError: the file cannot be read, or a file of its trial is missing, differs from the recorded one, or is
            not trusted.
        TrialError: this version cannot read the trial in it.
    """
    path = Path(path)
    known, wanted = read_metadata(path), digests(path)
    complete = all(key in known for key in END_KEYS)
    if not (complete or wanted):
        raise EpisodeError(f"{path} has no recorded steps: the run was killed before the first one")
    recorded = known if complete else known | _ended(known, wanted)
    comparison = DigestComparison(EpisodeDigest(), wanted)
    with unpack_attachments(path, known, folder, trust) as place, catch_interrupt() as stop:
        course = Provenance.of(path, place.folder, trust)
        simulation = course.simulate_until(comparison, stop)
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
    )


def _ended(known: dict[str, str], wanted: dict[int, str]) -> dict[str, str]:
    """Return the outcome of a replay that is interrupted at the last recorded step."""
    last = max(wanted)
    return {"digest": wanted[last], "outcome": "interrupted", "steps": str(last // int(known["step_ns"]))}
