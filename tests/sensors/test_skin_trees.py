"""Rays at skins through trees of boxes: the same bytes as if every triangle were tested on its own."""

import math

import numba
import numpy as np
import pytest

from crowdbot.core import Bodies, Scene, Skins, SpatialPose, stream
from crowdbot.humans import Gait, People
from crowdbot.sensors import Lidar3D
from crowdbot.sensors.beams import cone_directions, sort_beams, unit_vectors
from crowdbot.sensors.ray_casting import cast_rays
from crowdbot.sensors.skin_casting import SkinCasting, skin_casting

FIELDS = ("distance", "cos_incidence", "normal", "hit", "part")
CUBE = np.array([[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)])
SIDES = [
    [0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1],
    [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4], [1, 5, 7], [1, 7, 3],
]  # fmt: skip


def dressed(people, level, seed=0, side=8.0):
    """People in random places who stand, as skins."""
    random = stream(seed, "skins")
    place, who = random.uniform(0.0, side, (people, 2)), People.sample(people, random)
    gait = Gait(who, seed)
    points = gait.skin(gait.start(place, random.uniform(-3.0, 3.0, people), np.zeros((people, 2))), level=level)
    worn, count = who.clothing_mask(level), points.shape[1]
    faces = [who.faces(level)[own] + k * count for k, own in enumerate(worn)]
    faces = np.concatenate(faces) if people else np.zeros((0, 3))
    skins = Skins.of(points.reshape(1, -1, 3), faces, np.repeat(np.arange(people), worn.sum(axis=1).astype(int)))
    return Scene.of(place, bodies=Bodies.of(skins=skins), walls=[[(-1, -1), (-1, 9), (9, 9), (9, -1)]])


def alone(vertices, faces, owner=-1):
    return Scene.of([[500.0, 0.0]], bodies=Bodies.of(skins=Skins.of(vertices, faces, owner=owner)))


def both_ways(scene, pose, directions, limit=30.0):
    """Nearest triangles through the trees and one by one: distance, index and number of hits."""
    beams, skins = sort_beams(directions), scene.bodies.skins
    result = []
    for each in (False, True):
        reach, which = np.full(len(directions), np.inf), np.full(len(directions), -1)
        place, turn = pose.position[0], np.ascontiguousarray(pose.matrix[0])
        arguments = (skins.vertices[0], scene.active[0], place, turn, limit, beams, reach, which)
        skin_casting(skins).cast(*arguments, each=each)
        height = place[2]
        if height > 0.0:  # triangles behind the floor are not looked for
            fall = (np.stack([beams.x, beams.y, beams.z], axis=-1) @ turn.T)[:, 2]
            with np.errstate(divide="ignore"):
                hidden = (fall < 0.0) & (reach > height / -fall)
            reach[hidden], which[hidden] = np.inf, -1
        result.append((reach, which))
    return result


def assert_same(scene, pose, directions, limit=30.0):
    tree, each = both_ways(scene, pose, directions, limit)
    assert tree[0].tobytes() == each[0].tobytes()
    assert tree[1].tobytes() == each[1].tobytes()
    return int(np.sum(tree[1] >= 0))


@pytest.mark.parametrize("level", [1, 2])
@pytest.mark.parametrize("seed", range(4))
def test_people_are_met_as_every_triangle_would_be(level, seed):
    scene, random = dressed(12, level, seed), stream(seed, "poses")
    pose = SpatialPose.of((*random.uniform(0.0, 8.0, 2), random.uniform(0.1, 2.5)), *random.uniform(-3.0, 3.0, 3))
    rings = unit_vectors(np.linspace(-math.pi, math.pi, 300), np.linspace(-0.4, 0.4, 12)[:, None]).reshape(-1, 3)
    assert assert_same(scene, pose, rings) > 10
    assert assert_same(scene, pose, cone_directions(math.pi, 3000), 3.0) >= 0
    assert assert_same(scene, pose, unit_vectors(np.linspace(-1.0, 1.0, 81)), 6.0) >= 0


@pytest.mark.parametrize("seed", range(5))
def test_beams_through_corners_and_edges_and_along_faces(seed):
    """A cube, whole and turned: its planes, edges and corners are where rounding decides."""
    random = stream(seed, "cube")
    turned = SpatialPose.of((0.0, 0.0, 0.0), *random.uniform(-3.0, 3.0, 3)) if seed else SpatialPose.of((0, 0, 0))
    vertices = CUBE @ turned.matrix[0].T + [0.0, 0.0, 5.0]
    scene = alone(np.concatenate([vertices, vertices]), np.concatenate([SIDES, np.add(SIDES, 8)]))
    for place in ([3.0, 0.0, 0.0], [3.0, 1.0, 0.0], [3.0, 1.0, 1.0], [3.0, 3.0, 1.0], [0.2, 0.1, 0.3], [1.0, 0.0, 0.0]):
        origin = turned.matrix[0] @ np.array(place) + [0.0, 0.0, 5.0]
        pose = SpatialPose.of(tuple(origin), *random.uniform(-3.0, 3.0, 3))
        edges = 0.5 * (vertices[:, None] + vertices[None]).reshape(-1, 3)
        grid = np.concatenate([vertices, edges, *(s * vertices + (1.0 - s) * vertices[::-1] for s in (0.3, -0.7, 2.0))])
        out = (grid - origin) @ pose.matrix[0]
        out = out[np.linalg.norm(out, axis=1) > 1e-9]
        directions = out / np.linalg.norm(out, axis=1, keepdims=True)
        nearby = directions + 1e-15 * random.normal(size=directions.shape)
        directions = np.concatenate([directions, nearby, np.eye(3), -np.eye(3)])
        directions /= np.linalg.norm(directions, axis=1, keepdims=True)
        assert assert_same(scene, pose, directions) > 10


def test_triangles_without_area_and_not_finite_ones():
    random = stream(0, "odd")
    corners = random.uniform(-3.0, 3.0, (200, 3, 3)) + [0.0, 0.0, 4.0]
    corners[:20, 2] = corners[:20, 1]
    corners[20:40] = corners[20:40, :1]
    corners[40:60, 2] = 0.3 * corners[40:60, 0] + 0.7 * corners[40:60, 1]
    corners[60:80] = corners[60:80, :1] + 1e-9 * random.normal(size=(20, 3, 3))
    corners[80:90, 1, 2] = np.nan
    corners[90:100, 0, 0] = np.inf
    corners[100:120] = corners[80:100] + 0.0
    corners[120:130] *= 1e-8
    corners[130:140] *= 1e6
    scene = alone(corners.reshape(-1, 3), np.arange(600).reshape(-1, 3))
    for seed in range(5):
        pose = SpatialPose.of((0.1 * seed, 0.0, 4.0), *stream(seed, "odd pose").uniform(-3.0, 3.0, 3))
        whole = corners[np.isfinite(corners).all(axis=(1, 2))].reshape(-1, 3)
        out = (whole - pose.position[0]) @ pose.matrix[0]
        directions = np.concatenate([cone_directions(math.pi, 2000), out / np.linalg.norm(out, axis=1, keepdims=True)])
        assert assert_same(scene, pose, directions) > 1000


def test_the_first_of_equal_triangles_is_met():
    vertices = np.array([[2.0, -1.0, 0.0], [2.0, 1.0, 0.0], [2.0, 0.0, 2.0]])
    scene = alone(np.tile(vertices, (30, 1)), np.random.default_rng(0).permutation(30)[:, None] * 3 + [0, 1, 2])
    (reach, which), _ = both_ways(scene, SpatialPose.of((0.0, 0.0, 1.0)), np.array([[1.0, 0.0, 0.0]]))
    assert (reach.tolist(), which.tolist()) == ([2.0], [0])


def test_people_who_are_gone_or_out_of_range_are_not_met():
    scene, pose = dressed(6, 2), SpatialPose.of((4.0, 4.0, 1.0))
    fan_ = sort_beams(unit_vectors(np.linspace(-math.pi, math.pi, 720)))
    seen = set(cast_rays(scene, pose, fan_, 20.0, skins=True).hit.ravel().tolist()) - {-1, -2, -3}
    assert len(seen) >= 4
    gone = scene.replace(active=np.arange(6)[None] != min(seen))
    assert min(seen) not in cast_rays(gone, pose, fan_, 20.0, skins=True).hit
    far = cast_rays(scene, SpatialPose.of((400.0, 4.0, 1.0)), fan_, 20.0, skins=True)
    assert np.all(far.hit == -1)
    assert np.all(cast_rays(dressed(0, 2), pose, fan_, 20.0, skins=True).hit == -2)


def test_a_person_who_comes_later_and_moves_is_met():
    """The tree is sorted when the vertices of a person are first known, and its boxes follow them."""
    scene = dressed(3, 2, seed=5)
    skins, pose, directions = scene.bodies.skins, SpatialPose.of((4.0, 4.0, 1.0)), cone_directions(math.pi, 2000)
    count = skins.vertices.shape[1] // 3
    points = skins.vertices.copy()
    points[:, :count] = np.nan
    for shift in (None, 0.0, 0.5, 3.0):
        if shift is not None:
            points = skins.vertices + [shift, 0.0, 0.0]
            points[:, ::7] += 0.2 * shift
        moved = Skins(points, skins.faces, skins.owner, skins.part)
        hits = assert_same(scene.replace(bodies=Bodies.of(skins=moved)), pose, directions)
        assert hits > 5
        ready = skin_casting(moved).tree.ready.tolist()
        assert ready == [shift is not None, True, True]


def test_trees_are_kept_for_the_same_triangles_only():
    skins = dressed(2, 2).bodies.skins
    same = Skins(skins.vertices + 1.0, skins.faces.copy(), skins.owner.copy(), skins.part)
    other = Skins(skins.vertices, skins.faces[:, ::-1].copy(), skins.owner, skins.part)
    assert skin_casting(skins) is skin_casting(same)
    assert skin_casting(skins) is not skin_casting(other)
    tree = SkinCasting(skins).tree
    assert sorted(tree.order.tolist()) == list(range(len(skins.faces)))
    assert np.array_equal(skins.owner[tree.order], np.repeat(tree.person, np.diff(tree.begin)))


def test_environments_and_threads_give_the_same_bytes():
    scene, random = dressed(8, 2), stream(1, "batch")
    skins = scene.bodies.skins
    points = np.concatenate([skins.vertices + [0.3 * e, 0.0, 0.0] for e in range(5)])
    many = Scene.of(
        np.repeat(scene.position, 5, axis=0),
        bodies=Bodies.of(skins=Skins(points, skins.faces, skins.owner, skins.part)),
        walls=scene.walls,
    )
    pose = SpatialPose.of(random.uniform(2.0, 6.0, (5, 3)), *random.uniform(-0.3, 0.3, (3, 5)))
    fan_, most, results = sort_beams(cone_directions(math.pi, 1500)), numba.get_num_threads(), []
    for count in (1, min(2, numba.config.NUMBA_NUM_THREADS)):
        numba.set_num_threads(count)
        results.append(cast_rays(many, pose, fan_, 30.0, skins=True))
    numba.set_num_threads(most)
    for e in range(5):
        place = SpatialPose(pose.position[e : e + 1], pose.rotation[e : e + 1])
        single = cast_rays(many.environments([e]), place, fan_, 30.0, skins=True)
        for name in FIELDS:
            assert getattr(single, name)[0].tobytes() == getattr(results[0], name)[e].tobytes()
            assert getattr(results[1], name)[e].tobytes() == getattr(results[0], name)[e].tobytes()


def test_a_scanner_sees_skins_of_the_stage_as_props():
    scene = alone(CUBE + [4.0, 0.0, 1.0], SIDES)
    cloud = Lidar3D(columns=180, skins=True).read(scene, SpatialPose.of((0.0, 0.0, 1.0)))
    assert set(np.unique(cloud.hit)) == {-4, -3, -1}
    assert np.min(cloud.ranges[cloud.hit == -4]) == pytest.approx(3.0, abs=0.01)
