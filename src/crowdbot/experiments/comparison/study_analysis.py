"""Analysis of a study: measures of trials, latencies, and paired tests of conditions."""

from __future__ import annotations

import itertools
import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.core import CrowdbotError, EpisodeError, InputError, explain_write_errors
from crowdbot.experiments.emulation import participant_agent
from crowdbot.experiments.experiment import Experiment
from crowdbot.experiments.parser import parse_experiment
from crowdbot.experiments.question import Scale
from crowdbot.experiments.session_folder import COPY, folder_of
from crowdbot.experiments.session_summary import summary
from crowdbot.metrics import correct_p_values
from crowdbot.recording import read_episode
from crowdbot.trials import Avatar, parse_trial, read_trial_bytes

from .study import Measure, RecordedTrial, Study, TrialMeasures, looking_shares


class PairedTest(NamedTuple):
    """The difference of two conditions, second minus first, within participants.

    Fields:
        participants: number of participants with both conditions.
        difference: mean difference.
        low, high: 95 % confidence interval of the difference.
        p_value: of the paired t-test, or of the sign test for shares; two-sided.
        effect: Cohen's d_z, the mean in relation to the standard deviation of the differences.
        bound: largest difference that counts as equivalent.
        equivalence: p-value of the two one-sided tests; below 0.05 the conditions are equivalent within the bound.
    """

    participants: int
    difference: float
    low: float
    high: float
    p_value: float
    effect: float
    bound: float
    equivalence: float

    @property
    def equivalent(self) -> bool:
        """Whether the difference is smaller than the bound, at a level of 5 %."""
        return self.equivalence < 0.05


def paired_test(first: ArrayLike, second: ArrayLike, bound: float, *, binary: bool = False) -> PairedTest:
    """Compare two conditions of the same participants.

    Pairs with a value that is not finite are left out. With fewer than 3 pairs, or no spread of the differences, only
    the mean is known. Shares of binary outcomes get the exact sign test over the participants who differ, which is the
    exact test of McNemar for one trial in each condition; the normal approximation of the interval and of the
    equivalence needs many participants.

    Source: Lakens (2013), Calculating and reporting effect sizes, doi 10.3389/fpsyg.2013.00863; Schuirmann (1987), A
    comparison of the two one-sided tests procedure, doi 10.1007/BF01068419; McNemar (1947), doi 10.1007/BF02295996.

    Args:
        first, second: ``[N]`` values of N participants.
        bound: largest difference that counts as equivalent, above 0.
        binary: whether the values are shares of binary outcomes.

    Raises:
        InputError: the shapes differ, or the bound is not above 0.

    >>> test = paired_test([1.0, 1.2, 0.9, 1.1, 1.0], [1.1, 1.25, 1.05, 1.1, 1.1], bound=0.3)
    >>> test.participants, round(test.difference, 3), round(test.effect, 2), test.equivalent
    (5, 0.08, 1.4, True)
    """
    one, other = np.asarray(first, dtype=np.float64), np.asarray(second, dtype=np.float64)
    if one.ndim != 1 or one.shape != other.shape:
        raise InputError(f"the values have the shapes {one.shape} and {other.shape}; both must be [N]")
    if not bound > 0.0:
        raise InputError(f"bound = {bound} must be above 0")
    gap = (other - one)[np.isfinite(one) & np.isfinite(other)]
    count, mean = len(gap), float(gap.mean()) if len(gap) else math.nan
    spread = float(gap.std(ddof=1)) if count > 2 else 0.0
    if spread == 0.0:
        return PairedTest(count, mean, math.nan, math.nan, math.nan, math.nan, bound, math.nan)
    from scipy import stats  # takes longer to import than the app to start

    error, law = spread / math.sqrt(count), stats.t(count - 1)
    half = float(law.ppf(0.975)) * error
    p_value = _sign_test(gap) if binary else 2.0 * float(law.sf(abs(mean) / error))
    equivalence = max(float(law.sf((mean + bound) / error)), float(law.sf((bound - mean) / error)))
    return PairedTest(count, mean, mean - half, mean + half, p_value, mean / spread, bound, equivalence)


def _sign_test(gap: NDArray[np.float64]) -> float:
    """Return the two-sided p-value of the exact sign test; pairs without a difference do not count."""
    from scipy import stats

    up, down = int((gap > 0.0).sum()), int((gap < 0.0).sum())
    return float(stats.binomtest(up, up + down, 0.5).pvalue) if up + down else 1.0


LATENCY_FILE = "latency.json"


class TrialLatency(NamedTuple):
    """Latencies of a trial [s] with all added delays; None: unknown.

    Fields:
        motion, motion_p95: age of the pose of the participant when a step of the simulation uses it: median, and 95th
            percentile.
        picture, picture_p95: age of a state of the simulation when the headset begins to draw it.
        dropped: pictures that were not drawn in time.
        lost: messages of the headset that did not arrive.
    """

    motion: float | None = None
    motion_p95: float | None = None
    picture: float | None = None
    picture_p95: float | None = None
    dropped: int = 0
    lost: int = 0


def write_trial_latency(folder: Path, latencies: Mapping[str, TrialLatency]) -> None:
    """Write latencies by the names of the avatars to the folder of a trial.

    Raises:
        InputError: the file cannot be written.
    """
    text = json.dumps({name: latency._asdict() for name, latency in latencies.items()}, indent=1, allow_nan=False)
    with explain_write_errors(folder / LATENCY_FILE):
        (folder / LATENCY_FILE).write_text(text + "\n", encoding="utf-8")


def read_trial_latency(folder: Path, avatar: Avatar) -> TrialLatency:
    """Return the latencies of the participant who moved an avatar in a trial.

    Without a headset, the motion is as late as the ``delay`` of the avatar, and the picture is reality.

    Raises:
        InputError: the file is damaged.

    >>> read_trial_latency(Path("nowhere"), Avatar(name="guest", source="external", x=0, y=0, delay=0.08)).motion
    0.08
    """
    path = folder / LATENCY_FILE
    if not path.is_file():
        return TrialLatency(avatar.delay, avatar.delay, 0.0, 0.0)
    try:
        given = json.loads(path.read_text(encoding="utf-8")).get(avatar.name)
        if given is None:
            return TrialLatency(avatar.delay, avatar.delay, 0.0, 0.0)
        numbers = [given[name] for name in TrialLatency._fields]
    except (OSError, ValueError, AttributeError, KeyError, TypeError) as error:
        raise InputError(f"{path} is damaged: {error!r}; delete it to analyse the trial without latencies") from None
    if not all(number is None or (isinstance(number, int | float) and math.isfinite(number)) for number in numbers):
        raise InputError(f"{path} is damaged: a latency is not a finite number")
    return TrialLatency(*numbers)


SETTLING = 2.0
"""Time at the start of a trial that is left out of steady motions [s]."""
LOOKING: Mapping[str, Measure] = {
    "looking": Measure("share of time looking at the robot [1]", 0.1),
    "looking_visible": Measure("share of time looking at the robot, not hidden [1]", 0.1),
}
"""Measures of all studies, from the recorded directions of head or gaze."""
LATENCY: Mapping[str, Measure] = {
    "motion_latency": Measure("age of the participant's pose in the simulation, median [s]", 0.01, compared=False),
    "picture_latency": Measure("age of the state in the headset, median [s]", 0.01, compared=False),
}
"""Measured latencies of the headset, with all added delays."""
RATING_BOUND = 0.1
"""Bound of equivalence of a rating, as a part of the range of its scale."""


@dataclass(frozen=True)
class ConditionTest:
    """A measure in two conditions; ``corrected`` is the p-value after the correction of Holm over all tests."""

    measure: str
    first: str
    second: str
    test: PairedTest
    corrected: float

    def record(self) -> dict[str, Any]:
        """Return the values as a row of a table."""
        head = {"measure": self.measure, "first": self.first, "second": self.second}
        return {**head, **self.test._asdict(), "corrected": self.corrected}


@dataclass(frozen=True)
class StudyAnalysis:
    """All trials of all participants, and the paired tests between the conditions.

    Fields:
        study: kind of the experiment.
        measures: measures that are compared, with ratings as ``screen.question``.
        trials: the trials that ran.
        tests: a test for each measure and two conditions.
    """

    study: Study
    measures: Mapping[str, Measure]
    trials: tuple[TrialMeasures, ...]
    tests: tuple[ConditionTest, ...] = ()

    @property
    def conditions(self) -> tuple[str, ...]:
        """Names of the conditions in their first order."""
        return tuple(dict.fromkeys(trial.condition for trial in self.trials))

    @property
    def finite_measures(self) -> dict[str, Measure]:
        """The measures that are known in a trial."""
        known = {name for trial in self.trials for name, value in trial.values.items() if math.isfinite(value)}
        return {name: measure for name, measure in self.measures.items() if name in known}

    def values(self, measure: str, condition: str) -> dict[int, float]:
        """Return the mean of a measure in a condition by participant; trials in which it is unknown do not count."""
        found: dict[int, list[float]] = {}
        for trial in self.trials:
            value = trial.values.get(measure, math.nan)
            if trial.condition == condition and math.isfinite(value):
                found.setdefault(trial.participant, []).append(value)
        return {who: float(np.mean(values)) for who, values in found.items()}


def analyse_study(
    folder: Path | str, study: Study, *, bounds: Mapping[str, float] | None = None, settling: float = SETTLING
) -> StudyAnalysis:
    """Analyse the recorded trials of all participants.

    The names of the trials in the experiment are the conditions. Repetitions of a participant are averaged for the
    tests. Trials without an episode, or of another kind, are kept with the reason.

    Args:
        folder: output folder of the sessions.
        study: kind of the experiment.
        bounds: largest differences that count as equivalent, by measure.
        settling: time at the start of each trial that is left out of steady motions [s].

    Raises:
        EpisodeError: there is no session, or one is damaged.
        InputError: a bound is not that of a measure, or not above 0.
    """
    everything = summary(folder)
    ratings = rating_measures(experiment_of(folder))
    measures = {**study.measures, **LOOKING, **ratings, **LATENCY}
    limits = _checked({name: measure.bound for name, measure in measures.items() if measure.compared}, bounds or {})
    rows = [row for row in everything if row["outcome"] != "not run"]
    trials = tuple(_measured(Path(folder), row, study, settling, ratings) for row in rows)
    study_analysis = StudyAnalysis(study, measures, trials)
    return StudyAnalysis(study, measures, trials, _tests(study_analysis, limits))


def experiment_of(folder: Path | str) -> Experiment:
    """Return the experiment of the first session in a folder.

    Raises:
        EpisodeError: there is no session.
        TrialError: the copy of the experiment is damaged.
    """
    home = Path(folder)
    copies = [home / COPY] if (home / COPY).is_file() else sorted(home.glob(f"*/{COPY}"))
    if not copies:
        raise EpisodeError(f"{folder} contains no sessions; give the output folder of 'experiment run' (--out)")
    return parse_experiment(read_trial_bytes(copies[0]), place=str(copies[0]), folder=copies[0].parent, whole=False)


def rating_measures(experiment: Experiment) -> dict[str, Measure]:
    """Return the scales that are asked after trials as measures, by ``screen.question``.

    >>> from crowdbot.experiments import load_experiment
    >>> list(rating_measures(load_experiment("robot-speed")))
    ['opinion.comfort']
    """
    screens = [
        screen for block in experiment.blocks for screen in (*block.after, *(s for t in block.trials for s in t.after))
    ]
    asked = {
        f"{screen.name}.{question.name}": question
        for screen in screens
        for question in screen.questions
        if isinstance(question, Scale)
    }
    return {
        name: Measure(f"{name} [{item.low} to {item.high}]", RATING_BOUND * (item.high - item.low))
        for name, item in asked.items()
    }


def _checked(limits: dict[str, float], given: Mapping[str, float]) -> dict[str, float]:
    for name, bound in given.items():
        if name not in limits:
            raise InputError(f"there is no measure {name!r}; measures are {', '.join(limits)}")
        if not (math.isfinite(bound) and bound > 0.0):
            raise InputError(f"the bound of {name} = {bound} must be above 0")
    return limits | dict(given)


def _measured(
    folder: Path, row: Mapping[str, Any], study: Study, settling: float, ratings: Mapping[str, Measure]
) -> TrialMeasures:
    who, condition = int(row["participant"]), str(row["trial"])
    home = (folder if (folder / COPY).is_file() else folder_of(folder, who)) / str(row["folder"])
    try:
        if row["outcome"] in ("failed", "running"):
            raise EpisodeError(row["reason"] or "the trial did not end")
        episode = read_episode(home / "episode.mcap")
        recorded = RecordedTrial(parse_trial(episode.xml, place=str(episode.path)), episode, home, settling)
        values, labels, curves = study.evaluate(recorded)
        shares, view = looking_shares(recorded)
        latencies = _latencies(recorded)
    except CrowdbotError as error:
        return TrialMeasures(who, condition, {}, str(error))
    given = {name: float(row[name]) for name in ratings if isinstance(row.get(name), int | float)}
    return TrialMeasures(
        who, condition, {**values, **shares, **given, **latencies}, "", {**labels, "view": view}, curves
    )


def _latencies(recorded: RecordedTrial) -> dict[str, float]:
    """Return the measured latencies of the headset; none without one."""
    if not (recorded.folder / LATENCY_FILE).is_file():
        return {}
    trial_latency = read_trial_latency(recorded.folder, participant_agent(recorded.trial)[0])
    known = {"motion_latency": trial_latency.motion, "picture_latency": trial_latency.picture}
    return {name: value for name, value in known.items() if value is not None}


def _tests(analysis: StudyAnalysis, limits: Mapping[str, float]) -> tuple[ConditionTest, ...]:
    found: list[tuple[str, str, str, PairedTest]] = []
    for measure, (first, second) in itertools.product(limits, itertools.combinations(analysis.conditions, 2)):
        one, other = analysis.values(measure, first), analysis.values(measure, second)
        both = sorted(one.keys() & other.keys())
        if both:
            values = [one[k] for k in both], [other[k] for k in both]
            test = paired_test(*values, limits[measure], binary=analysis.measures[measure].binary)
            found.append((measure, first, second, test))
    corrected: Sequence[float] = correct_p_values([test.p_value for *_, test in found])
    return tuple(ConditionTest(*one, p) for one, p in zip(found, corrected, strict=True))
