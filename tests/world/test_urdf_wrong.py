"""Wrong and hostile URDF: one clear sentence each with file and line, and no half-built robot."""

import numpy as np
import pytest
import trimesh
from robot_texts import joint, link, mesh, robot

from crowdbot.core import InputError, RobotError
from crowdbot.world import read_urdf
from samples import sizes

A, B, C = link("a"), link("b"), link("c")
ZERO = "<limit lower='0' upper='1' effort='1' velocity='1'/>"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("<robot name='r'>\n<link name='a'>\n</robot>", "urdf:3: this is not well-formed XML: mismatched tag"),
        ("<robot", "urdf:1: this is not well-formed XML: unclosed token"),
        ("<machine/>", "urdf:1: the root element is <machine>, expected <robot>"),
        ("<robot name='r'/>", "urdf:1: <robot> contains no <link>; a robot needs at least one"),
        (
            robot("<link name='a'><visual><geometry><sphere/></geometry></visual></link>"),
            "<sphere> needs the attribute 'radius', a number; RViz, Gazebo and MuJoCo refuse this, too",
        ),
        (robot("<link/>"), "urdf:2: <link> needs the attribute 'name'"),
        (robot(A, A), "urdf:3: <link> 'a' has a name that is already in use"),
        (robot(A, B), "<robot> the links 'a' and 'b' are both the root: no joint has them as a child"),
        (robot(A, B, C), "<robot> 3 links, 'a' and 'b' among them, are each the root"),
        (robot(A, joint("j", "fixed", "a", "z")), "urdf:3: <joint> 'j' has the child 'z', which is not a link"),
        (
            robot(link("base"), joint("j", "fixed", "bose", "base")),
            "the parent 'bose', which is not a link, did you mean 'base'?",
        ),
        (
            robot(A, B, joint("j", "weld", "a", "b")),
            "urdf:4: <joint> 'j' type='weld' must be fixed, revolute, continuous",
        ),
        (robot(A, B, joint("j", "revolut", "a", "b")), "did you mean 'revolute'?"),
        (
            robot(A, B, joint("j", "revolute", "a", "b")),
            "'j' (revolute) needs <limit lower= upper= effort= velocity=> [rad]",
        ),
        (robot(A, B, joint("", "fixed", "a", "b")), "urdf:4: <joint> needs the attribute 'name'"),
        (robot(A, "<joint name='j' type='fixed'><parent link='a'/></joint>"), "'j' needs <child link=\"...\">"),
        (robot(A, joint("j", "fixed", "a", "a")), "connects the link 'a' to itself"),
        (
            robot(A, B, joint("j", "fixed", "a", "b"), joint("k", "fixed", "a", "b")),
            "urdf:5: <joint> 'k' moves the link 'b', which is also moved by 'j': the links form a loop",
        ),
        (
            robot(A, B, C, joint("j", "fixed", "b", "c"), joint("k", "fixed", "c", "b")),
            "closes a loop of links: b <- c <- b",
        ),
        (robot(link("a", mass=-2)), 'urdf:2: <mass> value="-2" must be at least 0'),
        (robot(link("a", mass="nan")), 'urdf:2: <mass> value="nan" is not finite'),
        (robot(link("a", mass="heavy")), 'urdf:2: <mass> value="heavy" is not a number'),
        (robot(link("a", moments=(1, "inf", 1))), '<inertia> iyy="inf" is not finite'),
        (
            robot(A, B, joint("j", "continuous", "a", "b", "<origin xyz='0 nan 0'/>")),
            '<origin> xyz="0 nan 0" is not finite',
        ),
        (robot(A, B, joint("j", "continuous", "a", "b", "<origin xyz='0 0'/>")), 'xyz="0 0" must be 3 numbers'),
        (robot(A, B, joint("j", "continuous", "a", "b", "<origin xyz='0 0 1e9'/>")), "contains a number above 1e+06"),
        (robot(A, B, joint("j", "continuous", "a", "b", "<axis xyz='0 0 0'/>")), 'xyz="0 0 0" has no direction'),
        (
            robot(A, B, joint("j", "revolute", "a", "b", "<limit lower='2' upper='1' effort='1' velocity='1'/>")),
            "<limit> lower = 2 is above upper = 1",
        ),
        (
            robot(A, B, joint("j", "continuous", "a", "b", "<dynamics damping='-1'/>")),
            '<dynamics> damping="-1" must be at least 0',
        ),
        (
            robot(A, B, joint("j", "continuous", "a", "b", "<mimic joint='k'/>")),
            "'j' mimics 'k', which is not a joint",
        ),
        (robot(A, B, joint("j", "continuous", "a", "b", "<mimic joint='j'/>")), "'j' mimics itself through 'j'"),
        (
            robot(A, B, C, joint("j", "floating", "a", "b"), joint("k", "continuous", "b", "c", "<mimic joint='j'/>")),
            "'k' mimics 'j'; only revolute, continuous and prismatic joints can",
        ),
        (robot(link("a", "<visual/>")), "urdf:2: <visual> needs <geometry>"),
        (robot(link("a", "<visual><geometry/></visual>")), "<geometry> must contain one of <box>, <cylinder>"),
        (robot(link("a", "<visual><geometry><box size='1 2'/></geometry></visual>")), 'size="1 2" must be 3 numbers'),
        (robot(link("a", "<visual><geometry><box/></geometry></visual>")), "<box> needs the attribute 'size'"),
        (robot(link("a", "<visual><geometry><box size='1 0 1'/></geometry></visual>")), 'size="1 0 1" must be above 0'),
        (
            robot(link("a", "<collision><geometry><cylinder radius='-1' length='1'/></geometry></collision>")),
            '<cylinder> radius="-1" must be above 0',
        ),
        (
            robot(link("a", "<visual><geometry><cylinder radius='1' length='1e200'/></geometry></visual>")),
            '<cylinder> length="1e200" must be at least 1e-09 m and at most 1e+06 m',
        ),
        (robot(link("a", "<visual><geometry><sphere radius='1e-320'/></geometry></visual>")), "must be at least 1e-09"),
        (robot(link("a", "<visual><geometry><box size='1 1 1e-320'/></geometry></visual>")), "must be at least 1e-09"),
        (robot(link("a", "<visual><geometry><mesh/></geometry></visual>")), "<mesh> needs the attribute 'filename'"),
        (robot(link("a", mesh("a.stl", scale="1 0 1"))), '<mesh> scale="1 0 1" must not be 0'),
    ],
)
def test_what_is_wrong_is_said(text, message):
    with pytest.raises(RobotError) as caught:
        read_urdf(text)
    assert message in str(caught.value)
    assert all(problem.startswith("urdf:") for problem in caught.value.problems)


def test_everything_is_said_at_once_in_the_order_of_lines():
    text = robot(link("a", mass=-1), link("b", mass="x"), joint("j", "wobbly", "a", "b"))
    with pytest.raises(RobotError) as caught:
        read_urdf(text)
    assert [problem.split(":")[1] for problem in caught.value.problems] == ["2", "3", "4"]


def test_the_sentence_names_the_file(tmp_path):
    path = tmp_path / "bad.urdf"
    path.write_text(robot(link("a", mass=-1)))
    with pytest.raises(RobotError, match="bad.urdf:2: <mass> value"):
        read_urdf(path)
    with pytest.raises(RobotError, match="there is no URDF file"):
        read_urdf(tmp_path / "absent.urdf")
    with pytest.raises(RobotError, match="is not a file"):
        read_urdf(tmp_path)
    (tmp_path / "empty.urdf").write_text("")
    with pytest.raises(RobotError, match="empty.urdf is empty; a URDF is an XML file with the root element <robot>"):
        read_urdf(tmp_path / "empty.urdf")


def test_an_entity_bomb_and_external_entities_are_refused(tmp_path):
    secret = tmp_path / "secret.txt"
    secret.write_text("do not read me")
    bomb = "".join(f'<!ENTITY e{k} "{f"&e{k - 1};" * 10 if k else "boom"}">' for k in range(12))
    for declared in (bomb, f'<!ENTITY e11 SYSTEM "file://{secret}">'):
        text = f"<!DOCTYPE robot [{declared}]>\n<robot name='r'><link name='&e11;'/></robot>"
        with pytest.raises(RobotError, match="urdf:1: a URDF must not have a DOCTYPE or entities") as caught:
            read_urdf("  " + text)
        assert "do not read me" not in str(caught.value)


def test_size_depth_and_number_have_limits():
    with pytest.raises(RobotError, match="more than 20 levels"):
        read_urdf("<robot>" + "<a>" * 30 + "</a>" * 30 + "</robot>")
    with pytest.raises(RobotError, match="larger than 4000000 bytes"):
        read_urdf("<robot>" + " " * 4_000_001 + "</robot>")
    with pytest.raises(RobotError, match="more than 2000 links"):
        read_urdf(robot(*(f"<link name='l{k}'/>" for k in range(2001))))


def test_a_long_chain_of_links_is_read():
    links = [link(f"l{k}") for k in range(500)]
    joints = [joint(f"j{k}", "fixed", f"l{k}", f"l{k + 1}", "<origin xyz='0 0 1'/>") for k in range(499)]
    model = read_urdf(robot(*reversed(joints), *reversed(links)))
    assert next(iter(model.links)) == "l0"
    assert model.poses()["l499"][2, 3] == 499.0


@pytest.mark.parametrize(
    "name",
    [
        "../secret.stl",
        "meshes/../../secret.stl",
        "package://robot/../../secret.stl",
        "package://robot/../secret.stl",
        "package://../secret.stl",
        "model://x/../../secret.stl",
        "file:///etc/passwd",
        "file://{outside}/secret.stl",
        "file://{outside}/robot/../secret.stl",
        "file://%2e%2e/secret.stl",
        "/etc/passwd",
        "link.stl",
    ],
)
def test_a_mesh_that_leaves_the_folder_is_not_read(tmp_path, name):
    folder = tmp_path / "robot"
    folder.mkdir()
    (tmp_path / "secret.stl").write_text("solid secret")
    (folder / "link.stl").symlink_to(tmp_path / "secret.stl")
    path = folder / "robot.urdf"
    path.write_text(robot(link("a", mesh(name.format(outside=tmp_path)))))
    model = read_urdf(path)
    assert "is outside the robot folder" in model.warnings[0]
    assert model.meshes == {}
    assert model.mesh_files == {}


@pytest.mark.parametrize(
    ("text", "remark"),
    [
        (
            robot("<link name='a'><visual><geometry><box size='1 1 1'/></geometry><material name='m'>"
                  "<color rgba='1 0 0 1'/></material><material name='n'/></visual></link>"),
            "<material> occurs more than once in <visual>; the first one is used",
        ),
        (
            robot(link("a", "<visual><geometry><sphere radius='1'/><box size='1 1 1'/></geometry></visual>")),
            "<geometry> contains 2 shapes; the first one, <sphere>, is used",
        ),
        (
            robot(link("a", "<visual><geometry><sphere radius='1'/></geometry><geometry/></visual>")),
            "<geometry> occurs more than once in <visual>; the first one is used",
        ),
        (
            robot(A, B, joint("j", "continuous", "a", "b", "<limit effort='9' velocity='2'/><limit/>")),
            "<limit> occurs more than once in <joint>; the first one is used",
        ),
        (
            robot(A, B, joint("j", "continuous", "a", "b", "<dynamics damping='1' spring_stiffness='{k}'/>")),
            'spring_stiffness="{k}" is not a number; it is ignored',
        ),
        (
            robot(A, B, joint("j", "continuous", "a", "b", "<dynamics spring_stiffness='-1'/>")),
            'spring_stiffness="-1" must be at least 0; it is ignored',
        ),
        (
            robot(A, B, C, joint("k", "continuous", "a", "c"), joint("j", "fixed", "a", "b", "<mimic joint='k'/>")),
            "<mimic> is ignored: a fixed joint does not move",
        ),
    ],
)  # fmt: skip
def test_parts_that_are_not_used_are_remarks(text, remark):
    assert any(remark in sentence for sentence in read_urdf(text).warnings)


@pytest.mark.parametrize("name", ["http://example.org/a.stl", "https://a/b.stl", "ftp://a/b.stl", "data://x"])
def test_nothing_is_fetched(name):
    model = read_urdf(robot(link("a", mesh(name))))
    assert "is not supported; use package://, file:// or a relative path" in model.warnings[0]


def test_names_of_files_have_a_limit():
    assert "is too long for a file name" in read_urdf(robot(link("a", mesh("x" * 2000)))).warnings[0]


def test_a_folder_that_was_given_may_be_read(tmp_path):
    (tmp_path / "parts").mkdir()
    trimesh.creation.box((1.0, 1.0, 1.0)).export(tmp_path / "parts" / "box.stl")
    (tmp_path / "robot").mkdir()
    path = tmp_path / "robot" / "robot.urdf"
    path.write_text(robot(link("a", mesh("package://parts/box.stl"))))
    warnings = read_urdf(path).warnings
    assert warnings[0].startswith("the package 'parts' is not found, and a mesh file of it is missing (give --package")
    assert "the mesh file package://parts/box.stl is missing" in warnings[1]
    model = read_urdf(path, packages={"parts": tmp_path / "parts"})
    assert model.warnings == ()
    path.write_text(robot(link("a", mesh("package://parts/../secret.stl"))))
    assert "is outside the robot folder" in read_urdf(path, packages={"parts": tmp_path / "parts"}).warnings[0]


def test_wrong_words_for_colliders():
    with pytest.raises(InputError, match="colliders = 'exact' must be auto, hull or pieces"):
        read_urdf(robot(A), colliders="exact")


def refused_or_read(text):
    """Return the problems of a text, and the model when there are none."""
    try:
        return (), read_urdf(text)
    except RobotError as error:
        return error.problems, None


@pytest.mark.parametrize("count", sizes(40, 60))
@pytest.mark.parametrize("name", ["pepper/pepper.urdf", "urdf_tutorial/07-physics.urdf"])
def test_damaged_files_are_refused_or_read_but_never_crash(urdf, name, count):
    whole = (urdf / name).read_bytes()
    rng = np.random.default_rng(5)
    outcomes = set()
    for _ in range(count):
        data = bytearray(whole)
        for place in rng.integers(0, len(data), rng.integers(1, 6)):
            data[place] = int(rng.choice(list(b"<>\"'/ 0e-n&\x00\xff")))
        text = bytes(data[: rng.integers(len(data) // 2, len(data) + 1)] if rng.random() < 0.2 else data)
        problems, model = refused_or_read("<" + text.decode("latin-1").lstrip()[1:])
        outcomes.add("read" if model else "refused")
        assert bool(problems) == (model is None)
        if model:
            assert np.isfinite(model.mass)
            assert all(np.all(np.isfinite(pose)) for pose in model.poses().values())
    assert outcomes == {"read", "refused"}


SWAPS = [("<mass", "<inertia"), ('"0', '"-'), ("link", "joint"), ("xyz", "rpy"), ('="', '=" ')]


@pytest.mark.parametrize("swap", SWAPS)
def test_swapped_words_are_refused_or_read(urdf, swap):
    text = (urdf / "urdf_tutorial" / "07-physics.urdf").read_text().replace(*swap)
    problems, model = refused_or_read(text[text.index("<robot") :])
    assert bool(problems) == (model is None)
    assert all(problem.startswith("urdf:") for problem in problems)
