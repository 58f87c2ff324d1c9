"""Faults of robots: what each does, batches, variants, both worlds, replay, branches, events, wrong input."""

from __future__ import annotations

import dataclasses
import re
from pathlib import Path

import numpy as np
import pytest

from crowdbot.core import InputError, TrialError
from crowdbot.recording import branch, record, replay
from crowdbot.simulation import Episode, FaultOrder, Simulation, simulate, simulate_seeds, simulate_variants
from crowdbot.trials import (
    LocalizationJump,
    LostCommands,
    SlippingWheel,
    Trial,
    apply_values,
    load_trial,
    parse_trial,
    trial_xml,
)

TEXT = """<trial name="faulty" duration="{duration}" step="0.1" world="{world}">
<crowd type="orca"/>
<agent name="p" x="3" y="0.1" goal="-6,0" speed="1"/>
<robot name="bot" x="-3" y="0" radius="0.25" visible="false" sensor-rates="exact"><goal x="3" y="0"/>
<drive type="differential-drive"/><navigator type="orca" safety="0.2"/>
<sensor type="ground-truth-people" name="people" rate="10"/><sensor type="lidar2d" name="scan" rate="10" rays="36"/>
{fault}</robot></trial>"""
KINDS = {
    "frozen": '<fault type="frozen-sensor" begin="1" end="4"/>',
    "blind": '<fault type="blind-sensor" sensor="people" begin="1" end="4"/>',
    "late": '<fault type="late-sensor" delay="1" begin="0.5" end="4"/>',
    "offset": '<fault type="localization-offset" y="0.4" heading="0.1"/>',
    "jump": '<fault type="localization-jump" deviation="0.5" begin="2"/>',
    "lost": '<fault type="lost-commands" share="0.5" begin="1" end="5.5"/>',
    "slip": '<fault type="slipping-wheel" slip="0.4" begin="1" end="3"/>',
}


def _trial(fault: str = "", world: str = "planar", duration: float = 7.0) -> Trial:
    return parse_trial(TEXT.format(fault=fault, world=world, duration=duration))


@pytest.fixture(scope="module")
def healthy() -> Episode:
    return simulate(_trial(), 1)


@pytest.mark.parametrize("kind", KINDS)
def test_a_fault_acts_from_its_begin_and_is_the_same_in_a_batch(kind: str, healthy: Episode) -> None:
    trial = _trial(KINDS[kind])
    assert parse_trial(trial_xml(trial)) == trial
    alone = [simulate(trial, seed) for seed in (1, 2)]
    assert [seed.digest for seed in simulate_seeds(trial, [1, 2])] == [item.digest for item in alone]
    found, fault = alone[0], trial.robots[0].faults[0].fault
    assert found.digest != healthy.digest
    rows = min(len(found.times), len(healthy.times))
    before = found.times[:rows] < fault.begin - 1e-9
    assert np.array_equal(found.position[:rows][before], healthy.position[:rows][before])
    assert np.array_equal(found.commands[:rows][before], healthy.commands[:rows][before])
    events = [(tick, one.fault, one.state) for tick, one in found.orders if isinstance(one, FaultOrder)]
    assert events[0] == (round(fault.begin / 0.1), f"{trial_kind(trial)} 1", "begin")
    if found.times[-1] >= fault.end:
        assert events[1] == (round(fault.end / 0.1), f"{trial_kind(trial)} 1", "end")


def trial_kind(trial: Trial) -> str:
    return re.sub(r"(?<!^)([A-Z])", r"-\1", type(trial.robots[0].faults[0].fault).__name__).lower()


@pytest.mark.parametrize("kind", KINDS)
def test_episodes_replay_branch_and_continue_from_keyframes(kind: str, tmp_path: Path) -> None:
    trial = _trial(KINDS[kind].replace('end="4"', 'end="6.5"').replace('x="3"', 'x="30"'))
    trial = apply_values(trial, {"robot/goal/x": 30, "end/collision": False})
    first = record(trial, 1, tmp_path / "first.mcap")
    assert replay(tmp_path / "first.mcap").equal
    assert branch(tmp_path / "first.mcap", at=5.5).digest == first.digest
    changed = branch(tmp_path / "first.mcap", at=5.5, changes={"robot/drive/max-speed": 0.2})
    assert changed.digest != first.digest


@pytest.mark.parametrize("kind", ["frozen", "late", "lost", "slip"])
def test_faults_act_in_the_physics_world(kind: str) -> None:
    trial = _trial(KINDS[kind], "physics", 2.0)
    found = simulate(trial, 1)
    assert found.digest != simulate(_trial("", "physics", 2.0), 1).digest
    assert found.digest == simulate_seeds(trial, [1, 2])[0].digest


def test_a_frozen_sensor_keeps_people_where_they_were() -> None:
    simulation = Simulation(_trial('<fault type="frozen-sensor" begin="1" end="2"/>'), [3, 4])
    for _ in range(15):
        simulation.advance()
    seen = simulation.observation("bot", 1).people
    true = simulation.world.scene.position[1, 0]
    assert seen.position[0, 0] - true[0] == pytest.approx(0.6, abs=0.02)  # 0.5 s and the step of the last measurement
    for _ in range(6):
        simulation.advance()
    assert np.array_equal(simulation.observation("bot", 1).people.position[0], simulation.world.scene.position[1, 0])


def test_a_blind_sensor_has_no_reading_and_sees_nobody() -> None:
    simulation = Simulation(_trial('<fault type="blind-sensor" begin="1" end="2"/>'))
    for _ in range(15):
        simulation.advance()
    blind = simulation.observation("bot")
    assert (len(blind.people), dict(blind.readings), blind.scan) == (0, {}, None)
    for _ in range(6):
        simulation.advance()
    assert sorted(simulation.observation("bot").readings) == ["people", "scan"]


def test_late_readings_arrive_in_their_order() -> None:
    found = simulate(_trial('<fault type="late-sensor" sensor="scan" delay="0.5" begin="1" end="2"/>'), 1)
    times = [float(np.ravel(reading.time)[0]) for reading in found.readings["bot/scan"]]
    assert times == sorted(times)
    simulation = Simulation(_trial('<fault type="late-sensor" delay="0.5" begin="1" end="3"/>'))
    for _ in range(18):
        simulation.advance()
    observed = simulation.observation("bot")
    assert float(np.ravel(observed.readings["scan"].time)[0]) == pytest.approx(1.3)
    assert observed.people.position[0, 0] - simulation.world.scene.position[0, 0, 0] == pytest.approx(0.5, abs=0.02)


def test_a_late_sensor_of_selected_environments_has_no_rows_of_others() -> None:
    simulation = Simulation(_trial('<fault type="late-sensor" delay="0.5"/>'), range(3))
    for _ in range(4):
        simulation.advance()
    for sensor in simulation.select([2, 0]).robots[0].sensors:
        rows = {name: len(value) for name, value in vars(sensor).items() if isinstance(value, np.ndarray)}
        assert set(rows.values()) == {2}, rows


def test_a_wrong_pose_moves_people_with_it() -> None:
    simulation = Simulation(_trial('<fault type="localization-offset" x="0.3" heading="0.2"/>'))
    observed, scene = simulation.observation("bot"), simulation.world.scene
    assert len(observed.people) == 0  # before the first reading
    simulation.advance()
    observed, scene = simulation.observation("bot"), simulation.world.scene
    assert observed.pose[0] == pytest.approx(float(scene.position[0, 1, 0]) + 0.3)
    assert observed.pose[2] == pytest.approx(float(scene.heading[0, 1]) + 0.2)
    gap = np.linalg.norm(scene.position[0, 0] - scene.position[0, 1])
    assert np.linalg.norm(observed.people.position[0] - observed.position) == pytest.approx(gap)
    assert observed.goal == (3.0, 0.0)


def test_jumps_depend_on_the_seed_with_their_deviation() -> None:
    simulation = Simulation(_trial('<fault type="localization-jump" deviation="0.5" heading="0.1"/>'), range(400))
    simulation.begin()
    errors = [np.array(simulation.observation("bot", e).pose) - (-3.0, 0.0, 0.0) for e in range(400)]
    assert np.std(errors, axis=0) == pytest.approx((0.5, 0.5, 0.1), rel=0.15)
    assert np.mean(errors, axis=0) == pytest.approx((0.0, 0.0, 0.0), abs=0.1)


def test_lost_commands_keep_the_one_before() -> None:
    found = simulate(_trial('<fault type="lost-commands" begin="1" end="3"/>'), 1)
    inside = (found.times >= 1.0 - 1e-9) & (found.times < 3.0 - 1e-9)
    held = found.commands[inside]
    assert np.array_equal(held, np.broadcast_to(found.commands[found.times < 0.95][-1], held.shape))
    half = LostCommands(share=0.25)
    shares = np.random.default_rng(0).random(10_000)
    lost = half.lose_commands(np.tile(half.numbers(), (10_000, 1)), shares)
    assert float(np.mean(lost)) == pytest.approx(0.25, abs=0.02)


def test_a_slipping_wheel_turns_to_its_side() -> None:
    left, right = SlippingWheel(side="left", slip=0.5), SlippingWheel(side="right", slip=0.5)
    command, numbers = np.array([[1.0, 0.0, 0.0]]), np.array([left.numbers()])
    one, two = (fault.change_commands(numbers, command, 0.25) for fault in (left, right))
    assert one.tolist() == [[0.75, 1.0, 0.0]]
    assert two.tolist() == [[0.75, -1.0, 0.0]]
    spin = left.change_commands(numbers, np.array([[0.25, 1.0, 0.0]]), 0.25)  # the left side stands still
    assert spin.tolist() == [[0.25, 1.0, 0.0]]


def test_variants_differ_in_the_numbers_of_faults() -> None:
    trial = _trial(KINDS["frozen"])
    variants = [apply_values(trial, {"robot/fault/begin": begin, "robot/fault/end": 3.5}) for begin in (0.5, 1.0, 1.5)]
    together = simulate_variants(variants, [1, 1, 2])
    alone = [simulate(variant, seed) for variant, seed in zip(variants, (1, 1, 2), strict=True)]
    assert [item.digest for item in together] == [item.digest for item in alone]
    other = apply_values(trial, {"robot/fault/sensor": "scan"})
    with pytest.raises(InputError, match="differ in robots"):
        simulate_variants([trial, other], [1, 1])


def test_a_restart_begins_anew() -> None:
    trial = _trial(KINDS["jump"])
    simulation = Simulation(trial, [1, 2])
    for _ in range(30):
        simulation.advance()
    simulation.restart([0], [2])
    for _ in range(25):
        simulation.advance()
    again = Simulation(trial, [2])
    for _ in range(25):
        again.advance()
    assert simulation.observation("bot", 0).pose == again.observation("bot").pose


@pytest.mark.parametrize(
    ("fault", "message"),
    [
        ('<fault type="frozen-senser"/>', "did you mean 'frozen-sensor'"),
        ('<fault type="frozen-sensor" sensor="laser"/>', "has a fault of the sensor 'laser', which it lacks"),
        ('<fault type="frozen-sensor" begin="3" end="2"/>', "end = 2 s must be after begin = 3 s"),
        ('<fault type="late-sensor" delay="0"/>', "delay = 0 s must be above 0"),
        ('<fault type="lost-commands" share="1.5"/>', "share = 1.5 must be above 0 and at most 1"),
        ('<fault type="slipping-wheel" side="rear"/>', "side = 'rear' must be left or right"),
        ('<fault type="slipping-wheel" sllip="0.2"/>', "did you mean 'slip'"),
        ('<fault type="localization-jump" deviation="-1"/>', "deviation = -1 must be at least 0"),
    ],
)
def test_wrong_faults_are_reported(fault: str, message: str) -> None:
    with pytest.raises(TrialError, match=re.escape(message)):
        _trial(fault)


def test_nobody_can_give_a_fault_order() -> None:
    simulation = Simulation(_trial())
    order = FaultOrder(robot="bot", fault="x", state="begin")
    with pytest.raises(InputError, match="write a <fault> in the trial"):
        order.check(simulation)
    order.apply(simulation)
    assert simulation.tick == 0


def test_trials_without_faults_have_none() -> None:
    trial = load_trial("frontal", duration=1.0)
    assert Simulation(trial).robots[0].faults is None
    spec = dataclasses.replace(trial.robots[0], faults=())
    assert spec == trial.robots[0]
    assert LocalizationJump().numbers() == (0.0, 86_400.0, 0.5, 0.0)
