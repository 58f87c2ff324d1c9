"""Small trials that tests share."""

from __future__ import annotations

from pathlib import Path

GOOD = """<?xml version="1.0" encoding="UTF-8"?>
<trial name="small" about="four people and a robot" duration="4" step="0.05" seed="3">
  <stage walkable="-6,-3 6,-3 6,3 -6,3">
    <wall points="-6,2.9 6,2.9"/>
    <obstacle points="0,1.5 1,1.5 1,2.5 0,2.5"/>
  </stage>
  <crowd type="orca" time-horizon="2"/>
  <spawner name="east" count="2" zone="-5,-2 -3,-2 -3,1 -5,1" goal="4,-2 5,-2 5,1 4,1"/>
  <spawner name="west" count="2" zone="3,-2 5,-2 5,1" goal="-5,-2 -4,-2 -4,1" speed="uniform(1, 1.4)" radius="0.25"/>
  <robot name="robot" x="-2" y="-2.4" radius="0.3">
    <goal x="3" y="-2.4" tolerance="0.3"/>
    <drive type="differential-drive" max-speed="1"/>
    <navigator type="straight"/>
    <sensor name="scan" x="0.1" type="lidar2d" rays="90" noise="gaussian(0.01)"/>
  </robot>
  <end collision="false"/>
</trial>
"""

FLOW = """<?xml version="1.0" encoding="UTF-8"?>
<trial name="flow" duration="20" step="0.05" substeps="2" seed="2" capacity="10" robot-margin="0.2" heading-jitter="0.001">
  <stage walkable="-8,-4 8,-4 8,4 -8,4">
    <wall points="0,-4 0,-1"/>
    <wall points="0,1 0,4"/>
  </stage>
  <routing radius="0.25" unreachable="nearest"/>
  <crowd name="calm" type="orca" time-horizon="2"/>
  <crowd name="hurried" type="social-force"/>
  <contact variant="force" stiffness="50" iterations="4"/>
  <limits max-speed="2.5" max-acceleration="5"/>
  <journey name="through">
    <zone points="-0.5,-1 0.5,-1 0.5,1 -0.5,1" aim="random"/>
    <point x="4" y="-2" tolerance="0.5"/>
    <direction heading="0.3"/>
  </journey>
  <journey name="in" then="stay">
    <point x="-2" y="0"/>
  </journey>
  <spawner name="hall" count="3" zone="-4,-3 -3,-3 -3,3 -4,3" journey="through" crowd="hurried"/>
  <spawner name="back" count="1" zone="4,1 5,1 5,2 4,2" goal="-5,-1 -4,-1 -4,1 -5,1"/>
  <source name="west" zone="-7.5,-3 -6.5,-3 -6.5,3 -7.5,3" journey="through" rate="0.9" max-count="90" crowd="hurried"/>
  <source name="north" zone="-4,2 -1,2 -1,3.5 -4,3.5" goal="-4,-3.5 -1,-3.5 -1,-2 -4,-2" rate="0.5" timing="regular"
    begin="2" end="15" speed="uniform(1, 1.4)" radius="0.2"/>
  <exit name="east" zone="6.5,-4 8,-4 8,4 6.5,4"/>
  <robot name="robot" x="2" y="-3" radius="0.3">
    <goal x="2" y="3" tolerance="0.3"/>
    <drive type="differential-drive" max-speed="0.3"/>
    <navigator type="orca"/>
    <sensor name="scan" type="lidar2d" rays="90"/>
  </robot>
  <end goal="false" collision="false"/>
</trial>
"""

BRIEF_FLOW = FLOW.replace('duration="20"', 'duration="8"')

SHY = """from dataclasses import dataclass
from crowdbot.core import Twist
from crowdbot.navigation import Navigator

@dataclass(frozen=True)
class Shy(Navigator):
    space: float = 1.0

    def act(self, observation):
        return Twist() if observation.nearest < self.space else observation.towards_goal(0.8)
"""


def changed(old: str, new: str) -> str:
    """Return the good trial with one thing changed."""
    assert GOOD.count(old) >= 1, old
    return GOOD.replace(old, new, 1)


def written(folder: Path, text: str | bytes, name: str = "trial.xml") -> Path:
    """Write a trial file."""
    folder.mkdir(parents=True, exist_ok=True)
    path = folder / name
    path.write_bytes(text.encode() if isinstance(text, str) else text)
    return path
