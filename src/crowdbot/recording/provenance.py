"""Provenance: trials, seeds and branch times of an episode, from which it can be simulated again."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from crowdbot.core import EpisodeError
from crowdbot.data import McapReader
from crowdbot.simulation import EpisodeDigest, Simulation, SimulationRun, StepRecord, StopRequest, apply_overrides
from crowdbot.trials import Trial, parse_trial, trial_xml

from .episode_reader import read_metadata
from .metadata import DIGEST

__all__ = ["DigestComparison", "Provenance", "ProvenanceSegment", "digests"]


@dataclass(frozen=True)
class ProvenanceSegment:
    """A trial and a seed that apply from a tick on."""

    tick: int
    trial: Trial
    seed: int


class DigestComparison:
    """Compares the digest at each recorded step with the recorded digest.

    Attributes:
        differs: time [s] of the first step that differs, or None.
    """

    def __init__(self, digest: EpisodeDigest, wanted: dict[int, str]) -> None:
        self.digest, self.wanted = digest, wanted
        self.differs: float | None = None
        self.latest: StepRecord | None = None

    def take(self, frame: StepRecord) -> None:
        """Compare a step."""
        self.digest.take(frame)
        if frame.due:
            self.latest = frame
            wanted = self.wanted.get(frame.nanoseconds, "")
            if self.differs is None and wanted and wanted != self.digest.hexdigest("interrupted"):
                self.differs = frame.nanoseconds / 1e9


@dataclass(frozen=True)
class Provenance:
    """Segments of an episode, the first from tick 0. The recording starts with the last segment."""

    parts: tuple[ProvenanceSegment, ...]

    @classmethod
    def of(cls, path: Path, folder: Path | None = None, trust: bool = False) -> Provenance:
        """Read the provenance of a recorded episode.

        Raises:
            EpisodeError: the file cannot be read.
            TrialError: this version cannot read a trial in it.
        """
        known = read_metadata(path)
        place = f"{path} (trial, written by crowdbot {known['version']})"

        def parsed(xml: str) -> Trial:
            return parse_trial(xml, place=place, folder=folder or path.parent, trust=trust, quiet=True)

        try:
            origin = json.loads(known.get("origin", "[]"))
            rows = [(int(one["tick"]), str(one["trial"]), int(one["seed"])) for one in origin]
            rows.append((int(known.get("begin", "0")), known["trial"], int(known["seed"])))
        except (ValueError, TypeError, KeyError) as error:
            raise EpisodeError(f"{path} has an invalid record of its origin: {error}") from None
        return cls(tuple(ProvenanceSegment(tick, parsed(xml), seed) for tick, xml, seed in rows))

    @property
    def origin(self) -> list[dict[str, Any]]:
        """Metadata of the segments before the last."""
        return [{"tick": part.tick, "trial": trial_xml(part.trial), "seed": part.seed} for part in self.parts[:-1]]

    def simulate_until(
        self,
        sink: DigestComparison,
        stop: StopRequest,
        progress: Callable[[float], None] | None = None,
        until: int | None = None,
    ) -> Simulation:
        """Simulate all segments before the last, without recording, and return the simulation at its start.

        Args:
            sink: receives the step records.
            stop: interrupts the run when set.
            progress: called with the completed fraction, 0 to 1.
            until: continue with the last segment up to this tick.

        Raises:
            EpisodeError: the run ends earlier.
        """
        first = self.parts[0]
        simulation = Simulation(first.trial, first.seed)
        ends = [part.tick for part in self.parts[1:]] + ([] if until is None else [until])
        for number, end in enumerate(ends):
            _on(simulation, end, sink, stop, progress)
            if number + 1 < len(self.parts):
                part = self.parts[number + 1]
                apply_overrides(simulation, part.trial, None if part.seed == self.parts[number].seed else part.seed)
        return simulation


def _on(
    simulation: Simulation,
    end: int,
    sink: DigestComparison,
    stop: StopRequest,
    progress: Callable[[float], None] | None,
) -> None:
    """Continue to a tick."""
    running = SimulationRun(simulation, [sink])
    told = -1
    while simulation.tick < end:
        if running.outcome is not None:
            raise EpisodeError(
                f"the episode ends at {simulation.world.clock.time:g} s ({running.failure or running.outcome}), before"
                f" {end * simulation.world.clock.step_ns / 1e9:g} s"
            )
        running.step()
        if stop.asked:
            raise KeyboardInterrupt
        if progress is not None and (share := simulation.tick * 100 // end) > told:
            told = share
            progress(simulation.tick / end)


def digests(path: Path) -> dict[int, str]:
    """Return the recorded digests by time [ns]; empty for files of format 1.

    Raises:
        EpisodeError: the file cannot be read.
    """
    from crowdbot.messages import Messages

    messages, found = Messages(), {}
    try:
        with path.open("rb") as stream:
            for heard in McapReader(stream).messages():
                if heard.topic.topic == DIGEST:
                    found[heard.stamp] = str(messages.decode_message(heard.data, heard.topic.kind).data)
    except Exception as error:  # damaged files cause many kinds of exceptions
        raise EpisodeError(f"{path} is damaged: {type(error).__name__}: {str(error)[:80] or 'no details'}") from error
    return found
