"""Branch: continue a recorded episode from a given time, with the same or with changed values."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, overload

from crowdbot.core import EpisodeError, FreeClock, InputError
from crowdbot.simulation import (
    Episode,
    EpisodeDigest,
    EpisodeLog,
    EpisodeStatistics,
    RunSummary,
    Simulation,
    Sink,
    StopRequest,
    apply_overrides,
    catch_interrupt,
    run_to_end,
    warn_of_failure,
)
from crowdbot.trials import Trial, apply_values, trial_xml

from .attachments import unpack_attachments
from .episode_reader import RecordedEpisode, read_metadata
from .episode_writer import Recorder
from .provenance import DigestComparison, OrderReplay, Provenance, ProvenanceSegment, digests, replay_decisions
from .recorded_run import episode_path
from .recorded_simulation import continue_from, simulate_to

Progress = Callable[[float], None]

TOLERANCE = 1000
"""Largest difference [ns] between the time of a branch and a recorded instant."""


@dataclass(frozen=True)
class _Options:
    """Changes of a branch, and where it is recorded."""

    seed: int | None
    changes: Mapping[str, Any]
    trial: Trial | None
    out: Path | str | None
    force: bool
    progress: Progress | None
    orders: bool
    keyframes: bool = True


@overload
def branch(
    source: Episode, at: float, *, seed: int | None = None, changes: Mapping[str, Any] | None = None,
    trial: Trial | None = None, out: Path | str | None = None, force: bool = False, progress: Progress | None = None,
    orders: bool = True,
) -> Episode: ...  # fmt: skip
@overload
def branch(
    source: Path | str | RecordedEpisode, at: float, *, seed: int | None = None,
    changes: Mapping[str, Any] | None = None, trial: Trial | None = None, out: Path | str | None = None,
    force: bool = False, folder: Path | None = None, trust: bool = False,
    progress: Progress | None = None, orders: bool = True, keyframes: bool = True,
) -> RunSummary: ...  # fmt: skip
def branch(
    source: Path | str | RecordedEpisode | Episode,
    at: float,
    *,
    seed: int | None = None,
    changes: Mapping[str, Any] | None = None,
    trial: Trial | None = None,
    out: Path | str | None = None,
    force: bool = False,
    folder: Path | None = None,
    trust: bool = False,
    progress: Progress | None = None,
    orders: bool = True,
    keyframes: bool = True,
) -> RunSummary | Episode:
    """Continue an episode from a recorded step, with the same or with changed values.

    The trial is simulated again without recording up to that step, and its digest is compared at each recorded step. A
    branch therefore starts in exactly the recorded state, including the internal states of people, sensors and random
    streams. It continues from the latest keyframe before that step (every 5 s); a file without keyframes, or of another
    version, is simulated from its beginning. Without changes, all messages and the final digest equal those of
    the original.

    Args:
        source: an episode file (also a branch or an incomplete file), or an episode in memory.
        at: time of a recorded step [s].
        seed: seed of new random streams; None continues the old ones.
        changes: changed values by path, see :class:`crowdbot.trials.Sweep`; they apply from the next step on.
        trial: the trial to continue with; ``changes`` apply to it.
        out: file to record to, or a folder for ``episode.mcap``.
        force: whether an existing file may be overwritten.
        folder, trust: see :func:`replay`; for files only.
        progress: called with the completed fraction, 0 to 1.
        orders: whether the recorded orders from outside after that step apply again.
        keyframes: whether to start from a keyframe; the result is the same. For files only.

    Returns:
        An :class:`Episode` for an episode in memory, otherwise a :class:`RunSummary`.

    Raises:
        EpisodeError: the file cannot be read, has no such step, or does not replay with the same digest.
        InputError: a changed value only affects the start.

    Warns:
        KeyframeWarning: a keyframe is damaged, and the file is simulated from its beginning.

    >>> from crowdbot.models import ORCA
    >>> from crowdbot.simulation import simulate
    >>> episode = simulate(Trial(name="empty", duration=2.0, crowd=ORCA()))
    >>> later = branch(episode, at=1.5, changes={"duration": 3})
    >>> float(later.times[0]), float(later.times[-1]), branch(episode, at=1.0).digest == episode.digest
    (1.5, 3.0, True)
    """
    options = _Options(seed, changes or {}, trial, out, force, progress, orders, keyframes)
    if isinstance(source, Episode):
        return _branch_of_episode(source, at, options)
    path = source.path if isinstance(source, RecordedEpisode) else Path(source)
    return _branch_of_file(path, at, folder, trust, options)


def _branch_of_file(source: Path, at: float, folder: Path | None, trust: bool, options: _Options) -> RunSummary:
    out = options.out
    if out is not None and episode_path(out).exists() and episode_path(out).resolve() == source.resolve():
        raise InputError(f"{source} is the source of the branch; record the branch to another file")
    with unpack_attachments(source, read_metadata(source), folder, trust) as place:
        course = Provenance.of(source, place.folder, trust)
        tally, outcome, simulation = _run(course, at, digests(source), options, EpisodeStatistics, str(source), source)
    warn_of_failure(simulation)
    written = None if out is None else episode_path(out)
    summary: RunSummary = tally.summary(outcome, simulation.tick, written, simulation.failures[0])
    return summary


def _branch_of_episode(episode: Episode, at: float, options: _Options) -> Episode:
    if episode.times[0] > 0.0:
        raise InputError("this episode is a branch; record the original to a file and branch from that")
    course = Provenance((ProvenanceSegment(0, episode.trial, episode.seed, episode.orders),))
    log, outcome, simulation = _run(course, at, {}, options, EpisodeLog, f"episode {episode.trial.name!r}")
    warn_of_failure(simulation)
    after: Episode = log.episode(outcome, simulation.tick, simulation.failures[0])
    return after


def _run(
    course: Provenance,
    at: float,
    wanted: Mapping[int, str],
    options: _Options,
    kind: type[Any],
    name: str,
    source: Path | None = None,
) -> tuple[Any, str, Simulation]:
    last = course.parts[-1]
    old = last.trial if options.trial is None else options.trial
    new = apply_values(old, options.changes, place=f"trial {old.name!r} with changes")
    if options.out is not None:
        trial_xml(new)  # raises if the trial cannot be recorded
    with catch_interrupt() as stop:
        comparison = DigestComparison(EpisodeDigest({}), dict(wanted))
        simulation = _there(course, at, comparison, stop, options, name, source)
        if options.trial is None:  # orders may have changed the trial
            new = apply_values(simulation.trial, options.changes, place=f"trial {old.name!r} with changes")
        apply_overrides(simulation, new, options.seed)
        _check_period(simulation, new, at)
        rest = tuple(row for row in last.orders if row[0] >= simulation.tick) if options.orders else ()
        if not options.orders:
            replay_decisions(simulation, None)
        part = ProvenanceSegment(simulation.tick, new, last.seed if options.seed is None else int(options.seed), rest)
        robots = simulation.world.ids[0, [control.agent for control in simulation.robots]].tolist()
        tally = kind(new, part.seed, comparison.digest, robots)
        parts = (*course.parts, part)
        return tally, _record(simulation, tally, comparison, parts, options, stop), simulation


def _there(
    course: Provenance,
    at: float,
    comparison: DigestComparison,
    stop: StopRequest,
    options: _Options,
    name: str,
    source: Path | None,
) -> Simulation:
    """Return the simulation at the step to branch from."""
    last, progress = course.parts[-1], options.progress
    tick = _tick(last, at, name, max(comparison.wanted, default=None))
    half = None if progress is None else lambda share: progress(0.5 * share)
    begin = None
    if source is not None and options.keyframes:  # the record of the step itself needs the step before it
        begin = continue_from(source, course, read_metadata(source), tick - 1, comparison)
    simulation = simulate_to(tick, course, comparison, begin, name, stop, half)
    if comparison.differs is not None:
        raise EpisodeError(
            f"{name} differs from its replay from {comparison.differs:g} s on, so it cannot be branched;"
            " crowdbot replay compares the versions"
        )
    return simulation


def _tick(last: ProvenanceSegment, at: float, name: str, latest: int | None) -> int:
    """Return the tick of a time; ``latest`` is the last recorded time [ns]."""
    clock = FreeClock(last.trial.step)
    step, nanoseconds = clock.step_ns, round(at * 1e9)
    first, end = last.tick * step, last.trial.ticks * step
    end = end if latest is None else max(first, min(end, latest))
    if not first - TOLERANCE <= nanoseconds <= end + TOLERANCE:
        raise EpisodeError(f"{name} has no step at {at:g} s; it lasts from {first / 1e9:g} s to {end / 1e9:g} s")
    schedule = clock.schedule(last.trial.recording.period)
    tick = (nanoseconds + step // 2) // step
    if abs(tick * step - nanoseconds) > TOLERANCE or not schedule.is_due(tick):
        recorded = (schedule.tick_of(schedule.index(tick) + k) * step for k in (0, 1))
        near = min(recorded, key=lambda time: abs(time - nanoseconds)) / 1e9
        raise EpisodeError(
            f"{name} has no step at {at:g} s: it was recorded every {last.trial.recording.period:g} s; the nearest is"
            f" {near:.9g} s"
        )
    return tick


def _check_period(simulation: Simulation, new: Trial, at: float) -> None:
    if not simulation.world.clock.schedule(new.recording.period).is_due(simulation.tick):
        raise InputError(f"a recording period of {new.recording.period:g} s has no step at {at:g} s")


def _record(
    simulation: Simulation,
    tally: Any,
    comparison: DigestComparison,
    parts: tuple[ProvenanceSegment, ...],
    options: _Options,
    stop: StopRequest,
) -> str:
    """Record the current step and all following ones; return the outcome."""
    out, progress = options.out, options.progress
    frame = comparison.latest
    assert frame is not None
    tally.keep(frame)
    rest = None if progress is None else lambda share: progress(0.5 + 0.5 * share)
    sinks: list[Sink] = [tally]
    steering = [OrderReplay(parts[-1].orders)]
    if out is None:
        return run_to_end(simulation, sinks, stop, rest, sources=steering)
    course, earlier = Provenance(parts), [part.trial for part in parts[:-1]]
    with Recorder(
        episode_path(out),
        tally,
        course.origin,
        begin=parts[-1].tick,
        earlier=earlier,
        force=options.force,
        simulation=simulation,
    ) as recorder:
        recorder.take(frame)
        outcome = run_to_end(simulation, [tally, recorder], stop, rest, sources=steering)
        recorder.complete(outcome, simulation.tick, simulation.failures[0])
    return outcome
