"""The latency of a robot without a type, in both worlds."""

import numpy as np
import pytest

from crowdbot.recording import run
from crowdbot.trials import parse_trial

TEXT = """
<trial name="late" seed="1" step="0.04" duration="1.2" world="{world}">
  <crowd type="orca"/>
  <robot x="0" y="0" latency="{latency}" control-period="0.04">
    <goal x="9" y="0"/>
    <drive type="omnidirectional"/>
    <navigator type="straight"/>
  </robot>
  <recording period="0.04" markers="0.4"/>
</trial>
"""


def forward(world, latency):
    """Return the way of the robot forward [m] after every step."""
    episode = run(parse_trial(TEXT.format(world=world, latency=latency)))
    return np.asarray(episode.position[:, 0, 0])


@pytest.mark.parametrize("world", ["planar", "physics"])
def test_a_robot_without_a_type_waits_for_its_latency(world):
    prompt, late = forward(world, 0.0), forward(world, 0.2)
    steps = 5  # 0.2 s in steps of 0.04 s
    np.testing.assert_allclose(late[: steps + 1], late[0], atol=1e-3)
    assert prompt[steps] > 0.01
    np.testing.assert_allclose(late[steps:], prompt[:-steps], atol=2e-3)
