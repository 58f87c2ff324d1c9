"""Walks for the tests: paths of bodies, where the soles are in the world, and how fast they slip."""

import numpy as np

from crowdbot.humans import Gait, People
from crowdbot.humans.asset import shapes

WALKERS = ("man-38", "woman-36", "man-55", "woman-20", "boy-12", "mannequin")


def bone(name):
    return shapes().bone(name)


def soles(gait, posture):
    """Heel, ball and tip of the toes of both feet, ``[N, 2, 3, 3]``, from the posed foot bones."""
    m = gait.people.measures
    nothing = np.zeros(len(m.leg))
    feet = []
    for side in "lr":
        foot, ball = bone(f"foot_{side}"), bone(f"ball_{side}")
        heel = np.stack([m.heel, nothing, -m.ankle], 1)
        under = np.stack([nothing, nothing, -m.ball[:, 1]], 1)
        tip = np.stack([m.toe - m.ball[:, 0], nothing, -m.ball[:, 1]], 1)
        points = [(foot, heel), (ball, under), (ball, tip)]
        feet.append([posture.position[:, b] + np.einsum("nij,nj->ni", posture.rotation[:, b], p) for b, p in points])
    return np.array(feet).transpose(2, 0, 1, 3)


def walk(path, time, dt, people=WALKERS, seed=0, moving=False, activity="walk", level=2):
    """Walk along ``path(t) -> (x, y, heading)``, the same for everyone; returns states, postures and soles in time."""
    gait = Gait(People.of(list(people)), seed=seed)
    count = len(people)

    def at(t):
        x, y, heading = path(t)
        return np.tile([x, y], (count, 1)).astype(float), np.full(count, float(heading))

    place, heading = at(0.0)
    velocity = (at(dt)[0] - place) / dt
    state = gait.start(place, heading, velocity if moving else None, activity)
    states, postures, under = [state], [gait.posture(state)], []
    for k in range(1, round(time / dt) + 1):
        before = place
        place, heading = at(k * dt)
        state = gait.step(state, place, (place - before) / dt, heading, dt)
        states.append(state)
        postures.append(gait.posture(state))
        under.append(gait.people.skin(postures[-1], level)[..., 2].min())
    points = np.array([soles(gait, p) for p in postures])
    return gait, states, postures, points, np.array(under)


def slip(states, points, dt, floor=1e-3):
    """Fastest speed over the floor of the points of every planted sole that lie on it before and after, [m/s].

    The lowest point counts when none stays within ``floor`` [m]; nan while the foot is in the air.
    """
    planted = np.array([s.planted for s in states]) > 0
    both = planted[1:] & planted[:-1]
    speed = np.linalg.norm(np.diff(points[..., :2], axis=0), axis=-1) / dt
    high = np.maximum(points[1:, ..., 2], points[:-1, ..., 2])
    lowest = np.take_along_axis(speed, np.argmin(high, axis=-1)[..., None], -1)[..., 0]
    touching = np.where(high < floor, speed, -1.0).max(axis=-1)
    return np.where(both, np.where(touching >= 0.0, touching, lowest), np.nan)


def knees(postures, side="l"):
    """Bend of the knees [rad], ``[T, N]``."""
    place = np.array([p.position for p in postures])
    thigh = place[:, :, bone(f"calf_{side}")] - place[:, :, bone(f"thigh_{side}")]
    shank = place[:, :, bone(f"foot_{side}")] - place[:, :, bone(f"calf_{side}")]
    lengths = np.linalg.norm(thigh, axis=-1) * np.linalg.norm(shank, axis=-1)
    return np.arccos(np.clip((thigh * shank).sum(-1) / lengths, -1, 1))
