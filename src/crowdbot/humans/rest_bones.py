"""RestSkeleton: bones of a person at rest, for programs that pose the whole skeleton."""

from __future__ import annotations

from typing import NamedTuple

from crowdbot.typing import Floats

from .asset import shapes
from .people import People


class RestSkeleton(NamedTuple):
    """The 28 bones of a person in the rest shape: x forward, y left, z up, feet on the floor.

    Fields:
        names: names of the bones, in the order of ``BodyPose.skeleton``.
        parents: index of the parent of each bone, -1 for the pelvis.
        head: start of each bone ``[28, 3]`` [m].
        hands: axes of the left and right hand ``[2, 3, 3]``: columns to the fingers, left, out of the back of the hand.
    """

    names: tuple[str, ...]
    parents: tuple[int, ...]
    head: Floats
    hands: Floats

    def bone(self, name: str) -> int:
        """Return the index of a bone."""
        return self.names.index(name)


def rest_skeleton(people: People, number: int = 0) -> RestSkeleton:
    """Return the bones of a person of a group, scaled to the stature of the person.

    Args:
        people: the group.
        number: index of the person.

    >>> bones = rest_skeleton(People.of(["man-20"]))
    >>> bones.names[0], len(bones.names), bones.parents[bones.bone("foot_l")] == bones.bone("calf_l")
    ('pelvis', 28, True)
    """
    every, body = shapes(), int(people.body[number])
    return RestSkeleton(
        every.bones, tuple(every.parents.tolist()), people.measures.head[number].copy(), people.rows.hands[body].copy()
    )
