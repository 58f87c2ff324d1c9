"""An order to one of several environments is recorded as in the run of that environment alone."""

from __future__ import annotations

from collections.abc import Iterable

from crowdbot.simulation import EpisodeDigest, Order, Simulation, SimulationRun, StepRecord, VelocityOrder
from crowdbot.trials import load_trial


class Steering:
    """Orders another velocity in some environments at one tick."""

    def __init__(self, environments: Iterable[int]) -> None:
        self.environments = tuple(environments)

    def orders(self, simulation: Simulation) -> list[Order]:
        if simulation.tick != 4:
            return []
        return [VelocityOrder(robot="robot", forward=0.3, environment=e) for e in self.environments]


class Digests:
    """Hashes the records of each environment."""

    def __init__(self, count: int) -> None:
        self.each = [EpisodeDigest() for _ in range(count)]
        self.orders: list[list[Order]] = [[] for _ in range(count)]

    def take(self, frame: StepRecord) -> None:
        self.each[frame.environment].take(frame)
        self.orders[frame.environment] += frame.orders


def digests_of(seeds: list[int], environments: Iterable[int]) -> tuple[list[str], list[list[Order]]]:
    simulation = Simulation(load_trial("frontal", duration=1.0), seeds)
    digests = Digests(len(seeds))
    run = SimulationRun(simulation, [digests], [Steering(environments)])
    while run.outcome is None:
        run.step()
    return [one.hexdigest("") for one in digests.each], digests.orders


def test_a_steered_run_has_the_same_digest_alone_and_among_others() -> None:
    together, orders = digests_of([1, 2, 3], (1, 2))
    alone = [digests_of([seed], steered)[0][0] for seed, steered in ((1, ()), (2, (0,)), (3, (0,)))]
    assert together == alone
    assert [len(order) for order in orders] == [0, 1, 1]
    assert orders[1][0] == VelocityOrder(robot="robot", forward=0.3)
    assert digests_of([2], ())[0][0] != alone[1]
