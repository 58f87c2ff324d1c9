"""Legs of a robot whose body alone has a shape, wheels with vertical joints, and packages that lack a file."""

from __future__ import annotations

from pathlib import Path

import pytest

from crowdbot.core import InputError
from crowdbot.world.robots.base_kind import recognize_base
from crowdbot.world.urdf import read_urdf

MASS = "<inertial><mass value='2'/><inertia ixx='0.01' iyy='0.01' izz='0.01' ixy='0' ixz='0' iyz='0'/></inertial>"
BODY = "<collision><geometry><{shape}/></geometry></collision>"
BOX = "box size='0.3 0.4 0.5'"


def limb(name: str, x: float, y: float, drops: tuple[float, ...], kind: str = "revolute") -> str:
    """Return links and joints of a limb, each link this much [m] below the one before."""
    text, parent = "", "body"
    for k, drop in enumerate(drops):
        link = f"{name}_{k}"
        limit = "<limit lower='-1' upper='1' effort='50' velocity='5'/>" if kind == "revolute" else ""
        place = f"{x} {y} {-drop}" if k == 0 else f"0 0 {-drop}"
        text += f"<link name='{link}'>{MASS}</link><joint name='{link}_joint' type='{kind}'>"
        text += (
            f"<parent link='{parent}'/><child link='{link}'/><origin xyz='{place}'/><axis xyz='0 1 0'/>{limit}</joint>"
        )
        parent = link
    return text


def robot(folder: Path, *limbs: str, shape: str = BOX) -> Path:
    """Write a robot with a shape of its body alone."""
    file = folder / "walker.urdf"
    body = f"<link name='body'>{MASS}{BODY.format(shape=shape)}</link>"
    file.write_text(f"<robot name='walker'>{body}{''.join(limbs)}</robot>")
    return file


LOW = (
    "<link name='{1}'/><joint name='{1}_joint' type='fixed'><parent link='{0}'/><child link='{1}'/>"
    "<origin xyz='0 0 -0.6'/></joint>"
)
"""A frame far below a link."""
FOUR = ((0.3, 0.2), (0.3, -0.2), (-0.3, 0.2), (-0.3, -0.2))


def pair(*drops: float) -> tuple[str, str]:
    """Return two limbs beside each other."""
    return limb("left", 0.0, 0.1, drops), limb("right", 0.0, -0.1, drops)


@pytest.mark.parametrize(
    ("limbs", "shape", "legs", "ground"),
    [
        (pair(0.1, 0.35, 0.3), BOX, 6, -0.75),
        (pair(0.3, 0.3), BOX, 4, -0.6),
        ((*pair(0.1, 0.35, 0.3), limb("arm", 0.0, 0.3, (0.0, 0.1))), BOX, 6, -0.75),
        (pair(0.0, 0.3535, 0.3), "cylinder radius='1' length='1'", 6, -0.6535),
        (
            tuple(limb(f"leg{k}", x, y, (0.1, 0.2, 0.2)) for k, (x, y) in enumerate(FOUR)),
            BOX, 12, -0.5,
        ),
        (tuple(limb(f"leg{k}", 0.3, 0.1 * k, (0.2, 0.2)) for k in range(6)), "sphere radius='0.2'", 12, -0.4),
    ],
    ids=["biped", "short", "with an arm", "test cylinder", "quadruped", "hexapod"],
)  # fmt: skip
def test_legs_without_shapes_are_legs(limbs, shape, legs, ground, tmp_path):
    base = recognize_base(read_urdf(robot(tmp_path, *limbs, shape=shape)))
    assert (base.kind, len(base.legs), base.ground) == ("legged", legs, pytest.approx(ground))
    assert base.castors == ()


@pytest.mark.parametrize(
    "limbs",
    [
        pair(0.0, 0.1),  # arms that end beside the body
        (limb("left", 0.0, 0.1, (0.1, 0.3, 0.3)),),
        (*pair(0.0, 0.1), LOW.format("left_1", "a"), LOW.format("right_1", "b")),
        pair(0.6),
        (limb("left", 0.0, 0.1, (0.3, 0.3), kind="fixed"), limb("right", 0.0, -0.1, (0.3, 0.3), kind="fixed")),
    ],
    ids=["arms", "one", "frames below arms", "one joint", "fixed"],
)
def test_what_hangs_down_is_no_leg(limbs, tmp_path):
    base = recognize_base(read_urdf(robot(tmp_path, *limbs)))
    assert (base.kind, base.legs, base.ground) == ("planar", (), pytest.approx(-0.25))
    assert base.why == "no wheels or legs are recognized"


@pytest.mark.parametrize("count", [3, 4, 6])
def test_wheels_with_vertical_joints_are_named(count, tmp_path):
    """Exports of swerve drives may lack the joints that roll."""
    wheel = (
        "<link name='w{0}'>{1}<collision><geometry><sphere radius='0.1'/></geometry></collision></link>"
        "<joint name='steer{0}' type='continuous'><parent link='body'/><child link='w{0}'/>"
        "<origin xyz='{0} 0 -0.3'/><axis xyz='0 0 -1'/></joint>"
    )
    base = recognize_base(read_urdf(robot(tmp_path, *(wheel.format(k, MASS) for k in range(count)))))
    assert base.kind == "planar"
    assert base.why.endswith(
        "recognized: the axes of " + ", ".join(f"steer{k}" for k in range(min(4, count))) + " are vertical"
    )


INCLUDE = (
    "<robot name='r' xmlns:xacro='http://ros.org/wiki/xacro'><xacro:include filename='{}'/>"
    "<link name='a'>{}</link><joint name='j' type='fixed'><parent link='a'/><child link='b'/>"
    "<origin rpy='0 0 ${{90*deg_to_rad}}'/></joint><link name='b'/></robot>"
)  # fmt: skip


@pytest.mark.parametrize(
    ("files", "filename", "words"),
    [
        (
            {"urdf/deg_to_rad.xacro": ""}, "$(find utils)/urdf/deg_to_rad.urdf.xacro",
            "utils of the package utils lacks it, it has deg_to_rad.xacro; if that is another version",
        ),
        (
            {"urdf/materials.xacro": "", "urdf/pi.xacro": ""}, "$(find utils)/urdf/deg_to_rad.urdf.xacro",
            "utils lacks it, its folder urdf has materials.xacro, pi.xacro; if that is another version, give the right",
        ),
        ({"readme.md": ""}, "$(find utils)/urdf/deg_to_rad.xacro", "lacks it, its folder urdf has no files;"),
        ({}, "package://utils/deg_to_rad.xacro", "lacks it, its folder . has package.xml; if that"),
        (None, "$(find utils)/urdf/deg_to_rad.xacro", r"is missing \(give --package utils=FOLDER if you have it\)"),
    ],
)  # fmt: skip
def test_a_package_that_lacks_a_file_is_not_asked_for_again(files, filename, words, tmp_path):
    packages = {}
    if files is not None:
        packages["utils"] = tmp_path / "utils"
        packages["utils"].mkdir()
        for name in ("package.xml", *files):
            (packages["utils"] / name).parent.mkdir(exist_ok=True)
            (packages["utils"] / name).write_text("<package><name>utils</name></package>")
    (tmp_path / "robot").mkdir()
    main = tmp_path / "robot" / "r.xacro"
    main.write_text(INCLUDE.format(filename, MASS))
    with pytest.raises(InputError, match=f"'deg_to_rad' is not defined; the included file .*{words}"):
        read_urdf(main, packages=packages)


def below_waist(joints: int, *limbs: str) -> tuple[str, ...]:
    """Return limbs below a waist of this many joints, whose links have a mass."""
    parts = [part.replace("<parent link='body'/>", f"<parent link='waist_{joints - 1}'/>") for part in limbs]
    return (limb("waist", 0.0, 0.0, (0.05,) * joints), *parts)


ARM = limb("arm", 0.0, 0.3, (0.0, 0.1))


@pytest.mark.parametrize(
    ("joints", "limbs", "legs"),
    [
        (1, pair(0.1, 0.1, 0.3, 0.3), 8),
        (1, (*pair(0.0, 0.05, 0.05, 0.3, 0.3, 0.05), ARM), 12),
        (2, pair(0.1, 0.1, 0.3, 0.3), 8),
        (3, pair(0.1, 0.1, 0.3, 0.3, 0.05), 10),
        (1, tuple(limb(f"leg{k}", x, y, (0.1, 0.1, 0.3, 0.3)) for k, (x, y) in enumerate(FOUR)), 16),
        (4, pair(0.1, 0.1, 0.3, 0.3), 0),  # an arm with two long fingers
        (5, pair(0.2, 0.2, 0.3), 0),
        (1, pair(0.2, 0.3, 0.3), 0),  # a gripper on a lift
    ],
)
def test_legs_below_a_waist_are_legs(joints, limbs, legs, tmp_path):
    """The root of Romeo is its chest, and its legs begin below its trunk."""
    base = recognize_base(read_urdf(robot(tmp_path, *below_waist(joints, *limbs))))
    assert (base.kind, len(base.legs)) == ("legged" if legs else "planar", legs)
    assert not any(name.startswith("waist") for name in base.legs)
