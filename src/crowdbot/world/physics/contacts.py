"""Contacts of one engine step: bodies, parts, forces and penetration."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import storable
from crowdbot.typing import Floats

from .body_region_limits import DAMPING, peak_share
from .engine import engine
from .mjcf_model import LIMB_NAMES
from .rider import RIDER

KINDS = ("robot", "person", "prop", "wall")
NOTHING, ROBOT, PROP, PERSON, WALL = 0, 1, 2, 3, 4
SLOW = 0.05
"""Smallest closing speed [m/s] for the depth of a contact between a led person and a led robot."""
WORDS = {ROBOT: "robot", PROP: "prop", PERSON: "person", WALL: "wall"}


@storable
class ContactBody(NamedTuple):
    """One of the two bodies in a contact.

    Fields:
        kind: ``robot``, ``person``, ``prop`` or ``wall``.
        number: index of the agent, of the prop on the stage, or of the wall ring; -1, -2, ... for the first, second
            ... door.
    """

    kind: str
    number: int


class EngineContact(NamedTuple):
    """Contact of two bodies in one engine step, ordered robot, prop, person, wall.

    Fields:
        first, second: the bodies.
        first_part, second_part: link of a robot or limb of a person, otherwise empty.
        force: normal force ``[3]`` of the first body on the second [N].
        depth: penetration [m].
        normal: mean contact normal ``[3]`` from the first body to the second.
        point: contact point ``[3]`` [m].
        first_velocity, second_velocity: velocities ``[3]`` of the surfaces at the point before this step [m/s].
        swing: velocity ``[3]`` of the limb relative to its person [m/s]; 0 without a person.
    """

    first: ContactBody
    second: ContactBody
    first_part: str
    second_part: str
    force: Floats
    depth: float
    normal: Floats
    point: Floats
    first_velocity: Floats
    second_velocity: Floats
    swing: Floats


class GeomTable(NamedTuple):
    """Body and part of each geom of an engine model; one table for all worlds with the model.

    Fields:
        kind: ``[G]`` kind of the body.
        number: agent of a robot, body slot of a person, number of a prop or a wall ring.
        part: link of a robot or limb of a person, otherwise empty.
    """

    kind: NDArray[np.int64]
    number: tuple[int, ...]
    part: tuple[str, ...]

    @classmethod
    def of(cls, model: Any, prefixes: dict[int, str]) -> GeomTable:
        """Return the table of a model; ``prefixes`` are the name prefixes of robots, by agent."""
        rows = [_sorted_out(model.geom(g).name, prefixes) for g in range(model.ngeom)]
        kinds = np.array([kind for kind, _, _ in rows], dtype=np.int64)
        return cls(kinds, tuple(number for _, number, _ in rows), tuple(part for _, _, part in rows))


class _ContactPoint(NamedTuple):
    """A contact point between the geoms ``one`` and ``other``, with their velocities."""

    row: int
    one: int
    first: Floats
    second: Floats
    swing: Floats
    other: int


class ContactReader:
    """Reads the contacts of an engine step.

    Args:
        model, data: model and data of the engine.
        geoms: bodies and parts of the geoms.
        agent_of: returns the agent of a body slot.
        swing: velocities of the limb ends ``[S, L, 6]`` [m/s] relative to their bodies.

    Attributes:
        led: agents that contacts do not move: their motion comes from outside.
    """

    def __init__(
        self, model: Any, data: Any, geoms: GeomTable, agent_of: Callable[[int], int],
        swing: Callable[[], Floats],
    ) -> None:  # fmt: skip
        self._mj, self._model, self._data = engine(), model, data
        self._agent_of, self._swing = agent_of, swing
        self.geoms = geoms
        self._kind, self._number, self._part = geoms
        self.led: frozenset[int] = frozenset()
        self._found: list[_ContactPoint] = []
        self._sizes: Floats = np.zeros((0, len(LIMB_NAMES), 3))

    @property
    def touching(self) -> bool:
        """Whether bodies other than the floor touched in the last engine step."""
        return bool(self._found)

    def use(self, model: Any, sizes: Floats) -> None:
        """Use a model in the following engine steps; ``sizes`` ``[S, L, 3]`` [m] are those of the limbs."""
        self._model, self._sizes = model, sizes

    def look(self) -> None:
        """Record active contacts and their surface velocities, between the two halves of an engine step."""
        self._found = []
        if self._data.ncon == 0:
            return
        pairs = self._data.contact.geom
        kinds = self._kind[pairs]
        for index in np.flatnonzero(np.all(kinds != NOTHING, axis=1)):
            one, other = int(pairs[index, 0]), int(pairs[index, 1])
            if self._rank(other) < self._rank(one):
                one, other = other, one
            point = np.array(self._data.contact[int(index)].pos)
            swing = np.zeros(3)
            for geom in (one, other):
                if self._kind[geom] == PERSON:
                    swing = self._swung(geom, point)
            first = self._velocity(one, point) + (swing if self._kind[one] == PERSON else 0.0)
            second = self._velocity(other, point) + (swing if self._kind[other] == PERSON else 0.0)
            self._found.append(_ContactPoint(int(index), one, first, second, swing, other))
        self._share()
        if self.led:
            self._limit_depth()

    def _share(self) -> None:
        """Divide the stiffness of a limb by its number of contact points, which are separate springs in the engine."""
        points: dict[tuple[int, int], list[int]] = {}
        for found in self._found:
            if PERSON in (self._kind[found.one], self._kind[found.other]):
                points.setdefault((found.one, found.other), []).append(found.row)
        for indices in points.values():
            for index in indices if len(indices) > 1 else ():
                contact = self._data.contact[index]
                rows = slice(contact.efc_address, contact.efc_address + contact.dim)
                self._data.efc_R[rows] *= len(indices)
                self._data.efc_D[rows] /= len(indices)

    def _limit_depth(self) -> None:
        """Limit the depth that counts between a led person and a led robot to that of an impact at their speed.

        Neither yields, so that the depth would grow with their paths, and the force to values that nobody has.
        """
        data = self._data
        for found in self._found:
            if self._agent(found.one) not in self.led or self._agent(found.other) not in self.led:
                continue
            contact = data.contact[found.row]
            limb = found.one if self._kind[found.one] == PERSON else found.other
            way = np.array(contact.frame[:3]) * (1.0 if contact.geom[0] == found.one else -1.0)
            sign = 1.0 if limb == found.one else -1.0
            closing = max(float((found.first - found.second - sign * found.swing) @ way), SLOW)
            row = int(contact.efc_address)
            deepest = closing * peak_share(DAMPING) / math.sqrt(-float(self._model.geom_solref[limb, 0]))
            excess = -float(data.efc_pos[row]) - deepest
            if excess > 0.0:
                stiffness, _, impedance, _ = data.efc_KBIP[row]
                data.efc_aref[row] -= stiffness * impedance * excess

    def _agent(self, geom: int) -> int:
        """Return the agent of a person or robot, -1 for others."""
        kind, number = int(self._kind[geom]), self._number[geom]
        return self._agent_of(number) if kind == PERSON else number if kind == ROBOT else -1

    def read(self) -> tuple[EngineContact, ...]:
        """Return the contacts after the second half of the step; points between the same parts are merged."""
        if not self._found:
            return ()
        together: dict[tuple[ContactBody, ContactBody, str, str], list[_ContactPoint]] = {}
        for found in self._found:
            one, other = found.one, found.other
            together.setdefault(self._key(one, other), []).append(found)
        return tuple(self._joined(key, rows) for key, rows in sorted(together.items(), key=lambda item: item[0]))

    def _joined(self, key: tuple[ContactBody, ContactBody, str, str], rows: list[_ContactPoint]) -> EngineContact:
        force, normals, depth, six = np.zeros(3), np.zeros(3), 0.0, np.zeros(6)
        for row in rows:
            contact = self._data.contact[row.row]
            normal = np.array(contact.frame[:3]) * (1.0 if contact.geom[0] == row.one else -1.0)
            self._mj.mj_contactForce(self._model, self._data, row.row, six)
            force += six[0] * normal
            normals += normal
            depth = max(depth, -float(contact.dist))
        size = float(np.sqrt(normals @ normals))
        normal = normals / size if size > 1e-9 else np.array([1.0, 0.0, 0.0])
        first = np.mean([row.first for row in rows], axis=0)
        second = np.mean([row.second for row in rows], axis=0)
        swing = np.mean([row.swing for row in rows], axis=0)
        point = np.mean([self._data.contact[row.row].pos for row in rows], axis=0)
        return EngineContact(*key, force, depth, normal, point, first, second, swing)

    def _key(self, one: int, other: int) -> tuple[ContactBody, ContactBody, str, str]:
        """Return bodies and parts of two geoms. The rider of a robot is a person for other robots, else its part."""
        first, second = self._party(one), self._party(other)
        rider = self._part[other].removeprefix(RIDER)
        if first.kind == second.kind == "robot" and rider != self._part[other]:
            return first, ContactBody("person", second.number), self._part[one], rider
        return first, second, self._part[one], self._part[other]

    def _rank(self, geom: int) -> tuple[int, bool, int]:
        return int(self._kind[geom]), self._part[geom].startswith(RIDER), geom

    def _party(self, geom: int) -> ContactBody:
        kind, number = int(self._kind[geom]), self._number[geom]
        return ContactBody(WORDS[kind], self._agent_of(number) if kind == PERSON else number)

    def _velocity(self, geom: int, point: Floats) -> Floats:
        """Return the velocity ``[3]`` of the body of a geom at a point."""
        body = int(self._model.geom_bodyid[geom])
        spin, move = self._data.cvel[body, :3], self._data.cvel[body, 3:]
        center = self._data.subtree_com[self._model.body_rootid[body]]
        return np.asarray(move + np.cross(spin, point - center))

    def _swung(self, geom: int, point: Floats) -> Floats:
        """Return the swing velocity of a limb at the position nearest to a point."""
        limb = LIMB_NAMES.index(self._part[geom])
        ends = self._swing()[self._number[geom], limb]
        axis = self._data.geom_xmat[geom].reshape(3, 3)[:, 2]
        half = max(float(self._sizes[self._number[geom], limb, 1]), 1e-9)
        along = float(np.clip(0.5 + 0.5 * (point - self._data.geom_xpos[geom]) @ axis / half, 0.0, 1.0))
        return np.asarray((1.0 - along) * ends[:3] + along * ends[3:])


def _sorted_out(name: str, prefixes: dict[int, str]) -> tuple[int, int, str]:
    """Return kind, number and part of a geom from its name."""
    if name.startswith("person"):
        slot, limb = name.removeprefix("person").split("/")
        return PERSON, int(slot), limb
    if name.startswith("prop"):
        return PROP, int(name.removeprefix("prop").split("/")[0]), ""
    if name.startswith("wall/"):
        return WALL, int(name.removeprefix("wall/").split(".")[0]), ""
    if name.startswith("door"):  # the walls of doors have negative numbers
        return WALL, -1 - int(name.removeprefix("door").split("/")[0]), ""
    for agent, prefix in prefixes.items():
        if name.startswith(prefix):
            return ROBOT, agent, name.removeprefix(prefix).rsplit("/", 1)[0].removesuffix("/seen")
    return NOTHING, -1, ""
