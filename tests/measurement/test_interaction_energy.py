"""Energy of the interaction of people by their time to collision."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError
from crowdbot.data import Trajectories
from crowdbot.measurement import (
    MeasurementPlan,
    WalkableArea,
    compute_individual_speed,
    compute_interaction_energy,
    compute_time_to_collision_distribution,
    fit_interaction_energy,
    measure,
    plot_measurements,
    pool_interaction_energy,
)


@settings(deadline=None, max_examples=30)
@given(st.floats(0.5, 3.0), st.floats(0.05, 3.0), st.floats(-0.3, 0.3))
def test_the_fit_finds_the_law(exponent, strength, offset):
    tau = np.arange(0.25, 3.0, 0.1)
    g = np.exp(-strength * tau**-exponent - offset)
    n, k, c = fit_interaction_energy(tau, g, np.full(len(tau), 50))
    assert n == pytest.approx(exponent, abs=0.026)
    assert np.exp(-k * tau**-n - c) == pytest.approx(g, rel=0.1, abs=1e-3)


def test_few_pairs_and_attraction_have_no_exponent():
    tau = np.arange(0.25, 3.0, 0.1)
    assert np.isnan(fit_interaction_energy(tau, np.exp(-1.0 / tau), np.full(len(tau), 4))[0])
    assert fit_interaction_energy(tau, np.exp(1.0 / tau), np.full(len(tau), 50))[1] == 0.0
    with pytest.raises(InputError, match="columns of equal length"):
        fit_interaction_energy(tau, tau[1:], tau)


def crossing(avoid, people=80, rows=300, seed=0):
    """People who cross a square in straight lines; with ``avoid``, pairs stay with the probability exp(-1 / tau^2)."""
    rng = np.random.default_rng(seed)
    place = rng.uniform(0.0, 12.0, (people, 2))
    way = rng.normal(0.0, 1.0, (people, 2))
    way *= 1.3 / np.hypot(*way.T)[:, None]
    time = 0.2 * np.arange(rows)
    x = (place[:, None] + time[None, :, None] * way[:, None]) % 12.0
    round_ = np.floor((place[:, None] + time[None, :, None] * way[:, None]) / 12.0)
    lap = (round_[..., 0] + 50.0 * round_[..., 1]).astype(int)
    id = np.unique(np.stack([np.repeat(np.arange(people), rows), lap.ravel()], axis=1), axis=0, return_inverse=True)[1]
    frame = np.tile(np.arange(rows), people)
    kept = np.ones(len(frame), dtype=bool)
    if avoid:
        for k in range(rows):
            here = np.flatnonzero(frame == k)
            away = x.reshape(-1, 2)[here] - x.reshape(-1, 2)[here][:, None]
            relative = way - way[:, None]
            gap = np.sum(away**2, axis=-1) - 0.16
            nearing = np.minimum(np.sum(away * relative, axis=-1), 0.0)
            inside = nearing**2 - np.sum(relative**2, axis=-1) * gap
            meets = (gap > 0.0) & (nearing < 0.0) & (inside > 0.0)
            tau = np.where(meets, gap / np.where(meets, np.sqrt(np.abs(inside)) - nearing, 1.0), np.inf)
            leaves = np.triu(rng.uniform(size=tau.shape) > np.exp(-1.0 / np.maximum(tau, 0.05) ** 2), 1)
            kept[here[np.any(leaves & meets, axis=1)]] = False
    flat = x.reshape(-1, 2)[kept]
    return Trajectories(id.ravel()[kept], frame[kept], flat[:, 0], flat[:, 1], row_rate=5.0, name="crossing")


def test_people_who_do_not_interact_have_no_energy():
    tracks = crossing(avoid=False)
    interaction_energy = compute_interaction_energy(
        tracks, compute_individual_speed(tracks, 1, border="single-sided"), 0.2
    )
    near = interaction_energy.table[(interaction_energy.table.ttc < 4.0) & (interaction_energy.table.ttc > 0.3)]
    assert near.g.mean() == pytest.approx(1.0, abs=0.1)
    assert np.mean((near.low <= 1.0) & (near.high >= 1.0)) > 0.7


def test_people_who_keep_apart_have_energy_at_small_times():
    tracks = crossing(avoid=True)
    velocity = compute_individual_speed(tracks, 1, border="single-sided")
    interaction_energy = compute_interaction_energy(tracks, velocity, 0.2)
    rows = interaction_energy.table.set_index(interaction_energy.table.ttc.round(2))
    assert rows.g[0.25] < 0.2 < rows.g[2.95]
    assert interaction_energy.exponent == pytest.approx(2.0, abs=0.7)
    assert rows.high[0.35] < 0.5
    assert interaction_energy.strength > 0.0
    assert interaction_energy.exponent_low <= interaction_energy.exponent <= interaction_energy.exponent_high
    same = compute_time_to_collision_distribution(tracks, velocity, 0.2)
    for name in ("ttc", "count", "expected", "g", "energy"):
        assert interaction_energy.table[name].to_numpy() == pytest.approx(same[name].to_numpy(), nan_ok=True)


def test_starts_are_pooled():
    parts = [crossing(avoid=True, rows=80, seed=seed) for seed in range(4)]
    tables = [
        compute_interaction_energy(part, compute_individual_speed(part, 1, border="single-sided"), 0.2).table
        for part in parts
    ]
    whole = pool_interaction_energy(tables)
    assert whole.table["count"].to_numpy() == pytest.approx(sum(table["count"].to_numpy() for table in tables))
    assert whole.table.g.to_numpy() == pytest.approx(
        sum(table["count"].to_numpy() for table in tables) / sum(table.expected.to_numpy() for table in tables)
    )
    assert whole.exponent == pytest.approx(2.0, abs=1.0)
    with pytest.raises(InputError, match="at least two tables with the same bins"):
        pool_interaction_energy(tables[:1])


def test_a_measurement_shows_the_energy(tmp_path):
    area = WalkableArea([(0.0, 0.0), (12.0, 0.0), (12.0, 12.0), (0.0, 12.0)])
    found = measure(crossing(avoid=True), MeasurementPlan(("encounters",), walkable=area, every=0.2))
    assert found.figures["energy_exponent_low"] <= found.figures["energy_exponent"]
    files = {file.name: file for file in plot_measurements([found], tmp_path)}
    assert set(files) == {"clearance.png", "time-to-collision.png", "interaction-energy.png"}
    assert files["interaction-energy.png"].stat().st_size > 5_000
