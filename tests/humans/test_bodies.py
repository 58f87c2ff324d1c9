"""Bodies: who there is, what they wear, what they weigh, and that capsules and skins agree."""

import importlib.resources

import numpy as np
import pytest
from scipy.spatial import cKDTree
from walks import walk

from crowdbot.core import InputError, UnknownName
from crowdbot.humans import (
    LIMBS,
    REGIONS,
    Gait,
    People,
    mass_shares,
    names,
    outfit,
    person,
    persons,
    posing_and_skinning,
)
from crowdbot.humans.asset import LEVELS, shapes
from crowdbot.humans.garments import drape
from crowdbot.humans.people import skin_vertices


def test_there_are_forty_adults_four_children_and_a_mannequin():
    everyone = persons()
    adults = [p for p in everyone if p.years >= 18]
    assert [sum(p.sex == s for p in adults) for s in "mf"] == [20, 20]
    assert sum(0 < p.years < 18 for p in everyone) == 4
    assert names()[-1] == "mannequin"
    assert len(set(names())) == len(everyone) == 45
    assert len({(p.height, p.mass) for p in adults}) == 40


def test_the_licence_ships_with_the_bodies():
    folder = importlib.resources.files("crowdbot").joinpath("assets", "humans")
    assert "CC0 1.0 Universal" in folder.joinpath("LICENSE").read_text(encoding="utf-8")
    assert "MakeHuman" in folder.joinpath("README.md").read_text(encoding="utf-8")


def test_everyone_has_at_least_ten_variations():
    for item in persons():
        assert len({outfit(item, k) for k in range(12)}) == 12
        if item.sex:
            assert len({outfit(item, k).top for k in range(10)}) == 10
            assert len({outfit(item, k).skin for k in range(12)}) == 1
    assert outfit(person("man-30"), 3) == outfit(person("man-30"), 3)


@pytest.mark.parametrize("level", range(LEVELS))
def test_meshes_are_sound(level):
    people = People.of(names(), variation=np.arange(45))
    faces, worn = people.faces(level), people.clothing_mask(level)
    vertices = shapes().levels[level].rest
    assert faces.min() >= 0
    assert faces.max() < vertices.shape[1]
    assert people.face_colors(level).shape == (45, len(faces), 3)
    assert people.vertex_colors(level).shape == (*vertices.shape[:2], 3)
    assert 0.0 <= people.face_colors(level).min() <= people.face_colors(level).max() <= 1.0
    assert worn.any(axis=1).all()
    assert vertices[..., 2].min() >= 0.0
    top = vertices[:, shapes().levels[level].vertex_part == 0, 2].max(axis=1)
    assert np.abs(top - people.height).max() < 0.03
    a, b, c = (vertices[0][faces[:, k]] for k in range(3))
    volume = (np.cross(a, b) * c).sum(axis=1)[worn[0]].sum() / 6.0  # the cut skin under the cloth leaves it open
    assert 0.03 < volume < 0.12


def test_the_three_levels_are_the_same_body():
    gait, states, postures, _, _ = walk(lambda t: (1.3 * t, 0.0, 0.0), 0.5, 0.05, moving=True)
    fine = gait.people.skin(postures[-1], 0)[0]
    for level in (1, 2):
        coarse = gait.people.skin(postures[-1], level)[0]
        away = cKDTree(fine).query(coarse)[0]
        assert np.mean(away) < 0.01
        assert away.max() < 0.06
    assert len(states) == 11


def _line(level, one, other):
    """Heights [m] on the mannequin of the vertices between two regions, in which parts may meet."""
    rest, faces = level.rest[-1], level.faces
    place = {k: {tuple(p) for p in rest[faces[level.face_region == shapes().regions.index(k)]].reshape(-1, 3).round(4)}
             for k in (one, other)}  # fmt: skip
    return np.array(sorted(place[one] & place[other]))[:, 2]


@pytest.mark.parametrize("level", range(LEVELS))
def test_hems_are_straight_and_clothes_have_no_gap(level):
    body = shapes().levels[level]
    for item, other, points in (("top", "bottom", 7), ("bottom", "shin", 6), ("shin", "shoes", 6)):
        line = _line(body, item, other)
        assert len(line) >= points
        assert np.ptp(line) < (0.006 if level == 0 else 0.015)


def test_soles_and_scalps_are_where_they_are_said_to_be():
    people = People.of(names())
    for body in shapes().levels:
        shoes = body.vertex_region == shapes().regions.index("shoes")
        assert np.abs(body.rest[:, shoes, 2].min(axis=1)).max() < 0.002
        scalp = body.vertex_region == shapes().regions.index("scalp")
        assert np.abs(body.rest[:, scalp, 2].max(axis=1) - people.height).max() < 0.006


def _outside(every, level):
    """Mean distance [m] by which the fine trousers lie outside the faces of a coarse level, on the mannequin."""
    fine, coarse = every.levels[0], every.levels[level]
    faces = coarse.faces[np.isin(coarse.face_part, (0, 1, 2))]
    legs = (fine.vertex_part == 2) & (fine.rest[-1, :, 2] > 0.15) & (fine.rest[-1, :, 2] < 0.7)
    a, b, c = (coarse.rest[-1][faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    points, middle = fine.rest[-1, legs], (a + b + c) / 3.0
    nearest = np.linalg.norm(points[:, None] - middle[None], axis=-1).argmin(axis=1)
    return ((points - middle[nearest]) * normal[nearest]).sum(axis=1).mean()


def test_coarse_limbs_are_as_thick_as_the_fine_ones():
    assert abs(_outside(shapes(), 2)) < 0.0025
    assert abs(_outside(shapes(), 1)) < 0.0015


def test_the_kernel_skins_as_numpy_does():
    gait, _, postures, _, _ = walk(lambda t: (1.3 * t, 0.0, 0.0), 0.5, 0.05, moving=True)
    people, level, now = gait.people, shapes().levels[1], postures[-1]
    cloth, size = drape(1), people.height / drape(1).height
    worn = cloth.shift[people.cuts[:, cloth.group], np.arange(len(cloth.group))]
    rest = level.rest[people.body] * people.scale[:, None, None] + worn * size[:, None, None]
    head = people.measures.head
    shift = now.position - np.einsum("nbij,nbj->nbi", now.rotation, head)
    expected = sum(
        level.weights[:, k, None]
        * (np.einsum("nvij,nvj->nvi", now.rotation[:, level.bones[:, k]], rest) + shift[:, level.bones[:, k]])
        for k in range(4)
    )
    found = skin_vertices(
        level, cloth, people.cuts, size, people.body, people.scale, head, now.rotation, now.position
    )  # fmt: skip
    np.testing.assert_allclose(found, expected, atol=1e-12)


def _gaps(people, posture):
    """Distance of every vertex of the finest skin, without hair and skirt, to the nearest capsule [m], signed."""
    limbs = people.limbs(posture)
    level = shapes().levels[0]
    plain = np.isin(level.vertex_part, [shapes().parts.index(p) for p in ("skin", "top", "legs")])
    points = people.skin(posture, 0)[:, plain]
    best = np.full(points.shape[:2], np.inf)
    for k in range(len(LIMBS)):
        start, axis = limbs.start[:, None, k], (limbs.end - limbs.start)[:, None, k]
        t = np.clip(((points - start) * axis).sum(-1) / (axis**2).sum(-1), 0.0, 1.0)
        best = np.minimum(
            best, np.linalg.norm(points - start - t[..., None] * axis, axis=-1) - limbs.radius[:, None, k]
        )
    return best


def test_capsules_fit_the_skins():
    people = People.of(names())
    gait = Gait(people)
    count = len(people)
    for activity, speed in (("walk", 0.0), ("walk", 1.4), ("phone", 1.0), ("sit", 0.0)):
        state = gait.start(np.zeros((count, 2)), np.zeros(count), np.tile([speed, 0.0], (count, 1)), activity)
        gaps = np.abs(_gaps(people, gait.posture(state)))
        assert gaps.mean(axis=1).max() < 0.02
        assert gaps.max() < 0.12
    limbs = gait.limbs(gait.start(np.zeros((count, 2)), np.zeros(count)))
    assert np.linalg.norm(limbs.end - limbs.start, axis=-1).max() < 0.45
    assert limbs.radius.min() > 0.025
    assert limbs.radius.max() < 0.2


def test_limbs_have_regions_and_masses():
    assert len(LIMBS) == 17
    assert {limb.region for limb in LIMBS} == set(REGIONS)
    for sex in ("m", "f", ""):
        assert mass_shares(sex).sum() == pytest.approx(1.0)
    people = People.of(["man-20", "man-20", "woman-20"], height=[1.6886, 2 * 1.6886 / 2, 1.5])
    np.testing.assert_allclose(people.limb_mass.sum(axis=1), people.mass)
    leg = sum(people.limb_mass[0, k] for k, limb in enumerate(LIMBS) if limb.name in ("thigh_l", "shank_l", "foot_l"))
    assert leg / people.mass[0] == pytest.approx(0.1986)  # de Leva 1996, men
    assert people.mass[2] == pytest.approx(person("woman-20").mass * (1.5 / person("woman-20").height) ** 3)


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: People.of(["man-20"], height=0.0), "height 0.0 m of a person must be from 0.5 to 2.5 m"),
        (lambda: People.of(["man-20"], height=np.nan), "height nan m"),
        (lambda: People.of(["man-20"], height=[1.0, 2.0]), r"height has shape \[2\]"),
        (lambda: People.of(["man-20"], variation=-1), "variation -1.0 must be a whole number, at least 0"),
        (lambda: People.of("man-20"), "takes a list of names"),
        (lambda: People.of(["man-20"]).faces(3), "level of detail 3 is not allowed, it must be from 0 to 2"),
        (lambda: People.sample(2, np.random.default_rng(0), kinds=["cat"]), "there is no person of the kinds cat"),
    ],
)
def test_wrong_input_is_named(call, message):
    with pytest.raises(InputError, match=message):
        call()


def test_an_unknown_person_is_named():
    with pytest.raises(UnknownName, match="unknown person 'women-36', did you mean 'woman-36'"):
        People.of(["women-36"])


def test_nobody_and_drawn_people_work():
    nobody = Gait(People.of([]))
    state = nobody.start(np.zeros((0, 2)), np.zeros(0))
    state = nobody.step(state, np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0), 0.1)
    assert nobody.skin(state).shape == (0, 447, 3)
    assert nobody.limbs(state).radius.shape == (0, 17)
    drawn = People.sample(30, np.random.default_rng(4), kinds=("man", "girl"))
    assert {p.sex for p in drawn.persons} == {"m", "f"}
    assert posing_and_skinning(5, 1)().shape == (5, 1243, 3)
