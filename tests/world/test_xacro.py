"""Xacro is expanded without ROS, and never evaluated as Python."""

import pytest
from real_robots import XACRO
from xacro_texts import ERRORS, EXPANSIONS, HEAD

from crowdbot.core import RobotError, parse_xml
from crowdbot.world import read_urdf
from crowdbot.world.urdf import parse_robot_file
from crowdbot.world.urdf.folders import Folders
from crowdbot.world.urdf.robot_document import find_whole_robots
from crowdbot.world.xacro import expand_xacro


def tree(element):
    return (element.tag, dict(element.attributes), element.stray, [tree(child) for child in element.children])


def expand(inner, folder=None, **options):
    root = parse_xml(f"{HEAD}{inner}</robot>".encode(), "r.xacro")
    files = None if folder is None else Folders(folder)
    path = None if folder is None else folder / "r.xacro"
    return expand_xacro(root, "r.xacro", files, path=path, **options)


def expected(inner):
    return [tree(child) for child in parse_xml(f"<r>{inner}</r>".encode(), "r.xml").children]


@pytest.mark.parametrize(("text", "wanted"), EXPANSIONS)
def test_expansions(text, wanted):
    assert [tree(child) for child in expand(text).root.children] == expected(wanted)


@pytest.mark.parametrize(("text", "sentence"), ERRORS)
def test_what_is_wrong_is_said_with_file_and_line(text, sentence):
    with pytest.raises(RobotError) as caught:
        expand(text)
    assert sentence in str(caught.value)
    assert str(caught.value).startswith("r.xacro:1: <")
    assert len(caught.value.problems) == 1


def test_arguments_and_environment_are_given():
    text = "<xacro:arg name='n' default='a'/><a b='$(arg n)' c='$(optenv V 1 2)' d='$(eval n + \"_\" + arg(\"n\"))'/>"
    assert expand(text).root.children[0].attributes == {"b": "a", "c": "1 2", "d": "a_a"}
    given = expand(text, arguments={"n": "z"}, environment={"V": "7"})
    assert given.root.children[0].attributes == {"b": "z", "c": "7", "d": "z_z"}
    assert given.arguments == {"n": "z"}
    with pytest.raises(RobotError, match="there is no argument 'm'; the file has n"):
        expand(text, arguments={"m": "z"})


def test_the_environment_of_the_process_is_not_read(monkeypatch):
    monkeypatch.setenv("SECRET", "leak")
    assert expand("<a b='$(optenv SECRET none)'/>").root.children[0].attributes == {"b": "none"}


def write(folder, name, text):
    path = folder / name
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text)
    return path


LINK = "<link name='{}'><inertial><mass value='${{m}}'/></inertial></link>"


def test_includes_are_found_beside_the_file_and_in_packages(tmp_path):
    main = write(
        tmp_path / "my_robot",
        "urdf/main.urdf.xacro",
        f"{HEAD}<xacro:include filename='parts/a.xacro'/><xacro:include filename='$(find other)/b.xacro' ns='other'/>"
        "<xacro:a/><xacro:other.b/><joint name='j' type='fixed'><parent link='a'/><child link='b'/></joint></robot>",
    )
    write(tmp_path / "my_robot", "package.xml", "<package><name>my_robot</name></package>")
    write(
        tmp_path / "my_robot",
        "urdf/parts/a.xacro",
        f"{HEAD}<xacro:property name='m' value='2'/><xacro:macro name='a'>{LINK.format('a')}</xacro:macro></robot>",
    )
    write(tmp_path / "other", "package.xml", "<package><name>other</name></package>")
    write(
        tmp_path / "other",
        "b.xacro",
        f"{HEAD}<xacro:macro name='b'>{LINK.format('b')}</xacro:macro></robot>",
    )
    model = read_urdf(main)
    assert model.mass == 4.0
    assert list(model.links) == ["a", "b"]
    (tmp_path / "other" / "package.xml").unlink()
    assert read_urdf(main, packages={"other": tmp_path / "other"}).mass == 4.0
    with pytest.raises(RobotError, match="which is not a link"):  # the missing file would define the link b
        read_urdf(main)


def test_a_missing_include_is_told(tmp_path):
    path = write(
        tmp_path,
        "r.xacro",
        f"{HEAD}<link name='a'/><xacro:include filename='$(find nowhere)/x.xacro'/><xacro:thing/></robot>",
    )
    warnings = read_urdf(path).warnings
    assert "r.xacro:1: the included file package://nowhere/x.xacro is missing; it is left out (give" in warnings[0]
    assert "the macro 'thing' is not defined, since an included file is missing; it is left out" in warnings[1]


def test_elements_without_the_prefix_are_read_as_before_2020_with_one_remark():
    made = expand(
        "<property name='r' value='0.5'/><macro name='wheel' params='side *pose'><link name='${side}'>"
        "<insert_block name='pose'/><sphere radius='${r}'/></link></macro><macro name='sphere' params='radius'/>"
        "<if value='1'><wheel side='left'><origin xyz='0 1 0'/></wheel></if><wheel/><property/>"
        "<gazebo><include/></gazebo>"
    )
    assert [tree(child) for child in made.root.children] == expected(
        "<link name='left'><origin xyz='0 1 0'/></link><wheel/><property/><gazebo><include/></gazebo>"
    )
    assert made.ignored == (
        "r.xacro:1: <property> has no 'xacro:' before its name, which xacro no longer accepts; this one and all others"
        " like it are read as if they had",
    )


def test_a_shape_with_the_name_of_a_macro_stays_a_shape():
    made = expand("<xacro:macro name='box' params='size'><link name='${size}'/></xacro:macro><box size='1 1 1'/>")
    assert [tree(child) for child in made.root.children] == expected("<box size='1 1 1'/>")
    assert made.ignored == ()


def test_an_error_names_the_included_file(tmp_path):
    path = write(tmp_path, "r.xacro", f"{HEAD}<xacro:include filename='in.xacro'/></robot>")
    write(tmp_path, "in.xacro", f"{HEAD}\n\n<link name='${{1/0}}'/></robot>")
    with pytest.raises(RobotError, match=r"in\.xacro:3: <link>: an expression divides by zero"):
        read_urdf(path)
    write(tmp_path, "in.xacro", f"{HEAD}\n\n<link name='a'><inertial><mass value='x'/></inertial></link></robot>")
    with pytest.raises(RobotError, match=r"in\.xacro:3: <mass> value=\"x\" is not a number"):
        read_urdf(path)


@pytest.mark.parametrize("name", ["../secret.xacro", "/etc/passwd", "file:///etc/passwd", "link.xacro"])
def test_nothing_outside_is_included(tmp_path, name):
    inside = tmp_path / "robot"
    path = write(inside, "r.xacro", f"{HEAD}<xacro:include filename='{name}'/></robot>")
    secret = write(tmp_path, "secret.xacro", "<robot><link name='leak'/></robot>")
    (inside / "link.xacro").symlink_to(secret)
    with pytest.raises(RobotError, match="is outside the robot folder"):
        read_urdf(path)
    path.write_text(f"{HEAD}<link name=\"${{xacro.load_yaml('{name}')}}\"/></robot>")
    with pytest.raises(RobotError, match="is outside the robot folder"):
        read_urdf(path)


def test_a_file_that_includes_itself_is_refused(tmp_path):
    path = write(tmp_path, "r.xacro", f"{HEAD}<xacro:include filename='r.xacro'/></robot>")
    with pytest.raises(RobotError, match="more than 20 files include each other"):
        read_urdf(path)


def test_growth_through_properties_is_bounded():
    rows = "".join(f"<xacro:property name='p{k}' value='${{[p{k - 1}] * 100}}'/>" for k in range(1, 8))
    with pytest.raises(RobotError, match="longer than 10000"):
        expand(f"<xacro:property name='p0' value='1'/>{rows}<a b='${{p7}}'/>")
    texts = "".join(f"<xacro:property name='t{k}' value='{f'${{t{k - 1}}}' * 10}'/>" for k in range(1, 12))
    with pytest.raises(RobotError, match="longer than 100000 characters"):
        expand(f"<xacro:property name='t0' value='ab'/>{texts}<a b='${{t11}}'/>")


YAML = """
# wheels
wheels:
  - {name: left, y: 0.2}   # first
  - name: right
    y: -0.2
limits: {velocity: 1.5, turn: !degrees 90,
         list: [1, 2.5, 'a b', true]}
plain: some text
empty:
nested:
  deep: {a: {b: 1e-3}}
"""


def test_yaml_is_loaded(tmp_path):
    write(tmp_path, "config/w.yaml", YAML)
    text = (
        "<xacro:property name='c' value=\"${xacro.load_yaml('config/w.yaml')}\"/>"
        "<a b=\"${c['wheels'][1]['y']}\" c='${c.limits.velocity * 2}' d='${c.limits.turn}' e='${c.nested.deep.a.b}'/>"
    )
    row = expand(text, tmp_path).root.children[0].attributes
    assert row == {"b": "-0.2", "c": "3.0", "d": "1.5707963267948966", "e": "0.001"}


FOREIGN = {
    "husky/husky_description/urdf/husky.urdf.xacro": (46.034 + 4 * 2.637, 15, 4),
    "jackal/jackal_description/urdf/jackal.urdf.xacro": (16.523 + 4 * 0.477 + 0.001, 13, 4),
    "kobuki/kobuki_standalone.urdf.xacro": (2.4 + 4 * 0.01 + 0.001 + 3 * 0.0001, 10, 2),
    "turtlebot3/turtlebot3_description/urdf/turtlebot3_burger.urdf": (
        0.82573504 + 2 * 0.02849894 + 0.005 + 0.114,
        7,
        2,
    ),
    "turtlebot3/turtlebot3_description/urdf/turtlebot3_waffle.urdf": (1.3729096 + 2 * 0.02849894 + 0.124, 13, 2),
    "turtlebot3/turtlebot3_description/urdf/turtlebot3_waffle_pi.urdf": (1.3729096 + 2 * 0.02849894 + 0.124, 11, 2),
}
"""Masses [kg] summed by hand from the files, number of links and of moving joints."""


@pytest.mark.parametrize("name", FOREIGN)
def test_real_xacro_robots(urdf, name):
    mass, links, moving = FOREIGN[name]
    model = read_urdf(urdf / name, colliders="hull")
    assert model.mass == pytest.approx(mass, rel=1e-9)
    assert (len(model.links), len(model.movable)) == (links, moving)


END = {
    "husky": "; it is a part of a robot, give urdf/husky.urdf.xacro",
    "jackal": "; it is a part of a robot, give urdf/jackal.urdf.xacro",
    "kobuki": "; it is a part of a robot, give kobuki_standalone.urdf.xacro",
    "turtlebot3": "contains no <link>; a robot needs at least one",  # included in comments only
}
"""Ends of the sentences about parts of robots, by folder."""


@pytest.mark.parametrize("path", XACRO, ids=lambda path: path.name)
def test_every_real_xacro_file_is_a_robot_of_its_mass_or_a_part_that_names_the_robot(urdf, path):
    name = str(path.relative_to(urdf))
    if name in FOREIGN:
        masses = [float(item.attributes["value"]) for item in every(parse_robot_file(path).root) if item.tag == "mass"]
        assert read_urdf(path, colliders="hull").mass == pytest.approx(sum(masses), rel=1e-9)
        return
    with pytest.raises(RobotError) as caught:
        read_urdf(path, colliders="hull")
    assert len(caught.value.problems) == 1
    assert str(caught.value).endswith(END[name.partition("/")[0]])


def every(element):
    yield element
    for child in element.children:
        yield from every(child)


def test_parts_name_all_robots_that_use_them(tmp_path):
    calls = f"{HEAD}<xacro:include filename='$(find r)/parts.xacro'/><xacro:wheel/></robot>"
    write(tmp_path, "a.urdf.xacro", calls)
    write(tmp_path, "b.urdf.xacro", calls)
    write(tmp_path, "parts.xacro", f"{HEAD}<xacro:include filename='wheel.xacro'/></robot>")
    wheel = write(tmp_path, "wheel.xacro", f"{HEAD}<xacro:macro name='wheel'><link name='w'/></xacro:macro></robot>")
    with pytest.raises(RobotError, match=r"only defines macros \(wheel\).*give a.urdf.xacro or b.urdf.xacro$"):
        read_urdf(wheel)
    extra = write(tmp_path, "extra.xacro", f"{HEAD}<xacro:wheel/></robot>")  # included by an environment variable
    with pytest.raises(RobotError, match=r"'wheel' is not defined; .* give a.urdf.xacro or b.urdf.xacro$"):
        read_urdf(extra)
    alone = write(tmp_path / "alone", "x.xacro", f"{HEAD}<xacro:macro name='m'><link name='w'/></xacro:macro></robot>")
    with pytest.raises(RobotError, match="give the file that calls them$"):
        read_urdf(alone)
    assert read_urdf(tmp_path / "a.urdf.xacro").root == "w"


def test_files_that_include_each_other_name_no_robot(tmp_path):
    one = write(tmp_path, "one.xacro", f"{HEAD}<xacro:include filename='two.xacro'/></robot>")
    write(tmp_path, "two.xacro", f"{HEAD}<xacro:include filename='one.xacro'/></robot>")
    assert find_whole_robots(one, tmp_path) == ()


def test_arguments_of_real_robots(urdf):
    path = urdf / "turtlebot3/turtlebot3_description/urdf/turtlebot3_burger.urdf"
    assert "tb/base_link" in read_urdf(path, arguments={"namespace": "tb/"}, colliders="hull").links
    husky = urdf / "husky/husky_description/urdf/husky.urdf.xacro"
    with_laser = read_urdf(husky, environment={"HUSKY_UST10_ENABLED": "1"}, colliders="hull")
    assert "front_laser" in with_laser.links


def test_a_name_of_a_missing_include_names_the_include(tmp_path):
    path = write(
        tmp_path,
        "r.xacro",
        f"{HEAD}<xacro:include filename='$(find nowhere)/x.xacro'/><link name='a${{cm2m}}'/></robot>",
    )
    wanted = "'cm2m' is not defined; the included file package://nowhere/x.xacro is missing .give --package nowhere="
    with pytest.raises(RobotError, match=wanted):
        read_urdf(path)
