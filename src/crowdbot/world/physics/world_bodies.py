"""All rigid bodies of a physics world: those that may touch, and those of ghosts."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any

from crowdbot.core import Storage, Walls
from crowdbot.world.physics.robots.link_forces import LinkForces
from crowdbot.world.physics.robots.robot_body import RobotBody

from .contacts import ContactReader
from .engine_models import BodyDesign, RobotStart, compile_bodies
from .people_bodies import PeopleBodies
from .rigid_bodies import RigidBodies, update_frames
from .stage import AbsentProp, PhysicsStage, PropBody


class WorldBodies:
    """Rigid bodies of robots, props and people near them.

    Each ghost has an engine state of its own, with the floor, the walls and the fixed props: nothing that it does can
    change the state of anybody else, not even by rounding.

    Args:
        walls: walls without the outlines of props.
        stage: stage with props.
        starts: robots by agent.
        ghosts: agents of robots that touch only the stage.
        slots: number of people that can have a body at the same time.
        step: time step of the engine [s].

    Attributes:
        main: bodies that touch each other.
        ghosts: bodies of ghosts by agent.
        robots: bodies of all robots by agent.
        people: bodies of people near robots and movable props.
        reader: reads the contacts of ``main``.
        links: drag and kinematic links of its robots.
        model: model of ``main`` during a step, see :meth:`engine_steps`.
    """

    storage = Storage(constants=("walls", "step", "stage", "starts", "slots", "reader", "links", "model"))

    def __init__(
        self,
        walls: Walls,
        stage: PhysicsStage,
        starts: Mapping[int, RobotStart],
        ghosts: Sequence[int],
        slots: int,
        step: float,
    ) -> None:
        self.walls, self.step = walls, step
        self.stage, self.starts, self.slots = stage, dict(starts), slots
        self.main = RigidBodies(self._main_design(ghosts))
        self.ghosts = {agent: RigidBodies(self._alone(agent)) for agent in sorted(ghosts) if agent in self.starts}
        compiled = self.main.compiled
        self.people = PeopleBodies(compiled.base, self.main.data, slots, step, compiled.shapes)
        self.model: Any = None
        self._collect()

    @property
    def parts(self) -> tuple[RigidBodies, ...]:
        """Parts with engine states of their own."""
        return (self.main, *self.ghosts.values())

    @contextmanager
    def engine_steps(self) -> Iterator[None]:
        """Use a model for the engine steps inside; afterwards, all frames are up to date."""
        with self.main.compiled.borrow() as model:
            try:
                self.model = model
                self.people.install(model)
                self.reader.use(model, self.people.shapes.size)
                yield
                update_frames(model, self.main.data)
            finally:
                self.model = None
                self.people.release()
                self.reader.use(self.main.compiled.base, self.people.shapes.size)

    def change(
        self,
        *,
        stage: PhysicsStage | None = None,
        starts: Mapping[int, RobotStart] | None = None,
        ghosts: Sequence[int] | None = None,
        slots: int | None = None,
        walls: Walls | None = None,
    ) -> None:
        """Add and remove bodies and walls; the state of all others is kept to the last bit. None: as before.

        New robots and movable props come to rest on the floor first.

        Raises:
            InputError: a robot has no driven or steered wheels, or a motor does not exist.
        """
        before = (self.stage, self.starts, self.slots, self.walls)
        ghostly = sorted(self.ghosts if ghosts is None else ghosts)
        try:
            self.stage = self.stage if stage is None else stage
            self.starts = self.starts if starts is None else dict(starts)
            self.slots = self.slots if slots is None else slots
            self.walls = self.walls if walls is None else walls
            designs = [self._main_design(ghostly), *(self._alone(item) for item in ghostly if item in self.starts)]
            for design in designs:
                compile_bodies(design)
        except Exception:
            self.stage, self.starts, self.slots, self.walls = before
            raise
        self._rebuild(before[0], [item for item in ghostly if item in self.starts])

    def picture(self) -> RigidBodies:
        """Return all bodies in one part in their current state, for a picture that shows ghosts."""
        whole = RigidBodies(self._main_design(()), settled=False)
        whole.take_state(self.parts)
        return whole

    def _rebuild(self, stage: PhysicsStage, ghosts: Sequence[int]) -> None:
        """Replace the engine states; ``stage`` is the old one."""
        old, known = self.parts, self.robots
        fresh = [RigidBodies(self._alone(agent)) for agent in self.starts if agent not in known]
        fresh += [
            RigidBodies(self._design((), number))
            for number, prop in enumerate(self.stage.props)
            if prop.movable and (number >= len(stage.props) or prop is not stage.props[number])
        ]
        self.main = RigidBodies(self._main_design(ghosts), known, settled=False)
        self.ghosts = {agent: RigidBodies(self._alone(agent), known, settled=False) for agent in ghosts}
        for part in self.parts:
            part.take_state([*fresh, *old])
        compiled = self.main.compiled
        if self.slots == len(self.people.agent):
            self.people.bind(compiled.base, self.main.data)
        else:
            self.people.grow(compiled.base, self.main.data, compiled.shapes)
        self._collect()

    def _collect(self) -> None:
        self.robots: dict[int, RobotBody] = {
            agent: part.robots[agent] for part in self.parts for agent in sorted(part.robots)
        }
        self.robots = dict(sorted(self.robots.items()))
        compiled = self.main.compiled
        self.links = LinkForces(compiled.base, self.main.robots.values(), self.step)
        self.reader = ContactReader(
            compiled.base, self.main.data, compiled.geoms, self.people.agent_of, self.people.swing_of
        )

    def _main_design(self, ghosts: Sequence[int]) -> BodyDesign:
        robots = tuple(start for agent, start in sorted(self.starts.items()) if agent not in ghosts)
        return BodyDesign(self.walls, self.stage, robots, self.slots, self.step)

    def _alone(self, agent: int) -> BodyDesign:
        return self._design((self.starts[agent],))

    def _design(self, robots: tuple[RobotStart, ...], number: int = -1) -> BodyDesign:
        """Return the design with some robots on the bare stage, and the movable prop of this number."""

        def left(k: int, prop: PropBody) -> PropBody:
            return AbsentProp() if prop.movable and k != number else prop

        props = tuple(left(k, prop) for k, prop in enumerate(self.stage.props))
        return BodyDesign(self.walls, dataclasses.replace(self.stage, props=props), robots, 0, self.step)
