"""RobotReactions: reactions and behaviour trees of a crowd, as a layer between routing and crowd model."""

from __future__ import annotations

import functools
import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import GESTURES, InputError, Scene, wrap_angle
from crowdbot.typing import Bools, Floats
from crowdbot.world.behaviors.behavior_choices import REACT, STAND, BehaviorChoices
from crowdbot.world.behaviors.behavior_tree import PERSON, STEP, BehaviorTree
from crowdbot.world.crowd.agent_arrays import BOOL, FLOAT, dense
from crowdbot.world.crowd.journey import GOES_ON, HOLD, HOLDS, JOURNEY
from crowdbot.world.crowd.people_flow import PeopleFlow
from crowdbot.world.crowd.person_random import uniform

from .reaction import REACTIONS, RobotReaction
from .reaction_kernel import SLOW, choose_motion, update_states

Step = Callable[[Scene, float], Scene]

REACTION, REACTION_STATE = "reaction", "reaction_state"
"""Names in the memory of a scene. ``[E, A]``: 1 + the index of the reaction of a person, -1 for none, 0 if it is not
drawn yet. ``[E, A, 4]``: code of the reaction in force (0: none), time left of it or of the pause [s], index of the
robot, time for which the robot has been out of sight [s].
"""
BEHAVIOR, BEHAVIOR_STATE = "behavior", "behavior_state"
"""Names in the memory of a scene with behaviour trees. ``[E, A]``: 1 + the index of the tree of a person, 0 for none.
``[E, A, S]``: state of the tree, see :meth:`BehaviorTree.begin`.
"""
WAIT = GESTURES.index("wait")
GESTURE = "gesture"
"""Name in the memory of a scene in which people can make gestures. ``[E, A]``: index in :data:`GESTURES`."""
AHEAD = 2.0
"""Time [s] that a goal lies ahead of a person who reacts."""
STILL = 0.2
"""Speed [m/s] below which people turn on the spot."""
TURN = 2.5
"""Turn rate of a person who turns to a robot [rad/s]."""
ASIDE = math.pi / 4.0
"""Largest angle [rad] between the walking direction and the body of a person who looks at a robot."""


class _Choice(NamedTuple):
    """What people with and without behaviour trees do in a step.

    Fields:
        memory: memory of the scene, in which reactions to other people are left out.
        rule: ``[E, A]`` 1 + the index of the reaction of each person, -1 for none.
        state: ``[E, A, 4]`` states of reactions, see :data:`REACTION_STATE`.
        stands: ``[E, A]`` who stands by their tree.
        face: ``[E, A, 2]`` vector to which they turn.
    """

    memory: dict[str, Any]
    rule: Floats
    state: Floats
    stands: Bools
    face: Floats


@dataclass(frozen=True)
class RobotReactions:
    """Which people react to robots, and how, and who has a behaviour tree.

    A behaviour tree is ticked once in each step, and chooses a reaction, the walk to the goal, or a stop. People whose
    reaction chooses their way do not keep the gap to robots that their model has beside that.

    Each person draws one of the reactions or trees of their group, or none, by a random number that depends only on
    the seed and their id. Reactions change the goal and the preferred speed that the crowd model gets, so they work
    with every model. People with the reactions ``ignore`` and ``impassive`` take their step from a second call of the
    model, without robots or with robots that stand still.

    Fields:
        groups: groups of people: pairs of a reaction or a :class:`BehaviorTree` and its share in the group. The sum of
            the shares is at most 1; the rest does not react.
        members: group of each initial agent ``[A]``, -1 for none.
        sources: group of the people of each source, -1 for none.

    Raises:
        InputError: a share is not from 0 to 1, their sum is larger, or a group does not exist.

    >>> groups = ([(RobotReaction("curious"), 0.25), (RobotReaction("scared"), 0.75)],)
    >>> reactions = RobotReactions(groups, members=[0, 0, -1])
    >>> reactions.reactions[0].kind, len(reactions.reactions)
    ('curious', 2)
    """

    groups: Sequence[Sequence[tuple[RobotReaction | BehaviorTree, float]]]
    members: Sequence[int] = ()
    sources: Sequence[int] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "groups", tuple(tuple(group) for group in self.groups))
        for name in ("members", "sources"):
            numbers = np.asarray(getattr(self, name), dtype=np.int64)
            object.__setattr__(self, name, tuple(numbers.tolist()))
            if numbers.size and not -1 <= numbers.min() <= numbers.max() < len(self.groups):
                raise InputError(f"RobotReactions: {name} must be from -1 to {len(self.groups) - 1}")
        for group in self.groups:
            shares = [float(share) for _, share in group]
            if not all(0.0 <= share <= 1.0 for share in shares) or sum(shares) > 1.0 + 1e-9:
                raise InputError(f"RobotReactions: the shares {shares} must be from 0 to 1, and at most 1 together")

    @functools.cached_property
    def reactions(self) -> tuple[RobotReaction, ...]:
        """The reactions of all groups and those that their trees choose, in order."""
        return tuple(
            reaction for group in self.groups for item, _ in group
            for reaction in (item.reactions if isinstance(item, BehaviorTree) else (item,))
        )  # fmt: skip

    @functools.cached_property
    def trees(self) -> tuple[BehaviorTree, ...]:
        """The behaviour trees of all groups, in order."""
        return tuple(item for group in self.groups for item, _ in group if isinstance(item, BehaviorTree))

    @functools.cached_property
    def _table(self) -> tuple[NDArray[np.int64], Floats]:
        rows = [
            (reaction.distance, reaction.duration, reaction.pause, reaction.speed, reaction.gap,
             reaction.repulsion, reaction.range, math.cos(0.5 * reaction.field_of_view))
            for reaction in self.reactions
        ]  # fmt: skip
        codes = np.array([reaction.code for reaction in self.reactions], dtype=np.int64)
        return codes, np.array(rows, dtype=np.float64).reshape(-1, 8)

    @functools.cached_property
    def _windows(self) -> Floats | None:
        """Times ``[K, 2]`` [s] between which each reaction can begin; None if all can at any time."""
        rows = np.array([(reaction.begin, reaction.end) for reaction in self.reactions]).reshape(-1, 2)
        return rows if np.any(rows != (0.0, math.inf)) else None

    @functools.cached_property
    def _gestures(self) -> NDArray[np.int64] | None:
        """Index of the gesture of each reaction ``[K]``; None if there is none."""
        codes = np.array([GESTURES.index(reaction.gesture) for reaction in self.reactions], dtype=np.int64)
        return codes if np.any(codes) else None

    def start(self, scene: Scene, flow: PeopleFlow) -> Scene:
        """Return the initial scene with the reaction of each initial person in its memory.

        Args:
            scene: the scene.
            flow: seeds and identities of the people.
        """
        group = np.full(scene.shape, -1, dtype=np.int64)
        first = min(len(self.members), scene.shape[1])
        group[:, :first] = self.members[:first]
        who = np.zeros(scene.shape, dtype=np.bool_)
        who[:, :first] = True
        memory = {REACTION: np.zeros(scene.shape), REACTION_STATE: np.zeros((*scene.shape, 4))}
        if self.trees:
            width = max(tree.width for tree in self.trees)
            memory |= {BEHAVIOR: np.zeros(scene.shape), BEHAVIOR_STATE: np.zeros((*scene.shape, width))}
            memory |= {HOLD: np.zeros(scene.shape)}
        if self._gestures is not None:
            memory[GESTURE] = np.zeros(scene.shape)
        return self._assign(scene.replace(memory={**scene.memory, **memory}), group, who & ~scene.external, flow)

    def apply(
        self, scene: Scene, step: Step, robots: Sequence[int], before: Scene, flow: PeopleFlow, dt: float
    ) -> tuple[Scene, Step]:
        """Return the scene for the crowd model with the wishes of people who react, and the step of the model.

        Args:
            scene: the scene at the start of the step, with the next points of paths as goals.
            step: step of the crowd model.
            robots: indices of the robots.
            before: the same scene with the goals of people, and the radii of all bodies without margins.
            flow: seeds and identities of the people.
            dt: time step [s].

        Raises:
            InputError: a behaviour tree reads an entry of its blackboard that nothing has written.
        """
        scene = self._assign_new(scene, flow)
        shape, codes = scene.shape, self._table[0]
        memory, pairs = scene.memory, (*scene.shape, 2)
        rule, state = dense(memory[REACTION], shape, FLOAT), memory[REACTION_STATE].copy()
        if not len(codes) or not (len(robots) or self.trees):
            return scene, step
        ahead = np.stack([np.cos(scene.heading), np.sin(scene.heading)], axis=-1)
        position, active = dense(scene.position, pairs, FLOAT), dense(scene.active, shape, BOOL)
        led = np.zeros(shape, dtype=np.bool_) if not self.trees else memory[BEHAVIOR] > 0.0
        own = np.where(led, -1.0, rule) if self.trees else rule
        some = update_states(
            *self._table, self._able_to_begin(own, state, scene.time), position, ahead, active,
            dense(scene.external, shape, BOOL), dense(scene.visible, shape, BOOL), np.array(robots, dtype=np.int64),
            np.ascontiguousarray(scene.walls.segments()), float(dt), state,
        )  # fmt: skip
        self._end_passed(own, state, before)
        chosen: _Choice | None = None
        if self.trees:
            chosen = self._tick(scene.replace(goal=before.goal), robots, state, flow, dt)
            memory, rule, state = chosen.memory, chosen.rule, chosen.state
            some = some or bool(np.any(led & scene.active))
        else:
            memory = {**memory, REACTION_STATE: state}
        if self._gestures is not None:
            shown = _of_rule(self._gestures, memory[REACTION], 0)
            memory = {**memory, GESTURE: np.where(memory[REACTION_STATE][..., 0] > 0.0, shown, 0.0)}
        scene = scene.replace(memory=memory)
        views = self._views(step, robots, state[..., 0])
        if not some:
            return scene, views
        wish, steers, toward = np.array(scene.desired_velocity(dt)), np.zeros(shape, dtype=np.bool_), np.zeros(pairs)
        choose_motion(
            self._table[1], rule, state, position, dense(scene.velocity, pairs, FLOAT), ahead,
            dense(before.radius, shape, FLOAT), dense(scene.preferred_speed, shape, FLOAT),
            dense(scene.max_speed, shape, FLOAT), active, wish, steers, toward,
        )  # fmt: skip
        stands = np.zeros(shape, dtype=np.bool_) if chosen is None else chosen.stands
        if chosen is not None:
            wish[stands], toward[stands] = 0.0, chosen.face[stands]
        looks = (state[..., 0] == REACTIONS.index("look")) & steers
        follows = _led_by_reaction(views, steers & ~looks)
        return _with_wishes(scene, wish, steers | stands), _turn_after(follows, toward, looks)

    def _able_to_begin(self, rule: Floats, state: Floats, time: float | Floats) -> Floats:
        """Return the rules ``[E, A]`` in which people whose reaction is not in force and cannot begin now have none."""
        if self._windows is None:
            return rule
        now = np.asarray(time, dtype=np.float64).reshape(-1, 1)
        begin, end = (_of_rule(self._windows[:, k], rule, 0.0) for k in (0, 1))
        return np.where((state[..., 0] == 0.0) & ((now < begin) | (now > end)), -1.0, rule)

    def _end_passed(self, rule: Floats, state: Floats, before: Scene) -> None:
        """End the reactions with a gesture in which the one who goes first has passed the other; modifies ``state``."""
        if self._gestures is None:
            return
        gesture = np.where(state[..., 0] > 0.0, _of_rule(self._gestures, rule, 0), 0)
        for e, a in np.argwhere(gesture > 0).tolist():
            robot = int(state[e, a, 2])
            first, second = (a, robot) if gesture[e, a] == WAIT else (robot, a)
            moving = before.velocity[e, first]
            speed = math.hypot(*moving)
            room = float(before.radius[e, first] + before.radius[e, second])
            ahead = (before.position[e, second] - before.position[e, first]) @ moving
            if speed > SLOW and ahead < -room * speed:
                state[e, a, :2], state[e, a, 3] = (0.0, self._table[1][int(rule[e, a]) - 1, 2]), 0.0

    def _tick(self, scene: Scene, robots: Sequence[int], state: Floats, flow: PeopleFlow, dt: float) -> _Choice:
        """Tick the behaviour trees of all people; ``state`` holds the reactions of people without one."""
        shape, memory = scene.shape, scene.memory
        choices = BehaviorChoices(scene, robots, flow.journeys, dt)
        present = scene.active & ~scene.external
        kept = memory[BEHAVIOR_STATE].copy().reshape(shape[0] * shape[1], -1)
        for number, tree in enumerate(self.trees):
            who = (present & (memory[BEHAVIOR] == 1.0 + number)).ravel()
            if not np.any(who):
                continue
            own = kept[:, : tree.width].copy()
            tree.write(own, who, PERSON, flow.ids.ravel().astype(np.float64))
            tree.write(own, who, STEP, dt)
            choices.tick(tree, self._first_of_tree[number], own, who)
            kept[who, : tree.width] = own[who]
        led = (memory[BEHAVIOR] > 0.0) & present
        motion, chosen = choices.motion.reshape(shape), choices.rule.reshape(shape)
        codes = np.append(self._table[0], 0)[chosen]
        rule = np.where(led, np.where(chosen >= 0, 1.0 + chosen, -1.0), memory[REACTION])
        acts = np.zeros((*shape, 4))
        acts[..., 0], acts[..., 2] = codes, np.where(motion == REACT, choices.target.reshape(shape), 0)
        new = np.where(led[..., None], acts, state)
        to_person = led & (motion == REACT) & ~np.isin(choices.target.reshape(shape), np.array(robots, dtype=np.int64))
        shown = np.where(to_person[..., None], 0.0, new)
        hold = np.where(led & choices.next_stop.reshape(shape), GOES_ON, np.minimum(memory[HOLD], HOLDS))
        stays = {REACTION: rule, REACTION_STATE: shown, HOLD: hold}
        stays[BEHAVIOR_STATE] = kept.reshape(memory[BEHAVIOR_STATE].shape)
        return _Choice({**memory, **stays}, rule, new, led & (motion == STAND), choices.face.reshape((*shape, 2)))

    @functools.cached_property
    def _first_of_tree(self) -> list[int]:
        """Index of the first reaction of each tree in the table of reactions."""
        first, found = 0, []
        for item, _ in (row for group in self.groups for row in group):
            if isinstance(item, BehaviorTree):
                found.append(first)
            first += len(item.reactions) if isinstance(item, BehaviorTree) else 1
        return found

    def _assign_new(self, scene: Scene, flow: PeopleFlow) -> Scene:
        """Return the scene with the reactions of people who have entered since the last step."""
        new = (scene.memory[REACTION] == 0.0) & np.greater(scene.active, scene.external)
        if not np.any(new):
            return scene
        group = np.full(scene.shape, -1, dtype=np.int64)
        if self.sources and flow.journeys is not None:
            first = len(flow.journeys.journeys) - len(self.sources)
            source = scene.memory[JOURNEY].astype(np.int64) - first
            group = np.where(source >= 0, np.asarray(self.sources)[np.maximum(source, 0)], -1)
        return self._assign(scene, group, new, flow)

    def _assign(self, scene: Scene, group: NDArray[np.int64], who: NDArray[np.bool_], flow: PeopleFlow) -> Scene:
        """Return the scene in which the people ``who`` of groups ``[E, A]`` have drawn their reactions."""
        luck = uniform(flow.seeds[:, None], flow.ids, "reaction")
        rule, first, number_of_tree = np.where(who, -1.0, scene.memory[REACTION]), 0, 0
        memory = dict(scene.memory)
        if self.trees:
            memory |= {name: np.where(who, 0.0, memory[name]) for name in (BEHAVIOR, HOLD)}
            memory[BEHAVIOR_STATE] = np.where(who[..., None], 0.0, memory[BEHAVIOR_STATE])
        for number, rows in enumerate(self.groups):
            ends = np.cumsum([share for _, share in rows])
            drawn = np.searchsorted(ends, luck, side="right")
            for k, (item, _) in enumerate(rows):
                mine = who & (group == number) & (drawn == k)
                if isinstance(item, BehaviorTree):
                    number_of_tree += 1
                    memory[BEHAVIOR][mine] = number_of_tree
                    memory[BEHAVIOR_STATE][mine, : item.width] = item.begin(1)
                    memory[HOLD][mine] = HOLDS if item.leads_journey else 0.0
                    first += len(item.reactions)
                else:
                    rule, first = np.where(mine, 1.0 + first, rule), first + 1
        state = np.where(who[..., None], 0.0, memory[REACTION_STATE])
        return scene.replace(memory={**memory, REACTION: rule, REACTION_STATE: state})

    def _views(self, step: Step, robots: Sequence[int], code: Floats) -> Step:
        """Return a step in which some people see no robots, or robots that stand still."""
        present = {reaction.kind for reaction in self.reactions}
        views = [kind for kind in ("ignore", "impassive") if kind in present]
        if not views:
            return step

        def look(scene: Scene, dt: float) -> Scene:
            after = step(scene, dt)
            for kind in views:
                who = code == REACTIONS.index(kind)
                after = _merge(after, step(_view(scene, kind, robots), dt), who)
            return after

        return look


def reaction_codes(scene: Scene) -> NDArray[np.int8] | None:
    """Return ``[E, A]`` the code of the reaction in force of each person; None in a world without reactions.

    A code is an index in :data:`REACTIONS`, 0 for none.

    >>> reaction_codes(Scene.of([[0.0, 0.0]])) is None
    True
    """
    state = scene.memory.get(REACTION_STATE)
    if state is None:
        return None
    return np.where(scene.active, state[..., 0], 0.0).astype(np.int8)


def people_by_reaction(scene: Scene, ids: NDArray[np.int64]) -> dict[str, list[int]] | None:
    """Return the ids of the people with a reaction in force, by kind; None in a world without reactions.

    Args:
        scene: scene with E = 1.
        ids: ``[A]`` identities.

    >>> people_by_reaction(Scene.of([[0.0, 0.0]]), np.array([7])) is None
    True
    """
    return _people_by_code(reaction_codes(scene), REACTIONS, ids)


def gesture_codes(scene: Scene) -> NDArray[np.int8] | None:
    """Return ``[E, A]`` the code of the gesture that each person makes; None in a world without gestures.

    A code is an index in :data:`crowdbot.core.GESTURES`, 0 for none.

    >>> gesture_codes(Scene.of([[0.0, 0.0]])) is None
    True
    """
    codes = scene.memory.get(GESTURE)
    if codes is None:
        return None
    return np.where(scene.active, codes, 0.0).astype(np.int8)


def people_by_gesture(scene: Scene, ids: NDArray[np.int64]) -> dict[str, list[int]] | None:
    """Return the ids of the people who make a gesture, by its name; None in a world without gestures.

    Args:
        scene: scene with E = 1.
        ids: ``[A]`` identities.

    >>> people_by_gesture(Scene.of([[0.0, 0.0]]), np.array([7])) is None
    True
    """
    return _people_by_code(gesture_codes(scene), GESTURES, ids)


def _people_by_code(
    codes: NDArray[np.int8] | None, names: Sequence[str], ids: NDArray[np.int64]
) -> dict[str, list[int]] | None:
    if codes is None:
        return None
    present = sorted({int(code) for code in codes[0].tolist()} - {0})
    return {names[code]: np.sort(ids[codes[0] == code]).tolist() for code in present}


def _of_rule(values: NDArray[Any], rule: Floats, other: float) -> NDArray[Any]:
    """Return the value ``[E, A]`` of the reaction of each person, ``other`` for those without one."""
    index = rule.astype(np.int64) - 1
    return np.where(index >= 0, values[np.maximum(index, 0)], other)


def _view(scene: Scene, kind: str, robots: Sequence[int]) -> Scene:
    """Return the scene as people with a reaction see it."""
    index = list(robots)
    if kind == "ignore":
        active = scene.active.copy()
        active[:, index] = False
        return scene.replace(active=active)
    velocity = scene.velocity.copy()
    velocity[:, index] = 0.0
    return scene.replace(velocity=velocity)


def _merge(after: Scene, other: Scene, who: NDArray[np.bool_]) -> Scene:
    """Return a scene in which the people ``who`` ``[E, A]`` move as in another one."""

    def choose(one: NDArray[Any], two: NDArray[Any]) -> NDArray[Any]:
        return np.where(who.reshape(*who.shape, *(1,) * (one.ndim - 2)), two, one)

    memory = {name: choose(value, other.memory[name]) for name, value in after.memory.items() if name in other.memory}
    return after.replace(
        position=choose(after.position, other.position),
        velocity=choose(after.velocity, other.velocity),
        heading=choose(after.heading, other.heading),
        memory={**after.memory, **memory},
    )


def _with_wishes(scene: Scene, wish: Floats, steers: NDArray[np.bool_]) -> Scene:
    """Return the scene with goals and preferred speeds for the desired velocities ``[E, A, 2]`` of some people."""
    if scene.preferred_velocity is not None:
        return scene.replace(preferred_velocity=np.where(steers[..., None], wish, scene.preferred_velocity))
    length = np.sqrt(wish[..., 0] ** 2 + wish[..., 1] ** 2)
    goal = scene.position + AHEAD * np.where((length > 1e-3)[..., None], wish, 0.0)
    speed = np.where(steers & (length > 1e-3), length, scene.preferred_speed)
    return scene.replace(goal=np.where(steers[..., None], goal, scene.goal), preferred_speed=speed)


def _led_by_reaction(step: Step, who: NDArray[np.bool_]) -> Step:
    """Return a step in which the people ``who`` ``[E, A]`` follow their reaction and do not keep away from robots."""
    if not np.any(who):
        return step

    def lead(scene: Scene, dt: float) -> Scene:
        after = step(scene, dt)
        if scene.robot is None:
            return after
        return _merge(after, step(scene.replace(robot=None), dt), who)

    return lead


def _turn_after(step: Step, toward: Floats, looks: NDArray[np.bool_]) -> Step:
    """Return a step after which people turn to a robot.

    Args:
        step: step of the crowd model.
        toward: ``[E, A, 2]`` vector to the robot, 0 for people who do not turn.
        looks: ``[E, A]`` who turns while walking, too.
    """
    turns = np.any(toward != 0.0, axis=-1)
    if not np.any(turns):
        return step
    robot = np.arctan2(toward[..., 1], toward[..., 0])

    def turn(scene: Scene, dt: float) -> Scene:
        after = step(scene, dt)
        speed = np.sqrt(after.velocity[..., 0] ** 2 + after.velocity[..., 1] ** 2)
        way = np.arctan2(after.velocity[..., 1], after.velocity[..., 0])
        slow = speed < STILL
        aim = np.where(slow, robot, way + np.clip(wrap_angle(robot - way), -ASIDE, ASIDE))
        heading = scene.heading + np.clip(wrap_angle(aim - scene.heading), -TURN * dt, TURN * dt)
        return after.replace(heading=np.where(turns & (slow | looks), wrap_angle(heading), after.heading))

    return turn
