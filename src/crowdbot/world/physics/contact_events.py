"""Contact events in the physics world: start, end, cause, impact speed and forces."""

from __future__ import annotations

import math
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from crowdbot.core import Storage, storable
from crowdbot.humans import LIMBS
from crowdbot.metrics import HOLD, cause_of
from crowdbot.typing import Floats

from .body_region_limits import BODY_REGION_LIMITS, region_of, two_body_force
from .contacts import ContactBody, EngineContact

CLAMPED = 0.5
"""Time under pressure [s] after which the force on a limb is quasi-static (ISO/TS 15066)."""
WINDOW = 0.1
"""Averaging window of quasi-static forces [s]; a limb without contact for longer is released."""
ANEW = 0.05
"""Time without contact [s] after which the next contact of a limb is a new impact."""
PARTS = {limb.name: limb.region for limb in LIMBS}


@storable
class ContactForce(NamedTuple):
    """Force between two bodies, averaged over one step of the world.

    Fields:
        first, second: the bodies, ordered robot, prop, person, wall.
        first_part: link of the robot.
        limb, part: limb of the person (:data:`crowdbot.humans.LIMBS`) and its part: ``head``, ``torso``, ``arm`` or
            ``leg``.
        force: magnitude of the mean force [N].
        vector: mean force ``[3]`` of the first body on the second [N].
        depth: maximum penetration [m].
        point: last contact point ``[3]`` [m].
    """

    first: ContactBody
    second: ContactBody
    first_part: str
    limb: str
    part: str
    force: float
    vector: tuple[float, float, float]
    depth: float
    point: tuple[float, float, float]


@storable
@dataclass(frozen=True)
class BodyContactEvent:
    """Contact of two bodies, from the first contact until they are separated for 0.5 s.

    Fields:
        first, second: the bodies.
        begin, end: times of the first and last contact [s].
        cause: the body that closed the distance: ``first``, ``second`` or ``mutual``; see
            :func:`crowdbot.metrics.contacts.cause_of`.
        impact_speed: closing speed of the surfaces along the normal at the first contact [m/s]. A swinging foot moves
            at three to four times the speed of the person.
        depth: maximum penetration [m].
        impulse: integral of the force [N s].
        limb, part, region: location of the hardest impact on the person: limb, part (``head``, ``torso``, ``arm`` or
            ``leg``) and region of ISO/TS 15066; empty without a person.
        peak_force: force of the hardest impact by the two-body model [N]; NaN without a person. This force and
            ``steady_force`` exclude support from below (a person stepping on something), because bodies of people
            cannot be lifted.
        steady_force: largest mean force over 0.1 s on a limb that is under pressure for 0.5 s with no gap of 0.1 s [N];
            0 without clamping. Without a person: on all parts together.
        steady_region: region of ``steady_force``; empty without a person.
        simulated_peak: largest force on one limb in one engine step [N], for comparison only. It is not an injury
            force.
    """

    first: ContactBody
    second: ContactBody
    begin: float
    end: float
    cause: str
    impact_speed: float
    depth: float
    impulse: float
    limb: str
    part: str
    region: str
    peak_force: float
    steady_force: float
    steady_region: str
    simulated_peak: float

    @property
    def duration(self) -> float:
        """Time from the first to the last contact [s]."""
        return self.end - self.begin

    @property
    def severity(self) -> float:
        """Ratio of force to limit of the region (ISO/TS 15066), maximum of impact and clamping; NaN without a person.

        Infinite for an impact on skull or face, which the standard does not allow.
        """
        if not self.region:
            return math.nan
        tissue = BODY_REGION_LIMITS[self.region]
        allowed = tissue.transient * tissue.limit
        impact = self.peak_force / allowed if allowed > 0.0 else math.inf if self.peak_force > 0.0 else 0.0
        steady = self.steady_force / BODY_REGION_LIMITS[self.steady_region].limit if self.steady_region else 0.0
        return max(impact, steady)


@storable
@dataclass
class _Pressed:
    """Force on a limb or on all limbs in a contact event; under pressure since ``since``, last at ``last``."""

    since: float
    last: float
    recent: deque[float]


@storable
@dataclass
class _Running:
    """An open contact event."""

    begin: float
    cause: str
    impact_speed: float
    end: float = 0.0
    depth: float = 0.0
    impulse: float = 0.0
    hardest: tuple[float, str, str] = (-1.0, "", "")
    steady: tuple[float, str] = (0.0, "")
    simulated_peak: float = 0.0
    pressed: dict[str, _Pressed] = field(default_factory=dict)
    region: dict[str, str] = field(default_factory=dict)


class BodyContactTracker:
    """Groups the contacts of engine steps into contact events.

    Args:
        step: time step of the engine [s].
        mass_of: returns the mass of a body [kg], infinite for a fixed one.
        limb_mass_of: returns the mass [kg] that a limb of a person has in an impact at a point ``[3]`` [m] along a
            normal ``[3]``.
        heading_of: returns the heading of a person [rad].
    """

    storage = Storage(constants=("_step", "_window", "_mass_of", "_limb_mass_of", "_heading_of"))

    def __init__(
        self, step: float, mass_of: Callable[[ContactBody], float],
        limb_mass_of: Callable[[int, str, Floats, Floats], float],
        heading_of: Callable[[int], float],
    ) -> None:  # fmt: skip
        self._step, self._mass_of, self._limb_mass_of, self._heading_of = step, mass_of, limb_mass_of, heading_of
        self._window = max(1, round(WINDOW / step))
        self._running: dict[tuple[ContactBody, ContactBody], _Running] = {}
        self._over: list[BodyContactEvent] = []
        self._sums: dict[tuple[ContactBody, ContactBody, str, str], tuple[Floats, float, Floats]] = {}

    @property
    def contact_events(self) -> tuple[BodyContactEvent, ...]:
        """All contact events so far, by start time; open events end with their last contact."""
        now = [_closed(pair, running) for pair, running in self._running.items()]
        return tuple(sorted([*self._over, *now], key=lambda one: (one.begin, one.first, one.second)))

    def add(self, time: float, contacts: tuple[EngineContact, ...]) -> None:
        """Add the contacts of the engine step that ends at ``time`` [s]."""
        if not contacts and not self._running:
            return
        pairs: dict[tuple[ContactBody, ContactBody], list[EngineContact]] = {}
        for contact in contacts:
            pairs.setdefault((contact.first, contact.second), []).append(contact)
            self._sum(contact)
        for pair, rows in pairs.items():
            self._touched(pair, rows, time)
        for pair, running in list(self._running.items()):
            self._pressed(running, pairs.get(pair, []), time)
            if time - running.end > HOLD:
                self._over.append(_closed(pair, self._running.pop(pair)))

    def forces(self, steps: int) -> tuple[ContactForce, ...]:
        """Return the mean forces of the last ``steps`` engine steps, and reset them."""
        found = []
        for (first, second, item, limb), (force, depth, point) in self._sums.items():
            mean = force / steps
            size = _size(mean)
            found.append(
                ContactForce(first, second, item, limb, PARTS.get(limb, ""), size, _three(mean), depth, _three(point))
            )
        self._sums = {}
        return tuple(sorted(found))

    def _sum(self, contact: EngineContact) -> None:
        limb = contact.second_part if contact.second.kind == "person" else ""
        limb = contact.first_part if contact.first.kind == "person" else limb
        link = contact.first_part if contact.first.kind == "robot" else ""
        key = (contact.first, contact.second, link, limb)
        force, depth, _ = self._sums.get(key, (np.zeros(3), 0.0, contact.point))
        self._sums[key] = (force + contact.force, max(depth, contact.depth), contact.point)

    def _touched(self, pair: tuple[ContactBody, ContactBody], rows: list[EngineContact], time: float) -> None:
        running = self._running.get(pair)
        if running is None:
            fastest = max(rows, key=_closing)
            cause = cause_of(fastest.normal, fastest.first_velocity, fastest.second_velocity)
            words = {"robot": "first", "person": "second", "mutual": "mutual"}
            running = _Running(time - self._step, words[cause], _closing(fastest))
            self._running[pair] = running
        running.end = time
        for contact in rows:
            running.depth = max(running.depth, contact.depth)
            if "person" in (contact.first.kind, contact.second.kind):
                self._hit(running, contact, time)

    def _hit(self, running: _Running, contact: EngineContact, time: float) -> None:
        """Evaluate an impact on a limb by the two-body model."""
        first = contact.first.kind == "person"
        person, limb = (contact.first, contact.first_part) if first else (contact.second, contact.second_part)
        known = running.pressed.get(limb)
        if known is not None and time - known.last < ANEW:
            return
        towards = contact.normal if first else -contact.normal
        heading = self._heading_of(person.number)
        ahead = float(towards[0] * math.cos(heading) + towards[1] * math.sin(heading)) >= 0.0
        region = region_of(limb, ahead)
        running.region[limb] = region
        mass = self._mass_of(contact.second if first else contact.first)
        swing = float(contact.swing @ contact.normal) * (1.0 if first else -1.0)
        surface = _closing(contact)
        body = min(surface, max(0.0, surface - swing))  # a swinging limb moves its own mass, not that of the body
        force = two_body_force(body, mass, region, self._mass_of(person))
        if surface > body:
            own = self._limb_mass_of(person.number, limb, contact.point, contact.normal)
            force = max(force, two_body_force(surface, mass, region, own))
        force *= _size(_borne(-towards))
        if force > running.hardest[0]:
            running.hardest = (force, limb, region)

    def _pressed(self, running: _Running, rows: list[EngineContact], time: float) -> None:
        """Update the force on each limb."""
        sums: dict[str, Floats] = {}
        for contact in rows:
            limb = contact.first_part if contact.first.kind == "person" else contact.second_part
            where = limb if limb in PARTS else ""
            on_limb = -contact.force if contact.first.kind == "person" else contact.force
            sums[where] = sums.get(where, np.zeros(3)) + on_limb
        borne = {where: _size(_borne(force) if where else force) for where, force in sums.items()}
        for where in sums.keys() - running.pressed.keys():
            running.pressed[where] = _Pressed(time, time, deque(maxlen=self._window))
        for where, pressed in running.pressed.items():
            force = _size(sums[where]) if where in sums else 0.0
            if where in sums:
                pressed.since = time if time - pressed.last > WINDOW else pressed.since
                pressed.last = time
            pressed.recent.append(borne.get(where, 0.0))
            running.impulse += force * self._step
            running.simulated_peak = max(running.simulated_peak, force)
            mean = sum(pressed.recent) / self._window
            if time - pressed.since >= CLAMPED and mean > running.steady[0]:
                running.steady = (mean, running.region.get(where, ""))


def _borne(push: Floats) -> Floats:
    """Return the part of a contact force that counts, without support from below.

    Bodies of people cannot be lifted; an upward force would be that of an immovable person.
    """
    return push * (1.0, 1.0, 0.0) if push[2] > 0.0 else push


def _size(vector: Floats) -> float:
    return float(np.sqrt(vector @ vector))


def _three(vector: Floats) -> tuple[float, float, float]:
    x, y, z = vector.tolist()
    return x, y, z


def _closing(contact: EngineContact) -> float:
    return max(0.0, float((contact.first_velocity - contact.second_velocity) @ contact.normal))


def _closed(pair: tuple[ContactBody, ContactBody], running: _Running) -> BodyContactEvent:
    force, limb, region = running.hardest
    return BodyContactEvent(
        *pair,
        begin=running.begin,
        end=running.end,
        cause=running.cause,
        impact_speed=running.impact_speed,
        depth=running.depth,
        impulse=running.impulse,
        limb=limb,
        part=PARTS.get(limb, ""),
        region=region,
        peak_force=force if limb else math.nan,
        steady_force=running.steady[0],
        steady_region=running.steady[1],
        simulated_peak=running.simulated_peak,
    )
