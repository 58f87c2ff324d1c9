"""Replay: run a recorded episode again and compare."""

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
from .provenance import DigestComparison, Provenance, digests

__all__ = ["Replay", "replay"]


@dataclass(frozen=True)
class Replay:
    """What came out of running a recorded episode again.

    Fields:
        path: of the episode.
        trial, seed: what was run.
        recorded, replayed: digest of the recording and of the new run.
        outcomes: of the recording and of the new run.
        recorded_versions, versions: of crowdbot, Python, numpy and numba, then and now.
        differs: the first recorded instant [s] at which they differ; None when it is not known or there is none.
        complete: whether the recording came to its end; one that was killed is compared as far as it goes.
        failures: the exceptions that ended the recording and the new run.
        changed: files of code that have other bytes than the recorded ones, and were trusted.
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
        """Whether both digests are equal: every recorded array, reading, command and the outcome."""
        return self.recorded == self.replayed

    def as_dict(self) -> dict[str, Any]:
        """Return what ``crowdbot replay --json`` prints."""
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
        """Return one or two sentences for people."""
        killed = "" if self.complete else ", killed before its end"
        what = f"{self.path}: {self.trial} with seed {self.seed} (made with {self.software}{killed})"
        told = f"; {', '.join(self.changed)} has other bytes than the recorded code" if self.changed else ""
        recorded, replayed = self.failures
        if recorded is not None:
            told += f"; the recorded run ended with an error: {recorded}"
        if replayed is not None and replayed != recorded:
            told += f"; the replay ended with an error: {replayed}"
        if self.equal:
            return f"{what} replays to the same bytes, digest {self.recorded}{told}"
        other = [f"{n} {v} then, {self.versions[n]} now" for n, v in self.recorded_versions.items()
                 if v != self.versions[n]]  # fmt: skip
        why = f"it was written with other versions: {'; '.join(other)}" if other else "the versions are the same"
        since = "" if self.differs is None else f" from {self.differs:g} s on"
        return f"{what} does NOT replay{since}: recorded digest {self.recorded}, replayed {self.replayed}; {why}{told}"


def replay(
    path: Path | str,
    *,
    folder: Path | None = None,
    trust: bool = False,
    progress: Callable[[float], None] | None = None,
) -> Replay:
    """Run the trial of an episode file again, with its seed, and compare the digests.

    An episode that was interrupted or ended with an error is run for as many steps as it has.

    Args:
        path: of the episode.
        folder: where files that the trial names lie (default: the folder of the episode). Code runs from there when
            it has the recorded bytes. Data are those that were recorded, which the episode holds.
        trust: whether other code may run, that which the episode holds included, and whether files may lie outside
            that folder, where they must have the recorded bytes.
        progress: called with the completed share, 0 to 1.

    Raises:
        EpisodeError: the file cannot be read, or a file of its trial is missing, other than recorded, or not trusted.
        TrialError: the trial in it cannot be read by this version.
    """
    path = Path(path)
    known, wanted = read_metadata(path), digests(path)
    complete = all(key in known for key in END_KEYS)
    if not (complete or wanted):
        raise EpisodeError(f"{path} holds no recorded instant: the run was killed before it began")
    recorded = known if complete else known | _ended(known, wanted)
    comparison = DigestComparison(EpisodeDigest(), wanted)
    with unpack_attachments(path, known, folder, trust) as place, catch_interrupt() as stop:
        course = Provenance.of(path, place.folder, trust)
        simulation = course.simulate_until(comparison, stop)
        ticks = int(recorded["steps"]) if recorded["outcome"] in ("interrupted", "error") else None
        outcome = run_to_end(simulation, [comparison], stop, progress, ticks)
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
        (recorded_failure(recorded), simulation.failure),
    )


def _ended(known: dict[str, str], wanted: dict[int, str]) -> dict[str, str]:
    """Return how a run ended that was killed: at its last recorded instant."""
    last = max(wanted)
    return {"digest": wanted[last], "outcome": "interrupted", "steps": str(last // int(known["step_ns"]))}
