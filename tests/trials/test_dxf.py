"""Stages from drawings in DXF: entities, units, layers, and wrong files."""

import math

import numpy as np
import pytest

from crowdbot.cli import main
from crowdbot.core import TrialError
from crowdbot.trials import import_dxf, import_trial, parse_trial, trial_xml


def groups(*pairs):
    return "".join(f"{code}\n{value}\n" for code, value in pairs)


def line(x, y, u, v, layer="0", *more):
    return groups((0, "LINE"), (8, layer), *more, (10, x), (20, y), (30, 0), (11, u), (21, v), (31, 0))


def drawing(*entities, units=6, layers=()):
    header = groups((0, "SECTION"), (2, "HEADER"), (9, "$INSUNITS"), (70, units), (0, "ENDSEC"))
    rows = "".join(groups((0, "LAYER"), (2, name), (70, flags), (62, color)) for name, flags, color in layers)
    table = groups((0, "SECTION"), (2, "TABLES"), (0, "TABLE"), (2, "LAYER")) + rows
    table += groups((0, "ENDTAB"), (0, "ENDSEC"))
    body = groups((0, "SECTION"), (2, "ENTITIES")) + "".join(entities) + groups((0, "ENDSEC"), (0, "EOF"))
    return groups((999, "made for a test")) + header + table + body


def read(tmp_path, text, **how):
    file = tmp_path / "hall.dxf"
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    return import_dxf(file, **how)


def walls(tmp_path, text, **how):
    ((_, trial),) = read(tmp_path, text, **how).trials
    return [np.array(wall.points) for wall in trial.stage.walls]


SQUARE = groups(
    (0, "LWPOLYLINE"), (8, "walls"), (90, 4), (70, 1), (10, 0), (20, 0), (10, 4000), (20, 0), (10, 4000), (20, 3000),
    (10, 0), (20, 3000),
)  # fmt: skip


def test_a_closed_polyline_in_millimetres_is_a_ring_of_walls(tmp_path):
    (ring,) = walls(tmp_path, drawing(SQUARE, units=4))
    assert ring.tolist() == [[0, 0], [4, 0], [4, 3], [0, 3], [0, 0]]


@pytest.mark.parametrize(("units", "size"), [(1, 0.0254), (2, 0.3048), (4, 0.001), (5, 0.01), (6, 1.0), (7, 1000.0)])
def test_units(tmp_path, units, size):
    (wall,) = walls(tmp_path, drawing(line(0, 0, 10, 5), units=units))
    np.testing.assert_allclose(wall, [[0, 0], [10 * size, 5 * size]], atol=1e-6)
    (wall,) = walls(tmp_path, drawing(line(0, 0, 10, 5), units=units), unit="cm")
    np.testing.assert_allclose(wall, [[0, 0], [0.1, 0.05]])


def test_a_file_without_unit_is_in_metres_and_says_so(tmp_path):
    done = read(tmp_path, drawing(line(0, 0, 10, 5), units=0))
    assert "the file has no unit: coordinates are metres" in done.left_out


def test_arcs_and_circles_keep_within_a_centimetre(tmp_path):
    circle = groups((0, "CIRCLE"), (8, "0"), (10, 2), (20, 1), (40, 3))
    arc = groups((0, "ARC"), (8, "0"), (10, 0), (20, 0), (40, 2), (50, 300), (51, 30))
    ring, bow = walls(tmp_path, drawing(circle, arc))
    np.testing.assert_allclose(np.hypot(*(ring - [2, 1]).T), 3.0, atol=1e-5)
    np.testing.assert_allclose(ring[0], ring[-1], atol=1e-6)
    middle = 0.5 * (ring[1:] + ring[:-1])
    assert np.hypot(*(middle - [2, 1]).T).min() > 3.0 - 0.0101
    np.testing.assert_allclose(bow[[0, -1]], [[1.0, -math.sqrt(3)], [math.sqrt(3), 1.0]], atol=1e-5)
    assert bow[len(bow) // 2][0] > 1.9  # it goes through angle 345 degrees, not the other way round


def test_bulges_of_both_kinds_of_polylines(tmp_path):
    light = groups((0, "LWPOLYLINE"), (8, "0"), (70, 0), (10, 0), (20, 0), (42, 1), (10, 2), (20, 0))
    vertices = groups((0, "VERTEX"), (8, "0"), (10, 0), (20, 0), (42, -1)) + groups((0, "VERTEX"), (10, 2), (20, 0))
    heavy = groups((0, "POLYLINE"), (8, "0"), (66, 1), (70, 0)) + vertices + groups((0, "SEQEND"))
    below, above = walls(tmp_path, drawing(light, heavy))
    for ring, side in ((below, -1.0), (above, 1.0)):
        np.testing.assert_allclose(np.hypot(*(ring - [1, 0]).T), 1.0, atol=1e-5)
        assert side * ring[:, 1].max() >= 0.0
        assert side * ring[len(ring) // 2, 1] > 0.99


def test_layers_are_chosen_by_name_and_hidden_ones_are_left_out(tmp_path):
    text = drawing(
        line(0, 0, 1, 0, "walls"), line(0, 1, 1, 1, "doors"), line(0, 2, 1, 2, "frozen"), line(0, 3, 1, 3, "off"),
        line(0, 4, 1, 4, "paper", (67, 1)), layers=[("walls", 0, 7), ("frozen", 1, 7), ("off", 0, -7)],
    )  # fmt: skip
    done = read(tmp_path, text)
    assert [wall.points[0][1] for wall in done.trials[0][1].stage.walls] == [0.0, 1.0]
    assert {"layer frozen: off or frozen", "layer off: off or frozen"} <= set(done.left_out)
    assert [ring[0, 1] for ring in walls(tmp_path, text, layers=["off", "walls"])] == [0.0, 3.0]
    with pytest.raises(TrialError, match="there is no layer 'wall' with walls; layers are doors, frozen, off, walls"):
        read(tmp_path, text, layers=["wall"])


def test_mirrored_duplicate_and_other_entities(tmp_path):
    arc = groups((0, "ARC"), (8, "0"), (10, 1), (20, 0), (40, 1), (50, 0), (51, 90), (230, -1))
    text = drawing(line(0, 0, 1, 0), line(0, 0, 1, 0), line(2, 2, 2, 2), arc, groups((0, "INSERT"), (8, "0"), (2, "b")))
    done = read(tmp_path, text)
    first, mirrored = (np.array(wall.points) for wall in done.trials[0][1].stage.walls)
    assert first.tolist() == [[0, 0], [1, 0]]
    assert mirrored[:, 0].max() <= 0.0
    assert "the block 'b' is not in the file and is left out" in done.left_out


def test_the_trial_is_written_and_read_and_found_by_content(tmp_path):
    file = tmp_path / "plan.txt"
    file.write_text(drawing(SQUARE, units=4).replace("\n", "\r\n"))
    ((name, trial),) = import_trial(file).trials
    assert (name, trial.name) == ("plan", "plan")
    assert parse_trial(trial_xml(trial)) == trial
    other = tmp_path / "x.xml"
    other.write_text("<trial/>")
    with pytest.raises(TrialError, match="layers and units belong to drawings"):
        import_trial(other, layers=["a"])


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        (b"AutoCAD Binary DXF\r\n\x1a\x00", "is a binary DXF file; save it as ASCII DXF"),
        ("", "ends without EOF"),
        ("0\nSECTION\n2\nENTITIES\n", "ends without EOF"),
        ("0\nSECTION\nx\ny\n", "hall.dxf:3: 'x' is not a group code of DXF"),
        (groups((0, "SECTION"), (2, "HEADER"), (0, "ENDSEC"), (0, "EOF")), "has no section ENTITIES"),
        (drawing(), "there are no lines, polylines, arcs or circles"),
        (drawing(line(0, 0, "nan", 1)), "'nan' is not a finite number"),
        (drawing(line(0, 0, "1e999", 1)), "'1e999' is not a finite number"),
        (drawing(line(0, 0, "1_0", 1)), "'1_0' is not a finite number"),
        (drawing(line(0, 0, 1e8, 1)), "LINE is more than 1e+06 m from the origin"),
        (drawing(line(0, 0, 5, 1), units=19), "the unit $INSUNITS = 19 is not supported"),
        (drawing(groups((0, "LINE"), (10, 1))), "LINE lacks the group 20"),
        (drawing(groups((0, "CIRCLE"), (10, 1), (20, 1), (40, -1))), "the radius -1 of CIRCLE must be above 0"),
        (drawing(*(line(k, 0, k, 1) for k in range(10_001))), "10001 walls are more than 10000; choose layers: 0"),
        (drawing(*[line(0, 0, 1, 1)] * 50_001), "more than 50000 entities are too many"),
        (drawing(groups((0, "ARC"), (10, 0), (20, 0), (40, "1e200"), (50, 0), (51, 9))), "more than 1e+06 m"),
    ],
)
def test_wrong_and_hostile_files_end_with_a_sentence(tmp_path, text, sentence):
    with pytest.raises(TrialError) as caught:
        read(tmp_path, text)
    assert sentence in str(caught.value)


def test_an_unknown_unit_and_a_missing_file(tmp_path):
    with pytest.raises(TrialError, match="the unit 'yd' is unknown; units are in, ft, mm, cm, m, km"):
        read(tmp_path, drawing(line(0, 0, 1, 1)), unit="yd")
    with pytest.raises(TrialError, match="there is no DXF file"):
        import_dxf(tmp_path / "missing.dxf")


def test_random_bytes_never_raise_anything_else(tmp_path):
    rng = np.random.default_rng(0)
    text, told = drawing(SQUARE, line(0, 0, 1, 0)).encode(), []
    for _ in range(200):
        data = bytearray(text)
        for k in rng.integers(len(data), size=rng.integers(1, 6)):
            data[k] = rng.integers(256)
        try:
            read(tmp_path, bytes(data[: rng.integers(len(data) // 2, len(data) + 1)]))
        except TrialError as error:
            told.append(str(error))
    assert len(told) > 50
    assert all("hall.dxf" in sentence for sentence in told)


@pytest.mark.parametrize(
    ("units", "size", "sentence"),
    [
        (
            4,
            25,
            "the drawing is 0.025 m x 0.0125 m in the unit mm, which may be wrong; with --unit m it is 25 m x 12.5 m",
        ),
        (1, 40, "the drawing is 1.02 m x 0.508 m in the unit in, which may be wrong; with --unit m it is 40 m x 20 m"),
        (6, 30000, "in the unit m, which may be wrong; with --unit mm it is 30 m x 15 m"),
        (0, 18000, "in the unit m, which may be wrong; with --unit mm it is 18 m x 9 m"),
        (4, 0.5, "the drawing is 0.0005 m x 0.00025 m in the unit mm, which may be wrong"),
    ],
)
def test_a_drawing_of_implausible_size_names_the_unit_that_mends_it(tmp_path, units, size, sentence):
    text = drawing(line(0, 0, size, 0), line(0, 0, 0, size / 2), units=units)
    notes = read(tmp_path, text).left_out
    assert [note for note in notes if sentence in note], notes
    if "--unit" in sentence:
        unit = sentence.partition("--unit ")[2].split()[0]
        assert not any("may be wrong" in note for note in read(tmp_path, text, unit=unit).left_out)


@pytest.mark.parametrize(("units", "size"), [(4, 2500), (6, 2000), (5, 900), (1, 300)])
def test_a_drawing_of_plausible_size_has_no_note(tmp_path, units, size):
    assert not any(
        "may be wrong" in note for note in read(tmp_path, drawing(line(0, 0, size, 0), units=units)).left_out
    )


def test_the_commands_tell_the_size_of_a_drawing(tmp_path, capsys):
    file = tmp_path / "hall.dxf"
    file.write_text(drawing(SQUARE.replace("4000", "9").replace("3000", "5"), units=4))
    out = tmp_path / "hall.xml"
    assert main(["new", "trial", str(out), "--import", str(file)]) == 0
    assert "with --unit m it is 9 m x 5 m" in capsys.readouterr().out
    main(["check", str(out)])
    assert "note: the box around the walls is 0.009 m x 0.005 m, below 2 m" in capsys.readouterr().out
    assert main(["new", "trial", str(out), "--import", str(file), "--unit", "m", "--force"]) == 0
    main(["check", str(out)])
    assert "note" not in capsys.readouterr().out


def block(name, *entities, base=(0, 0), flags=0):
    head = groups((0, "BLOCK"), (8, "0"), (2, name), (70, flags), (10, base[0]), (20, base[1]))
    return head + "".join(entities) + groups((0, "ENDBLK"), (8, "0"))


def insert(name, x, y, *more, layer="0"):
    return groups((0, "INSERT"), (8, layer), (2, name), (10, x), (20, y), *more)


def with_blocks(text, *blocks):
    section = groups((0, "SECTION"), (2, "BLOCKS")) + "".join(blocks) + groups((0, "ENDSEC"))
    return text.replace(groups((0, "SECTION"), (2, "ENTITIES")), section + groups((0, "SECTION"), (2, "ENTITIES")), 1)


DOOR = block("door", line(1, 0, 3, 0), base=(1, 0))


@pytest.mark.parametrize(
    ("more", "ends"),
    [
        ([], [[[10, 5], [12, 5]]]),
        ([(50, 90)], [[[10, 5], [10, 7]]]),
        ([(41, 2), (42, 3), (50, 180)], [[[10, 5], [6, 5]]]),
        ([(41, -1)], [[[10, 5], [8, 5]]]),
        ([(230, -1)], [[[-10, 5], [-12, 5]]]),
        ([(70, 2), (71, 2), (44, 4), (45, 1)], [[[10 + u, 5 + v], [12 + u, 5 + v]] for v in (0, 1) for u in (0, 4)]),
        ([(50, 90), (70, 2), (44, 4)], [[[10, 5], [10, 7]], [[10, 9], [10, 11]]]),
    ],
)
def test_a_block_is_drawn_where_it_is_inserted(tmp_path, more, ends):
    found = walls(tmp_path, with_blocks(drawing(insert("door", 10, 5, *more)), DOOR))
    np.testing.assert_allclose([wall.tolist() for wall in found], ends, atol=1e-6)


def test_blocks_in_blocks_and_arcs_in_stretched_blocks(tmp_path):
    circle = groups((0, "CIRCLE"), (8, "0"), (10, 0), (20, 0), (40, 1))
    room = block("room", insert("door", 0, 0), circle)
    text = with_blocks(drawing(insert("room", 100, 0, (41, 10), (42, 5), (50, 90))), DOOR, room)
    door, ellipse = walls(tmp_path, text)
    np.testing.assert_allclose(door, [[100, 0], [100, 20]], atol=1e-6)
    x, y = (ellipse - [100, 0]).T
    np.testing.assert_allclose((x / 5) ** 2 + (y / 10) ** 2, 1.0, atol=1e-6)
    assert len(ellipse) > 60  # chords within 1 cm at the size in the drawing


def test_layers_of_blocks(tmp_path):
    parts = block("parts", line(0, 0, 1, 0), line(0, 1, 1, 1, "glass"))
    text = with_blocks(drawing(insert("parts", 0, 0, layer="walls"), line(5, 5, 6, 5)), parts)
    (wall,) = walls(tmp_path, text, layers=["walls"])
    assert wall.tolist() == [[0, 0], [1, 0]]
    (glass,) = walls(tmp_path, text, layers=["glass"])
    assert glass.tolist() == [[0, 1], [1, 1]]
    assert len(walls(tmp_path, text)) == 3


@pytest.mark.parametrize(
    ("blocks", "sentence"),
    [
        ([], "the block 'door' is not in the file and is left out"),
        ([block("door", flags=4)], "the block 'door' is in another file and is left out"),
        ([block("door", groups((0, "TEXT"), (8, "0")), line(0, 0, 1, 0))], "entities TEXT are not imported"),
    ],
)
def test_blocks_that_are_left_out_are_named(tmp_path, blocks, sentence):
    done = read(tmp_path, with_blocks(drawing(insert("door", 0, 0), line(0, 0, 9, 9)), *blocks))
    assert sentence in done.left_out


@pytest.mark.parametrize(
    ("blocks", "more", "sentence"),
    [
        ([block("door", insert("door", 1, 0))], [], "blocks are nested more than 16 levels deep"),
        ([DOOR], [(70, 9000), (71, 9000)], "81000000 copies of a block are too many"),
        ([block("door", *[line(0, 0, k, 1) for k in range(1, 30)])], [(70, 100), (71, 100)], "are too many"),
        (
            [block("door", *[insert("none", 0, 0, (70, 200), (71, 200))] * 40), block("none")],
            [],
            "entities with those of blocks",
        ),
        ([DOOR], [(41, "wide")], "'wide' is not a finite number"),
    ],
)
def test_hostile_blocks_are_rejected(tmp_path, blocks, more, sentence):
    with pytest.raises(TrialError, match=sentence):
        read(tmp_path, with_blocks(drawing(insert("door", 0, 0, *more)), *blocks))
