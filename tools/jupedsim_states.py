"""Steps of JuPedSim from random states, against which the tests hold our versions of its models.

``python tools/jupedsim_states.py`` writes ``tests/models/golden/jupedsim_states.npz``; it needs the package jupedsim.
For each model, 25 rooms with 40 people each: states, and positions after each of some steps.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import jupedsim as jps
import numpy as np
import shapely

FILE = Path(__file__).parents[1] / "tests/models/golden/jupedsim_states.npz"
ROOM = [(-6.0, -6.0), (6.0, -6.0), (6.0, 6.0), (-6.0, 6.0)]
PILLAR = [(0.5, 0.0), (1.5, 0.5), (1.0, 1.5), (0.0, 1.0)]
ROOMS, PEOPLE, DT = 25, 40, 0.01
RADIUS, GAP = 0.2, 1.0
CORNER = 0.25
"""Distance [m] from the pillar, within which the engine leads people around its corners."""
STEPS = {
    "CollisionFreeSpeedModelV2": 1,
    "CollisionFreeSpeedModelV3": 4,
    "GeneralizedCentrifugalForceModel": 1,
    "WarpDriverModel": 1,
    "AnticipationVelocityModel": 1,
}
"""Models, and number of steps: more than one if a model remembers the last one."""
WARM_UP = {"AnticipationVelocityModel": 30}
"""Earlier steps of models that know no velocity or direction of people at the start; then the states are kept too."""


def states(rng: np.random.Generator) -> dict[str, np.ndarray]:
    """Return people at random places of the room, apart from each other, with goals that they see."""
    area = shapely.Polygon(ROOM, [PILLAR])
    free, clear = area.buffer(-0.3), area.buffer(-CORNER)
    found: dict[str, list[Any]] = {name: [] for name in ("position", "goal", "heading", "velocity", "preferred_speed")}
    while len(found["position"]) < PEOPLE:
        place, goal = rng.uniform(-5.7, 5.7, (2, 2))
        ray = shapely.LineString([place, goal])
        near = min((np.hypot(*(place - other)) for other in found["position"]), default=np.inf)
        if near < GAP or not free.contains(shapely.Point(place)) or not clear.contains(ray) or ray.length < 1.0:
            continue
        wish, turn = rng.uniform(0.6, 1.6), rng.uniform(-np.pi, np.pi)
        speed = rng.uniform(0.0, wish)
        found["position"].append(place)
        found["goal"].append(goal)
        found["heading"].append(turn)
        found["velocity"].append((speed * np.cos(turn), speed * np.sin(turn)))
        found["preferred_speed"].append(wish)
    return {name: np.array(value) for name, value in found.items()}


def steps(model: str, people: dict[str, np.ndarray], count: int) -> dict[str, np.ndarray]:
    """Return the positions ``[count, A, 2]`` after each step of a model, and the states after the warm-up, if any."""
    options = {"rng_seed": 1} if model == "AnticipationVelocityModel" else {}
    area = shapely.Polygon(ROOM, [PILLAR])
    simulation = jps.Simulation(model=getattr(jps, model)(**options), geometry=area, dt=DT)
    stage = simulation.add_direct_steering_stage()
    journey = simulation.add_journey(jps.JourneyDescription([stage]))
    numbers, speeds = [], []
    for k in range(PEOPLE):
        place, goal, turn = people["position"][k], people["goal"][k], people["heading"][k]
        more: dict[str, Any] = {"radius": RADIUS}
        ahead = (float(np.cos(turn)), float(np.sin(turn)))
        if model == "WarpDriverModel":
            more["orientation"] = ahead
        if model == "GeneralizedCentrifugalForceModel":
            wanted = (goal - place) / np.hypot(*(goal - place))
            speed = float(np.hypot(*people["velocity"][k]))
            # set below: while people are added, the engine rejects ellipses that overlap
            more = {"orientation": ahead, "desired_direction": tuple(wanted)}
        kind = getattr(jps, f"{model}AgentParameters")
        wish = float(people["preferred_speed"][k])
        agent = kind(position=tuple(place), journey_id=journey, stage_id=stage, desired_speed=wish, **more)
        numbers.append(simulation.add_agent(agent))
        simulation.agent(numbers[-1]).target = tuple(goal)
        if model == "GeneralizedCentrifugalForceModel":
            speeds.append(speed)
    for number, speed in zip(numbers, speeds, strict=False):
        simulation.agent(number).model.speed = speed

    def places() -> np.ndarray:
        return np.array([simulation.agent(number).position for number in numbers])

    found: dict[str, np.ndarray] = {}
    if model in WARM_UP:
        simulation.iterate(WARM_UP[model] - 1)
        before = places()
        simulation.iterate()
        ahead = np.array([simulation.agent(number).orientation for number in numbers])
        found |= {f"{model}.position": places(), f"{model}.velocity": (places() - before) / DT}
        found[f"{model}.heading"] = np.arctan2(ahead[:, 1], ahead[:, 0])
        # the engine leads the others around a corner of the pillar first
        rays = [shapely.LineString(pair) for pair in zip(places(), people["goal"], strict=True)]
        found[f"{model}.sees_goal"] = shapely.distance(shapely.Polygon(PILLAR), rays) > CORNER
    after = np.empty((count, PEOPLE, 2))
    for step in range(count):
        simulation.iterate()
        after[step] = places()
    return found | {model: after}


def main() -> None:
    """Write the file."""
    rng = np.random.default_rng(0)
    people = [states(rng) for _ in range(ROOMS)]
    arrays = {name: np.stack([person[name] for person in people]) for name in people[0]}
    for model, count in STEPS.items():
        found = [steps(model, person, count) for person in people]
        arrays |= {name: np.stack([one[name] for one in found]) for name in found[0]}
    np.savez_compressed(FILE, **arrays)
    print(f"{FILE}: {FILE.stat().st_size} bytes")


if __name__ == "__main__":
    main()
