"""The kinds of experiments that can be analysed and rehearsed."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

from crowdbot.core import UnknownName

from .comparison import SETTLING, EmulatedPerson, Study, StudyAnalysis, analyse_study, experiment_of
from .crossing import CrossingStudy
from .encounters import EncounterStudy
from .experiment import Experiment
from .leader_follower import LeaderFollowerStudy

STUDIES: Mapping[str, Study] = {
    study.name: study for study in (LeaderFollowerStudy(), CrossingStudy(), EncounterStudy())
}
"""Kinds of experiments, by the attribute ``analysis`` of the experiment."""
DEFAULT = LeaderFollowerStudy.name
"""Kind of an experiment that does not say it."""


def study_of(experiment: Experiment, name: str = "") -> Study:
    """Return the kind of an experiment: the named one, that of the experiment, or ``leader-follower``.

    Raises:
        UnknownName: there is no such kind.

    >>> from crowdbot.experiments import load_experiment
    >>> study_of(load_experiment("crossing")).title
    'Crossing the way of a robot'
    """
    chosen = name or experiment.analysis or DEFAULT
    if chosen not in STUDIES:
        raise UnknownName("analysis", chosen, STUDIES)
    return STUDIES[chosen]


def emulated_participant(experiment: Experiment, participant: int) -> EmulatedPerson:
    """Return the program that takes the place of a participant in a rehearsal of an experiment."""
    return study_of(experiment).participant(participant)


def analyse_sessions(
    folder: Path | str,
    *,
    analysis: str = "",
    bounds: Mapping[str, float] | None = None,
    settling: float = SETTLING,
) -> StudyAnalysis:
    """Analyse the recorded trials of all participants; see :class:`StudyAnalysis`.

    The names of the trials in the experiment are the conditions. Repetitions of a participant are averaged for the
    tests. Trials without an episode, or of another kind, are kept with the reason.

    Args:
        folder: output folder of the sessions.
        analysis: kind of the experiment (default: that of the experiment).
        bounds: largest differences that count as equivalent, by measure; default: those of the measures.
        settling: time at the start of each trial that is left out of steady motions [s].

    Raises:
        EpisodeError: there is no session, or one is damaged.
        InputError: a bound is not that of a measure, or not above 0.
        UnknownName: there is no such kind.
    """
    return analyse_study(folder, study_of(experiment_of(folder), analysis), bounds=bounds, settling=settling)
