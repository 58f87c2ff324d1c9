"""Metrics of logs against an independent few lines each, on random episodes."""

import cmath
import itertools
import math

import numpy as np
import pytest
from robot_logs import random_log

from crowdbot.metrics import detect_groups, log_metrics

SEEDS = range(12)


def pairs(log):
    """Yield sample, person, and both states as complex numbers."""
    z = lambda xy: complex(*xy)  # noqa: E731
    for t, p in zip(*np.nonzero(log.present), strict=True):
        yield (
            t, p, z(log.position[t]), z(log.velocity[t]), z(log.people_position[t, p]), z(log.people_velocity[t, p]),
        )  # fmt: skip


@pytest.mark.parametrize("seed", SEEDS)
def test_comfort(seed):
    log = random_log(seed)
    found = log_metrics(log, ["comfort"])
    near = [math.inf] * len(log.times)
    intended = [False] * len(log.times)
    heading = dict.fromkeys(range(log.present.shape[1]), 0.0)
    cost = [0.0] * len(log.times)
    for t, p, x, _, y, w in pairs(log):
        reach = log.radius + log.people_radius[p]
        near[t] = min(near[t], abs(x - y) - reach)
        intended[t] |= any(abs(x - (y + w * 0.25 * k)) < reach + 0.25 for k in range(1, 6))
        heading[p] = cmath.phase(w) if abs(w) > 0.05 else heading[p]
        q = (x - y) * cmath.exp(-1j * heading[p])
        s = max(2 * abs(w), 0.5)
        ahead = s if q.real >= 0 else s / 2
        cost[t] = max(cost[t], math.exp(-((q.real / ahead) ** 2 + (q.imag / (s * 2 / 3)) ** 2) / 2))
    close = [d for d in near if 0 <= d < 0.2]
    assert found["discomfort_share"] == pytest.approx(len(close) / len(near))
    assert found["intended_path_intrusion"] == pytest.approx(sum(intended) / len(intended))
    assert found["personal_space_cost"] == pytest.approx(max(cost))
    assert found["personal_space_integral"] == pytest.approx(sum(cost[1:]) * 0.1)


@pytest.mark.parametrize("seed", SEEDS)
def test_fear_panic_and_social_force(seed):
    log = random_log(seed)
    found = log_metrics(log, ["conflict", "force"])
    fear = panic = 0.0
    on_people, on_robot = 0.0, [0j] * len(log.times)
    for t, p, x, v, y, w in pairs(log):
        rho, c, u = log.radius + log.people_radius[p], y - x, v - w
        inner = (c * u.conjugate()).real
        side2 = abs(u) ** 2 * abs(c) ** 2 - inner**2
        if abs(c) < rho:
            fear = max(fear, 10.0)
        elif inner > 0 and side2 < (abs(u) * rho) ** 2:
            ttc = (inner - math.sqrt((abs(u) * rho) ** 2 - side2)) / abs(u) ** 2
            fear = max(fear, 1 / ttc if ttc > 0.01 else 10.0)
        elif inner > 0 and math.sqrt(side2) - abs(u) * rho > 0.01:
            g = math.sqrt(side2)
            panic = max(panic, abs(u) / abs(c) * g / (g - abs(u) * rho))
        for away, drift in ((c, u), (-c, -u)):
            e = away / abs(away)
            d = 2.0 * drift + e
            b, angle = 0.35 * abs(d), cmath.phase(e / d)
            forward = -math.exp(-abs(away) / b - (3 * b * angle) ** 2)
            left = -math.copysign(1, angle) * math.exp(-abs(away) / b - (2 * b * angle) ** 2)
            force = 2.1 * (forward + 1j * left) * d / abs(d)
            if away == c:
                on_robot[t] += force
            else:
                on_people += abs(force)
    assert found["max_fear"] == pytest.approx(fear)
    assert found["max_panic"] == pytest.approx(panic)
    assert found["social_force_on_people"] == pytest.approx(on_people)
    assert found["social_work"] == pytest.approx(on_people + sum(map(abs, on_robot)))


@pytest.mark.parametrize("seed", SEEDS)
def test_responsibility(seed):
    log = random_log(seed)
    found = log_metrics(log, ["conflict"])

    def conflict(t, p, v, w):
        away = log.people_position[t, p] - log.position[t]
        speed2 = float((w - v) @ (w - v))
        when = max(0.0, -float(away @ (w - v)) / speed2)
        return max(0.0, 1 - math.hypot(*(away + when * (w - v))) / (log.radius + log.people_radius[p]))

    solved, raised = [0.0, 0.0, 0.0], [0.0, 0.0]
    for t, p in itertools.product(range(1, len(log.times)), range(log.present.shape[1])):
        if not (log.present[t, p] and log.present[t - 1, p]):
            continue
        v0, v1 = log.velocity[t - 1 : t + 1]
        w0, w1 = log.people_velocity[t - 1 : t + 1, p]
        old, both = conflict(t - 1, p, v0, w0), conflict(t - 1, p, v1, w1)
        mine = (conflict(t - 1, p, v1, w0) - old + both - conflict(t - 1, p, v0, w1)) / 2
        parts = mine, both - old - mine, conflict(t, p, v1, w1) - both
        for k, part in enumerate(parts):
            solved[k] += max(0.0, -part)
            if k < 2:
                raised[k] += max(0.0, part)
    if sum(solved) > 0:
        assert found["responsibility"] == pytest.approx(solved[0] / sum(solved))
        assert found["people_responsibility"] == pytest.approx(solved[1] / sum(solved))
    if sum(raised) > 0:
        assert found["engagement"] == pytest.approx(raised[0] / sum(raised))


@pytest.mark.parametrize("seed", SEEDS)
def test_density_people_and_motion(seed):
    log = random_log(seed)
    found = log_metrics(log, ["density", "people", "motion", "legibility"])
    counts = {r: [0] * len(log.times) for r in (2.5, 3.0, 5.0, 10.0)}
    speeds, time = [], [0.0] * log.present.shape[1]
    least = [math.inf] * log.present.shape[1]
    for t, p, x, _, y, w in pairs(log):
        speeds.append(abs(w))
        for r, row in counts.items():
            row[t] += abs(x - y) < r
        time[p] += 0.1 * (t > 0 and abs(x - y) - log.radius - log.people_radius[p] < 1.2)
        least[p] = min(least[p], abs(x - y) - log.radius - log.people_radius[p])
    for r, name in ((2.5, "2_5m"), (3.0, "3m"), (5.0, "5m"), (10.0, "10m")):
        assert found[f"density_{name}"] == pytest.approx(np.mean(counts[r]) / (math.pi * r * r))
    assert found["people_speed"] == pytest.approx(np.mean(speeds))
    assert found["worst_person_intrusion_time"] == pytest.approx(max(time))
    assert found["worst_decile_clearance"] <= min(least) + 1e-9  # swept between samples
    assert found["motion_energy"] == pytest.approx(sum(abs(complex(*v)) ** 2 for v in log.velocity[1:]) * 0.1)
    angles = [
        abs(cmath.phase(complex(*(log.goal - x)) / complex(*v)))
        for x, v in zip(log.position, log.velocity, strict=True)
        if math.hypot(*v) > 0.05
    ]
    assert found["path_irregularity"] == pytest.approx(np.mean(angles))
    assert 0.0 < found["legibility"] < 1.0


@pytest.mark.parametrize("seed", SEEDS)
def test_warping_and_severity(seed):
    path = np.cumsum(np.random.default_rng(seed).normal(0.0, 1.0, (5, 2)), axis=0)
    log = random_log(seed, path=path)
    found = log_metrics(log, ["path", "severity"])
    from crowdbot.metrics.social.path_quality import sample_path

    a, b = sample_path(path, 0.25), sample_path(log.position, 0.25)
    table = {(-1, -1): 0.0}
    for i, j in itertools.product(range(len(a)), range(len(b))):
        before = min(table.get(k, math.inf) for k in ((i - 1, j), (i, j - 1), (i - 1, j - 1)))
        table[i, j] = before + math.dist(a[i], b[j])
    assert found["ndtw"] == pytest.approx(math.exp(-table[len(a) - 1, len(b) - 1] / (len(a) * 0.3)))
    speeds = [event.impact_speed for event in log.contacts]
    mu = 60 * 75 / 135
    wanted = max((v * math.sqrt(60e3 * mu) / 260 for v in speeds), default=0.0)
    assert found["severity_lower_leg"] == pytest.approx(wanted)


@pytest.mark.parametrize("seed", SEEDS)
def test_groups(seed):
    log = random_log(seed, people=12)
    wanted = set()
    for a, b in itertools.combinations(range(log.present.shape[1]), 2):
        both = log.present[:, a] & log.present[:, b]
        if both.sum() * 0.1 < 2.0 + (0.1 if both[0] else 0.0) - 1e-9:
            continue
        away = np.linalg.norm(log.people_position[both, a] - log.people_position[both, b], axis=1).mean()
        drift = np.linalg.norm(log.people_velocity[both, a] - log.people_velocity[both, b], axis=1).mean()
        if away <= 1.5 and drift <= 0.3:
            wanted.add((a, b))
    found = detect_groups(log)
    assert all(any({a, b} <= set(group) for group in found) for a, b in wanted)
    assert bool(found) == bool(wanted)
