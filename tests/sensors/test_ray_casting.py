"""Rays against analytic scenes, against the slow obvious way, and against MuJoCo's own."""

import math

import mujoco
import numba
import numpy as np
import pytest
from crowds_in_space import brute_force, carried_away, crowd, somewhere
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import Bodies, InputError, Pose, Scene, Skins, SpatialPose, stream
from crowdbot.core.kernels import Kernel
from crowdbot.sensors import ray_casting, skin_casting
from crowdbot.sensors.beams import cone_directions, sort_beams, unit_vectors
from crowdbot.sensors.ray_casting import cast_rays

AHEAD = np.array([[1.0, 0.0, 0.0]])
FANS = {
    "level": lambda: unit_vectors(np.linspace(-math.pi, math.pi, 61, endpoint=False)),
    "rings": lambda: unit_vectors(
        np.linspace(-math.pi, math.pi, 24, endpoint=False), np.linspace(-1.5, 1.5, 7)[:, None]
    ).reshape(-1, 3),
    "camera": lambda: unit_vectors(np.linspace(-0.6, 0.6, 12), np.linspace(-0.4, 0.4, 9)[:, None]).reshape(-1, 3),
    "cone": lambda: cone_directions(0.8, 80),
    "all": lambda: cone_directions(math.pi, 150),
    "poles": lambda: np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0], [1.0, 0.0, 0.0]]),
}


@pytest.mark.parametrize("name", FANS)
@settings(max_examples=2, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_equals_every_beam_against_everything(name, seed):
    scene, pose, directions = crowd(seed, people=7, environments=2), somewhere(seed, 2), FANS[name]()
    hits = cast_rays(scene, pose, sort_beams(directions), 100.0)
    distance, hit = brute_force(scene, pose, directions)
    grazed = np.isinf(hits.distance) != np.isinf(distance)
    assert np.mean(grazed) < 0.002
    both = np.isfinite(distance) & ~grazed
    steep = hits.cos_incidence > 1e-3  # what is only grazed is ill-conditioned in the slow way
    np.testing.assert_allclose(hits.distance[both & steep], distance[both & steep], rtol=0, atol=1e-9)
    assert np.mean(hits.hit[~grazed] == hit[~grazed]) > 0.998


@settings(max_examples=60, deadline=None)
@given(st.floats(0.05, 0.4), st.floats(0.3, 60.0), st.floats(-0.99, 0.99), st.floats(-math.pi, math.pi))
def test_a_capsule_far_away_to_1e_9(radius, away, offset, turn):
    """The beam meets the side of an upright capsule at a known chord, from any heading, however far."""
    scene = Scene.of(
        [[0.0, 0.0]],
        bodies=Bodies.of(start=[[[0.0, 0.0, 0.0]]], end=[[[0.0, 0.0, 2.0]]], radius=[[radius]], owner=[0]),
    )
    middle = away + radius
    aside = offset * radius
    place = np.array(
        [-middle * math.cos(turn) + aside * math.sin(turn), -middle * math.sin(turn) - aside * math.cos(turn)]
    )
    hits = cast_rays(scene, SpatialPose.of((*place, 1.0), 0.0, 0.0, turn), sort_beams(AHEAD), 100.0)
    assert hits.distance[0, 0] == pytest.approx(middle - math.sqrt(radius**2 - aside**2), abs=1e-9)
    normal = np.append(place + hits.distance[0, 0] * np.array([math.cos(turn), math.sin(turn)]), 0.0) / radius
    np.testing.assert_allclose(hits.normal[0, 0], normal, atol=1e-7)


def test_a_capsule_along_the_beam():
    scene = Scene.of(
        [[0.0, 0.0]], bodies=Bodies.of(start=[[[3.0, 0.0, 1.0]]], end=[[[5.0, 0.0, 1.0]]], radius=[[0.25]], owner=[0])
    )
    for z, chord in ((1.0, 0.25), (1.2, 0.15)):
        hits = cast_rays(scene, SpatialPose.of((0.0, 0.0, z)), sort_beams(AHEAD), 10.0)
        assert hits.distance[0, 0] == pytest.approx(3.0 - chord, abs=1e-12)
    back = cast_rays(scene, SpatialPose.of((8.0, 0.0, 1.0), yaw=math.pi), sort_beams(AHEAD), 10.0)
    assert back.distance[0, 0] == pytest.approx(2.75, abs=1e-12)


def test_walls_floor_posts_and_boxes_by_hand():
    scene = Scene.of(
        [[0.0, 9.0]],
        radius=0.5,
        height=1.2,
        walls=[[(4.0, -50.0), (4.0, 50.0)]],
        wall_height=2.0,
        bodies=Bodies.of(
            box_centre=[[0.0, -3.0, 0.5]], box_half=[[0.5, 0.5, 0.5]], post_foot=[[-3.0, 0.0, 0.0]],
            post_radius=[0.25], post_height=[0.8],
        ),
    )  # fmt: skip
    down = math.radians(30.0)
    beam = unit_vectors(np.array([0.0, 0.5 * math.pi, math.pi, -0.5 * math.pi]))

    def met(z, pitch=0.0, yaw=0.0, directions=beam):
        return cast_rays(scene, SpatialPose.of((0.0, 0.0, z), 0.0, pitch, yaw), sort_beams(directions), 100.0)

    low = met(0.7)
    np.testing.assert_allclose(low.distance[0], [4.0, 8.5, 2.75, 2.5], rtol=0, atol=1e-12)
    assert low.hit[0].tolist() == [-2, 0, -4, -4]
    np.testing.assert_allclose(low.normal[0], [[-1, 0, 0], [0, -1, 0], [1, 0, 0], [0, 1, 0]], atol=1e-12)
    high = met(1.5)
    assert high.hit[0].tolist() == [-2, -1, -1, -1]
    assert np.isinf(met(2.1).distance).all()  # over the wall too
    floor = met(0.7, pitch=down, directions=AHEAD)
    assert floor.hit.tolist() == [[-3]]
    assert floor.distance[0, 0] == pytest.approx(0.7 / math.sin(down), abs=1e-12)
    assert floor.cos_incidence[0, 0] == pytest.approx(math.sin(down), abs=1e-12)
    lid = met(1.5, pitch=0.5 * math.pi - math.atan2(3.0, 0.7), yaw=math.pi, directions=AHEAD)
    assert lid.distance[0, 0] == pytest.approx(math.hypot(3.0, 0.7), abs=1e-9)
    np.testing.assert_allclose(lid.normal[0, 0], [0.0, 0.0, 1.0], atol=1e-12)
    top = met(1.5, pitch=0.5 * math.pi - math.atan2(3.0, 0.5), yaw=-0.5 * math.pi, directions=AHEAD)
    np.testing.assert_allclose(top.normal[0, 0], [0.0, 0.0, 1.0], atol=1e-12)
    assert top.distance[0, 0] == pytest.approx(math.hypot(3.0, 0.5), abs=1e-9)


def test_limbs_stand_for_the_agent_and_the_cylinder_for_who_has_none():
    limb = Bodies.of(
        start=[[2.0, 0.0, 0.1]], end=[[2.0, 0.0, 0.6]], radius=[0.1], owner=[0], part=[1], parts=("a", "leg")
    )
    scene = Scene.of([[2.0, 0.0], [4.0, 0.0]], radius=0.5, bodies=limb)
    low = cast_rays(scene, SpatialPose.of((0.0, 0.0, 0.3)), sort_beams(AHEAD), 10.0)
    high = cast_rays(scene, SpatialPose.of((0.0, 0.0, 1.0)), sort_beams(AHEAD), 10.0)
    assert (low.distance.tolist(), low.hit.tolist(), low.part.tolist()) == ([[1.9]], [[0]], [[1]])
    assert (high.distance.tolist(), high.hit.tolist(), high.part.tolist()) == ([[3.5]], [[1]], [[-1]])
    gone = cast_rays(scene.without(0), SpatialPose.of((0.0, 0.0, 0.3)), sort_beams(AHEAD), 10.0)
    assert gone.hit.tolist() == [[1]]


def test_from_inside_everything_is_at_no_distance():
    for bodies in (
        Bodies.of(start=[[0, 0, 0]], end=[[0, 0, 2]], radius=[0.3], owner=[0]),
        Bodies.of(box_centre=[[0, 0, 1]], box_half=[[0.3, 0.3, 0.3]]),
        Bodies.of(post_foot=[[0, 0, 0]], post_radius=[0.3], post_height=[2.0]),
    ):
        scene = Scene.of([[0.1, 0.0]], active=[True], bodies=bodies).replace(position=np.array([[[50.0, 0.0]]]))
        hits = cast_rays(scene, SpatialPose.of((0.1, 0.0, 1.0)), sort_beams(FANS["all"]()), 10.0)
        assert np.all(hits.distance == 0.0)
        assert np.all(hits.cos_incidence == pytest.approx(1.0))


def test_what_is_absent_or_not_a_number_is_not_seen():
    scene = crowd(3)
    start, radius = scene.bodies.start.copy(), scene.bodies.radius.copy()
    start[:, :8], radius[:, 8:16] = np.nan, 0.0
    start[:, 16] = np.inf
    start[:, 17] = -np.inf
    odd = Bodies(**{**vars(scene.bodies), "start": start, "radius": radius})
    keep = np.r_[18 : start.shape[1]]
    less = Bodies(**{**vars(scene.bodies), "start": scene.bodies.start[:, keep], "end": scene.bodies.end[:, keep],
                     "radius": radius[:, keep], "owner": odd.owner[keep], "part": odd.part[keep]})  # fmt: skip
    pose, directions = somewhere(3), FANS["all"]()
    absent = scene.without(0).without(1)
    one = cast_rays(absent.replace(bodies=odd), pose, sort_beams(directions), 50.0)
    two = cast_rays(absent.replace(bodies=less), pose, sort_beams(directions), 50.0)
    assert one.distance.tobytes() == two.distance.tobytes()
    nobody = Scene.of(np.zeros((2, 0, 2)))
    assert np.isinf(cast_rays(nobody, somewhere(1, 2), sort_beams(FANS["level"]()), 5.0).distance).mean() < 1.0
    lost = scene.replace(position=np.where(absent.active[..., None], scene.position, np.nan), active=absent.active)
    assert (
        cast_rays(lost.replace(bodies=odd), pose, sort_beams(directions), 50.0).distance.tobytes()
        == one.distance.tobytes()
    )


def test_turning_and_shifting_the_world_changes_nothing():
    scene, pose = crowd(11, environments=3), somewhere(11, 3)
    there, place = carried_away(scene, pose, 1.1, np.array([7.0, -3.0]))
    fan_ = sort_beams(FANS["all"]())
    one, two = cast_rays(scene, pose, fan_, 50.0), cast_rays(there, place, fan_, 50.0)
    same = np.isclose(one.distance, two.distance, rtol=0, atol=1e-8) | (one.distance == two.distance)
    assert np.mean(same) > 0.99
    assert np.mean(one.hit == two.hit) > 0.99


def test_batches_threads_and_repeats_give_the_same_bytes():
    scene, pose, fan_ = crowd(5, environments=6), somewhere(5, 6), sort_beams(FANS["all"]())
    most = numba.get_num_threads()
    results = []
    for count in (1, min(2, numba.config.NUMBA_NUM_THREADS)):
        numba.set_num_threads(count)
        results.append(cast_rays(scene, pose, fan_, 50.0))
    numba.set_num_threads(most)
    for e in range(6):
        place = SpatialPose(pose.position[e : e + 1], pose.rotation[e : e + 1])
        alone = cast_rays(scene.environments([e]), place, fan_, 50.0)
        for name in ("distance", "cos_incidence", "normal", "hit", "part"):
            assert getattr(alone, name)[0].tobytes() == getattr(results[0], name)[e].tobytes()
            assert getattr(results[1], name)[e].tobytes() == getattr(results[0], name)[e].tobytes()


def ball(centre, radius, rings=40):
    """A closed sphere of triangles."""
    import trimesh

    mesh = trimesh.creation.uv_sphere(radius=radius, count=[rings, rings])
    return mesh.vertices + centre, mesh.faces


def test_skins_are_met_as_every_triangle_would_be():
    scene, pose = crowd(7, people=5, props=False), somewhere(7)
    pieces = [ball((*scene.position[0, a], 0.9), 0.3, 8) for a in (0, 1, 2)]
    vertices = np.concatenate([v for v, _ in pieces])
    faces = np.concatenate([f + k * len(pieces[0][0]) for k, (_, f) in enumerate(pieces)])
    skins = Skins.of(vertices, faces, owner=np.repeat([0, 1, 2], len(pieces[0][1])))
    scene = scene.replace(bodies=Bodies(**{**vars(scene.bodies), "skins": skins}))
    directions = FANS["all"]()
    hits = cast_rays(scene, pose, sort_beams(directions), 50.0, skins=True)
    distance, hit = brute_force(scene, pose, directions, skins=True)
    same = np.isclose(hits.distance, distance, rtol=0, atol=1e-9) | (hits.distance == distance)
    assert np.mean(same) > 0.99
    assert np.mean(hits.hit == hit) > 0.99
    blind = cast_rays(scene, pose, sort_beams(directions), 50.0)
    assert not np.array_equal(blind.distance, hits.distance)


def test_no_beam_slips_through_the_edges_of_a_closed_skin():
    vertices, faces = ball((0.0, 0.0, 1.0), 1.0, 12)
    skins = Skins.of(vertices, faces, owner=-1)
    scene = Scene.of([[50.0, 0.0]], bodies=Bodies.of(skins=skins))
    pose = SpatialPose.of((0.0, 0.0, 1.0))
    out = vertices - np.array([0.0, 0.0, 1.0])
    edges = out[faces[:, 0]] + out[faces[:, 1]]
    directions = np.concatenate([cone_directions(math.pi, 3000), out, edges])
    directions /= np.linalg.norm(directions, axis=1, keepdims=True)
    hits = cast_rays(scene, pose, sort_beams(directions), 50.0, skins=True)
    assert np.all(hits.distance <= 1.0 + 1e-9)
    assert np.all(hits.hit == -4)


def test_scans_of_one_and_of_many_environments_with_any_labels_share_compiled_kernels():
    vertices, faces = ball((0.0, 0.0, 1.0), 1.0, 12)
    names = vars(ray_casting) | vars(skin_casting)
    kernels = [value for value in names.values() if isinstance(value, Kernel)]

    def compiled(environments, owner):
        skins = Skins.of(np.repeat(vertices[None], environments, axis=0), faces, owner=owner)
        scene = Scene.of(np.full((environments, 1, 2), 50.0), bodies=Bodies.of(skins=skins))
        pose = SpatialPose.of(np.tile([0.0, 0.0, 1.0], (environments, 1)))
        cast_rays(scene, pose, sort_beams(AHEAD), 5.0, skins=True)
        return {kernel.__name__: len(kernel.signatures) for kernel in kernels}

    first = compiled(1, -1)
    assert compiled(1, np.zeros(len(faces), dtype=int)) == first
    many = compiled(4, -1)
    assert {name for name, count in many.items() if count != first[name]} <= {"_shared"}  # the parallel loop itself


def test_skins_that_are_not_there_are_asked_for_in_vain():
    with pytest.raises(InputError, match="no triangle skins"):
        cast_rays(crowd(0), somewhere(0), sort_beams(AHEAD), 5.0, skins=True)


def model_of(scene, skin=None):
    """The same scene in MuJoCo: capsules as mocap bodies, walls as thin boxes."""
    spec = mujoco.MjSpec()
    spec.memory = 64 * 2**20
    world = spec.worldbody
    world.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0, 0, 1])
    for x, y, X, Y in scene.walls.segments():
        angle = math.atan2(Y - y, X - x)
        world.add_geom(
            type=mujoco.mjtGeom.mjGEOM_BOX, size=[0.5 * math.hypot(X - x, Y - y), 1e-9, 0.5 * scene.wall_height],
            pos=[0.5 * (x + X), 0.5 * (y + Y), 0.5 * scene.wall_height],
            quat=[math.cos(0.5 * angle), 0, 0, math.sin(0.5 * angle)],
        )  # fmt: skip
    b = scene.bodies
    for k in range(b.radius.shape[1]):
        if scene.active[0, b.owner[k]]:
            body = world.add_body(mocap=True)
            body.add_geom(
                type=mujoco.mjtGeom.mjGEOM_CAPSULE, fromto=[*b.start[0, k], *b.end[0, k]], size=[b.radius[0, k], 0, 0]
            )
    for k in range(b.box_half.shape[1]):
        world.add_geom(
            type=mujoco.mjtGeom.mjGEOM_BOX, size=b.box_half[0, k], pos=b.box_centre[0, k], quat=b.box_turn[0, k]
        )
    posts = [(b.post_foot[0, k], b.post_radius[0, k], b.post_height[0, k]) for k in range(b.post_radius.shape[1])]
    bare = set(range(scene.shape[1])) - set(b.owner.tolist())
    posts += [
        (np.append(scene.position[0, a], 0.0), scene.radius[0, a], scene.height[0, a])
        for a in bare
        if scene.active[0, a]
    ]
    for foot, radius, height in posts:
        world.add_geom(
            type=mujoco.mjtGeom.mjGEOM_CYLINDER, size=[radius, 0.5 * height, 0], pos=foot + [0, 0, 0.5 * height]
        )
    if skin is not None:
        mesh = spec.add_mesh(name="skin", uservert=skin[0].ravel(), userface=skin[1].ravel())
        mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL
        world.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname="skin")
    model = spec.compile()
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return model, data


def mujoco_cast(model, data, pose, directions):
    world = np.ascontiguousarray(directions @ pose.matrix[0].T)
    count = len(world)
    who, distance, normal = np.zeros(count, np.int32), np.zeros(count), np.zeros(3 * count)
    mujoco.mj_multiRay(model, data, pose.position[0], world.ravel(), None, 1, -1, who, distance, normal, count, 1e9)
    return np.where(who < 0, np.inf, distance), normal.reshape(-1, 3)


@pytest.mark.parametrize("seed", range(6))
@pytest.mark.parametrize("name", ["level", "rings", "all"])
def test_equals_mujoco(seed, name):
    scene, directions = crowd(seed, people=14), FANS[name]()
    pose = somewhere(seed + 100)
    hits = cast_rays(scene, pose, sort_beams(directions), 1e3)
    if np.any(hits.distance == 0.0):  # from inside MuJoCo looks for the way out
        pose = somewhere(seed + 200, height=(2.2, 2.5))
        hits = cast_rays(scene, pose, sort_beams(directions), 1e3)
    distance, normal = mujoco_cast(*model_of(scene), pose, directions)
    grazed = np.isinf(distance) != np.isinf(hits.distance[0])
    assert np.mean(grazed) <= 0.01
    both = np.isfinite(distance) & np.isfinite(hits.distance[0]) & (hits.cos_incidence[0] > 0.05)
    np.testing.assert_allclose(hits.distance[0][both], distance[both], rtol=0, atol=1e-6)
    np.testing.assert_allclose(hits.normal[0][both], normal[both], rtol=0, atol=1e-5)


def test_skins_equal_mujocos_meshes():
    vertices, faces = ball((0.0, 0.0, 1.0), 0.5, 16)
    vertices = np.asarray(vertices * [1.0, 0.6, 1.4], dtype=np.float32).astype(float)
    scene = crowd(2, people=2, embodied=0, props=False)
    scene = scene.replace(active=np.zeros((1, 2), dtype=bool))
    model, data = model_of(scene, (vertices, faces))
    skins = Skins.of(vertices, faces, owner=-1)
    scene = scene.replace(bodies=Bodies.of(skins=skins))
    pose, directions = SpatialPose.of((1.6, 0.4, 1.2), 0.3, 0.1, 3.0), FANS["camera"]()
    hits = cast_rays(scene, pose, sort_beams(directions), 1e3, skins=True)
    distance, _ = mujoco_cast(model, data, pose, directions)
    on = hits.hit[0] == -4
    assert on.sum() > 20
    steep = on & (hits.cos_incidence[0] > 0.05)
    np.testing.assert_allclose(hits.distance[0][steep], distance[steep], rtol=0, atol=1e-6)  # MuJoCo keeps float32


def test_poses_in_space_compose():
    rng = stream(0, "poses")
    pose = SpatialPose.of(rng.normal(size=(3, 3)), *rng.uniform(-3.0, 3.0, (3, 3)))
    part = pose.offset(0.3, -0.2, 0.5, 0.1, 0.7, -1.0)
    inner = SpatialPose.of((0.3, -0.2, 0.5), 0.1, 0.7, -1.0)
    np.testing.assert_allclose(part.matrix, pose.matrix @ inner.matrix, atol=1e-14)
    np.testing.assert_allclose(part.position, pose.position + pose.matrix @ np.array([0.3, -0.2, 0.5]), atol=1e-14)
    np.testing.assert_allclose(
        pose.matrix @ np.moveaxis(pose.matrix, 1, 2), np.broadcast_to(np.eye(3), (3, 3, 3)), atol=1e-14
    )
    level = Pose.of([[1.0, 2.0]], 0.4).to_spatial(0.7)
    assert level.planar.heading == pytest.approx(0.4)
    np.testing.assert_allclose(SpatialPose.of((0, 0, 0), pitch=0.3).matrix[0, :, 0], [math.cos(0.3), 0, -math.sin(0.3)])
