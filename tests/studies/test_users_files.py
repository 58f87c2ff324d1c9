"""Files of users: the study runs commands on own files, counts people, and names what is not as expected."""

from __future__ import annotations

from pathlib import Path

import pytest

from users_files import LIST, Outcome, UserFile, main, miss, read_list

PAGE = Path(__file__).parents[2] / "docs" / "results" / "users-files.md"
ROW = '[[file]]\nkind = "{kind}"\nrepository = "me/data"\ncommit = "abc"\nfile = "{file}"\n{more}\n'
WALK = "".join(f"{10 * k}\t{id}\t{0.5 * k + id}\t{id}\n" for k in range(25) for id in (1, 2))
WORLD = (
    "<sdf version='1.6'><model name='house'><static>1</static><link name='l'><pose>0 0 1 0 0 0</pose>"
    "<collision name='c'><geometry><box><size>4 0.2 2</size></box></geometry></collision></link></model></sdf>"
)
ROOM = b"P5\n60 40\n255\n" + bytes(60) + (b"\x00" + 58 * b"\xfe" + b"\x00") * 38 + bytes(60)


@pytest.fixture
def checkouts(tmp_path):
    home = tmp_path / "me" / "data"
    home.mkdir(parents=True)
    (home / "walk.txt").write_text(WALK)
    (home / "rate.csv").write_text("id,frame,x,y\n" + "".join(f"1,{k},{0.05 * k},0\n" for k in range(30)))
    (home / "model.sdf").write_text(WORLD)
    (home / "hall.ifc").write_text("ISO-10303-21;\nFILE_SCHEMA(('IFC4'));\n")
    (home / "map.yaml").write_text("image: map.pgm\nresolution: 0.2\norigin: [0, 0, 0]\n")
    (home / "map.pgm").write_bytes(ROOM)
    (home / "bare.yaml").write_text("image: map.pgm\nresolution: 0.2\n")
    return tmp_path


def pages(checkouts, capsys, *rows):
    file = checkouts / "list.toml"
    file.write_text("".join(ROW.format(kind=kind, file=name, more=more) for kind, name, more in rows))
    assert main([str(checkouts), "--list", str(file)]) == 0
    return capsys.readouterr().out


def test_the_page_has_what_the_commands_said(checkouts, capsys):
    text = pages(
        checkouts, capsys,
        ("text", "walk.txt", "people = 2"),
        ("table", "rate.csv", 'refused = "has no frame rate"'),
        ("table", "rate.csv", 'command = "predict --fps 25"\npeople = 1'),
        ("model", "model.sdf", 'command = "import"'),
        ("building", "hall.ifc", 'command = "import"\nrefused = "is a building in IFC"'),
        ("map", "map.yaml", 'command = "map"'),
        ("map", "bare.yaml", 'command = "map"\nrefused = "does not say origin"'),
    )  # fmt: skip
    assert "7 commands on recordings, scenes and maps of 1 public repositories" in text
    assert "4 are read, 3 refused; 0 not as expected." in text
    link = "[me/data](https://github.com/me/data/blob/abc/{})"
    assert (
        f"| text | {link.format('walk.txt')} | `predict` | 50 rows of 2 people, step 0.4 s; 13 x 1 m, 1.25 m/s |"
        in text
    )
    assert "|  |  | `predict --fps 25` | 30 rows of 1 person, step 0.04 s; 1.45 x 0 m, 1.25 m/s |" in text
    assert f"| model | {link.format('model.sdf')} | `import` | 1 walls; 4 remarks |" in text
    assert "refused: hall.ifc is a building in IFC" in text
    assert str(checkouts) not in text
    assert sorted(path.name for path in (checkouts / "me" / "data").glob("*.xml")) == []


def test_what_is_not_as_expected_is_named(checkouts, capsys):
    text = pages(
        checkouts, capsys,
        ("text", "walk.txt", "people = 3"),
        ("text", "walk.txt", 'refused = "no"'),
        ("table", "rate.csv", ""),
        ("building", "hall.ifc", 'command = "import"\nrefused = "is a drawing"'),
        ("gone", "gone.txt", ""),
    )  # fmt: skip
    assert "5 not as expected." in text
    assert "* me/data, walk.txt: 2 people are read, the file has 3." in text
    assert "* me/data, walk.txt: it is read." in text
    assert "* me/data, rate.csv: it is refused: rate.csv has no frame rate" in text
    assert "it is refused, but not because 'is a drawing': hall.ifc is a building" in text
    assert f"git clone https://github.com/me/data {checkouts}/me/data" in text


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ('[[file]]\nkind = "a"\n', "file 1 lacks 'repository'"),
        (ROW.format(kind="a", file="b", more="size = 3"), "file 1 has 'size', allowed are command"),
        (ROW.format(kind="a", file="b", more='command = "run"'), "file 1 has the command 'run', it begins with"),
        ("[[file", "cannot read"),
    ],
)
def test_a_wrong_list_is_refused(text, words, checkouts, capsys):
    file = checkouts / "list.toml"
    file.write_text(text)
    with pytest.raises(SystemExit):
        main([str(checkouts), "--list", str(file)])
    assert words in capsys.readouterr().err


def test_the_list_and_the_page_agree():
    items, text = read_list(LIST), PAGE.read_text(encoding="utf-8")
    assert f"{len(items)} commands on recordings" in text
    assert len({item.repository for item in items}) >= 25
    for item in items:
        assert f"({'https://github.com'}/{item.repository}/blob/{item.commit}/" in text
    assert "None." in text  # as expected, all of them


def test_an_outcome_without_people_is_no_miss():
    item = UserFile("a", "me/data", "abc", "b.txt")
    assert miss(item, Outcome(True, "read")) == ""
    assert miss(item, Outcome(False, "no file")) == "it is refused: no file"
