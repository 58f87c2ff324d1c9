"""A participant in a simulation: the crowd and the sensors see limbs, contacts are felt, recordings replay."""

import numpy as np
import pytest
from headset_messages import message, pose

from crowdbot.core import InputError
from crowdbot.recording import open_run, read_episode, replay
from crowdbot.sensors import Lidar2D
from crowdbot.simulation import Simulation, SimulationRun
from crowdbot.trials import parse_trial
from crowdbot.vr import (
    BodyEstimator,
    BodySize,
    HeadsetRecorder,
    RigidTransform,
    SharedRooms,
    VrParticipant,
    read_headset_clock,
    read_headset_recording,
)
from crowdbot.vr.vr_participant import avatar_body
from crowdbot.world import worlds_of

OFFSET = 431.5
AVATAR = '<avatar name="guest" source="external" x="1.5" y="0" heading="3.14159265" body="man-20"/>'
SCAN = """<trial name="scan" duration="5" bodies="{bodies}"><stage/><crowd type="orca"/>{avatar}
<robot name="robot" type="cuybot" default-sensors="false" x="0" y="0"><goal x="9" y="9"/><navigator type="external"/>
<sensor type="lidar2d" name="scan" z="1.2" rays="360" field-of-view="6.265732" rate="20"/></robot>
<end goal="false" collision="false"/></trial>"""
CROWD = """<trial name="meet" duration="8" world="{world}"><stage/><crowd type="orca"/>{avatar}{others}
<end goal="false" collision="false"/></trial>"""


class Player:
    """A headset and a simulation on one simulated clock."""

    def __init__(self, trial, head, right=None, recorder=None, gaze=None):
        self.now, self.head, self.right, self.gaze = 1000.0, head, right, gaze
        rooms = SharedRooms()
        rooms.rooms["person"].place = RigidTransform.at(1.5, 0.0, np.pi)
        self.felt = []
        self.person = VrParticipant(
            "guest", rooms, recorder=recorder, clock=lambda: self.now, tell=lambda one: self.felt.append(one["touch"]),
            utc=lambda: self.now + 1e9,
        )  # fmt: skip
        self.run = SimulationRun(Simulation(trial, posed=True))
        self.number, self.exchange = 0, None

    def poses(self):
        """Send 4 messages in the time of a step."""
        for _ in range(4):
            self.now += 0.0125
            self.number += 1
            more = {} if self.exchange is None else {"clock": np.array(self.exchange)}
            if self.gaze is not None:
                more["gaze"] = self.gaze(self.now - 1000.0)
            right = None if self.right is None else self.right(self.now - 1000.0)
            data = message(self.now + OFFSET, self.head(self.now - 1000.0), right=right, number=self.number, **more)
            answer = self.person.take(data)["clock"]
            self.exchange = (*answer, self.now + OFFSET)

    def step(self, run=None):
        self.poses()
        run = run or self.run
        return run.step(self.person.orders(run.simulation))


@pytest.mark.parametrize("bodies", ["", "limbs", "skins"])
def test_the_beams_of_a_scanner_end_on_the_arm_within_2_cm(bodies):
    """The right arm reaches to the robot: beams of 360 end on the skin of the avatar, by default too."""
    text = SCAN.format(avatar=AVATAR, bodies=bodies)
    trial = parse_trial(text if bodies else text.replace(' bodies=""', ""))
    assert isinstance(trial.robots[0].sensors[0].sensor, Lidar2D)
    hand = np.array([0.33, -0.25, 1.2])
    player = Player(trial, lambda _: (0.0, 0.0, 1.58), lambda _: hand)
    for _ in range(12):
        player.step()
    simulation = player.run.simulation
    reading = next(item for _, _, item in simulation.new_readings())
    people = worlds_of(simulation.world)[0].people
    wrist = people.posture().position[0, 16]
    true = player.person.rooms.rooms["person"].place.apply(hand)
    assert np.linalg.norm(wrist - true) < 0.01
    elbow = people.posture().position[0, 15]
    angles = trial.robots[0].sensors[0].sensor.angles
    ranges = reading.ranges[0]
    ends = np.stack([ranges * np.cos(angles), ranges * np.sin(angles), np.full(len(angles), 1.2)], 1)
    ends = ends[np.isfinite(ranges) & (ranges < 5.0)]
    fingers = true - [0.19, 0.0, 0.0]  # a hand is 19 cm long
    near = np.abs(ends[:, 1] - true[1]) < 0.09
    assert near.sum() >= 3
    skin = people.skin(0)[0]
    gaps = [np.linalg.norm(skin - end, axis=1).min() for end in ends[near]]
    print(f"bodies={bodies or 'default'}: beam to skin {[round(float(1e3 * gap), 1) for gap in gaps]} mm")
    assert max(gaps) < 0.02
    assert ends[near][:, 0].min() == pytest.approx(fingers[0], abs=0.06)
    assert elbow[0] > wrist[0]


def test_people_go_around_a_participant_who_stands_in_their_way():
    others = '<agent x="-4" y="0" goal="6,0"/>'
    trial = parse_trial(CROWD.format(world="planar", avatar=AVATAR, others=others))
    player = Player(trial, lambda time: (0.0, 0.1 * np.sin(time), 1.58))
    least = np.inf
    walker = next(k for k in range(2) if player.run.simulation.people.owner[k] == 0)
    for _ in range(150):
        player.step()
        scene = player.run.simulation.world.scene
        least = min(least, float(np.hypot(*(scene.position[0, 0] - scene.position[0, 1]))))
    assert least > 0.45
    assert player.run.simulation.world.scene.position[0, walker, 0] > 3.0
    assert player.person.summary()["motion_median"] == pytest.approx(20.0, abs=0.1)
    assert player.person.stream.clock.offset == pytest.approx(-OFFSET)


def test_a_push_against_a_robot_is_felt_with_its_force_and_side():
    robot = """<robot name="robot" type="turtlebot2" x="0.6" y="0"><goal x="9" y="9"/>
    <navigator type="external"/></robot>"""
    trial = parse_trial(CROWD.format(world="physics", avatar=AVATAR, others=robot))
    player = Player(trial, lambda time: (min(0.6 * time, 1.2), 0.0, 1.58))
    for _ in range(40):
        player.step()
    assert player.felt
    first = player.felt[0]
    assert first["begins"]
    assert first["kind"] == "robot"
    assert first["force"] > 0.0
    assert 0.25 <= first["strength"] <= 1.0
    assert first["limb"]
    assert sum(item["begins"] for item in player.felt) < len(player.felt)


def test_a_contact_in_the_plane_has_the_force_of_the_two_body_model():
    robot = """<robot name="robot" type="turtlebot2" x="0.4" y="0"><goal x="9" y="9"/>
    <navigator type="external"/></robot>"""
    trial = parse_trial(CROWD.format(world="planar", avatar=AVATAR, others=robot))
    player = Player(trial, lambda time: (min(0.6 * time, 1.2), 0.0, 1.58))
    for _ in range(60):
        player.step()
    first = player.felt[0]
    assert (first["kind"], first["begins"], first["point"]) == ("robot", True, None)
    mass = trial.robots[0].mass  # 0.6 m/s against the chest: 25 N/mm, 40 kg
    assert first["force"] == pytest.approx(0.6 * np.sqrt(25e3 * 40.0 * mass / (40.0 + mass)), rel=0.05)
    assert first["strength"] == 1.0
    assert player.felt[-1]["force"] == 0.0  # leans against it
    assert player.felt[-1]["strength"] == 0.25


def test_a_recorded_participant_replays_without_a_headset(tmp_path):
    """The episode replays to the byte, and the raw messages give the same orders again."""
    trial = parse_trial(CROWD.format(world="planar", avatar=AVATAR, others='<agent x="-4" y="0" goal="6,0"/>'))
    with HeadsetRecorder(tmp_path / "raw.headset") as recorder, open_run(trial, out=tmp_path / "one") as run:
        hand = lambda time: (0.4, -0.2, 1.1 + 0.1 * time)  # noqa: E731
        player = Player(trial, lambda time: (0.3 * time, 0.0, 1.58), hand, recorder)
        for _ in range(60):
            player.step(run)
    assert replay(tmp_path / "one/episode.mcap").equal
    orders = [order for _, order in read_episode(tmp_path / "one/episode.mcap").orders]
    assert len(orders) > 50
    people, number, _ = avatar_body(Simulation(trial), "guest")
    stream, estimator = type(player.person.stream)(), BodyEstimator(BodySize.of(people, number))
    again = []
    for item in read_headset_recording(tmp_path / "raw.headset"):
        if item.sample is not None:
            stream.add(item.sample, item.time)
        elif "step" in item.note:
            again.append(estimator.update(stream.at(item.time), player.person.rooms.rooms["person"].place))
    assert [item.row().tolist() for item in again] == [order.pose.row().tolist() for order in orders] or np.allclose(
        [item.row() for item in again], [order.pose.row() for order in orders], equal_nan=True, atol=1e-12
    )


def test_gaze_and_clocks_of_a_headset_are_in_the_episode_and_in_its_recording(tmp_path):
    """The eyes look 0.25 rad to the left of the head; the clock of the headset is 431.5 s ahead."""
    trial = parse_trial(CROWD.format(world="planar", avatar=AVATAR, others='<agent x="-4" y="3" goal="6,3"/>'))
    c, s = np.cos(0.25), np.sin(0.25)
    ray = pose(np.array([0.0, 0.0, 1.6]), np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]))
    with HeadsetRecorder(tmp_path / "raw.headset") as recorder, open_run(trial, out=tmp_path / "one") as run:
        player = Player(trial, lambda _: (0.0, 0.0, 1.58), recorder=recorder, gaze=lambda _: ray)
        for _ in range(60):
            player.step(run)
    assert player.person.summary()["gaze"]
    assert replay(tmp_path / "one/episode.mcap").equal
    orders = [order for _, order in read_episode(tmp_path / "one/episode.mcap").orders]
    assert len(orders) > 50
    assert np.array([order.gaze for order in orders]) == pytest.approx(np.array([[c, s, 0.0]] * len(orders)), abs=1e-6)
    samples = [item for item in read_headset_recording(tmp_path / "raw.headset") if item.sample is not None]
    assert all(sample.sample.gaze == pytest.approx([c, s, 0.0], abs=1e-6) for sample in samples)
    clock = read_headset_clock(tmp_path / "raw.headset")
    assert len(clock.server) == 3  # 60 steps of 50 ms, one estimate in a second
    assert clock.offset == pytest.approx(-OFFSET, abs=1e-9)
    assert clock.round_trip == pytest.approx(0.0, abs=1e-9)
    assert clock.utc - clock.server == pytest.approx(1e9)
    times = np.array([sample.sample.time for sample in samples])
    assert clock.to_server(times) == pytest.approx(np.array([sample.time for sample in samples]), abs=1e-9)


def test_a_recording_without_compared_clocks_says_so(tmp_path):
    with HeadsetRecorder(tmp_path / "raw.headset") as recorder:
        recorder.message(5.0, message(1.0))
    with pytest.raises(InputError, match="clocks were not compared"):
        read_headset_clock(tmp_path / "raw.headset")


def test_tracking_that_is_lost_leaves_the_avatar_where_it_was():
    trial = parse_trial(CROWD.format(world="planar", avatar=AVATAR, others='<agent x="-4" y="3" goal="6,3"/>'))
    player = Player(trial, lambda time: (0.5 * time, 0.0, 1.58) if time < 1.0 else None)
    for _ in range(60):
        player.step()
    assert player.person.is_lost()
    scene = player.run.simulation.world.scene
    assert scene.active[0, 1]
    assert scene.velocity[0, 1].tolist() == [0.0, 0.0]
    assert player.person.summary()["lost_tracking"]


def test_a_headset_on_a_cupboard_is_no_person_and_damaged_recordings_are_refused(tmp_path):
    trial = parse_trial(CROWD.format(world="planar", avatar=AVATAR, others='<agent x="-4" y="3" goal="6,3"/>'))
    player = Player(trial, lambda _: (0.0, 0.0, 6.0))
    for _ in range(5):
        player.step()
    assert player.person.refused > 0
    assert "high" in player.person.reason
    with pytest.raises(InputError, match="not a recording of a headset"):
        list(read_headset_recording(__file__))
    path = tmp_path / "one.headset"
    with HeadsetRecorder(path) as recorder:
        recorder.message(1.0, message(1.0))
        recorder.note(2.0, {"a": 1})
    data = path.read_bytes()
    path.write_bytes(data[:-3])
    assert len(list(read_headset_recording(path))) == 1
    path.write_bytes(data[:6] + b"\x09" + data[7:])
    with pytest.raises(InputError, match="damaged"):
        list(read_headset_recording(path))
    with pytest.raises(InputError, match="no avatar 'gest'"):
        avatar_body(Simulation(trial), "gest")
