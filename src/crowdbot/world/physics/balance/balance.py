"""Balance: whether people stand, brace, step or fall, as linear inverted pendulums over their feet.

The state of a person is the displacement ``d`` of the centre of mass from its place over the feet, and its rate. Pushes
change the rate. The centre of pressure ``p`` stays within the base of support, and the body accelerates by
``w^2 (d - p)``. The extrapolated centre of mass ``d + d' / w`` tells whether the feet can hold it, where a recovery
step must land, and when it is out of reach (Hof 2008, doi:10.1016/j.humov.2007.08.003).
"""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Storage, kernel
from crowdbot.humans import People
from crowdbot.typing import Floats, Ints

from .ability import RESPONSE, balance_ability

PUSHERS = ("robot", "prop", "person", "wall")
"""Kinds of bodies that push, by number."""
STANDING, STEPPING, FALLING, LYING_DOWN, RISING = 0, 1, 2, 3, 4
"""Phases: standing or walking, recovery steps, falling, lying, getting up."""
BRACED = 0.1
"""Delay [s] after which people shift the centre of pressure to the edge of the feet (assumed)."""
GAIN = 2.0
"""Centre of pressure in relation to the extrapolated centre of mass (assumed: it then decays with the rate ``w``)."""
FURTHER, SHORTER, MOST = 0.3, 0.6, 3
"""Time [s] and length, in relation to the first, of further steps when one was not enough, and their largest number
(assumed)."""
FARTHEST = 0.87
"""Displacement in relation to the height of the centre of mass from which nobody recovers: 60 degrees (assumed)."""
GRIP = 0.5
"""Friction of shoes, which limits the acceleration (assumed: the usual lower bound of safe floors)."""
STILL = 2e-3
"""Displacement [m] and rate [m/s] below which a person stands again."""


@kernel(inline=True)
def _limit(limits: Floats, ahead: float, aside: float) -> float:
    """Return a limit in a direction, between those ahead, behind and aside, as on an ellipse."""
    size = math.sqrt(ahead * ahead + aside * aside)
    ahead_limit: float = limits[0]
    if size < 1e-9:
        return ahead_limit
    along = ahead_limit if ahead >= 0.0 else limits[1]
    return 1.0 / math.sqrt((ahead / size / along) ** 2 + (aside / size / limits[2]) ** 2)


@kernel
def _advance(
    rows: Ints, dt: float, heading: Floats, rate: Floats, center: Floats, base: Floats, reach: Floats, shift: Floats,
    speed: Floats, phase: Ints, clock: Floats, due: Floats, failed: Ints, steps: Ints, pulled: Floats,
) -> None:  # fmt: skip
    """Advance people by ``dt`` [s] in place, and write their accelerations ``pulled`` [m/s2]."""
    for i in rows:
        pulled[i, 0], pulled[i, 1] = 0.0, 0.0
        if phase[i] >= FALLING or (shift[i, 0] == 0.0 and shift[i, 1] == 0.0 and speed[i, 0] == 0.0 == speed[i, 1]):
            continue
        w = rate[i]
        clock[i] += dt
        x, y = shift[i, 0] + speed[i, 0] / w, shift[i, 1] + speed[i, 1] / w
        far = math.sqrt(x * x + y * y)
        c, s = math.cos(heading[i]), math.sin(heading[i])
        edge, longest = _limit(base[i], c * x + s * y, c * y - s * x), _limit(reach[i], c * x + s * y, c * y - s * x)
        if phase[i] == STANDING and far > edge:
            phase[i], due[i], failed[i] = STEPPING, RESPONSE, 0
        elif phase[i] == STEPPING:
            due[i] -= dt
            if failed[i] > 0:
                longest *= SHORTER
            if due[i] <= 0.0 and far > edge:
                steps[i] += 1
                share = 1.0 if far <= longest + edge else longest / far
                shift[i, 0], shift[i, 1] = shift[i, 0] - share * x, shift[i, 1] - share * y
                failed[i] = 0 if share == 1.0 else failed[i] + 1
                due[i] = FURTHER
                if failed[i] > MOST:
                    phase[i] = FALLING
                x, y, far = (1.0 - share) * x, (1.0 - share) * y, (1.0 - share) * far
            if (far <= edge and due[i] <= 0.0) or (failed[i] == 0 and far <= 0.5 * edge):
                phase[i] = STANDING
        size = math.sqrt(shift[i, 0] ** 2 + shift[i, 1] ** 2)
        if size > FARTHEST * center[i] and shift[i, 0] * speed[i, 0] + shift[i, 1] * speed[i, 1] > 0.0:
            phase[i] = FALLING
        if clock[i] >= BRACED:
            share = min(GAIN, edge / max(far, 1e-9))
            px, py = share * x, share * y
        else:
            share = min(1.0, edge / max(size, 1e-9))
            px, py = share * shift[i, 0], share * shift[i, 1]
        ax, ay = w * w * (shift[i, 0] - px), w * w * (shift[i, 1] - py)
        most = GRIP * 9.81 / max(math.sqrt(ax * ax + ay * ay), 1e-9)
        if most < 1.0:
            ax, ay = most * ax, most * ay
        speed[i, 0], speed[i, 1] = speed[i, 0] + dt * ax, speed[i, 1] + dt * ay
        shift[i, 0], shift[i, 1] = shift[i, 0] + dt * speed[i, 0], shift[i, 1] + dt * speed[i, 1]
        pulled[i, 0], pulled[i, 1] = ax, ay
        if phase[i] == STANDING and far < STILL and abs(speed[i, 0]) < STILL and abs(speed[i, 1]) < STILL:
            shift[i], speed[i], clock[i] = 0.0, 0.0, 0.0


class Balance:
    """Balance of all agents of a world; those that are no people cannot be pushed.

    Args:
        people: bodies of N people.
        agents: their agents ``[N]``.
        count: number of agents A.

    Attributes:
        shift, speed: displacement ``[A, 2]`` [m] of the centre of mass from its place over the feet, and its rate
            [m/s].
        phase: ``[A]``, one of ``STANDING``, ``STEPPING``, ``FALLING``, ``LYING_DOWN`` and ``RISING``.
        steps: number ``[A]`` of recovery steps so far.
        pulled: acceleration ``[A, 2]`` [m/s2] by gravity and feet in the latest step.
        pusher: kind and number ``[A, 2]`` of the body that pushed each person last, -1 for none; see :meth:`push`.

    >>> balance, heading = Balance(People.of(["man-36"]), np.zeros(1, dtype=np.int64), 1), np.zeros(1)
    >>> balance.push(0, np.array([0.6, 0.0]), 1.3, ("robot", 1))
    >>> for _ in range(400):
    ...     balance.advance(np.array([0]), heading, 0.005)
    >>> int(balance.steps[0]), int(balance.phase[0]) == STANDING
    (1, True)
    """

    storage = Storage(constants=("rate", "center", "base", "reach"))

    def __init__(self, people: People, agents: Ints, count: int) -> None:
        self.shift, self.speed, self.pulled = (np.zeros((count, 2)) for _ in range(3))
        self.clock, self.due = np.zeros(count), np.zeros(count)
        self.phase, self.failed, self.steps = (np.zeros(count, dtype=np.int64) for _ in range(3))
        self.pusher = np.full((count, 2), -1, dtype=np.int64)
        self.rate, self.center = np.ones(count), np.ones(count)
        self.base, self.reach = np.ones((count, 3)), np.ones((count, 3))
        self.learn(people, agents, count)

    def learn(self, people: People, agents: Ints, count: int) -> None:
        """Set the abilities of people among ``count`` agents; those above the number so far are added."""
        more = count - len(self.phase)
        for name, array in list(self.__dict__.items()):
            if more > 0:
                filler = np.full((more, *array.shape[1:]), -1 if name == "pusher" else 0, dtype=array.dtype)
                setattr(self, name, np.concatenate([array, filler]))
        found = balance_ability(people)
        self.rate[agents], self.center[agents] = found.rate, found.center
        self.base[agents], self.reach[agents] = found.base, found.reach

    @property
    def unsteady(self) -> NDArray[np.bool_]:
        """Whether each agent ``[A]`` is out of balance or on the floor."""
        moved = np.any(self.shift != 0.0, axis=1) | np.any(self.speed != 0.0, axis=1)
        return np.asarray(moved | (self.phase != STANDING))

    @property
    def down(self) -> NDArray[np.bool_]:
        """Whether each agent ``[A]`` falls, lies or gets up."""
        return np.asarray(self.phase >= FALLING)

    def forget(self, agents: NDArray[np.bool_]) -> None:
        """Let agents ``[A]`` stand upright, as those who are absent."""
        for array in (self.shift, self.speed, self.pulled, self.clock, self.due, self.phase, self.failed, self.steps):
            array[agents] = 0
        self.pusher[agents] = -1

    def push(self, agent: int, change: Floats, height: float, pusher: tuple[str, int] | None) -> None:
        """Change the rate of a person by a push.

        A push at the height of the centre of mass or above moves it over the feet. A push on the feet moves the feet
        below it: the rate changes by the opposite. Between them, the effect is linear (assumed: a rod that is free at
        both ends).

        Args:
            agent: the person.
            change: impulse ``[2]`` per mass of the person [m/s].
            height: height of the contact [m].
            pusher: kind and number of the other body. The push of a person counts for the body that pushed them.
                None: a force that no body exerts.
        """
        if self.phase[agent] >= FALLING:
            return
        share = min(max(2.0 * height / self.center[agent] - 1.0, -1.0), 1.0)
        self.speed[agent] += share * change
        if pusher is None:
            self.pusher[agent] = -1
            return
        kind, number = PUSHERS.index(pusher[0]), pusher[1]
        if pusher[0] == "person" and self.pusher[number, 0] >= 0:
            kind, number = self.pusher[number].tolist()
        if (kind, number) != (PUSHERS.index("person"), agent):
            self.pusher[agent] = kind, number

    def advance(self, agents: Ints, heading: Floats, dt: float) -> None:
        """Advance some agents by ``dt`` [s]; ``heading`` ``[A]`` [rad]."""
        _advance(
            agents, dt, heading, self.rate, self.center, self.base, self.reach, self.shift, self.speed, self.phase,
            self.clock, self.due, self.failed, self.steps, self.pulled,
        )  # fmt: skip
