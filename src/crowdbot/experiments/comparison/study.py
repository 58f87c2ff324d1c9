"""Study: a kind of experiment with its measures, its plot and its emulated participant."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple, Protocol

from crowdbot.recording import RecordedEpisode
from crowdbot.simulation import OrderSource
from crowdbot.trials import Trial
from crowdbot.typing import Floats

if TYPE_CHECKING:
    from matplotlib.figure import Figure


COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#56b4e9", "#e69f00")
"""Colours of the conditions (Okabe, Ito)."""


@dataclass(frozen=True)
class Measure:
    """A column of the analysis.

    Fields:
        title: name with the unit.
        bound: default largest difference that counts as equivalent. The bounds are choices, not findings: about the
            smallest difference that an observer of the two would notice.
        binary: whether a trial has the value 0 or 1, such as a collision; the means are then shares of the trials.
        compared: whether the conditions are tested against each other; not so for what describes the apparatus.
    """

    title: str
    bound: float
    binary: bool = False
    compared: bool = True


class RecordedTrial(NamedTuple):
    """A recorded trial of one participant.

    Fields:
        trial: the trial of the episode.
        episode: what was recorded.
        folder: folder of the trial; streams of the session are beside it.
        settling: time at the start that is left out of steady motions [s].
    """

    trial: Trial
    episode: RecordedEpisode
    folder: Path
    settling: float


@dataclass(frozen=True, eq=False)
class TrialMeasures:
    """One trial of one participant.

    Fields:
        participant: number.
        condition: name of the trial in the experiment.
        values: measures by name, NaN where one is not known; empty with a ``reason``.
        reason: why there are none.
        labels: texts about the trial, such as who leads.
        curves: arrays for the plot of the study.
    """

    participant: int
    condition: str
    values: Mapping[str, float]
    reason: str = ""
    labels: Mapping[str, str] = field(default_factory=dict)
    curves: Mapping[str, Floats] = field(default_factory=dict)

    def record(self) -> dict[str, Any]:
        """Return the values as a row of a table."""
        head = {"participant": self.participant, "condition": self.condition}
        return {**head, **self.labels, **self.values, "reason": self.reason}


class EmulatedPerson(Protocol):
    """A program that takes the place of a participant in the trials of a study."""

    def source(self, trial: Trial) -> OrderSource:
        """Return the source of the orders of a run of the trial; it raises InputError for another kind of trial."""


class Study(ABC):
    """Contract of the kinds of experiments that ``crowdbot experiment analyse`` knows.

    Attributes:
        name: name in the attribute ``analysis`` of an experiment.
        title: heading of the report.
        measures: what is compared between the conditions, by name.
        about: what the plot of the trials shows, HTML.
    """

    name: ClassVar[str]
    title: ClassVar[str]
    measures: ClassVar[Mapping[str, Measure]]
    about: ClassVar[str]

    @abstractmethod
    def evaluate(self, recorded: RecordedTrial) -> tuple[dict[str, float], dict[str, str], dict[str, Floats]]:
        """Return measures, labels and curves of a trial, see :class:`TrialMeasures`.

        Raises:
            InputError: it is a trial of another kind.
        """

    @abstractmethod
    def draw(self, trials: Sequence[TrialMeasures]) -> Figure:
        """Return a plot of trials, at least one, all with results."""

    @abstractmethod
    def participant(self, number: int) -> EmulatedPerson:
        """Return the emulated participant of a number."""
