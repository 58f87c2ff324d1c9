"""Measurement and report of ``crowdbot bench engines``."""

from __future__ import annotations

import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.benchmark.speed.timing import environment, load_average
from crowdbot.benchmark.speed.workloads import crowd
from crowdbot.core import InputError, MissingExtra, Scene, kebab_case

from .peers import EnginePeer, JuPedSimPeer, NavgroundOrcaPeer, PySocialForcePeer, Rvo2Peer, most_kernel_threads

Start = Callable[[], Callable[[], object]]
"""Makes an engine at the start, and returns the function that makes one step of it."""


def time_steps(ours: Start, theirs: Start, steps: int, repeats: int) -> NDArray[np.float64]:
    """Return the mean time [s] of a step of both engines, ``[2, repeats]``.

    Each repetition begins at the start in both engines, with one step that is not timed.

    >>> def start(count):
    ...     return lambda: (lambda: sum(range(count)))
    >>> found = time_steps(start(1), start(10_000), 5, 3)
    >>> bool((found[0] < found[1]).all()), found.shape
    (True, (2, 3))
    """
    result = np.empty((2, repeats))
    for k in range(repeats):
        for row, start in enumerate((ours, theirs)):
            step = start()
            step()
            begin = time.perf_counter()
            for _ in range(steps):
                step()
            result[row, k] = (time.perf_counter() - begin) / steps
    return result


@contextmanager
def kernel_threads(count: int) -> Iterator[None]:
    """Run kernels in ``count`` threads inside of the context."""
    import numba

    before = numba.get_num_threads()
    numba.set_num_threads(count)
    try:
        yield
    finally:
        numba.set_num_threads(before)


@dataclass(frozen=True)
class EngineRow:
    """Time of a step of a model and of the same model in another engine.

    Fields:
        model: name of our model.
        engine: name of the other engine.
        people: number of people.
        order: order of the people in memory, ``random`` or ``sorted`` by place.
        threads: threads of both.
        dt: time step of both [s].
        ours, theirs: median time of a step [ms].
        ratio: ``theirs / ours``, the median over the repetitions.
        low, high: 10th and 90th percentile of these ratios.
    """

    model: str
    engine: str
    people: int
    order: str
    threads: int
    dt: float
    ours: float
    theirs: float
    ratio: float
    low: float
    high: float

    def as_dict(self) -> dict[str, Any]:
        """Return the row as ``crowdbot bench engines --json`` prints it."""
        return asdict(self)


@dataclass(frozen=True)
class MillionRow:
    """A step of a very large crowd in a process of its own.

    Fields:
        model: name of the model.
        people: number of people.
        seconds: shortest time of a step [s].
        megabytes: largest memory of the process [MB].
    """

    model: str
    people: int
    seconds: float
    megabytes: float


PROTOCOL = (
    "People on a jittered grid, 0.5 per square metre, with random goals; both engines walk on from the same state with"
    " the same time step, 2 s or 300 000 steps of people from the start in each repetition. The engines alternate, so"
    " that other work on the machine slows both; a ratio is the median over the repetitions, with the 10th and 90th"
    " percentile. Above 1, crowdbot is faster."
)
WALK, LARGEST = 2.0, 300_000
"""Time that people walk in a repetition [s], and its largest number of people times steps."""
CELL = 3.0
"""Height [m] of the strips in which sorted people follow each other."""


@dataclass(frozen=True)
class EngineSizes:
    """Sizes of the measurement.

    Fields:
        repeats: pairs of blocks.
        people: largest number of people beside another engine.
        million: number of people of the very large crowd, 0 for none.
    """

    repeats: int = 7
    people: int = 100_000
    million: int = 1_000_000

    def __post_init__(self) -> None:
        if self.repeats < 1:
            raise InputError(f"repeats {self.repeats} is below 1")

    @classmethod
    def quick(cls, repeats: int) -> EngineSizes:
        """Return sizes that test the command, not the speed."""
        return cls(repeats, 1000, 2000)


@dataclass(frozen=True)
class EngineReport:
    """Result of the benchmark of engines.

    Fields:
        machine: processor, system and versions.
        load: load averages over one minute before and after, None where the system has none.
        sizes: sizes of the measurement.
        threads: largest number of threads of our kernels; rows with more are left out.
        versions: versions of the engines by package.
        protocols: what is compared, by engine.
        missing: for each engine that is not installed, how to install it.
        rows: times and ratios.
        million: the very large crowd, None if it was not measured.
    """

    machine: str
    load: tuple[float | None, float | None]
    sizes: EngineSizes
    threads: int
    versions: dict[str, str]
    protocols: dict[str, str]
    missing: dict[str, str]
    rows: tuple[EngineRow, ...]
    million: MillionRow | None

    def as_dict(self) -> dict[str, Any]:
        """Return the report as ``crowdbot bench engines --json`` prints it."""
        return {"protocol": PROTOCOL, **asdict(self)}


def measure_engines(
    sizes: EngineSizes = EngineSizes(),
    rvo2: Path | None = None,
    report: Callable[[str, float], None] | None = None,
) -> EngineReport:
    """Measure steps of our models beside those of other engines.

    Args:
        sizes: sizes of the measurement.
        rvo2: folder with the source of RVO2, compiled with optimisation (default: the package pyrvo).
        report: called with the name and the completed fraction before each row.

    Raises:
        InputError: the source of RVO2 is not there or cannot be compiled.
    """
    before = load_average()
    makers: list[Callable[[], EnginePeer]] = [
        lambda: Rvo2Peer(rvo2), JuPedSimPeer, NavgroundOrcaPeer, PySocialForcePeer,
    ]  # fmt: skip
    peers, missing = [], {}
    for make in makers:
        try:
            peers.append(make())
        except MissingExtra as error:
            missing[str(error).split(" needs ")[0].removeprefix("the comparison with ")] = str(error)
    tasks = [(peer, *task) for peer in peers for task in _tasks(peer, sizes)]
    rows = []
    for number, (peer, people, order, threads) in enumerate(tasks):
        if report is not None:
            report(f"{peer.name} {people}", number / (len(tasks) + 1))
        rows.append(_measure(peer, people, order, threads, sizes.repeats))
    if report is not None and sizes.million:
        report("a very large crowd", len(tasks) / (len(tasks) + 1))
    million = _million(sizes.million) if sizes.million else None
    versions = {package: version(package) for peer in peers for package in peer.packages}
    protocols = {peer.describe(): peer.protocol for peer in peers}
    return EngineReport(
        environment(), (before, load_average()), sizes, most_kernel_threads(), versions, protocols, missing,
        tuple(rows), million,
    )  # fmt: skip


def _tasks(peer: EnginePeer, sizes: EngineSizes) -> Iterator[tuple[int, str, int]]:
    """Yield people, order and threads."""
    for people in peer.people:
        if people <= sizes.people:
            for threads in peer.threads():
                for order in ("random", "sorted"):
                    yield people, order, threads


def _measure(peer: EnginePeer, people: int, order: str, threads: int, repeats: int) -> EngineRow:
    model, scene = peer.model, crowd(people)
    if order == "sorted":
        scene = _sorted(scene)

    def start() -> Callable[[], object]:
        state = [scene]

        def step() -> None:
            state[0] = model.step(state[0], peer.dt)

        return step

    start()()  # compiles in all threads
    steps = max(2, min(round(WALK / peer.dt), LARGEST // people))
    with kernel_threads(threads):
        a, b = time_steps(start, lambda: peer.step(scene, threads), steps, repeats)
    ratios = b / a
    low, middle, high = np.percentile(ratios, (10, 50, 90)).tolist()
    times = (1e3 * float(np.median(a)), 1e3 * float(np.median(b)))
    name = kebab_case(type(model).__name__)
    return EngineRow(name, peer.name, people, order, threads, peer.dt, *times, middle, low, high)


def _sorted(scene: Scene) -> Scene:
    """Return the people in strips, from one end to the other."""
    x, y = scene.position[0].T
    order = np.lexsort((x, np.floor(y / CELL)))
    return Scene.of(scene.position[:, order], scene.velocity[:, order], goal=scene.goal[:, order], max_speed=1.8)


def _million(people: int) -> MillionRow:
    """Measure the steps of a very large crowd in a child process, whose memory is told."""
    program = (
        "import time\n"
        "from crowdbot.core import peak_memory\n"
        "from crowdbot.benchmark.speed.workloads import crowd\n"
        "from crowdbot.models import ORCA\n"
        f"scene, model, best = crowd({people}), ORCA(), float('inf')\n"
        "for _ in range(4):\n"
        "    begin = time.perf_counter()\n"
        "    scene = model.step(scene, 0.1)\n"
        "    best = min(best, time.perf_counter() - begin)\n"
        "print(best, peak_memory() / 2**20)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)  # noqa: S603
    seconds, megabytes = map(float, done.stdout.split())
    return MillionRow("orca", people, seconds, megabytes)
