"""Bodies of people near robots and movable props.

Only a few people of a crowd can come into contact in the next step, therefore the engine has a fixed number of bodies.
A body follows the crowd model exactly until contact. A push changes its velocity according to its mass; the person then
returns to the path of the crowd model with limited force.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from crowdbot.core import Storage, kernel, storable
from crowdbot.humans import limb_chain
from crowdbot.typing import Bools, Floats, Ints

from .balance.balance import Balance
from .balance.force_pushes import ForcePushes
from .balance.recovery import BRACE, GRAVITY, GRIP, REACTION, recovery_force
from .body_region_limits import region_of, softness
from .contacts import EngineContact
from .layers import write_layers
from .mjcf_model import LIMB_COUNT, LIMB_NAMES, PARKED


def chain_rows(limb: str) -> list[int]:
    """Return the rows of the arm or leg of a limb; empty for the trunk."""
    return [LIMB_NAMES.index(name) for name in limb_chain(limb)]


@kernel
def move_limbs(
    here: Ints, walk: Floats, touched: Ints, wary: Ints, toward: Floats, speeds: Floats, step: float, fresh: Bools,
    late: Bools, stride: Floats, limbs: Floats, walked: Floats, swing: Floats, position: Floats, rotation: Floats,
    size: Floats, bound: Floats,
) -> None:  # fmt: skip
    """Move limbs according to the gait, and write the poses of their capsules, in place.

    Limbs of people in contact keep their pose and return slowly afterwards. Towards what a person touched, they move
    even more slowly.

    Args:
        here: bodies in use ``[P]``.
        walk: ends of the limbs ``[P, L, 6]`` [m] by the gait.
        touched, wary: engine steps for which limbs keep their pose, and return slowly ``[S]``.
        toward: horizontal unit vectors ``[S, 2]`` from the person to what it touched.
        speeds: largest speeds [m/s] in general, after a contact, and towards what was touched.
        step: duration of the engine step [s].
        fresh, late: whether bodies are new, and whether their limbs are behind the gait ``[S]``.
        stride: velocities of the ends ``[S, L, 6]`` [m/s] by the gait.
        limbs, walked, swing: ends of the limbs [m], those by the gait, and velocities [m/s] ``[S, L, 6]``.
        position, rotation, size, bound: capsules, see :class:`BodyShapes`.
    """
    count = walk.shape[1]
    moved, guarded, share = np.empty((count, 6)), np.empty((count, 6)), np.empty(count)
    for k in range(len(here)):
        s = here[k]
        held = touched[s] > 0 and not fresh[s]
        slow = held or late[s]
        fastest = speeds[1] if slow else speeds[0]
        tx, ty = (toward[s, 0], toward[s, 1]) if slow and wary[s] > 0 else (0.0, 0.0)
        behind = held
        for limb in range(count):
            first, second = 0.0, 0.0
            for c in range(6):
                lag = walk[k, limb, c] - limbs[s, limb, c]
                moved[limb, c] = lag
                if c < 3:
                    first += lag * lag
                else:
                    second += lag * lag
            part = min(1.0, fastest * step / max(math.sqrt(max(first, second)), 1e-12))
            if held:
                part = 0.0
            if fresh[s]:
                part = 1.0
            share[limb] = part
            behind = behind or part < 1.0
            for end in range(0, 6, 3):
                for c in range(3):
                    moved[limb, end + c] = part * moved[limb, end + c]
                    guarded[limb, end + c] = moved[limb, end + c]
                excess = max(0.0, moved[limb, end] * tx + moved[limb, end + 1] * ty - speeds[2] * step)
                guarded[limb, end] -= excess * tx
                guarded[limb, end + 1] -= excess * ty
                for c in range(3):
                    behind = behind or guarded[limb, end + c] != moved[limb, end + c]
        late[s] = slow and behind
        fresh[s] = False
        for limb in range(count):
            keeps = late[s] or share[limb] < 1.0
            for c in range(6):
                limbs[s, limb, c] = limbs[s, limb, c] + guarded[limb, c] if keeps else walk[k, limb, c]
                swing[s, limb, c] = guarded[limb, c] / step if keeps else stride[s, limb, c]
                walked[s, limb, c] = walk[k, limb, c]
            _write_capsule(s, limb, limbs, position, rotation, size, bound)


@kernel(inline=True)
def _write_capsule(
    s: int, limb: int, limbs: Floats, position: Floats, rotation: Floats, size: Floats, bound: Floats
) -> None:
    """Write middle, rotation, half length and bounding radius of a limb; the rotation takes the z axis to the limb."""
    a = limbs[s, limb]
    x, y, z = a[3] - a[0], a[4] - a[1], a[5] - a[2]
    length = max(math.sqrt(x * x + y * y + z * z), 1e-9)
    for c in range(3):
        position[s, limb, c] = 0.5 * (a[3 + c] + a[c])
    size[s, limb, 1] = 0.5 * length
    bound[s, limb] = 0.5 * length + size[s, limb, 0]
    x, y, z = x / length, y / length, z / length
    q0, q1, q2 = 1.0 + z, -y, x
    if z < -1.0 + 1e-9:
        q0, q1, q2 = 0.0, 1.0, 0.0
    norm = math.sqrt(q0 * q0 + q1 * q1 + q2 * q2)
    rotation[s, limb, 0], rotation[s, limb, 1] = q0 / norm, q1 / norm
    rotation[s, limb, 2], rotation[s, limb, 3] = q2 / norm, 0.0


@storable
class BodyShapes(NamedTuple):
    """Limbs and masses of the bodies, which are parts of the engine model; S bodies, L limbs.

    Fields:
        position, rotation: ``[S, L, 3]`` [m] and quaternions ``[S, L, 4]`` of the limbs relative to their bodies.
        size: radius, half length and 0 ``[S, L, 3]`` [m].
        bound: radius of the bounding sphere ``[S, L]`` [m].
        softness: stiffness and damping of contacts ``[S, L, 2]``, negated.
        mass: ``[S]`` [kg].
        inverse_weight: inverse of mass and inertia ``[S, 2]``.
    """

    position: Floats
    rotation: Floats
    size: Floats
    bound: Floats
    softness: Floats
    mass: Floats
    inverse_weight: Floats

    @classmethod
    def of(cls, model: Any, geoms: Ints, bodies: Ints) -> BodyShapes:
        """Return a copy of the shapes of a model."""
        position, rotation, size, bound, softness = (
            array.reshape(len(bodies), LIMB_COUNT, *array.shape[1:])
            for array in (getattr(model, name)[geoms] for name in (*POSES, "geom_solref"))
        )
        return cls(position, rotation, size, bound, softness, model.body_mass[bodies], model.body_invweight0[bodies])

    def copy(self) -> BodyShapes:
        """Return an independent copy."""
        return BodyShapes(*(array.copy() for array in self))

    def write_all(self, model: Any, geoms: Ints, bodies: Ints) -> None:
        """Write the shapes to a model."""
        if not len(bodies):
            return
        self.write_poses(model, geoms)
        model.geom_solref[int(geoms[0]) : int(geoms[-1]) + 1] = self.softness.reshape(-1, 2)
        model.body_mass[bodies], model.body_invweight0[bodies] = self.mass, self.inverse_weight

    def write_poses(self, model: Any, geoms: Ints) -> None:
        """Write poses and sizes of the limbs to a model."""
        rows = slice(int(geoms[0]), int(geoms[-1]) + 1)
        for name, array in zip(POSES, self, strict=False):
            getattr(model, name)[rows] = array.reshape(len(geoms), *array.shape[2:])


POSES = ("geom_pos", "geom_quat", "geom_size", "geom_rbound")
"""Arrays of an engine model with the poses and sizes of limbs, in the order of :class:`BodyShapes`."""


HOLD = 0.05
"""Time [s] after a contact for which limbs keep their pose relative to the body."""
RETURN = 1.5
"""Speed [m/s] at which they then return to the gait."""
GUARD, GUARDED = 0.2, 1.5
"""Speed [m/s] at which they return towards what they touched, for ``GUARDED`` [s] (assumed: people do not kick it)."""
QUICK = 5.0
"""Largest speed [m/s] of a limb relative to the body (assumed: swinging feet reach 4 to 5 m/s over the floor). Without
it, a sudden change of direction by the crowd model would swing a foot at twice that speed."""
TREAD, LIFTED = 0.5, 0.5
"""An arm or leg is raised immediately, by up to ``LIFTED`` [m], if at least the share ``TREAD`` of the contact force
points upwards. Bodies cannot rise and would otherwise press the limb down."""
GIVE, GIVEN = 1.0, 0.3
"""Largest speed [m/s] and distance [m] by which an arm or leg yields relative to the body when the mean force over
about :data:`REACTION` exceeds :data:`BRACE`. Single impacts do not move it."""
REGIONS = {ahead: tuple(region_of(name, ahead) for name in LIMB_NAMES) for ahead in (True, False)}


class PeopleBodies:
    """Pool of bodies in the engine, assigned to nearby people.

    Args:
        model, data: model and data of the engine.
        slots: number of bodies S.
        step: time step of the engine [s].
        shapes: limbs and masses at the start; None: those of the model.

    Attributes:
        agent: ``[S]`` agent of each body, -1 for a free one.
        pushed: ``[S]`` whether a contact displaced the body during this step of the world.
        led: agents whose motion comes from outside: contacts do not displace them.
        balance: balance of the agents; None: nobody loses it.
        pushes: forces from outside during this step of the world.
    """

    storage = Storage(
        constants=("pushes", "_model", "_data", "step", "geoms", "bodies", "_place", "_speed", "_hold"),
        resized=("_begin", "_heading", "_limbs", "led"),
    )  # fmt: skip

    def __init__(self, model: Any, data: Any, slots: int, step: float, shapes: BodyShapes | None = None) -> None:
        self.step = step
        self._model: Any = None
        self.agent = np.full(slots, -1, dtype=np.int64)
        self.pushed = np.zeros(slots, dtype=np.bool_)
        self.led: Ints = np.zeros(0, dtype=np.int64)
        self.balance: Balance | None = None
        self.pushes: ForcePushes | None = None
        self._heading = np.zeros(0)
        self._begin, self._duration = np.zeros((0, 2)), 0.0
        self._off = np.zeros((slots, 2))
        self._mass, self._center = np.full(slots, 70.0), np.ones(slots)
        self._toward, self._wary = np.zeros((slots, 2)), np.zeros(slots, dtype=np.int64)
        self.bind(model, data)
        self.shapes = BodyShapes.of(model, self.geoms.ravel(), self.bodies) if shapes is None else shapes.copy()
        self._way = np.zeros((slots, 2))
        self._limbs: tuple[Floats, Floats] = (np.zeros((0, LIMB_COUNT, 6)), np.zeros((0, LIMB_COUNT, 6)))
        self._limbs_now = np.zeros((slots, LIMB_COUNT, 6))
        self._walk_now = np.zeros((slots, LIMB_COUNT, 6))
        self._load = np.zeros((slots, LIMB_COUNT, 3))
        self._stride = np.zeros((slots, LIMB_COUNT, 6))
        self._late = np.zeros(slots, dtype=np.bool_)
        self._touched = np.zeros(slots, dtype=np.int64)
        self._since = np.zeros(slots, dtype=np.int64)
        self._fresh = np.ones(slots, dtype=np.bool_)
        self._hold, self._quiet = round(HOLD / step), False
        self.swing = np.zeros((slots, LIMB_COUNT, 6))
        """Velocities [m/s] of both ends of the limbs relative to the body."""
        self._park(np.arange(slots))

    def bind(self, model: Any, data: Any) -> None:
        """Continue in another model and state of the engine, in which the bodies have the same order."""
        slots = len(self.agent)
        self._data = data
        first = int(model.geom("person0/" + LIMB_NAMES[0]).id) if slots else 0
        self.geoms = first + np.arange(slots * LIMB_COUNT).reshape(slots, LIMB_COUNT)
        self.bodies = np.array([model.body(f"person{s}").id for s in range(slots)], dtype=np.int64)
        self._place = np.array([model.joint(f"person{s}/x").qposadr[0] for s in range(slots)], dtype=np.int64)
        self._speed = np.array([model.joint(f"person{s}/x").dofadr[0] for s in range(slots)], dtype=np.int64)

    def install(self, model: Any) -> None:
        """Use a model in the following engine steps, in which nobody else uses it."""
        self._model = model
        self.shapes.write_all(model, self.geoms.ravel(), self.bodies)
        if self.balance is not None:
            unsteady, down = self.balance.unsteady[self.agent], self.balance.down[self.agent]
            write_layers(model, self.geoms, self.bodies, unsteady & (self.agent >= 0), down & (self.agent >= 0))

    def release(self) -> None:
        """Use the model no longer."""
        self._model = None

    def grow(self, model: Any, data: Any, shapes: BodyShapes) -> None:
        """Continue in a model with more bodies, whose limbs and masses at the start are ``shapes``."""
        more = PeopleBodies(model, data, len(shapes.mass), self.step, shapes)
        old, kept = len(self.agent), dict(self.__dict__)
        self.__dict__.update(more.__dict__)
        self.balance, self.pushes = kept["balance"], kept["pushes"]
        for name, array in kept.items():
            if not isinstance(array, np.ndarray) or name in ("geoms", "bodies", "_place", "_speed"):
                continue
            if name in ("led", "_begin", "_heading"):  # of agents, not of bodies
                setattr(self, name, array)
            else:
                getattr(self, name)[:old] = array
        for array, before in zip(self.shapes, kept["shapes"], strict=True):
            array[:old] = before

    def take(
        self, wanted: Ints, mass: Floats, radius: Floats, center: Floats, other: Floats, ahead: Bools, firm: Bools
    ) -> int:  # fmt: skip
        """Assign bodies to people and return the number of people without a free body.

        Args:
            wanted: agents, by decreasing priority.
            mass, radius: masses ``[W]`` [kg] and limb radii ``[W, L]`` [m].
            center: heights of the centre of mass ``[W]`` [m].
            other: mass of the nearest mover ``[W]`` [kg].
            ahead: whether it is ahead of the person ``[W]``.
            firm: whether contacts cannot move it ``[W]``.
        """
        rank = {int(agent): k for k, agent in enumerate(wanted[: len(self.agent)])}
        gone = np.array([s for s, agent in enumerate(self.agent) if agent >= 0 and int(agent) not in rank], dtype=int)
        self._park(gone)
        have = {int(agent) for agent in self.agent if agent >= 0}
        free = [s for s in range(len(self.agent)) if self.agent[s] < 0]
        for agent in rank:
            if agent not in have:
                self.agent[free.pop(0)] = agent
        for slot in np.flatnonzero(self.agent >= 0):
            k = rank[int(self.agent[slot])]
            self._embody(int(slot), float(mass[k]), radius[k], float(other[k]), bool(ahead[k]), bool(firm[k]))
            self._center[slot] = center[k]
        return max(0, len(wanted) - len(self.agent))

    def agent_of(self, slot: int) -> int:
        """Return the agent that has a body, -1 for none."""
        return int(self.agent[slot])

    def swing_of(self) -> Floats:
        """Return the velocities of the limb ends ``[S, L, 6]`` [m/s] relative to their bodies."""
        return self.swing

    def limb_ends(self, agent: int) -> Floats | None:
        """Return both ends of the limbs of an agent ``[L, 6]`` [m] in the engine; None without a body."""
        slots = np.flatnonzero(self.agent == agent)
        if not len(slots):
            return None
        x, y = self._data.qpos[self._place[slots[0]] + np.arange(2)].tolist()
        return np.asarray(self._limbs_now[slots[0]] + (x, y, 0.0, x, y, 0.0))

    def begin(
        self, place: Floats, way: Floats, before: Floats, after: Floats, duration: float, heading: Floats
    ) -> None:  # fmt: skip
        """Set the targets of all bodies for the next step of the world.

        Args:
            place: positions ``[A, 2]`` [m].
            way: velocities ``[A, 2]`` [m/s] towards the positions of the crowd model.
            before, after: both limb ends ``[A, L, 6]`` at the start and the end of the step, relative to the body.
            duration: duration of the step [s].
            heading: headings ``[A]`` [rad].
        """
        here, self._heading = self._here, heading
        agents = self.agent[here]
        self._way[here] = way[agents]
        self._begin, self._duration = place, duration
        touched = (self._touched[here] > 0) & ~np.isin(agents, self.led)
        held = here[touched]  # a person in contact cannot change velocity immediately
        self._off[held] = self._velocity(held) - self._way[held]
        self.pushed[:] = np.any(self._off != 0.0, axis=1)
        self._quiet = self._quiet and not self.pushed.any()
        if self.balance is not None:
            self.pushed[here] |= self.balance.unsteady[agents]
            self._quiet = self._quiet and not self.pushed.any()
        self._limbs = (before[agents], after[agents])
        self._stride[here] = self.swing[here] = (after[agents] - before[agents]) / duration
        for axis in (0, 1):
            self._data.qpos[self._place[here] + axis] = place[agents, axis]
            self._data.qvel[self._speed[here] + axis] = way[agents, axis] + self._off[here, axis]

    def go(self, share: float) -> None:
        """Pose the limbs at this fraction of the step, and apply the resistance of pushed people."""
        here = self._here
        if not len(here):
            return
        self._move(here, (1.0 - share) * self._limbs[0] + share * self._limbs[1])
        self.shapes.write_poses(self._model, self.geoms.ravel())
        self._lead(share)
        force = np.zeros((len(here), 2))
        if np.any(self.pushed):
            force = self._braced(here)
        if self.pushes:
            force += self._push(here, self.pushes)
        for axis in (0, 1):
            self._data.qfrc_applied[self._speed[here] + axis] = force[:, axis]

    def register_contacts(self, contacts: Sequence[EngineContact]) -> None:
        """Record people pushed in the last engine step, and let pressed limbs yield."""
        if not contacts and self._quiet:
            return
        self._touched, self._wary = np.maximum(self._touched - 1, 0), np.maximum(self._wary - 1, 0)
        fresh = self.step / REACTION
        self._load *= 1.0 - fresh
        for contact in contacts:
            for party, limb, sign, other in (
                (contact.first, contact.first_part, -1.0, contact.second),
                (contact.second, contact.second_part, 1.0, contact.first),
            ):
                if party.kind == "person" and party.number in self.agent:  # riders are parts of robots
                    slot = int(np.flatnonzero(self.agent == party.number)[0])
                    self._touched[slot] = self._hold
                    if self.balance is not None and party.number not in self.led:
                        change = sign * contact.force[:2] * (self.step / self._mass[slot])
                        self.balance.push(party.number, change, float(contact.point[2]), other)
                    self._beware(slot, -sign * contact.normal)
                    row = LIMB_NAMES.index(limb)
                    self._load[slot, row] += fresh * sign * contact.force
                    self._lift(slot, limb, sign * float(contact.normal[2]), contact.depth)
                    if self._since[slot] >= REACTION / self.step:
                        self._give_way(slot, limb, self._load[slot, row])
        here = self._here
        if len(here):
            now = self._velocity(here)
            self.pushed[here] |= np.any(now != self._way[here] + self._off[here], axis=1)
        self._since[self.pushed] += 1
        self._quiet = not (contacts or self._touched.any() or self._wary.any() or self.pushed.any() or self._load.any())

    def _lead(self, share: float) -> None:
        """Keep the bodies that are led from outside on their path, at the end of the engine step before ``share``."""
        for slot in np.flatnonzero(np.isin(self.agent, self.led)) if len(self.led) else ():
            self._off[slot], self.pushed[slot] = 0.0, False
            place = self._begin[self.agent[slot]] + (share * self._duration - self.step) * self._way[slot]
            self._data.qpos[self._place[slot] + np.arange(2)] = place
            self._data.qvel[self._speed[slot] + np.arange(2)] = self._way[slot]

    def _beware(self, slot: int, towards: Floats) -> None:
        """Remember the direction of what a person touched."""
        size = math.hypot(towards[0], towards[1])
        if size > TREAD:
            self._toward[slot], self._wary[slot] = towards[:2] / size, round(GUARDED / self.step)

    def _lift(self, slot: int, limb: str, upwards: float, depth: float) -> None:
        """Raise the arm or leg of a limb off the object below it."""
        rows = chain_rows(limb)
        if upwards < TREAD or not rows:
            return
        up = min(depth / upwards, QUICK * self.step)
        raised = self._limbs_now[slot, rows][:, [2, 5]] + up
        if np.max(raised - self._walk_now[slot, rows][:, [2, 5]]) <= LIFTED:
            self._limbs_now[slot, rows] += (0.0, 0.0, up, 0.0, 0.0, up)

    def _give_way(self, slot: int, limb: str, force: Floats) -> None:
        """Move the arm or leg of a limb in the direction of the force if the force is too large to resist."""
        size = float(np.sqrt(force @ force))
        rows = chain_rows(limb)
        if size <= BRACE or not rows:
            return
        shift = min(1.0, size / BRACE - 1.0) * GIVE * self.step * force / size
        shift[2] = max(0.0, shift[2])  # not into the floor
        moved = self._limbs_now[slot, rows] + np.tile(shift, 2)
        away = np.sqrt(np.sum((moved - self._walk_now[slot, rows]).reshape(-1, 3) ** 2, axis=1))
        if away.max() <= GIVEN:
            self._limbs_now[slot, rows] = moved

    def end(self) -> tuple[Ints, Floats, Floats]:
        """Return the people pushed off their path, with positions ``[P, 2]`` [m] and velocities ``[P, 2]`` [m/s]."""
        slots = np.flatnonzero(self.pushed & (self.agent >= 0) & ~np.isin(self.agent, self.led))
        velocity = self._velocity(slots)
        off = velocity - self._way[slots]
        off[np.sum(off * off, axis=1) < STEADY**2] = 0.0
        self._off[:] = 0.0
        self._off[slots] = off
        self._since[np.all(self._off == 0.0, axis=1) & (self._touched == 0)] = 0
        place = np.stack([self._data.qpos[self._place[slots] + axis] for axis in (0, 1)], axis=-1)
        return self.agent[slots], place.reshape(-1, 2), velocity

    @property
    def _here(self) -> Ints:
        return np.flatnonzero(self.agent >= 0)

    def _velocity(self, slots: Ints) -> Floats:
        return np.stack([self._data.qvel[self._speed[slots] + axis] for axis in (0, 1)], axis=-1).reshape(-1, 2)

    def _braced(self, here: Ints) -> Floats:
        """Return the horizontal forces ``[P, 2]`` [N] by which people brace, topple, step or rub on the floor."""
        error = self._way[here] - self._velocity(here)
        since = np.asarray(self._since[here] * self.step, dtype=np.float64)
        mass, center, free = self._mass[here], self._center[here], self._touched[here] == 0
        if self.balance is None:
            return recovery_force(error, mass, center, since, free)
        agents = self.agent[here]
        balance, down = self.balance, self.balance.down[agents]
        balance.advance(agents[~np.isin(agents, self.led)], self._heading, self.step)
        own = np.where(down[:, None], 0.0, balance.speed[agents])  # the rest of the error is not that of a pendulum
        force = recovery_force(error + own, mass, center, since, free) + mass[:, None] * balance.pulled[agents]
        size = np.sqrt(np.sum(error * error, axis=1))
        rubbed = mass * np.minimum(size / self.step, GRIP * GRAVITY) / np.maximum(size, 1e-12)
        return np.asarray(np.where(down[:, None], error * rubbed[:, None], force))

    def _push(self, here: Ints, pushes: ForcePushes) -> Floats:
        """Return the forces ``[P, 2]`` [N] from outside; who is pushed does not step yet."""
        force = pushes.forces(self.agent[here], self._mass[here], self.balance)
        self._touched[here[np.any(force != 0.0, axis=1)]] = self._hold
        self._quiet = False
        return force

    def unsettled(self) -> Ints:
        """Return the agents who are not on the path of the crowd model."""
        off = np.any(self._off != 0.0, axis=1) | (self._touched > 0)
        return np.asarray(self.agent[off & (self.agent >= 0)])

    def _park(self, slots: Ints) -> None:
        """Move unused bodies out of the way."""
        self.agent[slots] = -1
        self._off[slots], self._load[slots] = 0.0, 0.0
        self._touched[slots], self._since[slots] = 0, 0
        self.pushed[slots], self._late[slots], self._fresh[slots] = False, False, True
        self._wary[slots] = 0
        if not len(slots):
            return
        self.shapes.position[slots] = (0.0, 0.0, PARKED)
        for axis in (0, 1):
            self._data.qpos[self._place[slots] + axis] = 2.0 * slots if axis else 0.0
            self._data.qvel[self._speed[slots] + axis] = 0.0
            self._data.qfrc_applied[self._speed[slots] + axis] = 0.0

    def _embody(self, slot: int, mass: float, radius: Floats, other: float, ahead: bool, firm: bool) -> None:
        shapes, led = self.shapes, bool(np.isin(self.agent[slot], self.led))
        moved = None if led == firm else (other if led else mass)
        self._mass[slot] = mass
        shapes.mass[slot] = mass
        shapes.inverse_weight[slot] = (1.0 / mass, 0.0)
        shapes.size[slot, :, 0] = radius
        for limb, region in enumerate(REGIONS[ahead]):
            stiffness, damping = softness(region, mass, other, self.step, moved)
            shapes.softness[slot, limb] = (-stiffness, -damping)

    def _move(self, here: Ints, walk: Floats) -> None:
        """Move limbs according to the gait; a limb that continued its gait while blocked would press without limit."""
        shapes = self.shapes
        move_limbs(
            here, walk, self._touched, self._wary, self._toward, SPEEDS, self.step, self._fresh, self._late,
            self._stride, self._limbs_now, self._walk_now, self.swing, shapes.position, shapes.rotation, shapes.size,
            shapes.bound,
        )  # fmt: skip


SPEEDS = np.array([QUICK, RETURN, GUARD])
STEADY = 1e-4
"""A pushed person with a velocity error below this [m/s] has recovered."""
