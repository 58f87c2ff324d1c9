"""SimulationRun: a run that is advanced step by step, steered, held, copied and taken back."""

from __future__ import annotations

import dataclasses
import threading
import weakref
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Protocol, runtime_checkable

import numpy as np

from crowdbot.core import ExternalClock, InputError, MissingExtra, PacedClock
from crowdbot.typing import Bools, Ints

from .decision_timer import decision_times
from .external_robots import open_own_sources
from .failure import RunEnd, RunFailure
from .orders.order import Order
from .simulation import Simulation
from .step_batch import StepBatch
from .step_record import StepRecord

KEYFRAMES = 5.0
"""Simulated time [s] between two keyframes: snapshots for :meth:`SimulationRun.seek`, and states in episode files."""


class Sink(Protocol):
    """A consumer of step records."""

    def take(self, frame: StepRecord) -> None:
        """Process a step record."""


@runtime_checkable
class BatchSink(Sink, Protocol):
    """A consumer of step records that can take those of many environments as arrays.

    A run with several environments whose sinks are all of this kind makes no single records.
    """

    def take_batch(self, batch: StepBatch) -> None:
        """Process the records of one step."""


class OrderSource(Protocol):
    """A program that steers a simulation: a bridge to ROS, a headset, a web page."""

    def orders(self, simulation: Simulation) -> Iterable[Order]:
        """Return the orders for this step; see :meth:`Simulation.new_readings`."""


class StopRequest:
    """A request to stop the run."""

    asked: bool = False


@dataclass(frozen=True)
class RunSnapshot:
    """The state of a run at one instant, see :meth:`SimulationRun.snapshot`."""

    simulation: Simulation
    numbers: tuple[int, ...]
    ends: tuple[RunEnd | None, ...]
    pending: Bools


class SimulationRun:
    """A run that the caller advances step by step: all environments until the end of each.

    The record of a step is written before the next step, after the orders for it; the last one immediately.

    Args:
        simulation: a new simulation, or one that another run has advanced.
        sinks: receive the step records of all environments.
        sources: programs that steer the simulation, asked in every step.
        ticks: interrupt the run after this number of steps (default: no limit).
        stop: ends the run at the next recorded step when set.
        keyframes: whether :meth:`seek` can go back; a snapshot is kept every 5 s.

    Attributes:
        ends: end of each environment, None while it runs. The outcome is ``error`` after an exception in a model,
            sensor, navigator or source.
        refusals: orders that became impossible by earlier ones of the same instant, with the reason; they are not
            recorded.

    >>> from crowdbot.models import ORCA
    >>> from crowdbot.trials import Trial
    >>> clock = ExternalClock(0.05)
    >>> running = SimulationRun(Simulation(Trial(name="empty", duration=1.0, crowd=ORCA()), 0, clock))
    >>> running.until(520_000_000)
    10
    >>> running.until(7_000_000_000), running.outcome
    (10, 'finished')
    """

    def __init__(
        self,
        simulation: Simulation,
        sinks: Sequence[Sink] = (),
        sources: Sequence[OrderSource] = (),
        ticks: int | None = None,
        stop: StopRequest | None = None,
        keyframes: bool = False,
    ) -> None:
        self.simulation, self.sinks = simulation, sinks
        own = () if sources else open_own_sources(simulation)
        self.sources: Sequence[OrderSource] = sources or own
        self._closing = [weakref.finalize(self, item.close) for item in own]
        self._ticks, self._stop = ticks, stop or StopRequest()
        self._schedule = simulation.world.clock.schedule(simulation.trial.recording.period)
        self._numbers = list(range(simulation.count))
        self.ends: list[RunEnd | None] = [None] * simulation.count
        self.refusals: list[tuple[Order, str]] = []
        self._queue: list[Order] = []
        self._orders: dict[int, list[Order]] = {}
        self._pending = np.zeros(simulation.count, dtype=np.bool_)
        self._going = threading.Event()
        self._going.set()
        self._history: list[tuple[int, Order]] = []
        self._keyframes: list[tuple[int, RunSnapshot]] | None = [] if keyframes else None
        if not simulation.begun.all():
            simulation.begin()
            self._finish_step()
        else:
            self._end_where(self._due & simulation.may_end(), np.zeros(simulation.count, dtype=np.bool_))
        self._keep_keyframe()

    def step(self, orders: Iterable[Order] = ()) -> str | None:
        """Advance one step and return the outcome of the run, None while an environment runs.

        Args:
            orders: orders for the current instant, before the step.

        Raises:
            InputError: the run has ended, or an order is impossible; then nothing has changed.
        """
        if self.outcome is not None:
            raise InputError(f"the run has ended ({self.outcome}) at {self.simulation.world.clock.time:g} s")
        self._enqueue(orders)
        self.flush()
        self.simulation.advance()
        self._finish_step()
        self._keep_keyframe()
        return self.outcome

    def advance(self, steps: int | None = None) -> str | None:
        """Advance a number of steps, or to the end, waiting while the run is held; return the outcome.

        Another thread can call :meth:`hold` and :meth:`go`. A pause does not change the result.
        """
        done = 0
        while self.outcome is None and (steps is None or done < steps):
            self._going.wait()
            self.step()
            done += 1
        return self.outcome

    def hold(self) -> None:
        """Pause :meth:`advance`, and a clock that follows real time."""
        self._going.clear()
        if isinstance(self.simulation.world.clock, PacedClock):
            self.simulation.world.clock.pause()

    def go(self) -> None:
        """Continue after :meth:`hold`."""
        if isinstance(self.simulation.world.clock, PacedClock):
            self.simulation.world.clock.resume()
        self._going.set()

    @property
    def speed(self) -> float:
        """Simulated time over real time, of a clock that follows real time.

        Raises:
            InputError: the clock does not.
        """
        return self._paced_clock().rate

    @speed.setter
    def speed(self, speed: float) -> None:
        """Set the speed."""
        self._paced_clock().rate = speed

    def _paced_clock(self) -> PacedClock:
        clock = self.simulation.world.clock
        if not isinstance(clock, PacedClock):
            raise InputError(f"a {type(clock).__name__} has no speed; run with a PacedClock")
        return clock

    def snapshot(self) -> RunSnapshot:
        """Return the current state, before the orders of this instant."""
        everything = range(self.simulation.count)
        ends = tuple(self.ends)
        return RunSnapshot(self.simulation.select(everything), tuple(self._numbers), ends, self._pending.copy())

    def restore(self, snapshot: RunSnapshot) -> None:
        """Continue from a snapshot of this run, which can be restored again.

        Raises:
            InputError: the run has sinks, which already hold a later time; branch the episode instead.
        """
        if self.sinks:
            raise InputError("a run that is recorded cannot go back; branch its episode instead")
        clock, simulation = self.simulation.world.clock, snapshot.simulation.select(range(snapshot.simulation.count))
        simulation.world.environment_time.follow(clock)
        self.simulation, self._numbers, self.ends = simulation, list(snapshot.numbers), list(snapshot.ends)
        self._pending, self._queue, self._orders = snapshot.pending.copy(), [], {}

    def seek(self, seconds: float) -> None:
        """Go to an instant [s]: forwards by steps, backwards from the latest keyframe with the same orders.

        Raises:
            InputError: the instant is earlier and the run keeps no keyframes, or has sinks.
        """
        step_ns = self.simulation.world.clock.step_ns
        target = round(seconds * 1e9) // step_ns
        if target < self.simulation.tick:
            if self._keyframes is None:
                raise InputError(
                    f"the run is at {self.simulation.tick * step_ns / 1e9:g} s; to go back it needs keyframes"
                )
            kept = [(tick, item) for tick, item in self._keyframes if tick <= target]
            self.restore(kept[-1][1])
            self._keyframes = kept
            self._repeat(target)
        while self.simulation.tick < target and self.outcome is None:
            self.step()

    def _repeat(self, target: int) -> None:
        """Step to a tick with the orders that were applied before, and forget the later ones."""
        begin, sources = self.simulation.tick, self.sources
        orders, self.sources = [row for row in self._history if begin <= row[0] <= target], ()
        self._history = [row for row in self._history if row[0] < begin]
        while self.simulation.tick < target and self.outcome is None:
            now = self.simulation.tick
            self.step([order for tick, order in orders if tick == now])
        self._enqueue(order for tick, order in orders if tick == target)
        self.sources = sources

    def _keep_keyframe(self) -> None:
        tick, frames = self.simulation.tick, self._keyframes
        apart = KEYFRAMES * 1e9 / self.simulation.world.clock.step_ns
        if frames is not None and self.outcome is None and (not frames or tick >= frames[-1][0] + apart):
            frames.append((tick, self.snapshot()))

    def close(self) -> None:
        """Write the records of the current instant; the run can continue."""
        self.flush()

    def until(self, nanoseconds: int) -> int:
        """Advance to an external time [ns] and return the number of steps.

        Raises:
            InputError: the time is earlier than the previous one.
        """
        clock = self.simulation.world.clock
        due = clock.due(nanoseconds) if isinstance(clock, ExternalClock) else nanoseconds // clock.step_ns - clock.tick
        for done in range(due):
            if self.outcome is not None:
                return done
            self.step()
        return max(0, due)

    def flush(self) -> None:
        """Apply the orders for the current instant, and write its records; no more orders are possible for it."""
        self._apply()
        self._write(np.flatnonzero(self._pending), last=False)

    @property
    def outcome(self) -> str | None:
        """The outcome of the run: that of the only environment, or ``finished`` after the last of several."""
        if any(end is None for end in self.ends):
            return None
        return self.ends[0].outcome if len(self.ends) == 1 and self.ends[0] is not None else "finished"

    @property
    def failure(self) -> RunFailure | None:
        """The exception that ended the first environment."""
        return self.simulation.failures[0]

    def drop_inactive(self) -> None:
        """Remove the environments that have ended from the simulation; records keep the numbers of the others."""
        index = [e for e, number in enumerate(self._numbers) if self.ends[number] is None]
        if index and len(index) < len(self._numbers):
            self.simulation = self.simulation.select(index)
            self._numbers, self._pending = [self._numbers[e] for e in index], self._pending[index]

    @property
    def _due(self) -> Bools:
        return self._schedule.is_due(self.simulation.ticks)

    def _finish_step(self) -> None:
        """Ask the sources (part 7), determine outcomes, and write the last records of environments that end."""
        simulation = self.simulation
        try:
            for source in self.sources:
                self._enqueue(source.orders(simulation))
        except MissingExtra:
            raise
        except Exception as error:  # sources may raise anything
            for e in range(simulation.count):
                simulation.fail(e, error)
        self._note_misses()
        due = self._due
        runs = np.array([self.ends[number] is None for number in self._numbers])
        stops = self._stops()
        ended = self._end_where((due & (stops | simulation.may_end())) | simulation.failed, stops)
        eventful = simulation.is_eventful()
        eventful[list(self._orders)] = True
        self._pending = runs & (eventful | (due & ~simulation.broken))
        if ended.any():
            self._apply()
            self._write(np.flatnonzero(ended & self._pending), last=True)
        for close in self._closing if self.outcome is not None else ():
            close()

    def _note_misses(self) -> None:
        """Keep the decisions of this step that missed their deadline or did not return for the records."""
        for control in self.simulation.robots:
            for e, order in control.timer.orders(control.robot, self.simulation.ticks, self.simulation.failures):
                self._orders.setdefault(e, []).append(order)
            if control.faults is not None:
                step = self.simulation.world.clock.dt
                for e, event in control.faults.orders(control.robot, self.simulation.ticks, step):
                    self._orders.setdefault(e, []).append(event)

    def _end_where(self, chosen: Bools, stops: Bools) -> Bools:
        """Set the ends of environments ``[E]`` that end now, and return which ones."""
        simulation = self.simulation
        ended = np.zeros(simulation.count, dtype=np.bool_)
        for e in np.flatnonzero(chosen).tolist():
            if self.ends[self._numbers[e]] is None:
                outcome = simulation.outcome(e) or ("interrupted" if stops[e] else None)
                if outcome is not None:
                    times = decision_times(simulation.robots, e)
                    end = RunEnd(outcome, int(simulation.ticks[e]), simulation.failures[e], times)
                    self.ends[self._numbers[e]] = end
                    ended[e] = True
        return ended

    def _stops(self) -> Bools:
        ticks = self.simulation.ticks
        limit = np.zeros(len(ticks), dtype=np.bool_) if self._ticks is None else ticks >= self._ticks
        return np.asarray(limit | self._stop.asked)

    def _enqueue(self, orders: Iterable[Order]) -> None:
        """Check orders for the current instant and keep them until its end."""
        found = list(orders)
        for order in found:
            order.check(self.simulation)
            if self.ends[self._numbers[order.environment]] is not None:
                raise InputError(f"{type(order).__name__}: environment {order.environment} has ended")
        self._queue += found

    def _apply(self) -> None:
        """Apply the orders of the current instant, by environment and source, and keep them for the records."""
        for order in sorted(self._queue, key=lambda one: (one.environment, one.source)):
            try:
                order.apply(self.simulation)
            except InputError as error:  # an earlier order of this instant has made it impossible
                self.refusals.append((order, str(error)))
                continue
            # a record belongs to one environment, whose run alone has number 0
            self._orders.setdefault(order.environment, []).append(dataclasses.replace(order, environment=0))
            if self._keyframes is not None:
                self._history.append((self.simulation.tick, order))
            self._pending[order.environment] = True
        self._queue = []

    def _write(self, index: Ints, last: bool) -> None:
        """Write the records of some environments."""
        self._pending[index] = False
        if not len(index):
            return
        due = self._schedule.is_due(self.simulation.ticks[index])
        numbers = [self._numbers[e] for e in index.tolist()]
        orders = {e: tuple(self._orders.pop(e)) for e in index.tolist() if e in self._orders}
        sinks = [sink for sink in self.sinks if isinstance(sink, BatchSink)]
        if self.simulation.count > 1 and len(sinks) == len(self.sinks) > 0:
            batch = StepBatch.of(self.simulation, index, np.array(numbers), due, last, orders)
            for sink in sinks:
                sink.take_batch(batch)
            return
        for k, e in enumerate(index.tolist()):
            frame = self.simulation.record(e, bool(due[k]), last, orders.get(e, ()), numbers[k])
            for item in self.sinks:
                item.take(frame)
