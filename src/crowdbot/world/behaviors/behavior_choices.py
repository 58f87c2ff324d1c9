"""BehaviorChoices: conditions and actions of behaviour trees in a scene, and what people choose in a step."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Scene
from crowdbot.typing import Bools, Floats
from crowdbot.world.crowd.agent_arrays import BOOL, FLOAT, dense
from crowdbot.world.crowd.journey import JOURNEY, STOP, JourneyAssignment
from crowdbot.world.reactions.reaction_kernel import find_robot

from .behavior_tree import FAILURE, RUNNING, SUCCESS, BehaviorTree, Node, Statuses
from .node_kinds import NEEDS_ROBOT

NEAR = 0.3
"""Distance [m] within which a person without a journey is at their goal."""
STAND, WALK, REACT = 0, 1, 2
"""What a person does in a step: stand, walk to the goal, or follow a reaction."""


class BehaviorChoices:
    """What the people of a scene choose when their trees are ticked; the last action of a tick counts.

    Args:
        scene: scene at the start of a step, with the goals of people, not the next points of their paths.
        robots: indices of the robots.
        journeys: journeys of people, None without.
        dt: time step [s].

    Attributes:
        motion: ``[N]`` what each person does, N = E A.
        rule: ``[N]`` index of the reaction that is followed, -1 for none.
        target: ``[N]`` agent that is followed, approached or avoided, in the environment of the person.
        face: ``[N, 2]`` vector to which people who stand turn, 0 for none.
        next_stop: ``[N]`` who takes the next stop of their journey.
    """

    def __init__(self, scene: Scene, robots: Sequence[int], journeys: JourneyAssignment | None, dt: float) -> None:
        self.scene, self.journeys, self.dt = scene, journeys, dt
        shape = self.shape = scene.shape
        count = shape[0] * shape[1]
        self.robots = np.array(robots, dtype=np.int64)
        self.position, self.goal = dense(scene.position, (*shape, 2), FLOAT), dense(scene.goal, (*shape, 2), FLOAT)
        self.active, self.visible = dense(scene.active, shape, BOOL), dense(scene.visible, shape, BOOL)
        self.people = np.greater(scene.active, scene.external)
        self.group = np.broadcast_to(scene.group, shape)
        self.ahead = np.stack([np.cos(scene.heading), np.sin(scene.heading)], axis=-1)
        self.edges = np.ascontiguousarray(scene.walls.segments())
        self.motion = np.full(count, STAND, dtype=np.int64)
        self.rule = np.full(count, -1, dtype=np.int64)
        self.target = np.zeros(count, dtype=np.int64)
        self.face = np.zeros((count, 2))
        self.next_stop = np.zeros(count, dtype=np.bool_)
        self._rules: dict[int, int] = {}

    def tick(self, tree: BehaviorTree, first: int, state: Floats, who: Bools) -> None:
        """Tick the tree of some people once.

        Args:
            tree: the tree.
            first: index of its first reaction in the table of reactions.
            state: ``[N, width]``, modified in place.
            who: ``[N]``.

        Raises:
            InputError: a node reads an entry that nothing has written.
        """
        acting = [node.slot for node in tree.nodes if node.reaction is not None]
        self._rules = {slot: first + 1 + number for number, slot in enumerate(acting)}
        self._rules[-1] = first
        tree.tick(state, who, self._leaf)
        walks = who & self.next_stop & (self.motion == STAND)
        self._walk(walks)

    def _leaf(self, node: Node, who: Bools, inputs: Mapping[str, Floats], kept: Floats) -> Statuses:
        """Tick a condition or an action, see :data:`.behavior_tree.Leaf`."""
        if node.kind in NEEDS_ROBOT:
            return self._react(node, who, self._nearest_robot(who))
        if node.kind in self._TIMERS:
            found: Statuses = self._TIMERS[node.kind](self, who, inputs, kept)
        else:
            found = self._LEAVES[node.kind](self, node, who, inputs)
        return found

    def _each(self, who: Bools) -> list[tuple[int, int, int]]:
        """Return number, environment and agent of some people."""
        return [(n, *divmod(n, self.shape[1])) for n in np.flatnonzero(who).tolist()]

    def _check(self, who: Bools, holds: Bools) -> Statuses:
        return np.where(holds & who, SUCCESS, FAILURE).astype(np.int8)

    def _stand(self, who: Bools) -> None:
        self.motion[who], self.rule[who], self.face[who] = STAND, -1, 0.0

    def _walk(self, who: Bools) -> None:
        self._stand(who)
        self.motion[who], self.rule[who] = WALK, self._rules[-1]

    def _react(self, node: Node, who: Bools, target: NDArray[np.int64]) -> Statuses:
        """Let people follow the reaction of a node to the agents ``target`` ``[N]``; -1 fails."""
        able = who & (target >= 0)
        self._stand(able)
        self.motion[able], self.rule[able], self.target[able] = REACT, self._rules[node.slot], target[able]
        return self._check(who, able)

    # conditions

    def _robot_visible(self, node: Node, who: Bools, inputs: Mapping[str, Floats]) -> Statuses:
        holds = np.zeros(len(who), dtype=np.bool_)
        for n, e, a in self._each(who):
            row = np.zeros(8)
            row[0], row[7] = inputs["distance"][n], math.cos(0.5 * inputs["field_of_view"][n])
            people = (self.position, self.ahead, self.active, self.visible)
            holds[n] = find_robot(e, a, row, *people, self.robots, self.edges) >= 0
        return self._check(who, holds)

    def _robot_near(self, node: Node, who: Bools, inputs: Mapping[str, Floats]) -> Statuses:
        robot = self._nearest_robot(who)
        return self._check(who, (robot >= 0) & (self._distance_to(robot) <= inputs["distance"]))

    def _person_near(self, node: Node, who: Bools, inputs: Mapping[str, Floats]) -> Statuses:
        return self._check(who, self._nearest_person(who, inputs["distance"]) >= 0)

    def _group_behind(self, node: Node, who: Bools, inputs: Mapping[str, Floats]) -> Statuses:
        holds = np.zeros(len(who), dtype=np.bool_)
        for n, e, a in self._each(who):
            others = self._group_of(e, a)
            far = np.hypot(*(self.position[e, others] - self.position[e, a]).T) > inputs["distance"][n]
            left = np.hypot(*(self.position[e, others] - self.goal[e, a]).T)
            holds[n] = bool(np.any(far & (left > math.hypot(*(self.position[e, a] - self.goal[e, a])))))
        return self._check(who, holds)

    def _goal_reached(self, node: Node, who: Bools, inputs: Mapping[str, Floats]) -> Statuses:
        at = np.hypot(*np.moveaxis(self.position - self.goal, -1, 0)) < NEAR
        mine = who.reshape(self.shape)
        if self.journeys is not None:
            led = self.scene.memory[JOURNEY] >= 0.0
            at = np.where(led, self.journeys.reached(self.scene, mine & led), at)
        return self._check(who, at.ravel())

    def _expired(self, who: Bools, inputs: Mapping[str, Floats], kept: Floats) -> Statuses:
        kept[who] += inputs["ts"][who]
        done = kept >= inputs["seconds"]
        kept[who & done & (inputs["only_once"] == 0.0)] = 0.0
        return self._check(who, done)

    # actions

    def _regular(self, node: Node, who: Bools, inputs: Mapping[str, Floats]) -> Statuses:
        self._walk(who)
        if node.reaction is not None:
            self.rule[who] = self._rules[node.slot]
        return self._check(who, who)

    def _update_goal(self, node: Node, who: Bools, inputs: Mapping[str, Floats]) -> Statuses:
        able = np.zeros(len(who), dtype=np.bool_)
        if self.journeys is not None:
            able = who & self.journeys.under_way(self.scene).ravel()
        self.next_stop |= able
        return self._check(who, able)

    def _stand_still(self, node: Node, who: Bools, inputs: Mapping[str, Floats]) -> Statuses:
        self._stand(who)
        return self._check(who, who)

    def _wait(self, who: Bools, inputs: Mapping[str, Floats], kept: Floats) -> Statuses:
        done = kept >= inputs["seconds"] - 1e-9
        self._stand(who & ~done)
        kept[who] = np.where(done, 0.0, kept + self.dt)[who]
        return np.where(done, SUCCESS, RUNNING).astype(np.int8)

    def _talk(self, who: Bools, inputs: Mapping[str, Floats], kept: Floats) -> Statuses:
        able, face = np.zeros(len(who), dtype=np.bool_), np.zeros((len(who), 2))
        for n, e, a in self._each(who):
            others = self._group_of(e, a)
            if len(others):
                able[n], face[n] = True, self.position[e, others].mean(axis=0) - self.position[e, a]
        done = kept >= inputs["seconds"] - 1e-9
        talks = able & (~done | (inputs["seconds"] == 0.0))
        self._stand(talks)
        self.face[talks] = face[talks]
        kept[who] = np.where(able & ~done, kept + self.dt, 0.0)[who]
        return np.where(able, np.where(done, SUCCESS, RUNNING), FAILURE).astype(np.int8)

    def _queue(self, node: Node, who: Bools, inputs: Mapping[str, Floats]) -> Statuses:
        target = np.full(len(who), -1, dtype=np.int64)
        for n, e, a in self._each(who):
            others = np.flatnonzero(self._same_aim(e, a))
            mine = math.hypot(*(self.position[e, a] - self.goal[e, a]))
            ahead = others[np.hypot(*(self.position[e, others] - self.goal[e, a]).T) < mine]
            target[n] = self._nearest(e, a, ahead, math.inf)
        self._walk(who & (target < 0))
        self._react(node, who, target)
        return self._check(who, who)

    def _to_person(self, node: Node, who: Bools, inputs: Mapping[str, Floats]) -> Statuses:
        return self._react(node, who, self._nearest_person(who, inputs["distance"]))

    def _always(self, node: Node, who: Bools, inputs: Mapping[str, Floats]) -> Statuses:
        return self._check(who, who if node.kind == "AlwaysSuccess" else ~who)

    _TIMERS: ClassVar[dict[str, Any]] = {"TimeExpiredCondition": _expired, "Wait": _wait, "TalkInGroup": _talk}
    _LEAVES: ClassVar[dict[str, Any]] = {
        "AlwaysSuccess": _always, "AlwaysFailure": _always,
        "IsRobotVisible": _robot_visible, "IsRobotNear": _robot_near, "IsPersonNear": _person_near,
        "IsGroupBehind": _group_behind, "IsGoalReached": _goal_reached,
        "RegularNav": _regular, "IgnoreRobot": _regular, "ImpassiveNav": _regular, "UpdateGoal": _update_goal,
        "StandStill": _stand_still, "QueueNav": _queue,
        "FollowPerson": _to_person, "ApproachPerson": _to_person,
    }  # fmt: skip

    # who is where

    def _distance_to(self, target: NDArray[np.int64]) -> Floats:
        """Return the distance of each person to an agent of their environment ``[N]`` [m]."""
        e = np.repeat(np.arange(self.shape[0]), self.shape[1])
        away = self.position[e, target] - self.position.reshape(-1, 2)
        far: Floats = np.hypot(away[:, 0], away[:, 1])
        return far

    def _nearest_robot(self, who: Bools) -> NDArray[np.int64]:
        """Return the nearest robot that can be seen of each person ``[N]``, -1 for none."""
        found = np.full(len(who), -1, dtype=np.int64)
        for n, e, a in self._each(who):
            there = self.robots[self.active[e, self.robots] & self.visible[e, self.robots]]
            found[n] = self._nearest(e, a, there, math.inf)
        return found

    def _nearest_person(self, who: Bools, distance: Floats) -> NDArray[np.int64]:
        """Return the nearest other person within a distance ``[N]`` [m], -1 for none."""
        found = np.full(len(who), -1, dtype=np.int64)
        for n, e, a in self._each(who):
            others = np.flatnonzero(self.people[e])
            found[n] = self._nearest(e, a, others[others != a], float(distance[n]))
        return found

    def _nearest(self, e: int, a: int, others: NDArray[np.int64], distance: float) -> int:
        if not len(others):
            return -1
        far = np.hypot(*(self.position[e, others] - self.position[e, a]).T)
        best = int(np.argmin(far))
        return int(others[best]) if far[best] <= distance else -1

    def _group_of(self, e: int, a: int) -> NDArray[np.int64]:
        """Return the other members of the group of a person."""
        if self.group[e, a] < 0:
            return np.zeros(0, dtype=np.int64)
        others = np.flatnonzero(self.people[e] & (self.group[e] == self.group[e, a]))
        rest: NDArray[np.int64] = others[others != a]
        return rest

    def _same_aim(self, e: int, a: int) -> Bools:
        """Return ``[A]`` which other people walk to the same stop, or to the same goal without a journey."""
        memory = self.scene.memory
        others: Bools = self.people[e].copy()
        others[a] = False
        if JOURNEY in memory and memory[JOURNEY][e, a] >= 0.0:
            for name in (JOURNEY, STOP):
                others &= memory[name][e] == memory[name][e, a]
        else:
            others &= np.all(self.goal[e] == self.goal[e, a], axis=-1)
        return others
