"""JointTarget: a position that a joint of a robot takes from an instant of a trial on."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from crowdbot.core import InputError
from crowdbot.trials.fields import attribute, check
from crowdbot.world import check_joint

if TYPE_CHECKING:
    from crowdbot.world import Robot


LINE = r"\S.{0,199}"


@dataclass(frozen=True, kw_only=True)
class JointTarget:
    """A target of a joint: it moves there from ``at`` on, within ``over``, and keeps the position.

    >>> wave = JointTarget(name="LShoulderPitch", target=-1.0, at=2.0, over=0.5)
    >>> wave.end
    2.5
    """

    name: str = attribute(about="name of the joint", pattern=LINE)
    target: float = attribute(about="position of the joint [rad or m], within its limits")
    at: float = attribute(0.0, about="time at which the motion begins", unit="s", min=0.0)
    over: float = attribute(0.0, about="duration of the motion at constant speed", unit="s", min=0.0)

    def __post_init__(self) -> None:
        check(self)

    @property
    def end(self) -> float:
        """Time at which the joint is at its target [s]."""
        return self.at + self.over


def joint_problems(targets: Sequence[JointTarget], robot: Robot) -> Iterator[str]:
    """Yield why the joints of a robot cannot follow targets.

    >>> from crowdbot.world import Robot
    >>> list(joint_problems([JointTarget(name="HeadYaw", target=9.0)], Robot.load("pepper")))
    ["<joint>: the joint 'HeadYaw' of pepper cannot be at 9 rad; it moves from -2.08567 to 2.08567 rad"]
    """
    last: dict[str, JointTarget] = {}
    for target in targets:
        try:
            check_joint(robot, target.name, target.target)
        except InputError as error:
            yield f"<joint>: {error}"
        before = last.get(target.name)
        if before is not None and target.at < before.end:
            yield (
                f'<joint>: the target of {target.name!r} at="{target.at:g}" begins before the one before ends at'
                f" {before.end:g} s"
            )
        last[target.name] = target


def joint_positions(
    targets: Sequence[JointTarget], posture: Mapping[str, float], before: int, now: int
) -> dict[str, float]:
    """Return the positions of the joints that move in the time after ``before`` up to ``now`` [ns].

    Args:
        targets: targets; those of one joint do not overlap.
        posture: positions of joints before their first target; 0 for others.
        before, now: interval [ns].

    >>> rise = [JointTarget(name="a", target=1.0, at=0.1, over=0.2), JointTarget(name="b", target=3.0, at=0.5)]
    >>> [joint_positions(rise, {}, k * 100_000_000, (k + 1) * 100_000_000) for k in (-1, 0, 1, 2, 3, 4)]
    [{}, {'a': 0.0}, {'a': 0.5}, {'a': 1.0}, {}, {'b': 3.0}]
    """
    result: dict[str, float] = {}
    start: dict[str, float] = {}
    for target in targets:
        begin, end = round(target.at * 1e9), round(target.end * 1e9)
        first = start.get(target.name, float(posture.get(target.name, 0.0)))
        start[target.name] = target.target
        if begin <= now and end > before:
            share = 1.0 if now >= end else (now - begin) / (end - begin)
            result[target.name] = target.target if share == 1.0 else first + share * (target.target - first)
    return result
