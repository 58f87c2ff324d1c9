"""Workloads of ``crowdbot bench`` and their references."""

from __future__ import annotations

import dataclasses
import functools
import subprocess
import sys
from collections.abc import Callable
from typing import Any

import numpy as np

from crowdbot.core import Scene, Walls, kebab_case, parameters, stream
from crowdbot.recording import run

from .measurement import Gauge, Measurement
from .reference_engines import JUPEDSIM, jupedsim_step, power_law_in_numpy
from .sensing import TRACKING_PAIRS, posing_and_skinning, rays_of_limbs, rays_of_skins, scan_prediction, tracking

DENSITY = 0.5
"""People per square metre in timed crowds."""
DT = 0.1
NEIGHBORS, REACH = 10, 5.0
"""Neighbor settings of all models: the 10 nearest within 5 m."""
LARGE = ("orca", "power-law", "social-force")
"""Models that are also timed with 100 000 people."""
COMPARED = ("collision-free-speed", "social-force", "power-law", "orca")
"""Models that are compared with JuPedSim."""
JUPEDSIM_DT = 0.01


def measurements() -> dict[str, Callable[[], Measurement | Gauge]]:
    """Return functions that prepare measurements, by name, in order of execution.

    >>> "orca-1000" in measurements()
    True
    """
    from crowdbot import models
    from crowdbot.core import builtin_classes

    kinds = builtin_classes(models, models.CrowdModel)
    found: dict[str, Callable[[], Measurement | Gauge]] = {}
    del kinds["mixture"]  # its speed depends on its models
    for name, kind in kinds.items():
        found[f"{name}-1000"] = functools.partial(_crowd_of, kind, 1000)
        if name != "cost-model":
            found[f"{name}-10000"] = functools.partial(_crowd_of, kind, 10_000)
            found[f"{name}-batch"] = functools.partial(_batch_of, kind)
    for name in LARGE:
        if name in kinds:
            found[f"{name}-100000"] = functools.partial(_crowd_of, kinds[name], 100_000)
            found[f"{name}-growth"] = functools.partial(_growth, kinds[name])
    for name in COMPARED:
        if name in kinds:
            found[f"{name}-jupedsim"] = functools.partial(_against_jupedsim, kinds[name])
    found["collision-free-speed-same-step"] = functools.partial(
        _against_jupedsim, kinds["collision-free-speed"], JUPEDSIM[1], JUPEDSIM_DT
    )
    if "power-law" in kinds:
        found["power-law-numpy"] = functools.partial(_against_numpy, kinds["power-law"])
    found |= {
        "people-robot-gap": functools.partial(_robot_gap, True),
        "people-robot": functools.partial(_robot_gap, False),
    }
    found["orca-memory"] = _memory
    found |= {"orca-alone": _alone, "lidar-720": _lidar, "lidar-1080-batch": _lidar_batch, "trial": _trial}
    found |= {name: functools.partial(tracking, *pair) for name, pair in TRACKING_PAIRS.items()}
    found["predict-scans-1080"] = scan_prediction
    found |= {f"physics-{people}": functools.partial(_physics, people) for people in (50, 200)}
    found |= {f"physics-{people}-balance": functools.partial(_balance, people) for people in (50, 200)}
    found["camera-50"] = _camera
    found["lidar2d-1080-limbs"] = rays_of_limbs
    found["lidar3d-16x1800-limbs"] = functools.partial(rays_of_limbs, rings=16)
    for level in (0, 2):
        found[f"lidar3d-16x1800-skins-{level}"] = functools.partial(rays_of_skins, level)
    found["posing-and-skinning"] = posing_and_skinning
    for predictor in ("ConstantVelocity", "Kalman", "Simulated"):
        found[f"predict-{kebab_case(predictor)}"] = functools.partial(_predictor, predictor)
    return found


def crowd(agents: int, environments: int = 1, seed: int = 0) -> Scene:
    """Return people on a jittered grid at 0.5 per square metre with random goals, walking at 1.3 m/s."""
    random = stream(seed, "speed")
    side = (agents / DENSITY) ** 0.5
    count = int(np.ceil(agents**0.5))
    grid = (np.stack(np.meshgrid(np.arange(count), np.arange(count)), axis=-1).reshape(-1, 2)[:agents] + 0.5) / count
    place = side * grid + random.uniform(-0.2, 0.2, (environments, agents, 2))
    goal = random.uniform(0.0, side, (environments, agents, 2))
    away = goal - place
    velocity = 1.3 * away / np.linalg.norm(away, axis=-1, keepdims=True)
    order = random.permutation(agents)  # random order: the index does not depend on the position
    return Scene.of(place[:, order], velocity[:, order], goal=goal[:, order], max_speed=1.8)


def _make_model(kind: type) -> Any:
    names = {row.name for row in parameters(kind)}
    given = {"max_neighbors": float(NEIGHBORS), "neighbor_distance": REACH}
    return kind(**{name: value for name, value in given.items() if name in names})


def _crowd_of(kind: type, agents: int) -> Measurement:
    model, scene = _make_model(kind), crowd(agents)
    real = f"real time ({agents} people, step {DT} s)"
    return Measurement("agent-steps/s", agents, lambda: model.step(scene, DT), real, agents / DT)


def _batch_of(kind: type) -> Measurement:
    model, scene = _make_model(kind), crowd(32, environments=1024)
    real = f"real time (1024 scenes of 32 people, step {DT} s)"
    agents = scene.shape[0] * scene.shape[1]
    return Measurement("agent-steps/s", agents, lambda: model.step(scene, DT), real, agents / DT)


def _growth(kind: type) -> Measurement:
    model, large, small = _make_model(kind), crowd(100_000), crowd(1000)
    words = "the same model with 1000 people, per agent"
    return Measurement(
        "agent-steps/s", 1e5, lambda: model.step(large, DT), words,
        other=lambda: [model.step(small, DT) for _ in range(20)], other_amount=2e4,
    )  # fmt: skip


def _against_jupedsim(kind: type, theirs: str = JUPEDSIM[0], dt: float = DT) -> Measurement:
    """Compare the simulated time of all agents: ours with steps of ``dt``, JuPedSim with its own steps of 0.01 s."""
    model, scene = _make_model(kind), crowd(10_000)
    step = jupedsim_step(theirs, scene)
    words = f"JuPedSim {theirs}, 10000 people, step {JUPEDSIM_DT} s (ours {dt} s)"
    return Measurement(
        "agent-s/s", 1e4 * dt, lambda: model.step(scene, dt), words,
        other=lambda: [step() for _ in range(5)], other_amount=5e4 * JUPEDSIM_DT,
    )  # fmt: skip


def _against_numpy(kind: type) -> Measurement:
    model, scene = _make_model(kind), crowd(1000)
    words = "the same model in NumPy, for all pairs, 1000 people"
    return Measurement(
        "agent-steps/s", 20e3, lambda: [model.step(scene, DT) for _ in range(20)], words,
        other=lambda: power_law_in_numpy(scene), other_amount=1e3,
    )  # fmt: skip


def _robot_gap(same_robot: bool) -> Measurement:
    """Time 100 people who keep a gap to a robot that drives through them.

    Args:
        same_robot: whether the other crowd has the robot, but people with ``robot-gap=0``; otherwise it has no robot.
    """
    from crowdbot.models import People

    people, count = 100, 200
    some = crowd(people)
    middle = some.position[0].mean(axis=0)
    is_robot = np.append(np.zeros(people, dtype=bool), True)
    scene = Scene.of(
        np.vstack([some.position[0], middle]), np.vstack([some.velocity[0], (0.7, 0.0)]),
        goal=np.vstack([some.goal[0], middle]), max_speed=1.8, radius=np.where(is_robot, 0.35, 0.25),
        external=is_robot, robot=is_robot,
        active=is_robot | np.append(np.hypot(*(some.position[0] - middle).T) > 0.7, True),
    )  # fmt: skip
    model = People().individual(people + 1, stream(0, "robot-gap"))
    kind: type = People
    other = kind(robot_gap=0.0) if same_robot else model
    other_scene = scene if same_robot else scene.replace(active=scene.active & ~is_robot)
    return Measurement(
        "agent-steps/s", count * people, functools.partial(_repeat, lambda: model.step(scene, DT), count),
        "the same 100 people and robot with robot-gap=0" if same_robot else "the same 100 people without a robot",
        other=functools.partial(_repeat, lambda: other.step(other_scene, DT), count), other_amount=count * people,
    )  # fmt: skip


def _alone() -> Measurement:
    from crowdbot.models import ORCA

    model, many = ORCA(), crowd(32, environments=256)
    single = [
        Scene.of(many.position[e], many.velocity[e], goal=many.goal[e], max_speed=1.8) for e in range(many.shape[0])
    ]
    agents = many.shape[0] * many.shape[1]
    words = "the same 256 scenes of 32 people, one at a time"
    return Measurement(
        "agent-steps/s", agents, lambda: model.step(many, DT), words,
        other=lambda: [model.step(scene, DT) for scene in single], other_amount=agents,
    )  # fmt: skip


def _memory() -> Gauge:
    """Read the peak memory of a child process that simulates 100 000 people for three steps."""
    program = (
        "from crowdbot.core import peak_memory\n"
        "from crowdbot.benchmark.speed.workloads import crowd\n"
        "from crowdbot.models import ORCA\n"
        "scene = crowd(100_000)\nfor _ in range(3): scene = ORCA().step(scene, 0.1)\n"
        "print(peak_memory() / 2**20)"
    )
    output = ""
    for _ in range(2):  # the first run may compile kernels, which needs more memory
        run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)  # noqa: S603
        output = run.stdout
    return Gauge("MB", float(output), "500 MB for 100000 people", 500.0)


def _lidar() -> Measurement:
    from crowdbot.core import Pose
    from crowdbot.sensors import Lidar2D

    sensor, scene = Lidar2D(rays=720), crowd(50)
    pose = Pose.of((5.0, 5.0), 0.0)
    return Measurement("scans/s", 20, lambda: [sensor.read(scene, pose) for _ in range(20)], "a 10 Hz sensor", 10.0)


def _lidar_batch() -> Measurement:
    """Scan 64 environments of 50 people and 4 walls with 1080 beams, the walls within the range."""
    from crowdbot.core import Pose
    from crowdbot.sensors import Lidar2D, SensorView

    environments, people, beams = 64, 50, 1080
    scene, random = crowd(people, environments), stream(0, "lidar-batch")
    side = (people / DENSITY) ** 0.5
    room = [(-1.0, -1.0), (-1.0, side + 1.0), (side + 1.0, side + 1.0), (side + 1.0, -1.0)]
    scene = scene.replace(walls=Walls.of([room]))
    pose = Pose.of(random.uniform(0.0, side, (environments, 2)), random.uniform(-np.pi, np.pi, environments))
    sensor, view = Lidar2D(rays=beams, range_max=25.0), SensorView(scene, pose)
    work = functools.partial(_repeat, lambda: sensor.measure(view, None), 10)
    return Measurement("rays/s", 10 * environments * beams, work, "50 million rays/s on 2 cores", 5e7)


def _repeat(work: Callable[[], object], count: int) -> None:
    for _ in range(count):
        work()


def _predictor(name: str) -> Measurement:
    from crowdbot import prediction
    from crowdbot.trials import load_trial

    predictor = getattr(prediction, name)()
    past, _ = run(load_trial("crossing-flows")).tracks(0.4).windows(8, 12)
    live = "a live stream of 2.5 windows/s"
    return Measurement("windows/s", len(past), lambda: predictor.predict(past, 12), live, 2.5)


def _physics(people: int, balance: bool = False) -> Measurement:
    """Time one robot among people in steps of 5 ms, with odometry and a laser scanner of limbs, both at 10 Hz."""
    from crowdbot.core import Twist
    from crowdbot.sensors import Lidar2D, SensorView

    world, robot = _bodies(people, balance)
    laser, body = Lidar2D(rays=1080), world.robot_body(robot)
    wheels = body.robot.mount("odometry").sensor
    _, state = wheels.measure(SensorView(world.scene, world.pose(robot)), wheels.begin())

    def work() -> None:
        nonlocal state
        for _ in range(20):
            world.step({robot: Twist(0.5, 0.3)})
            _, state = wheels.measure(SensorView(world.scene, world.pose(robot)), state)
            laser.read(world.body_scene().without(robot), body.sensor_pose("laser"))

    return Measurement("simulated s/s", 20 * DT, work, "real time", 1.0)


def _balance(people: int) -> Measurement:
    """Time the same with people who can lose their balance, against the world without balance."""
    one, other = _physics(people, True), _physics(people)
    return Measurement(one.unit, one.amount, one.work, "the same without balance", 0.0, other.work, other.amount)


def _camera() -> Measurement:
    """Time images of 640 x 480 pixels with depth."""
    from crowdbot.world import SceneCamera

    world, _ = _bodies(50)
    camera = SceneCamera((-2.0, -2.0, 3.0), (5.0, 5.0, 0.8), detail=2)
    return Measurement("images/s", 1, lambda: world.render(camera, depth=True), "a camera of 10 Hz", 10.0)


def _bodies(people: int, balance: bool = False) -> tuple[Any, int]:
    """Return a physics world with a robot in the middle of a crowd, and the agent index of the robot."""
    from crowdbot.models import ORCA
    from crowdbot.world import PhysicsWorld, Robot

    robot, some = Robot.load("differential"), crowd(people)
    middle = some.position[0].mean(axis=0)
    scene = Scene.of(
        np.vstack([some.position[0], middle]), goal=np.vstack([some.goal[0], middle]), max_speed=1.8,
        radius=np.append(np.full(people, 0.25), robot.radius), external=np.append(np.zeros(people, dtype=bool), True),
        active=np.append(np.hypot(*(some.position[0] - middle).T) > robot.radius + 0.5, True),
    )  # fmt: skip
    return PhysicsWorld(scene, ORCA(), {people: robot}, DT, balance=balance), people


def _trial() -> Measurement:
    from crowdbot.trials import load_trial

    trial = load_trial("crossing-flows")
    trial = dataclasses.replace(trial, duration=10.0)
    seconds = float(run(trial).times[-1])
    return Measurement("simulated s/s", seconds, lambda: run(trial), "real time", 1.0)
