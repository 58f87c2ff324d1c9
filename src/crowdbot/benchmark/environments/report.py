"""Measurement and report of ``crowdbot bench environments``."""

from __future__ import annotations

import itertools
import sys
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from importlib.metadata import version
from types import FrameType
from typing import Any

from crowdbot.benchmark.speed.timing import environment, load_average
from crowdbot.core import CrowdbotError, InputError, MissingExtra
from crowdbot.simulation import Simulation
from crowdbot.trials import Trial, builtin_trials, expand_sweeps, load_trial

from .crossing import BEAMS, CrossingTask, advance_work, crossing_trial, episode_work, repeat_step, reset_work
from .peers import IrSimPeer, NavgroundPeer
from .work_rate import TimedWork, WorkRate, rates


@dataclass(frozen=True)
class BenchmarkSizes:
    """Numbers of environments, steps, episodes and repetitions.

    Fields:
        repeats: timed repetitions after a warm-up.
        environments: environments E of a batch.
        steps: steps of a batch of 10 people; twice as many with 50.
        single_steps: steps of a single environment.
        peer_worlds: worlds of navground per repetition.
        episodes: episodes to their end, ours and in navground.
        block: episodes that are simulated together.
        slow_episodes: episodes to their end in ir-sim.
        trial_environments: environments of each built-in trial, beside a single one.
        trial_steps: steps of each built-in trial.
        trials: largest number of built-in trials.

    Raises:
        InputError: a number is below 1.

    >>> BenchmarkSizes(environments=64).steps
    100
    """

    repeats: int = 5
    environments: int = 256
    steps: int = 100
    single_steps: int = 100
    peer_worlds: int = 64
    episodes: int = 1000
    block: int = 250
    slow_episodes: int = 4
    trial_environments: int = 64
    trial_steps: int = 20
    trials: int = 1000

    def __post_init__(self) -> None:
        for name, value in vars(self).items():
            if value < 1:
                raise InputError(f"{name.replace('_', ' ')} {value} is below 1")

    @classmethod
    def quick(cls, repeats: int = 1) -> BenchmarkSizes:
        """Return sizes that take seconds and only show that everything works."""
        return cls(repeats, 4, 4, 4, 2, 2, 2, 1, 2, 2, 2)


@dataclass(frozen=True)
class PeerRate:
    """Rate of another simulator in a row.

    Fields:
        peer: its name.
        protocol: what its work includes, and how it differs from ours.
        rate: its rate.
        ratio_cpu, ratio_wall: our rate divided by its rate, per CPU second and per second.
    """

    peer: str
    protocol: str
    rate: WorkRate
    ratio_cpu: float
    ratio_wall: float


@dataclass(frozen=True)
class EnvironmentRow:
    """A rate of our simulation and those of other simulators.

    Fields:
        name: name of the row.
        protocol: what the work includes.
        unit: unit of the rates per second.
        people: people in each environment, without the robot.
        environments: environments E that advance together.
        rate: our rate.
        peers: rates of other simulators.
    """

    name: str
    protocol: str
    unit: str
    people: int
    environments: int
    rate: WorkRate
    peers: tuple[PeerRate, ...] = ()

    def as_dict(self) -> dict[str, Any]:
        """Return the row as ``crowdbot bench environments --json`` prints it."""
        return {**asdict(self), "cpu_milliseconds_per_unit": 1e3 / self.rate.per_cpu_second}


@dataclass(frozen=True)
class CallRow:
    """Calls in one step of a simulation.

    Fields:
        name: name of the row.
        environments: environments E that advance together.
        python_calls: calls of Python functions per step.
        builtin_calls: calls of compiled functions from Python per step.
        ratio: Python calls divided by those of a single environment.
    """

    name: str
    environments: int
    python_calls: float
    builtin_calls: float
    ratio: float


@dataclass(frozen=True)
class TrialRate:
    """Speed of a built-in trial.

    Fields:
        name: name of the trial.
        agents: people and robots at the start.
        single: steps per second of a single environment.
        batch: steps of environments per second of a batch.
        environments: environments E of the batch.
        ratio: steps per CPU second of the batch divided by those of the single environment.
        reason: why the trial was not measured, empty otherwise.
    """

    name: str
    agents: int = 0
    single: WorkRate | None = None
    batch: WorkRate | None = None
    environments: int = 0
    ratio: float | None = None
    reason: str = ""


def planar_trials() -> Iterator[tuple[str, Trial]]:
    """Yield the built-in trials in the planar world by name; of sweeps, their first trial."""
    for name in builtin_trials():
        trial = load_trial(name)
        first = expand_sweeps(trial)[0] if trial.sweeps else trial
        if first.world == "planar":
            yield name, first


def trial_rates(sizes: BenchmarkSizes, report: Callable[[str, float], None]) -> list[TrialRate]:
    """Return the speed of all built-in planar trials; ``report`` receives the progress."""
    trials = list(itertools.islice(planar_trials(), sizes.trials))
    rows = []
    for k, (name, trial) in enumerate(trials):
        report("built-in trials", k / len(trials))
        try:
            rows.append(_rate_of(name, trial, sizes))
        except CrowdbotError as error:
            rows.append(TrialRate(name, reason=str(error)))
    report("built-in trials", 1.0)
    return rows


def _rate_of(name: str, trial: Trial, sizes: BenchmarkSizes) -> TrialRate:
    single, _ = _measure(trial, 1, sizes.trial_steps)
    batch, agents = _measure(trial, sizes.trial_environments, sizes.trial_steps)
    return TrialRate(
        name, agents, single, batch, sizes.trial_environments, batch.per_cpu_second / single.per_cpu_second
    )


def _measure(trial: Trial, environments: int, steps: int) -> tuple[WorkRate, int]:
    """Return the steps of environments per second after a warm-up of two steps, and the agents at the start."""
    simulation = Simulation(trial, range(environments))
    agents = int(simulation.world.scene.active[0].sum())
    repeat_step(2)(simulation)
    work = TimedWork(environments * steps, lambda: simulation, repeat_step(steps))
    rate = rates({"ours": work}, repeats=1, warm_up=False)["ours"]
    failure = next((failure for failure in simulation.failures if failure is not None), None)
    if failure is not None:
        raise CrowdbotError(f"an environment ended with an error: {failure}")
    return rate, agents


def count_calls(simulation: Simulation, steps: int) -> tuple[float, float]:
    """Return the calls of Python functions and of compiled functions per step, in the calling thread."""
    found = {"call": 0, "c_call": 0}

    def tally(frame: FrameType, event: str, argument: Any) -> None:
        if event in found:
            found[event] += 1

    before = sys.getprofile()
    sys.setprofile(tally)
    try:
        for _ in range(steps):
            simulation.advance()
    finally:
        sys.setprofile(before)
    return found["call"] / steps, (found["c_call"] - 1) / steps  # the last one is setprofile


def call_rows(trial: Trial, environments: int, steps: int) -> list[CallRow]:
    """Return the calls of a single environment and of a batch."""
    rows: list[CallRow] = []
    for name, count in (("calls-single", 1), ("calls-batch", environments)):
        simulation = Simulation(trial, range(count))
        simulation.advance()
        python, builtin = count_calls(simulation, steps)
        rows.append(CallRow(name, count, python, builtin, python / rows[0].python_calls if rows else 1.0))
    return rows


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
    before, measurer, many = load_average(), _Measurer(chosen), chosen.environments
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
        environment(),
        (before, load_average()),
        chosen,
        versions,
        measurer.missing,
        tuple(rows),
        tuple(calls),
        tuple(trials),
    )
