"""People and robots are added, removed, moved and redirected while a simulation runs."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError
from crowdbot.recording import open_run, read_episode, replay
from crowdbot.simulation import (
    AddPersonOrder,
    MoveOrder,
    Order,
    ParameterOrder,
    RedirectOrder,
    RemoveOrder,
    Simulation,
    SimulationRun,
    VelocityOrder,
    read_order,
    write_order,
)
from crowdbot.trials import Trial, load_trial, parse_trial
from space_trials import LEAN, room
from trial_texts import FLOW

TRIALS = {
    "flow": parse_trial(FLOW),
    "frontal": load_trial("frontal", duration=3.0),
    "planar": parse_trial(room("planar", LEAN)),
    "physics": parse_trial(room("physics", LEAN)),
}


def after(trial: Trial, orders: dict[int, list[Order]], steps: int) -> Simulation:
    run = SimulationRun(Simulation(trial, 3))
    for k in range(steps):
        run.step(orders.get(k, ()))
    return run.simulation


def test_a_new_person_has_the_next_id_and_walks_to_the_goal() -> None:
    trial = TRIALS["frontal"]
    before = Simulation(trial, 3)
    agents = before.world.scene.shape[1]
    simulation = after(trial, {4: [AddPersonOrder(x=-5.0, y=3.0, goal_x=5.0, goal_y=3.0, speed=1.0)]}, 25)
    (slot,) = np.flatnonzero(simulation.world.ids[0] == agents)
    assert simulation.world.scene.position[0, slot] == pytest.approx([-4.0, 3.0], abs=0.2)
    record = simulation.record()
    assert record.ids.tolist() == list(range(agents + 1))
    assert record.scene.shape == (1, agents + 1)


@pytest.mark.parametrize("name", ["frontal", "physics"])
def test_who_is_removed_is_gone_and_who_is_moved_is_elsewhere(name: str) -> None:
    trial = TRIALS[name]
    simulation = after(trial, {2: [RemoveOrder(person=0)]}, 4)
    assert not simulation.world.scene.active[0, 0]
    with pytest.raises(InputError, match=r"there is nobody with the id 0; present are 1"):
        RemoveOrder(person=0).check(simulation)
    robot = trial.people
    moved = after(trial, {2: [MoveOrder(person=robot, x=2.0, y=6.0, heading=1.0)]}, 3)
    assert moved.world.scene.position[0, robot] == pytest.approx([2.0, 6.0], abs=0.1)
    assert moved.world.scene.heading[0, robot] == pytest.approx(1.0, abs=0.1)


@pytest.mark.parametrize("name", ["planar", "physics"])
def test_people_beyond_the_bodies_of_a_trial_get_bodies_and_replay(name: str, tmp_path: Path) -> None:
    """The room has bodies for its people only; six more come, are seen by a laser in space, and replay."""
    trial, file = TRIALS[name], tmp_path / "episode.mcap"
    agents = Simulation(trial, 3).world.scene.shape[1]
    more = [AddPersonOrder(x=3.0 + 0.7 * k, y=5.0, goal_x=3.0, goal_y=1.0) for k in range(6)]
    with open_run(trial, 3, out=file) as running:
        for k in range(12):
            running.step(more[:3] if k == 2 else more[3:] if k == 5 else ())
        world = running.simulation.world
        assert world.scene.shape == (1, agents + 6)
        assert sorted(world.ids[0].tolist())[-1] == agents + 5
        if name == "physics":
            assert world.people is not None
            assert len(world.people.people) == agents - 1 + 6
            new = np.isin(world.people.agents, np.arange(agents, agents + 6))
            feet = world.people.ends[new][:, :, [0, 1]].mean(axis=1)
            np.testing.assert_allclose(feet, world.scene.position[0, world.people.agents[new]], atol=0.3)
    assert len(read_episode(file).orders) == 6
    assert replay(file).equal


def test_people_are_added_to_one_environment_with_bodies() -> None:
    trial = TRIALS["physics"]
    run, alone = SimulationRun(Simulation(trial, [3, 3])), SimulationRun(Simulation(trial, 3))
    run.step([AddPersonOrder(x=3.0, y=5.0, goal_x=3.0, goal_y=1.0, environment=1)])
    alone.step()
    for _ in range(5):
        run.step()
        alone.step()
    first = alone.simulation.record().scene
    assert run.simulation.record(0).scene.digest() == first.digest()
    assert run.simulation.record(1).scene.active.sum() == first.active.sum() + 1


def test_a_person_with_another_goal_turns_around() -> None:
    trial = TRIALS["frontal"]
    x, y = Simulation(trial, 3).world.scene.position[0, 0].tolist()
    straight = after(trial, {}, 40).world.scene.position[0, 0]
    turned = after(trial, {1: [RedirectOrder(person=0, x=x, y=y + 20.0)]}, 40).world.scene.position[0, 0]
    assert turned[1] > straight[1] + 0.8


def test_orders_reach_only_their_environment() -> None:
    trial = TRIALS["frontal"]
    run = SimulationRun(Simulation(trial, [3, 3, 3]))
    alone = SimulationRun(Simulation(trial, 3))
    run.step([RemoveOrder(person=0, environment=1), AddPersonOrder(x=0, y=4, goal_x=1, goal_y=4, environment=2)])
    alone.step()
    for _ in range(10):
        run.step()
        alone.step()
    first = alone.simulation.record().scene
    assert run.simulation.record(0).scene.digest() == first.digest()
    assert run.simulation.record(1).scene.active.sum() == first.active.sum() - 1
    assert run.simulation.record(2).scene.active.sum() == first.active.sum() + 1


def test_a_parameter_changes_while_it_runs() -> None:
    trial = TRIALS["frontal"]
    slow = after(trial, {1: [ParameterOrder(path="robot/drive/max-speed", value="0.1")]}, 40)
    assert slow.trial.robots[0].drive.max_speed == 0.1
    assert np.hypot(*slow.world.scene.velocity[0, trial.people]) <= 0.1 + 1e-9
    with pytest.raises(InputError, match="step cannot change"):
        ParameterOrder(path="step", value="0.01").check(slow)


ORDERS = st.one_of(
    st.builds(VelocityOrder, robot=st.sampled_from(["robot", "puck", "hal"]), forward=st.floats(-9, 9)),
    st.builds(RemoveOrder, person=st.integers(-3, 12)),
    st.builds(MoveOrder, person=st.integers(-1, 9), x=st.floats(-20, 20), y=st.floats(-20, 20)),
    st.builds(RedirectOrder, person=st.integers(-1, 9), x=st.floats(), y=st.floats(-20, 20)),
    st.builds(
        AddPersonOrder, x=st.floats(0, 10), y=st.floats(0, 7), goal_x=st.floats(0, 10), goal_y=st.floats(),
        speed=st.floats(-1, 30), radius=st.floats(-0.1, 1.0),
    ),
    st.builds(
        ParameterOrder, path=st.sampled_from(["robot/x", "duration", "crowd/time-horizon", "nothing"]),
        value=st.sampled_from(["1", "-1", "x"]),
    ),
)  # fmt: skip


@pytest.mark.parametrize("name", ["flow", "planar", "physics"])
@given(sequence=st.lists(st.lists(ORDERS, max_size=4), min_size=3, max_size=8))
@settings(max_examples=6, deadline=None)
def test_any_orders_are_refused_clearly_or_replay(
    name: str, sequence: list[list[Order]], tmp_path_factory: pytest.TempPathFactory
) -> None:
    file = tmp_path_factory.mktemp("orders") / "episode.mcap"
    taken = 0
    with open_run(TRIALS[name], 3, out=file) as running:
        for orders in sequence:
            good = []
            for order in orders:
                try:
                    order.check(running.simulation)
                except InputError:
                    continue
                assert read_order(write_order(order)) == order
                good.append(order)
            if running.outcome is not None:
                break
            running.step(good)
            taken += len(good)
        scene = running.simulation.world.scene
        assert np.isfinite(scene.position[scene.active]).all()
        refused = len(running.refusals)
    assert len(read_episode(file).orders) == taken - refused
    assert replay(file).equal


@pytest.mark.parametrize(
    ("order", "message"),
    [
        (AddPersonOrder(x=0, y=0, goal_x=1, goal_y=0, speed=0.0), "speed = 0.0 must be above 0 and at most 20"),
        (AddPersonOrder(x=0, y=0, goal_x=1e9, goal_y=0), "must be finite and at most 1e\\+06 m away"),
        (MoveOrder(person=0, x=float("nan"), y=0), "x = nan, y = 0 m must be finite"),
        (RemoveOrder(person=4), "4 is the id of a robot|nobody with the id 4"),
        (ParameterOrder(path="robot/nothing", value="1"), "nothing"),
    ],
)
def test_impossible_orders_are_explained(order: Order, message: str) -> None:
    simulation = Simulation(TRIALS["frontal"], 3)
    with pytest.raises(InputError, match=message):
        order.check(simulation)


def test_steered_runs_of_a_file_name_their_orders(tmp_path: Path) -> None:
    with open_run(TRIALS["frontal"], 3, out=tmp_path) as running:
        running.step([RemoveOrder(person=0, source="page")])
        running.step()
    ((time, order),) = read_episode(tmp_path / "episode.mcap").orders
    assert (time, order) == (0.0, RemoveOrder(person=0, source="page"))
