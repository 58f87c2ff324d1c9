"""Recognition of wheels, castors and the kind of base of a robot model."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import NamedTuple

import numpy as np

from crowdbot.core import InputError, did_you_mean
from crowdbot.typing import Floats
from crowdbot.world.urdf import Cylinder, Joint, LinkShape, RobotModel
from crowdbot.world.urdf.transforms import transform_points

BASE_KINDS = (
    "differential", "skid-steer", "ackermann", "tricycle", "mecanum", "omnidirectional", "legged", "planar",
)  # fmt: skip
"""Kinds of base; ``planar`` is a base without wheels and legs that are recognized."""
WAIST, LEG = 3, 4
"""Most joints of a waist, and fewest of a leg below it: fingers of a hand on an arm share more and have fewer."""
LIFT = 0.3
"""Travel [m] above which a sliding joint belongs to a lift, not to a leg."""
NEAR_GROUND = 0.03
"""Height [m] above the lowest point up to which a part stands on the ground."""
TOUCHES = 0.008
"""Height [m] above the lowest point up to which a part without wheels touches the ground."""
UPS = {
    "y": ((0, 1, 0), "1.5708 0 0"), "-y": ((0, -1, 0), "-1.5708 0 0"),
    "x": ((1, 0, 0), "0 -1.5708 0"), "-x": ((-1, 0, 0), "0 1.5708 0"),
}  # fmt: skip
"""Axes that CAD exports may take for up, with their directions and the rpy of a joint that turns them to z."""
PLUGINS = {
    "skid": "skid-steer", "mecanum": "mecanum", "planar_move": "omnidirectional",
    "force_based_move": "omnidirectional", "omni": "omnidirectional",
    "holonomic": "omnidirectional", "ackermann": "ackermann", "tricycle": "tricycle", "diff": "differential",
}  # fmt: skip
"""Kinds by a part of the name of a Gazebo plugin or controller."""


class FoundWheel(NamedTuple):
    """A wheel: joint, link, radius [m], centre ``[3]`` and axle ``[3]`` in the root frame, and steering joint."""

    joint: str
    link: str
    radius: float
    center: Floats
    axle: Floats
    steering: str


class BaseKind(NamedTuple):
    """What is known of a base.

    Fields:
        kind: one of :data:`BASE_KINDS`.
        why: reason, a part of a sentence.
        wheels: all wheels without castors.
        driven: joints of the driven wheels.
        castors: links that roll or glide on the ground without a motor.
        legs: joints of legs.
        ground: height [m] of the lowest point in the root frame.
        turned: what is wrong if the robot lies on its side: it has wheels if another axis than z is up. Else empty.
    """

    kind: str
    why: str
    wheels: tuple[FoundWheel, ...]
    driven: tuple[str, ...]
    castors: tuple[str, ...]
    legs: tuple[str, ...]
    ground: float
    turned: str = ""

    @property
    def track(self) -> float:
        """Distance [m] between the left and right wheels; 0 without wheels."""
        sides = [float(wheel.center[1]) for wheel in self.wheels]
        return max(sides) - min(sides) if sides else 0.0

    @property
    def rear(self) -> float:
        """Position x [m] of the axle around which the base turns: unsteered wheels, or the middle of all."""
        fixed = [float(wheel.center[0]) for wheel in self.wheels if not wheel.steering]
        return sum(fixed) / len(fixed) if fixed else 0.0

    @property
    def wheelbase_of_axles(self) -> float:
        """Distance [m] between the first and the last axle of all wheels."""
        places = [float(wheel.center[0]) for wheel in self.wheels]
        return max(places) - min(places) if places else 0.0

    @property
    def rolls_sideways(self) -> bool:
        """Whether the wheels of a base without rollers and steering of all wheels roll along y instead of x."""
        fixed = [wheel for wheel in self.wheels if not wheel.steering]
        return self.kind in ("differential", "skid-steer", "ackermann", "tricycle", "planar") and bool(
            fixed and all(abs(wheel.axle[0]) > 0.9 for wheel in fixed)
        )

    @property
    def axles(self) -> int:
        """Number of axles: groups of wheels whose places differ by less than half a radius."""
        places = sorted(float(wheel.center[0]) for wheel in self.wheels)
        least = 0.5 * max((wheel.radius for wheel in self.wheels), default=0.0)
        return sum(k == 0 or place - places[k - 1] > least for k, place in enumerate(places))

    @property
    def wheelbase(self) -> float:
        """Distance [m] between steered and other wheels; 0 without steering."""
        steered = [float(wheel.center[0]) for wheel in self.wheels if wheel.steering]
        return abs(sum(steered) / len(steered) - self.rear) if steered else 0.0


def recognize_base(model: RobotModel, plugins: tuple[str, ...] = (), kind: str = "") -> BaseKind:
    """Return wheels and kind of base of a robot.

    A wheel is a rotating joint with a horizontal axle whose round child stands on the ground. Wheels below a vertical
    joint without limits, or with "cast" in their name, are castors; if there are no others, those below a vertical
    joint are driven and steered. The kind follows from plugins, otherwise from the number, places and steering joints
    of the wheels.

    Args:
        model: the robot.
        plugins: names of Gazebo plugins and controllers.
        kind: kind of base, if it is known.

    Raises:
        InputError: ``kind`` is unknown.
    """
    if kind and kind not in BASE_KINDS:
        raise InputError(
            f"the kind of base {kind[:40]!r} must be {', '.join(BASE_KINDS)}{did_you_mean(kind, BASE_KINDS)}"
        )
    poses = model.poses()
    points = {name: _points(model, name, poses) for name in model.links}
    solid = [rows for rows in points.values() if len(rows)]
    ground = float(min(rows[:, 2].min() for rows in solid)) if solid else 0.0
    found_wheels: list[FoundWheel] = []
    loose: list[FoundWheel] = []
    for joint in model.movable:
        wheel = _wheel(model, joint, poses, points[joint.child], ground)
        if wheel is None and model.links[joint.child].collisions:  # the collision shape of a wheel may be a box
            wheel = _wheel(model, joint, poses, _outline(model.links[joint.child].visuals, poses[joint.child]), ground)
        if wheel is not None:
            (loose if _is_castor(model, joint) else found_wheels).append(wheel)
    if not found_wheels:  # castors alone cannot drive a robot: they have motors
        found_wheels, loose = (
            [wheel for wheel in loose if wheel.steering],
            [wheel for wheel in loose if not wheel.steering],
        )
    castors = [wheel.link for wheel in loose]
    legs, feet = ((), ground) if found_wheels or castors else _legs(model, points, poses, ground)
    ground = min(ground, feet)
    moving = {name for wheel in found_wheels for name in _below(model, wheel.link)}
    for name, rows in points.items():
        below = len(rows) > 0 and rows[:, 2].min() < ground + TOUCHES
        if below and name not in moving and name not in castors and not legs:
            castors.append(name)
    named, why = (kind, "given") if kind else _kind(found_wheels, legs, plugins, model)
    driven = tuple(wheel.joint for wheel in _driven(found_wheels, named, model))
    turned = "" if found_wheels or (castors and loose) or legs or named != "planar" else _turned(model, points)
    return BaseKind(named, why, tuple(found_wheels), driven, tuple(castors), legs, ground, turned)


def _turned(model: RobotModel, points: Mapping[str, Floats]) -> str:
    """Return what is wrong with a robot that has wheels if another axis than z is up, as a sentence.

    SolidWorks exports in the axes of the drawing, whose up is often y. Round parts at both ends of an axle that would
    stand on the ground are wheels; parts without a mesh have the box of their inertia, so that corners do not count.
    """
    poses, found = model.poses(), dict[str, list[Joint]]()
    for name, (direction, _) in UPS.items():
        heights = {link: rows @ np.array(direction, dtype=np.float64) for link, rows in points.items() if len(rows)}
        ground = min((float(rows.min()) for rows in heights.values()), default=0.0)
        for joint in model.movable:
            if joint.kind == "continuous" and joint.child in heights:
                low, high = float(heights[joint.child].min()), float(heights[joint.child].max())
                axle = poses[joint.child][:3, :3] @ joint.axis
                wide = float(np.ptp(points[joint.child] @ np.cross(axle, direction)))
                flat = abs(float(axle @ np.array(direction))) < 0.2
                if flat and low < ground + NEAR_GROUND and abs(wide - (high - low)) < 0.2 * (high - low):
                    found.setdefault(name, []).append(joint)
    found = {name: joints for name, joints in found.items() if _opposite(joints, poses)}
    if not found:
        return ""
    up = max(found, key=lambda name: len(found[name]))
    joints = found[up]
    return (
        f"the robot lies on its side: with {up} up, {', '.join(joint.name for joint in joints[:4])} would be wheels,"
        f" but up is z (REP 103); export the file with z up, or put its root {model.root!r} below a new root, with a"
        f" fixed joint of rpy={UPS[up][1]!r}"
    )


def _opposite(joints: Sequence[Joint], poses: Mapping[str, Floats]) -> bool:
    """Return whether two joints are at opposite sides of a body, along their common axle."""
    for joint in joints:
        axle = poses[joint.child][:3, :3] @ joint.axis
        for other in joints:
            away = poses[other.child][:3, 3] - poses[joint.child][:3, 3]
            along = abs(float(away @ axle))
            if along > 0.05 and float(np.linalg.norm(np.cross(away, axle))) < 0.3 * along:
                return True
    return False


def _points(model: RobotModel, name: str, poses: Mapping[str, Floats]) -> Floats:
    link = model.links[name]
    return _outline(link.collisions or link.visuals, poses[name])


def _outline(parts: Sequence[LinkShape], pose: Floats) -> Floats:
    """Return points ``[N, 3]`` of shapes at a pose."""
    rows = [transform_points(pose @ part.origin, part.shape.points()) for part in parts]
    return np.concatenate(rows) if rows else np.zeros((0, 3))


def _wheel(
    model: RobotModel, joint: Joint, poses: Mapping[str, Floats], points: Floats, ground: float
) -> FoundWheel | None:
    """Return a wheel if the child of a joint is round about a horizontal axis and stands on the ground."""
    if joint.kind not in ("continuous", "revolute") or joint.upper - joint.lower < 2.0 * math.pi or len(points) < 4:
        return None
    matrix = poses[joint.child]
    axle, center = matrix[:3, :3] @ joint.axis, matrix[:3, 3]
    if abs(axle[2]) > 0.2 or points[:, 2].min() > ground + NEAR_GROUND:
        return None
    away = points - center
    along = away @ axle
    across = np.linalg.norm(away - along[:, None] * axle, axis=1)
    radius = float(center[2] - points[:, 2].min())
    if not 0.005 < radius < 2.0 or across.max() > 1.25 * radius:
        return None
    up = float(points[:, 2].max() - center[2])
    if abs(up - radius) > 0.2 * radius:  # it is not round about the axle
        return None
    for part in model.links[joint.child].collisions:
        if isinstance(part.shape, Cylinder) and abs(part.shape.radius - radius) < 0.02 * radius:
            radius = part.shape.radius
    return FoundWheel(joint.name, joint.child, radius, center, axle, _steering(model, joint, poses))


def _steering(model: RobotModel, joint: Joint, poses: Mapping[str, Floats]) -> str:
    """Return the joint with a vertical axis and limits above a wheel, or ''."""
    for above in joints_above(model, joint):
        vertical = abs((poses[above.child][:3, :3] @ above.axis)[2]) > 0.8
        if above.size == 1 and above.kind != "prismatic" and vertical:
            return above.name
    return ""


def wheel_springs(model: RobotModel, base: BaseKind) -> tuple[str, ...]:
    """Return the vertical sliding joints between the base and its driven or steered wheels: springs.

    Args:
        model: the robot.
        base: its base.
    """
    poses, found = model.poses(), dict[str, None]()
    for wheel in base.wheels:
        for above in joints_above(model, model.joints[wheel.joint]):
            if above.kind == "prismatic" and abs((poses[above.child][:3, :3] @ above.axis)[2]) > 0.8:
                found[above.name] = None
    return tuple(found)


def joints_above(model: RobotModel, joint: Joint) -> list[Joint]:
    """Return the joints between a joint and the body of the robot, the nearest first.

    Joints above the body, as x, y and theta of a simulated base, move the whole robot.
    """
    parents = {joint.child: joint for joint in model.joints.values()}
    found, name, body = [], joint.parent, _body(model)
    while name in parents and name != body:
        found.append(parents[name])
        name = parents[name].parent
    return found


def is_locked(joint: Joint) -> bool:
    """Return whether the limits of a turning joint allow no motion."""
    return joint.kind == "revolute" and joint.lower == joint.upper


def _body(model: RobotModel) -> str:
    """Return the first link with a shape, from the root outwards as long as there is only one way."""
    name = model.root
    while not (model.links[name].collisions or model.links[name].visuals):
        below = [joint.child for joint in model.joints.values() if joint.parent == name]
        if len(below) != 1:
            break
        (name,) = below
    return name


def _below(model: RobotModel, link: str) -> set[str]:
    below = {link}
    for joint in model.joints.values():
        if joint.parent in below:
            below.add(joint.child)
    return below


def _is_castor(model: RobotModel, joint: Joint) -> bool:
    if any("cast" in name.lower() for name in (joint.name, joint.child)):
        return True
    free = [item for item in joints_above(model, joint) if item.kind == "continuous" and not item.motor.kind]
    return bool(free) and not joint.motor.kind


def _legs(
    model: RobotModel, points: Mapping[str, Floats], poses: Mapping[str, Floats], ground: float
) -> tuple[tuple[str, ...], float]:
    """Return the joints of legs, and the height [m] of the lowest foot.

    Legs are chains of at least two rotating joints whose last links are near the ground. They begin at different joints
    of the body. Fingers of a hand that hangs down do not, nor does an arm on a lift. A link with a mass and without a
    shape counts by its origin, as the feet of a model whose body alone has a shape. A model whose root is the chest
    has its waist above the legs: up to three joints that all of them share, with at least four more in each leg.
    """
    found: list[tuple[str, ...]] = []
    feet = math.inf
    for name, rows in points.items():
        bare = not len(rows) and model.links[name].inertial is not None
        lowest = float(poses[name][2, 3]) if bare else float(rows[:, 2].min()) if len(rows) else math.inf
        if lowest > ground + 2.0 * NEAR_GROUND:
            continue
        last = next((joint for joint in model.joints.values() if joint.child == name), None)
        chain = [] if last is None else [last, *joints_above(model, last)]
        turning = [joint for joint in chain if joint.kind in ("revolute", "continuous") and joint.mimic is None]
        lifted = any(joint.kind == "prismatic" and joint.upper - joint.lower > LIFT for joint in chain)
        if len(turning) >= 2 and not lifted:
            feet = min(feet, lowest)
            found.append(tuple(joint.name for joint in reversed(turning)))
    whole = [chain for chain in found if not any(other[: len(chain)] == chain != other for other in found)]
    shared = next((k for k, names in enumerate(zip(*whole, strict=False)) if len(set(names)) > 1), 0)
    if len({chain[0] for chain in found}) < 2 and not (
        0 < shared <= WAIST and all(len(chain) - shared >= LEG for chain in whole)
    ):
        return (), ground
    return tuple(dict.fromkeys(name for chain in found for name in chain[shared:])), feet


def _kind(
    wheels: list[FoundWheel], legs: tuple[str, ...], plugins: tuple[str, ...], model: RobotModel
) -> tuple[str, str]:
    """Return the kind of base and the reason."""
    steered = [wheel for wheel in wheels if wheel.steering]
    fixed = [wheel for wheel in wheels if not wheel.steering]
    for plugin in plugins:
        for word, kind in PLUGINS.items():
            if word in plugin.lower():
                several = kind == "differential" and len(wheels) >= 4
                return ("skid-steer" if several else kind), f"the plugin {plugin[:60]}"
    if not wheels:
        upright = [joint for joint in model.movable if _is_upright(model, joint)]
        others = (
            f": the axes of {', '.join(joint.name for joint in upright[:4])} are vertical" if len(upright) > 2 else ""
        )
        return (
            ("legged", f"{len(legs)} joints of legs")
            if legs
            else ("planar", f"no wheels or legs are recognized{others}")
        )
    if any("mecanum" in name.lower() for name in (*model.links, *model.joints)):
        return "mecanum", "wheels with 'mecanum' in their name"
    if len(fixed) >= 4 and any(len(_below(model, wheel.link)) > 4 for wheel in fixed):
        return "mecanum", "wheels with rollers"
    if any(abs(np.cross(wheel.axle, fixed[0].axle)[2]) > 0.3 for wheel in fixed):
        return "omnidirectional", f"{len(wheels)} wheels with axles in several directions"
    if steered and not fixed:
        return "omnidirectional", f"all {len(wheels)} wheels are steered"
    if steered:
        kind = "tricycle" if len(steered) == 1 else "ackermann"
        return kind, f"{len(steered)} steered and {len(fixed)} other wheels"
    if abs(float(fixed[0].axle[1])) < 0.8:
        return "planar", "the axles are not across the robot"
    rows = {round(float(wheel.center[0]) / (0.5 * wheel.radius)) for wheel in fixed}
    if len(fixed) >= 4 and len(rows) > 1:
        return "skid-steer", f"{len(fixed)} wheels on {len(rows)} axles"
    return ("differential", f"{len(fixed)} wheels on one axle") if len(fixed) > 1 else ("planar", "only one wheel")


def _is_upright(model: RobotModel, joint: Joint) -> bool:
    """Return whether a joint turns without end about a vertical axis, and nothing turns below it, as a wheel may."""
    vertical = abs(float((model.poses()[joint.child][:3, :3] @ joint.axis)[2])) > 0.8
    below = _below(model, joint.child)
    return joint.kind == "continuous" and vertical and not any(item.parent in below for item in model.movable)


def _driven(wheels: list[FoundWheel], kind: str, model: RobotModel) -> list[FoundWheel]:
    """Return the wheels that have motors: in a tricycle the steered one, in a car the others.

    A tricycle whose file gives motors to the unsteered wheels alone is driven by these.
    """
    steered = [wheel for wheel in wheels if wheel.steering]
    fixed = [wheel for wheel in wheels if not wheel.steering]
    if kind == "tricycle":
        motors = [bool(model.joints[wheel.joint].motor.kind) for wheel in (*steered, *fixed)]
        return fixed if any(motors[len(steered) :]) and not any(motors[: len(steered)]) else steered
    return fixed if kind == "ackermann" else wheels
