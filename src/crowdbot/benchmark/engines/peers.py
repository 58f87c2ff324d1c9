"""Other engines beside our crowd models: RVO2, JuPedSim, navground and PySocialForce.

RVO2, the C++ library of ORCA, is compiled from a folder with its source or is the package ``pyrvo``; the others are
optional packages.
"""

from __future__ import annotations

import contextlib
import ctypes
import hashlib
import logging
import shutil
import subprocess
import tempfile
from abc import ABC, abstractmethod
from collections.abc import Callable
from importlib import resources
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from crowdbot.benchmark.speed.reference_engines import jupedsim_step
from crowdbot.core import InputError, Scene, cache_root, import_optional
from crowdbot.models import ORCA, CollisionFreeSpeed, GroupForce


def most_kernel_threads() -> int:
    """Return the largest number of threads of our kernels: the cores that this process may use, or a setting."""
    import numba

    return int(numba.config.NUMBA_NUM_THREADS)  # type: ignore[attr-defined]


class EnginePeer(ABC):
    """Another engine, with the settings that make it comparable with one of our models.

    Attributes:
        name: name of the engine.
        packages: packages whose versions the report tells.
        people: numbers of people to measure.
        dt: time step of both [s].
        protocol: what both compute, and how they differ.
    """

    name: ClassVar[str]
    packages: tuple[str, ...] = ()
    people: ClassVar[tuple[int, ...]]
    dt: ClassVar[float]
    protocol: ClassVar[str]

    @property
    @abstractmethod
    def model(self) -> Any:
        """Our model with the settings of the engine."""

    @abstractmethod
    def step(self, scene: Scene, threads: int = 1) -> Callable[[], object]:
        """Return a function that makes one step of the engine from the people of environment 0.

        Args:
            scene: people without walls.
            threads: number of threads, one of :meth:`threads`.

        Raises:
            MissingExtra: the engine is not installed.
        """

    def threads(self) -> tuple[int, ...]:
        """Return the numbers of threads that the engine can use."""
        return (1,)

    def describe(self) -> str:
        """Return which build of the engine runs."""
        return self.name


FLAGS = ("-O3", "-march=native", "-DNDEBUG", "-fopenmp")
REACH, MOST, HORIZON = 5.0, 10, 2.0
SLOWEST = 300.0
"""Longest time [s] of the compiler."""


class Rvo2Peer(EnginePeer):
    """RVO2 without walls; the desired velocities are set once, by us they are computed in every step.

    Args:
        source: folder with the source of RVO2 (``Agent.cc`` or ``Agent.cpp`` in it or in ``src``), compiled with
            ``g++ -O3 -march=native -fopenmp``; None uses the package ``pyrvo``, which has one thread.

    Raises:
        InputError: the folder has no such source, or it cannot be compiled.
        MissingExtra: there is no folder, and pyrvo is not installed.
    """

    name = "RVO2"
    people = (1000, 10_000, 100_000)
    dt = 0.1
    protocol = (
        "ORCA of 10 neighbours within 5 m, horizon 2 s, no walls; RVO2 computes in single precision (ours in double)"
        " and keeps the desired velocities of the start (ours come from goals in every step)"
    )
    packages: tuple[str, ...] = ("pyrvo",)

    def __init__(self, source: Path | None = None) -> None:
        self.library: Any = None
        if source is None:
            self._pyrvo = import_optional("pyrvo", "the comparison with RVO2", "peers")
        else:
            self.packages, self.library = (), _load(_compile(Path(source)))

    @property
    def model(self) -> ORCA:
        return ORCA(neighbor_distance=REACH, max_neighbors=float(MOST), time_horizon=HORIZON)

    def threads(self) -> tuple[int, ...]:
        # 1, and 2 with the compiled library where our kernels have two
        return (1, 2) if self.library is not None and most_kernel_threads() > 1 else (1,)

    def describe(self) -> str:
        return f"RVO2 from source, g++ {' '.join(FLAGS)}" if self.library is not None else "RVO2 of the package pyrvo"

    def step(self, scene: Scene, threads: int = 1) -> Callable[[], object]:
        wish = scene.desired_velocity(self.dt)
        columns = (scene.position, scene.velocity, wish, scene.radius, scene.max_speed)
        values = [np.ascontiguousarray(column[0]) for column in columns]
        if self.library is not None:
            return _Simulator(self.library, self.dt, values, threads).step
        simulator = self._pyrvo.RVOSimulator(self.dt, REACH, MOST, HORIZON, HORIZON, 0.25, 2.0)
        for number, (place, velocity, wish, radius, top) in enumerate(zip(*(v.tolist() for v in values), strict=True)):
            simulator.add_agent(tuple(place))
            simulator.set_agent_velocity(number, tuple(velocity))
            simulator.set_agent_pref_velocity(number, tuple(wish))
            simulator.set_agent_radius(number, radius)
            simulator.set_agent_max_speed(number, top)
        return simulator.do_step  # type: ignore[no-any-return]


class _Simulator:
    """A simulator of the compiled library."""

    def __init__(self, library: Any, dt: float, values: list[Any], threads: int) -> None:
        self._library, self._threads = library, threads
        self._pointer = ctypes.c_void_p(library.rvo2_new(dt, REACH, MOST, HORIZON))
        library.rvo2_add(self._pointer, len(values[0]), *values)

    def step(self) -> None:
        self._library.rvo2_step(self._pointer, self._threads)

    def __del__(self) -> None:
        self._library.rvo2_delete(self._pointer)


def _load(path: Path) -> Any:
    library = ctypes.CDLL(str(path))
    array = np.ctypeslib.ndpointer(np.float64, flags="C_CONTIGUOUS")
    library.rvo2_new.restype = ctypes.c_void_p
    library.rvo2_new.argtypes = [ctypes.c_float, ctypes.c_float, ctypes.c_size_t, ctypes.c_float]
    library.rvo2_add.argtypes = [ctypes.c_void_p, ctypes.c_size_t, *[array] * 5]
    library.rvo2_step.argtypes = [ctypes.c_void_p, ctypes.c_int]
    library.rvo2_delete.argtypes = [ctypes.c_void_p]
    return library


def _compile(folder: Path) -> Path:
    """Return the shared library of the source and our access to it, compiled once."""
    source = next((item for item in (folder, folder / "src") if any(item.glob("Agent.c*"))), None)
    if source is None:
        raise InputError(
            f"{folder} has no source of RVO2: there is no Agent.cc or Agent.cpp in it or in its folder src"
        )
    compiler = shutil.which("g++")
    if compiler is None:
        raise InputError("RVO2 cannot be compiled: there is no g++; install it, or leave out --rvo2")
    files = sorted(item for item in source.glob("*.c*") if item.suffix in (".cc", ".cpp") and item.stem != "Export")
    access = resources.files("crowdbot") / "assets" / "benchmark" / "rvo2_access.cc"
    digest = hashlib.sha256(b"".join([access.read_bytes(), *(file.read_bytes() for file in files)])).hexdigest()[:16]
    built = cache_root() / "rvo2" / f"{digest}.so"
    if not built.exists():
        built.parent.mkdir(parents=True, exist_ok=True)
        _run_compiler(compiler, source, [str(access), *map(str, files)], built)
    return built


def _run_compiler(compiler: str, source: Path, files: list[str], built: Path) -> None:
    headers = built.parent / "headers"
    headers.mkdir(exist_ok=True)  # newer versions include a header that their build system writes
    (headers / "Export.h").write_text("#pragma once\n#define RVO_EXPORT\n", encoding="utf-8")
    include = [f"-I{source}", *([] if (source / "Export.h").exists() else [f"-I{headers}"])]
    part = built.with_suffix(".part")
    command = [compiler, *FLAGS, "-std=c++17", "-shared", "-fPIC", *include, *files, "-o", str(part)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=SLOWEST)  # noqa: S603
    if done.returncode:
        lines = [line for line in done.stderr.splitlines() if "error" in line] or ["no message"]
        raise InputError(f"the source of RVO2 in {source} cannot be compiled: {lines[0]}")
    part.replace(built)


class JuPedSimPeer(EnginePeer):
    """The collision-free speed model of JuPedSim, with direct steering, the least work for it."""

    name = "JuPedSim"
    packages = ("jupedsim",)
    people = (1000, 10_000)
    dt = 0.01
    protocol = (
        "collision-free speed model of version 2 with its default values, people within 3 m, no walls; JuPedSim"
        " computes in one thread"
    )

    def __init__(self) -> None:
        import_optional("jupedsim", "the comparison with JuPedSim", "peers")

    def threads(self) -> tuple[int, ...]:
        # 1 and 2: JuPedSim has one thread, ours can have more
        return (1, 2) if most_kernel_threads() > 1 else (1,)

    @property
    def model(self) -> CollisionFreeSpeed:
        return CollisionFreeSpeed()

    def step(self, scene: Scene, threads: int = 1) -> Callable[[], object]:
        return jupedsim_step("CollisionFreeSpeedModelV2", scene)


class NavgroundOrcaPeer(EnginePeer):
    """ORCA of navground, a compiled world with its neighbour search."""

    name = "navground"
    packages = ("navground",)
    people = (1000,)
    dt = 0.1
    protocol = "ORCA of 10 neighbours within 5 m, horizon 2 s, no walls; navground also resolves contacts in each step"

    def __init__(self) -> None:
        self._core = import_optional("navground.core", "the comparison with navground", "peers")
        self._sim = import_optional("navground.sim", "the comparison with navground", "peers")

    @property
    def model(self) -> ORCA:
        return ORCA(neighbor_distance=5.0, max_neighbors=10.0, time_horizon=2.0)

    def step(self, scene: Scene, threads: int = 1) -> Callable[[], object]:
        core, sim, world = self._core, self._sim, self._sim.World()
        columns = (scene.position[0], scene.goal[0], scene.radius[0], scene.preferred_speed[0], scene.max_speed[0])
        for place, goal, radius, speed, top in zip(*(column.tolist() for column in columns), strict=True):
            kinematics = core.kinematics.OmnidirectionalKinematics(max_speed=top, max_angular_speed=1.5)
            behavior = core.behaviors.ORCABehavior(kinematics, radius)
            behavior.optimal_speed, behavior.safety_margin = speed, 0.0
            behavior.horizon, behavior.max_number_of_neighbors = 5.0, 10
            behavior.time_horizon = behavior.static_time_horizon = 2.0
            task = sim.tasks.WaypointsTask(waypoints=[goal], loop=False, tolerance=0.2)
            sight = [sim.state_estimations.BoundedStateEstimation(range=5.0)]
            agent = sim.Agent(radius, behavior, kinematics, task, sight, 0.0)
            agent.position = place
            world.add_agent(agent)
        return lambda: world.update(self.dt)


class PySocialForcePeer(EnginePeer):
    """PySocialForce, all pairs in compiled Python."""

    name = "PySocialForce"
    packages = ("pysocialforce",)
    people = (100, 500)
    dt = 0.4
    protocol = (
        "social force with contacts (ours: group-force, variant pysocialforce), no walls, no groups; it compares all"
        " pairs in one thread"
    )

    def __init__(self) -> None:
        root = logging.getLogger()
        level, handlers = root.level, list(root.handlers)
        logging.disable()  # its import writes a file, and prints the messages of every package
        try:
            with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
                self._module = import_optional("pysocialforce", "the comparison with PySocialForce", "peers")
        finally:  # also if the package is missing
            logging.disable(logging.NOTSET)
            root.setLevel(level)
            for handler in [handler for handler in root.handlers if handler not in handlers]:
                root.removeHandler(handler)
                handler.close()

    @property
    def model(self) -> GroupForce:
        return GroupForce(variant="pysocialforce")

    def step(self, scene: Scene, threads: int = 1) -> Callable[[], object]:
        state = np.concatenate([scene.position[0], scene.velocity[0], scene.goal[0]], axis=1)
        simulator = self._module.Simulator(state)
        return lambda: simulator.step(1)
