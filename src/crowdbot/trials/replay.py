"""Replay: run a recorded episode again and compare."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from .episode import Log
from .episode_file import versions
from .recorded import read_episode
from .run import drive, stopping
from .simulation import Simulation
from .trial import Trial

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
    """

    path: Path
    trial: str
    seed: int
    recorded: str
    replayed: str
    outcomes: tuple[str, str]
    recorded_versions: dict[str, str]
    versions: dict[str, str]

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
            "outcome": self.outcomes[0],
            "replayed_outcome": self.outcomes[1],
            "recorded_versions": self.recorded_versions,
            "versions": self.versions,
        }

    def __str__(self) -> str:
        """Return one or two sentences for people."""
        what = f"{self.path}: {self.trial} with seed {self.seed}"
        if self.equal:
            return f"{what} replays to the same bytes, digest {self.recorded}"
        other = [f"{n} {v} then, {self.versions[n]} now" for n, v in self.recorded_versions.items()
                 if v != self.versions[n]]  # fmt: skip
        why = f"it was written with other versions: {'; '.join(other)}" if other else "the versions are the same"
        return f"{what} does NOT replay: recorded digest {self.recorded}, replayed {self.replayed}; {why}"


def replay(
    path: Path | str,
    *,
    folder: Path | None = None,
    trust: bool = False,
    progress: Callable[[float], None] | None = None,
) -> Replay:
    """Run the trial of an episode file again, with its seed, and compare the digests.

    An interrupted episode is run for as many steps as it has.

    Args:
        path: of the episode.
        folder: where code that the trial names lies (default: the folder of the episode).
        trust: whether code from outside that folder may be loaded.
        progress: called with the share that is done, 0 to 1.

    Raises:
        EpisodeError: the file cannot be read.
        TrialError: the trial in it cannot be read by this version.
    """
    path = Path(path)
    recorded = read_episode(path)
    place = f"{path} (trial, written by crowdbot {recorded.version})"
    trial = Trial.parse(recorded.xml, place=place, folder=folder or path.parent, trust=trust)
    simulation = Simulation(trial, recorded.seed)
    log = Log(trial, recorded.seed)
    with stopping() as stop:
        ticks = recorded.steps if recorded.outcome == "interrupted" else None
        outcome = drive(simulation, [log], stop, progress, ticks)
        if stop.asked and simulation.tick != ticks:
            raise KeyboardInterrupt
    now = versions()
    return Replay(
        path,
        recorded.name,
        recorded.seed,
        recorded.digest,
        log.digest.ended(outcome),
        (recorded.outcome, outcome),
        {name: recorded.metadata.get(name, "unknown") for name in now},
        now,
    )
