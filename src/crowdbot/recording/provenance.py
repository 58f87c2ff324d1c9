"""Provenance: trials, seeds and branch times from which an episode can be simulated again."""

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
    """A trial and a seed that count from a tick on."""

    tick: int
    trial: Trial
    seed: int


class DigestComparison:
    """Compares the digest at every recorded instant with what was recorded.

    Attributes:
        differs: the first instant [s] at which they are not the same, None when there is none yet.
    """

    def __init__(self, digest: EpisodeDigest, wanted: dict[int, str]) -> None:
        self.digest, self.wanted = digest, wanted
        self.differs: float | None = None
        self.latest: StepRecord | None = None

    def take(self, frame: StepRecord) -> None:
        """Compare an instant."""
        self.digest.take(frame)
        if frame.due:
            self.latest = frame
            wanted = self.wanted.get(frame.nanoseconds, "")
            if self.differs is None and wanted and wanted != self.digest.hexdigest("interrupted"):
                self.differs = frame.nanoseconds / 1e9


@dataclass(frozen=True)
class Provenance:
    """The parts of an episode, the first from tick 0; it was recorded from the beginning of the last."""

    parts: tuple[ProvenanceSegment, ...]

    @classmethod
    def of(cls, path: Path, folder: Path | None = None, trust: bool = False) -> Provenance:
        """Read how a recorded episode came about.

        Raises:
            EpisodeError: the file cannot be read.
            TrialError: a trial in it cannot be read by this version.
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
            raise EpisodeError(f"{path} does not say what it branched from: {error}") from None
        return cls(tuple(ProvenanceSegment(tick, parsed(xml), seed) for tick, xml, seed in rows))

    @property
    def origin(self) -> list[dict[str, Any]]:
        """What the metadata of an episode keep of the parts before the last."""
        return [{"tick": part.tick, "trial": trial_xml(part.trial), "seed": part.seed} for part in self.parts[:-1]]

    def simulate_until(
        self,
        sink: DigestComparison,
        stop: StopRequest,
        progress: Callable[[float], None] | None = None,
        until: int | None = None,
    ) -> Simulation:
        """Run everything before the last part, without recording, and return the simulation as the last part begins.

        Args:
            sink: receives the step records.
            stop: interrupts the run when set.
            progress: called with the completed share, 0 to 1.
            until: continue with the last part up to this tick.

        Raises:
            EpisodeError: the run ends before.
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
    """Go on to a tick."""
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
    """Return the recorded digest at every recorded instant [ns]; none in files of format 1.

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
    except Exception as error:  # damaged bytes make their readers fail in many ways; all mean the same to the user
        raise EpisodeError(f"{path} is damaged: {type(error).__name__}: {str(error)[:80] or 'no details'}") from error
    return found
