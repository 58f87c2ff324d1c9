"""Metrics: errors, likelihood and collisions of forecasts, and navigation metrics of robots among people."""

from .agent_states import AgentLog, AgentStates
from .collisions import collision_mask, collision_share, neighbor_mask
from .contact_tracker import ContactTracker
from .contacts import HOLD, ContactEvent, cause_of, contact_events
from .displacement import ade, best_of, distances, fde, miss_rate
from .earth_mover import earth_mover_distance
from .energy import energy_score
from .footprint_clearance import FOOTPRINT_METRICS, footprint_clearance
from .impacts import IMPACT_METRICS, Impact, impact_metrics
from .incremental import CONTACT_METRICS, NavigationMetrics, NavigationOutcome
from .interval import Intervals, bootstrap_interval
from .likelihood import kde_nll
from .mahalanobis import mahalanobis
from .modes import mode_count, mode_coverage, mode_shares
from .motion import heading_change, jerk, longest_stall, path_efficiency, path_length, stalled_time
from .navigation import NAVIGATION_METRICS, navigation_metrics, outcome
from .nearest_neighbor import nearest_neighbor_accuracy
from .people_rows import PEOPLE_COLUMNS, PersonImpact, TableRobot, people_table
from .persons import PersonErrors, error_over_horizon, person_errors
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
from .social import (
    GAZE_HALF_ANGLE,
    HEAD_HALF_ANGLE,
    LOG_FAMILIES,
    BodyRegion,
    Coordination,
    GazeDwell,
    LogMetric,
    Metric,
    RobotLog,
    check_log_metric,
    coordination,
    correct_p_values,
    crowd_effect,
    detect_groups,
    empty_scene_ratios,
    gate_metrics,
    gaze_dwell,
    head_injury_criterion,
    impact_region_metrics,
    log_metrics,
    metric_families,
    metric_page,
    metric_table,
)
from .step_clearance import step_clearance, step_wall_clearance

__all__ = [
    "CONTACT_METRICS",
    "FOOTPRINT_METRICS",
    "GAZE_HALF_ANGLE",
    "HEAD_HALF_ANGLE",
    "HOLD",
    "IMPACT_METRICS",
    "LOG_FAMILIES",
    "NAVIGATION_METRICS",
    "PEOPLE_COLUMNS",
    "AgentLog",
    "AgentStates",
    "BodyRegion",
    "ContactEvent",
    "ContactTracker",
    "Coordination",
    "GazeDwell",
    "Impact",
    "Intervals",
    "LogMetric",
    "Metric",
    "NavigationMetrics",
    "NavigationOutcome",
    "PersonErrors",
    "PersonImpact",
    "RobotLog",
    "Score",
    "TableRobot",
    "ade",
    "best_of",
    "bootstrap_interval",
    "cause_of",
    "check_log_metric",
    "clearance",
    "collision_mask",
    "collision_share",
    "contact_events",
    "coordination",
    "correct_p_values",
    "crowd_effect",
    "detect_groups",
    "distances",
    "earth_mover_distance",
    "empty_scene_ratios",
    "energy_score",
    "error_over_horizon",
    "fde",
    "footprint_clearance",
    "gate_metrics",
    "gaze_dwell",
    "head_injury_criterion",
    "heading_change",
    "impact_metrics",
    "impact_region_metrics",
    "jerk",
    "kde_nll",
    "local_density",
    "log_metrics",
    "longest_stall",
    "mahalanobis",
    "metric_families",
    "metric_page",
    "metric_table",
    "miss_rate",
    "mode_count",
    "mode_coverage",
    "mode_shares",
    "navigation_metrics",
    "nearest_neighbor_accuracy",
    "neighbor_mask",
    "outcome",
    "path_efficiency",
    "path_length",
    "people_table",
    "person_errors",
    "personal_space_compliance",
    "proxemic_shares",
    "score",
    "stalled_time",
    "step_clearance",
    "step_wall_clearance",
    "swept_clearance",
    "swept_distance",
    "time_to_collision",
    "wall_clearance",
]
