"""Hostile meshes, material files and textures: a refusal in one sentence, no trace, no hang, no file outside."""

import json
import re
import struct
import zlib

import numpy as np
import pytest
import trimesh
from mesh_texts import BOX_DAE, BOX_MTL, BOX_OBJ, PNG, box_glb, png

from crowdbot.core import InputError
from crowdbot.world import read_urdf
from crowdbot.world.urdf import mjcf
from crowdbot.world.urdf.meshes import read_mesh
from samples import sample

ONE = (1.0, 1.0, 1.0)
ROBOT = """<robot name='r'><link name='a'><inertial><mass value='1'/>
<inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>
<visual><geometry><mesh filename='{name}'/></geometry></visual>
<collision><geometry><mesh filename='{name}'/></geometry></collision></link></robot>"""


def write_robot(folder, name, data):
    """Write a robot with a mesh to a folder and return its path."""
    (folder / name).write_bytes(data if isinstance(data, bytes) else data.encode())
    (folder / "r.urdf").write_text(ROBOT.format(name=name))
    return folder / "r.urdf"


def change_table(change):
    """Return a GLB file whose table is changed by a function."""
    data = box_glb()
    length = struct.unpack("<I", data[12:16])[0]
    table = json.loads(data[20 : 20 + length])
    change(table)
    text = json.dumps(table).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + length :]
    head = struct.pack("<4sII", b"glTF", 2, 20 + len(text) + len(rest))
    return head + struct.pack("<I4s", len(text), b"JSON") + text + rest


def doubling_dae(levels):
    """Return a DAE file whose nodes use each other twice on every level."""
    rows = "".join(
        f"<node id='n{k}'><instance_node url='#n{k + 1}'/><instance_node url='#n{k + 1}'/></node>"
        for k in range(levels)
    )
    last = f"<node id='n{levels}'><instance_geometry url='#box'/></node>"
    library = f"<library_nodes>{last}{rows}</library_nodes><library_visual_scenes>"
    text = BOX_DAE.replace("<library_visual_scenes>", library)
    return text.replace("<instance_geometry url='#box'>", "<instance_node url='#n0'/><instance_geometry url='#box'>")


def set_count(table):
    table["accessors"][0]["count"] = 10**12


def without_view(table):
    del table["accessors"][0]["bufferView"]
    table["accessors"][0]["count"] = 10**11


def set_loop(table):
    table["nodes"] = [{"children": [1]}, {"children": [0], "mesh": 0}]


def share_child(table):
    table["nodes"] = [{"children": [1, 1]}, {"children": [2, 2]}, {"mesh": 0}]


def add_nodes(table):
    table["nodes"] = [{"mesh": 0}] * 50_000
    table["scenes"] = [{"nodes": list(range(50_000))}]


def name_outside(table):
    table["buffers"][0]["uri"] = "../../../../etc/passwd"


NESTED = "<node>" * 5000 + "</node>" * 5000
HOSTILE = {
    "count.stl": (b"x" * 80 + b"\xff\xff\xff\x7f" + b"\0" * 500, "announces 2147483647 triangles"),
    "short.stl": (b"x" * 50, "a binary STL file has at least 84"),
    "solids.stl": (b"solid a\nfacet\nendsolid a\n" * 3000, "3000 solids, at most 2000"),
    "nan.stl": (b"x" * 80 + struct.pack("<I", 1) + struct.pack("<12f", *[np.nan] * 12) + b"\0\0", "not finite|no tri"),
    "count.ply": (b"ply\nformat ascii 1.0\nelement vertex 99999999999\nend_header\n", "announces 99999999999 rows"),
    "word.ply": (b"ply\nformat ascii 1.0\nelement vertex many\nend_header\n", "announces 'many' rows"),
    "count.glb": (change_table(set_count), "its array 0 has 1000000000000 rows"),
    "zeros.glb": (change_table(without_view), "its array 0 has 100000000000 rows, at most"),
    "loop.glb": (change_table(set_loop), "its nodes are a loop"),
    "shared.glb": (change_table(share_child), "a node has several parents"),
    "nodes.glb": (change_table(add_nodes), "50000 nodes, at most 2000"),
    "outside.glb": (change_table(name_outside), "its buffer is in another file"),
    "deep.glb": (b"glTF" + struct.pack("<IIII", 2, 200_020, 200_000, 0x4E4F534A) + b"[" * 200_000, "not valid JSON"),
    "list.glb": (b"glTF" + struct.pack("<IIII", 2, 24, 4, 0x4E4F534A) + b"[1] ", "its table is not a JSON object"),
    "entity.dae": ("<!DOCTYPE a [<!ENTITY b 'c'>]><COLLADA>&b;</COLLADA>", "must not have a DOCTYPE or entities"),
    "double.dae": (doubling_dae(40), "shapes in its scene, at most 2000"),
    "loop.dae": (doubling_dae(3).replace("url='#n3'", "url='#n0'"), "its nodes contain themselves"),
    "nested.dae": (BOX_DAE.replace("<node id='body'>", f"{NESTED}<node id='body'><instance_node url='#x'/>"),
                   "nested more than 100 levels"),
    "zip.dae": (b"PK\x03\x04" + b"\0" * 200, "a compressed archive"),
    "zip.obj": (b"\x1f\x8b" + b"\0" * 200, "a compressed archive"),
    "parts.obj": ("v 0 0 0\nv 1 0 0\nv 0 1 0\n" + "".join(f"usemtl m{k}\nf 1 2 3\n" for k in range(3000)),
                  "3000 materials, at most 2000"),
    "index.obj": ("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 99\n", "point|cannot be read"),
    "nan.obj": ("v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "not finite|cannot be read|no triangles"),
}  # fmt: skip


@pytest.mark.parametrize("name", HOSTILE)
def test_hostile_meshes_are_refused_in_a_sentence(tmp_path, name, recwarn):
    data, sentence = HOSTILE[name]
    path = tmp_path / name
    path.write_bytes(data if isinstance(data, bytes) else data.encode())
    with pytest.raises(InputError, match=sentence) as refusal:
        read_mesh(path, name, ONE)
    assert "\n" not in str(refusal.value)
    assert len(str(refusal.value)) < 300
    model = read_urdf(write_robot(tmp_path, name, data))
    assert any(name in warning for warning in model.warnings)
    assert model.links["a"].collisions


def compress(rows):
    return zlib.compress(b"\0" * rows, 9)


def bomb(width, height):
    """Return a small PNG file that unpacks to many pixels."""
    head = struct.pack(">IIBBBBB", width, height, 8, 0, 0, 0, 0)
    rows = compress(min((width + 1) * height, 100_000_000))
    chunks = [(b"IHDR", head), (b"IDAT", rows), (b"IEND", b"")]
    made = [
        struct.pack(">I", len(body)) + name + body + struct.pack(">I", zlib.crc32(name + body)) for name, body in chunks
    ]
    return b"\x89PNG\r\n\x1a\n" + b"".join(made)


TEXTURES = {
    "huge image": (bomb(9000, 9000), "81000000 pixels|has 9000 x 9000 pixels|is missing"),
    "larger than any memory": (bomb(100_000, 100_000), "colour is used"),
    "damaged image": (PNG[:60], "cannot be read"),
    "wrong checksum": (PNG[:45] + b"\xff" + PNG[46:], "cannot be read"),
    "script": (b"%!PS-Adobe-3.0 EPSF-3.0\n%%BoundingBox: 0 0 9 9\n(/etc/passwd) run", "colour is used"),
}


@pytest.mark.parametrize("name", TEXTURES)
def test_hostile_textures_are_left_out_in_a_sentence(tmp_path, name):
    data, sentence = TEXTURES[name]
    (tmp_path / "box.mtl").write_text(BOX_MTL)
    (tmp_path / "paint.png").write_bytes(data)
    model = read_urdf(write_robot(tmp_path, "box.obj", BOX_OBJ))
    shape = model.links["a"].visuals[0].shape
    assert not shape.textures
    assert len(shape.faces) == 12
    if name != "script" and name != "larger than any memory":
        assert any(re.search(sentence, warning) for warning in model.warnings), model.warnings
    assert mjcf(model).load().nmesh > 0


OUTSIDE = (
    "../secret.png",
    "/etc/hostname",
    "file:///etc/hostname",
    "..\\secret.png",
    "%2e%2e/secret.png",
    "a/../../secret.png",
)


@pytest.mark.parametrize("reference", OUTSIDE)
@pytest.mark.parametrize("kind", ["obj", "dae", "mtl"])
def test_textures_outside_the_folder_are_not_read(tmp_path, monkeypatch, reference, kind):
    folder = tmp_path / "robot"
    folder.mkdir()
    (tmp_path / "secret.png").write_bytes(png())
    opened = []
    whole = type(tmp_path).read_bytes
    monkeypatch.setattr(type(tmp_path), "read_bytes", lambda path: opened.append(path.resolve()) or whole(path))
    if kind == "dae":
        robot = write_robot(folder, "box.dae", BOX_DAE.replace("paint.png", reference))
    elif kind == "obj":
        robot = write_robot(folder, "box.obj", BOX_OBJ.replace("box.mtl", reference))
    else:
        (folder / "box.mtl").write_text(BOX_MTL.replace("paint.png", reference))
        robot = write_robot(folder, "box.obj", BOX_OBJ)
    model = read_urdf(robot)
    assert not model.links["a"].visuals[0].shape.textures
    assert all(path.is_relative_to(folder.resolve()) for path in opened)
    assert any("colour is used" in warning for warning in model.warnings)


def test_a_link_to_a_file_outside_is_not_followed(tmp_path):
    folder = tmp_path / "robot"
    folder.mkdir()
    (tmp_path / "secret.png").write_bytes(png())
    (folder / "paint.png").symlink_to(tmp_path / "secret.png")
    (folder / "box.mtl").write_text(BOX_MTL)
    model = read_urdf(write_robot(folder, "box.obj", BOX_OBJ))
    assert not model.links["a"].visuals[0].shape.textures
    assert "'paint.png' of the mesh box.obj is outside the folder of the robot" in model.warnings[0]


FILES = {
    "box.glb": box_glb(),
    "box.dae": BOX_DAE.encode(),
    "box.obj": BOX_OBJ.encode(),
    "box.mtl": BOX_MTL.encode(),
    "paint.png": PNG,
    "box.stl": bytes(trimesh.creation.box().export(file_type="stl")),
    "box.ply": bytes(trimesh.creation.box().export(file_type="ply")),
}
WORDS = (
    b"0",
    b"-1",
    b"99999999999",
    b"nan",
    b"1e999",
    b"<",
    b">",
    b"\0",
    b"../",
    b"\xff\xff\xff\xff",
    b"/etc/passwd",
    b"",
    b" ",
    b"f 1 2 3\n",
)


def damage(data, rng):
    """Return bytes with words inserted, bytes changed, parts doubled or removed."""
    data = bytearray(data)
    for _ in range(int(rng.integers(1, 8))):
        at = int(rng.integers(0, max(1, len(data))))
        kind = int(rng.integers(4))
        if kind == 0:
            data[at:at] = WORDS[int(rng.integers(len(WORDS)))]
        elif kind == 1 and data:
            data[min(at, len(data) - 1)] = int(rng.integers(256))
        elif kind == 2:
            data[at:at] = data[at : at + int(rng.integers(1, 40))]
        else:
            del data[at : at + int(rng.integers(1, 40))]
    return bytes(data)


@pytest.mark.parametrize(("count", "seed"), sample([(60, 3), *((2500, seed) for seed in range(4))], 1, rows=True))
def test_damaged_meshes_and_textures_are_refused_or_drawn(tmp_path, count, seed):
    rng = np.random.default_rng(seed)
    outcomes = {"refused": 0, "read": 0}
    names = list(FILES)
    for name, data in FILES.items():
        (tmp_path / name).write_bytes(data)
    for number in range(count):
        name = names[int(rng.integers(len(names)))]
        (tmp_path / name).write_bytes(damage(FILES[name], rng))
        mesh = "box.obj" if name in ("box.mtl", "paint.png") else name
        (tmp_path / "r.urdf").write_text(ROBOT.format(name=mesh))
        model = read_urdf(tmp_path / "r.urdf", colliders="hull")
        outcomes["refused" if any("cannot be used" in text for text in model.warnings) else "read"] += 1
        assert not any("Traceback" in text or "\n" in text for text in model.warnings)
        if number % 20 == 0:
            assert mjcf(model).load().nbody == 2
        (tmp_path / name).write_bytes(FILES[name])
    assert min(outcomes.values()) > 0
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted([*FILES, "r.urdf"])
