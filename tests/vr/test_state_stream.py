"""Bytes of the state of 50 people and a robot on their way to a headset, and of the poses on their way back."""

import numpy as np
from headset_messages import message

from crowdbot.simulation import Simulation
from crowdbot.trials import load_trial
from crowdbot.vr import headset_frame, pack_triples
from crowdbot.web import StateFrame
from crowdbot.web.simulator import StageView

TRIAL = """<trial name="full" duration="60" seed="3"><stage><wall points="-9,-9 9,-9 9,9 -9,9 -9,-9"/></stage>
<crowd type="orca"/><avatar name="guest" source="external" x="0" y="0"/>
{agents}
<robot name="robot" type="pepper" x="3" y="0" default-sensors="false"><goal x="-3" y="0"/>
<navigator type="straight"/><sensor name="scan" type="lidar2d" rays="360"/></robot><end goal="false"/></trial>"""
DESKTOP, LAN = 400e3, 1.2e6
"""Most bytes a second at 30 Hz and at the rate of a headset."""


class Windows:
    """A session whose window always takes a frame."""

    def __init__(self):
        self.frames = []

    def tell(self, event, data):
        pass

    def show(self, frame):
        self.frames.append(frame)

    def is_ready(self, channel=None):
        return True


def crowd(folder):
    """Return a trial with 50 people, one of them an avatar, and a robot."""
    agents = "".join(
        f'<agent x="{x:g}" y="{y:g}" goal="{-x:g},{-y:g}"/>'
        for x, y in [(1.5 * i - 5.25, 1.5 * j - 4.5) for i in range(7) for j in range(7)]
    )
    path = folder / "full.xml"
    path.write_text(TRIAL.format(agents=agents))
    return load_trial(path)


def test_fifty_people_and_a_robot_fit_into_the_stream(tmp_path):
    simulation, windows = Simulation(crowd(tmp_path), posed=True), Windows()
    view = StageView(windows, frozenset({"scans"}))
    view.open(simulation)
    simulation.begin()
    sizes = []
    for _ in range(10):
        simulation.advance()
        view.show(always=True)
        sizes.append(len(headset_frame(windows.frames[-1]).encode()))
    assert len(windows.frames[-1].arrays["ids"]) == 50
    assert len(windows.frames[-1].arrays["bots"]) == 1
    print(f"state of 50 people and a robot: {max(sizes)} B, {max(sizes) * 30 / 1e3:.0f} kB/s at 30 Hz,"
          f" {max(sizes) * 90 / 1e3:.0f} kB/s at 90 Hz")  # fmt: skip
    assert max(sizes) > 10_000
    assert max(sizes) * 30 < DESKTOP
    assert max(sizes) * 90 < LAN


def test_triples_keep_rotations():
    random = np.random.default_rng(0).standard_normal((500, 28, 4))
    random[0, :4] = np.eye(4)
    random[1, :4] = -np.eye(4)
    quaternions = random / np.linalg.norm(random, axis=2, keepdims=True)
    packed = pack_triples(np.round(32767 * quaternions).astype(np.int16).reshape(500, -1)).reshape(-1, 3).astype(int)
    assert packed.shape == (14_000, 3)
    largest = (packed[:, 0] & 1) | (packed[:, 1] & 1) << 1
    parts = (packed >> 1) / (16383 * np.sqrt(2))
    found = np.zeros((len(packed), 4))
    for k, others in enumerate(([1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2])):
        rows = np.flatnonzero(largest == k)
        found[np.ix_(rows, others)] = parts[rows]
        found[rows, k] = np.sqrt(1 - np.sum(parts[rows] ** 2, axis=1))
    assert np.min(np.abs(np.sum(found * quaternions.reshape(-1, 4), axis=1))) > 1 - 1e-7


def test_a_message_of_a_headset_is_small():
    clock = {"clock": np.zeros(4), "pictures": np.zeros((1, 2)), "dropped": np.zeros(1, dtype=np.uint32)}
    data = message(1.0, left=(0, 0.3, 1.2), right=(0, -0.3, 1.2), **clock)
    assert StateFrame.decode(data).channel == "headset"
    assert len(data) * 90 < 50e3
