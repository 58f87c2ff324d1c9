"""Nobody crosses a wall in a step: every model, any speed, step and direction, in both worlds, batches and pushes."""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.typing import NDArray
from PIL import Image

from crowdbot.catalogue import builtin_names
from crowdbot.core import Scene, Walls
from crowdbot.models import SocialForce
from crowdbot.simulation import PushOrder, Simulation
from crowdbot.trials import Trial, load_trial, parse_trial
from crowdbot.world import ContactModel, PlanarWorld

MODELS = sorted(set(builtin_names("models")["models"]) - {"mixture", "cost-model"})
SLOW = "cost-model"
VARIANTS = [*MODELS, 'social-force" variant="umans2018', 'group-force" variant="pysocialforce']
EXTRAS = ["", "<contact/>", '<contact variant="force"/>', '<limits max-speed="10"/>']
SIDE = 0.9


@dataclasses.dataclass(frozen=True)
class Blind(SocialForce):
    """A user's model that walks straight to its goal, whatever is in the way."""

    def velocity(self, scene: Scene, dt: float, rng: Any = None) -> NDArray[np.float64]:
        return scene.desired_velocity(dt)


def point(x: float, y: float, angle: float) -> tuple[float, float]:
    return math.cos(angle) * x - math.sin(angle) * y, math.sin(angle) * x + math.cos(angle) * y


def written(*points: tuple[float, float]) -> str:
    return " ".join(f"{x:.9f},{y:.9f}" for x, y in points)


def trial(
    model: str, speed: float, step: float, angle: float, slope: float = 0.3, extra: str = "", world: str = "planar"
) -> Trial:
    """Five people whose ways to their goals cross a thin wall, and a block behind it."""
    agents = []
    for k in range(5):
        (x, y), goal = point(-1.0 - 0.7 * k, 0.4 * k, angle), point(8.0, 0.4 * k + slope * (9.0 + 0.7 * k), angle)
        agents.append(f'<agent x="{x:.9f}" y="{y:.9f}" goal="{written(goal)}" speed="{speed}"/>')
    wall = written(point(0.0, -60.0, angle), point(0.0, 0.7, angle), point(0.0, 60.0, angle)).split()
    block = [point(x, y, angle) for x, y in ((2, -9), (2.2, -9), (2.2, 9), (2, 9))]
    return parse_trial(
        f'<trial name="wall" duration="{8 * step}" step="{step}" world="{world}"><recording period="{step}"/><stage>'
        f'<wall points="{wall[0]} {wall[1]}"/><wall points="{wall[1]} {wall[2]}"/>'
        f'<obstacle points="{written(*block)}"/></stage><crowd type="{model}"/>{extra}{"".join(agents)}</trial>'
    )


def places(simulation: Simulation, steps: int) -> NDArray[np.float64]:
    """Return the positions of everybody ``[T, E, A, 2]``."""
    simulation.begin()
    found = [simulation.world.scene.position]
    for _ in range(steps):
        simulation.advance()
        found.append(simulation.world.scene.position)
    assert simulation.failures == [None] * simulation.count
    return np.array(found)


def farthest(way: NDArray[np.float64], angle: float) -> float:
    """Return the largest distance beyond the wall [m] that anyone reaches; people start on the negative side."""
    return float((way @ [math.cos(angle), math.sin(angle)]).max())


@settings(max_examples=40, deadline=None)
@given(
    model=st.sampled_from(VARIANTS),
    speed=st.floats(0.5, 10.0),
    step=st.sampled_from([0.02, 0.05, 0.1, 0.2, 0.25]),
    angle=st.floats(-math.pi, math.pi),
    slope=st.floats(-2.0, 2.0),
    extra=st.sampled_from(EXTRAS),
)
def test_nobody_crosses_a_wall_with_any_model(
    model: str, speed: float, step: float, angle: float, slope: float, extra: str
) -> None:
    way = places(Simulation(trial(model, speed, step, angle, slope, extra)), min(60, round(4.0 / step)))
    assert farthest(way, angle) < 1e-9


@pytest.mark.parametrize("model", [*VARIANTS, SLOW])
def test_nobody_crosses_a_wall_at_ten_metres_per_second(model: str) -> None:
    way = places(Simulation(trial(model, 10.0, 0.25, 0.7)), 12)
    assert farthest(way, 0.7) < 1e-9


@settings(max_examples=4, deadline=None)
@given(
    model=st.sampled_from(["social-force", "boids", "heuristics", "collision-free-speed"]),
    speed=st.floats(3.0, 10.0),
    step=st.sampled_from([0.05, 0.25]),
    angle=st.floats(-math.pi, math.pi),
)
def test_nobody_crosses_a_wall_in_the_physics_world(model: str, speed: float, step: float, angle: float) -> None:
    way = places(Simulation(trial(model, speed, step, angle, world="physics")), 10)
    assert farthest(way, angle) < 1e-9


@pytest.mark.parametrize("substeps", [1, 3])
@pytest.mark.parametrize("contact", [None, ContactModel()])
@pytest.mark.parametrize("room", ["corners", "polygon", "triangle"])
def test_a_model_of_a_user_crosses_no_wall(substeps: int, contact: ContactModel | None, room: str) -> None:
    rng = np.random.default_rng(7)
    left, right, low, high = (-SIDE, -SIDE), (SIDE, -SIDE), (-SIDE, SIDE), (SIDE, SIDE)
    rings = {
        "corners": [[left, right], [right, high], [high, low], [low, left]],
        "polygon": [[left, low, high, right]],
        "triangle": [[left, right], [right, (0.0, SIDE)], [(0.0, SIDE), left]],
    }
    rng = np.random.default_rng(7)
    start = rng.uniform(-0.1, 0.1, (1, 30, 2))
    goal = 50.0 * rng.normal(size=start.shape)
    scene = Scene.of(start, goal=goal, radius=0.3, preferred_speed=10.0, max_speed=10.0, walls=Walls.of(rings[room]))
    world = PlanarWorld(scene, Blind(), {}, dt=0.2, contact=contact, substeps=substeps)
    for _ in range(10):
        scene = world.step({})
        assert np.abs(scene.position).max() <= SIDE
        assert np.hypot(*np.moveaxis(scene.velocity, -1, 0)).max() <= 10.0 + 1e-9


def test_who_is_stopped_slides_and_has_the_velocity_of_the_motion() -> None:
    scene = Scene.of(
        [[0.0, 0.0]],
        goal=[[40.0, 30.0]],
        radius=0.3,
        preferred_speed=5.0,
        max_speed=5.0,
        walls=[[(1.0, -50.0), (1.0, 50.0)]],
    )
    world = PlanarWorld(scene, Blind(), {}, dt=0.25)
    after = world.step({})
    assert after.position[0, 0].tolist() == pytest.approx([0.7, 0.75])
    assert after.velocity[0, 0].tolist() == pytest.approx([2.8, 3.0])
    last = world.step({})
    assert last.position[0, 0].tolist() == pytest.approx([0.7, after.position[0, 0, 1] + 0.25 * last.velocity[0, 0, 1]])
    assert last.velocity[0, 0, 0] == pytest.approx(0.0, abs=1e-12)


def test_robots_are_not_stopped_and_people_walk_through_openings() -> None:
    scene = Scene.of(
        [[0.0, 0.0], [0.0, 3.0]], goal=[[9.0, 0.0], [9.0, 3.0]], radius=0.3, preferred_speed=8.0, max_speed=8.0,
        walls=[[(1.0, -9.0), (1.0, -0.6)], [(1.0, 0.6), (1.0, 9.0)]],
    )  # fmt: skip
    world = PlanarWorld(scene, Blind(), {}, dt=0.25)
    way = [world.step({}).position[0, :, 0] for _ in range(4)]
    assert way[0].tolist() == pytest.approx([2.0, 0.7])
    assert way[-1].tolist() == pytest.approx([8.0, 0.7])


@pytest.mark.parametrize("extra", ["", "<contact/>"])
def test_a_batch_stops_at_walls_with_the_bits_of_single_runs(extra: str) -> None:
    fast = trial("social-force", 9.0, 0.2, 0.4, extra=extra)
    fast = dataclasses.replace(fast, heading_jitter=0.3)
    together = places(Simulation(fast, range(130)), 6)  # more people than one thread takes
    assert len({row.tobytes() for row in np.moveaxis(together, 1, 0)}) > 1
    assert farthest(together, 0.4) < 1e-9
    for seed in (0, 1, 129):
        np.testing.assert_array_equal(places(Simulation(fast, seed), 6)[:, 0], together[:, seed])


@pytest.mark.parametrize("world", ["planar", "physics"])
def test_pushed_people_cross_no_wall(world: str) -> None:
    simulation = Simulation(trial("social-force", 4.0, 0.1, 0.0, world=world))
    simulation.begin()
    order = PushOrder(person=0, force=1000.0, direction=0.0, duration=0.5)
    order.check(simulation)
    order.apply(simulation)
    assert farthest(places(simulation, 20), 0.0) < 1e-9


def diamond(cells: int) -> NDArray[np.uint8]:
    """Return the image of a map: a closed ring of cells that touch at their corners only."""
    size = 2 * cells + 5
    rows, columns = np.indices((size, size)) - size // 2
    return np.where(np.abs(rows) + np.abs(columns) == cells, 0, 254).astype(np.uint8)


@pytest.mark.parametrize("rotation", [0.0, 0.35])
@pytest.mark.parametrize("cells", [6, 15])
def test_diagonal_walls_of_a_map_stop_rays_and_people(tmp_path: Path, cells: int, rotation: float) -> None:
    image = diamond(cells)
    Image.fromarray(image).save(tmp_path / "map.png")
    half = 0.05 * len(image)
    (tmp_path / "map.yaml").write_text(
        f"image: map.png\nresolution: 0.1\norigin: [{-half}, {-half}, 0.0]\nnegate: 0\noccupied_thresh: 0.65\n"
        "free_thresh: 0.196\n",
        encoding="utf-8",
    )
    (tmp_path / "trial.xml").write_text(
        f'<trial name="map" duration="5"><stage map="map.yaml" rotation="{rotation}"/><crowd type="boids"/>'
        '<agent x="0.15" y="-0.15" goal="30,29" speed="8" radius="0.1"/>'
        '<robot name="r" x="0" y="0" radius="0.05"><goal x="0.1" y="0"/><drive type="differential-drive"/>'
        '<navigator type="straight"/><sensor name="scan" type="lidar2d" rays="3600" range-max="100" z="1.9"/></robot>'
        '<end goal="false" collision="false"/></trial>',
        encoding="utf-8",
    )
    simulation = Simulation(load_trial(str(tmp_path / "trial.xml")))
    simulation.begin()
    ((_, _, reading),) = simulation.new_readings()
    assert np.asarray(reading.ranges).max() < 0.1 * (cells + 2.5)
    for _ in range(60):
        simulation.advance()
        assert np.abs(simulation.world.scene.position[0, 0]).sum() < 0.1 * 1.3 * (cells + 2)
