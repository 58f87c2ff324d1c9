"""Live motion capture: Xsens and NatNet datagrams, hostile ones, and the clocks of sender and simulation."""

from __future__ import annotations

import random
import socket
import time

import motion_senders as senders
import numpy as np
import pytest
from bridge_runs import wait
from hypothesis import given
from hypothesis import strategies as st
from motion_senders import Motive, Sender

from crowdbot.bridges import open_stream
from crowdbot.bridges.motion_capture import ClockOffset, NatNetStream, XsensStream
from crowdbot.bridges.motion_capture.natnet import read_server
from crowdbot.core import InputError


def fed(*datagrams: bytes) -> XsensStream:
    stream = XsensStream(port=0)
    for k, datagram in enumerate(datagrams):
        stream.take(datagram, "127.0.0.1:5", 5.0 + 0.01 * k)
    return stream


def test_a_pose_datagram_has_760_bytes_and_gives_position_and_rotation() -> None:
    pose = senders.posed({"Pelvis": senders.about("z", 0.5)}, (1.0, 2.0, 0.0))
    datagram = senders.mxtp02(pose, 7, 1.25)
    assert len(datagram) == 760
    ((_, sample),) = fed(senders.mxtp12("Anna"), datagram).read("Anna", 0.0, 0.05)
    assert (sample.number, sample.time) == (7, 1.25)
    np.testing.assert_allclose(sample.position, [place for place, _ in pose], atol=1e-6)
    np.testing.assert_allclose(sample.rotation[14, 0, 0], np.cos(0.5), atol=1e-6)


def test_scale_information_gives_the_rest_pose_and_centimetres_are_found() -> None:
    metres = fed(senders.mxtp13(), senders.mxtp02(senders.posed({}), 1, 0.0))
    large = [((100 * x, 100 * y, 100 * z), turn) for (x, y, z), turn in senders.posed({})]
    centimetres = fed(senders.mxtp02(large, 1, 0.0))
    ((_, a),), ((_, b),) = (item.read("0", 0.0, 0.05) for item in (metres, centimetres))
    np.testing.assert_allclose(a.skeleton.rest, senders.T_POSE, atol=1e-6)
    np.testing.assert_allclose(a.position, b.position, atol=1e-5)
    assert b.skeleton.leg_length("l") == pytest.approx(0.87, abs=1e-5)


def test_a_pose_in_two_parts_is_put_together_whatever_comes_first() -> None:
    whole = senders.mxtp02(senders.walk(0.3), 5, 0.3)[24:]
    cut = 10 * 32
    parts = [
        senders.mxtp("02", whole[:cut], 5, 0.3, 10, part=0),
        senders.mxtp("02", whole[cut:], 5, 0.3, 13, part=0x81),
    ]
    for order in (parts, parts[::-1]):
        ((_, sample),) = fed(*order).read("", 0.0, 0.05)
        np.testing.assert_allclose(sample.position[0], [0.3, 0.0, 0.96], atol=1e-6)
    assert fed(parts[0]).read("", 0.0, 0.05) == []


def test_lost_and_late_samples_are_counted_and_dropped() -> None:
    stream = fed(*(senders.mxtp02(senders.walk(k / 100), k, k / 100) for k in (0, 1, 2, 6, 5, 7)))
    statistics = stream.statistics()
    assert (statistics.samples, statistics.lost, statistics.refused) == (5, 3, 0)
    assert statistics.rate == pytest.approx(100.0)


BAD = {
    "bytes are less": b"MXTP",
    "no MXTP": b"X" * 100,
    "the header says": senders.mxtp02(senders.posed({}), 1, 0.0)[:-1],
    "segments need": senders.mxtp("02", b"\0" * 64, 1, 0.0, 3),
    "body segments instead of 23": senders.mxtp("02", b"\0" * 64, 1, 0.0, 2),
    "not finite": senders.mxtp02([((float("nan"), 0.0, 0.0), senders.IDENTITY)] * 23, 1, 0.0),
    "out of range": senders.mxtp02([((0.0, 0.0, 0.0), (9.0, 0.0, 0.0, 0.0))] * 23, 1, 0.0),
    "select Position + Orientation (Quaternion)": senders.mxtp("01", b"\0" * 28, 1, 0.0, 1),
    "check the unit": senders.mxtp02([((0.0, 0.0, 0.0), senders.IDENTITY)] * 23, 1, 0.0),
    "too short": senders.mxtp("13", b"\0", 1, 0.0, 1),
    "lacks": senders.mxtp("13", b"\0\0\0\1\0\0\0\1A" + b"\0" * 12, 1, 0.0, 1),
}


@pytest.mark.parametrize("reason", BAD)
def test_a_bad_datagram_is_refused_with_its_reason(reason: str) -> None:
    stream = fed(BAD[reason])
    assert stream.statistics().refused == 1
    assert reason in stream.statistics().reason
    assert stream.read("", 0.0, 0.05) == []


@given(st.binary(max_size=900))
def test_any_datagram_leaves_the_stream_working(data: bytes) -> None:
    stream = fed(data, b"MXTP02" + data, b"MXTP13" + data, b"MXTP12" + data)
    stream.take(senders.mxtp02(senders.posed({}), 1, 0.0, character=9), "127.0.0.1:5", 9.0)
    assert "9" in stream.subjects()


@pytest.mark.live
def test_mutated_datagrams_leave_both_decoders_working_and_their_memory_bounded() -> None:
    rng = random.Random(3)
    motive = Motive()
    natnet = NatNetStream()  # the decoder alone: there is no server
    motive.socket.close()
    natnet.info = read_server(motive.server_info())
    xsens = XsensStream()
    for stream, seeds in (
        (xsens, [senders.mxtp02(senders.walk(0.1), 1, 0.1), senders.mxtp12("Anna"), senders.mxtp13()]),
        (natnet, [motive.frame(1, 0.1), motive.descriptions()]),
    ):
        for k in range(3000):
            data = bytearray(rng.choice(seeds))
            for _ in range(rng.randint(1, 8)):
                data[rng.randrange(len(data))] = rng.choice((0, 1, 127, 128, 255, rng.randrange(256)))
            if rng.random() < 0.3:
                data = data[: rng.randrange(len(data))]
            stream.take(bytes(data), "127.0.0.1", 1e-3 * k)
        assert stream.statistics().refused > 500
        assert len(stream.subjects()) <= 32
    natnet.take(motive.descriptions(), "127.0.0.1", 1e3)
    natnet.take(motive.frame(5000, 50.0), "127.0.0.1", 1e3)
    assert "Anna" in natnet.subjects()


def test_a_second_sender_is_refused_until_the_first_is_silent() -> None:
    stream = fed(senders.mxtp02(senders.walk(0.0), 0, 0.0))
    other = senders.mxtp02(senders.walk(1.0), 1, 1.0)
    stream.take(other, "127.0.0.1:6", 5.5)
    assert "not the first sender" in stream.statistics().reason
    assert stream.statistics().samples == 1
    stream.take(other, "127.0.0.1:6", 8.0)
    assert stream.statistics().samples == 2


@pytest.mark.live
def test_a_port_in_use_is_an_error_and_the_stream_listens_on_loopback() -> None:
    with open_stream("xsens:0") as stream:
        assert isinstance(stream, XsensStream)
        assert stream.host == "127.0.0.1"
        with pytest.raises(InputError, match=f"cannot receive on 127.0.0.1:{stream.port}: Address already in use"):
            XsensStream(port=stream.port).__enter__()


@pytest.mark.live
def test_samples_come_over_the_network_with_their_age() -> None:
    with open_stream("xsens:0") as stream:
        assert isinstance(stream, XsensStream)
        with Sender(stream.port) as sender:
            wait(lambda: sender.sent > 30 and stream.subjects())
            start, ages, late = time.monotonic(), [], []
            for k in range(20):
                time.sleep(max(0.0, start + 0.02 * k - time.monotonic()))
                now = 0.02 * k
                for at, _ in stream.read("Anna", now, now + 0.02):
                    ages.append(now - at)
                    late.append(time.monotonic() - start - now)
    assert ages  # how many and how old: tested with a simulated clock below
    # No sample comes from the future: seen from a step that begins late, the newest is as much ahead at most.
    assert all(-age <= more + 1e-9 for age, more in zip(ages, late, strict=True))
    assert stream.statistics("Anna").rate == pytest.approx(240.0, rel=0.02)
    latency = stream.latency()
    assert latency is not None
    assert 0.0 <= latency[0] <= latency[1]


def test_samples_have_the_simulated_time_at_which_they_were_made() -> None:
    """Clock of the sender 100 s ahead, delays of 2 to 12 ms, steps that are up to 20 ms late: 1 ms stays."""
    rng, now = random.Random(5), [50.0]
    stream = XsensStream(monotonic=lambda: now[0])
    stamps: list[tuple[float, float]] = []
    events = [(50.0 + k / 240 + 0.002 + 0.01 * rng.random() * (k % 7 > 0), "sample", k) for k in range(480)]
    events += [(50.0 + 0.05 * k + 0.02 * rng.random() * (k % 3 > 0), "step", k) for k in range(1, 40)]
    for at, kind, k in sorted(events):
        now[0] = at
        if kind == "sample":
            stream.take(senders.mxtp02(senders.walk(k / 240), k, 150.0 + k / 240), "127.0.0.1:5", at)
        else:
            stamps += [(time, item.time - 150.0) for time, item in stream.read("", 0.05 * k, 0.05 * k + 0.05)]
    errors = [stamp - made for stamp, made in stamps[3:]]
    assert len(stamps) == 39
    assert max(errors) - min(errors) < 0.0015
    assert 0.001 < np.mean(errors) < 0.0035  # time codes are whole milliseconds; the smallest delay is not observable
    latency = stream.latency()
    assert latency is not None
    assert latency[0] < 0.03


@given(st.lists(st.floats(0.0, 0.5), min_size=30, max_size=60), st.floats(-1e4, 1e4), st.floats(-1e-4, 1e-4))
def test_the_clock_offset_is_the_smallest_delay_despite_queues_and_drift(
    delays: list[float], shift: float, drift: float
) -> None:
    delays[7] = delays[-2] = 0.0
    offset = ClockOffset(window=1e6)
    for k, delay in enumerate(delays):
        offset.add(0.01 * k, 0.01 * k * (1.0 + drift) + shift + delay)
    assert abs(offset.value - shift) <= 0.01 * len(delays) * abs(drift) + 1e-9


def test_the_clock_offset_starts_anew_after_a_jump() -> None:
    offset = ClockOffset()
    offset.add(100.0, 5.0)
    offset.add(0.0, 6.0)
    assert offset.value == 6.0


@pytest.mark.live
@pytest.mark.parametrize("version", [(3, 0), (3, 1), (4, 0), (4, 1), (4, 2)])
@pytest.mark.parametrize("local", [False, True], ids=["global", "local"])
def test_motive_streams_rigid_bodies_and_skeletons(version: tuple[int, int], local: bool) -> None:
    with Motive(version, local) as motive, open_stream(f"natnet:127.0.0.1:{motive.port}") as stream:
        wait(lambda: len(stream.subjects()) == 2)
        ((_, person),) = stream.read("Anna", 0.0, 0.05)
        ((_, cart),) = stream.read("Cart", 0.0, 0.05)
    hand = person.position[person.skeleton.roles["hand_l"]] - person.position[0]
    np.testing.assert_allclose(hand, [0.0, 0.72, 0.5], atol=1e-5)
    assert person.position[0, 0] == pytest.approx(person.time, abs=1e-5)
    np.testing.assert_allclose(cart.position[0], [0.5 * cart.time, 1.0, 0.3], atol=1e-5)
    assert np.arctan2(cart.rotation[0, 1, 0], cart.rotation[0, 0, 0]) == pytest.approx(0.5 * cart.time, abs=1e-4)


@pytest.mark.live
def test_motive_by_multicast_and_with_z_up() -> None:
    motive = Motive(multicast="239.255.42.99", up_axis=2)
    with motive, open_stream(f"natnet:127.0.0.1:{motive.port}") as stream:
        wait(lambda: "Cart" in stream.subjects())
        ((_, cart),) = stream.read("Cart", 0.0, 0.05)
        wait(lambda: motive.alive > 0)
    np.testing.assert_allclose(cart.position[0], [1.0, 0.3, 0.5 * cart.time], atol=1e-5)


@pytest.mark.live
def test_a_server_that_does_not_answer_or_is_too_old_is_an_error() -> None:
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as silent:
        silent.bind(("127.0.0.1", 0))
        port = silent.getsockname()[1]
        with pytest.raises(InputError, match="does not answer within 0.2 s; is Broadcast Frame Data on"):
            NatNetStream("127.0.0.1", port, timeout=0.2).__enter__()
    with Motive((2, 10)) as motive, pytest.raises(InputError, match="NatNet 2.10 is too old; 3.0"):
        NatNetStream("127.0.0.1", motive.port, timeout=1.0).__enter__()


@pytest.mark.live
def test_the_fake_server_is_understood_by_an_independent_client() -> None:
    import natnet

    frames: list[object] = []
    with Motive((4, 1)) as motive:
        client = natnet.NatNetClient("127.0.0.1", "127.0.0.1", command_port=motive.port, use_multicast=False)
        described: list[object] = []
        client.on_data_frame_received_event.handlers.append(frames.append)
        client.on_data_description_received_event.handlers.append(described.append)
        with client:
            client.request_modeldef()
            end = time.monotonic() + 5.0
            while (len(frames) < 20 or not described) and time.monotonic() < end:
                client.update_sync()
                time.sleep(0.002)
    frame, names = frames[-1], described[0]
    assert frame.rigid_bodies[0].pos[0] == pytest.approx(1.0)
    assert [rigid_body_description.name for rigid_body_description in names.skeletons[0].rigid_body_descriptions][
        :2
    ] == ["Anna_Hip", "Anna_Ab"]
    assert frame.skeletons[0].rigid_bodies[0].pos[2] == pytest.approx(frame.suffix.timestamp, abs=1e-5)
