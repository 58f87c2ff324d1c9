"""Avatars: people and robots whose pose comes from outside, from a function, a recording or a stream."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from crowdbot.core import InputError, Scene, Storage, tree, wrap_angle
from crowdbot.humans import BodyPose, PoseMotion, PoseSource, PoseTrack
from crowdbot.typing import Floats, Ints
from crowdbot.world.robots.drives.drive import Twists

if TYPE_CHECKING:
    from crowdbot.world.physics.people_motion import PeopleMotion


JUMP = 8.0
"""A change of position in a step that needs a higher speed [m/s] is a teleport: nothing on the way is touched."""
TURN_JUMP = 12.0
"""A turn of a robot in a step that needs a higher rate [rad/s] is a teleport as well."""
AHEAD = 10.0
"""Longest time [s] between a sample and the current time that is used for interpolation."""


class Avatars:
    """The avatars of a world in E environments. To crowd models they are external agents, like robots.

    Robots can be avatars, too: they are where their source says, and their drives and commands have no effect.

    Args:
        agents: index of each avatar ``[K]``.
        names: name of each avatar.
        sources: source of each avatar in each environment ``[E][K]``.
        delay: time [s] by which each avatar follows its source later ``[K]``.
        robots: those of ``agents`` that are robots.
        external: names of the avatars whose samples come from outside while the world runs.

    Attributes:
        rows: latest pose of each avatar ``[E, K, 139]``, see :meth:`crowdbot.humans.BodyPose.row`.

    >>> track = PoseTrack.of([0.0, 1.0], [BodyPose(0, 0), BodyPose(1, 2)])
    >>> avatars = Avatars([1], ["guide"], [[track]], [0.0])
    >>> scene = avatars.place(Scene.of([[9.0, 9.0], [9.0, 9.0]]), 0.5)
    >>> scene.position[0, 1].tolist(), scene.velocity[0, 1].tolist()
    ([0.5, 1.0], [1.0, 2.0])
    """

    storage = Storage(
        constants=("agents", "names", "sources", "delay", "robots", "_latest", "external"),
        environments=("sources",),
        properties=("streams",),
    )  # fmt: skip

    def __init__(
        self,
        agents: Sequence[int] | Ints,
        names: Sequence[str],
        sources: Sequence[Sequence[PoseSource]],
        delay: Sequence[float],
        robots: Sequence[int] = (),
        external: Iterable[str] = (),
    ) -> None:
        self.external = frozenset(external)
        self.robots = tuple(int(agent) for agent in robots)
        self.agents = np.asarray(agents, dtype=np.int64)
        self.names, self.delay = tuple(names), tuple(float(item) for item in delay)
        self.sources = tree.objects(tuple(row) for row in sources)
        self._latest: dict[tuple[int, float], tuple[PoseSource, PoseMotion]] = {}  # holds sources, so ids are unique
        self.rows = np.zeros((len(self.sources), len(self.agents), len(BodyPose(0.0, 0.0).row())))

    @property
    def people(self) -> Ints:
        """The agents that are persons, without robots."""
        return np.asarray(self.agents[~np.isin(self.agents, self.robots)])

    @property
    def streams(self) -> list[list[PoseSource]]:
        """Sources of the external avatars in each environment; the others do not change."""
        return [
            [source for name, source in zip(self.names, row, strict=True) if name in self.external]
            for row in self.sources
        ]

    @streams.setter
    def streams(self, streams: list[list[PoseSource]]) -> None:
        """Set the sources of the external avatars in each environment."""
        rows = [iter(row) for row in streams]
        self.sources = tree.objects(
            tuple(next(row) if name in self.external else source for name, source in zip(self.names, old, strict=True))
            for row, old in zip(rows, self.sources, strict=True)
        )

    def __deepcopy__(self, memo: Any) -> Avatars:
        """Return an independent copy; sources do not change, so they are shared."""
        return tree.take(self, slice(None))

    def hold(self, scene: Scene) -> Scene:
        """Return the scene with the avatars as external agents."""
        external = scene.external.copy()
        external[:, self.agents] = True
        return scene.replace(external=external)

    def place(self, scene: Scene, time: float | Floats) -> Scene:
        """Return the scene with the avatars where they are at a time [s], one or ``[E]``.

        Raises:
            InputError: a source returns no pose.
        """
        now = np.broadcast_to(np.asarray(time, dtype=np.float64), (scene.shape[0],)).tolist()
        latest, self._latest = self._latest, {}
        position, velocity, heading = scene.position.copy(), scene.velocity.copy(), scene.heading.copy()
        for e, sources in enumerate(self.sources):
            for k, (agent, source, delay) in enumerate(zip(self.agents.tolist(), sources, self.delay, strict=True)):
                key = (id(source), now[e] - delay)
                known = self._latest.get(key) or latest.get(key) or (source, source.motion(key[1]))
                self._latest[key] = known
                motion = known[1]
                row = motion.row
                self.rows[e, k] = row
                position[e, agent] = row[:2]
                velocity[e, agent] = motion.vx, motion.vy
                heading[e, agent] = wrap_angle(row[2])
        return scene.replace(position=position, velocity=velocity, heading=heading)

    def move(
        self, world: Any, earlier: Scene, before: Scene, crowd: Scene, time: float | Floats
    ) -> tuple[Scene, Scene, Scene]:
        """Return the scenes before and after a step of the crowd with the avatars at their new places.

        An avatar that teleports in the step is already at its new place before it. The bodies of people get the new
        poses for the end of the step.

        Args:
            world: the world of the scenes.
            earlier, before: scenes before the last substep of the crowd, and before the step.
            crowd: scene after the step of the crowd.
            time: time at the end of the step [s], one or ``[E]``.
        """
        after, motions = self.place(crowd, time), world.people_motions
        earlier = self._skip_jumps(earlier, after, world.dt, ())
        before = self._skip_jumps(before, after, world.dt, motions)
        for motion, poses in zip(motions, self._poses(), strict=False):
            motion.set_poses(poses)
        return earlier, before, after

    def lead_robots(self, before: Scene, led: Scene, after: Scene, dt: float) -> tuple[Scene, dict[int, Twists]]:
        """Return the scene after a step with its robots where they are led, and their twists.

        Args:
            before: scene before the step, in which teleports are done.
            led: scene with the robots where their sources say.
            after: scene in which drives have moved all robots.
            dt: time step [s].

        >>> track = PoseTrack.of([0.0, 1.0], [BodyPose(0, 0), BodyPose(1, 0)])
        >>> robots = Avatars([0], ["robot/cart"], [[track]], [0.0], [0])
        >>> before = robots.place(Scene.of([[0.0, 0.0]]), 0.0)
        >>> robots.lead_robots(before, robots.place(before, 0.1), before, 0.1)[1][0].at(0).forward
        1.0
        """
        twists: dict[int, Twists] = {}
        if not self.robots:
            return after, twists
        arrays = {name: getattr(after, name).copy() for name in ("position", "velocity", "heading")}
        for agent in self.robots:
            for name, array in arrays.items():
                array[:, agent] = getattr(led, name)[:, agent]
            present = after.active[:, agent]
            arrays["velocity"][~present, agent] = 0.0
            turn = np.where(present, wrap_angle(led.heading[:, agent] - before.heading[:, agent]) / dt, 0.0)
            cos, sin = np.cos(led.heading[:, agent]), np.sin(led.heading[:, agent])
            vx, vy = arrays["velocity"][:, agent].T
            twists[agent] = Twists.of(Twists(cos * vx + sin * vy, turn, cos * vy - sin * vx), len(turn))
        return after.replace(**arrays), twists

    def _skip_jumps(self, before: Scene, after: Scene, dt: float, motions: Sequence[PeopleMotion]) -> Scene:
        step = after.position[:, self.agents] - before.position[:, self.agents]
        jumps = np.sqrt(np.sum(step * step, axis=-1)) > JUMP * dt
        spins = np.zeros_like(jumps)
        robots = np.isin(self.agents, self.robots)
        if robots.any():
            led = self.agents[robots]
            turn = wrap_angle(after.heading[:, led] - before.heading[:, led])
            spins[:, robots] = jumps[:, robots] | (np.abs(turn) > TURN_JUMP * dt)
        if not (jumps.any() or spins.any()):
            return before
        position, heading = before.position.copy(), before.heading.copy()
        for e, k in np.argwhere(jumps).tolist():
            agent = int(self.agents[k])
            position[e, agent] = after.position[e, agent]
            if motions:
                motions[e].move(agent, *step[e, k].tolist())
        for e, k in np.argwhere(spins).tolist():
            heading[e, self.agents[k]] = after.heading[e, self.agents[k]]
        return before.replace(position=position, heading=heading)

    def pose(self, world: Any) -> None:
        """Show the current poses of heads, hands and skeletons on the bodies of people."""
        for motion, poses in zip(world.people_motions, self._poses(), strict=False):
            motion.set_poses(poses)
            motion.take(motion.state)

    def poses(self, environment: int) -> dict[int, Floats]:
        """Return the rows of the avatars with a pose of head, hands or skeleton in an environment, by agent."""
        return list(self._poses())[environment]

    def _poses(self) -> Iterator[dict[int, Floats]]:
        """Yield the rows of the avatars with a pose of head, hands or skeleton, by agent, in each environment."""
        for rows in self.rows:
            given = np.flatnonzero(~np.all(np.isnan(rows[:, 3:]), axis=-1)).tolist()
            yield {int(self.agents[k]): rows[k].copy() for k in given}

    def take(self, environment: int, name: str, time: float, pose: BodyPose, now: float) -> None:
        """Add a sample to the stream of an avatar.

        Args:
            environment: index of the environment.
            name: name of the avatar.
            time: time stamp of the sample [s].
            pose: the pose.
            now: current time [s].
        """
        sources, k = list(self.sources[environment]), self.names.index(name)
        track = sources[k]
        if not isinstance(track, PoseTrack):
            raise InputError(f"avatar {name!r} does not take samples")
        sources[k] = track.with_sample(time, pose, now - self.delay[k] - AHEAD)
        self.sources[environment] = tuple(sources)


def give_pose(world: Any, name: str, time: float, pose: BodyPose, environment: int = 0) -> None:
    """Give a sample to an avatar, which is then where its samples say at the current time.

    Args:
        world: the world.
        name: name of an avatar with a stream.
        time: time stamp of the sample [s].
        pose: the pose.
        environment: index of the environment.

    Raises:
        InputError: the avatar does not take samples.
    """
    own, row = world.part(environment)
    avatars = own.avatars
    if avatars is None or name not in avatars.names:
        raise InputError(f"there is no avatar {name!r}")
    now = world.times
    avatars.take(row, name, time, pose, float(now[environment]))
    before = own.scene
    placed = avatars.place(before, now if own is world else now[environment])
    own.scene = placed
    for e, motion in enumerate(own.people_motions):
        for agent in avatars.agents.tolist():
            motion.move(agent, *(placed.position[e, agent] - before.position[e, agent]).tolist())
