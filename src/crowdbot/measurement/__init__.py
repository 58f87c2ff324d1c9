"""Measurements of pedestrian dynamics in recordings and simulations alike.

Speeds, accelerations, Voronoi cells, densities and passages come from PedPy; :func:`pedpy_tracks` gives a recording to
its other functions. What PedPy lacks is here: each function takes :class:`crowdbot.data.Trajectories` and returns a
pandas table. ``episode.tracks()`` of a simulation is a recording too.
"""

from .diagram import StartsMean, compute_fundamental_diagram, mean_over_starts
from .distances import compute_headways, compute_pair_distribution_function
from .encounters import (
    compute_encounters,
    compute_time_to_collision_distribution,
    distribution,
    expected_times,
    time_edges,
)
from .flow import compute_crossing_frames, compute_flow, compute_line_flow, compute_n_t, crossing_times, mean_flow
from .geometry import MeasurementArea, MeasurementLine, WalkableArea
from .interaction_energy import (
    FIT_RANGE,
    InteractionEnergy,
    compute_interaction_energy,
    fit_interaction_energy,
    pool_interaction_energy,
)
from .lanes import LANE_BAND, compute_lane_order, lane_order, walking_direction
from .people import (
    BORDERS,
    compute_individual_acceleration,
    compute_individual_speed,
    compute_individual_voronoi_polygons,
    pedpy_tracks,
)
from .plots import plot_measurements
from .profiles import Grid, compute_profiles
from .rows import select_rows
from .steady import SteadyState, combine_steady_states, detect_steady_state, steady_threshold
from .survey import FIGURES, METHODS, MeasurementPlan, Measurements, measure, pool_diagrams
from .waves import StopAndGo, compute_stop_and_go, compute_stops, wave_speed

__all__ = [
    "BORDERS",
    "FIGURES",
    "FIT_RANGE",
    "LANE_BAND",
    "METHODS",
    "Grid",
    "InteractionEnergy",
    "MeasurementArea",
    "MeasurementLine",
    "MeasurementPlan",
    "Measurements",
    "StartsMean",
    "SteadyState",
    "StopAndGo",
    "WalkableArea",
    "combine_steady_states",
    "compute_crossing_frames",
    "compute_encounters",
    "compute_flow",
    "compute_fundamental_diagram",
    "compute_headways",
    "compute_individual_acceleration",
    "compute_individual_speed",
    "compute_individual_voronoi_polygons",
    "compute_interaction_energy",
    "compute_lane_order",
    "compute_line_flow",
    "compute_n_t",
    "compute_pair_distribution_function",
    "compute_profiles",
    "compute_stop_and_go",
    "compute_stops",
    "compute_time_to_collision_distribution",
    "crossing_times",
    "detect_steady_state",
    "distribution",
    "expected_times",
    "fit_interaction_energy",
    "lane_order",
    "mean_flow",
    "mean_over_starts",
    "measure",
    "pedpy_tracks",
    "plot_measurements",
    "pool_diagrams",
    "pool_interaction_energy",
    "select_rows",
    "steady_threshold",
    "time_edges",
    "walking_direction",
    "wave_speed",
]
