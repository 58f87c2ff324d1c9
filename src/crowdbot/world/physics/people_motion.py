"""PeopleMotion: bodies, gaits and limb poses of the people in a scene."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import GESTURES, InputError, Scene, Storage, stream
from crowdbot.humans import (
    ACTIVITIES,
    CHAIR,
    LIMBS,
    WHEELCHAIR,
    FallPose,
    Gait,
    Gaits,
    People,
    Posture,
    ankle_positions,
    fall_postures,
    reach_poses,
    stand_on_ground,
    striking_mass,
)
from crowdbot.typing import Floats, Ints
from crowdbot.world.ground.ground import Ground
from crowdbot.world.reactions.robot_reactions import gesture_codes

NAMES = tuple(limb.name for limb in LIMBS)
SOLE, STEEP = 0.06, 2.0
"""A foot stands on the highest ground within ``SOLE`` [m] of the ankle, and rises ahead of an edge with this slope."""
LOOK, GAZE = ACTIVITIES.index("look"), 0.9
"""The activity of looking at the nearest robot, and the height [m] of the point looked at."""
SIGNALS = np.array([ACTIVITIES.index(f"signal-{name}") if name != "none" else -1 for name in GESTURES])
"""Activity that shows each gesture."""
FASTEST = 11.9
"""Upper limit of the walking speed [m/s] for gaits."""


class LimbCapsules(NamedTuple):
    """Capsules of the limbs of people, E = 1; the field names are those of bodies in a scene.

    Fields:
        start, end: ends ``[1, B, 3]`` [m].
        radius: ``[1, B]`` [m], 0 for absent people.
        owner: agent of each capsule ``[B]``.
        part: index into ``parts`` ``[B]``.
        parts: names of the limbs.
    """

    start: Floats
    end: Floats
    radius: Floats
    owner: Ints
    part: Ints
    parts: tuple[str, ...]


class PeopleMotion:
    """Bodies and gaits of the people in a scene.

    Args:
        scene: initial scene, E = 1.
        agents: indices of the agents that are people.
        people: bodies of ``agents``, followed by ``riders``; None samples adults.
        seed: seed of bodies and gaits.
        riders: agents of type ``wheelchair`` with a rider; sensors see the rider as part of the robot.
        ground: uneven ground on which they walk; None: level.

    Attributes:
        agents: agents of people, then of wheelchairs with riders; afoot: without wheelchairs.
        people: bodies; state: current poses.
        usual: index of the activity of each while they make no gesture.

    Raises:
        InputError: the number of bodies is wrong.
    """

    storage = Storage(constants=("agents", "people", "row", "gait", "radius", "ground", "usual"))

    def __init__(
        self, scene: Scene, agents: Ints, people: People | None = None, seed: int = 0, riders: Sequence[int] = (),
        ground: Ground | None = None,
    ) -> None:  # fmt: skip
        self.afoot, self.ground = agents, ground
        self.agents = agents = np.concatenate([agents, np.array(riders, dtype=np.int64)])
        self.people = People.sample(len(agents), stream(seed, "people")) if people is None else people
        if len(self.people) != len(agents):
            raise InputError(
                f"people: {len(self.people)} bodies are given for {len(agents)} agents that are not robots;"
                " give one for each"
            )
        self.row = np.full(scene.shape[1], -1, dtype=np.int64)
        self.row[agents] = np.arange(len(agents))
        self.poses: Mapping[int, Floats] = {}
        self.fallen: Mapping[int, FallPose] = {}
        """Poses of people out of balance at the end of the latest step, by row."""
        self._targets: Mapping[int, Floats] = {}
        self.gait = self._new_gait(seed, range(len(agents)))
        place, velocity, heading = self._of(scene)
        self.state: Gaits = self.gait.start(place, heading, velocity, self._busy("walk"))
        self.usual: Ints = self.state.wish.astype(np.int64)
        self.ends, self.radius = self._measured(self.state)

    def grow(self, agents: int, new: Sequence[int] = ()) -> None:
        """Add agents, of which ``new`` are people with a random adult body; nothing changes for the others.

        Args:
            agents: number of agents afterwards.
            new: indices of the new people. The body and the gait of a person depend on the seed and this index.
        """
        self.row = np.pad(self.row, (0, max(0, agents - len(self.row))), constant_values=-1)
        new = [agent for agent in new if self.row[agent] < 0]
        if not new:
            return
        first, seed = len(self.afoot), self.gait.seed
        more = [People.sample(1, stream(seed, "people", "agent", agent)) for agent in new]
        persons, variation = self.people.persons, np.concatenate([item.variation for item in more])
        self.people = People(
            (*persons[:first], *(item.persons[0] for item in more), *persons[first:]),
            np.insert(self.people.variation, first, variation),
            np.insert(self.people.height, first, np.concatenate([item.height for item in more])),
            self.people.clips,
            self.people.own,
        )
        numbers = list(self.gait.ids or ())
        following = max(numbers, default=-1) + 1
        numbers[first:first] = range(following, following + len(new))
        self.afoot = np.concatenate([self.afoot, np.array(new, dtype=np.int64)])
        self.agents = np.insert(self.agents, first, new)
        self.row[self.agents] = np.arange(len(self.agents))
        self.gait = self._new_gait(seed, numbers)
        self._start_rows(slice(first, first + len(new)))

    def _new_gait(self, seed: int, numbers: Sequence[int]) -> Gait:
        seats = [CHAIR] * len(self.afoot) + [WHEELCHAIR] * (len(self.agents) - len(self.afoot))
        return Gait(self.people, seed, ids=list(numbers), seat=seats)

    def _start_rows(self, rows: slice) -> None:
        """Insert the states of new people, who stand at the origin until they are present."""
        count = len(self.agents)
        fresh = self.gait.start(np.zeros((count, 2)), np.zeros(count))
        ends, radius = self._measured(fresh)

        def joined(old: NDArray[Any], start: NDArray[Any]) -> NDArray[Any]:
            return np.concatenate([old[: rows.start], start[rows], old[rows.start :]])

        self.state = type(self.state)(*(joined(old, new) for old, new in zip(self.state, fresh, strict=True)))
        self.usual = joined(self.usual, fresh.wish.astype(np.int64))
        self.ends, self.radius = joined(self.ends, ends), joined(self.radius, radius)

    def begin(self, scene: Scene, activity: str | Sequence[str]) -> None:
        """Restart at the poses in ``scene``, with one activity for all or one for each person.

        Riders always sit; activities are those of ``afoot``.
        """
        place, velocity, heading = self._of(scene)
        self.take(self.gait.start(place, heading, velocity, self._busy(activity)))
        self.usual = self.state.wish.astype(np.int64)

    def _busy(self, activity: str | Sequence[str]) -> list[str]:
        own = [activity] * len(self.afoot) if isinstance(activity, str) else list(activity)
        return [*own, *["sit"] * (len(self.agents) - len(self.afoot))]

    def walk(self, scene: Scene, dt: float) -> None:
        """Walk to the positions in ``scene`` within ``dt`` [s]."""
        self.take(self.next_state(scene, dt))

    def next_state(self, scene: Scene, dt: float) -> Gaits:
        """Return the body states after ``dt`` [s] at the positions in ``scene``, with the gestures of its people."""
        place, velocity, heading = self._of(scene)
        codes, shown = gesture_codes(scene), None
        if codes is not None:
            own = codes[0, self.agents]
            shown = np.where(own > 0, SIGNALS[own], self.usual)
        return self.gait.step(self.state, place, velocity, heading, dt, shown)

    def take(self, state: Gaits, ends: Floats | None = None) -> None:
        """Set the state; ``ends`` are its limb ends, if known."""
        self.state = state
        self.ends = self._measured(state)[0] if ends is None else ends

    def set_poses(self, poses: Mapping[int, Floats]) -> None:
        """Set the poses ``[139]`` of agents for the next state, see :meth:`crowdbot.humans.BodyPose.row`."""
        self.poses = {int(self.row[agent]): row for agent, row in poses.items()}

    def fall_poses(self, active: NDArray[np.bool_]) -> dict[int, FallPose]:
        """Return the poses of the people out of balance who are present, ``active`` ``[A]``, by agent."""
        found = {int(self.agents[row]): pose for row, pose in self.fallen.items()}
        return {agent: found[agent] for agent in sorted(found) if active[agent]}

    def move(self, agent: int, dx: float, dy: float) -> None:
        """Move the limbs of an agent that is elsewhere at once [m]."""
        if (dx or dy) and self.row[agent] >= 0:
            self.ends = self.ends.copy()
            self.ends[self.row[agent]] += (dx, dy, 0.0, dx, dy, 0.0)

    def posture(self, state: Gaits | None = None) -> Posture:
        """Return the posture of all people, by default the current one."""
        state = self.state if state is None else state
        walking = self.gait.posture(state, self._targets)
        if self.ground is not None:
            under = self.ground.support(ankle_positions(walking)[..., :2], SOLE, STEEP)
            walking = stand_on_ground(walking, self.people, state.yaw, under)
        if self.fallen:
            walking = fall_postures(walking, self.people, state.yaw, self.fallen)
        return reach_poses(walking, self.people, self.poses) if self.poses else walking

    def skin(self, level: int, numbers: Ints | None = None) -> Floats:
        """Return the current vertices ``[N, V, 3]`` [m] of people, by default all, at a level of detail."""
        return self.people.skin(self.posture(), level, numbers)

    def ends_of(self, state: Gaits) -> Floats:
        """Return both ends of all limbs ``[N, L, 6]`` [m] in the world."""
        return self._measured(state)[0]

    def relative_ends(self, scene: Scene, ends: Floats | None = None) -> Floats:
        """Return the limb ends of all agents ``[A, L, 6]`` [m] relative to their positions in a scene.

        Args:
            scene: the scene.
            ends: limb ends of all people in the world; None: the current ones.
        """
        points = self.ends if ends is None else ends
        result = np.zeros((scene.shape[1], *points.shape[1:]))
        place = np.pad(scene.position[0, self.agents], ((0, 0), (0, 1)))
        result[self.agents] = points - np.tile(place, 2)[:, None]
        return result

    def limb_mass(self, agent: int, limb: str, point: Floats, normal: Floats, ends: Floats | None = None) -> float:
        """Return the mass [kg] that a limb of a person has in an impact, see :func:`crowdbot.humans.striking_mass`.

        Args:
            agent: the person.
            limb: name of the limb.
            point: point of contact ``[3]`` [m].
            normal: unit vector ``[3]`` of the impact.
            ends: limb ends of the person ``[L, 6]`` [m]; None: the current ones.
        """
        row = self.row[agent]
        ends = self.ends[row] if ends is None else ends
        start, end = ends[:, :3], ends[:, 3:]
        way = end[NAMES.index(limb)] - start[NAMES.index(limb)]
        share = float((point - start[NAMES.index(limb)]) @ way) / max(float(way @ way), 1e-12)
        return striking_mass(start, end, self.people.limb_mass[row], limb, min(max(share, 0.0), 1.0), normal)

    def limbs(self, active: NDArray[np.bool_]) -> LimbCapsules:
        """Return the capsules of all people.

        Args:
            active: ``[A]`` which agents are present.
        """
        count = len(self.agents) * len(LIMBS)
        there = np.where(active[self.agents, None], self.radius, 0.0)
        return LimbCapsules(
            self.ends[..., :3].reshape(1, count, 3),
            self.ends[..., 3:].reshape(1, count, 3),
            there.reshape(1, count),
            np.repeat(self.agents, len(LIMBS)),
            np.tile(np.arange(len(LIMBS)), len(self.agents)),
            NAMES,
        )

    def _of(self, scene: Scene) -> tuple[Floats, Floats, Floats]:
        here = scene.active[0, self.agents]
        self._targets = self._nearest_robots(scene)
        place = np.where(here[:, None], scene.position[0, self.agents], 0.0)
        velocity = np.where(here[:, None], scene.velocity[0, self.agents], 0.0)
        speed = np.sqrt(np.sum(velocity * velocity, axis=1, keepdims=True))
        velocity = velocity * np.minimum(1.0, FASTEST / np.maximum(speed, 1e-9))
        return place, velocity, np.where(here, scene.heading[0, self.agents], 0.0)

    def _nearest_robots(self, scene: Scene) -> dict[int, Floats]:
        """Return the point ``[3]`` [m] of the nearest robot, by row of each person who looks at robots."""
        rows = np.flatnonzero(self._looks) if len(self._looks) == len(self.agents) else np.empty(0, dtype=np.int64)
        robots = np.flatnonzero(scene.active[0] & scene.external[0])
        robots = robots[self.row[robots] < 0]
        nearest_robots = {}
        for row in rows:
            away = scene.position[0, robots] - scene.position[0, self.agents[row]]
            if len(away):
                place = scene.position[0, robots[int(np.argmin(np.sum(away * away, axis=1)))]]
                nearest_robots[int(row)] = np.array([place[0], place[1], GAZE])
        return nearest_robots

    @property
    def _looks(self) -> NDArray[np.bool_]:
        state = getattr(self, "state", None)
        return np.zeros(0, dtype=np.bool_) if state is None else state.wish == LOOK

    def _measured(self, state: Gaits) -> tuple[Floats, Floats]:
        limbs = self.people.limbs(self.posture(state))
        return np.concatenate([limbs.start, limbs.end], axis=-1), limbs.radius
