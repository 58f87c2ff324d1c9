"""Makes tests/reference/pedpy/two_way.npz: a made crowd and what PedPy measures in it.

Run with PedPy installed: ``python tests/measurement/pedpy_reference.py``. The file in the repository is of PedPy 1.5.1.
"""

import sys
from pathlib import Path

import numpy as np

FPS = 10.0
CORNERS = [(0, 0), (12, 0), (12, 3), (9, 3), (9, 5), (7, 5), (7, 3), (0, 3)]
PILLAR = [(3.4, 1.3), (3.8, 1.3), (3.8, 1.7), (3.4, 1.7)]
AREA = [(5.0, 0.2), (8.0, 0.2), (8.0, 2.8), (5.0, 2.8)]
LINE = ((6.0, 0.0), (6.0, 3.0))
WIDTH = -2.0
STEP = 4
GRID = 0.5
CUT_OFF = (0.8, 3)


def crowd():
    """Return id, frame, x, y of people who walk both ways in a corridor with a niche and a pillar."""
    rng = np.random.default_rng(16)
    rows = []
    for k in range(22):
        side = 1.0 if k % 3 else -1.0
        speed, start = rng.uniform(0.7, 1.6), rng.integers(0, 30)
        lane = rng.uniform(0.2, 1.1) if k % 2 else rng.uniform(1.9, 2.8)
        x0 = rng.uniform(0.3, 5.0) if side > 0 else rng.uniform(7.0, 11.7)
        for frame in range(int(start), 80):
            t = (frame - start) / FPS
            x = x0 + side * (speed * t + 0.2 * np.sin(1.3 * t + k))
            y = lane + 0.08 * np.sin(5.0 * t + k)
            if not 0.05 < x < 11.95:
                break
            rows.append((k + 1, frame, x, y))
    for frame in range(80):
        rows.append((40, frame, 8.0 + 0.3 * np.sin(0.1 * frame), 4.2))
    return np.asarray(rows, dtype=float)


def measure(rows):
    """Return the measurements of PedPy by name."""
    import pandas as pd
    import pedpy
    from pedpy import SpeedCalculation as Border

    table = pd.DataFrame(rows, columns=["id", "frame", "x", "y"]).astype({"id": int, "frame": int})
    tracks = pedpy.TrajectoryData(table, frame_rate=FPS)
    hall, area = pedpy.WalkableArea(CORNERS, obstacles=[PILLAR]), pedpy.MeasurementArea(AREA)
    line = pedpy.MeasurementLine(LINE)
    cells = pedpy.compute_individual_voronoi_polygons(traj_data=tracks, walkable_area=hall)
    cut = pedpy.compute_individual_voronoi_polygons(
        traj_data=tracks, walkable_area=hall, cut_off=pedpy.Cutoff(radius=CUT_OFF[0], quad_segments=CUT_OFF[1])
    )
    found = {"cells": cells[["id", "frame", "density"]], "cut": cut[["id", "frame", "density"]]}
    found["classic"] = pedpy.compute_classic_density(traj_data=tracks, measurement_area=area)
    density, joined = pedpy.compute_voronoi_density(individual_voronoi_data=cells, measurement_area=area)
    found["voronoi"] = density
    speeds = {}
    for name, border in (
        ("exclude", Border.BORDER_EXCLUDE),
        ("adaptive", Border.BORDER_ADAPTIVE),
        ("single", Border.BORDER_SINGLE_SIDED),
    ):
        speeds[name] = pedpy.compute_individual_speed(
            traj_data=tracks, frame_step=STEP, speed_calculation=border, compute_velocity=True
        )
        found[f"speed_{name}"] = speeds[name]
    found["speed_along"] = pedpy.compute_individual_speed(
        traj_data=tracks, frame_step=STEP, movement_direction=np.array([1.0, 0.0]), compute_velocity=True
    )
    found["acceleration"] = pedpy.compute_individual_acceleration(
        traj_data=tracks, frame_step=STEP, compute_acceleration_components=True
    )
    single = speeds["single"]
    found["mean_speed"] = pedpy.compute_mean_speed_per_frame(
        traj_data=tracks, individual_speed=single, measurement_area=area
    )
    found["voronoi_speed"] = pedpy.compute_voronoi_speed(
        traj_data=tracks, individual_speed=single, individual_voronoi_intersection=joined, measurement_area=area
    )
    n_t, crossing = pedpy.compute_n_t(traj_data=tracks, measurement_line=line)
    found["n_t"], found["crossing"] = n_t, crossing
    found["flow"] = pedpy.compute_flow(
        nt=n_t, crossing_frames=crossing, individual_speed=single, delta_frame=10, frame_rate=FPS
    )
    species = pedpy.compute_species(
        individual_voronoi_polygons=cells, measurement_line=line, trajectory_data=tracks, frame_step=STEP
    )
    found["species"] = species
    at_line = {"individual_voronoi_polygons": cells, "measurement_line": line, "species": species}
    found["line_density"] = pedpy.compute_line_density(**at_line)
    found["line_speed"] = pedpy.compute_line_speed(**at_line, individual_speed=single)
    found["line_flow"] = pedpy.compute_line_flow(**at_line, individual_speed=single)
    passages, between = pedpy.compute_frame_range_in_area(traj_data=tracks, measurement_line=line, width=WIDTH)
    found["passages"] = passages
    inside = pedpy.compute_classic_density(traj_data=tracks, measurement_area=between)
    found["passing_density"] = pedpy.compute_passing_density(density_per_frame=inside, frames=passages)
    found["passing_speed"] = pedpy.compute_passing_speed(frames_in_area=passages, frame_rate=FPS, distance=abs(WIDTH))
    found["neighbors"] = pedpy.compute_neighbors(cells, as_list=False)
    found["neighbor_distance"] = pedpy.compute_neighbor_distance(traj_data=tracks, neighborhood=found["neighbors"])
    data = table.merge(cells, on=["id", "frame"]).merge(single, on=["id", "frame"])
    for density_method, speed_method in (("VORONOI", "ARITHMETIC"), ("CLASSIC", "MEAN")):
        both = pedpy.compute_profiles(
            data=data,
            walkable_area=hall,
            grid_size=GRID,
            density_method=pedpy.DensityMethod[density_method],
            speed_method=pedpy.SpeedMethod[speed_method],
        )
        found[f"profile_{density_method.lower()}"] = np.mean(both[0], axis=0)
    return {
        name: getattr(value, "to_numpy", lambda value=value: value)().astype(float) for name, value in found.items()
    }


if __name__ == "__main__":
    rows = crowd()
    target = Path(__file__).parents[1] / "reference" / "pedpy" / "two_way.npz"
    np.savez_compressed(target, rows=rows, **measure(rows))
    sys.stdout.write(f"{target}\n")
