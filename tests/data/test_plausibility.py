"""Units and columns that a file does not name: a warning with the number and the option, no silent conversion."""

from __future__ import annotations

import re

import numpy as np
import pytest

from crowdbot import cli
from crowdbot.core import DataError, InputError
from crowdbot.data import load

NORTH = 1.0 / 111_195.0
"""Degrees of latitude in a metre."""


def walkers(people=4, rows=40, dt=0.1, speed=1.3, seed=0):
    """Return rows of id, frame, time [s], x and y [m] of people who walk beside each other, and heights of heads."""
    random = np.random.default_rng(seed)
    table = []
    for frame in range(rows):
        for who in range(people):
            height = 1.55 + 0.1 * who + 0.02 * np.sin(12.0 * dt * frame) + 0.003 * random.standard_normal()
            table.append((who, frame, dt * frame, speed * dt * frame, 1.2 * who, height))
    return table


def write(path, header, rows):
    path.write_text("\n".join([header, *(",".join(f"{value:.9g}" for value in row) for row in rows)]) + "\n")
    return path


def warnings_of(path, **options):
    return load(path, **options).warnings


@pytest.mark.parametrize(
    ("dt", "per", "unit", "begin"),
    [
        (0.1, 1e3, "ms", 0.0),
        (0.4, 1e3, "ms", 1.0e6),
        (0.02, 1e3, "ms", 0.0),
        (0.002, 1e3, "ms", 0.0),
        (0.5, 1e3, "ms", 5000.0),
    ],
)
@pytest.mark.parametrize("frames", [True, False])
def test_times_in_milliseconds(tmp_path, dt, per, unit, begin, frames):
    count = 1000 if dt < 0.01 else 40
    rows = [(a, f, begin + round(per * t), x, y) for a, f, t, x, y, _ in walkers(2, count, dt)]
    header = "id,frame,timestamp,x,y" if frames else "id,timestamp,x,y"
    path = write(tmp_path / "t.csv", header, rows if frames else [(row[0], *row[2:]) for row in rows])
    (warning,) = warnings_of(path)
    assert f"give --columns time_{unit}=timestamp" in warning
    assert f"{per * dt:.4g} s apart" in warning
    mended = load(path, columns={f"time_{unit}": "timestamp"})
    assert mended.dt == pytest.approx(dt)
    assert "warning" not in mended.note
    assert "milliseconds" in mended.note


@pytest.mark.parametrize(("per", "unit"), [(1e6, "us"), (1e9, "ns")])
@pytest.mark.parametrize("dt", [0.02, 0.04, 0.1, 0.25, 0.4])
def test_times_in_shorter_units(tmp_path, per, unit, dt):
    rows = [(a, f, per * t, x, y) for a, f, t, x, y, _ in walkers(2, 20, dt)]
    path = write(tmp_path / "t.csv", "id,frame,stamp,x,y".replace("stamp", "time"), rows)
    (warning,) = warnings_of(path)
    assert f"give --columns time_{unit}=time" in warning
    assert load(path, columns={f"time_{unit}": "time"}).dt == pytest.approx(dt)
    alone = write(tmp_path / "a.csv", "id,time,x,y", [(row[0], *row[2:]) for row in rows])
    with pytest.raises(DataError, match=f"times must be in seconds; give --columns time_{unit}=COLUMN"):
        load(alone)


@pytest.mark.parametrize(
    ("column", "per"),
    [("timestamp_ms", 1e3), ("time [ms]", 1e3), ("t_us", 1e6), ("Timestamp_ns", 1e9), ("milliseconds", 1e3)],
)
def test_names_with_a_unit_of_time_are_read_in_it(tmp_path, column, per):
    path = write(tmp_path / "t.csv", f"id,{column},x,y", [(a, per * t, x, y) for a, _, t, x, y, _ in walkers()])
    tracks = load(path)
    assert tracks.dt == pytest.approx(0.1)
    assert column in tracks.note
    assert "warning" not in tracks.note


def test_a_frame_rate_that_contradicts_milliseconds_is_refused(tmp_path):
    path = write(tmp_path / "t.csv", "id,time,x,y", [(a, 1e3 * t, x, y) for a, _, t, x, y, _ in walkers()])
    with pytest.raises(DataError, match="probably in milliseconds, give --columns time_ms=time"):
        load(path, fps=10.0)


@pytest.mark.parametrize(
    ("longitude", "latitude"), [(6.4, 50.9), (-71.1, 42.4), (139.7, 35.7), (0.0, 0.0), (-58.4, -34.6)]
)
def test_places_in_degrees(tmp_path, longitude, latitude):
    east = NORTH / np.cos(np.radians(latitude))
    rows = [(a, t, longitude + east * x, latitude + NORTH * y) for a, _, t, x, y, _ in walkers(6)]
    text = "\n".join(",".join(f"{value:.10f}" if k else str(value) for k, value in enumerate(row)) for row in rows)
    for names in ("x,y", "east,north"):
        path = tmp_path / "t.csv"
        path.write_text(f"id,time,{names}\n{text}\n")
        columns = dict(zip("xy", names.split(","), strict=True))
        (warning,) = warnings_of(path, columns=columns)
        assert "give --units deg" in warning
        metres = load(path, columns=columns, units="deg")
        assert np.ptp(metres.position, axis=0) == pytest.approx([5.07, 6.0], abs=1e-3)
        assert "warning" not in metres.note
    for names in ("lon,lat", "longitude,latitude", "Lng,Lat"):
        path.write_text(f"id,time,{names}\n{text}\n")
        named = load(path)
        assert np.ptp(named.position, axis=0) == pytest.approx([5.07, 6.0], abs=1e-3)
        assert "degrees are converted" in named.note


def steps(longitude, latitude, both=True):
    """Return rows of id, time, latitude and longitude of ten people, every second one of whom walks to the east."""
    rows = []
    for who in range(10):
        speed = 1.1 + 0.05 * who
        for k in range(60):
            east, north = (0.1 * speed * k, who) if who % 2 or not both else (who, 0.1 * speed * k)
            x = longitude + NORTH * east / np.cos(np.radians(latitude))
            rows.append((who, 0.1 * k, latitude + NORTH * north, x))
    return rows


def degrees_file(path, header, rows):
    lines = (",".join(f"{value:.10f}" if k else str(value) for k, value in enumerate(row)) for row in rows)
    path.write_text("\n".join([header, *lines]) + "\n")
    return path


@pytest.mark.parametrize("header", ["id,time,x,y", "person,t,pos_x,pos_y", "id,time,x [m],y [m]"])
@pytest.mark.parametrize(
    ("longitude", "latitude"),
    [(11.58, 48.14), (139.7, 35.7), (-0.12, 51.5), (-122.3, 47.6), (-58.4, -34.6), (24.9, 60.2), (151.2, -33.9)],
)
def test_places_in_degrees_with_the_latitude_first(tmp_path, longitude, latitude, header):
    path = degrees_file(tmp_path / "t.csv", header, steps(longitude, latitude))
    (warning,) = warnings_of(path)
    x, y = header.split(",")[2:]
    assert "degrees of latitude (x) and longitude (y), give --units deg" in warning
    assert f"and give --columns x={y} y={x}" in warning
    metres = load(path, units="deg", columns={"x": y, "y": x})
    assert "warning" not in metres.note
    origin = float(metres.note.split("of longitude ")[1].split(",")[0])
    assert origin == pytest.approx(longitude, abs=1e-3)
    assert np.ptp(metres.position, axis=0) == pytest.approx([9.145, 8.85], abs=0.3)


def test_the_order_of_degrees_is_not_taken_on_trust(tmp_path):
    swapped = [(who, t, x, y) for who, t, y, x in steps(11.58, 48.14)]
    (ordered,) = warnings_of(degrees_file(tmp_path / "t.csv", "id,time,x,y", swapped))
    assert ordered.endswith("degrees of longitude (x) and latitude (y), give --units deg")
    (unknown,) = warnings_of(degrees_file(tmp_path / "t.csv", "id,time,x,y", steps(11.58, 48.14, both=False)))
    assert unknown.endswith("give --units deg, and if x, 48.14, is the latitude, also give --columns x=y y=x")
    path = degrees_file(tmp_path / "t.csv", "id,time,x,y", steps(139.7, 35.7))
    with pytest.raises(DataError, match=r"latitude is 139\.7.*x is probably the latitude.* give --columns x=y y=x"):
        load(path, units="deg")
    rows = [(int(who), round(10 * t), x, y) for who, t, x, y in steps(139.7, 35.7)]
    path.write_text("\n".join(f"{frame} {who} {x:.10f} {y:.10f}" for who, frame, x, y in rows))
    (nameless,) = warnings_of(path, fps=10.0)
    assert nameless.endswith("give --units deg, and write a table with x and y exchanged")


@pytest.mark.parametrize("header", ["id,time,x,y", "person,t,pos_x,pos_y"])
@pytest.mark.parametrize(("longitude", "latitude"), [(11.58, 48.14), (-0.12, 51.5), (-58.4, -34.6), (24.9, 60.2)])
def test_exchanged_degrees_are_named_by_the_speeds(tmp_path, longitude, latitude, header):
    path = degrees_file(tmp_path / "t.csv", header, steps(longitude, latitude))
    (warning,) = warnings_of(path, units="deg")
    x, y = header.split(",")[2:]
    east, north = (float(text) for text in re.findall(r"([0-9.]+) m ", warning)[:2])
    cos_x, cos_y = np.cos(np.radians((latitude, longitude)))
    assert (east, north) == (pytest.approx(9.0 * cos_y, abs=0.3), pytest.approx(9.1 / cos_x, abs=0.4))
    assert "only exchanged people walk as fast to the east as to the north" in warning
    assert warning.endswith(f"of latitude (x) and longitude (y), give --columns x={y} y={x}")
    assert "warning" not in load(path, units="deg", columns={"x": y, "y": x}).note


@pytest.mark.parametrize(("longitude", "latitude"), [(11.58, 48.14), (-0.12, 51.5), (-58.4, -34.6)])
@pytest.mark.parametrize("exchanged", [False, True])
def test_an_order_of_degrees_that_the_speeds_do_not_decide_is_named(tmp_path, longitude, latitude, exchanged):
    rows = steps(longitude, latitude, both=False)
    rows = rows if exchanged else [(who, t, x, y) for who, t, y, x in rows]
    path = degrees_file(tmp_path / "t.csv", "id,time,x,y", rows)
    (warning,) = warnings_of(path, units="deg")
    first = float(warning.split("if x, ")[1].split(",")[0])
    assert first == pytest.approx(latitude if exchanged else longitude, abs=1e-3)
    assert "m to the north as read" in warning
    assert "which the speeds do not decide: if it is, give --columns x=y y=x, if not, give --columns x=x y=y" in warning
    for columns in ({"x": "x", "y": "y"}, {"x": "y", "y": "x"}):
        assert "warning" not in load(path, units="deg", columns=columns).note
    named = degrees_file(tmp_path / "n.csv", "id,time,lat,lon" if exchanged else "id,time,lon,lat", rows)
    assert "warning" not in load(named).note


def test_degrees_near_the_equator_have_no_doubtful_order(tmp_path):
    path = degrees_file(tmp_path / "t.csv", "id,time,x,y", steps(6.6, 0.4, both=False))
    assert "warning" not in load(path, units="deg").note


def test_degrees_that_cannot_be(tmp_path):
    path = write(tmp_path / "t.csv", "id,time,lon,lat", [(1, 0, 10, 99), (1, 1, 10, 99)])
    with pytest.raises(DataError, match="latitude is 99, but degrees of latitude are at most 90"):
        load(path)
    with pytest.raises(InputError, match="x=lat y=lon: x is the longitude"):
        load(path, columns={"x": "lat", "y": "lon"})


@pytest.mark.parametrize(
    ("per", "units"), [(1.0, None), (100.0, "cm"), (1000.0, "mm"), (1.0 / 0.3048, "ft"), (1.0, "m")]
)
@pytest.mark.parametrize("header", ["id,time,x,y,z", "id,time,pos_x,pos_y,pos_z", "id,time,z,y,x"])
def test_a_height_that_is_read_as_y(tmp_path, per, units, header):
    rows = [(a, t, per * x, per * h, per * y) for a, _, t, x, y, h in walkers()]
    path = write(tmp_path / "t.csv", header, rows)
    (warning,) = warnings_of(path, units=units)
    third = "z" if header.endswith(("z", "x")) and "pos" not in header else "pos_z"
    assert f"y is probably the height, give --columns y={third}" in warning
    mended = load(path, units=units, columns={"y": third})
    assert "warning" not in mended.note


def test_a_height_in_another_place(tmp_path):
    rows = [(a, t, h, x, y) for a, _, t, x, y, h in walkers()]
    (warning,) = warnings_of(write(tmp_path / "t.csv", "id,time,x,y,z", rows))
    assert "x is probably the height, give --columns x=z" in warning
    rows = [(a, f, x, h, y) for a, f, _, x, y, h in walkers()]
    lines = (" ".join(f"{value:.6g}" for value in row) for row in rows)
    (tmp_path / "p.txt").write_text("# PeTrack\n# framerate: 10\n# id frame x/m y/m z/m\n" + "\n".join(lines) + "\n")
    (warning,) = warnings_of(tmp_path / "p.txt")
    assert "y is probably the height, write a CSV and give --columns" in warning


def test_people_on_one_line_who_walk_through_each_other(tmp_path):
    rows = [(a, t, x + (0.05 * a), 1.7) for a, _, t, x, _, _ in walkers()]
    (warning,) = warnings_of(write(tmp_path / "t.csv", "id,time,x,y", rows))
    assert "y is constant at 1.7 m" in warning


@pytest.mark.parametrize(("unit", "per"), [("cm", 100.0), ("mm", 1000.0)])
def test_places_in_smaller_units(tmp_path, unit, per):
    rows = [(a, t, per * x, per * y) for a, _, t, x, y, _ in walkers()]
    path = write(tmp_path / "t.csv", "id,time,x,y", rows)
    (warning,) = warnings_of(path)
    assert f"with --units {unit} it is 1.3 m/s" in warning
    assert "warning" not in load(path, units=unit).note


@pytest.mark.parametrize(
    "change",
    [
        lambda a, t, x, y, h: (t, x, y, h),  # heights as heights
        lambda a, t, x, y, h: (t, x, 0.0 * y, h) if a == 0 else (t, x, y, h),
        lambda a, t, x, y, h: (t, x + 3.0 * a, 0.1 * np.sin(x), h),  # one after the other
        lambda a, t, x, y, h: (10.0 * t, 0.05 * a, y, h),  # nobody moves, a row each second
        lambda a, t, x, y, h: (10.0 * t, 0.05 * a + 0.003 * np.sin(50.0 * t), y, h),  # noise of standing people
        lambda a, t, x, y, h: (100.0 * t, 100.0 * x, y, h),  # a row every 10 s
        lambda a, t, x, y, h: (1.7e9 + t, x, y, h),  # seconds since 1970
    ],
)
def test_recordings_of_people_have_no_warning(tmp_path, change):
    rows = [(a, *change(a, t, x, y, h)) for a, _, t, x, y, h in walkers()]
    path = tmp_path / "t.csv"
    path.write_text("id,time,x,y,z\n" + "\n".join(",".join(map(repr, map(float, row))) for row in rows) + "\n")
    assert warnings_of(path) == []


def test_measure_prints_the_warnings(tmp_path, capsys):
    path = write(tmp_path / "t.csv", "id,time,x,y", [(a, 1e3 * t, x, y) for a, _, t, x, y, _ in walkers()])
    assert cli.main(["measure", str(path), "--methods", "individual"]) == 0
    assert "t.csv: warning: the times in time are 100 s apart" in capsys.readouterr().err
