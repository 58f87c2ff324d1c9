"""FallingPeople: people who lose their balance, fall, lie on the floor and get up."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from crowdbot.core import Scene, Storage, stream
from crowdbot.humans import LYING, FallPose, People, Posture
from crowdbot.metrics import HIC15_LIMIT, fall_hic15
from crowdbot.typing import Ints
from crowdbot.world.physics.scenery import add_rings

from .balance import FALLING, LYING_DOWN, PUSHERS, RISING, Balance
from .fall import Fall, FallMotion, direction_name, head_probability, impact_speeds

if TYPE_CHECKING:
    from crowdbot.world.physics.people_motion import PeopleMotion

START = math.radians(25.0)
"""Largest tilt [rad] at the beginning of a fall: those who lean further are on their feet, with hips and knees bent
(assumed)."""
FASTEST = 2.0
"""Largest initial rate of a fall [rad/s]: the body then reaches the floor as in free fall, in 0.45 s. The rest of a
hard push moves the falling body along the floor."""
RISE = 3.0
"""Time [s] of getting up (assumed)."""
AHEAD, BEHIND, ASIDE = 0.9, 0.95, 0.22
"""Extent [m] of a lying body of 1.75 m from the pelvis to head, feet and sides, as an obstacle."""


class FallingPeople:
    """Balance and falls of the people of a world, E = 1.

    Args:
        motion: bodies of the people.
        count: number of agents A.
        get_up: time [s] on the floor after which people get up; None: they stay. Those whose HIC15 exceeds its limit
            stay, too.

    Attributes:
        balance: balance of all agents.
        falls: falls so far, also those that are not over, by time.
    """

    storage = Storage(constants=("get_up",))

    def __init__(self, motion: PeopleMotion, count: int, get_up: float | None) -> None:
        self.get_up = get_up
        self.balance = Balance(motion.people, motion.agents, count)
        self.falls: tuple[Fall, ...] = ()
        self._since, self._direction, self._tilt, self._speed = (np.zeros(count) for _ in range(4))
        self._struck = np.zeros(count, dtype=np.bool_)
        self._moved = np.zeros((count, 2))
        self._number = np.full(count, -1, dtype=np.int64)

    def grow(self, motion: PeopleMotion, count: int) -> None:
        """Add agents, of which those of ``motion`` are people."""
        self.balance.learn(motion.people, motion.agents, count)
        more = count - len(self._since)
        for name in ("_since", "_direction", "_tilt", "_speed", "_struck", "_moved", "_number"):
            array = getattr(self, name)
            filler = np.full((more, *array.shape[1:]), -1 if name == "_number" else 0, dtype=array.dtype)
            setattr(self, name, np.concatenate([array, filler]))

    def motion_of(self, agent: int) -> FallMotion:
        """Return the tilt of a falling person over time."""
        return FallMotion(float(self._tilt[agent]), float(self._speed[agent]), float(self.balance.rate[agent]))

    def lead(self, before: Scene, after: Scene, time: float, dt: float) -> Scene:
        """Return the scene after a step that ends at ``time`` [s], in which those on the floor follow their falls."""
        self.balance.forget(self.balance.down & ~before.active[0])
        rows = np.flatnonzero(self.balance.down)
        if not len(rows):
            return after
        position, velocity, heading = after.position.copy(), after.velocity.copy(), after.heading.copy()
        for agent in rows.tolist():
            moved = np.zeros(2)
            if self.balance.phase[agent] == FALLING:
                begin = time - dt
                moved = (self._progress(agent, time) - self._progress(agent, begin)) * self._moved[agent]
            position[0, agent], velocity[0, agent] = before.position[0, agent] + moved, moved / dt
            heading[0, agent] = before.heading[0, agent]
        return after.replace(position=position, velocity=velocity, heading=heading)

    def _progress(self, agent: int, time: float) -> float:
        """Return the share of the way of the pelvis of a falling person."""
        first = math.sin(self._tilt[agent])
        now = math.sin(self.motion_of(agent).tilt(time - self._since[agent]))
        return (now - first) / max(1.0 - first, 1e-6)

    def poses(self, motion: PeopleMotion, scene: Scene, time: float) -> dict[int, FallPose]:
        """Return the poses of people out of balance at a time [s], by row of their body."""
        result = {}
        for agent in np.flatnonzero(self.balance.unsteady).tolist():
            row, phase = int(motion.row[agent]), int(self.balance.phase[agent])
            if row < 0 or not scene.active[0, agent]:
                continue
            direction, start, late = float(self._direction[agent]), float(self._tilt[agent]), time - self._since[agent]
            if phase == FALLING:
                tilt = self.motion_of(agent).tilt(late)
            elif phase == LYING_DOWN:
                tilt = LYING
            elif phase == RISING:
                share = min(late / RISE, 1.0)
                tilt, start = LYING * 0.5 * (1.0 + math.cos(math.pi * share)), 0.0
            else:
                x, y = self.balance.shift[agent].tolist()
                direction = math.atan2(y, x) - float(scene.heading[0, agent])
                tilt, start = math.asin(min(math.hypot(x, y) / float(self.balance.center[agent]), 0.9)), 0.0
            struck = bool(self._struck[agent])
            result[row] = FallPose(direction, tilt, start, struck, phase >= FALLING, phase == RISING)
        return result

    def update(self, motion: PeopleMotion, scene: Scene, time: float, seed: int) -> None:
        """Begin falls of people whose balance is lost, and let others come to rest or get up, at a time [s]."""
        phase = self.balance.phase
        for agent in np.flatnonzero(phase >= FALLING).tolist():
            number, late = int(self._number[agent]), time - float(self._since[agent])
            if phase[agent] == FALLING and number < 0:
                self._begin(motion, scene, agent, time, seed)
            elif phase[agent] == FALLING and time >= self.falls[number].end - 1e-9:
                phase[agent], self._since[agent] = LYING_DOWN, time
            elif phase[agent] == LYING_DOWN and self.get_up is not None and late >= self.get_up - 1e-9:
                if self.falls[number].hic15 <= HIC15_LIMIT:
                    phase[agent], self._since[agent] = RISING, time
            elif phase[agent] == RISING and late >= RISE - 1e-9:
                self.balance.forget(np.arange(len(phase)) == agent)
        self._number[phase < FALLING] = -1

    def _begin(self, motion: PeopleMotion, scene: Scene, agent: int, time: float, seed: int) -> None:
        balance, row = self.balance, int(motion.row[agent])
        shift, speed = balance.shift[agent], balance.speed[agent]
        toward = shift + speed / balance.rate[agent]
        away = toward / max(math.hypot(*toward), 1e-9)
        tilt = math.asin(min(max(float(shift @ away), 0.0) / float(balance.center[agent]), math.sin(START)))
        self._tilt[agent], self._since[agent] = tilt, time
        self._speed[agent] = min(max(float(speed @ away), 0.0) / float(balance.center[agent]), FASTEST)
        yaw = float(scene.heading[0, agent])
        self._direction[agent] = math.atan2(away[1], away[0]) - yaw
        word = direction_name(float(self._direction[agent]))
        earlier = sum(fall.person == agent for fall in self.falls)
        chance = head_probability(word, float(motion.people.persons[row].years))
        struck = bool(stream(seed, "fall", agent, earlier).uniform() < chance)
        self._struck[agent] = struck
        posture, body = motion.gait.posture(motion.state), motion.people
        one = People((body.persons[row],), body.variation[row : row + 1], body.height[row : row + 1])
        upright = Posture(posture.rotation[row : row + 1], posture.position[row : row + 1])
        fall = self.motion_of(agent)
        speeds, places = impact_speeds(upright, one, yaw, float(self._direction[agent]), struck, fall)
        self._moved[agent] = max(float((places[-1] - places[0]) @ away), 0.0) * away
        kind, causer = balance.pusher[agent].tolist()
        head = speeds["head"]
        self._number[agent] = len(self.falls)
        new = Fall(
            agent, time, time + fall.duration, word, PUSHERS[kind] if kind >= 0 else "", causer,
            int(balance.steps[agent]), speeds["hand"], speeds["lower leg"], speeds["pelvis"], speeds["chest"], head,
            fall_hic15(head),
        )  # fmt: skip
        self.falls = (*self.falls, new)

    def add_obstacles(self, scene: Scene) -> Scene:
        """Return the scene in which the crowd model does not move those on the floor, with walls around them."""
        down = self.balance.down & scene.active[0]
        rows = np.flatnonzero(down)
        if not len(rows):
            return scene
        rings = []
        for agent in rows.tolist():
            angle = float(scene.heading[0, agent] + self._direction[agent])
            along, across = np.array([math.cos(angle), math.sin(angle)]), np.array([-math.sin(angle), math.cos(angle)])
            place, size = scene.position[0, agent], float(self.balance.center[agent]) / 0.98
            corners = ((AHEAD, ASIDE), (-BEHIND, ASIDE), (-BEHIND, -ASIDE), (AHEAD, -ASIDE))
            rings.append(np.array([place + size * (x * along + y * across) for x, y in corners]))
        return scene.replace(external=scene.external | down[None], walls=add_rings(scene.walls, tuple(rings)))

    def wanting(self) -> Ints:
        """Return the agents who need a body although nothing may be near them: those who step or fall."""
        phase = self.balance.phase
        return np.flatnonzero(self.balance.unsteady & (phase <= FALLING))
