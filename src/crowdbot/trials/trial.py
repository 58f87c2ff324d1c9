"""Trial: the description of a simulation as a tree of frozen dataclasses, which is also the XML tree."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from crowdbot.core import PERSON_COLOR, ROBOT_COLOR, WALL_COLOR, Disc, InputError, Path2D, draw_svg
from crowdbot.core.fields import attribute, check, child, children
from crowdbot.models import CrowdModel
from crowdbot.world import ContactModel, Exit, Portal

from .agent import Agent, Avatar
from .camera import Camera
from .crowd import Crowd, Crowds, Limits, Routing
from .ground.plan import floor_plan
from .journey import Journey
from .people import SourceSpec, Spawner
from .recorded_people import RecordedPeople
from .robot import Mount, RobotGoal, RobotSpec
from .stage import Stage
from .sweep import Sweep

__all__ = ["End", "EndCondition", "Mount", "RecordingSpec", "RobotGoal", "RobotSpec", "Trial"]


def trial_svg(trial: Any) -> str:
    """Return an SVG drawing: walls grey, ground brown, doors, zones of people blue, robots and their goals red."""
    rings = [np.concatenate([ring, ring[:1]]) for ring in trial.stage.rings]
    lines = floor_plan(trial.stage) + [Path2D(ring, WALL_COLOR, 1.5) for ring in rings]
    for area in [spawner.zone for spawner in trial.spawners] + [source.zone for source in trial.sources]:
        zone = np.asarray(area, dtype=np.float64)
        lines.append(Path2D(np.concatenate([zone, zone[:1]]), PERSON_COLOR, 1.0, 0.6))
    discs = [Disc(agent.x, agent.y, 0.25, PERSON_COLOR) for agent in trial.agents]
    for robot in trial.robots:
        start = np.array([robot.x, robot.y], dtype=np.float64)
        lines.append(Path2D(np.stack([start, np.asarray(robot.goal.position)]), ROBOT_COLOR, 1.2, 0.6))
        discs.append(Disc(robot.x, robot.y, 0.3, ROBOT_COLOR))
    people = sum(spawner.count for spawner in trial.spawners) + len(trial.agents)
    who = f"{people} {'person' if people == 1 else 'people'} at the start"
    which = f"{len(trial.robots)} robot{'' if len(trial.robots) == 1 else 's'}"
    return draw_svg(lines, discs, f"{trial.name}: {who}, {which}, {trial.duration:g} s")


@dataclass(frozen=True)
class EndCondition:
    """A condition that ends a trial: position of a robot, number of people, or time.

    >>> EndCondition("x", above=20.0).holds(21.0)
    True
    """

    what: str = attribute(
        about="x or y of the robot [m], number of people, or time [s]", choices=("x", "y", "people", "time")
    )
    below: float | None = attribute(None, about="it is below this")
    above: float | None = attribute(None, about="it is above this")
    robot: str = attribute("", about="name of the robot, by default the first")
    outcome: str = attribute("finished", about="outcome of the trial", choices=("finished", "success", "timeout"))

    def __post_init__(self) -> None:
        check(self)
        if (self.below is None) == (self.above is None):
            raise InputError("needs one of below and above")

    def holds(self, value: float) -> bool:
        """Return whether the condition holds for a value."""
        return value < self.below if self.below is not None else value > (self.above or 0.0)


@dataclass(frozen=True)
class End:
    """Conditions that end a trial before its duration is over."""

    goal: bool = attribute(True, about="every robot has reached its goal")
    collision: bool = attribute(True, about="a robot touches a person, a wall or another robot")
    fall: bool = attribute(False, about="somebody has fallen, in the physics world with balance; outcome: fall")
    empty: bool = attribute(False, about="ends when no people are left and none will enter")
    conditions: tuple[EndCondition, ...] = children("when", about="other conditions, of which one suffices", max=100)

    def __post_init__(self) -> None:
        check(self)


@dataclass(frozen=True)
class RecordingSpec:
    """Recording periods. A trial ends at a recorded instant."""

    period: float = attribute(0.1, about="time between two recorded scenes", unit="s", exclusive_min=0.0)
    markers: float = attribute(0.5, about="time between two sets of shapes for viewers", unit="s", exclusive_min=0.0)

    def __post_init__(self) -> None:
        check(self)


@dataclass(frozen=True, kw_only=True)
class Trial:
    """A simulation: stage, people, robots, end conditions.

    A trial made in Python is checked when it runs, or by :func:`crowdbot.trials.check_trial`.

    Raises:
        InputError: a value is not allowed.

    >>> from crowdbot.models import ORCA
    >>> Trial(name="alone", duration=2.0, crowd=ORCA()).ticks
    40
    """

    name: str = attribute(about="name of the trial", pattern=r"\S.{0,79}")
    about: str = attribute("", about="one line for people")
    duration: float = attribute(about="longest simulated time", unit="s", exclusive_min=0.0, max=86_400.0)
    world: str = attribute(
        "planar", about="discs in the plane, or bodies with contact forces", choices=("planar", "physics")
    )
    physics_step: float = attribute(0.005, about="time step of the physics world", unit="s", min=0.0001, max=0.02)
    balance: bool = attribute(
        False,
        about="whether pushed people brace, step and fall, in the physics world; otherwise they stay upright",
    )
    get_up: float | None = attribute(
        5.0, about="time on the floor after which people get up", unit="s", min=0.0, max=86_400.0
    )
    bodies: str | None = attribute(
        None,
        about="shape of people for laser scanners (default: limbs in the physics world and in trials with avatars,"
        " otherwise discs); other sensors see limbs or skins; unless it is discs, avatars have their skin",
        choices=("discs", "limbs", "skins"),
    )
    step: float = attribute(0.05, about="time step of the world", unit="s", min=0.001, max=1.0)
    substeps: int = attribute(1, about="crowd steps per step of the world", min=1, max=10_000)
    seed: int = attribute(0, about="seed of everything random", min=-(2**53), max=2**53)
    capacity: int | None = attribute(
        None, about="maximum number of people at a time; others wait outside", min=0, max=100_000
    )
    robot_margin: float = attribute(
        0.1, about="margin that people add to the radius of a robot", unit="m", min=0.0, max=10.0
    )
    heading_jitter: float = attribute(
        0.0,
        about="maximum random deviation of each person's direction, which breaks symmetric deadlocks",
        unit="rad",
        min=0.0,
        max=math.pi,
    )
    stage: Stage = child(Stage, about="stage: walls, obstacles and the walkable area")
    routing: Routing | None = child(None, about="routing around walls")
    crowd: CrowdModel = children({"crowd": Crowd}, into=Crowds, about="crowd models", min=1, max=20)
    contact: ContactModel | None = child(None, about="contact between people")
    limits: Limits | None = child(None, about="limits of speed and acceleration")
    journeys: tuple[Journey, ...] = children("journey", about="sequences of stops", max=1000)
    agents: tuple[Agent, ...] = children("agent", about="single people", max=20_000)
    spawners: tuple[Spawner, ...] = children("spawner", about="people", max=1000)
    sources: tuple[SourceSpec, ...] = children("source", about="people who enter during the trial", max=1000)
    recorded: tuple[RecordedPeople, ...] = children("recorded", about="people who follow a recording", max=100)
    avatars: tuple[Avatar, ...] = children("avatar", about="people whose pose comes from outside", max=100)
    exits: tuple[Exit, ...] = children("exit", about="zones where people leave", max=1000)
    portals: tuple[Portal, ...] = children("portal", about="zones that move people elsewhere", max=1000)
    robots: tuple[RobotSpec, ...] = children("robot", about="robots", max=100)
    cameras: tuple[Camera, ...] = children("camera", about="cameras", max=100)
    end: End = child(End, about="end conditions")
    recording: RecordingSpec = child(RecordingSpec, about="recording rates")
    sweeps: tuple[Sweep, ...] = children("sweep", about="parameter sweeps", max=20)
    folder: Path | None = dataclasses.field(default=None, compare=False, repr=False)
    """Folder of the code that the trial names; not part of the XML."""

    def __post_init__(self) -> None:
        check(self)
        steps = self.step / self.physics_step
        if self.balance and self.world != "physics":
            raise InputError('balance="true" needs the bodies of world="physics"')
        if self.end.fall and not self.balance:
            raise InputError('<end fall="true"> needs people who can fall: world="physics" and balance="true"')
        if self.world == "physics" and (steps < 1.0 - 1e-6 or abs(steps - round(steps)) > 1e-6):
            raise InputError(
                f'step="{self.step:g}" must be a whole number of steps of the physics world, physics-step='
                f'"{self.physics_step:g}" s'
            )

    def _repr_svg_(self) -> str:
        """Return an SVG drawing for notebooks: stage, zones of people, robots and their goals."""
        return trial_svg(self)

    @property
    def people(self) -> int:
        """Number of agents, people of spawners, avatars and recorded people.

        Their indices come in this order, before those of robots.
        """
        recorded = sum(len(item.walks(self.duration)) for item in self.recorded)
        return len(self.agents) + sum(spawner.count for spawner in self.spawners) + len(self.avatars) + recorded

    @property
    def ticks(self) -> int:
        """Number of time steps until the duration is over."""
        return max(1, math.ceil(round(self.duration / self.step, 6)))
