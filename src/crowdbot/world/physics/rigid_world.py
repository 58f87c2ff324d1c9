"""RigidWorld: robots, props and people of a physics world as rigid bodies, which may come and go."""

from __future__ import annotations

import copy
import dataclasses
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, Self

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Scene, Walls
from crowdbot.world.crowd.ghosts import hide_ghosts
from crowdbot.world.phases.pushes import acting_pushes
from crowdbot.world.physics.robots.robot_body import RobotBody
from crowdbot.world.planar import PlanarWorld
from crowdbot.world.planar_live_changes import (
    check_robot_place,
    chosen_environments,
    new_prop_name,
    prop_number,
    put_robot_at,
    remove_robot_at,
    robot_environments,
    without_last,
)
from crowdbot.world.rendering.camera import CameraImages, SceneCamera
from crowdbot.world.rendering.renderer import Renderer
from crowdbot.world.robots.robot import Robot

from .balance.falling_people import FallingPeople
from .contacts import ContactBody
from .engine import engine
from .engine_models import RobotStart
from .mjcf_model import MjcfModel
from .people_bodies import PeopleBodies
from .people_motion import PeopleMotion
from .rider import seat_rider
from .scenery import add_rings
from .stage import AbsentProp, PhysicsStage, PropBody, without_prop
from .world_bodies import WorldBodies

if TYPE_CHECKING:
    from crowdbot.world.crowd.source import PeopleSource

__all__ = ["RigidWorld"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
SLOTS = 24
"""Default of the largest number of people with a body in the engine."""
MORE = 4
"""Number of bodies in the engine that are added at a time."""


class RigidWorld(PlanarWorld):
    """Part of :class:`PhysicsWorld`: access to the bodies, and changes of them between two steps."""

    people: PeopleMotion
    falling: FallingPeople | None
    rigid: WorldBodies
    stage: PhysicsStage
    _renderers: dict[bool, Renderer]
    _prop_names: list[str]
    _at: dict[int, tuple[float, float, float]]
    _outlined: Walls
    _plane: tuple[Scene, Scene] | None
    _slots_fixed: bool

    @property
    def robot_bodies(self) -> dict[int, RobotBody]:
        """Bodies of the robots by agent."""
        return self.rigid.robots

    @property
    def engine_model(self) -> Any:
        """The ``mujoco.MjModel``, shared with other worlds of the same stage and robots; not to be changed."""
        return self.rigid.main.compiled.base

    @property
    def data(self) -> Any:
        """The ``mujoco.MjData`` of all bodies that can touch each other."""
        return self.rigid.main.data

    @property
    def mjcf(self) -> MjcfModel:
        """The MJCF model."""
        return self.rigid.main.compiled.built

    @property
    def _people_bodies(self) -> PeopleBodies:
        return self.rigid.people

    @property
    def _movable(self) -> list[int]:
        return [k for k, prop in enumerate(self.stage.props) if prop.movable]

    def _wanting(self, scene: Scene) -> Ints:
        """Return the people who need a body although nothing may be near them: out of balance, or pushed."""
        pushed = acting_pushes(scene, self.ids)
        return pushed if self.falling is None else np.union1d(self.falling.wanting(), pushed)

    def _push_people(self, crowd: Scene) -> Scene:
        """Return the scene unchanged: the engine applies the forces."""
        return crowd

    def command(self, robot: int, joints: Mapping[str, float]) -> None:
        """Set the commands of joint motors of a robot; they stay in force until changed.

        Raises:
            InputError: the agent is not a robot, a joint has no motor or is a wheel, or a value is not finite.
        """
        self.robot_body(robot).command(joints)

    def robot_body(self, robot: int) -> RobotBody:
        """Return the body of a robot.

        Raises:
            InputError: the agent is not a robot.
        """
        if robot not in self.robot_bodies:
            raise InputError(f"agent {robot} is not a robot; robots are {sorted(self.robot_bodies) or 'none'}")
        return self.robot_bodies[robot]

    def render(
        self, camera: SceneCamera, *, rgb: bool = True, depth: bool = False, segmentation: bool = False
    ) -> CameraImages:
        """Return the current images of a camera, with the skins of people. No display is needed.

        Raises:
            InputError: no OpenGL backend works, or the robot or link of the camera is unknown.
        """
        return self.renderer.images(camera, rgb=rgb, depth=depth, segmentation=segmentation)

    @property
    def renderer(self) -> Renderer:
        """Renderer of the current state with ghosts, for films; see :meth:`Renderer.render`."""
        return self._shown(bool(self.rigid.ghosts))

    def environment_renderer(self, environment: int) -> Renderer:
        """Return the renderer without ghosts, for cameras of :mod:`crowdbot.sensors`; see :class:`World`."""
        return self._shown(False)

    def _shown(self, ghosts: bool) -> Renderer:
        """Return the renderer of the current state, with ghosts or without."""
        whole = self.rigid.picture() if ghosts else self.rigid.main
        scene = self.scene if ghosts else hide_ghosts(self.scene, self.ghosts)
        if ghosts not in self._renderers:
            robots = {agent: body.robot for agent, body in whole.robots.items()}
            self._renderers[ghosts] = Renderer.of_physics(whole.compiled.built, robots, self.stage, self.people, scene)
        self._renderers[ghosts].show_engine(scene, whole.data.qpos)
        return self._renderers[ghosts]

    def prop(self, number: int) -> Floats:
        """Return the frame ``[4, 4]`` of a prop in the world."""
        if not 0 <= number < len(self.stage.props) or isinstance(self.stage.props[number], AbsentProp):
            raise InputError(f"there is no prop {number}; the stage has {len(self.stage.props)}")
        body = self.data.body(f"prop{number}")
        found = np.eye(4)
        found[:3, :3], found[:3, 3] = body.xmat.reshape(3, 3), body.xpos
        return found

    def change_bodies(self, robots: Mapping[int, Robot], stage: PhysicsStage, walls: Walls | None = None) -> None:
        """Replace the descriptions of robots: sensors, posture and latency; the stage stays. See :class:`World`."""
        for agent, robot in robots.items():
            if agent not in self.drives or agent in self.robot_bodies:
                self.robot_body(agent).robot = self._with_rider(agent, robot)

    def _with_rider(self, agent: int, robot: Robot) -> Robot:
        """Return the robot of an agent with its rider, if it has one."""
        people = self.people
        if agent not in people.agents[len(people.afoot) :]:
            return robot
        return seat_rider(robot, people.people, int(people.row[agent]))

    def copy(self) -> Self:
        """Return an independent world in the same state, on a free clock."""
        shared: list[Any] = [engine(), self.stage, self.router, self.people.people, self.people.gait, self.model]
        shared += [body.robot for body in self.robot_bodies.values()]
        shared += [start.robot for start in self.rigid.starts.values()]
        shared += [part.compiled.base for part in self.rigid.parts]
        shared.append(self.rigid.reader.geoms)
        renderers, self._renderers = self._renderers, {}
        known = {id(one): one for one in shared} | {id(part.data): copy.copy(part.data) for part in self.rigid.parts}
        try:
            other = copy.deepcopy(self, known)
        finally:
            self._renderers = renderers
        other.environment_time = other.environment_time.select([0])
        return other

    def reconfigure(self, scene: Scene, sources: Sequence[PeopleSource], seed: Any = None, **how: Any) -> None:
        """Change parameters of the running world, also which robots are ghosts; see :class:`PlanarWorld`."""
        super().reconfigure(scene, sources, seed, **how)
        if sorted(self.rigid.ghosts) != sorted(agent for agent in self.ghosts if agent in self.robot_bodies):
            self.rigid.change(ghosts=self.ghosts)
            self._forget()

    def add_robot(
        self,
        robot: Robot,
        x: float,
        y: float,
        heading: float = 0.0,
        *,
        ghost: bool = False,
        environments: Sequence[int] | None = None,
    ) -> int:
        """Add a robot, at rest on the floor; see :class:`World`."""
        check_robot_place(robot, x, y, heading)
        agent = self.scene.shape[1]
        self.place_robot(agent, robot, (x, y, heading), ghost, bool(chosen_environments(1, environments)))
        return agent

    def place_robot(
        self, agent: int, robot: Robot, place: tuple[float, float, float], ghost: bool, present: bool
    ) -> None:
        """Make an agent without a body a robot, which is present or absent."""
        place = (float(place[0]), float(place[1]), math.pi - (math.pi - float(place[2])) % (2.0 * math.pi))
        if present:
            starts = {**self.rigid.starts, agent: RobotStart(agent, robot, *place)}
            self.rigid.change(starts=starts, ghosts=[*self.rigid.ghosts, *([agent] if ghost else [])])
            self._at[agent] = place
        put_robot_at(self, agent, robot, place, ghost, [0] if present else [])
        if self.falling is not None:
            self.falling.grow(self.people, self.scene.shape[1])
        self._forget()

    def remove_robot(self, agent: int, environments: Sequence[int] | None = None) -> None:
        """Remove a robot and its body; see :class:`World`."""
        chosen = robot_environments(self, agent, environments)
        self.rigid.change(starts={one: start for one, start in self.rigid.starts.items() if one != agent})
        remove_robot_at(self, agent, chosen)
        self._forget()

    @property
    def prop_names(self) -> list[str]:
        """Names of the props on the stage, in their order."""
        return [name for name in self._prop_names if name]

    def add_prop(self, prop: PropBody, name: str = "") -> str:
        """Add a prop, at rest on the floor; see :class:`World`."""
        name = new_prop_name(self._prop_names, name)
        self._change_stage(dataclasses.replace(self.stage, props=(*self.stage.props, prop)))
        self._prop_names = [*self._prop_names, name]
        return name

    def remove_prop(self, name: str) -> None:
        """Remove a prop; see :class:`World`."""
        names = self._prop_names
        number = prop_number(names, name)
        self._change_stage(without_prop(self.stage, number))
        self._prop_names = without_last([*names[:number], "", *names[number + 1 :]])

    def change_walls(self, walls: Walls) -> None:
        """Replace the walls, without the outlines of props; see :class:`World`."""
        self.rigid.change(walls=walls)
        self.scene = self.scene.replace(walls=walls)
        self._outlined = add_rings(walls, self.stage.outlines())
        self._forget()

    def embody_person(self, agent: int, environment: int) -> None:
        """Give a new person a body."""
        self.people.grow(self.scene.shape[1], [agent])
        if self.falling is not None:
            self.falling.grow(self.people, self.scene.shape[1])
        wanted = min(SLOTS, len(self.people.afoot))
        if wanted > self.rigid.slots and not self._slots_fixed:
            self.rigid.change(slots=min(SLOTS, self.rigid.slots + MORE))
        self._forget()

    def _change_stage(self, stage: PhysicsStage) -> None:
        self.rigid.change(stage=stage)
        self.stage, self._outlined = stage, add_rings(self.scene.walls, stage.outlines())
        self._forget()

    def _forget(self) -> None:
        """Drop what was derived from the old bodies."""
        self._renderers, self._plane = {}, None

    def _led_people(self, scene: Scene) -> Ints:
        """Return the agents whose motion comes from outside: avatars, and people on recorded tracks."""
        led = np.zeros(0, dtype=np.int64) if self.avatars is None else self.avatars.agents
        if self.script is None:
            return led
        return np.union1d(led, np.flatnonzero(self.script.follower_mask(scene)[0]))

    def _heading_of(self, agent: int) -> float:
        return float(self.scene.heading[0, agent])

    def _limb_mass_of(self, agent: int, limb: str, point: Floats, normal: Floats) -> float:
        return self.people.limb_mass(agent, limb, point, normal, self._people_bodies.limb_ends(agent))

    def _mass_of(self, party: ContactBody) -> float:
        if party.kind == "robot":
            return self.robot_bodies[party.number].mass
        if party.kind == "person":
            return float(self.people.people.mass[self.people.row[party.number]])
        if (
            party.kind == "wall"
            and party.number < 0
            and (leaf := self.stage.doors[-1 - party.number]).opening == "push"
        ):
            return leaf.mass
        return self.stage.props[party.number].weight if party.kind == "prop" else math.inf
