"""Ranges of the crowd models: densities at which they walk like people, and time steps for which they are made."""

from __future__ import annotations

from typing import NamedTuple

from crowdbot.core import kebab_case
from crowdbot.models import CrowdModel
from crowdbot.trials.crowd import Crowds
from crowdbot.trials.randomized_model import RandomizedModel
from crowdbot.trials.trial import Trial

STEP_TOLERANCE = 1e-9
FREE = "no fundamental diagram: its speed is within 10 % of Weidmann's curve up to 0.7 people/m2 only"
SLOW = "a one-way crowd of 0.25 people/m2 walks at 0.7 m/s"
JAMS = "two-way crowds jam or hardly move at higher densities"


class ModelRange(NamedTuple):
    """Range of a crowd model at its defaults.

    Fields:
        model: name of the model.
        max_density: largest density [1/m2].
        why: what happens beyond it.
        max_step: largest time step of the crowd [s].
        density_source, step_source: where the limits come from.
    """

    model: str
    max_density: float
    why: str
    max_step: float
    density_source: str
    step_source: str


PAGE = "crowdbot validate, corridor"
TWO_WAY = "crowdbot validate, lanes and narrow two-way"
JUPEDSIM = "JuPedSim 1.4.2, default time step"
UMANS = "UMANS, time step of its examples"
HEADWAY = "Walking speed and density in the documentation"
SUBSTEPS = "the model divides longer steps into substeps of 0.01 s"
MODEL_RANGES = (
    ModelRange("anticipation-velocity", 0.5, JAMS, 0.01, TWO_WAY, JUPEDSIM),
    ModelRange("boids", 0.7, FREE, 0.1, PAGE, "CrowdBot simulator"),
    ModelRange("collision-free-speed", 3.0, JAMS, 0.01, PAGE, JUPEDSIM),
    ModelRange("collision-free-speed-v3", 0.5, JAMS, 0.01, TWO_WAY, JUPEDSIM),
    ModelRange("cost-model", 0.7, FREE, 0.1, PAGE, UMANS),
    ModelRange("escape-panic", 0.7, FREE, 0.1, PAGE, SUBSTEPS),
    ModelRange("generalized-centrifugal-force", 0.1, SLOW, 0.01, PAGE, JUPEDSIM),
    ModelRange("group-force", 0.7, FREE, 0.1, PAGE, "PySocialForce tests"),
    ModelRange("headed-social-force", 0.7, FREE, 0.02, PAGE, "contact forces of an explicit step"),
    ModelRange("heuristics", 0.5, JAMS, 0.1, TWO_WAY, UMANS),
    ModelRange("orca", 0.7, FREE, 0.25, PAGE, "RVO2, time step of its examples"),
    ModelRange("people", 2.0, "narrow two-way corridors are slower than in experiments", 0.05, HEADWAY, HEADWAY),
    ModelRange("pledestrians", 0.7, FREE, 0.1, PAGE, UMANS),
    ModelRange("power-law", 0.5, JAMS, 0.1, TWO_WAY, UMANS),
    ModelRange("social-force", 0.5, "lanes do not form and people are pushed through walls", 0.1, TWO_WAY, UMANS),
    ModelRange("tangent", 0.5, JAMS, 0.1, TWO_WAY, "CrowdBot simulator"),
    ModelRange("vbm", 0.25, JAMS, 0.1, TWO_WAY, "CrowdBot simulator"),
    ModelRange("vog", 0.7, FREE, 0.1, PAGE, "CrowdBot simulator"),
    ModelRange("warp-driver", 0.7, FREE, 0.01, PAGE, JUPEDSIM),
)
"""Ranges of the built-in models; a model that is missing has no known range."""


def model_range(model: CrowdModel) -> ModelRange | None:
    """Return the range of a model, None if it is not known.

    >>> from crowdbot.models import CollisionFreeSpeed
    >>> model_range(CollisionFreeSpeed()).max_step
    0.01
    """
    if isinstance(model, RandomizedModel):
        return model_range(model.model)
    name = kebab_case(type(model).__name__)
    here = type(model).__module__.startswith("crowdbot.models.")
    return next((item for item in MODEL_RANGES if here and item.model == name), None)


def range_remarks(trial: Trial) -> list[str]:
    """Return a sentence for every limit of a crowd model that a trial exceeds.

    The density is the number of people at the start over the walkable area; trials without walkable area have none.

    >>> from crowdbot.models import CollisionFreeSpeed
    >>> range_remarks(Trial(name="t", duration=1, crowd=CollisionFreeSpeed(), step=0.05, substeps=5))
    []
    """
    models = trial.crowd.models if isinstance(trial.crowd, Crowds) else (trial.crowd,)
    ranges = {item.model: item for item in map(model_range, models) if item is not None}
    density, step = start_density(trial), trial.step / trial.substeps
    result = []
    for bounds in ranges.values():
        if density > bounds.max_density:
            result.append(
                f"crowd model {bounds.model} is used at {density:.2g} people/m2, beyond its range of"
                f" {bounds.max_density:g}: {bounds.why} ({bounds.density_source})"
            )
        if step > bounds.max_step + STEP_TOLERANCE:
            result.append(
                f"crowd model {bounds.model} is used with a time step of {step:g} s, beyond its range of"
                f' {bounds.max_step:g} s ({bounds.step_source}); write substeps="{_substeps(trial, bounds)}"'
            )
    return result


def start_density(trial: Trial) -> float:
    """Return the people at the start per walkable area [1/m2], 0 if the stage has no walkable area."""
    stage = trial.stage
    if not stage.bounded:
        return 0.0
    ground = stage.shapes[1].area
    return float((len(trial.agents) + sum(spawner.count for spawner in trial.spawners)) / ground)


def _substeps(trial: Trial, one: ModelRange) -> int:
    return next(n for n in range(1, 10_001) if trial.step / n <= one.max_step + STEP_TOLERANCE or n == 10_000)
