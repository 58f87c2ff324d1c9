"""Falsification: factors, criteria, proposals, estimates, searches, clusters, found trials, resuming."""

from __future__ import annotations

import dataclasses
import json
import math
import re
from pathlib import Path

import numpy as np
import pytest
from scipy import special, stats

from crowdbot.core import InputError, TrialError
from crowdbot.falsification import (
    CrossEntropy,
    FalsificationResult,
    PlainSampling,
    Proposal,
    Sample,
    SampleRunner,
    SearchSpace,
    Splitting,
    collision_urgency,
    falsify,
    find_clusters,
    fit_proposal,
    mixture_estimate,
    mixture_weights,
    parse_factor,
    parse_failure,
    parse_sampling,
    replicate_estimate,
    write_report,
)
from crowdbot.simulation import simulate
from crowdbot.trials import apply_values, load_trial, parse_trial
from samples import sizes

BLIND = """<trial name="blind" duration="6" step="0.1">
<crowd type="orca"/>
<agent name="p" x="0" y="3" goal="0,-3" speed="1" radius="0.25"/>
<robot x="-3" y="0" radius="0.25" visible="false" holonomic="true"><goal x="3" y="0"/>
<drive type="omnidirectional" max-speed="1" max-acceleration="1000"/><navigator type="straight" speed="1"/></robot>
</trial>"""
OVER = ("agent[p]/y=normal(4.5, 0.4)", "agent[p]/speed=uniform(0.8, 1.2)")


@pytest.fixture(scope="module")
def space() -> SearchSpace:
    return SearchSpace(parse_trial(BLIND), tuple(map(parse_factor, OVER)))


@pytest.fixture(scope="module")
def plain(space: SearchSpace) -> FalsificationResult:
    return falsify(space, "collision", PlainSampling(), runs=400, seed=5)


class Line(SampleRunner):
    """A runner whose robustness is a function of the point and the seed, without a simulation."""

    def __init__(self, budget: int, dimensions: int, bound: float, seeds: bool = False) -> None:
        trial = parse_trial(BLIND)
        factors = tuple(parse_factor(f"agent[p]/{name}=normal(1, 0.1)") for name in ("x", "y", "speed")[:dimensions])
        super().__init__(SearchSpace(trial, factors), parse_failure("collision"), budget)
        self.bound, self.seeds = bound, seeds

    def run(self, points: np.ndarray, seeds: np.ndarray) -> list[Sample]:
        rows = []
        for point, seed in zip(points[: self.remaining].tolist(), seeds, strict=False):
            height = float(special.ndtri((seed + 0.5) / 2**31)) if self.seeds else point[0]
            rows.append(Sample(tuple(point), int(seed), "success", self.bound - height))
        self.samples += rows
        return rows


@pytest.mark.parametrize(
    ("text", "distribution"),
    [
        ("x=uniform(2, 4)", stats.uniform(2, 2)),
        ("x=normal(1, 0.5)", stats.truncnorm(-3, 3, 1, 0.5)),
        ("x=log-uniform(0.1, 10)", stats.loguniform(0.1, 10)),
        ("x=integer(2, 5)", stats.randint(2, 6)),
    ],
)
def test_factors_have_their_distributions(text: str, distribution: object) -> None:
    factor = parse_factor(text)
    shares = (np.arange(400) + 0.5) / 400
    values = [factor.value_at(float(z)) for z in special.ndtri(shares)]
    assert values == pytest.approx(distribution.ppf(shares), rel=1e-9)  # type: ignore[attr-defined]


def test_choices_are_equally_likely_and_edges_are_values() -> None:
    factor = parse_factor("crowd/type=choice(orca, boids, tangent)")
    values = [factor.value_at(float(z)) for z in special.ndtri((np.arange(300) + 0.5) / 300)]
    assert [values.count(word) for word in ("orca", "boids", "tangent")] == [100, 100, 100]
    for z in (-40.0, 40.0):
        assert factor.value_at(z) in factor.arguments
        assert parse_factor("x=integer(1, 3)").value_at(z) in (1, 3)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("speed", "must be PATH=DISTRIBUTION"),
        ("seed=uniform(0, 1)", "the seed is always a factor"),
        ("x=uniform(2, 1)", "low end 2 not below its high end 1"),
        ("x=unifrom(1, 2)", "did you mean 'uniform'"),
        ("x=log-uniform(0, 1)", "not above 0"),
        ("x=integer(1.5, 3)", "whole numbers"),
        ("x=choice(a)", "at least two different values"),
        ("x=uniform(1,)", "empty value"),
    ],
)
def test_wrong_factors_are_refused(text: str, message: str) -> None:
    with pytest.raises(InputError, match=re.escape(message)):
        parse_factor(text)


def test_variants_equal_those_of_a_sweep(space: SearchSpace) -> None:
    for z in (-1.3, 0.0, 2.2):
        point = np.array([z, -z])
        assert space.variant(point) == apply_values(space.trial, space.values(point))
    frontal = load_trial("frontal")
    mixed = SearchSpace(
        frontal, (parse_factor("spawner/speed=uniform(0.8, 1.6)"), parse_factor("spawner/count=integer(1, 2)"))
    )
    for z in (-1.0, 1.0):
        assert mixed.variant(np.array([z, z])) == apply_values(frontal, mixed.values(np.array([z, z])))


def test_wrong_paths_are_refused() -> None:
    trial = parse_trial(BLIND)
    with pytest.raises(TrialError, match="has no element 'agnet'"):
        SearchSpace(trial, (parse_factor("agnet/x=uniform(0, 1)"),))
    with pytest.raises(InputError, match="is there twice"):
        SearchSpace(trial, tuple(map(parse_factor, (OVER[0], OVER[0]))))


def test_robustness_is_positive_exactly_without_a_failure(plain: FalsificationResult) -> None:
    assert 0 < plain.failures < 400
    for sample in plain.samples:
        assert sample.fails == (sample.outcome == "collision")
    metrics = {"collision": 0.0, "timeout": 1.0, "min_clearance": 0.5, "goal_progress": 0.25, "time_to_goal": math.nan}
    assert parse_failure("timeout").robustness("timeout", metrics, 10.0, 0.5) == -0.75
    assert parse_failure("any").robustness("timeout", metrics, 10.0, 0.5) == -0.75
    assert parse_failure("collision").robustness("timeout", metrics, 10.0, 0.5) == math.exp(-0.5)
    assert parse_failure("time-to-goal<9").robustness("timeout", metrics, 10.0, 0.5) == -1.0
    assert parse_failure("min-clearance>=0.5").robustness("timeout", metrics, 10.0, 0.5) > 0.0
    assert parse_failure("min-clearance>0.5").robustness("timeout", metrics, 10.0, 0.5) <= 0.0
    with pytest.raises(InputError, match='needs world="physics"'):
        parse_failure("severity").robustness("timeout", metrics, 10.0, 0.5)
    with pytest.raises(InputError, match="did you mean 'collision'"):
        parse_failure("colision")
    with pytest.raises(InputError, match="a metric of one run"):
        parse_failure("collision-rate<0.1@95%")


def test_the_urgency_of_a_head_on_run_is_known() -> None:
    text = BLIND.replace('x="0" y="3" goal="0,-3" speed="1"', 'x="5" y="Y" goal="-5,Y" speed="1"')
    trial = parse_trial(text.replace("Y", "0").replace('duration="6"', 'duration="2"'))
    episode = simulate(trial, 0)
    assert episode.outcome == "timeout"
    # 7.5 m between the circles, which close at 2 m/s: the time to collision falls from 3.75 s to 1.75 s
    assert collision_urgency(episode) == pytest.approx(math.exp(-1.75) - math.exp(-3.75), rel=0.15)
    passing = simulate(parse_trial(text.replace("Y", "2").replace('duration="6"', 'duration="2"')), 0)
    assert collision_urgency(passing) == 0.0


def test_samples_equal_single_runs(space: SearchSpace, plain: FalsificationResult) -> None:
    for sample in plain.samples[:5]:
        episode = simulate(space.variant_of(sample.point), sample.seed)
        assert (episode.digest, episode.outcome) == (sample.digest, sample.outcome)


def test_a_proposal_integrates_to_one_and_its_weights_are_bounded() -> None:
    rng = np.random.default_rng(0)
    proposal = fit_proposal(rng.normal(2.0, 0.3, (300, 2)), rng.random(300), rng, 0.1)
    draws = proposal.draw(rng, 200_000)
    weights = np.exp(-proposal.log_ratio(draws))
    assert weights.mean() == pytest.approx(1.0, abs=0.03)
    assert weights.max() <= 10.0 + 1e-9
    plain = Proposal.standard(2).draw(rng, 200_000)
    assert np.exp(proposal.log_ratio(plain)).mean() == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize("repeats", sizes(100, 300))
def test_mixture_intervals_cover_with_many_and_with_few_failures(repeats: int) -> None:
    rng = np.random.default_rng(1)
    plain, shifted = Proposal.standard(1), Proposal(np.ones(1), np.array([[3.0]]), np.array([[0.6]]), 0.1)
    for counts, bound, least in (((100, 200), 3.0, 0.93), ((150, 3), 3.0, 0.93), ((300, 0), 2.5, 0.9)):
        largest = sum(counts) / (counts[0] + 0.1 * counts[1])
        true, hits, values = float(special.ndtr(-bound)), 0, []
        for _ in range(repeats):
            points = np.concatenate([plain.draw(rng, counts[0]), shifted.draw(rng, counts[1])])
            weights = mixture_weights([plain, shifted], counts, points)
            found = mixture_estimate(points[:, 0] > bound, weights, np.repeat([0, 1], counts), largest)
            hits += found.low <= true <= found.high
            values.append(found.value)
        assert hits >= least * repeats
        assert float(np.mean(values)) == pytest.approx(true, rel=0.35)
    none = mixture_estimate(np.zeros(100, dtype=bool), np.ones(100), np.zeros(100, dtype=int), 10.0)
    assert (none.value, none.low) == (0.0, 0.0)
    assert none.high == pytest.approx(0.3, rel=0.01)
    assert replicate_estimate(np.array([0.1, 0.1, 0.1]), 30)[:3] == pytest.approx((0.1, 0.1, 0.1))


@pytest.mark.parametrize(("seeds", "bound"), [(False, 3.5), (True, 2.0)])
def test_splitting_estimates_a_known_probability(seeds: bool, bound: float) -> None:
    values = []
    for seed in range(6):
        runner = Line(12_000, 2, bound, seeds)
        match = Splitting().search(runner, np.random.default_rng(seed))
        assert match.estimate is not None
        values.append(match.estimate.value)
        assert runner.remaining >= 0
    assert float(np.mean(values)) == pytest.approx(float(special.ndtr(-bound)), rel=0.35)


@pytest.mark.parametrize(("probability", "seeds"), [(3e-5, 20), pytest.param(1e-3, 20, marks=pytest.mark.sweep)])
def test_cross_entropy_estimates_a_known_probability(probability: float, seeds: int) -> None:
    covered, ratios = 0, []
    for seed in range(seeds):
        runner = Line(1000, 3, -float(special.ndtri(probability)))
        match = CrossEntropy().search(runner, np.random.default_rng(seed))
        assert match.estimate is not None
        covered += match.estimate.low <= probability <= match.estimate.high
        ratios.append(match.estimate.value / probability)
        assert match.estimate.high / match.estimate.low < 3.0
        assert np.all(match.weights > 0.0)
    assert covered >= 0.9 * seeds
    assert float(np.mean(ratios)) == pytest.approx(1.0, abs=0.06)


def test_cross_entropy_without_a_failure_has_an_upper_bound() -> None:
    match = CrossEntropy().search(Line(400, 2, 60.0), np.random.default_rng(0))
    assert match.estimate is not None
    assert (match.estimate.value, match.estimate.low) == (0.0, 0.0)
    assert 3.0 / 400 < match.estimate.high < 0.1


def test_searches_agree_with_plain_runs(space: SearchSpace, plain: FalsificationResult) -> None:
    found = falsify(space, "collision", CrossEntropy(), runs=200, seed=1)
    assert plain.estimate is not None
    assert found.estimate is not None
    assert found.estimate.low <= plain.estimate.high
    assert plain.estimate.low <= found.estimate.high


def test_a_search_of_calibration_finds_the_worst_and_the_most_likely_failure(space: SearchSpace) -> None:
    worst = falsify(space, "collision", parse_sampling("genetic"), runs=120)
    likely = falsify(space, "collision", parse_sampling("random-search", "likely"), runs=120)
    assert worst.estimate is None
    assert worst.failures > 0
    assert likely.failures > 0
    assert len(worst.samples) <= 120
    with pytest.raises(InputError, match="known are cross-entropy, splitting, plain"):
        parse_sampling("gradient")
    with pytest.raises(InputError, match="must be worst or likely"):
        parse_sampling("cma-es", "best")


def test_clusters_divide_by_event_and_values() -> None:
    rows = [Sample((4.0 + k / 50, 0.0), k, "collision", -0.1 * k, event="person left") for k in range(5)]
    rows += [Sample((-4.0 - k / 50, 0.0), k, "collision", -0.2, event="person left") for k in range(3)]
    rows += [Sample((4.0, 0.0), 9, "collision", -0.2, event="wall"), Sample((0.0, 0.0), 1, "success", 1.0)]
    weights = np.array([1.0] * 8 + [2.0, 5.0])
    clusters = find_clusters(rows, weights)
    assert [(cluster.event, len(cluster.members), cluster.share) for cluster in clusters] == [
        ("person left", 5, 0.5), ("person left", 3, pytest.approx(0.3)), ("wall", 1, 0.2),
    ]  # fmt: skip
    assert (clusters[0].likely, clusters[0].worst) == (0, 4)
    assert find_clusters(rows[-1:], np.ones(1)) == []


def test_found_trials_give_the_same_digest_and_an_interrupted_search_continues(
    space: SearchSpace, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    whole = falsify(space, "collision", runs=200, seed=3, folder=tmp_path / "whole", keep=3)
    assert whole.found
    assert all(one.same for one in whole.found)
    for one in whole.found:
        trial = load_trial(str(tmp_path / "whole" / one.file))
        assert simulate(trial).digest == whole.samples[one.sample].digest
    import crowdbot.falsification.sample as room

    calls, run = [], room.simulate_variants

    def stop(*words: object) -> object:
        calls.append(words)
        if len(calls) == 4:
            raise KeyboardInterrupt
        return run(*words)  # type: ignore[arg-type]

    monkeypatch.setattr(room, "simulate_variants", stop)
    with pytest.raises(KeyboardInterrupt):
        falsify(space, "collision", runs=200, seed=3, folder=tmp_path / "again", keep=3)
    kept = len(list((tmp_path / "again" / "parts").glob("*.json")))
    assert kept >= 3
    again = falsify(space, "collision", runs=200, seed=3, folder=tmp_path / "again", keep=3)
    assert again.table() == whole.table()


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("raise ValueError('too shy')", "too shy"),
        ("return Twist(float('nan'))", "nan"),
        ("while True: pass", "did not return within 0.3 s"),
    ],
    ids=["raises", "nan", "hangs"],
)
def test_a_navigator_that_fails_is_a_counted_failure_and_its_file_travels(
    tmp_path: Path, line: str, message: str
) -> None:
    (tmp_path / "shy.py").write_text(
        "from dataclasses import dataclass\n"
        "from crowdbot.core import Twist\nfrom crowdbot.navigation import Navigator\n"
        "@dataclass(frozen=True)\nclass Shy(Navigator):\n    def act(self, observation):\n"
        f"        if observation.time > 1.0:\n            {line}\n        return Twist(0.1)\n"
    )
    text = BLIND.replace('<navigator type="straight" speed="1"/>', '<navigator type="shy.py:Shy"/>')
    trial = parse_trial(text.replace('holonomic="true"', 'holonomic="true" decision-limit="0.3"'), folder=tmp_path)
    space = SearchSpace(trial, (parse_factor(OVER[0]),))
    result = falsify(space, "collision", PlainSampling(), runs=3, folder=tmp_path / "out", keep=1)
    assert result.failures == 3
    assert {sample.outcome for sample in result.samples} == {"error"}
    assert sum(result.errors.values()) == 3
    assert all(message in error.lower() for error in result.errors)
    assert result.estimate is not None
    assert result.estimate.value == 1.0
    assert (tmp_path / "out" / "found" / "shy.py").is_file()
    assert result.found[0].same


def test_impossible_variants_are_counted_apart() -> None:
    trial = parse_trial(BLIND.replace('duration="6"', 'duration="1"'))
    result = falsify(SearchSpace(trial, ()), "timeout", PlainSampling(), runs=2)
    assert (result.failures, result.invalid) == (2, 0)
    touching = SearchSpace(
        trial, (parse_factor("agent[p]/x=uniform(-6, 0)"), parse_factor("agent[p]/y=uniform(-0.01, 0.01)"))
    )
    found = falsify(touching, "timeout", PlainSampling(), runs=40, seed=2)
    assert 0 < found.invalid < 40
    assert found.estimate is not None
    assert found.estimate.runs == 40 - found.invalid


def test_the_report_and_the_file_hold_the_result(space: SearchSpace, tmp_path: Path) -> None:
    result = falsify(space, "collision", runs=200, seed=3, keep=2)
    write_report(result, space, tmp_path / "report.html")
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "http" not in page
    drawings = json.loads(re.search(r'type="application/json">(.*?)</script>', page, re.S)[1])  # type: ignore[index]
    assert len(drawings) == len(result.found) == 2
    result.save(tmp_path / "result.json")
    stored = json.loads((tmp_path / "result.json").read_text(encoding="utf-8"))
    assert stored["schema"] == "crowdbot-falsification/1"
    assert len(stored["samples"]) == 200
    empty = dataclasses.replace(result, clusters=(), found=(), samples=result.samples[:1], weights=result.weights[:1])
    write_report(empty, space, tmp_path / "empty.html")
    assert "No run fails" in (tmp_path / "empty.html").read_text(encoding="utf-8")
