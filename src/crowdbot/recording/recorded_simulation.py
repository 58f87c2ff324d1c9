"""Recorded episodes that run again."""

from __future__ import annotations

import contextlib
import warnings
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from types import TracebackType
from typing import NamedTuple

from crowdbot.core import EpisodeError, InputError
from crowdbot.simulation import EpisodeDigest, OrderSource, Simulation, SimulationRun, StopRequest
from crowdbot.trials import Trial

from .attachments import unpack_attachments
from .episode_reader import read_metadata
from .keyframes import Keyframe, KeyframeWarning, keyframe_ticks, latest_keyframe
from .provenance import DigestComparison, OrderReplay, Provenance, digests, replay_decisions

LATE = "the episode is simulated from its beginning"


class RecordedSimulation:
    """The simulation of a recorded episode, for instants in any order.

    :meth:`at` continues from the latest keyframe, at most 5 s before the instant. Episodes without keyframes, or made
    with other versions, are simulated from the beginning. The digest is compared at every recorded step on the way.

    Use it as a context manager: files of the trial are unpacked until it ends.

    Args:
        path: the episode.
        folder, trust: see :func:`replay`.

    Raises:
        EpisodeError: the file cannot be read.

    >>> import tempfile
    >>> from crowdbot.models import ORCA
    >>> from crowdbot.recording import record
    >>> from crowdbot.trials import Trial
    >>> path = record(Trial(name="empty", duration=12.0, crowd=ORCA()), out=tempfile.mkdtemp()).path
    >>> with RecordedSimulation(path) as recorded:
    ...     [recorded.at(seconds).tick for seconds in (11.0, 3.0)]
    [220, 60]
    """

    def __init__(self, path: Path | str, *, folder: Path | None = None, trust: bool = False) -> None:
        self.path, self._folder, self._trust = Path(path), folder, trust
        self._stack = contextlib.ExitStack()
        self._known: dict[str, str] = {}
        self._wanted: dict[int, str] = {}
        self._course: Provenance | None = None
        self._new: dict[int, Simulation] = {}
        self._places: dict[int, tuple[int, int]] = {}

    def __enter__(self) -> RecordedSimulation:
        """Read the trial and the orders."""
        self._known, self._wanted = read_metadata(self.path), digests(self.path)
        self._places = keyframe_ticks(self.path)
        place = self._stack.enter_context(unpack_attachments(self.path, self._known, self._folder, self._trust))
        self._course = Provenance.of(self.path, place.folder, self._trust)
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Remove unpacked files."""
        self._stack.close()

    def at(self, seconds: float) -> Simulation:
        """Return an independent simulation at an instant [s], after the orders of its step.

        Raises:
            InputError: the instant is outside the recorded time, or the files of the trial are not open.
            EpisodeError: the episode does not replay with the same digest.
        """
        course = self._course
        if course is None:
            raise InputError("use RecordedSimulation as a context manager: with RecordedSimulation(path) as recorded")
        step = int(self._known["step_ns"])
        tick, first = round(seconds * 1e9 / step), course.parts[-1].tick
        last = max(self._wanted, default=first * step) // step
        if not first <= tick <= last:
            raise InputError(
                f"{self.path} has no instant {seconds:g} s; it lasts from {first * step / 1e9:g} s to"
                f" {last * step / 1e9:g} s"
            )
        comparison = DigestComparison(EpisodeDigest(), self._wanted)
        start = continue_from(self.path, course, self._known, tick, comparison, self._fresh, self._places)
        simulation = simulate_to(tick, course, comparison, start, str(self.path), StopRequest())
        if comparison.differs is not None:
            raise EpisodeError(f"{self.path} differs from its replay from {comparison.differs:g} s on")
        return simulation

    def run_from(self, seconds: float) -> SimulationRun:
        """Return a run that continues from an instant [s] with the recorded orders, to watch the episode.

        Raises:
            InputError, EpisodeError: see :meth:`at`.
        """
        simulation = self.at(seconds)
        assert self._course is not None
        return SimulationRun(simulation, (), (OrderReplay(self._course.parts[-1].orders),))

    def trial_simulation(self) -> Simulation:
        """Return a new simulation of the trial at the end of the episode, at its own start: shapes, bodies, sensors."""
        return self._fresh(max(self._wanted, default=0) // int(self._known["step_ns"]))

    def changes(self) -> int:
        """Return the number of orders that have changed the trial."""
        assert self._course is not None
        return self._course.changes_until(2**62)

    def _fresh(self, tick: int) -> Simulation:
        """Return a new simulation of the trial with its changes up to a step, built once for each set of changes."""
        assert self._course is not None
        changes = self._course.changes_until(tick)
        if changes not in self._new:
            self._new[changes] = self._course.begin_at(tick)
        return self._new[changes].select([0])


def simulate_to(
    tick: int,
    course: Provenance,
    comparison: DigestComparison,
    start: Simulation | None,
    name: str,
    stop: StopRequest,
    progress: Callable[[float], None] | None = None,
) -> Simulation:
    """Return the simulation at a step of the last segment.

    Args:
        tick: the step.
        course: provenance of the episode.
        comparison: compares the digests on the way.
        start: the simulation at a keyframe, see :func:`continue_from`; None: from the beginning.
        name: name of the episode, for messages.
        stop, progress: see :meth:`Provenance.simulate_until`.

    Raises:
        EpisodeError: the run ends earlier.

    Warns:
        KeyframeWarning: the run differs after the keyframe; it is simulated from the beginning.
    """
    if start is not None:
        try:
            simulation = course.simulate_until(comparison, stop, progress, until=tick, start=start)
            if comparison.differs is None:
                return simulation
        except EpisodeError:  # the state of a wrong keyframe may end the run
            pass
        warnings.warn(f"{name} differs after its keyframe; {LATE}", KeyframeWarning, stacklevel=4)
        comparison.digest, comparison.differs = EpisodeDigest({}), None
    return course.simulate_until(comparison, stop, progress, until=tick)


def continue_from(
    path: Path,
    course: Provenance,
    known: dict[str, str],
    tick: int,
    comparison: DigestComparison,
    fresh: Callable[[int], Simulation] | None = None,
    places: Mapping[int, tuple[int, int]] | None = None,
) -> Simulation | None:
    """Return the simulation at the latest keyframe up to a step, with the digest in ``comparison``; None without one.

    Args:
        path: the episode.
        course: its provenance.
        known: its metadata.
        tick: the step.
        comparison: continues from the digest of the keyframe.
        fresh: returns a new simulation with the changes up to a step (default: built from the provenance).
        places: offset and length of each keyframe by its step, if known.

    Raises:
        EpisodeError: the file cannot be read.

    Warns:
        KeyframeWarning: a keyframe is damaged.
    """
    begin = fresh or course.begin_at
    try:
        keyframe: Keyframe | None = latest_keyframe(path, known, tick, comparison.wanted, places)
        if keyframe is None or keyframe.tick < course.parts[-1].tick:
            return None
        simulation: Simulation = begin(keyframe.tick)
        keyframe.restore(simulation)
        digest = keyframe.digest
    except EpisodeError:
        raise
    except InputError as error:
        warnings.warn(f"{path}: {error}; {LATE}", KeyframeWarning, stacklevel=3)
        return None
    comparison.digest = digest
    return simulation


class EpisodeRerun(NamedTuple):
    """The trial of an episode with its seed and its orders.

    Fields:
        trial, seed: the trial and its seed.
        sources: the recorded orders.
        prepare: to be called with a new simulation; decisions miss their deadline or hang as recorded.
    """

    trial: Trial
    seed: int
    sources: tuple[OrderSource, ...]
    prepare: Callable[[Simulation], None]


@contextlib.contextmanager
def open_rerun(path: Path | str, *, folder: Path | None = None, trust: bool = False) -> Iterator[EpisodeRerun]:
    """Return a context in which an episode can run again, with the files that it holds.

    Args:
        path: the episode, which is not a branch.
        folder, trust: see :func:`crowdbot.recording.replay`.

    Raises:
        EpisodeError: the file cannot be read, is a branch, or a file of its trial is missing or not trusted.

    >>> from crowdbot.models import ORCA
    >>> from crowdbot.recording import record
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as out:
    ...     summary = record(Trial(name="empty", duration=1.0, crowd=ORCA()), out=out)
    ...     with open_rerun(f"{out}/episode.mcap") as rerun:
    ...         rerun.trial.name, rerun.seed
    ('empty', 0)
    """
    path = Path(path)
    with unpack_attachments(path, read_metadata(path), folder, trust) as place:
        provenance = Provenance.of(path, place.folder, trust)
        if len(provenance.parts) > 1:
            raise EpisodeError(f"{path} is a branch; render the episode from which it was made")
        (part,) = provenance.parts
        yield EpisodeRerun(
            part.trial, part.seed, (OrderReplay(part.orders),), lambda one: replay_decisions(one, part.orders)
        )
