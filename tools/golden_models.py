"""Reference steps of the crowd models, so that a changed model is noticed without recordings or other engines.

``python tools/golden_models.py`` writes ``tests/models/golden/steps.npz``. Write it again only when a model is changed
on purpose, and say so in the commit.
"""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np

from crowdbot import models
from crowdbot.core import Scene, builtin_classes, parameters, stream
from crowdbot.models import ORCA, VOG, CostModel, CrowdModel, Mixture, SocialForce, costs

FILE = Path(__file__).parents[1] / "tests/models/golden/steps.npz"
DT = 0.1
STEPS = 4
"""The first velocities are kept, and those of the fourth step, which also follow from what models remember."""
VARIANTS = {
    "boids": ("crowdbot",),
    "escape-panic": ("crowdbot",),
    "group-force": ("pysocialforce",),
    "headed-social-force": ("jhsfm",),
    "social-force": ("umans2018",),
    "vbm": ("crowdbot",),
}
ROOM = [(-5.0, -5.0), (-5.0, 5.0), (5.0, 5.0), (5.0, -5.0)]  # clockwise: people are inside
PILLAR = [(0.5, 0.0), (1.5, 0.5), (1.0, 1.5), (0.0, 1.0)]
SCREEN = [(-3.0, -2.0), (-1.5, -3.5)]


def room() -> Scene:
    """Return three crowds of 24 in a room: groups, a robot, somebody invisible, somebody absent, various sizes."""
    rng, shape = stream(0, "room"), (3, 24)
    place = rng.uniform(-4.7, 4.7, (*shape, 2))
    group = np.broadcast_to(np.repeat(np.arange(12), 2) - 4, shape)
    flags = np.arange(24)
    return Scene.of(
        place,
        rng.normal(0.0, 0.7, (*shape, 2)),
        radius=rng.uniform(0.15, 0.3, shape),
        goal=rng.uniform(-4.5, 4.5, (*shape, 2)),
        preferred_speed=rng.uniform(0.6, 1.7, shape),
        max_speed=rng.uniform(1.7, 2.2, shape),
        group=np.maximum(group, -1),
        external=np.broadcast_to(flags == 5, shape),
        visible=np.broadcast_to(flags != 7, shape),
        active=np.broadcast_to(flags != 11, shape),
        walls=[ROOM, PILLAR, SCREEN],
    )


def crossing() -> Scene:
    """Return two streams of 15 that cross, dense enough for contacts, without walls and with desired velocities."""
    rng = stream(0, "crossing")
    first = np.stack([rng.uniform(-4.0, 0.5, 15), rng.uniform(-1.0, 1.0, 15)], axis=-1)
    second = np.stack([rng.uniform(-1.0, 1.0, 15), rng.uniform(-4.0, 0.5, 15)], axis=-1)
    wish = np.repeat([[1.3, 0.0], [0.0, 1.1]], 15, axis=0)
    place = np.concatenate([first, second])
    return Scene.of(place, wish + rng.normal(0.0, 0.2, (30, 2)), radius=0.25, preferred_velocity=wish, max_speed=1.8)


SCENES = {"room": room, "crossing": crossing}


def drawn(model: CrowdModel, shape: tuple[int, int], name: str) -> CrowdModel:
    """Return the model with parameters of each agent, uniformly at random in their boxes."""
    rng = stream(0, name)
    values = {row.name: rng.uniform(row.low, row.high, shape) for row in parameters(type(model))}
    return dataclasses.replace(model, **values)


def composed(count: int) -> dict[str, CrowdModel]:
    """Return cost models that use every cost and every optimiser, and a mixture."""
    wish, small = costs.PreferredVelocity(), {"speeds": 4, "angles": 12}
    return {
        "cost-force": CostModel(costs.GoalForce() + costs.PowerLawForce(), relaxation_time=0.5),
        "cost-model-force": CostModel(costs.ModelForce(SocialForce()) + 0.2 * costs.Inertia()),
        "cost-energy": CostModel(wish + 2.0 * costs.PowerLawEnergy(), refinements=3, **small),
        "cost-obstacles": CostModel(wish + costs.ReciprocalObstacles(), samples="umans", **small),
        "cost-effort": CostModel(costs.Effort() + 0.1 * costs.NoiseTerm(), samples="random", **small),
        "cost-distance": CostModel(costs.CollisionDistance(), samples="umans", relaxation_time=0.5, **small),
        "cost-free-way": CostModel(costs.FreeWay(), contact_stiffness=62.5, max_acceleration=5.0, **small),
        "cost-range": CostModel(costs.AdmissibleRange(), **small),
        "cost-passing": CostModel(costs.PassingTimes(), samples="umans", **small),
        "cost-flow": CostModel(costs.GoalForce() + 3.0 * costs.FocusOfExpansion(), max_acceleration=5.0),
        "mixture": Mixture((ORCA(), SocialForce(), VOG()), which=np.arange(count) % 3),
    }


def cases(shape: tuple[int, int]) -> dict[str, CrowdModel]:
    """Return every built-in model and variant by name, with default parameters and with drawn ones."""
    found: dict[str, CrowdModel] = {}
    for name, kind in builtin_classes(models, CrowdModel).items():
        if kind is Mixture:
            continue
        for variant in (None, *VARIANTS.get(name, ())):
            title = name if variant is None else f"{name}-{variant}"
            found[title] = kind() if variant is None else kind(variant=variant)  # type: ignore[call-arg]
            found[f"{title}-drawn"] = drawn(found[title], shape, title)
    return found | composed(shape[1])


def steps(scene_name: str, name: str) -> np.ndarray:
    """Return the velocities ``[2, E, A, 2]`` [m/s] of the first and of the fourth step of a model in a scene."""
    scene, velocity = SCENES[scene_name](), []
    model = cases(scene.shape)[name]
    for step in range(STEPS):
        scene = model.step(scene, DT, stream(step, "golden", name))
        velocity.append(scene.velocity)
    return np.stack([velocity[0], velocity[-1]])


def compute() -> dict[str, np.ndarray]:
    """Return all steps by ``scene.model``."""
    return {f"{scene}.{name}": steps(scene, name) for scene in SCENES for name in cases(SCENES[scene]().shape)}


def main() -> None:
    """Write the file."""
    FILE.parent.mkdir(parents=True, exist_ok=True)
    np.savez_compressed(FILE, **compute())
    print(f"{FILE}: {FILE.stat().st_size} bytes")


if __name__ == "__main__":
    main()
