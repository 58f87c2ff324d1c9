"""Branch: go on from an instant of a recorded episode, with the same or with other values."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from crowdbot.core import EpisodeError, InputError
from crowdbot.simulation import (
    Digest,
    Episode,
    Log,
    Simulation,
    Sink,
    Stop,
    Summary,
    Tally,
    changed,
    drive,
    stopping,
    target,
    turn_to,
)
from crowdbot.trials import Trial

from .attachments import unpacked
from .episode_reader import read_metadata
from .provenance import Comparison, Course, Part, digests

__all__ = ["branch", "branched"]

Progress = Callable[[float], None]


def branch(
    path: Path | str,
    at: float,
    *,
    seed: int | None = None,
    changes: Mapping[str, Any] | None = None,
    trial: Trial | None = None,
    out: Path | str | None = None,
    folder: Path | None = None,
    trust: bool = False,
    progress: Progress | None = None,
) -> Summary:
    """Go on from an instant of a recorded episode, with other values, and record what follows.

    The trial is run again, without recording, up to the instant, and its digest is compared with the recorded one at
    every instant on the way. So a branch begins in exactly the state of then, everything that people, sensors and
    random numbers remember included; it costs the time that the run itself needs up to there. What is recorded begins
    at the instant. With no changes every message, and the digest at the end, is the same as in the original.

    Args:
        path: of the episode; it may be a branch itself, or a run that was killed.
        at: a recorded instant [s].
        seed: for new chance from then on; None: chance goes on.
        changes: other values by path; see :func:`crowdbot.simulation.overrides.changed`. They apply from the next step.
        trial: the trial to go on by, instead of ``changes``.
        out: file to record to, or a folder for ``episode.mcap``.
        folder, trust: as of :func:`replay`.
        progress: called with the share that is done, 0 to 1.

    Raises:
        EpisodeError: the file cannot be read, has no such instant, or does not replay to the same bytes.
        InputError: something is changed that only counts at the beginning.
    """
    source = Path(path)
    if out is not None and target(out).exists() and target(out).resolve() == source.resolve():
        raise InputError(f"{source} is the episode to branch from; record the branch to another place")
    with unpacked(source, read_metadata(source), folder, trust) as place:
        course = Course.of(source, place.folder, trust)
        wanted = digests(source)
        tally, outcome, steps = _run(course, at, wanted, seed, changes, trial, out, progress, Tally, str(source))
    summary: Summary = tally.summary(outcome, steps, None if out is None else target(out))
    return summary


def branched(
    episode: Episode, at: float, *, seed: int | None = None, changes: Mapping[str, Any] | None = None,
    trial: Trial | None = None, out: Path | str | None = None,
) -> Episode:  # fmt: skip
    """Go on from an instant of an episode in memory; see :func:`branch`. The episode must not be a branch itself."""
    if episode.times[0] > 0.0:
        raise InputError("this episode is a branch; record the first one and branch from the files")
    course = Course((Part(0, episode.trial, episode.seed),))
    log, outcome, steps = _run(course, at, {}, seed, changes, trial, out, None, Log, f"episode {episode.trial.name!r}")
    after: Episode = log.episode(outcome, steps)
    return after


def _run(
    course: Course,
    at: float,
    wanted: Mapping[int, str],
    seed: int | None,
    changes: Mapping[str, Any] | None,
    trial: Trial | None,
    out: Path | str | None,
    progress: Progress | None,
    kind: type[Any],
    name: str,
) -> tuple[Any, str, int]:
    last = course.parts[-1]
    new = changed(last.trial if trial is None else trial, changes or {})
    if out is not None:
        new.xml()  # say at once when it cannot be recorded
    with stopping() as stop:
        comparison = Comparison(Digest(), dict(wanted))
        simulation = _there(course, at, comparison, stop, progress, name, max(wanted, default=None))
        turn_to(simulation, new, seed)
        _check_period(simulation, new, at)
        part = Part(simulation.tick, new, last.seed if seed is None else int(seed))
        tally = kind(new, part.seed, comparison.digest)
        return tally, *_recorded(simulation, tally, comparison, (*course.parts, part), out, stop, progress)


def _there(
    course: Course,
    at: float,
    comparison: Comparison,
    stop: Stop,
    progress: Progress | None,
    name: str,
    latest: int | None,
) -> Simulation:
    """Return the simulation at the instant to branch from."""
    last = course.parts[-1]
    tick = _tick(last, at, name, latest)
    half = None if progress is None else lambda share: progress(0.5 * share)
    simulation = course.begun(comparison, stop, half, until=tick)
    if comparison.differs is not None:
        raise EpisodeError(
            f"{name} does not replay to the same bytes from {comparison.differs:g} s on, so there is no state to"
            " branch from; crowdbot replay tells the versions"
        )
    return simulation


def _tick(last: Part, at: float, name: str, latest: int | None) -> int:
    """Return the tick of an instant; ``latest`` is the last one that was recorded [ns]."""
    period, step = round(last.trial.recording.period * 1e9), round(last.trial.step * 1e9)
    nanoseconds = round(at * 1e9)
    first, end = last.tick * step, last.trial.ticks * step
    end = end if latest is None else max(first, min(end, latest))
    if not first <= nanoseconds <= end:
        raise EpisodeError(f"{name} has no instant at {at:g} s; it lasts from {first / 1e9:g} s to {end / 1e9:g} s")
    if nanoseconds % period:
        near = round(nanoseconds / period) * period / 1e9
        raise EpisodeError(
            f"{name} has no instant at {at:g} s: it was recorded every {period / 1e9:g} s; the nearest is {near:g} s"
        )
    return nanoseconds // step


def _check_period(simulation: Simulation, new: Trial, at: float) -> None:
    if simulation.tick % simulation.world.clock.every(new.recording.period):
        raise InputError(f"a recording period of {new.recording.period:g} s has no instant at {at:g} s")


def _recorded(
    simulation: Simulation,
    tally: Any,
    comparison: Comparison,
    parts: tuple[Part, ...],
    out: Path | str | None,
    stop: Stop,
    progress: Progress | None,
) -> tuple[str, int]:
    """Record the instant itself and everything after; return outcome and steps."""
    frame = comparison.latest
    assert frame is not None
    tally.keep(frame)
    rest = None if progress is None else lambda share: progress(0.5 + 0.5 * share)
    sinks: list[Sink] = [tally]
    if out is None:
        return drive(simulation, sinks, stop, rest), simulation.tick
    from .episode_writer import Recorder

    course, earlier = Course(parts), [part.trial for part in parts[:-1]]
    with Recorder(target(out), tally, course.origin, begin=parts[-1].tick, earlier=earlier) as recorder:
        recorder.take(frame)
        outcome = drive(simulation, [tally, recorder], stop, rest)
        recorder.complete(outcome, simulation.tick)
    return outcome, simulation.tick
