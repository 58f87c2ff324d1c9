"""Measurements of pedestrian dynamics in recordings and simulations alike.

Speeds, accelerations, Voronoi cells, densities and passages come from PedPy; :func:`pedpy_tracks` gives a recording to
its other functions. What PedPy lacks is here: each function takes :class:`crowdbot.data.Trajectories` and returns a
pandas table. ``episode.tracks()`` of a simulation is a recording too.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from crowdbot.lazy import lazy_exports

if TYPE_CHECKING:
    from .diagram import StartsMean as StartsMean
    from .diagram import compute_fundamental_diagram as compute_fundamental_diagram
    from .diagram import mean_over_starts as mean_over_starts
    from .distances import compute_headways as compute_headways
    from .distances import compute_pair_distribution_function as compute_pair_distribution_function
    from .encounters import compute_encounters as compute_encounters
    from .encounters import compute_time_to_collision_distribution as compute_time_to_collision_distribution
    from .encounters import distribution as distribution
    from .encounters import expected_times as expected_times
    from .encounters import time_edges as time_edges
    from .flow import compute_crossing_frames as compute_crossing_frames
    from .flow import compute_flow as compute_flow
    from .flow import compute_line_flow as compute_line_flow
    from .flow import compute_n_t as compute_n_t
    from .flow import crossing_times as crossing_times
    from .flow import mean_flow as mean_flow
    from .geometry import MeasurementArea as MeasurementArea
    from .geometry import MeasurementLine as MeasurementLine
    from .geometry import WalkableArea as WalkableArea
    from .interaction_energy import FIT_RANGE as FIT_RANGE
    from .interaction_energy import InteractionEnergy as InteractionEnergy
    from .interaction_energy import compute_interaction_energy as compute_interaction_energy
    from .interaction_energy import fit_interaction_energy as fit_interaction_energy
    from .interaction_energy import pool_interaction_energy as pool_interaction_energy
    from .lanes import LANE_BAND as LANE_BAND
    from .lanes import compute_lane_order as compute_lane_order
    from .lanes import lane_order as lane_order
    from .lanes import walking_direction as walking_direction
    from .people import BORDERS as BORDERS
    from .people import compute_individual_acceleration as compute_individual_acceleration
    from .people import compute_individual_speed as compute_individual_speed
    from .people import compute_individual_voronoi_polygons as compute_individual_voronoi_polygons
    from .people import pedpy_tracks as pedpy_tracks
    from .plots import plot_measurements as plot_measurements
    from .profiles import Grid as Grid
    from .profiles import compute_profiles as compute_profiles
    from .rows import select_rows as select_rows
    from .steady import SteadyState as SteadyState
    from .steady import combine_steady_states as combine_steady_states
    from .steady import detect_steady_state as detect_steady_state
    from .steady import steady_threshold as steady_threshold
    from .survey import FIGURES as FIGURES
    from .survey import METHODS as METHODS
    from .survey import MeasurementPlan as MeasurementPlan
    from .survey import Measurements as Measurements
    from .survey import measure as measure
    from .survey import pool_diagrams as pool_diagrams
    from .waves import StopAndGo as StopAndGo
    from .waves import compute_stop_and_go as compute_stop_and_go
    from .waves import compute_stops as compute_stops
    from .waves import wave_speed as wave_speed

__getattr__, __dir__, __all__ = lazy_exports(__name__)
