"""Reference engines for the speed of crowd models: JuPedSim, and a plain NumPy implementation."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from crowdbot.core import Scene, import_optional
from crowdbot.typing import Floats

JUPEDSIM = ("SocialForceModel", "CollisionFreeSpeedModelV2", "AnticipationVelocityModel")
"""Timed models of JuPedSim; the first was the fastest at 10 000 people."""


def jupedsim_step(model: str, scene: Scene) -> Callable[[], object]:
    """Return a function that makes one step of JuPedSim with the people of environment 0 in an empty square.

    Everyone has direct steering to a point 100 m ahead, the least work for JuPedSim.

    Raises:
        MissingExtra: jupedsim is not installed.
    """
    jps = import_optional("jupedsim", "the comparison with JuPedSim", "bench")
    place = scene.position[0]
    low, high = place.min() - 200.0, place.max() + 200.0
    square = [(low, low), (high, low), (high, high), (low, high)]
    simulation = jps.Simulation(model=getattr(jps, model)(), geometry=square)
    stage = simulation.add_direct_steering_stage()
    journey = simulation.add_journey(jps.JourneyDescription([stage]))
    parameters = getattr(jps, f"{model}AgentParameters")
    for point, velocity in zip(place, scene.velocity[0], strict=True):
        agent = parameters(position=tuple(point), journey_id=journey, stage_id=stage)
        number = simulation.add_agent(agent)
        simulation.agent(number).target = tuple(point + velocity / np.hypot(*velocity) * 100.0)
    return simulation.iterate  # type: ignore[no-any-return]


def power_law_in_numpy(scene: Scene, reach: float = 5.0) -> Floats:
    """Return the accelerations ``[A, 2]`` [m/s2] of Karamouzas et al. 2014 in environment 0, all pairs at once.

    A direct implementation without kernel and neighbor search.
    """
    strength, exponent, decay = 1.5, 2.0, 3.0
    x, v, r = scene.position[0], scene.velocity[0], scene.radius[0]
    away, closing = x[:, None] - x, v[:, None] - v
    a = (closing**2).sum(axis=-1)
    b = -(away * closing).sum(axis=-1)
    distance2 = (away**2).sum(axis=-1)
    c = distance2 - (r[:, None] + r) ** 2
    root = b * b - a * c
    with np.errstate(all="ignore"):
        time = (b - np.sqrt(root)) / a
        acts = (c > 0.0) & (root > 0.0) & (a > 0.0) & (time > 0.0) & (distance2 < reach**2)
        size = strength * np.exp(-time / decay) / (a * time**exponent) * (exponent / time + 1.0 / decay)
        push = closing - (a[..., None] * away + b[..., None] * closing) / np.sqrt(root)[..., None]
        force = np.where(acts[..., None], -size[..., None] * push, 0.0)
    goal = (scene.desired_velocity(0.1)[0] - v) / 0.54
    return np.asarray(goal + force.sum(axis=1))
