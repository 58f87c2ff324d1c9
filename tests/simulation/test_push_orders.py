"""A push is a force on a person for a time: in the plane, in the physics world, in copies, recordings and replays."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np
import pytest

from crowdbot.cli import main
from crowdbot.core import InputError
from crowdbot.recording import open_run, read_episode, replay
from crowdbot.simulation import (
    AddPersonOrder,
    OrderSchedule,
    PushOrder,
    RemoveOrder,
    Simulation,
    read_order,
    restore_state,
    simulate,
    state_of,
    write_order,
)
from crowdbot.trials import parse_trial

TRIAL = """<trial name="pushed" duration="{duration}" {world} step="0.05" seed="1"><stage>{walls}</stage>
<crowd type="orca"/><agent name="one" x="0" y="0" heading="{heading}" body="{body}" speed="0.001"/>
<agent name="two" x="0" y="5" body="man-36" speed="0.001"/>{more}</trial>"""
PLANAR, PHYSICS, BALANCE = "", 'world="physics"', 'world="physics" balance="true"'
MASS = {}


def trial(world: str = PLANAR, body: str = "man-24", heading: float = 0.0, walls: str = "", duration: float = 3.0,
          more: str = "") -> object:  # fmt: skip
    return parse_trial(TRIAL.format(world=world, body=body, heading=heading, walls=walls, duration=duration, more=more))


def pushed(simulation: Simulation, order: PushOrder, steps: int = 40) -> np.ndarray:
    """Return position and velocity of the person ``[steps, 4]`` after an order."""
    simulation.begin()
    order.check(simulation)
    order.apply(simulation)
    rows = []
    for _ in range(steps):
        simulation.advance()
        scene = simulation.world.environment_scene(order.environment)
        rows.append([*scene.position[0, order.person], *scene.velocity[0, order.person]])
    assert simulation.failures[order.environment] is None
    return np.array(rows)


def mass_of(world: str, body: str) -> float:
    """Return the mass of the body in a simulation with bodies."""
    people = Simulation(trial(PHYSICS, body), 1).world.people
    return float(people.people.mass[people.row[0]])


@pytest.mark.parametrize("world", [PLANAR, PHYSICS])
@pytest.mark.parametrize("direction", [0.0, 2.0])
def test_a_short_push_changes_the_velocity_by_impulse_over_mass(world: str, direction: float) -> None:
    rows = pushed(Simulation(trial(world), 1), PushOrder(person=0, force=600, direction=direction, duration=0.05), 2)
    away = rows[0, 2:] @ np.array([math.cos(direction), math.sin(direction)])
    assert away == pytest.approx(600 * 0.05 / mass_of(world, "man-24"), abs=0.02)  # nobody reacts within 0.05 s
    assert abs(rows[0, 2:] @ np.array([-math.sin(direction), math.cos(direction)])) < 0.01


def test_heavier_people_are_moved_less() -> None:
    order = PushOrder(person=0, force=400, duration=0.1)
    ways = [pushed(Simulation(trial(body=body), 1), order)[-1, 0] for body in ("woman-24", "man-50")]
    assert ways[0] > ways[1] > 0.05


def test_people_recover_alike_in_the_plane_and_in_the_physics_world() -> None:
    order = PushOrder(person=0, force=300, direction=0.0, duration=0.4)
    plane, engine = (pushed(Simulation(trial(world), 1), order) for world in (PLANAR, PHYSICS))
    assert np.abs(plane[-10:, 2:]).max() < 0.03  # both stand again
    assert np.abs(engine[-10:, 2:]).max() < 0.03
    assert plane[:, 0].max() == pytest.approx(engine[:, 0].max(), rel=0.15)
    assert plane[:, 2].max() == pytest.approx(engine[:, 2].max(), rel=0.1)


def test_nobody_else_moves_and_without_a_push_nothing_changes() -> None:
    one, other = Simulation(trial(), 1), Simulation(trial(), 1)
    pushed(one, PushOrder(person=0, force=300, duration=0.3), 20)
    other.begin()
    for _ in range(20):
        other.advance()
    assert np.array_equal(one.world.scene.position[0, 1], other.world.scene.position[0, 1])
    assert "push" not in other.world.scene.memory


@pytest.mark.parametrize("world", [PLANAR, PHYSICS])
def test_a_wall_stops_a_pushed_person(world: str) -> None:
    walls = '<wall points="0.5,-3 0.5,3"/>'
    rows = pushed(Simulation(trial(world, walls=walls), 1), PushOrder(person=0, force=2000, duration=0.2))
    assert 0.1 < rows[:, 0].max() < 0.5
    assert np.abs(rows[-1, 2:]).max() < 0.1


def test_with_balance_people_brace_step_or_fall_by_the_force() -> None:
    found = []
    for force in (40, 250, 900):
        simulation = Simulation(trial(BALANCE, "woman-72", duration=6.0), 1)
        pushed(simulation, PushOrder(person=0, force=force, direction=0.0, duration=0.25))
        world = simulation.world
        found.append((int(world.falling.balance.steps[0]), [fall.direction for fall in world.falls]))
    assert found[0] == (0, [])
    assert found[1][0] >= 1
    assert found[1][1] == []
    assert found[2][1] == ["forward"]


@pytest.mark.parametrize(("direction", "word"), [(math.pi, "backward"), (math.pi / 2, "left"), (-math.pi / 2, "right")])
def test_the_direction_of_the_fall_is_that_of_the_push(direction: float, word: str) -> None:
    simulation = Simulation(trial(BALANCE, "woman-72", duration=6.0), 1)
    pushed(simulation, PushOrder(person=0, force=900, direction=direction, duration=0.25))
    (fall,) = simulation.world.falls
    assert (fall.person, fall.direction, fall.cause, fall.causer) == (0, word, "", -1)


def test_a_second_push_replaces_the_rest_of_the_first() -> None:
    simulation = Simulation(trial(), 1)
    pushed(simulation, PushOrder(person=0, force=100, duration=5.0), 2)
    PushOrder(person=0, force=100, duration=0.05).apply(simulation)
    for _ in range(30):
        simulation.advance()
    assert np.abs(simulation.world.scene.velocity[0, 0]).max() < 0.05
    assert not simulation.world.scene.memory["push"].any()


def test_an_environment_is_pushed_as_alone() -> None:
    orders = [PushOrder(person=0, force=300, duration=0.3, environment=e) for e in (0, 1)]
    for world in (PLANAR, BALANCE):
        alone = pushed(Simulation(trial(world), 5), orders[0], 20)
        together = pushed(Simulation(trial(world), [4, 5, 6]), orders[1], 20)
        assert np.array_equal(alone, together)


def test_copies_and_restarts_keep_or_forget_a_push() -> None:
    whole = Simulation(trial(), [1, 2])
    pushed(whole, PushOrder(person=0, force=300, duration=0.5, environment=1), 4)
    copy = whole.select([1, 0])
    whole.advance()
    copy.advance()
    assert np.array_equal(copy.world.scene.position[0], whole.world.scene.position[1])
    whole.restart([1], [2])
    assert not whole.world.scene.memory["push"].any()


@pytest.mark.parametrize("world", [PLANAR, BALANCE])
def test_the_state_of_a_run_holds_a_push(world: str) -> None:
    first, second = Simulation(trial(world), 1), Simulation(trial(world), 1)
    pushed(first, PushOrder(person=0, force=500, duration=0.4), 6)
    restore_state(second, state_of(first))
    for _ in range(12):
        first.advance()
        second.advance()
    assert np.array_equal(first.world.scene.position, second.world.scene.position)


@pytest.mark.parametrize("world", [PLANAR, BALANCE])
def test_a_push_is_recorded_and_replays_to_the_byte(world: str, tmp_path: Path) -> None:
    order = PushOrder(person=0, force=700, direction=0.5, duration=0.4, source="test")
    for name in ("a", "b"):
        with open_run(trial(world), out=tmp_path / name) as running:
            while running.outcome is None:
                running.step([order] if running.simulation.tick == 8 else [])
    one, two = ((tmp_path / name / "episode.mcap").read_bytes() for name in ("a", "b"))
    assert one == two
    episode = read_episode(tmp_path / "a" / "episode.mcap")
    assert episode.orders == ((0.4, order),)
    assert np.ptp(episode.position[:, 0, 0]) > 0.2
    assert replay(tmp_path / "a" / "episode.mcap").equal


def test_somebody_who_has_left_or_come_later_can_be_pushed(tmp_path: Path) -> None:
    simulation = Simulation(trial(), 1)
    simulation.begin()
    order = PushOrder(person=0, force=300, duration=0.5)
    order.apply(simulation)
    RemoveOrder(person=0).apply(simulation)
    order.apply(simulation)
    simulation.advance()
    AddPersonOrder(x=2.0, y=0.0, goal_x=2.0, goal_y=0.0, speed=0.001).apply(simulation)
    new = int(simulation.world.ids[0].max())
    simulation.advance()
    slot = int(np.flatnonzero(simulation.world.ids[0] == new)[0])
    assert np.abs(simulation.world.scene.velocity[0, slot]).max() < 0.01  # the push was for the person before
    PushOrder(person=new, force=300, duration=0.1).apply(simulation)
    simulation.advance()
    assert simulation.world.scene.velocity[0, slot, 0] > 0.1


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"force": 0}, "force = 0 N must be above 0 and at most 5000"),
        ({"force": float("nan")}, "force = nan N must be above 0"),
        ({"force": 9000}, "force = 9000 N must be above 0 and at most 5000"),
        ({"force": 10, "duration": 60}, "duration = 60 s must be above 0 and at most 10"),
        ({"force": 10, "direction": math.inf}, "direction = inf rad must be finite"),
        ({"force": 5000, "duration": 1}, "force \\* duration = 5000 N s must be at most 500"),
    ],
)
def test_impossible_pushes_are_explained(values: dict[str, float], message: str) -> None:
    with pytest.raises(InputError, match=message):
        PushOrder(person=0, **values)


def test_robots_avatars_recorded_people_and_nobody_cannot_be_pushed() -> None:
    others = (
        '<robot name="r" type="turtlebot2" x="4" y="0" default-sensors="false"><goal x="5" y="0"/>'
        '<navigator type="straight"/></robot><avatar name="you" source="external" x="3" y="3"/>'
    )
    simulation = Simulation(trial(more=others), 1)
    refusals = {3: "3 is the id of a robot", 2: "2 is the id of avatar 'you'", 9: "nobody with the id 9"}
    for person, message in refusals.items():
        with pytest.raises(InputError, match=message):
            PushOrder(person=person, force=10).check(simulation)


def test_a_push_is_written_and_read() -> None:
    order = PushOrder(person=3, force=200, direction=1.5, duration=0.25)
    assert write_order(order) == '{"order": "push", "person": 3, "force": 200, "direction": 1.5, "duration": 0.25}'
    assert read_order(write_order(order)) == order


def test_a_file_of_orders_steers_a_run_of_the_command_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "hall.xml").write_text(TRIAL.format(
        world=PLANAR, body="man-24", heading=0, walls="", duration=2, more=""), encoding="utf-8")  # fmt: skip
    rows = [{"time": 0.52, "order": "push", "person": 1, "force": 300}, {"time": 0.2, "order": "remove", "person": 0}]
    (tmp_path / "orders.jsonl").write_text("\n\n".join(map(json.dumps, rows)), encoding="utf-8")
    words = [str(tmp_path / "hall.xml"), "--orders", str(tmp_path / "orders.jsonl")]
    assert main(["run", *words, "--out", str(tmp_path / "out")]) == 0
    episode = read_episode(tmp_path / "out" / "episode.mcap")
    times = [(pytest.approx(0.2), RemoveOrder(person=0)), (pytest.approx(0.55), PushOrder(person=1, force=300))]
    assert list(episode.orders) == times
    assert replay(tmp_path / "out" / "episode.mcap").equal
    capsys.readouterr()
    assert main(["run", *words[:2], str(tmp_path / "none.jsonl")]) == 2
    assert "cannot read the orders" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("{", "line 2: not JSON"),
        ("[1]", "line 2: an order must be a JSON object"),
        ('{"order": "push", "person": 1, "force": 9}', "line 2: time = None must be a number of seconds"),
        ('{"time": -1, "order": "push", "person": 1, "force": 9}', "line 2: time = -1 must be a number"),
        ('{"time": 1, "order": "shove"}', "line 2: order 'shove' is unknown"),
        ('{"time": 1, "order": "push", "person": 1}', "line 2: order 'push' lacks force"),
    ],
)
def test_a_wrong_line_of_orders_is_named(line: str, message: str, tmp_path: Path) -> None:
    (tmp_path / "orders.jsonl").write_text(f"\n{line}\n", encoding="utf-8")
    with pytest.raises(InputError, match=message):
        OrderSchedule.read(tmp_path / "orders.jsonl")


FALL_TRIAL = """<trial name="fall" duration="6" world="physics" balance="{balance}" step="0.05"><stage/>
<crowd type="orca"/><agent x="0" y="0" body="woman-72" speed="0.001"/><end fall="true"/></trial>"""


def test_a_fall_ends_a_trial_that_asks_for_it(tmp_path: Path) -> None:
    with open_run(parse_trial(FALL_TRIAL.format(balance="true")), out=tmp_path) as running:
        while running.outcome is None:
            running.step([PushOrder(person=0, force=900, duration=0.25)] if running.simulation.tick == 4 else [])
    assert running.outcome == "fall"
    episode = read_episode(tmp_path / "episode.mcap")
    (fall,) = episode.falls
    assert episode.outcome == "fall"
    assert fall.end <= episode.times[-1] < fall.end + 0.2
    assert replay(tmp_path / "episode.mcap").equal
    assert simulate(parse_trial(FALL_TRIAL.format(balance="true")), 0).outcome == "finished"  # nobody falls


def test_falls_end_only_trials_in_which_people_can_fall() -> None:
    with pytest.raises(InputError, match='<end fall="true"> needs people who can fall: world="physics" and balance='):
        parse_trial(FALL_TRIAL.format(balance="false"))
