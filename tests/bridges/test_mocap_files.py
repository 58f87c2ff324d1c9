"""Recordings of motion capture: BVH, MVNX and CSV files."""

from __future__ import annotations

import math
import random
from pathlib import Path

import motion_senders as senders
import numpy as np
import pytest

from crowdbot.bridges import open_stream
from crowdbot.bridges.motion_capture import read_bvh, read_csv, read_mvnx
from crowdbot.core import InputError


def limb(side: str, names: list[str], offsets: list[str], end: str) -> str:
    text = "".join(
        f"JOINT {side}{name} {{ OFFSET {offset} CHANNELS 3 Zrotation Xrotation Yrotation "
        for name, offset in zip(names, offsets, strict=True)
    )
    return f"{text} End Site {{ OFFSET {end} }} {'}' * len(names)}\n"


def bvh(rows: list[list[float]], scale: float = 100.0, unit: str = "0.01") -> bytes:
    """Return a BVH file, y up, facing z, as motion capture software exports it."""

    def xyz(*numbers: float) -> str:
        return " ".join(f"{scale * number:.6g}" for number in numbers)

    text = f"HIERARCHY\nROOT Hips {{ OFFSET {xyz(0, 0, 0)}\n"
    text += " CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n"
    text += f"JOINT Spine {{ OFFSET {xyz(0, 0.1, 0)} CHANNELS 3 Zrotation Xrotation Yrotation\n"
    text += f"JOINT Spine1 {{ OFFSET {xyz(0, 0.2, 0)} CHANNELS 3 Zrotation Xrotation Yrotation\n"
    text += f"JOINT Neck {{ OFFSET {xyz(0, 0.25, 0)} CHANNELS 3 Zrotation Xrotation Yrotation\n"
    text += f"JOINT Head {{ OFFSET {xyz(0, 0.1, 0)} CHANNELS 3 Zrotation Xrotation Yrotation"
    text += f" End Site {{ OFFSET {xyz(0, 0.18, 0)} }} }} }}\n"
    arm, leg = ["Shoulder", "Arm", "ForeArm", "Hand"], ["UpLeg", "Leg", "Foot"]
    for side, s in (("Left", 1.0), ("Right", -1.0)):
        offsets = [xyz(0.03 * s, 0.2, 0), xyz(0.15 * s, 0, 0), xyz(0.29 * s, 0, 0), xyz(0.25 * s, 0, 0)]
        text += limb(side, arm, offsets, xyz(0.1 * s, 0, 0))
    text += "} }\n"
    for side, s in (("Left", 1.0), ("Right", -1.0)):
        offsets = [xyz(0.09 * s, 0, 0), xyz(0, -0.43, 0), xyz(0, -0.42, 0)]
        text += limb(side, leg, offsets, xyz(0, -0.06, 0.15))
    width = 6 + 3 * (4 + 8 + 6)
    lines = [" ".join(map(str, row + [0.0] * (width - len(row)))) for row in rows]
    return (text + f"}}\nMOTION\nFrames: {len(rows)}\nFrame Time: 0.02\n" + "\n".join(lines) + "\n").encode()


WALK = bvh([[0.0, 95.0, 2.0 * k, 0.0, 0.0, 10.0] for k in range(50)])


def test_a_bvh_file_walks_forward_with_z_up() -> None:
    recording = read_bvh(WALK, "walk.bvh")
    (_, a), (_, b) = recording.read("", 0.0, 0.99 * 0.98)
    assert recording.subjects() == ("Hips",)
    assert (a.number, b.number) == (48, 49)
    np.testing.assert_allclose(b.position[0], [0.98, 0.0, 0.95], atol=1e-9)
    assert math.atan2(b.rotation[0, 1, 0], b.rotation[0, 0, 0]) == pytest.approx(math.radians(10.0))
    hand = b.position[b.skeleton.roles["hand_l"]] - b.position[0]
    turn = math.radians(10.0)
    np.testing.assert_allclose(hand, [-0.72 * math.sin(turn), 0.72 * math.cos(turn), 0.5], atol=1e-9)
    assert recording.statistics().rate == pytest.approx(50.0)


@pytest.mark.parametrize("scale", [1.0, 100.0, 1000.0, 1.0 / 0.056444])
def test_the_unit_of_a_bvh_file_is_found_from_the_legs(scale: float) -> None:
    ((_, sample),) = read_bvh(bvh([[0.0, 0.95 * scale]], scale), "a.bvh").read("", 0.0, 0.0)
    assert sample.position[0, 2] == pytest.approx(0.95, rel=1e-4)
    assert sample.skeleton.leg_length("l") == pytest.approx(0.85, rel=1e-4)


def test_the_rotation_of_a_bvh_joint_moves_what_hangs_on_it() -> None:
    raised = [0.0, 95.0, 0.0] + [0.0] * 3 + [0.0] * 12 + [0.0] * 3 + [90.0, 0.0, 0.0]
    ((_, sample),) = read_bvh(bvh([raised]), "a.bvh").read("", 0.0, 0.0)
    arm = sample.position[sample.skeleton.roles["hand_l"]] - sample.position[sample.skeleton.roles["upperarm_l"]]
    np.testing.assert_allclose(arm, [0.0, 0.0, 0.54], atol=1e-9)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (b"HIERARCHY", b"SKELETON", "a.bvh:1: 'SKELETON' stands where HIERARCHY is expected"),
        (b"MOTION", b"MOVES", "a.bvh has no MOTION section"),
        (b"CHANNELS 6", b"CHANNELS 9", "a.bvh:3: a joint has 9 channels; at most 6 are possible"),
        (b"Zrotation", b"Wrotation", "a.bvh:3: channel 'Wrotation' is unknown; known are Xposition"),
        (b"OFFSET 0 0 0", b"OFFSET 0 nan 0", "a.bvh:2: 'nan' must be a finite number"),
        (b"Frames: 1", b"Frames: 2", "a.bvh has 1 frames instead of 2"),
        (b"Frame Time: 0.02", b"Frame Time: 0", "1 frames every 0 s are out of range"),
        (b"LeftHand", b"LeftClaw", "a.bvh: a skeleton has no joint such as LeftHand"),
        (b"\n0.0 95.0", b"\n95.0", "instead of 60"),
        (b"\n0.0 95.0", b"\nx 95.0", "a value of a frame must be a finite number"),
    ],
)
def test_a_bad_bvh_file_is_refused_with_the_line(old: bytes, new: bytes, message: str) -> None:
    data = bvh([[0.0, 95.0]])
    assert old in data
    with pytest.raises(InputError) as caught:
        read_bvh(data.replace(old, new, 1), "a.bvh")
    assert message in str(caught.value)


def mvnx(identity: bool = True, head: str = "") -> bytes:
    def frame(kind: str, t: float, pose: list[tuple[senders.Vector, senders.Quaternion]]) -> str:
        places = " ".join(f"{item:.6f}" for place, _ in pose for item in place)
        turns = " ".join(f"{item:.6f}" for _, turn in pose for item in turn)
        return (
            f'<frame time="{round(1000 * t)}" tc="00:00" ms="0" type="{kind}">'
            f"<orientation>{turns}</orientation><position>{places}</position></frame>"
        )

    frames = [frame("identity", 0.0, senders.posed({}))] if identity else []
    frames += [frame("tpose", 0.0, senders.posed({}))]
    frames += [frame("normal", k / 60, senders.walk(k / 60)) for k in range(30)]
    return f"""<?xml version="1.0" encoding="UTF-8"?>{head}
<mvnx version="4"><subject label="Anna" frameRate="60" segmentCount="23">
<frames segmentCount="23">{"".join(frames)}</frames></subject></mvnx>""".encode()


def test_an_mvnx_file_gives_the_same_samples_as_the_stream() -> None:
    for identity in (True, False):
        recording = read_mvnx(mvnx(identity), "walk.mvnx")
        (before, sample), (after, _) = recording.read("Anna", 0.0, 0.25)
        assert (sample.number, round(before, 3), round(after, 3)) == (15, 0.25, 0.267)
        wanted = [place for place, _ in senders.walk(0.25)]
        np.testing.assert_allclose(sample.position, wanted, atol=1e-5)
        assert sample.skeleton.leg_length("l") == pytest.approx(0.87, abs=1e-4)


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"<mvnx>", "a.mvnx:1: this is not well-formed XML: no element found"),
        (mvnx(head="<!DOCTYPE mvnx [<!ENTITY a 'b'>]>"), "a.mvnx:1: an MVNX file must not have a DOCTYPE or entities"),
        (b"<mvnx/>", "a.mvnx has no <subject> with frames"),
        (b"<mvnx><subject label='A'/></mvnx>", "subject 'A' has no frames of type normal"),
        (mvnx().replace(b"<position>0.000000", b"<position>nan"), "not finite or out of range"),
        (mvnx().replace(b"<position>", b"<position>1 "), "a frame has 70 numbers instead of 69"),
        (mvnx().replace(b'time="17"', b'time="x"'), "a frame has no time in milliseconds"),
        (mvnx().replace(b'time="17"', b'time="900"'), "must be finite and increase"),
        (mvnx().replace(b"orientation", b"velocity"), "export both in MVN"),
    ],
)
def test_a_bad_mvnx_file_is_refused(data: bytes, message: str) -> None:
    with pytest.raises(InputError) as caught:
        read_mvnx(data, "a.mvnx")
    assert message in str(caught.value)


TAKE = """Format Version,1.23,Take Name,Take,Capture Frame Rate,120.0,Rotation Type,Quaternion,Length Units,{unit}

,Type,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Rigid Body,Marker
,Name,Cart,Cart,Cart,Cart,Cart,Cart,Cart,Cart,Unlabeled
,ID,"1","1","1","1","1","1","1","1","2"
,,Rotation,Rotation,Rotation,Rotation,Position,Position,Position,Mean Marker Error,Position
Frame,Time (Seconds),X,Y,Z,W,X,Y,Z,,X
0,0.000,0,0.707107,0,0.707107,{x},500,{z},0.1,3
1,0.010,,,,,,,,,
2,0.020,0,0.707107,0,0.707107,{x},500,3000,0.1,3
"""


def test_a_take_of_motive_gives_rigid_bodies_with_z_up() -> None:
    text = TAKE.format(unit="Millimeters", x=1000, z=2000)
    recording = read_csv(text.encode(), "take.csv")
    (first, a), (second, b) = recording.read("Cart", 0.0, 0.005)
    assert (first, second) == (0.0, 0.02)
    np.testing.assert_allclose(a.position, [[2.0, 1.0, 0.5]])
    np.testing.assert_allclose(b.position, [[3.0, 1.0, 0.5]])
    assert math.atan2(a.rotation[0, 1, 0], a.rotation[0, 0, 0]) == pytest.approx(math.pi / 2, abs=1e-5)


def test_a_plain_table_has_several_subjects() -> None:
    text = "time,subject,x,y,z,qw,qx,qy,qz\n0,a,1,2,0,1,0,0,0\n0,b,5,6,0,0,0,0,1\n1,a,2,2,0,1,0,0,0\n1,b,,,,,,,\n"
    recording = read_csv(text.encode(), "t.csv")
    assert recording.subjects() == ("a", "b")
    ((_, b),) = recording.read("b", 0.0, 0.0)
    np.testing.assert_allclose(b.rotation[0, :2, 0], [-1.0, 0.0])
    assert recording.read("b", 0.0, 0.5) == []


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "a.csv:1: the header is missing"),
        ("time,x\n", "a.csv:1: y is missing"),
        ("time,x,y,w\n", "a.csv:1: 'w' is unknown; known are time"),
        ("time,x,y\n", "a.csv has no samples"),
        ("time,x,y\n0,1\n", "a.csv:2: there are 2 cells, expected 3 as in the header"),
        ("time,x,y\n0,1,inf\n", "a.csv:2: y = 'inf' must be a finite number"),
        ("time,x,y\n0,1,1\n0,1,1\n", "must be finite and increase"),
        ("time,x,y,qw\n0,1,1,3\n", "a.csv:2: the length of a quaternion must be 1"),
        (TAKE.format(unit="Feet", x=1, z=1), "Length Units must be one of meters"),
        (TAKE.format(unit="Meters", x=1, z=1).replace("Quaternion", "XYZ"), "Rotation Type must be Quaternion"),
        (TAKE.format(unit="Meters", x=1, z=1).replace("Rigid Body", "Bone"), "export skeletons as BVH"),
    ],
)
def test_a_bad_csv_file_is_refused(text: str, message: str) -> None:
    with pytest.raises(InputError) as caught:
        read_csv(text.encode(), "a.csv")
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("reader", "data"),
    [(read_bvh, WALK), (read_mvnx, mvnx()), (read_csv, TAKE.format(unit="Meters", x=1, z=1).encode())],
)
def test_mutated_files_are_read_or_refused(reader, data: bytes) -> None:
    rng, refused = random.Random(1), 0
    for _ in range(150):
        mutated = bytearray(data)
        for _ in range(rng.randint(1, 6)):
            k = rng.randrange(len(mutated))
            mutated[k : k + rng.randint(0, 4)] = rng.choice([b"", b"1e9", b"nan", b"{", b"-", b",", b"<", b"\xff"])
        try:
            reader(bytes(mutated), "m").read("", 0.0, 0.01)
        except InputError:
            refused += 1
    assert 10 < refused <= 150


def test_open_stream_takes_paths_and_names_what_it_knows(tmp_path: Path) -> None:
    (tmp_path / "walk.bvh").write_bytes(WALK)
    assert open_stream(str(tmp_path / "walk.bvh")).subjects() == ("Hips",)
    message = r"must be xsens:PORT, natnet:SERVER, vrpn:SERVER or a file that ends in .bvh, .csv, .mvnx"
    with pytest.raises(InputError, match=message):
        open_stream("vicon:3")
    with pytest.raises(InputError, match="port '99999' must be a number from 0 to 65535"):
        open_stream("xsens:99999")
    with pytest.raises(InputError, match="there is no file"):
        open_stream("none.bvh")
