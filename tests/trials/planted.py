"""A trial with planted mistakes: every kind that a trial can have, each with its line and what is said of it."""

from __future__ import annotations

from typing import NamedTuple

__all__ = ["KINDS", "RICH", "VALUES", "Kind", "planted"]

RICH = """<trial name="rich" duration="20" capacity="600" robot-margin="0.1" seed="3">
  <stage walkable="-12,-6 12,-6 12,6 -12,6" wall-height="2.5">
    <wall points="-12,-5.8 -8,-5.8"/>
    <obstacle points="-1,4 1,4 1,5 -1,5"/>
    <obstacle points="-1,-5 1,-5 1,-4 -1,-4"/>
    <cube x="11" y="5.5" size="0.4" mass="3"/>
    <light x="0" y="0" brightness="0.5"/>
  </stage>
  <routing radius="0.25"/>
  <crowd name="calm" type="orca" neighbor-distance="5" time-horizon="2"/>
  <crowd name="hurried" type="social-force" relaxation-time="0.5"/>
  <crowd name="varied" type="boids" margin="uniform(0.4, 0.6)"/>
  <contact stiffness="60" iterations="4"/>
  <limits max-speed="2.5"/>
  <journey name="through">
    <zone points="-0.5,-1 0.5,-1 0.5,1 -0.5,1" aim="random"/>
    <point x="4" y="-2" tolerance="0.5"/>
  </journey>
  <journey name="inside" then="stay">
    <point x="-2" y="0"/>
  </journey>
  <agent x="6" y="2" goal="-6,2" crowd="hurried" speed="1.2"/>
  <agent x="7" y="3" journey="inside" body="man" activity="phone">
    <parameter name="time-horizon" value="2"/>
    <parameter name="max-neighbors" value="5"/>
  </agent>
  <agent x="-6" y="4.5" radius="0.3" outfit="2"/>
  <spawner name="hall" count="3" zone="-10,-3 -8,-3 -8,0 -10,0" journey="through" crowd="hurried"/>
  <spawner name="back" count="2" zone="8,1 10,1 10,3 8,3" goal="-5,-1 -4,-1 -4,1 -5,1" speed="uniform(1, 1.4)"/>
  <spawner name="pairs" count="4" zone="5,-5 8,-5 8,-3 5,-3" goal="-7,-5 -6,-5 -6,-4 -7,-4">
    <group size="2" share="0.5"/>
    <group size="1" share="1"/>
  </spawner>
  <source name="west" zone="-11,1 -10,1 -10,3 -11,3" journey="through" rate="0.2" max-count="9" crowd="varied"/>
  <source name="north" zone="2,3 4,3 4,5 2,5" goal="2,-5 4,-5 4,-4 2,-4" rate="0.1" begin="2" end="15"/>
  <exit name="east" zone="11,-4 12,-4 12,-2 11,-2"/>
  <portal name="door" zone="11,0 12,0 12,1 11,1" dx="-20"/>
  <robot name="tim" x="2" y="-3" radius="0.3">
    <goal x="2" y="2" tolerance="0.3"/>
    <drive type="differential-drive" max-speed="0.8"/>
    <navigator type="orca" safety="0.1"/>
    <sensor name="scan" type="lidar2d" rays="90" rate="10"/>
    <sensor name="touch" type="bumper" radius="0.3"/>
  </robot>
  <robot name="pep" type="pepper" x="-4" y="-3" control-period="0.1">
    <goal x="-4" y="3"/>
    <navigator type="straight" speed="0.5"/>
    <sensor name="eye" type="depth-camera" link="Head" width="24" height="18" rate="5"/>
  </robot>
  <camera name="above" x="0" y="0" z="6" pitch="1.5" width="64"/>
  <camera name="head" robot="pep" link="Head" height="48"/>
  <end collision="false"><when what="people" below="1"/></end>
  <recording period="0.2" markers="1"/>
  <sweep path="spawner[pairs]/count" values="3 4"/>
  <sweep path="robot[tim]/navigator/safety" values="0.1 0.2"/>
</trial>
"""


class Kind(NamedTuple):
    """A mistake: what stands there instead of what, and what is said of it, ``back`` lines before it."""

    old: str
    new: str
    said: str
    back: int = 0


VALUES = (
    Kind('duration="20"', 'duration="-20"', "<trial> duration=.-20. must be above 0 s and at most 86400 s"),
    Kind(
        'robot-margin="0.1"', 'robot-magin="0.1"', "<trial> has no attribute 'robot-magin', did you mean 'robot-margin'"
    ),
    Kind('seed="3"', 'seed="three"', "<trial> seed=.three. is not a number"),
    Kind('wall-height="2.5"', 'wall-height="0"', "<stage> wall-height=.0. must be at least 0.001 m and at most 100 m"),
    Kind('points="-12,-5.8 -8,-5.8"', 'points="-12,-5.8"', "<wall> points=.* must be at least 2 different points"),
    Kind('size="0.4"', 'size="inf"', "<cube> size=.inf. is not finite"),
    Kind('mass="3"', 'weight="3"', "<cube> has no attribute 'weight'"),
    Kind('brightness="0.5"', 'brightness="2"', "<light> brightness=.2. must be at most 1 and at least 0"),
    Kind('<routing radius="0.25"', '<routing radius="-0.25"', "<routing> radius=.* must be above 0 m and at most 10 m"),
    Kind('stiffness="60"', 'stiffness="-60"', "<contact> stiffness=.* must be above 0 1/s2 and at most"),
    Kind('iterations="4"', 'iterations="4.5"', "<contact> iterations=.4.5. must be a whole number"),
    Kind('max-speed="2.5"', 'max-speed="0"', "<limits> max-speed=.0. must be above 0 m/s and at most 1000000 m/s"),
    Kind('aim="random"', 'aim="randm"', "<zone> aim=.randm. must be nearest or random, did you mean 'random'"),
    Kind('y="-2" tolerance="0.5"', 'y="-2" tolerance="0"', "<point> tolerance=.0. must be above 0 m"),
    Kind('then="stay"', 'then="say"', "<journey> then=.say. must be leave or stay or again"),
    Kind('speed="1.2"', 'speed="120"', "<agent> speed=.120. must be at most 10 m/s and above 0 m/s"),
    Kind('outfit="2"', 'outfit="-2"', "<agent> outfit=.-2. must be at least 0"),
    Kind(
        'count="2"',
        'cuont="2"',
        "<spawner> has no attribute 'cuont', did you mean 'count'.; it takes name, count, zone",
    ),
    Kind(
        'speed="uniform(1, 1.4)"', 'speed="unifrm(1, 1.4)"', "<spawner> speed=.* not a distribution, did you mean 'unif"
    ),
    Kind('size="2"', 'size="0"', "<group> size=.0. must be at least 1 and at most 50"),
    Kind('size="1" ', "", "<group> needs the attribute 'size'"),
    Kind('rate="0.2"', 'rate="0,2"', "<source> rate=.0,2. is not a number"),
    Kind('max-count="9"', 'max-count="-9"', "<source> max-count=.-9. must be at least 0"),
    Kind(
        'y="-3" radius="0.3"', 'y="-3" radius="-0.3"', "<robot> radius=.-0.3. must be at least 0.001 m and at most 10 m"
    ),
    Kind('y="2" tolerance="0.3"', 'y="2" tolerence="0.3"', "<goal> has no attribute 'tolerence', did you mean 'toler"),
    Kind('width="64"', 'width="6"', "<camera> width=.6. must be at least 16 and at most 1920"),
    Kind('height="48"', 'hieght="48"', "<camera> has no attribute 'hieght', did you mean 'height'"),
    Kind('collision="false"', 'collision="no"', "<end> collision=.no. must be true or false"),
    Kind('neighbor-distance="5"', 'neighbor-distance="-5"', "<crowd> .* must be at least 0 m and at most 1e.09 m"),
    Kind(
        'relaxation-time="0.5"', 'relaxation-tme="0.5"', "<crowd> has no attribute 'relaxation-tme', did you mean 'rela"
    ),
    Kind('margin="uniform(0.4, 0.6)"', 'margin="uniform(0.4)"', "<crowd> margin=.* uniform takes 2 numbers, not 1"),
    Kind('type="boids"', 'type="bods"', "<crowd> unknown crowd model 'bods', did you mean 'boids'"),
    Kind('max-speed="0.8"', 'max-speed="0"', "<drive> .* must be finite and above 0 m/s, without an upper limit"),
    Kind('type="differential-drive"', 'type="diferential-drive"', "<drive> unknown drive .*did you mean 'differential"),
    Kind('safety="0.1"', 'safety="-0.1"', "<navigator> .* must be finite and at least 0 m, without an upper limit"),
    Kind('rays="90"', 'rays="0"', "<sensor> .* must be a whole number of at least 1 and at most 1000000"),
    Kind('type="bumper"', "", "<sensor> needs the attribute 'type'"),
    Kind('type="straight"', 'type="strait"', "<navigator> unknown navigator 'strait', did you mean 'straight'"),
    Kind('width="24"', 'width="fast"', "<sensor> width: 'fast' is not a int"),
    Kind('<crowd name="calm"', '<crowd name="calm one"', "<crowd> name=.calm one. must match"),
    Kind('zone="2,3 4,3 4,5 2,5"', 'zone="2,3 4,3"', "<source> zone=.* must be at least 3 different points"),
    Kind('markers="1"', 'markers="0"', "<recording> markers=.0. must be above 0 s and at most 1000000 s"),
    Kind("<contact ", "<contct ", "<contct> is not an element of <trial>, did you mean 'contact'"),
    Kind('<source name="west"', '<sorce name="west"', "<sorce> is not an element of <trial>, did you mean 'source'"),
    Kind("<limits ", "<qqq/><limits ", "<qqq> is not an element of <trial>; it takes"),
    Kind("<end ", "text<end ", "<trial> contains the text 'text'; values are written as attributes", back=99),
)
"""Values that are wrong by themselves: all of them are told at once."""
KINDS = (
    *VALUES,
    Kind('body="man"', 'body="mn"', "<agent> body=.mn. has 'mn', did you mean"),
    Kind('activity="phone"', 'activity="fone"', "<agent> activity=.fone. has 'fone', did you mean 'phone'"),
    Kind('begin="2" end="15"', 'begin="16" end="15"', "<source> begin 16 s must be before end 15 s"),
    Kind('dx="-20"', 'dx="0"', "<portal> needs dx or dy"),
    Kind(' below="1"', "", "<when> needs one of below and above"),
    Kind('rate="10"', 'rate="40"', "<sensor> rate 40 Hz: 0.025 s is shorter than the time step of 0.05 s"),
    Kind('type="pepper"', 'type="peper"', "<robot> type=.peper. is not a robot, did you mean 'pepper'"),
    Kind(
        'goal="-6,2" crowd="hurried"', 'goal="-6,2" crowd="hurrid"', "<agent> crowd=.* is not the name of a crowd, did"
    ),
    Kind('crowd="varied"', 'crowd="varid"', "<source> crowd=.varid. is not the name of a crowd, did you mean 'varied'"),
    Kind('journey="inside"', 'journey="insid"', "<agent> journey=.insid. is not the name of a journey, did you mean"),
    Kind(
        '-8,0 -10,0" journey="through"',
        '-8,0 -10,0" journey="throgh"',
        "<spawner> journey=.throgh. is not the name of a journey, did you mean 'through'",
    ),
    Kind('-10,3 -11,3" journey="through"', '-10,3 -11,3"', "<source> needs a goal zone or a journey"),
    Kind('name="max-neighbors"', 'name="max-neighbor"', "<parameter> max-neighbor cannot be given, did you mean"),
    Kind('value="2"', 'value="-2"', "<parameter> time-horizon=.-2. .*must be at least 0.001 s"),
    Kind('robot="pep"', 'robot="pepp"', "<camera> robot=.pepp. is not a robot, did you mean 'pep'"),
    Kind(
        'link="Head" height',
        'link="Haed" height',
        "<camera> link=.Haed. is not a link .*'Head'",
    ),
    Kind(
        'camera name="above"', 'camera name="head"', "<camera> name 'head' is already used by another camera", back=-1
    ),
    Kind('points="-1,4 1,4 1,5 -1,5"', 'points="-1,4 1,5 1,4 -1,5"', "<obstacle> points is not a simple polygon"),
    Kind('<point x="-2" y="0"', '<point x="-20" y="0"', "<point> at -20,0 lies outside the walkable area"),
    Kind('<agent x="6" y="2"', '<agent x="0" y="-4.5"', "<agent> stands at 0,-4.5, 0.00 m from a wall"),
    Kind('x="-6" y="4.5"', 'x="-6" y="5.9"', "<agent> stands at -6,5.9, 0.10 m from a wall"),
    Kind('zone="-10,-3 -8,-3 -8,0', 'zone="-10,-30 -8,-3 -8,0', "<spawner> spawn zone reaches outside"),
    Kind('goal="-5,-1 -4,-1 -4,1 -5,1"', 'goal="-5,-1 -4,1 -4,-1 -5,1"', "<spawner> goal is not a simple polygon"),
    Kind('count="4"', 'count="90"', "<spawner> only .* of 90 people fit into the spawn zone"),
    Kind('goal="2,-5 4,-5 4,-4 2,-4"', 'goal="-0.9,-4.9 0.9,-4.9 0,-4.1"', "<source> goal zone lies inside obstacle 2"),
    Kind('zone="11,-4 12,-4 12,-2 11,-2"', 'zone="31,-4 32,-4 32,-2"', "<exit> zone lies outside"),
    Kind('zone="11,0 12,0 12,1 11,1"', 'zone="11,0 12,0 13,0"', "<portal> zone is not a simple polygon"),
    Kind('<robot name="tim" x="2"', '<robot name="tim" x="20"', "<robot> starts at 20,-3 outside the walkable"),
    Kind('<goal x="-4" y="3"', '<goal x="0" y="-4.5"', "<robot> has its goal at 0,-4.5 inside obstacle 2", back=1),
    Kind(
        'control-period="0.1"', 'control-period="0.03"', "<robot> control-period 0.03 s is shorter than the time step"
    ),
    Kind('period="0.2"', 'period="0.02"', "<recording> period 0.02 s is shorter than the time step"),
    Kind(
        'path="spawner[pairs]/count"',
        'path="spawner[pair]/count"',
        "<sweep> .*does not exist: no <spawner> has the name",
    ),
    Kind('values="3 4"', 'values="3 -4"', "<sweep> with .*count=-4: <spawner> count=.-4. must be at least 0"),
    Kind(
        "navigator/safety",
        "navigatr/safety",
        "<sweep> .*does not exist: <robot> has no element 'navigatr', did you mean",
    ),
    Kind(
        'values="0.1 0.2"',
        'values="0.1 -9"',
        "<sweep> with .*safety=-9: <navigator> .* -9.0 m must be finite and at",
    ),
)


def planted(kinds: list[Kind]) -> tuple[str, list[tuple[int, str]]]:
    """Return the rich trial with these mistakes, and the line and what is said of each."""
    said = []
    for kind in kinds:
        line = RICH[: RICH.index(kind.old)].count("\n") + 1
        said.append((max(1, line - kind.back), kind.said))
    text = RICH
    for kind in sorted(kinds, key=lambda kind: -RICH.index(kind.old)):
        at = RICH.index(kind.old)
        text = text[:at] + kind.new + text[at + len(kind.old) :]
    return text, said
