"""Maps of ROS in every form of YAML and image: the same walls, or a sentence."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

from crowdbot.core import InputError
from crowdbot.trials import Stage

HEAD = "image: room.pgm\nresolution: 0.1\norigin: [-1.0, -2.0, 0.0]\n"
PLAIN = HEAD + "negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
BLOCK = PLAIN.replace("[-1.0, -2.0, 0.0]", "\n  - -1.0\n  - -2.0\n  - 0.0")
JSON = (
    '{"image": "room.pgm", "resolution": 0.1, "origin": [-1, -2, 0], "negate": 0, "occupied_thresh": 0.65,'
    ' "free_thresh": 0.196}'
)
FORMS = {
    "plain": PLAIN,
    "no end of the last line": PLAIN.rstrip(),
    "CRLF": PLAIN.replace("\n", "\r\n"),
    "byte order mark": "\ufeff" + PLAIN,
    "byte order mark and CRLF": "\ufeff" + PLAIN.replace("\n", "\r\n"),
    "blank lines": PLAIN.replace("\n", "\n\n"),
    "document marks": f"---\n{PLAIN}...\n",
    "directive": f"%YAML 1.2\n---\n{PLAIN}",
    "comments": "# map\n" + PLAIN.replace("\n", "  # a comment\n"),
    "other order": "\n".join(reversed(PLAIN.splitlines())),
    "block list": BLOCK,
    "block list at the margin": BLOCK.replace("  - ", "- "),
    "block list with comments": BLOCK.replace("- -1.0", "- -1.0  # x"),
    "list on several lines": PLAIN.replace(", -2.0", ",\n  -2.0"),
    "comma at the end of the list": PLAIN.replace("0.0]", "0.0,]"),
    "blanks in the list": PLAIN.replace("[-1.0, -2.0, 0.0]", "[ -1.0 ,-2.0 , 0.0 ]"),
    "flow mapping": "{" + ", ".join(PLAIN.splitlines()) + "}",
    "flow mapping on lines": "{\n " + ",\n ".join(PLAIN.splitlines()) + "\n}",
    "JSON": JSON,
    "JSON on lines": JSON.replace(", ", ",\n  "),
    "double quotes": PLAIN.replace("room.pgm", '"room.pgm"'),
    "single quotes": PLAIN.replace("room.pgm", "'room.pgm'"),
    "quoted keys": PLAIN.replace("image:", '"image":').replace("origin:", "'origin':"),
    "explicit key": PLAIN.replace("image: room.pgm", "? image\n: room.pgm"),
    "folded image": PLAIN.replace("room.pgm", ">-\n  room.pgm"),
    "literal image": PLAIN.replace("room.pgm", "|-\n  room.pgm"),
    "tags": PLAIN.replace("image: ", "image: !!str ").replace("0.65", "!!float 0.65"),
    "anchor and alias": PLAIN.replace("0.0]", "&zero 0.0]").replace("negate: 0", "negate: *zero"),
    "merge key": "image: room.pgm\nbase: &base {resolution: 0.1, origin: [-1, -2, 0]}\n<<: *base\nnegate: 0\n",
    "whole numbers": PLAIN.replace("[-1.0, -2.0, 0.0]", "[-1, -2, 0]"),
    "exponents": PLAIN.replace("0.1\n", "1.0e-1\n").replace("-2.0", "-2.0e+0"),
    "signs": PLAIN.replace("0.65", "+0.65").replace("0.0]", "+0.0]"),
    "numbers without zero": PLAIN.replace("0.65", ".65").replace("-1.0", "-1."),
    "false for 0": PLAIN.replace("negate: 0", "negate: false"),
    "mode trinary": PLAIN + "mode: trinary\n",
    "other keys": PLAIN + "map_id: 3\nlayers: {a: [1, 2]}\ntopic: /map\n",
    "defaults": "image: room.pgm\nresolution: 0.1\norigin: [-1, -2, 0]\n",
    "blanks before colons": PLAIN.replace("negate:", "negate :").replace("image:", "image  :"),
    "path in the folder": PLAIN.replace("room.pgm", "./room.pgm"),
    "PNG": PLAIN.replace("room.pgm", "room.png"),
    "PNG with colours": PLAIN.replace("room.pgm", "colours.png"),
    "BMP": PLAIN.replace("room.pgm", "room.bmp"),
    "negated image": PLAIN.replace("room.pgm", "negated.pgm").replace("negate: 0", "negate: 1"),
}


@pytest.fixture
def room(tmp_path):
    """A folder with images of a room of 4 m x 3 m with a block."""
    cells = np.full((30, 40), 254, dtype=np.uint8)
    cells[[0, -1]] = cells[:, [0, -1]] = 0
    cells[5:10, 20:30] = 0
    image = Image.fromarray(cells)
    for name in ("room.pgm", "room.png", "room.bmp"):
        image.save(tmp_path / name)
    image.convert("RGB").save(tmp_path / "colours.png")
    Image.fromarray(255 - cells).save(tmp_path / "negated.pgm")
    return tmp_path


def rings(room, text):
    (room / "map.yaml").write_bytes(text.encode())
    return [np.asarray(ring) for ring in Stage(map="map.yaml", folder=room).rings]


@pytest.mark.parametrize("form", FORMS)
def test_every_form_of_a_map_gives_the_same_walls(room, form):
    expected, walls = rings(room, PLAIN), rings(room, FORMS[form])
    assert len(expected) == len(walls) == 3
    assert all(np.array_equal(a, b) for a, b in zip(expected, walls, strict=True))
    assert np.concatenate(walls).min(axis=0) == pytest.approx([-1.0, -2.0])
    assert np.concatenate(walls).max(axis=0) == pytest.approx([3.0, 1.0])


def test_a_map_is_turned_about_its_corner(room):
    turned = np.concatenate(rings(room, PLAIN.replace("0.0]", "1.5707963267948966]")))
    assert turned.min(axis=0) == pytest.approx([-4.0, -2.0])
    assert turned.max(axis=0) == pytest.approx([-1.0, 2.0])


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ("resolution: 0.1", "\tresolution: 0.1", "map.yaml"),
        ("0.65", "65", "occupied_thresh = 65 must be from 0 to 1; 65 % is 0.65"),
        ("0.65", "65%", "occupied_thresh has '65%', which is not a number"),
        ("0.1\n", '"0.1 m"\n', "resolution has '0.1 m', which is not a number"),
        ("[-1.0, -2.0, 0.0]", "[-1.0, -2.0]", "origin = .* must be a list of three numbers"),
        ("image: room.pgm\n", "", "is not a ROS map: it does not say image"),
        ("negate: 0", "mode: tri", "mode = 'tri' is unknown"),
        ("0.0]", "0.0", "map.yaml"),
        ("room.pgm", "gone.pgm", "there is no file 'gone.pgm'"),
        ("room.pgm", "!!python/name:os.system", "map.yaml"),
    ],
)
def test_what_is_no_map_is_refused_with_a_sentence(room, old, new, sentence):
    assert old in PLAIN
    with pytest.raises(InputError, match=sentence):
        rings(room, PLAIN.replace(old, new, 1))
