"""Steps: their order, who allows them, and the same bytes however time comes."""

from __future__ import annotations

import dataclasses
import importlib
import random
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray

from crowdbot.core import Clock, ExternalClock, FreeClock, InputError, PacedClock, Pose, Scene, Twist
from crowdbot.models import ORCA
from crowdbot.navigation import Navigator, Observation
from crowdbot.recording import open_run, read_episode, record
from crowdbot.sensors import Lidar2D, SensorView
from crowdbot.simulation import EpisodeStatistics, Order, Simulation, SimulationRun, StepRecord, VelocityOrder
from crowdbot.trials import Trial, parse_trial
from crowdbot.world import DifferentialDrive, World
from trial_texts import BRIEF_FLOW, GOOD

TRIAL = parse_trial(GOOD)
simulation_module = importlib.import_module("crowdbot.simulation.simulation")
EVENTS: list[tuple[str, float]] = []


class Watched(FreeClock):
    def advance(self) -> None:
        EVENTS.append(("time", self.time))
        super().advance()


@dataclasses.dataclass(frozen=True)
class Crowd(ORCA):
    def velocity(self, scene: Scene, dt: float, rng: Any = None) -> NDArray[np.float64]:
        EVENTS.append(("crowd", scene.time))
        return super().velocity(scene, dt, rng)


@dataclasses.dataclass(frozen=True)
class Wheels(DifferentialDrive):
    def step(self, pose: Pose, twist: Any, command: Any, dt: float) -> Any:
        EVENTS.append(("robots", 0.0))
        return super().step(pose, twist, command, dt)


@dataclasses.dataclass(frozen=True)
class Eye(Lidar2D):
    def measure(self, view: SensorView, state: Any, rng: Any = None) -> Any:
        EVENTS.append(("sensors", view.time))
        return super().measure(view, state, rng)


@dataclasses.dataclass(frozen=True)
class Pilot(Navigator):
    def act(self, observation: Observation) -> Twist:
        EVENTS.append(("navigators", observation.time))
        return Twist(0.5)


class Wire:
    """A source that gives every robot another command."""

    def orders(self, simulation: Simulation) -> list[Order]:
        EVENTS.append(("orders", simulation.world.scene.time))
        return [VelocityOrder(robot="robot", forward=0.25)]


class Book:
    """A recorder."""

    def take(self, frame: StepRecord) -> None:
        EVENTS.append(("recorder", frame.scene.time))
        assert frame.commands.tolist() == [[0.25, 0.0, 0.0]]


def watched(monkeypatch: pytest.MonkeyPatch, world: str) -> Simulation:
    """Return a simulation whose parts tell when they are at work, each with the time of the scene that it sees."""
    EVENTS.clear()
    robot = dataclasses.replace(
        TRIAL.robots[0],
        drive=Wheels() if world == "planar" else DifferentialDrive(),
        navigator=Pilot(),
        control_period=0.05,
        sensors=[dataclasses.replace(TRIAL.robots[0].sensors[0], sensor=Eye(rays=4, rate=20.0))],
    )
    trial = dataclasses.replace(
        TRIAL, crowd=Crowd(), robots=[robot], recording=dataclasses.replace(TRIAL.recording, period=0.05), world=world
    )
    simulation = Simulation(trial, 3, Watched(0.05))
    bodies = simulation_module.leave_goal_zones

    def leave(world: World, zones: Any) -> None:
        EVENTS.append(("people's bodies", world.scene.time))
        bodies(world, zones)

    monkeypatch.setattr(simulation_module, "leave_goal_zones", leave)
    return simulation


BEGIN = [("sensors", 0.0), ("navigators", 0.0), ("orders", 0.0)]
OLD, NEW = 0.0, 0.05


def test_the_order_of_a_step(monkeypatch: pytest.MonkeyPatch) -> None:
    simulation = watched(monkeypatch, "planar")
    physics = simulation.world._resolve_overlaps

    def resolve(earlier: Scene, after: Scene) -> Scene:
        EVENTS.append(("physics", earlier.time))
        return physics(earlier, after)

    monkeypatch.setattr(simulation.world, "_resolve_overlaps", resolve)
    running = SimulationRun(simulation, [Book()], [Wire()])
    assert BEGIN == EVENTS
    EVENTS.clear()
    running.step()
    assert [
        ("recorder", OLD),
        ("time", OLD),
        ("crowd", OLD),
        ("robots", 0.0),
        ("physics", OLD),
        ("people's bodies", NEW),
        ("sensors", NEW),
        ("navigators", NEW),
        ("orders", NEW),
    ] == EVENTS


def test_the_order_of_a_step_in_the_physics_world(monkeypatch: pytest.MonkeyPatch) -> None:
    simulation = watched(monkeypatch, "physics")
    world: Any = simulation.world
    (agent,) = world.robot_bodies
    ask, substep, limbs = world.robot_bodies[agent].ask, world._substep, world.people.take
    asked: list[float] = []

    def robots(command: Any) -> None:
        EVENTS.append(("robots", world.scene.time))
        asked.append(float(command.forward[0]))
        ask(command)

    def engine(share: float, time: float) -> None:
        EVENTS.append(("physics", round(time, 9)))
        substep(share, time)

    def taken(gait: Any, ends: Any) -> None:
        EVENTS.append(("limbs", 0.0))
        limbs(gait, ends)

    monkeypatch.setattr(world.robot_bodies[agent], "ask", robots)
    monkeypatch.setattr(world, "_substep", engine)
    monkeypatch.setattr(world.people, "take", taken)
    running = SimulationRun(simulation, [Book()], [Wire()])
    assert BEGIN == EVENTS
    for old in (0.0, 0.05, 0.1):
        EVENTS.clear()
        running.step()
        new = round(old + 0.05, 9)
        assert [
            ("recorder", old),
            ("time", old),
            ("crowd", old),
            ("robots", old),
            *(("physics", round(old + 0.005 * k, 9)) for k in range(1, 11)),
            ("limbs", 0.0),
            ("people's bodies", new),
            ("sensors", new),
            ("navigators", new),
            ("orders", new),
        ] == [(what, round(time, 9)) for what, time in EVENTS]
    assert asked == [0.25, 0.25, 0.25], "the order came after the navigator, and was obeyed in the next step"


def driven(trial: Trial, clock: Clock | None, times: list[int] | None, out: Path | None = None) -> str:
    tally = EpisodeStatistics(trial, trial.seed)
    running = SimulationRun(Simulation(trial, trial.seed, clock), [tally])
    for nanoseconds in times or []:
        running.until(nanoseconds)
    while running.outcome is None:
        running.step()
    return tally.digest.hexdigest(running.outcome)


@pytest.mark.parametrize("text", [GOOD, BRIEF_FLOW], ids=["small", "flow"])
def test_an_external_clock_in_odd_ticks_gives_the_same_bytes(text: str, tmp_path: Path) -> None:
    trial = parse_trial(text)
    free = record(trial, out=tmp_path / "free")
    chance, now = random.Random(0), 0
    with open_run(trial, out=tmp_path / "outside", clock=ExternalClock(trial.step)) as running:
        while running.outcome is None:
            now += chance.choice([0, 1, 7_000_001, 49_999_999, 50_000_000, 333_333_333])
            running.until(now)
    assert (tmp_path / "free" / "episode.mcap").read_bytes() == (tmp_path / "outside" / "episode.mcap").read_bytes()
    assert read_episode(tmp_path / "outside" / "episode.mcap").digest == free.digest


@given(pauses=st.lists(st.integers(0, 900_000_000), max_size=12))
@settings(deadline=None, max_examples=3)
def test_however_time_comes_the_digest_is_the_same(pauses: list[int]) -> None:
    times = np.cumsum(pauses).tolist()
    assert driven(TRIAL, ExternalClock(0.05), times) == driven(TRIAL, None, None)


def test_a_paced_run_gives_the_same_bytes_and_takes_its_time() -> None:
    slept: list[float] = []
    clock = PacedClock(0.05, rate=8.0, monotonic=lambda: sum(slept), sleep=slept.append)
    assert driven(TRIAL, clock, None) == driven(TRIAL, None, None)
    assert sum(slept) == pytest.approx(TRIAL.ticks * 0.05 / 8.0)


def test_clocks_that_do_not_fit_are_refused() -> None:
    late = FreeClock(0.05)
    late.advance()
    for clock in (late, FreeClock(0.1)):
        with pytest.raises(InputError, match="but the trial starts at tick 0 with steps of 0.05 s"):
            Simulation(TRIAL, 0, clock)
    running = SimulationRun(Simulation(TRIAL, 3, ExternalClock(0.05)))
    running.until(200_000_000)
    with pytest.raises(InputError, match="external time went back"):
        running.until(100_000_000)
    with pytest.raises(InputError, match="there is no robot 'rob'; the trial has robot"):
        running.step([VelocityOrder(robot="rob")])


def test_a_run_that_has_ended_is_not_stepped_on() -> None:
    running = SimulationRun(Simulation(TRIAL, 3, ExternalClock(0.05)))
    assert running.until(10**12) == 80
    assert running.outcome == "timeout"
    assert running.until(10**13) == 0
    with pytest.raises(InputError, match=r"the run has ended \(timeout\) at 4 s"):
        running.step()


def test_who_closes_a_run_early_interrupts_it(tmp_path: Path) -> None:
    with open_run(TRIAL, out=tmp_path) as running:
        for _ in range(43):
            running.step()
    read = read_episode(tmp_path / "episode.mcap")
    assert (read.complete, read.outcome, read.steps, read.times[-1]) == (True, "interrupted", 42, 2.1)


def test_a_bridge_steers_and_contacts_are_recorded(tmp_path: Path) -> None:
    class Ram:
        def orders(self, simulation: Simulation) -> list[Order]:
            return [VelocityOrder(robot="robot", forward=1.0)]

    with open_run(TRIAL, out=tmp_path, sources=[Ram()]) as running:
        while running.outcome is None:
            running.step()
    read = read_episode(tmp_path / "episode.mcap")
    assert np.all(read.commands[:, 0] == [1.0, 0.0, 0.0])
    assert {contact.other for contact in read.contacts} <= {"wall", *map(str, range(4))}
