"""Runs of a trial that other programs steer over a robot port."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Sequence
from pathlib import Path

from crowdbot.core import InputError
from crowdbot.recording import Recorder, episode_path
from crowdbot.simulation import (
    EpisodeDigest,
    EpisodeStatistics,
    OrderSource,
    RunSummary,
    Simulation,
    SimulationRun,
    Sink,
    StopRequest,
    catch_interrupt,
    warn_of_failure,
)
from crowdbot.trials import Trial, check_trial

from .port import BridgePort, steered_trial
from .run_control import BridgeClock, InstantRepeat, Pace, RunControl
from .simulation_interfaces import STATE_PAUSED, STATE_PLAYING
from .transport import RemarkSource, Transport

IDLE = 0.02
"""Longest real time [s] between two looks at the transports."""


def run_bridge(
    trial: Trial,
    transports: Sequence[Transport],
    seed: int | None = None,
    out: Path | str | None = None,
    clock: BridgeClock | None = None,
    force: bool = False,
    note: Callable[[str], None] | None = None,
    sources: Sequence[OrderSource] = (),
) -> RunSummary:
    """Run a trial whose robots other programs drive, see :class:`BridgeRun`.

    Args:
        trial: the trial. Robots with the navigator ``external`` are driven; without one, all robots are.
        transports: connections to other programs.
        seed: random seed (default: the seed of the trial).
        out: file to record to, or a folder for ``episode.mcap``; a reset writes ``episode-2.mcap``, and so on.
        clock: when steps are taken (default: in real time).
        force: whether existing files may be overwritten.
        note: receives remarks for people.
        sources: other programs that steer the simulation, such as motion capture.

    Returns:
        The summary of the last run.

    >>> from crowdbot.trials import load_trial
    >>> run_bridge(load_trial("frontal", duration=1.0), [], clock=BridgeClock("free")).steps
    20
    """
    return BridgeRun(trial, transports, seed, out, clock or BridgeClock(), force, note, sources).run()


class BridgeRun:
    """Runs a trial step by step with a robot port.

    Before each step, the loop waits as the clock says, and meanwhile answers calls. Then it takes the commands and
    orders that have arrived, applies them to the current instant, advances one step and sends its messages. So a
    command that answers the messages of an instant is applied at this instant. The episode contains the orders; a
    replay gives the same bytes.

    Arguments as in :func:`run_bridge`; ``port`` replaces that of the trial and the transports.
    """

    def __init__(
        self,
        trial: Trial,
        transports: Sequence[Transport],
        seed: int | None,
        out: Path | str | None,
        clock: BridgeClock,
        force: bool = False,
        note: Callable[[str], None] | None = None,
        sources: Sequence[OrderSource] = (),
        port: BridgePort | None = None,
    ) -> None:
        self.sources = sources
        self.trial, self.seed, self.clock, self.force = steered_trial(trial), seed, clock, force
        self.out = None if out is None else episode_path(out)
        if port is None:
            control = RunControl(state=STATE_PAUSED if clock.mode == "step" else STATE_PLAYING)
            port = BridgePort(self.trial, transports, control, follows_clock=clock.mode == "follow")
        self.port, self.control = port, port.control
        self.note = note or (lambda text: None)
        self.stop = StopRequest()
        self.pace = Pace(trial.step, clock.rate)
        self.port.inbox.asked_pace.rate = clock.rate if clock.mode == "paced" and not sources else None
        self.port.inbox.in_step = clock.mode == "commands"
        self.repeat = InstantRepeat()
        self._robots: set[str] = set()
        self._back = -1

    def run(self) -> RunSummary:
        """Run until the trial ends, Ctrl-C, or another program quits; a reset or another world begins a new episode."""
        number = 1
        with contextlib.ExitStack() as stack:
            self.stop = stack.enter_context(catch_interrupt())
            stack.callback(self.port.stop)
            stack.callback(self._finish_control)
            self.port.start()
            if self.port.transports:
                names = ", ".join(transport.name for transport in self.port.transports)
                self.note(f"trial {self.trial.name} is open to {names}; Ctrl-C ends the run")
            while True:
                summary = self._run_once(number)
                following = self.control.restart
                if following is None or self.stop.asked:
                    break
                number += 1
                self.trial = steered_trial(following)
        latency = self.port.inbox.latency.summary()
        if latency.commands:
            self.note(
                f"{self.port.inbox.count.received} messages received; {latency.commands} commands answered a step after"
                f" {1e3 * latency.median:.1f} ms (median), {1e3 * latency.p99:.1f} ms (99 %)"
            )
        for transport in self.port.transports:
            if isinstance(transport, RemarkSource) and (text := transport.remark()):
                self.note(text)
        return summary

    def _run_once(self, number: int) -> RunSummary:
        chosen = self.trial.seed if self.seed is None else int(self.seed)
        try:
            check_trial(self.trial, chosen)
        except InputError as error:
            self.control.finish_restart(str(error))
            raise
        out = self._file(number)
        tally = EpisodeStatistics(self.trial, chosen, None if out is None else EpisodeDigest({}))
        simulation = Simulation(self.trial, chosen)
        self.control.begun = self.trial
        if number > 1:
            self.port.change_trial(self.trial)
        sinks: list[Sink] = [tally]
        with contextlib.ExitStack() as stack:
            recorder = None
            if out is not None:
                recorder = stack.enter_context(Recorder(out, tally, force=self.force, simulation=simulation))
                sinks.append(recorder)
            running = SimulationRun(simulation, [*sinks, self.port], self.sources, stop=self.stop)
            outcome = self._drive(running)
            if recorder is not None:
                recorder.complete(outcome, running.simulation.tick, running.failure)
        warn_of_failure(running.simulation)
        return tally.summary(outcome, running.simulation.tick, out, running.failure)

    def _drive(self, running: SimulationRun) -> str:
        """Run to the end and return the outcome."""
        port, control = self.port, self.control
        self.pace.restart()
        self._note_instant(running.simulation, unasked=True)
        port.begin(running.simulation)
        control.finish_restart()
        while running.outcome is None:
            port.serve(running.simulation)
            if control.leaves:
                break
            if not self._is_due(running.simulation):
                continue
            running.step(port.take_orders(running.simulation))
            for order, reason in running.refusals:
                port.report("error", f"{type(order).__name__}: {reason}")
            running.refusals.clear()
            self._note_instant(running.simulation)
            port.publish(running.simulation)
            control.note_step()
            if self.clock.mode == "paced" and (remark := self.pace.note_step()):
                port.report("warning", remark)
                self.note(remark)
        control.finish_steps(False)
        running.close()
        return running.outcome or "interrupted"

    def _is_due(self, simulation: Simulation) -> bool:
        """Return whether the next step may be taken, after waiting a moment if not."""
        if self.stop.asked:
            return True
        if not self.control.may_step:
            self.pace.restart()
            self.port.inbox.wait(IDLE)
            return False
        wait = self._wait_time(simulation)
        if wait > 0.0:
            self.port.inbox.wait(min(wait, IDLE))
        return wait <= 0.0

    def _wait_time(self, simulation: Simulation) -> float:
        mode, inbox = self.clock.mode, self.port.inbox
        if self.control.steps or mode in ("free", "step"):
            return 0.0
        if mode == "paced":
            return self._wait_for_pace(simulation)
        if mode == "follow":
            return self._wait_for_time(simulation)
        if self._robots - inbox.commanded:
            if self.repeat.must_send(self.port.is_heard):
                self.port.publish(simulation)
            return IDLE
        if self._robots <= inbox.stamped:  # they say which instant they answer
            return 0.0
        return 0.0 if self.repeat.is_settled(inbox.count.velocities) else IDLE

    def _note_instant(self, simulation: Simulation, unasked: bool = False) -> None:
        """Note that the messages of an instant are sent now, for the mode ``commands``."""
        if self.clock.mode == "commands":
            self._robots = {robot.robot.name for robot in simulation.robots if robot.robot.mirror is None}
            count = self.port.inbox.count.velocities
            self.repeat.begin(self.port.is_heard, count, len(self._robots), unasked)

    def _wait_for_pace(self, simulation: Simulation) -> float:
        asked = self.port.inbox.asked_pace
        if simulation.world.clock.nanoseconds < asked.until:
            self.pace.restart()
            return 0.0
        if asked.rate is not None and asked.rate != self.pace.rate:
            self.pace.rate = asked.rate
            self.pace.restart()
        return self.pace.wait_time()

    def _wait_for_time(self, simulation: Simulation) -> float:
        clock, now = simulation.world.clock, self.port.inbox.external_time
        if now is None:
            return IDLE
        if now < clock.nanoseconds and now != self._back:
            self._back = now
            self.port.report("error", f"the time on /clock went back to {now / 1e9:g} s from {clock.time:g} s")
        return 0.0 if now >= clock.nanoseconds + clock.step_ns else IDLE

    def _finish_control(self) -> None:
        """Answer who waits for steps or another beginning, at the end; the port answers all others."""
        self.control.finish_steps(False)
        self.control.finish_restart("the run has ended")

    def _file(self, number: int) -> Path | None:
        if self.out is None or number == 1:
            return self.out
        return self.out.with_name(f"{self.out.stem}-{number}{self.out.suffix}")
