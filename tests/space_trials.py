"""A trial with everything that only bodies, links, props and cameras bring."""

from __future__ import annotations

ROOM = """<?xml version="1.0" encoding="UTF-8"?>
<trial name="room" duration="1" step="0.04" seed="4">
  <stage walkable="0,0 12,0 12,8 0,8" wall-height="2.2" friction="0.9">
    <cube x="4" y="2" size="0.6" fixed="true"/>
    <cube x="6" y="1" size="0.3" mass="2"/>
    <table x="9" y="6.5" heading="0.3"/>
    <tree x="2" y="7" height="4"/>
    <light x="6" y="4" shadows="true"/>
  </stage>
  <crowd type="orca"/>
  <agent x="6" y="4" goal="1,4" body="woman-36" outfit="3"/>
  <agent x="7" y="2.2" heading="3" body="man" activity="phone"/>
  <spawner count="3" zone="9,1 11,1 11,5 9,5" goal="1,1 2,1 2,5 1,5" body="adult child" activity="talk bottle"/>
  <robot name="pepper" type="pepper" sensor-rates="nearest" x="2" y="4" control-period="0.08">
    <goal x="10" y="4"/>
    <navigator type="orca"/>
    <sensor name="laser_rear" type="lidar2d" rate="6.25" rays="31" link="sick_laser_rear"/>
    <sensor name="eyes" type="rgbcamera" link="CameraTop_frame" width="32" height="24" rate="5" segmentation="true"/>
    <sensor name="depth" type="depth-camera" x="0.1" z="1" pitch="0.2" rate="5" width="24" height="18"/>
    <sensor name="imu" type="imu" rate="25"/>
    <sensor name="wheels" type="wheel-odometry" rate="25" delay="0.08"/>
    <sensor name="people" type="ground-truth-people" rate="12.5" visible-only="false"/>
    <sensor name="sonar" type="ultrasound" x="0.2" z="0.3" rate="12.5"/>
    <sensor name="rings" type="lidar3d" z="1.3" rate="5" columns="36"/>
  </robot>
  <robot name="puck" x="2" y="2.2" height="0.4" mass="15" latency="0.12" control-period="0.04">
    <goal x="10" y="2"/>
    <drive type="differential-drive"/>
    <navigator type="straight"/>
    <sensor name="scan" type="lidar2d" rays="60" rate="12.5"/>
  </robot>
  <camera name="door" x="0.5" y="0.5" heading="0.7" z="2" pitch="0.2" width="64" height="48"/>
  <camera name="head" robot="pepper" link="Head" x="0.1" z="0" width="64" height="48"/>
  <end collision="false" goal="false"/>
  <recording period="0.04" markers="0.4"/>
</trial>
"""
PEPPER = ROOM[ROOM.index('  <robot name="pepper"') : ROOM.index('  <robot name="puck"')]
HEAD = next(line for line in ROOM.splitlines(keepends=True) if 'robot="pepper"' in line)
LEAN = ROOM.replace(PEPPER, "").replace(HEAD, "")
"""The room without Pepper: a robot with a flat laser."""
WORLDS = ("planar", "physics")


def room(world: str = "planar", text: str = ROOM, **changes: str) -> str:
    """The text of the room in a world, with other attributes of the trial."""
    more = "".join(f' {name.replace("_", "-")}="{value}"' for name, value in changes.items())
    return text.replace('seed="4"', f'seed="4" world="{world}"{more}')
