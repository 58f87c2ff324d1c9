"""Clock offset and latency, with simulated clocks and networks; added delays appear where they were added."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError
from crowdbot.vr import ClockSync, HeadsetSample, HeadsetStream, StreamSettings

HEAD = np.array([0.0, 0.0, 1.6, 1.0, 0.0, 0.0, 0.0])
OFFSET = -7345.678  # clock of the headset minus that of the server [s]


def network(random):
    """Return a delay [s]: 3 ms, mostly a few more, sometimes 30 ms."""
    return 0.003 + random.exponential(0.002) + (0.03 if random.random() < 0.05 else 0.0)


class Rig:
    """A headset at 72 Hz and a simulation at 20 Hz on a simulated network, in the time of the server."""

    def __init__(self, settings, seed=0, drift=0.0, loss=0.0):
        self.random, self.drift, self.loss = np.random.default_rng(seed), drift, loss
        self.stream = HeadsetStream(settings)

    def headset(self, time):
        return (1.0 + self.drift) * time + OFFSET

    def play(self, seconds, speed=0.5, picture=0.0):
        """Walk at a speed [m/s]; return the error of each step from the place that the latency implies [m]."""
        messages, errors, exchange = [], [], None
        for k, time in enumerate(np.arange(0.0, seconds, 1 / 72)):
            if self.random.random() < self.loss:
                continue
            head = HEAD.copy()
            head[0] = speed * time
            shown = [[time - picture - 0.05, self.headset(time)]]
            sample = HeadsetSample(self.headset(time), head, number=k, clock=exchange, pictures=np.array(shown))
            arrival = time + network(self.random)
            exchange = (self.headset(time), arrival, arrival, self.headset(arrival + network(self.random)))
            messages.append((arrival, sample))
        messages.sort(key=lambda message: message[0])
        for step in np.arange(1.0, seconds, 0.05):
            while messages and messages[0][0] <= step:
                self.stream.add(messages[0][1], messages[0][0])
                messages.pop(0)
            before = self.stream.latency.count("motion")
            found = self.stream.at(step)
            if found is not None and self.stream.latency.count("motion") > before:
                age = self.stream.latency._latest["motion"][-1]
                errors.append(found.head[0] - speed * (step - age))
        return np.array(errors)


@pytest.mark.parametrize("added", [0.0, 0.05, 0.1, 0.2])
def test_added_delay_is_in_the_latency_within_5_ms(added):
    """The median of 200 steps, under jitter, loss and a clock that is far off and drifts by 20 ppm."""
    plain, late = Rig(StreamSettings(), 1, 2e-5, 0.02), Rig(StreamSettings(motion_delay=added), 2, 2e-5, 0.02)
    for rig, picture in ((plain, 0.0), (late, added)):
        errors = rig.play(12.0, picture=picture)
        assert len(errors) > 200
        assert np.abs(errors).max() < 0.5 * 0.004  # what the simulation sees is as old as the log says
    for name in ("motion", "picture"):
        more = late.stream.latency.median(name) - plain.stream.latency.median(name)
        print(f"added {1e3 * added:.0f} ms: {name} has {1e3 * more:.2f} ms more")
        assert more == pytest.approx(added, abs=0.005)
    assert plain.stream.latency.median("motion") == pytest.approx(0.02, abs=0.005)
    assert plain.stream.latency.median("picture") == pytest.approx(0.05, abs=0.005)


@given(st.floats(-1e5, 1e5), st.integers(0, 100))
@settings(max_examples=30, deadline=None)
def test_the_offset_is_within_half_of_the_smallest_delay(offset, seed):
    random, sync = np.random.default_rng(seed), ClockSync()
    assert not sync
    for time in np.arange(0.0, 3.0, 0.1):
        there, back = network(random), network(random)
        sync.add(time - offset, time + there, time + there + 0.001, time + there + 0.001 + back - offset)
    assert abs(sync.offset - offset) <= 0.5 * sync.delay + 1e-9
    assert abs(sync.offset - offset) < 0.002
    assert sync.to_server(1.0) == pytest.approx(1.0 + sync.offset)


def test_impossible_exchanges_are_left_out():
    sync = ClockSync()
    for times in ((0.0, 1.0, 0.9, 0.1), (0.0, 5.0, 5.0, -0.1), (0.0, np.nan, 1.0, 1.0), (0.0, 5.0, 5.0, 100.0)):
        sync.add(*times)
    assert not sync
    assert np.isnan(sync.to_server(0.0))


def test_lost_messages_are_counted_and_tracking_is_lost_after_the_timeout():
    stream = HeadsetStream(StreamSettings(timeout=0.3))
    stream.add(HeadsetSample(0.0, HEAD, number=1), 0.0)
    assert stream.at(0.01) is None  # the clocks are not related yet
    for k in (2, 3, 6):
        stream.add(HeadsetSample(0.01 * k, HEAD, number=k, clock=(0.0, 0.0, 0.0, 0.0)), 0.01 * k)
    assert stream.latency.lost == 2
    assert stream.at(0.1) is not None
    assert not stream.is_lost(0.3)
    assert stream.is_lost(0.4)
    assert stream.at(0.4) is None
    stream.add(HeadsetSample(0.41, None, number=7), 0.41)
    assert stream.is_lost(0.41)
    stream.add(HeadsetSample(0.42, HEAD, number=8), 0.42)
    assert not stream.is_lost(0.42)


def test_noise_has_its_standard_deviation_and_the_same_seed_the_same_values():
    found = []
    for _ in range(2):
        stream = HeadsetStream(StreamSettings(noise=0.02, buffer=0.0), seed=3)
        for k in range(2000):
            stream.add(HeadsetSample(0.001 * k, HEAD, number=k, clock=(0.0, 0.0, 0.0, 0.0)), 0.001 * k)
        rows = np.array([sample.head[:3] for sample in stream._samples]) - HEAD[:3]
        found.append(rows)
    assert found[0].std() == pytest.approx(0.02, rel=0.05)
    assert (found[0] == found[1]).all()


@pytest.mark.parametrize("wrong", [{"noise": -1.0}, {"motion_delay": 3.0}, {"timeout": "1"}, {"buffer": float("nan")}])
def test_settings_out_of_range_are_refused(wrong):
    with pytest.raises(InputError, match=f"{next(iter(wrong))} = .*: expected 0 to"):
        StreamSettings(**wrong)
