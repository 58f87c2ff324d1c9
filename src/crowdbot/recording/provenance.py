"""Provenance: trials, seeds and branch times of an episode, from which it can be simulated again."""

from __future__ import annotations

import itertools
import json
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from crowdbot.core import EpisodeError, InputError
from crowdbot.data import McapReader
from crowdbot.simulation import (
    DecisionOrder,
    EpisodeDigest,
    Order,
    RecordedDecisions,
    Simulation,
    SimulationRun,
    StepRecord,
    StopRequest,
    TrialOrder,
    apply_overrides,
    read_order,
    write_order,
)
from crowdbot.trials import Trial, parse_trial, trial_xml

from .episode_reader import read_metadata
from .metadata import DIGEST, ORDERS


@dataclass(frozen=True)
class ProvenanceSegment:
    """A trial and a seed that apply from a tick on, and the orders from outside since then.

    Fields:
        tick: first tick.
        trial, seed: the trial and its seed.
        orders: tick and order, in the order of their application.
    """

    tick: int
    trial: Trial
    seed: int
    orders: tuple[tuple[int, Order], ...] = ()


class OrderReplay:
    """Repeats recorded orders, as an :class:`crowdbot.simulation.OrderSource`."""

    def __init__(self, orders: Iterable[tuple[int, Order]]) -> None:
        self._by_tick: dict[int, list[Order]] = {}
        for tick, order in orders:
            if not isinstance(order, DecisionOrder):
                self._by_tick.setdefault(tick, []).append(order)

    def orders(self, simulation: Simulation) -> list[Order]:
        """Return the orders of the current step."""
        return self._by_tick.get(simulation.tick, [])


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


def replay_decisions(simulation: Simulation, orders: Iterable[tuple[int, Order]] | None) -> None:
    """Let decisions miss their deadline and hang as recorded, instead of measuring time; None measures again."""
    rows = None if orders is None else list(orders)
    for control in simulation.robots:
        recorded = None if rows is None else RecordedDecisions.of(rows, control.robot.name)
        for e in range(simulation.count):
            control.timer.replay(e, recorded)


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
            return parse_trial(xml, place=place, folder=folder or path.parent, trust=trust)

        try:
            origin = json.loads(known.get("origin", "[]"))
            rows = [
                (int(item["tick"]), str(item["trial"]), int(item["seed"]), _orders(item.get("orders", ())))
                for item in origin
            ]
            rows.append(
                (int(known.get("begin", "0")), known["trial"], int(known["seed"]), recorded_orders(path, known))
            )
        except (ValueError, TypeError, KeyError, InputError) as error:
            raise EpisodeError(f"{path} has an invalid record of its origin: {error}") from None
        return cls(tuple(ProvenanceSegment(tick, parsed(xml), seed, orders) for tick, xml, seed, orders in rows))

    @property
    def origin(self) -> list[dict[str, Any]]:
        """Metadata of the segments before the last."""
        result = []
        for part, following in itertools.pairwise(self.parts):
            row: dict[str, Any] = {"tick": part.tick, "trial": trial_xml(part.trial), "seed": part.seed}
            orders = [[tick, write_order(order)] for tick, order in part.orders if tick <= following.tick]
            result.append(row | ({"orders": orders} if orders else {}))
        return result

    def changes_until(self, tick: int) -> int:
        """Return the number of orders up to a tick that change the trial."""
        return sum(isinstance(order, TrialOrder) and at <= tick for part in self.parts for at, order in part.orders)

    def begin_at(self, tick: int) -> Simulation:
        """Return a new simulation with the changes of the trial up to a tick, to continue from a stored state."""
        first = self.parts[0]
        simulation, seed = Simulation(first.trial, first.seed), first.seed
        for part in self.parts:
            apply_overrides(simulation, part.trial, None if part.seed == seed else part.seed)
            seed = part.seed
            for at, order in part.orders:
                if isinstance(order, TrialOrder) and at <= tick:
                    order.apply(simulation)
        return simulation

    def simulate_until(
        self,
        sink: DigestComparison,
        stop: StopRequest,
        progress: Callable[[float], None] | None = None,
        until: int | None = None,
        start: Simulation | None = None,
    ) -> Simulation:
        """Simulate all segments before the last, without recording, and return the simulation at its start.

        Args:
            sink: receives the step records.
            stop: interrupts the run when set.
            progress: called with the completed fraction, 0 to 1.
            until: continue with the last segment up to this tick.
            start: a simulation in the last segment, from a keyframe; None: from the beginning.

        Raises:
            EpisodeError: the run ends earlier.
        """
        first = self.parts[0]
        if start is not None:
            replay_decisions(start, [row for part in self.parts for row in part.orders])
            if until is not None:
                _on(start, until, sink, stop, progress, OrderReplay(self.parts[-1].orders))
            return start
        simulation = Simulation(first.trial, first.seed)
        replay_decisions(simulation, [row for part in self.parts for row in part.orders])
        ends = [part.tick for part in self.parts[1:]] + ([] if until is None else [until])
        for number, end in enumerate(ends):
            _on(simulation, end, sink, stop, progress, OrderReplay(self.parts[number].orders))
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
    orders: OrderReplay,
) -> None:
    """Continue to a tick."""
    running = SimulationRun(simulation, [sink], [orders])
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
    running.flush()


def digests(path: Path) -> dict[int, str]:
    """Return the recorded digests by time [ns].

    Raises:
        EpisodeError: the file cannot be read.
    """
    return dict(_texts(path, DIGEST))


def recorded_orders(path: Path, known: Mapping[str, str]) -> tuple[tuple[int, Order], ...]:
    """Return the orders in an episode file with their ticks, in the order of their application.

    Raises:
        EpisodeError: the file cannot be read.
        InputError: a message is not an order.
    """
    found = list(_texts(path, ORDERS))
    return tuple((stamp // int(known["step_ns"]), read_order(text)) for stamp, text in found)


def _orders(rows: Iterable[Any]) -> tuple[tuple[int, Order], ...]:
    return tuple((int(tick), read_order(str(text))) for tick, text in rows)


def _texts(path: Path, topic: str) -> Iterable[tuple[int, str]]:
    """Return time [ns] and content of the text messages of a topic."""
    from crowdbot.messages import Messages

    messages, found = Messages(), []
    try:
        with path.open("rb") as stream:
            for heard in McapReader(stream).messages(lambda channel: channel.topic != topic):
                if heard.topic.topic == topic:
                    found.append((heard.stamp, str(messages.decode_message(heard.data, heard.topic.kind).data)))
    except Exception as error:  # damaged files cause many kinds of exceptions
        raise EpisodeError(f"{path} is damaged: {type(error).__name__}: {str(error)[:80] or 'no details'}") from error
    return found
