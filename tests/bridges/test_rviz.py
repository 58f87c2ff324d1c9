"""RViz 1 of Debian shows what the ROS 1 node sends: a picture of its window, with the file that ships."""

from importlib.resources import files

import numpy as np
import pytest
from bridge_runs import Running
from PIL import Image
from ros1_master import RosMaster
from rviz_screen import RvizScreen

from crowdbot.bridges import open_transport
from crowdbot.trials import parse_trial

TRIAL = """<trial name="rviz" duration="3600">
  <crowd type="orca"/>
  <stage><wall points="-4,-4 4,-4 4,4 -4,4 -4,-4"/></stage>
  <agent x="1.5" y="1.2"/><agent x="-1" y="-2"/>
  <end collision="false" goal="false"/>
  <robot name="robot" x="0" y="0"><goal x="3" y="0"/><navigator type="external"/>
    <drive type="differential-drive" max-speed="1.0"/>
    <sensor name="scan" type="lidar2d" rays="360" field-of-view="6.28" rate="10"/>
  </robot>
</trial>"""
SCAN = (255, 0, 255)
"""Colour of the scan in this test, which nothing else has."""
PERSON = (255, 165, 0)


def colored(picture, color):
    """Return where a picture has a colour, also shaded: rows of pixel y, x."""
    share = picture.astype(float) / np.maximum(picture.max(axis=-1, keepdims=True), 1)
    return np.argwhere((abs(share - np.array(color) / 255).max(axis=-1) < 0.15) & (picture.max(axis=-1) > 60))


@pytest.mark.sweep
def test_rviz_shows_the_scan_of_the_walls_and_the_robot(rviz, ros1, tmp_path):
    text = files("crowdbot").joinpath("assets", "bridges", "crowdbot.rviz").read_text()
    shown = tmp_path / "crowd.rviz"
    shown.write_text(text.replace("Color: 220; 30; 30", "Color: {}; {}; {}".format(*SCAN)))
    with RosMaster(tmp_path) as master, RvizScreen(rviz, shown, master.environment, tmp_path) as screen:
        screen.wait(lambda picture: (picture == 245).all(axis=-1).mean() > 0.2)  # its view is there
        assert len(colored(screen.picture(), SCAN)) < 50  # nothing is sent yet; an icon has some
        with Running(parse_trial(TRIAL, place="rviz"), [open_transport(f"ros1:{master.url}")]):
            picture = screen.wait(lambda picture: len(colored(picture, SCAN)) > 500)
    Image.fromarray(picture).save(tmp_path / "rviz.png")
    found = colored(picture, SCAN)
    spread = np.ptp(found, axis=0)
    assert min(spread) > 100  # walls on all sides, not one spot
    assert len(colored(picture, PERSON)) > 500
