"""Measurement and report of ``crowdbot bench environments``."""

from __future__ import annotations

import os
from collections.abc import Callable
from dataclasses import asdict, dataclass
from importlib.metadata import version
from typing import Any

from crowdbot.benchmark.speed.timing import environment
from crowdbot.core import MissingExtra
from crowdbot.trials import Trial, load_trial

from .builtin_rates import trial_rates
from .calls import call_rows
from .crossing import BEAMS, CrossingTask, advance_work, crossing_trial, episode_work, reset_work
from .ir_sim_peer import IrSimPeer
from .navground_peer import NavgroundPeer
from .rows import CallRow, EnvironmentRow, PeerRate, TrialRate
from .sizes import BenchmarkSizes
from .work_rate import TimedWork, rates

PEERS: tuple[type[NavgroundPeer] | type[IrSimPeer], ...] = (NavgroundPeer, IrSimPeer)
"""The other simulators."""

PROTOCOL = (
    "Each rate is the median of alternating repetitions in one process after a warm-up; CPU seconds are those of all"
    " threads. All simulators start from the same positions and goals, with the same radius, speed and time step."
    " Rates of steps count steps of environments."
)
ADVANCE = (
    "Simulation.advance: people, robot, contacts, arrivals and end conditions; the robot {sees} and its ORCA navigator"
    " decides in every step of 0.05 s; no resets, no records; {steps} steps from the start, E = {environments}"
)
TRACKER = "has a perfect tracker without a scanner"
SCANNER = f"scans with {BEAMS} beams, 20 Hz,"
CALLS = "Calls per step of Simulation.advance, counted with sys.setprofile; 10 people, perfect tracker"
TRIALS = "Simulation.advance with sensors and navigators as in the trial, after two steps; no resets, no records"


@dataclass(frozen=True)
class EnvironmentReport:
    """Result of the benchmark of environments.

    Fields:
        machine: processor, system and versions.
        load: load averages over one minute before and after, None where the system has none.
        sizes: numbers of environments, steps and repetitions.
        versions: versions of the peers by package.
        missing: for each peer that is not installed, how to install it.
        rows: rates with those of the peers.
        calls: Python calls per step.
        trials: speed of the built-in planar trials.
    """

    machine: str
    load: tuple[float | None, float | None]
    sizes: BenchmarkSizes
    versions: dict[str, str]
    missing: dict[str, str]
    rows: tuple[EnvironmentRow, ...]
    calls: tuple[CallRow, ...]
    trials: tuple[TrialRate, ...]

    def as_dict(self) -> dict[str, Any]:
        """Return the report as ``crowdbot bench environments --json`` prints it."""
        return {
            "protocol": PROTOCOL,
            "machine": self.machine,
            "load": self.load,
            "sizes": asdict(self.sizes),
            "versions": self.versions,
            "missing": self.missing,
            "rows": [row.as_dict() for row in self.rows],
            "calls": {"protocol": CALLS, "rows": [asdict(row) for row in self.calls]},
            "trials": {"protocol": TRIALS, "rows": [asdict(row) for row in self.trials]},
        }


class _Measurer:
    """Measures rows with the installed peers."""

    def __init__(self, sizes: BenchmarkSizes) -> None:
        self.sizes = sizes
        self.peers: list[NavgroundPeer | IrSimPeer] = []
        self.missing: dict[str, str] = {}
        for kind in PEERS:
            try:
                self.peers.append(kind())
            except MissingExtra as error:
                self.missing[kind.name] = str(error)

    def advance(self, name: str, people: int, beams: int, environments: int) -> EnvironmentRow:
        """Measure the steps of the crossing."""
        sizes, trial = self.sizes, crossing_trial(people, beams)
        steps = sizes.single_steps if environments == 1 else sizes.steps * (2 if people > 10 else 1)
        worlds = 1 if environments == 1 else min(sizes.peer_worlds, environments)
        task = CrossingTask.of(trial, worlds)
        works = {peer.name: peer.advance_work(task, worlds, steps) for peer in self.peers}
        words = ADVANCE.format(sees=SCANNER if beams else TRACKER, steps=steps, environments=environments)
        ours = advance_work(trial, environments, steps)
        return self._row(name, words, "steps/s", trial, environments, ours, works)

    def reset(self, name: str, together: int) -> EnvironmentRow:
        """Measure restarts, ``together`` in each call."""
        sizes, trial = self.sizes, crossing_trial(10, 0)
        task = CrossingTask.of(trial, 1)
        works = {peer.name: peer.reset_work(task, min(32, sizes.peer_worlds)) for peer in self.peers}
        words = (
            f"Simulation.restart of {together} of {sizes.environments} environments in each call, with new seeds and"
            " the first readings and decisions; peers: a new world (navground), a reset to the same start (ir-sim)"
        )
        return self._row(
            name, words, "resets/s", trial, sizes.environments, reset_work(trial, sizes.environments, together), works
        )

    def episodes(self, name: str) -> EnvironmentRow:
        """Measure episodes of the built-in trial from their start to their end."""
        sizes, trial = self.sizes, load_trial("circle-crossing")
        task = CrossingTask.of(trial, min(sizes.episodes, sizes.environments))
        works = {}
        for peer in self.peers:
            count = sizes.slow_episodes if isinstance(peer, IrSimPeer) else sizes.episodes
            works[peer.name] = peer.episode_work(task, count)
        words = (
            f"simulate_seeds of {sizes.episodes} episodes of circle-crossing (5 people, 360 beams at 10 Hz) in blocks"
            f" of {sizes.block}, from the check of the trial to the end: resets, contacts, records in memory, digests;"
            f" peers without records, ir-sim with {sizes.slow_episodes} episodes and a scan in every step"
        )
        ours = episode_work(trial, sizes.episodes, sizes.block)
        return self._row(name, words, "episodes/s", trial, sizes.block, ours, works, once=True)

    def _row(
        self, name: str, words: str, unit: str, trial: Trial, environments: int, ours: TimedWork,
        works: dict[str, TimedWork], once: bool = False,
    ) -> EnvironmentRow:  # fmt: skip
        found = rates({"crowdbot": ours} | works, 1 if once else self.sizes.repeats, warm_up=not once)
        mine = found.pop("crowdbot")
        peers = tuple(
            PeerRate(
                peer.name,
                peer.differences,
                found[peer.name],
                mine.per_cpu_second / found[peer.name].per_cpu_second,
                mine.per_second / found[peer.name].per_second,
            )
            for peer in self.peers
        )
        return EnvironmentRow(name, words, unit, trial.people, environments, mine, peers)


def measure_environments(
    sizes: BenchmarkSizes | None = None, progress: Callable[[str, float], None] | None = None
) -> EnvironmentReport:
    """Measure simulations of one and many environments, together with the installed peers.

    Args:
        sizes: numbers of environments, steps and repetitions.
        progress: called with the name of the current task and its completed share, 0 to 1.
    """
    chosen = sizes or BenchmarkSizes()
    report = progress or (lambda what, share: None)
    before, measurer, many = _load(), _Measurer(chosen), chosen.environments
    tasks: dict[str, Callable[[str], EnvironmentRow]] = {
        "steps-10": lambda name: measurer.advance(name, 10, 0, many),
        "steps-10-scan": lambda name: measurer.advance(name, 10, BEAMS, many),
        "steps-50": lambda name: measurer.advance(name, 50, 0, many),
        "steps-10-single": lambda name: measurer.advance(name, 10, 0, 1),
        "steps-10-scan-single": lambda name: measurer.advance(name, 10, BEAMS, 1),
        "reset-single": lambda name: measurer.reset(name, 1),
        "reset-batch": lambda name: measurer.reset(name, many),
        "episodes": measurer.episodes,
    }
    rows = []
    for name, measure in tasks.items():
        report(name, 0.0)
        rows.append(measure(name))
        report(name, 1.0)
    report("calls", 0.0)
    calls = call_rows(crossing_trial(10, 0), many, min(20, chosen.steps))
    report("calls", 1.0)
    trials = trial_rates(chosen, report)
    versions = {package: version(package) for peer in measurer.peers for package in peer.packages}
    return EnvironmentReport(
        environment(), (before, _load()), chosen, versions, measurer.missing, tuple(rows), tuple(calls), tuple(trials)
    )


def _load() -> float | None:
    return os.getloadavg()[0] if hasattr(os, "getloadavg") else None
