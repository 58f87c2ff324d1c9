"""Floor 2: what is measured. Displacement errors of forecasts, and how robots moved among people."""

from .contacts import ContactEvent, cause_of, contact_events
from .displacement import (
    PersonErrors,
    ade,
    best_of,
    collided,
    collision_share,
    distances,
    error_over_horizon,
    fde,
    miss_rate,
    person_errors,
)
from .motion import heading_change, jerk, longest_stall, path_efficiency, path_length, stalled_time
from .navigation import NAVIGATION_METRICS, Outcome, navigation_metrics, outcome
from .proximity import (
    clearance,
    local_density,
    personal_space_compliance,
    proxemic_shares,
    swept_clearance,
    swept_distance,
    time_to_collision,
    wall_clearance,
)
from .score import Score, score

__all__ = [
    "NAVIGATION_METRICS",
    "ContactEvent",
    "Outcome",
    "PersonErrors",
    "Score",
    "ade",
    "best_of",
    "cause_of",
    "clearance",
    "collided",
    "collision_share",
    "contact_events",
    "distances",
    "error_over_horizon",
    "fde",
    "heading_change",
    "jerk",
    "local_density",
    "longest_stall",
    "miss_rate",
    "navigation_metrics",
    "outcome",
    "path_efficiency",
    "path_length",
    "person_errors",
    "personal_space_compliance",
    "proxemic_shares",
    "score",
    "stalled_time",
    "swept_clearance",
    "swept_distance",
    "time_to_collision",
    "wall_clearance",
]
