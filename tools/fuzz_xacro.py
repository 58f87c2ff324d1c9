"""Samples of xacro, hostile expressions in them, and how they are read."""

from __future__ import annotations

import random
import re
import sys
from pathlib import Path

from fuzzing import mutate_xml, replace_one

sys.path.append(str(Path(__file__).parents[1] / "tests" / "world"))

EXPRESSION = re.compile(r"\$[{(][^{}()]*[})]")
PLACE = re.compile(r'(?<=")[^"<>]*\$\{[^"<>]*(?=")|(?<==")[^"<>]*(?=")')
HOSTILE_EXPRESSIONS = (
    "__import__('os').system('touch pwned')", "().__class__.__bases__[0].__subclasses__()", "open('pwned', 'w')",
    "eval('1')", "exec('x = 1')", "lambda: 1", "9 ** 9 ** 9", "2 ** 10000000", "'a' * 10 ** 9", "[1] * 10 ** 9",
    "[x for x in range(10 ** 9)]", "[[x, y] for x in range(9999) for y in range(9999)]", "'%999999999d' % 1",
    "'{0.__class__}'.format(1)", "'a'.__class__", "math.__dict__", "math.factorial(10 ** 6)",
    "xacro.load_yaml('/etc/passwd')", "xacro.load_yaml('../../../../etc/passwd')", "radius", "radius + ", "(" * 300,
    "-" * 5000 + "1", "[" * 90 + "]" * 90,
    "1 if", "a.b.c", "x", "nan", "float('inf')", "float('1e999')", "int('9' * 5000)", "str(2 ** 9999)", "1 / 0",
    "1 % 0", "0 ** -1", "(-1) ** 0.5", "sqrt(-1)", "1 << 100000000", "True + 'a'", "{}", "{1: [2]}[2]", "[][0]",
    "dict(a=1).b",
    "'abc'[::0]", "range(5)[9]", "'a' in 5", "max()", "min([])", "round(1, 2, 3)", "print(1)", "globals()", "\\x00",
    "é",
    "''.join(['a'] * 10 ** 9)", "'a'.replace('a', 'b' * 10 ** 8)", "'a'.ljust(10 ** 10)", "sorted(range(10 ** 9))",
)  # fmt: skip
HOSTILE_COMMANDS = (
    "find ..", "find /", "find no_such", "arg", "arg none", "env HOME", "optenv HOME", "optenv", "dirname", "anon x",
    "eval __import__('os')", "eval 1 +", "eval 9**9**9", "cwd", "find robot_description)/../../$(find x", "",
)  # fmt: skip
MAIN = """<robot name="cart" xmlns:xacro="http://ros.org/wiki/xacro">
  <xacro:arg name="laser" default="true"/>
  <xacro:property name="radius" value="0.1"/>
  <xacro:property name="wheels" value="${xacro.load_yaml('$(find robot_description)/config/wheels.yaml')}"/>
  <xacro:include filename="$(find robot_description)/urdf/wheel.urdf.xacro"/>
  <xacro:include filename="named.xacro" ns="named"/>
  <link name="base"><inertial><mass value="${10 + 4}"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>
    </inertial><visual><geometry><box size="${2 * 0.2} 0.3 0.2"/></geometry></visual></link>
  <xacro:macro name="side" params="name y *origin **more"><xacro:wheel name="${name}" y="${y}" radius="${radius}"/>
    <link name="${name}_frame"/><joint name="${name}_fixed" type="fixed"><parent link="base"/>
      <child link="${name}_frame"/><xacro:insert_block name="origin"/></joint><xacro:insert_block name="more"/>
  </xacro:macro>
  <xacro:side name="left" y="${wheels['left']['y']}"><origin xyz="0 ${0.2} 0"/><more/></xacro:side>
  <xacro:side name="right" y="${wheels.right.y}"><origin xyz="0 ${-0.2} 0" rpy="0 0 ${pi / 2}"/><more/></xacro:side>
  <xacro:if value="$(arg laser)"><xacro:named.laser size="${max(0.04, radius / 3)}"/></xacro:if>
  <xacro:unless value="${radius &gt; 0.05 and not $(arg laser)}"><material name="m"><color rgba="1 0 0 1"/></material>
  </xacro:unless>
</robot>
"""
WHEEL = """<robot xmlns:xacro="http://ros.org/wiki/xacro">
  <xacro:macro name="wheel" params="name y radius:=0.1 count:=2">
    <link name="${name}_wheel"><inertial><mass value="0.5"/>
      <inertia ixx="${0.5 * radius**2 / 4}" iyy="1e-3"
        izz="${[1e-3 for k in range(count)][1]}" ixy="0" ixz="0" iyz="0"/></inertial>
      <collision><geometry><cylinder radius="${radius}" length="0.04"/></geometry></collision></link>
    <joint name="${name}_joint" type="continuous"><parent link="base"/><child link="${name}_wheel"/>
      <origin xyz="0 ${y} 0" rpy="${-pi / 2} 0 0"/><axis xyz="0 0 1"/></joint>
    <xacro:if value="${count &gt; 2}"><xacro:wheel name="${name}_${count}" y="${y}" count="${count - 1}"/></xacro:if>
  </xacro:macro>
</robot>
"""
NAMED = """<robot xmlns:xacro="http://ros.org/wiki/xacro">
  <xacro:macro name="laser" params="size"><link name="laser"><visual><geometry><sphere radius="${size}"/></geometry>
    </visual></link><joint name="laser_joint" type="fixed"><parent link="base"/><child link="laser"/></joint>
  </xacro:macro>
</robot>
"""
PACKAGES = 20
"""Copies of the package among the samples: as many as of the small robots."""
YAML = "left: {y: 0.2, names: [a, 'b c']}\nright:\n  y: -0.2\n  turn: !degrees 90\n"


def make_xacro(folder: Path) -> None:
    """Write a package with includes, macros and YAML, and one small robot for each form of xacro."""
    from xacro_texts import EXPANSIONS, HEAD

    for number in range(PACKAGES):
        package = folder / f"package-{number}"
        (package / "urdf").mkdir(parents=True)
        (package / "config").mkdir()
        (package / "package.xml").write_text("<package><name>robot_description</name></package>", encoding="utf-8")
        (package / "urdf" / "main.xacro").write_text(MAIN, encoding="utf-8")
        (package / "urdf" / "wheel.urdf.xacro").write_text(WHEEL, encoding="utf-8")
        (package / "urdf" / "named.xacro").write_text(NAMED, encoding="utf-8")
        (package / "config" / "wheels.yaml").write_text(YAML, encoding="utf-8")
    for number, (text, _) in enumerate(EXPANSIONS):
        place = folder / f"form-{number}"
        place.mkdir()
        (place / "main.xacro").write_text(f"{HEAD}<link name='base'/>{text}</robot>", encoding="utf-8")


def read_xacro(folder: Path, name: str, rng: random.Random) -> None:
    """Expand the robot and read it, some with an argument or an environment."""
    from crowdbot.core import RobotError
    from crowdbot.world import read_urdf

    inner = folder / "urdf" / "main.xacro"
    main = inner if inner.exists() else folder / "main.xacro"
    arguments = {"laser": rng.choice(("false", "${1/0}", "x"))} if rng.random() < 0.1 and inner.exists() else None
    try:
        read_urdf(main, arguments=arguments, environment={"HOME": "a"}, colliders="hull")
    except RobotError as error:
        if folder.name not in str(error):
            raise AssertionError(f"the message names no file: {error}") from None
        raise


def mutate_xacro(text: str, rng: random.Random) -> str:
    """Return a xacro file with one to three expressions or values changed, half of them with changes of XML as well."""
    for _ in range(rng.choice((1, 1, 2, 3))):
        kind = rng.random()
        if kind < 0.4:
            text = replace_one(text, EXPRESSION, rng, lambda _: f"${{{rng.choice(HOSTILE_EXPRESSIONS)}}}")
        elif kind < 0.6:
            text = replace_one(text, EXPRESSION, rng, lambda _: f"$({rng.choice(HOSTILE_COMMANDS)})")
        elif kind < 0.8:
            text = replace_one(text, PLACE, rng, lambda _: f"${{{rng.choice(HOSTILE_EXPRESSIONS)}}}")
        else:
            words = EXPRESSION.findall(text) or [""]
            text = replace_one(text, EXPRESSION, rng, lambda _, words=words: rng.choice(words))
    return mutate_xml(text, rng) if rng.random() < 0.5 else text
