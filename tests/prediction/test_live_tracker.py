"""What real trackers send: late and split messages, wrong units and stamps, tracks that jump."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Iterable
from typing import Any

import numpy as np
import pytest

from crowdbot.core import InputError, stream
from crowdbot.prediction import AnchorNet, ConstantVelocity, Kalman, Live, Predictor, Simulated, TrackerWarning

PREDICTORS = pytest.mark.parametrize(
    "predictor", [ConstantVelocity(), Kalman(), AnchorNet(), Simulated(substep=0.4)], ids=lambda p: p.name
)
Frame = dict[str, Any]


def frames(rate: float = 10.0, seconds: float = 4.0) -> list[Frame]:
    """Five people: one is hidden for a while, one comes late, one jumps; with covariances and radii."""
    rng = stream(7, "frames")
    start, velocity = rng.uniform(-8.0, 8.0, (5, 2)), rng.normal(0.0, 0.8, (5, 2))
    result = []
    for row in range(round(seconds * rate)):
        now = row / rate + float(rng.uniform(-0.02, 0.02))
        place = start + velocity * now + rng.normal(0.0, 0.01, (5, 2))
        place[4] += 45.0 * (now > 3.0)
        here = np.array([True, not 2.0 < now < 2.6, now > 3.3, True, True])
        size = np.where(rng.random(5) < 0.5, rng.uniform(0.2, 0.3, 5), np.nan)
        spread = rng.uniform(0.01, 0.05, 5)[:, None, None] * np.eye(2)
        who = [int(number) for number in 10 * np.flatnonzero(here)]
        result.append(
            {"ids": who, "position": place[here], "robots": [30] if row % 5 == 0 else [], "time": 1.79e9 + now,
             "covariances": spread[here] if row % 3 else None, "radii": size[here]}
        )  # fmt: skip
    return result


def fed(predictor: Predictor, rows: Iterable[Frame], dt: float = 0.4, **options: Any) -> Live:
    live = Live(predictor, dt=dt, **options)
    for row in rows:
        live.update(**row)
    return live


def assert_same(live: Live, other: Live) -> None:
    """Everything that two streams tell is equal to the bit."""
    assert live.ids.tolist() == other.ids.tolist()
    a, b = live.past(), other.past()
    for name in ("position", "present", "robot", "id", "frame", "radius"):
        np.testing.assert_array_equal(getattr(a, name), getattr(b, name), err_msg=name)
    c, d = live.predict(12, 3), other.predict(12, 3)
    for name in ("position", "weight", "existence", "covariance"):
        np.testing.assert_array_equal(getattr(c, name), getattr(d, name), err_msg=name)


def sentences(act: Callable[[], object]) -> list[str]:
    """Return the tracker warnings of an action."""
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        act()
    assert all(report.category is TrackerWarning for report in caught)
    assert all(report.filename == __file__ for report in caught)  # the line that called Live
    return [str(report.message) for report in caught]


def walk(
    live: Live, scale: float = 1.0, time: float = 1.0, rows: int = 60, people: int = 6, speed: float = 1.3
) -> None:
    """Send people at 10 Hz in units of ``1 / scale`` m, with stamps in units of ``1 / time`` s; predict each frame."""
    rng = stream(3, "walk")
    angle = rng.uniform(0.0, 6.28, people)
    way = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    for row in range(rows):
        place = (rng.normal(0.0, 0.01, (people, 2)) + speed * 0.1 * row * way) * scale
        live.update(range(people), place, time=time * (100.0 + 0.1 * row))
        live.predict(3)


# Late and split messages


@PREDICTORS
def test_late_frames_have_the_result_of_frames_in_order(predictor: Predictor) -> None:
    rows = frames()
    swapped = [row for k in range(0, len(rows), 2) for row in reversed(rows[k : k + 2])]
    rng = stream(1, "order")
    mixed = [rows[k + j] for k in range(0, len(rows), 2) for j in rng.permutation(2)]
    for order in (swapped, mixed):
        one, other = fed(predictor, rows), fed(predictor, order)
        assert other.drop_count == 0
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", TrackerWarning)  # the jump
            assert_same(one, other)


@pytest.mark.parametrize(("delay", "observe"), [(0.4, 8), (2.5, 2)])
def test_any_order_within_the_allowed_lateness(delay: float, observe: int) -> None:
    rows = frames(rate=30.0)
    rng = stream(2, "order")
    arrival = [row["time"] + rng.uniform(0.0, delay) for row in rows]
    mixed = [rows[k] for k in np.argsort(arrival)]
    one, other = (
        fed(Kalman(), order, dt=0.1, observe=observe, coast=0.1, allowed_lateness=delay + 0.1)
        for order in (rows, mixed)
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", TrackerWarning)
        assert_same(one, other)


def test_a_stamp_that_is_a_millisecond_late_is_no_error() -> None:
    live = Live(ConstantVelocity(), dt=0.1)
    for now in (0.0, 0.1, 0.2, 0.199, 0.3):
        live.update([1], [[1.2 * now, 0.0]], time=now)
    np.testing.assert_allclose(live.predict(1).position[0, 0, 0, 0], [0.48, 0.0], atol=1e-9)


def test_late_frames_of_others_do_not_change_who_is_predicted() -> None:
    live = Live(ConstantVelocity(), dt=0.1, coast=0.0)
    live.update([1], [[0.0, 0.0]], time=0.0)
    live.update([1], [[0.1, 0.0]], time=0.1)
    live.update([2], [[5.0, 0.0]], time=0.05)
    assert live.ids.tolist() == [1]


def test_older_frames_are_dropped_with_one_warning() -> None:
    rows = [{"ids": [1], "position": [[0.1 * k, 0.0]], "time": 5.0 + 0.1 * k} for k in range(20)]
    live = Live(ConstantVelocity(), dt=0.1)

    def feed() -> None:
        for k, row in enumerate(rows):
            live.update(**row)
            if k > 10:
                live.update([1, 2], [[99.0, 9.0], [3.0, 3.0]], time=row["time"] - 0.25 - k, radii=[0.1, 0.1])

    (sentence,) = sentences(feed)
    assert "a frame of -5.15 s came 11.25 s after that of 6.1 s, more than allowed_lateness = 0.2 s" in sentence
    assert "raise allowed_lateness" in sentence
    assert "make a new Live" in sentence
    assert live.drop_count == 9
    assert_same(live, fed(ConstantVelocity(), rows, dt=0.1))


def test_the_lateness_may_be_zero() -> None:
    live = Live(ConstantVelocity(), dt=0.1, allowed_lateness=0.0)
    live.update([1], [[0.0, 0.0]], time=0.0)
    live.update([1], [[0.1, 0.0]], time=0.1)
    with pytest.warns(TrackerWarning, match="a frame of 0.099 s came 0.001 s after"):
        live.update([1], [[7.0, 0.0]], time=0.099)
    assert live.past().position[0, :, 0, 0].tolist() == [0.0, 0.1]
    for wrong in (-0.1, np.nan, np.inf):
        with pytest.raises(InputError, match=r"allowed_lateness = .* s must be finite and at least 0"):
            Live(ConstantVelocity(), dt=0.1, allowed_lateness=wrong)
    for wrong in (0.0, -1.0, np.nan):
        with pytest.raises(InputError, match=r"max_speed = .* m/s must be above 0"):
            Live(ConstantVelocity(), dt=0.1, max_speed=wrong)


@PREDICTORS
def test_frames_of_the_same_stamp_are_one_frame(predictor: Predictor) -> None:
    rows = [row for row in frames(seconds=2.9) if row["covariances"] is not None]
    split = []
    for row in rows:
        half = len(row["ids"]) // 2
        for part in (slice(half, None), slice(None, half)):
            people = {name: row[name][part] for name in ("ids", "position", "covariances", "radii")}
            split.append({**people, "time": row["time"], "robots": row["robots"]})
    assert_same(fed(predictor, rows), fed(predictor, split))


def test_the_last_message_of_a_stamp_counts() -> None:
    live = Live(Kalman(), dt=0.1)
    live.update([1, 2], [[0.0, 0.0], [5.0, 0.0]], time=1.0, radii=[0.2, 0.3])
    live.update(
        [2, 3], [[5.5, 0.0], [8.0, 0.0]], time=1.0, covariances=np.tile(np.eye(2), (2, 1, 1)), radii=[0.4, np.nan]
    )
    past = live.past()
    assert past.position[0, :, :, 0].tolist() == [[0.0, 5.5, 8.0]]
    assert past.radius is not None
    np.testing.assert_array_equal(past.radius, [[0.2, 0.4, np.nan]])
    plain = Live(Kalman(), dt=0.1)
    plain.update([1, 2, 3], [[0.0, 0.0], [5.5, 0.0], [8.0, 0.0]], time=1.0)
    one, other = live.predict(1).covariance, plain.predict(1).covariance
    assert one is not None
    assert other is not None
    own = Kalman().measurement ** 2
    np.testing.assert_allclose((one - other)[0, 0, :, 0, 0], [0.0, 1.0 - own, 1.0 - own])


# Units


@pytest.mark.parametrize(
    ("scale", "words"),
    [(10.0, "not in metres, or dt or the time stamps are too short"),
     (100.0, "centimetres or pixels; multiply centimetres by 0.01"), (1000.0, "millimetres; multiply them by 0.001")],
)  # fmt: skip
@pytest.mark.parametrize("people", [1, 6])
def test_units_that_are_not_metres_are_reported_once(scale: float, words: str, people: int) -> None:
    live = Live(ConstantVelocity(), dt=0.4)
    reports = sentences(lambda: walk(live, scale, people=people))
    (sentence,) = [report for report in reports if "positions are probably" in report]
    assert words in sentence
    assert "median speed of 1" in sentence
    assert "set max_speed" in sentence
    if scale >= 100.0:
        assert len(reports) == 1  # nobody jumps
        here = live.past().position[0, -1]
        assert np.linalg.norm(here, axis=1) == pytest.approx(1.3 * 5.9 * scale, rel=0.02)  # nothing is rescaled
        assert np.abs(live.predict(12).position[0, 0] - here).max() < 1e-9  # instead of hundreds of metres


def test_units_are_judged_in_frames_of_several_cameras() -> None:
    live = Live(ConstantVelocity(), dt=0.4)

    def feed() -> None:
        for row in range(60):
            now, camera = 0.085 * row, row % 2  # the first frame after 0.4 s is of the other camera
            live.update([camera], [[130.0 * now, 10.0 * camera]], time=now)

    (sentence,) = sentences(feed)
    assert "in centimetres" in sentence


@pytest.mark.parametrize("speed", [0.0, 1.3, 5.0])
@pytest.mark.parametrize("rate", [2.5, 10.0, 200.0])
def test_people_who_stand_walk_and_run_are_plausible(speed: float, rate: float) -> None:
    rng = stream(4, "noise")
    live = Live(ConstantVelocity(), dt=0.4)
    for row in range(round(5.0 * rate)):
        now = (row + float(rng.uniform(-0.3, 0.3))) / rate
        live.update([1, 2], [[speed * now, 0.0], [0.0, 3.0 - speed * now]] + rng.normal(0.0, 0.05, (2, 2)), time=now)
    assert live.past().present.all()


def test_faster_streams_have_a_larger_max_speed() -> None:
    (sentence,) = sentences(lambda: walk(Live(ConstantVelocity(), dt=0.4), speed=9.0))
    assert "set max_speed to more than 18 m/s" in sentence
    for limit in (19.0, np.inf):
        assert sentences(lambda limit=limit: walk(Live(ConstantVelocity(), 0.4, max_speed=limit), speed=9.0)) == []
    live = Live(ConstantVelocity(), dt=0.4, max_speed=np.inf)
    assert sentences(lambda: walk(live, 100.0)) == []
    assert np.abs(live.predict(12).position - live.past().position[0, -1]).max() > 400.0


def test_fast_robots_are_not_judged() -> None:
    live = Live(ConstantVelocity(), dt=0.4)
    for row in range(20):
        live.update([1, 2], [[0.4 * row, 1.0], [4.0 * row, 0.0]], robots=[2])
    np.testing.assert_allclose(live.predict(1).position[0, 0, 0, 1], [80.0, 0.0])


def test_a_restart_of_the_tracker_is_no_wrong_unit() -> None:
    live = Live(ConstantVelocity(), dt=0.4)
    place = stream(5).uniform(-20.0, 20.0, (6, 2))

    def feed() -> None:
        for row in range(20):
            live.update(range(6), (place if row < 10 else place[::-1]) + 0.4 * row)
            live.predict(1)

    (sentence,) = sentences(feed)
    assert "faster than max_speed" in sentence


# Stamps


@pytest.mark.parametrize(
    ("time", "unit", "factor"),
    [(1e3, "milliseconds", "0.001"), (1e6, "microseconds", "1e-6"), (1e9, "nanoseconds", "1e-9")],
)
def test_stamps_that_are_not_seconds_are_reported_once(time: float, unit: str, factor: str) -> None:
    (sentence,) = sentences(lambda: walk(Live(ConstantVelocity(), dt=0.4), time=time))
    assert f"time stamps are {0.1 * time:.4g} s apart" in sentence
    assert f"probably in {unit}" in sentence
    assert f"multiply them by {factor}" in sentence


def test_pauses_are_plausible() -> None:
    live, now = Live(ConstantVelocity(), dt=0.4), 0.0
    for row in range(40):
        now += 0.1 if row % 4 else 60.0
        live.update([row // 4], [[1.2 * now, 0.0]], time=now)
    assert live.drop_count == 0


# Jumps


@PREDICTORS
@pytest.mark.parametrize("stamped", [True, False])
@pytest.mark.parametrize("hidden", [0, 4])
def test_a_jump_of_45_m_is_not_continued(predictor: Predictor, stamped: bool, hidden: int) -> None:
    live = Live(predictor, dt=0.1)

    def feed() -> None:
        for row in range(30):
            place = np.array([[0.12 * row, 0.0], [0.0, 4.0 - 0.1 * row]]) + [[45.0 * (row >= 24), 0.0], [0.0, 0.0]]
            here = slice(1, None) if 24 - hidden <= row < 24 else slice(None)
            live.update(np.array([7, 8])[here], place[here], time=0.1 * row if stamped else None)
            if row >= 24:
                away = live.predict(12).position[0, 0] - place
                assert np.linalg.norm(away, axis=-1).max() < 3.0

    (sentence,) = sentences(feed)
    length, gap = 45.12 + 0.12 * hidden, 0.1 * (hidden + 1)
    assert f"7 moved {length:.3g} m in {gap:.3g} s, faster than max_speed = 12 m/s" in sentence
    assert "the track begins again there" in sentence
    past = live.past()
    assert past.present[0, -6:].all()
    assert not past.present[0, :-6, 0].any()
    assert past.present[0, :-6, 1].all()
    velocity = (live.predict(1).position[0, 0, 0, 0] - past.position[0, -1, 0]) / 0.1
    if isinstance(predictor, ConstantVelocity | Kalman):
        np.testing.assert_allclose(velocity, [1.2, 0.0], atol=0.05)


def test_each_jump_begins_a_track_and_one_is_reported() -> None:
    live = Live(ConstantVelocity(), dt=0.1)

    def feed() -> None:
        for row in range(40):
            live.update(["a", "b"], [[0.1 * row + 20.0 * (row // 10), 0.0], [9.0 * (row >= 25), 1.0]], time=0.1 * row)
            assert np.abs(live.predict(5).position[0, 0] - live.past().position[0, -1]).max() < 1.0

    (sentence,) = sentences(feed)
    assert "'a' moved 20.1 m" in sentence


def test_a_jump_at_the_second_frame_is_reported_when_it_is_known_from_wrong_units() -> None:
    live = Live(ConstantVelocity(), dt=0.1)

    def send(place: float) -> None:
        live.update([1], [[place, 0.0]])
        assert abs(live.predict(9).position[0, 0, -1, 0, 0] - place) < 1.0

    assert sentences(lambda: [send(0.0), send(45.0)]) == []
    (sentence,) = sentences(lambda: [send(45.1), send(45.2)])
    assert "moved 45 m in 0.1 s" in sentence


def test_a_hidden_person_does_not_coast_along_a_jump() -> None:
    live = Live(ConstantVelocity(), dt=0.1, coast=1.0)
    for row in range(20):
        live.update([1, 2], [[0.1 * row + 45.0 * (row == 19), 0.0], [0.0, 5.0]])
    live.update([2], [[0.0, 5.0]])
    with pytest.warns(TrackerWarning, match="1 moved 45.1 m"):
        place = live.predict(1).position[0, 0, 0, 0]
    np.testing.assert_allclose(place, [46.9, 0.0])


def test_noise_between_frames_a_millisecond_apart_is_no_jump() -> None:
    live, rng = Live(Kalman(), dt=0.1), stream(6, "noise")
    for row in range(60):
        now = 0.05 * (row // 2) + 0.001 * (row % 2)
        live.update([1], [[1.2 * now, 0.0] + rng.normal(0.0, 0.05, 2)], time=now)
    assert live.past().present.all()


# All together


def test_every_kind_is_reported_once_by_each_stream() -> None:
    def feed() -> None:
        live = Live(ConstantVelocity(), dt=0.4)
        for row in range(40):  # a person who jumps, and messages that are too late
            live.update([1, 2], [[0.1 * row + 30.0 * (row % 9 == 8), 0.0], [0.0, 0.1 * row]], time=0.1 * row)
            live.update([2], [[0.0, 0.0]], time=0.1 * row - 1.0)
            live.predict(2)
        walk(live, 100.0, time=1e3)  # from now on in centimetres and milliseconds
        for row in range(20):
            live.update([1], [[130.0 * row, 0.0]])
            live.predict(2)

    for _ in range(2):
        reports = sentences(feed)
        kinds = ["is dropped", "faster than max_speed", "probably in milliseconds", "positions are probably"]
        assert [sum(kind in report for report in reports) for kind in kinds] == [1, 1, 1, 1]
        assert len(reports) == 4


def test_warnings_as_errors_do_not_lose_a_frame() -> None:
    live = Live(ConstantVelocity(), dt=0.1)
    with pytest.raises(TrackerWarning, match="positions are probably in millimetres"):
        walk(live, 1000.0)
    count = live.past().frame[0, -1]
    live.update([0], [[0.0, 0.0]])
    assert live.past().frame[0, -1] == count + 1
