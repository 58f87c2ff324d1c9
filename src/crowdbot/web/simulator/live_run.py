"""LiveRun: a trial that runs in a thread, is steered by orders, and is recorded."""

from __future__ import annotations

import contextlib
import math
import shutil
import time
from collections import deque
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

from crowdbot.core import CrowdbotError, InputError, TrialError, notify_compiling
from crowdbot.navigation import Navigator
from crowdbot.recording import Recorder, open_run, repair
from crowdbot.simulation import EpisodeStatistics, Order, OrderSource, Simulation, SimulationRun
from crowdbot.trials import Trial

from .beginning_player import BeginningPlayer
from .kernel_preparation import prepare_kernels
from .paced_loop import PacedLoop
from .recorded_beginning import RecordedBeginning
from .stage_view import StageView

Controls = dict[str, OrderSource]
SHARE = 0.02
"""Largest share of the real time for metrics that are computed while a trial runs."""
SEAMLESS = 10.0
"""Time of the recording [s] up to which the run goes on there; later, the run is shown from its start."""

PAGE = 3.0
"""Longest time [s] that the compiler waits for a page that loads the recording."""


class LiveRun:
    """A running trial: always recorded, so that it can be saved at any time, and replays to the byte.

    Orders are applied between two steps. An order to a paused run advances it by one step.

    Args:
        trial, seed: the trial and its seed.
        file: the recording; removed by :meth:`close`.
        view: sends the state to the windows.
        tell: called in the thread of the run when the status has changed.
        paused: whether the run waits at its start.
        beginning: recording of the same run, shown until it is prepared, or None.
        at: instant [s] to which the run goes as fast as possible, also if it is paused.
    """

    kind = "run"

    def __init__(
        self,
        trial: Trial,
        seed: int,
        file: Path,
        view: StageView,
        tell: Callable[[Any], None],
        paused: bool = False,
        beginning: RecordedBeginning | None = None,
        at: float = 0.0,
    ) -> None:
        self.trial, self.seed, self.file, self.view = trial, seed, file, view
        self._tell, self._at = tell, at
        self.state, self.problems = "preparing", list[str]()
        self.compiling = False
        self.values: dict[str, float | None] = {}
        self.metrics: dict[str, float] = {}
        self.controls: Controls = {}
        """Robots and avatars that the user moves, by name."""
        self.taken: dict[str, Navigator] = {}
        """Navigators of robots that the user has taken over, by name."""
        self.given = 0
        """Orders that were applied."""
        self._statistics: EpisodeStatistics | None = None
        self._metrics_due = 0.0
        self._queue: list[Order] = []
        self._chains: deque[Order] = deque()
        self._stack = contextlib.ExitStack()
        self._run: SimulationRun | None = None
        self.loop = PacedLoop(trial.step, self._advance, self._begin, self._end, paused, view.settle)
        self.beginning: BeginningPlayer | None = None
        """Shows a recording until the run is prepared."""
        if beginning is not None:
            self.beginning = BeginningPlayer(
                beginning, trial, view.session, lambda: 0.0 if self.loop.paused else self.loop.speed or 1.0
            )

    @property
    def simulation(self) -> Simulation:
        """The simulation; only for actions in the thread of the run."""
        if self._run is None:
            raise InputError(self.problems[0] if self.problems else "the simulation is not ready yet")
        return self._run.simulation

    @property
    def running(self) -> SimulationRun:
        """The run; only for actions in the thread of the run."""
        if self._run is None:
            raise InputError(self.problems[0] if self.problems else "the simulation is not ready yet")
        return self._run

    def do(self, action: Callable[[], Any]) -> Any:
        """Run an action in the thread of the run."""
        return self.loop.do(action)

    def order(self, order: Order) -> None:
        """Apply an order before the next step.

        Raises:
            InputError: the order is impossible, or the run has ended.
        """
        self.do(lambda: self._take(order))

    def order_in_turn(self, orders: Sequence[Order]) -> None:
        """Apply orders one after the other, one in each step, because each needs the one before.

        Does not wait for a run that is being prepared: it applies them when it is ready, and tells those it refuses.
        """

        def begin() -> None:
            self._check_open()
            self._chains += orders
            if self.loop.paused:
                while self._chains and not self.loop.ended.is_set():
                    self._paused_step([])

        def begin_later() -> None:
            try:
                begin()
            except InputError as error:
                if not self.problems:  # otherwise they tell why the run failed
                    self.problems = [str(error)]
                self._tell(self)

        if self.state == "preparing":
            self.loop.do_later(begin_later)
        else:
            self.do(begin)

    def save(self, path: Path) -> None:
        """Copy the recording; that of a run in progress ends before the current instant."""

        def copy() -> None:
            if self._run is not None and self._run.outcome is None:
                for sink in self._run.sinks:
                    if isinstance(sink, Recorder):
                        sink.flush()
            if not self.file.is_file():
                raise InputError("nothing is recorded yet: run the trial first")
            shutil.copyfile(self.file, path)
            repair(path)

        self.do(copy)

    def start(self) -> None:
        """Start the thread."""
        if self.beginning is not None:
            self.beginning.start()
        self.loop.start()

    def close(self, wait: float | None = None) -> None:
        """Stop the run and remove its recording."""
        self._stop_beginning()
        self.view.close()
        self.loop.close(wait)

    def status(self) -> dict[str, Any]:
        """Return the status, JSON."""
        run = self._run
        time_now = 0.0 if run is None else float(run.simulation.world.times[0])
        recorded = self.beginning is not None and self.beginning.active
        return {
            "kind": self.kind, "state": self._state_word(), "time": time_now, "duration": self.trial.duration,
            "speed": self.loop.speed, "late": self.loop.late, "factor": self.view.factor, "seed": self.seed,
            "trial": self.trial.name, "outcome": None if run is None else run.outcome, "problems": self.problems,
            "orders": self.given, "compiling": self.compiling, "recorded": recorded, "values": self.values,
            "metrics": {key: metric for key, metric in self.metrics.items() if math.isfinite(metric)},
        }  # fmt: skip

    def _state_word(self) -> str:
        if self.state == "running" and self.loop.paused:
            return "paused"
        return self.state

    def _begin(self) -> None:
        if self.beginning is not None:
            self.beginning.wait_for_page(PAGE)
        try:
            if self.beginning is not None:
                prepare_kernels(lambda: self.loop.closed, self._note_compiling)
            with notify_compiling(self._note_compiling):
                run = self._stack.enter_context(open_run(self.trial, self.seed, self.file, force=True))
                self.view.open(run.simulation)
                if not self.loop.paused:
                    self._take_first_step(run)
        except TrialError as error:
            self._fail(list(error.problems))
            return
        except (CrowdbotError, OSError) as error:
            self._fail([str(error)])
            return
        except Exception as error:  # code of the trial may raise anything
            self._fail([f"{type(error).__name__}: {error}"])
            return
        self._run = run
        self._statistics = next(sink for sink in run.sinks if isinstance(sink, EpisodeStatistics))
        self._stop_beginning()
        if run.outcome is not None:
            self.loop.ended.set()
            self._finish(run)
            return
        self.view.show(always=True)
        self._set_state("running")
        ahead = min(self._at, self.trial.duration) - float(run.simulation.world.times[0])
        self.loop.hurry(round(ahead / self.trial.step))

    def _take_first_step(self, run: SimulationRun) -> None:
        """Compile what a step and its picture need, and go on to where the recording is."""
        run.step()
        self.view.prepare()
        recorded = self.beginning
        while recorded is not None and run.outcome is None and not self.loop.closed:
            if not float(run.simulation.world.times[0]) < recorded.now <= SEAMLESS:
                break
            run.step()
            self.view.walk()

    def _stop_beginning(self) -> None:
        if self.beginning is not None:
            self.beginning.stop()

    def _note_compiling(self) -> None:
        self.compiling = True
        self._tell(self)

    def _fail(self, problems: list[str]) -> None:
        self.problems = problems
        self._stop_beginning()
        self.loop.ended.set()
        self._set_state("failed")

    def _set_state(self, state: str) -> None:
        self._measure()
        self.state = state
        self._tell(self)

    def _advance(self) -> bool:
        run = self._run
        if run is None:
            return False
        try:
            self._step(run)
            if run.outcome is not None:
                self._finish(run)
                return False
        except Exception as error:  # an extra that is missing, a full disk, a bug: the page says it
            self._fail([str(error) if isinstance(error, CrowdbotError | OSError) else repr(error)])
            return False
        self.compiling = False
        waits = self.loop.paused and not self.loop.hurries
        self.view.show(always=waits)
        if self.view.is_status_due() or waits:
            self._measure()
            self._tell(self)
        return True

    def _step(self, run: SimulationRun) -> None:
        orders, self._queue = self._queue, []
        if self._chains:
            orders.append(self._chains.popleft())
        for control in list(self.controls.values()):
            orders += control.orders(run.simulation)
        before = len(run.refusals)
        try:
            run.step(orders)
        except InputError as error:  # an order that has become impossible, such as for a robot that is gone
            self.problems = [str(error)]
            self.controls.clear()
            self._chains.clear()
            run.step()
            return
        self.given += len(orders) - (len(run.refusals) - before)

    def _finish(self, run: SimulationRun) -> None:
        if run.failure is not None:
            self.problems = [str(run.failure)]
        self.controls.clear()
        self._stack.close()
        self.view.show(always=True)
        self._set_state("ended")

    def _take(self, order: Order) -> None:
        self._check_open()
        order.check(self.simulation)
        self.problems = []
        if self.loop.paused:
            self._paused_step([order])
        else:
            self._queue.append(order)

    def _check_open(self) -> None:
        if self.running.outcome is not None:
            raise InputError(f"the run has ended ({self.running.outcome}); restart it first")

    def _paused_step(self, orders: list[Order]) -> None:
        """Advance one step with orders, so that the picture shows them."""
        self._queue += orders
        if not self._advance():
            self.loop.ended.set()

    def _measure(self) -> None:
        run, tally = self._run, self._statistics
        if run is None:
            return
        self.values = self.view.measure()
        now = time.monotonic()
        if tally is not None and tally.travels and (now >= self._metrics_due or run.outcome is not None):
            with contextlib.suppress(InputError):  # there is no record yet
                self.metrics = tally.metrics(run.outcome or "interrupted")
            cost = time.monotonic() - now
            self._metrics_due = now + max(0.5, cost / SHARE)

    def _end(self) -> None:
        self._stack.close()
        self.file.unlink(missing_ok=True)
