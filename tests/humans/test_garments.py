"""Clothes that hang off the body."""

import numpy as np
import pytest

from crowdbot.humans import LEVELS, Gait, People, names, outfit, person, shapes

ADULTS = [name for name in names() if name.startswith(("man-", "woman-"))]


def variation(name, **worn):
    """The first outfit of a person with these clothes."""
    return next(k for k in range(100) if all(getattr(outfit(person(name), k), a) == b for a, b in worn.items()))


def standing(bodies, level=0, height=None, **worn):
    """Skins of people who stand, in these clothes, and the vertices of regions at that level."""
    people = People.of(bodies, [variation(name, **worn) for name in bodies], height)
    gait = Gait(people)
    place = np.zeros((len(bodies), 2))
    return gait.skin(gait.start(place, np.zeros(len(bodies))), level), shapes().levels[level]


def of(mesh, *regions):
    return np.isin(mesh.vertex_region, [shapes().regions.index(name) for name in regions])


def width(skin, chosen, low, high):
    """Width [m] from side to side of the left leg of each person between two heights."""
    here = chosen[None] & (skin[..., 2] > low) & (skin[..., 2] < high) & (skin[..., 1] > 0.0)
    return np.where(here, skin[..., 1], -np.inf).max(axis=1) - np.where(here, skin[..., 1], np.inf).min(axis=1)


def test_long_trousers_hang_wide_over_the_ankle_and_shorts_leave_it_bare():
    long, mesh = standing(ADULTS, legs="long")
    short, _ = standing(ADULTS, legs="short")
    shin = of(mesh, "shin")
    trousers, bare = width(long, shin, 0.12, 0.2), width(short, shin, 0.12, 0.2)
    assert trousers.min() > 0.11
    assert trousers.max() < 0.19
    assert np.median(trousers) > np.median(bare) + 0.04
    thigh = of(mesh, "bottom")
    assert np.median(width(short, thigh, 0.5, 0.6)) > np.median(width(short, shin, 0.4, 0.48)) + 0.03


@pytest.mark.parametrize("level", [0, 1])
def test_hems_of_trousers_cover_the_shoes(level):
    skin, mesh = standing(["man-32", "woman-36", "boy-08"], level, legs="long")
    hem = np.where(of(mesh, "shin")[None], skin[..., 2], np.inf).min(axis=1)
    shoes = np.where(of(mesh, "shoes")[None], skin[..., 2], -np.inf).max(axis=1)
    assert np.all(hem < shoes - 0.01)
    assert np.all(hem > 0.03)


@pytest.mark.parametrize("level", range(LEVELS))
def test_cloth_stays_outside_of_the_limbs_and_moves_no_skin(level):
    loose, mesh = standing(["man-44"], level, legs="long", sleeves="long")
    short, _ = standing(["man-44"], level, legs="short", sleeves="short")
    moved = np.linalg.norm(loose - short, axis=-1)[0]
    skin = of(mesh, "skin", "scalp", "eyes", "hair", "shoes")
    assert moved[skin].max() == 0.0
    assert moved[of(mesh, "top")].max() == 0.0
    assert moved[of(mesh, "forearm")].max() > 0.003
    middle = [loose[0, of(mesh, "shin") & (side * loose[0, :, 1] > 0.0), :2].mean(axis=0) for side in (1, -1)]
    far = [np.linalg.norm(p - min(middle, key=lambda m: np.linalg.norm(p - m))) for p in loose[0, of(mesh, "shin"), :2]]
    assert 0.03 < np.median(far) < 0.12


def test_a_shirt_hangs_from_the_chest_over_the_waist():
    skin, mesh = standing(ADULTS, legs="long")
    scale = np.array([person(name).height for name in ADULTS]) / 1.7
    top = of(mesh, "top")[None]

    def girth(low, high):
        here = top & (skin[..., 2] > low * scale[:, None]) & (skin[..., 2] < high * scale[:, None])
        return np.where(here, skin[..., 0], -np.inf).max(axis=1) - np.where(here, skin[..., 0], np.inf).min(axis=1)

    assert np.all(girth(1.0, 1.1) > 0.8 * girth(1.15, 1.25))


def test_cloth_grows_with_the_stature():
    tall, mesh = standing(["man-32"], height=2.0, legs="long")
    small, _ = standing(["man-32"], height=1.0, legs="long")
    shin = of(mesh, "shin")
    assert width(tall, shin, 0.12, 0.24) == pytest.approx(2.0 * width(small, shin, 0.06, 0.12), rel=2e-3)


def test_the_mannequin_and_legs_below_a_skirt_are_tight():
    people = People.of(["mannequin", "woman-36"], [0, variation("woman-36", legs="skirt", sleeves="none")])
    assert people.cuts.tolist() == [[0, 0, 0], [1, 0, 0]]
