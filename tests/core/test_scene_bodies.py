"""Bodies: shapes of arrays, and what scenes do with them."""

import numpy as np
import pytest

from crowdbot.core import STAGE, Bodies, InputError, Scene, Skins

LIMBS = {"start": [[0, 0, 0.1], [4, 0, 0.1]], "end": [[0, 0, 1.5], [4, 0, 1.5]], "radius": [0.1, 0.2], "owner": [0, 1]}


def _pair(**changes):
    return Scene.of([[0.0, 0.0], [4.0, 0.0]], **{"bodies": Bodies.of(**LIMBS), **changes})


def test_one_environment_needs_no_axis_and_the_rest_is_empty():
    bodies = Bodies.of(**LIMBS, parts=("leg",), part=0)
    assert (bodies.start.shape, bodies.radius.shape, bodies.batch) == ((1, 2, 3), (1, 2), 1)
    assert (bodies.box_half.shape, bodies.post_foot.shape) == ((1, 0, 3), (1, 0, 3))
    assert bodies.part.tolist() == [0, 0]
    assert Bodies.of(start=[[1, 2, 3]], end=[[1, 2, 4]], radius=[0.1]).owner.tolist() == [STAGE]


def test_what_is_the_same_in_all_environments_may_be_given_once():
    bodies = Bodies.of(**LIMBS, box_centre=np.zeros((3, 1, 3)), box_half=[[1.0, 1.0, 1.0]])
    assert bodies.batch == 3
    assert bodies.start.shape == (3, 2, 3)
    assert bodies.box_turn[2, 0].tolist() == [1.0, 0.0, 0.0, 0.0]


def test_environments_are_taken_with_their_bodies():
    scene = Scene.of(np.zeros((3, 2, 2)), bodies=Bodies.of(**{**LIMBS, "radius": [[0.1, 0.2], [0.3, 0.4], [0.5, 0.6]]}))
    assert scene.environments([2, 0]).bodies.radius.tolist() == [[0.5, 0.6], [0.1, 0.2]]
    with pytest.raises(InputError, match="bodies of 1 environments for 3 environments"):
        Scene.of(np.zeros((3, 2, 2)), bodies=Bodies.of(**LIMBS))


def test_the_digest_tells_moved_limbs_but_not_those_of_the_absent():
    plain, scene = Scene.of([[0.0, 0.0], [4.0, 0.0]]), _pair()
    assert plain.digest() == Scene.of([[0.0, 0.0], [4.0, 0.0]]).digest() != scene.digest()
    moved = scene.replace(bodies=Bodies.of(**{**LIMBS, "radius": [0.1, 0.3]}))
    assert moved.digest() != scene.digest()
    assert moved.without(1).digest() == scene.without(1).digest() != scene.digest()
    skins = Skins.of([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]], owner=1)
    other = Skins.of([[0, 0, 0], [2, 0, 0], [0, 1, 0]], [[0, 1, 2]], owner=1)
    one, two = (_pair(bodies=Bodies.of(**LIMBS, skins=s)) for s in (skins, other))
    assert one.digest() != two.digest()
    assert one.without(1).digest() == two.without(1).digest()


def test_after_a_step_only_the_stage_keeps_its_bodies():
    bodies = Bodies.of(
        **{**LIMBS, "owner": [0, STAGE]},
        post_foot=[[1, 1, 0]],
        post_radius=[0.2],
        post_height=[1.0],
        post_owner=[1],
        skins=Skins.of([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2], [2, 1, 0]], owner=[1, STAGE]),
    )
    later = _pair(bodies=bodies).advance(np.ones((1, 2, 2)), 0.1)
    assert later.bodies.owner.tolist() == [STAGE]
    assert later.bodies.post_foot.shape == (1, 0, 3)
    assert later.bodies.skins.faces.tolist() == [[2, 1, 0]]
    assert Bodies.of(**LIMBS, skins=Skins.of(np.eye(3), [[0, 1, 2]], owner=0)).stage_bodies().skins is None
    assert Scene.of([[0.0, 0.0]]).advance(np.zeros((1, 1, 2)), 0.1).bodies is None


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"legs": 3}, "there is no field 'legs'"),
        ({"start": [[0, 0, 0]]}, "end is missing for 1 shapes"),
        ({**LIMBS, "radius": [0.1, 0.2, 0.3]}, "must fit"),
        ({**LIMBS, "owner": [0]}, "owner has shape \\[1\\], it must be one for each of 2"),
        ({**LIMBS, "owner": [0, -2]}, "owner -2 is below -1"),
        ({"start": np.zeros((2, 1, 3)), "end": np.zeros((3, 1, 3)), "radius": [0.1]}, "for \\[2, 3\\] environments"),
    ],
)
def test_wrong_bodies_are_explained(values, message):
    with pytest.raises(InputError, match=message):
        Bodies.of(**values)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        (([[0, 0]], [[0, 0, 0]], 0), "vertices have shape \\[1, 2\\]"),
        ((np.zeros((3, 3)), [[0, 1, 3]], 0), "a face refers to vertex 3, but there are 3 vertices"),
        ((np.zeros((3, 3)), [[0, 1, 2]], [0, 1]), "skins: owner has shape \\[2\\]"),
    ],
)
def test_wrong_skins_are_explained(values, message):
    with pytest.raises(InputError, match=message):
        Skins.of(*values)


def test_heights_must_be_above_0():
    with pytest.raises(InputError, match="height 0.0 m is not above 0"):
        Scene.of([[0.0, 0.0]], height=0.0)
    with pytest.raises(InputError, match="wall_height -1.0 m is not above 0"):
        Scene.of([[0.0, 0.0]], wall_height=-1.0)
    assert Scene.of([[0.0, 0.0], [1.0, 0.0]], height=[1.0, np.nan], active=[True, False]).height[0, 0] == 1.0
