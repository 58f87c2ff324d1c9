"""Tables as spreadsheets, robots and trackers write them: the same tracks, or the cause in one sentence."""

import gzip
import math

import numpy as np
import pytest

from crowdbot.core import DataError
from crowdbot.data import NoWindowError, Trajectories, load

HEAD = ("time", "id", "x", "y")


def walkers(rows=40):
    """Rows (time, id, x, y) of six people who walk at 1.3 m/s, by time."""
    table = []
    for k in range(rows):
        for person in range(1, 7):
            angle, way = 0.9 * person, 1.3 * 0.4 * k
            table.append((0.4 * k, person, 2.0 * person + way * math.cos(angle), person + way * math.sin(angle)))
    return table


def point(row):
    return (f"{row[0]:.1f}", str(row[1]), f"{row[2]:.4f}", f"{row[3]:.4f}")


def comma(row):
    return tuple(word.replace(".", ",") for word in point(row))


def text_of(delimiter=",", head=HEAD, words=point, rows=None):
    lines = ([delimiter.join(head)] if head else []) + [delimiter.join(words(row)) for row in rows or walkers()]
    return "\n".join(lines) + "\n"


def save(tmp_path, data, name="own.csv"):
    path = tmp_path / name
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    return path


def assert_same(tracks: Trajectories) -> None:
    assert (len(tracks), tracks.dt, tracks.ids.tolist()) == (240, pytest.approx(0.4), [1, 2, 3, 4, 5, 6])
    expected = sorted(walkers(), key=lambda row: (row[0], row[1]))
    assert np.allclose(tracks.position, [row[2:] for row in expected], atol=1e-4)
    assert tracks.warnings == []


@pytest.mark.parametrize(
    "data",
    [
        text_of("|"),
        text_of("|", words=comma),
        text_of(";", words=comma),
        text_of("\t", words=comma),
        "sep=;\n" + text_of(";", words=comma),
        "SEP=,\r\n" + text_of(),
        text_of().encode("utf-16"),
        text_of("\t").encode("utf-16"),
        b"\xfe\xff" + text_of().encode("utf-16-be"),
        text_of().encode("utf-32"),
        gzip.compress(text_of(";").encode("utf-16"), mtime=0),
        b"\xef\xbb\xbf" + text_of().encode(),
        text_of().replace("\n", "\r").encode(),
    ],
    ids=lambda data: repr(data[:12]),
)
def test_delimiters_and_encodings(tmp_path, data):
    assert_same(load(save(tmp_path, data)))


@pytest.mark.parametrize(
    ("delimiter", "words"), [(";", comma), ("|", point), ("\t", comma), (" ", point), (";", point)]
)
def test_a_table_without_names_keeps_its_first_row(tmp_path, delimiter, words):
    path = save(tmp_path, text_of(delimiter, None, words))
    assert_same(load(path, columns={"time": "1", "id": "2", "x": "3", "y": "4"}))


@pytest.mark.parametrize("delimiter", [";", "|"])
def test_a_table_without_names_asks_for_numbers_of_columns(tmp_path, delimiter):
    with pytest.raises(DataError, match="a table without names needs numbers of columns, such as --columns time=1"):
        load(save(tmp_path, text_of(delimiter, None, comma)))


@pytest.mark.parametrize(
    "head",
    [("sec", "nanosec"), ("secs", "nsecs"), ("header.stamp.sec", "header.stamp.nanosec"), ("stamp.secs", "stamp.nsecs"),
     ("Sec", "NanoSec")],
)  # fmt: skip
def test_stamps_in_two_columns(tmp_path, head):
    def words(row):
        sec, rest = divmod(round(row[0] * 1e9), 10**9)
        return (str(1_700_000_000 + sec), str(rest), *point(row)[1:])

    tracks = load(save(tmp_path, text_of(head=(*head, "id", "x", "y"), words=words)))
    assert_same(tracks)
    assert f"times are {head[0]} with the nanoseconds of {head[1]}" in tracks.note


@pytest.mark.parametrize(
    ("head", "twice"),
    [(("time", "id", "x", "y", "y"), "y"), (("time", "id", "x", "x", "y"), "x"),
     (("time", "time", "id", "x", "y"), "time"), (("time", "id", "id", "x", "y"), "id"),
     (("time", "id", "X", "X", "y"), "X")],
)  # fmt: skip
def test_two_columns_of_one_name_are_not_chosen_by_chance(tmp_path, head, twice):
    at = head.index(twice)
    path = save(tmp_path, text_of(head=head, words=lambda row: (*point(row)[: at + 1], "7", *point(row)[at + 1 :])))
    with pytest.raises(DataError, match=f"several columns called '{twice}'; choose one by its number"):
        load(path)
    assert_same(load(path, columns={twice.lower(): str(at + 1)}))


@pytest.mark.parametrize(
    ("column", "value", "sentence"),
    [
        (2, "1e308", r"line 61: x is 1e\+308 for frame 9, id 6; coordinates must be at most 1e\+12"),
        (3, "-1e200", r"y is -1e\+200 for frame 9, id 6; coordinates must be at most 1e\+12"),
        (2, "1e400", "x is inf for frame 9, id 6; coordinates must be finite"),
        (0, "1e308", r"line 61: the time 1e\+308 s is more than 1e\+12 steps of 0.4 s from the others"),
        (0, "-1e30", "remove rows with wrong times"),
        (0, "inf", "its time is missing or infinite"),
        (3, "", "y is nan for frame 9, id 6; coordinates must be finite"),
    ],
)
@pytest.mark.filterwarnings("error")
def test_numbers_that_are_no_places_or_times(tmp_path, column, value, sentence):
    def words(row):
        cells = list(point(row))
        if row[1] == 6 and cells[0] == "3.6":
            cells[column] = value
        return cells

    with pytest.raises(DataError, match=sentence):
        load(save(tmp_path, text_of(words=words)))


def test_decimal_commas_need_another_delimiter(tmp_path):
    with pytest.raises(DataError, match="line 2 has 7 columns, the line of names has 4; commas are delimiters here"):
        load(save(tmp_path, text_of(words=comma)))


@pytest.mark.parametrize("pair", [(1, 2), (2, 5), (3, 4), (1, 6), (6, 2)])
def test_exchanged_identities_are_named(tmp_path, pair):
    first, second = pair
    exchanged = {first: second, second: first}
    rows = [(t, exchanged.get(id, id) if t > 10.1 else id, x, y) for t, id, x, y in walkers()]
    (warning,) = load(save(tmp_path, text_of(rows=rows))).warnings
    assert "2 steps are impossible for people" in warning
    assert f"at frame 26, the ids {min(pair)} and {max(pair)} are perhaps exchanged there" in warning


@pytest.mark.parametrize("jump", [5.0, -9.0])
def test_a_track_of_two_people_is_named(tmp_path, jump):
    rows = [(t, id, x + jump * (id == 3 and t > 10.1), y) for t, id, x, y in walkers()]
    (warning,) = load(save(tmp_path, text_of(rows=rows))).warnings
    assert "a step is impossible for people: person 3 moves at" in warning
    assert "the track is perhaps of two people" in warning


@pytest.mark.parametrize("wrong", [1e6, 1e9])
def test_a_wrong_time_stamp_is_named(tmp_path, wrong):
    rows = [
        (wrong if (k, id) == (39, 6) else t, id, x, y) for k, (t, id, x, y) in enumerate(walkers()) for k in [k // 6]
    ]
    (warning,) = load(save(tmp_path, text_of(rows=rows))).warnings
    assert f"nobody is there for {wrong:.3g} s after 15.6 s" in warning


def test_kilometres(tmp_path):
    rows = [(t, id, x / 1000, y / 1000) for t, id, x, y in walkers()]
    words = lambda row: (f"{row[0]:.1f}", str(row[1]), f"{row[2]:.7f}", f"{row[3]:.7f}")  # noqa: E731
    path = save(tmp_path, text_of(rows=rows, words=words))
    (warning,) = load(path).warnings
    assert "the places are probably in kilometres, give --units km" in warning
    assert_same(load(path, units="km"))


@pytest.mark.parametrize("height", ["1.7", "0.5", "0.0", "12", "-1"])
def test_five_columns_with_the_frame_first(tmp_path, height):
    words = lambda row: (str(round(row[0] * 25)), *point(row)[1:], height)  # noqa: E731
    path = save(tmp_path, text_of(" ", None, words))
    tracks = load(path)
    assert any("id and frame seem to be swapped" in warning for warning in tracks.warnings)
    with pytest.raises(NoWindowError, match="id and frame seem to be swapped"):
        tracks.windows(8, 12)
    assert_same(load(path, columns={"frame": "1", "id": "2", "x": "3", "y": "4"}, fps=25.0))


@pytest.mark.parametrize(
    "last", [(0.05, 0.0, -0.5), (-0.05, 0.0, 0.5), (0.0, 0.1, -0.5), (0.0, -0.1, 0.9), (0.05, 0.05, -0.9)]
)
def test_a_homography_whose_horizon_lies_between_people(tmp_path, last):
    path = save(tmp_path, text_of())
    with pytest.raises(DataError, match=r"the horizon of the homography lies between the positions, such as person \d"):
        load(path, transform=[[0.02, 0.0, 0.0], [0.0, 0.02, 0.0], last])
    away = [[0.02, 0.0, 0.0], [0.0, 0.02, 0.0], [0.001, 0.0, 1.0]]
    assert len(load(path, transform=away)) == 240
    same_place = load(path, transform=(-np.asarray(away)).tolist()).position
    assert np.allclose(same_place, load(path, transform=away).position)
