"""Bodies of rigged characters, against the included body that they were made of, and hostile files."""

import copy
import io
import json
import zipfile

import numpy as np
import pytest
from characters import INT, character, character_table, glb

from crowdbot.core import InputError, UnknownName
from crowdbot.humans import (
    KEYPOINTS,
    Gait,
    People,
    RiggedBody,
    import_body,
    keypoint_places,
    person,
    read_body,
    shapes,
    write_body,
)

MADE_OF = "woman-36"
SCHEMES = ("mixamo", "biped")


@pytest.fixture(scope="module")
def bodies(tmp_path_factory):
    """Return a body of each naming scheme, made of the same included body."""
    folder = tmp_path_factory.mktemp("bodies")
    return {item: import_body(character(folder, f"{item}.glb", scheme=item), f"{item}.body").body for item in SCHEMES}


def pair(body):
    """Return people: the included body, and the imported one."""
    return People.of([MADE_OF, body.name], own=[body])


@pytest.mark.parametrize("scheme", SCHEMES)
def test_a_character_has_the_bones_and_the_stature_of_the_body_that_it_was_made_of(bodies, scheme):
    """The directions of its limbs are those of the mean adult, therefore some joints of the arms are elsewhere."""
    body = bodies[scheme]
    away = np.linalg.norm(body.head - shapes().head[person(MADE_OF).index], axis=1)
    assert away.max() < 0.02
    assert away[: shapes().bone("upperarm_l")].max() < 0.003
    assert body.height == pytest.approx(person(MADE_OF).height + 0.009, abs=0.012)  # with the scalp
    assert body.levels[0].rest[:, 2].min() == pytest.approx(0.0, abs=1e-6)


def test_both_naming_schemes_and_units_give_the_same_body(bodies):
    one, other = (bodies[scheme] for scheme in SCHEMES)
    np.testing.assert_allclose(one.head, other.head, atol=1e-4)
    np.testing.assert_allclose(one.levels[0].rest, other.levels[0].rest, atol=2e-4)


@pytest.mark.parametrize("scheme", SCHEMES)
def test_an_imported_body_walks_like_the_included_one(bodies, scheme):
    people = pair(bodies[scheme])
    gait = Gait(people, seed=1, ids=[0, 0])
    way = np.array([[1.3, 0.0], [1.3, 0.0]])
    state = gait.start(np.zeros((2, 2)), np.zeros(2), way)
    for k in range(60):
        state = gait.step(state, way * 0.02 * (k + 1), way, np.zeros(2), 0.02)
        limbs = gait.limbs(state)
        assert np.abs(limbs.start[0] - limbs.start[1]).max() < 0.06
        soles = gait.skin(state, 0)[1, people.mesh(0).vertex_span(0), 2]
        assert -0.025 < soles.min() < 0.03


@pytest.mark.parametrize("activity", ["sit", "wave", "carry", "phone", "run"])
def test_an_imported_body_takes_part_in_activities(bodies, activity):
    people = pair(bodies["mixamo"])
    gait = Gait(people, seed=1, ids=[0, 0])
    speed = np.array([[2.5 if activity == "run" else 0.0, 0.0]] * 2)
    state = gait.start(np.zeros((2, 2)), np.zeros(2), speed, activity)
    for k in range(80):
        state = gait.step(state, speed * 0.02 * (k + 1), speed, np.zeros(2), 0.02)
    wrists = gait.posture(state).position[:, [shapes().bone("hand_l"), shapes().bone("hand_r")]]
    assert np.linalg.norm(wrists[0] - wrists[1], axis=1).max() < 0.08


def test_the_skin_of_an_imported_body_has_its_own_part_of_the_vertices(bodies):
    people = pair(bodies["biped"])
    gait = Gait(people)
    state = gait.start([[0.0, 0.0], [5.0, 0.0]], [0.0, 0.0])
    for level in (0, 1, 2):
        skin, worn, faces = gait.skin(state, level), people.clothing_mask(level), people.faces(level)
        own = skin[1][np.unique(faces[worn[1]])]
        other = skin[0][np.unique(faces[worn[0]])]
        assert own[:, 0].min() > 4.0
        assert own[:, 0].max() < 6.0
        assert other[:, 0].max() < 1.0
        assert np.ptp(own[:, 2]) == pytest.approx(bodies["biped"].height, abs=0.04)
        colors = people.face_colors(level)[1, worn[1]]
        assert set(np.argmax(colors, axis=1).tolist()) == {0, 2}  # red and blue, as in the texture
        assert people.vertex_colors(level).shape == skin.shape


def test_keypoints_capsules_and_mass_are_scaled_to_the_body(tmp_path):
    tall = import_body(character(tmp_path), "tall.body", height=2.0).body
    assert tall.height == pytest.approx(2.0)
    mean = person("mannequin")
    assert tall.mass == pytest.approx(mean.mass * (2.0 / mean.height) ** 2)
    people = pair(tall)
    gait = Gait(people)
    posture = gait.posture(gait.start(np.zeros((2, 2)), np.zeros(2)))
    points, ratio = keypoint_places(people, posture), 2.0 / person(MADE_OF).height
    assert points.shape == (2, len(KEYPOINTS), 3)
    assert points[1, :5, 2].mean() == pytest.approx(ratio * points[0, :5, 2].mean(), rel=0.02)
    radius = people.limbs(posture).radius
    np.testing.assert_allclose(radius[1], ratio * radius[0], rtol=0.2)
    assert people.limb_mass[1].sum() == pytest.approx(tall.mass)
    assert import_body(character(tmp_path), "heavy.body", mass=90.0).body.mass == 90.0


def test_bones_that_a_skeleton_lacks_have_the_place_of_the_mean_adult(tmp_path):
    lacking = ("spine_02", "spine_03", "clavicle_l", "clavicle_r", "ball_l", "ball_r", "fingers_02_l", "thumb_r")
    found = import_body(character(tmp_path, without=lacking), "few.body")
    assert found.missing == tuple(bone for bone in shapes().bones if bone in lacking)
    away = np.linalg.norm(found.body.head - shapes().head[person(MADE_OF).index], axis=1)
    assert away.max() < 0.06


def test_a_body_survives_its_file(bodies, tmp_path):
    body = bodies["mixamo"]
    file = tmp_path / "mixamo.body"
    file.write_bytes(write_body(body))
    again = read_body(file)
    np.testing.assert_array_equal(again.picture, body.picture)
    np.testing.assert_allclose(again.levels[2].rest, body.levels[2].rest, atol=1e-6)
    np.testing.assert_allclose(again.levels[0].uv, body.levels[0].uv, atol=1e-4)
    assert (again.name, again.height) == (body.name, pytest.approx(body.height, abs=1e-5))
    assert file.read_bytes() == write_body(body)  # the same bytes each time


def test_a_dense_mesh_has_coarser_levels_of_detail(tmp_path):
    body = import_body(character(tmp_path, level=0), "dense.body").body
    counts = [len(level.faces) for level in body.levels]
    assert counts[0] > 5000
    assert 1000 < counts[1] <= 3000
    assert 300 < counts[2] <= 900
    for level in body.levels:
        main = level.bones[:, 0]
        assert {shapes().bones[k] for k in np.unique(main)} >= {"head", "calf_l", "lowerarm_r", "foot_r"}


def test_only_given_names_are_bodies(bodies):
    with pytest.raises(UnknownName, match=r"ann.body"):
        People.of(["ann.body"], own=[bodies["mixamo"]])


def changed(change):
    """Return the table and the data of a character after a change."""
    table, data = character_table()
    table = copy.deepcopy(table)
    result = change(table, data)
    return glb(table, result if isinstance(result, bytes) else data)


def rename(table, old, new):
    for node in table["nodes"]:
        node["name"] = node["name"].replace(old, new)


def set_pose(table, name, rotation):
    """Turn a node by a quaternion x, y, z, w."""
    node = next(node for node in table["nodes"] if node["name"].endswith(name))
    matrix = np.array(node.pop("matrix")).reshape(4, 4).T
    node["translation"] = matrix[:3, 3].tolist()
    node["rotation"] = rotation


CLEAR = {"baseColorFactor": [1.0, 1.0, 1.0, 0.0]}


def picture_at(address):
    def change(table, data):
        table["images"] = [{"uri": address}]

    return change


@pytest.mark.parametrize(
    ("change", "message"),
    [
        (lambda t, d: t.pop("skins"), r"ann.glb has no skinned mesh; export the character with its skeleton"),
        (lambda t, d: rename(t, "LeftForeArm", "Wing"), r"ann.glb has no joint for lowerarm_l; its joints are mixamo"),
        (lambda t, d: t["nodes"][-1].update(scale=[1.0] * 3), r"the character is 1\d\d\.?\d* m tall, .*--height"),
        (lambda t, d: t["nodes"][-1].update(scale=["a"] * 3), r"ann.glb: scale of a node must be 3 numbers"),
        (lambda t, d: t["nodes"][-1].update(scale=[1e9] * 3), r"scale of a node must be 3 numbers of at most 1e6"),
        (lambda t, d: t["nodes"][-1].update(rotation=[0.3827, 0, 0, 0.9239]), r"does not stand upright; save it"),
        (lambda t, d: set_pose(t, "LeftUpLeg", [0, 0, 0.7071, 0.7071]), r"the legs are not straight; save it"),
        (picture_at("../secret.png"), r"ann.glb refers to '../secret.png', which lies outside its folder"),
        (picture_at("/etc/hostname"), r"ann.glb refers to '/etc/hostname', which lies outside its folder"),
        (picture_at("https://example.org/a.png"), r"only files in its folder are read"),
        (picture_at("file:///etc/hostname"), r"only files in its folder are read"),
        (picture_at("skin.png"), r"refers to 'skin.png', and there is no such file in its folder"),
        (picture_at("data:image/png;base64,AAAA"), r"ann.glb: image 0 cannot be read: UnidentifiedImageError"),
        (lambda t, d: t.update(extensionsRequired=["KHR_draco_mesh_compression"]), r"needs the extension 'KHR_draco"),
        (lambda t, d: t["accessors"][0].update(count=10**9), r"its array 0 has 1000000000 rows"),
        (lambda t, d: t["accessors"][0].update(sparse={}), r"array 0 is sparse"),
        (lambda t, d: t["accessors"][0].update(type="VEC2"), r"array 0 has the shape \[4740, 2\]; expected \[N, 3\]"),
        (lambda t, d: t["skins"][0].update(joints=[0, 1]), r"has no joint for head"),
        (lambda t, d: t["skins"][0].update(joints=["a"]), r"joints of a skin must be a list of whole numbers"),
        (lambda t, d: t["meshes"][0]["primitives"][0].update(mode=5), r"triangle strips and fans are not supported"),
        (lambda t, d: t["meshes"][0]["primitives"][0]["attributes"].pop("JOINTS_0"), r"no JOINTS_0 and WEIGHTS_0"),
        (lambda t, d: t["meshes"][0]["primitives"][0]["attributes"].pop("POSITION"), r"a primitive has no POSITION"),
        (lambda t, d: t["materials"][0]["pbrMetallicRoughness"].update(baseColorFactor=[2, 0, 0, 1]), r"baseColorFac"),
        (lambda t, d: t["materials"][0].update(alphaMode="BLEND", pbrMetallicRoughness=CLEAR), r"triangles are transp"),
        (lambda t, d: t["nodes"][0].update(children=[0]), r"ann.glb: .*"),
    ],
)  # fmt: skip
def test_a_wrong_character_is_refused_in_a_sentence(tmp_path, change, message):
    (tmp_path / "sub").mkdir()
    (tmp_path / "secret.png").write_bytes(b"secret")
    file = tmp_path / "sub" / "ann.glb"
    file.write_bytes(changed(change))
    with pytest.raises(InputError, match=message) as caught:
        import_body(file, "ann.body")
    assert "\n" not in str(caught.value)


def test_a_gltf_file_takes_its_data_and_its_picture_from_its_folder(tmp_path):
    table, data = character_table()
    view = table["bufferViews"][table["images"][0]["bufferView"]]
    (tmp_path / "skin.png").write_bytes(data[view["byteOffset"] : view["byteOffset"] + view["byteLength"]])
    (tmp_path / "ann data.bin").write_bytes(data)
    table["buffers"][0]["uri"], table["images"] = "ann%20data.bin", [{"uri": "skin.png"}]
    file = tmp_path / "ann.gltf"
    file.write_text(json.dumps(table), encoding="utf-8")
    body = import_body(file, "ann.body").body
    assert set(np.argmax(body.face_colors(0), axis=1).tolist()) == {0, 2}


def test_a_point_that_names_no_joint_is_refused(tmp_path):
    def change(table, data):
        skin = table["skins"][0]
        skin["joints"] = skin["joints"][:27]  # the toes of the right foot have no joint

    file = tmp_path / "ann.glb"
    file.write_bytes(changed(change))
    with pytest.raises(InputError, match=r"a point names joint 27 of the 27 joints of its skin"):
        import_body(file, "ann.body")


def test_a_triangle_beyond_the_points_is_refused(tmp_path):
    def change(table, data):
        one = table["accessors"][table["meshes"][0]["primitives"][0]["indices"]]
        assert one["componentType"] == INT
        first = table["bufferViews"][one["bufferView"]]["byteOffset"]
        return data[:first] + b"\xff\xff\xff\x7f" + data[first + 4 :]

    file = tmp_path / "ann.glb"
    file.write_bytes(changed(change))
    with pytest.raises(InputError, match=r"a triangle names point 2147483647 of 4740"):
        import_body(file, "ann.body")


@pytest.mark.parametrize(
    ("data", "message"),
    [
        (b"", r"no body file|no body"),
        (b"PK\x03\x04" + b"x" * 50, r"x.body is no body file"),
        (None, r"cannot read the body .*x.body: No such file.*crowdbot new body FILE.glb writes one"),
    ],
)
def test_a_file_that_is_no_body_is_refused(tmp_path, data, message):
    file = tmp_path / "x.body"
    if data is not None:
        file.write_bytes(data)
    with pytest.raises(InputError, match=message):
        read_body(file)


def repacked(body, **changes):
    """Return the file of a body with changed arrays."""
    with np.load(io.BytesIO(write_body(body))) as file:
        arrays = {key: file[key] for key in file.files}
    out = io.BytesIO()
    np.savez(out, **(arrays | changes))
    return out.getvalue()


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"faces0": np.full((2, 3), 10**6)}, r"uv has the shape"),
        ({"faces2": None}, r"faces must be from 0 to"),
        ({"bones1": None}, r"bones must be from 0 to 27"),
        ({"head": np.full((28, 3), np.nan)}, r"bones must be 28 points within 4 m"),
        ({"picture": np.zeros(9, np.uint8)}, r"the picture cannot be read"),
        ({"about": np.frombuffer(b'{"format": "other"}', np.uint8)}, r"has the format 'other'"),
        ({"about": np.frombuffer(b"[" * 9, np.uint8)}, r"x.body is no body: JSONDecodeError"),
        ({"rest0": np.array([{}], dtype=object)}, r"x.body is no body file: Object arrays cannot be loaded"),
    ],
)
def test_a_changed_body_is_refused_in_a_sentence(bodies, tmp_path, changes, message):
    body = bodies["mixamo"]
    full = {"faces2": np.full(body.levels[2].faces.shape, 10**6), "bones1": np.full(body.levels[1].bones.shape, 99)}
    file = tmp_path / "x.body"
    file.write_bytes(repacked(body, **{key: full[key] if value is None else value for key, value in changes.items()}))
    with pytest.raises(InputError, match=message):
        read_body(file)


def test_a_file_that_unpacks_to_too_much_is_refused_before_it_is_unpacked(tmp_path):
    file = tmp_path / "x.body"
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("rest0.npy", b"\0" * 300_000_000)
    with pytest.raises(InputError, match=r"x.body holds 300000000 bytes in 1 parts, which is too much"):
        read_body(file)


def test_a_stature_is_that_of_a_person(bodies):
    body = bodies["mixamo"]
    with pytest.raises(InputError, match=r"x.body: height = 3 must be from 0.5 to 2.5"):
        RiggedBody("x.body", 3.0, body.mass, body.head, body.tail, body.levels, body.picture)


@pytest.mark.parametrize("seed", range(30))
def test_a_damaged_character_is_read_or_refused_in_a_sentence(tmp_path, seed):
    rng = np.random.default_rng(seed)
    data = bytearray(glb(*character_table(level=2)))
    table = 20 + int.from_bytes(data[12:16], "little")
    for place in rng.integers(20, table if seed % 3 else len(data), size=1 + seed % 4):
        data[place] = int(rng.choice([*b'0123456789-[]{},"e', rng.integers(256)]))
    file = tmp_path / "ann.glb"
    file.write_bytes(bytes(data))
    sentence = ""
    try:
        found = import_body(file, "ann.body").body.levels[0].rest
    except InputError as error:
        sentence, found = str(error), np.zeros(3)
    assert "\n" not in sentence
    assert len(sentence) < 600
    assert np.all(np.isfinite(found))
