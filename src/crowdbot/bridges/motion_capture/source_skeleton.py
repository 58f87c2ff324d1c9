"""SourceSkeleton: joints of a motion capture system and what they are in a body."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from crowdbot.core import InputError
from crowdbot.typing import Floats

MOST_JOINTS = 300
HAND, FOOT = ("hand", "wrist"), ("foot", "ankle")
LEGS = (0.25, 1.6)
"""Shortest and longest leg of a person from hip to ankle [m]."""


@dataclass(frozen=True, eq=False)
class SourceSkeleton:
    """Joints of an actor in the rest pose: x forward, y left, z up, standing upright on the floor.

    Limbs are found from the names of hands, feet and head and from the hierarchy: the parent of a hand is a forearm,
    and so on. Names can have a prefix (``Anna:LeftHand``) and twist or roll bones are skipped.

    Fields:
        names: names of the joints.
        parents: index of the parent of each joint, -1 for the root; parents come first.
        rest: positions of the joints in the rest pose ``[J, 3]`` [m].

    Raises:
        InputError: there are no two hands, two feet and a head, or a leg is not 0.25 m to 1.6 m long.

    >>> from crowdbot.bridges.motion_capture.xsens_segments import xsens_skeleton
    >>> skeleton = xsens_skeleton()
    >>> skeleton.names[skeleton.roles["thigh_l"]], [skeleton.names[k] for k in skeleton.spine]
    ('LeftUpperLeg', ['L5', 'L3', 'T12', 'T8'])
    """

    names: tuple[str, ...]
    parents: tuple[int, ...]
    rest: Floats

    def __post_init__(self) -> None:
        roles: dict[str, int] = {}
        for side, word in (("l", "left"), ("r", "right")):
            roles |= self._limb(side, word, HAND, ("hand", "lowerarm", "upperarm"))
            roles |= self._limb(side, word, FOOT, ("foot", "calf", "thigh"))
        head = [k for k, name in enumerate(self.names) if plain_name(name) == "head"]
        if not head:
            raise InputError(f"a skeleton has no joint named head; it has {', '.join(self.names)[:300]}")
        roles["head"] = head[0]
        pelvis = self._common(roles["thigh_l"], roles["thigh_r"])
        chest = self._common(roles["upperarm_l"], roles["upperarm_r"])
        object.__setattr__(self, "_roles", roles | {"pelvis": pelvis, "chest": chest} | self._extras(roles, chest))
        object.__setattr__(self, "_spine", self._path(chest, pelvis))
        for side in "lr":
            if not LEGS[0] <= self.leg_length(side) <= LEGS[1]:
                raise InputError(
                    f"a leg of a skeleton is {self.leg_length(side):.3g} m long; check the unit and the rest pose"
                )

    @property
    def roles(self) -> dict[str, int]:
        """Index of the joint of ``pelvis``, ``chest``, ``head``, ``hand_l`` and so on."""
        found: dict[str, int] = self._roles  # type: ignore[attr-defined]
        return found

    @property
    def spine(self) -> tuple[int, ...]:
        """Joints above the pelvis up to the chest, from below; empty if arms start at the pelvis."""
        found: tuple[int, ...] = self._spine  # type: ignore[attr-defined]
        return found

    def leg_length(self, side: str) -> float:
        """Return the length of the leg from hip to ankle of a side, ``l`` or ``r`` [m]."""
        hip, knee, ankle = (self.rest[self.roles[f"{name}_{side}"]] for name in ("thigh", "calf", "foot"))
        return float(np.linalg.norm(knee - hip) + np.linalg.norm(ankle - knee))

    def child_direction(self, role: str) -> Floats | None:
        """Return the direction from a joint to its children in the rest pose; None without children."""
        k = self.roles[role]
        ends = [self.rest[c] for c, parent in enumerate(self.parents) if parent == k]
        way = np.mean(ends, axis=0) - self.rest[k] if ends else np.zeros(3)
        return way if float(np.linalg.norm(way)) > 1e-3 else None

    def _limb(self, side: str, word: str, ends: tuple[str, ...], roles: Sequence[str]) -> dict[str, int]:
        wanted = {f"{a}{b}" for one in ends for a, b in ((word, one), (side, one), (one, word), (one, side))}
        found = [k for k, name in enumerate(self.names) if plain_name(name) in wanted]
        if not found:
            raise InputError(f"a skeleton has no joint such as {word.title()}{ends[0].title()}; "
                             f"it has {', '.join(self.names)[:300]}")  # fmt: skip
        chain = [found[0]]
        while len(chain) < 3:
            above = self.parents[chain[-1]]
            while above >= 0 and re.search("roll|twist", plain_name(self.names[above])):
                above = self.parents[above]
            if above < 0:
                raise InputError(f"joint {self.names[found[0]]!r} of a skeleton has not two parents")
            chain.append(above)
        return {f"{role}_{side}": k for role, k in zip(roles, chain, strict=True)}

    def _extras(self, roles: dict[str, int], chest: int) -> dict[str, int]:
        """Return the neck, collar bones and toes, where they are."""
        found: dict[str, int] = {}
        neck = self.parents[roles["head"]]
        if neck not in (-1, chest):
            found["neck"] = neck
        for side in "lr":
            collar = self.parents[roles[f"upperarm_{side}"]]
            if collar not in (-1, chest):
                found[f"clavicle_{side}"] = collar
            toes = [c for c, parent in enumerate(self.parents) if parent == roles[f"foot_{side}"]]
            if toes and "end" not in plain_name(self.names[toes[0]]):
                found[f"ball_{side}"] = toes[0]
        return found

    def _line(self, k: int) -> list[int]:
        found = [k]
        while self.parents[found[-1]] >= 0:
            found.append(self.parents[found[-1]])
        return found

    def _common(self, a: int, b: int) -> int:
        """Return the lowest joint above both."""
        above = set(self._line(b)[1:])
        for k in self._line(a)[1:]:
            if k in above:
                return k
        raise InputError(f"joints {self.names[a]!r} and {self.names[b]!r} of a skeleton are not connected")

    def _path(self, top: int, bottom: int) -> tuple[int, ...]:
        """Return the joints from above the bottom to the top; none if the top is not above it."""
        line = self._line(top)
        return tuple(reversed(line[: line.index(bottom)])) if bottom in line else ()


def plain_name(name: str) -> str:
    """Return a joint name in lower case without name space and punctuation.

    >>> plain_name("mixamorig:Left_Hand")
    'lefthand'
    """
    return re.sub(r"[^a-z0-9]", "", name.rsplit(":", maxsplit=1)[-1].lower())


def body_axes(names: Sequence[str], parents: Sequence[int], rest: Floats) -> Floats:
    """Return the matrix from the axes of a source to x forward, y left, z up, found from its rest pose.

    Args:
        names, parents: see :class:`SourceSkeleton`.
        rest: positions in the rest pose in any right-handed frame and unit ``[J, 3]``.

    Raises:
        InputError: limbs are not found, or the rest pose does not stand.

    >>> from crowdbot.bridges.motion_capture.xsens_segments import xsens_skeleton
    >>> z_up = xsens_skeleton()
    >>> body_axes(z_up.names, z_up.parents, z_up.rest[:, [1, 2, 0]] * 100.0).round().astype(int).tolist()
    [[0, 0, 1], [1, 0, 0], [0, 1, 0]]
    """
    size = float(np.linalg.norm(np.ptp(rest, axis=0)))
    if not 0.0 < size < float("inf"):
        raise InputError("a skeleton has no extent in the rest pose")
    found = SourceSkeleton(tuple(names), tuple(parents), rest * (1.9 / size))
    left = found.rest[found.roles["thigh_l"]] - found.rest[found.roles["thigh_r"]]
    up = found.rest[found.roles["head"]] - found.rest[found.roles["pelvis"]]
    y, z = (np.sign(one) * (np.arange(3) == int(np.argmax(np.abs(one)))) for one in (left, up))
    if float(y @ z) != 0.0 or not np.any(left) or not np.any(up):
        raise InputError("a skeleton does not stand in the rest pose: its hips are not beside each other")
    return np.stack([np.cross(y, z), y, z])
