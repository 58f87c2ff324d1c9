"""Joints of robots move while a simulation runs, with the sensors on their links."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError
from crowdbot.recording import branch, open_run, replay
from crowdbot.simulation import (
    JointOrder,
    Order,
    Simulation,
    SimulationRun,
    apply_overrides,
    read_order,
    write_order,
)
from crowdbot.trials import Trial, apply_values, parse_trial
from crowdbot.world import Robot, free_joints

WORLDS = ("planar", "physics")


def lab(world: str = "planar", bodies: str = "") -> Trial:
    """Return a trial with a standing Pepper whose scanner turns with its head, and a box on its left."""
    shape = f' bodies="{bodies}"' if bodies else ""
    return parse_trial(f"""<trial name="lab" duration="1.2" step="0.04" world="{world}"{shape}>
      <stage><obstacle points="1,3 3,3 3,4 1,4"/></stage>
      <crowd type="orca"/>
      <agent x="8" y="0" goal="8,1"/>
      <robot name="pepper" type="pepper" x="2" y="0" default-sensors="false" control-period="0.08">
        <goal x="2" y="-9"/>
        <navigator type="external"/>
        <sensor name="eyes" type="lidar2d" link="Head" rays="31" rate="25"/>
        <sensor name="base" type="lidar2d" rays="31" rate="25"/>
      </robot>
      <robot name="watch" x="2" y="-2" radius="0.2" heading="1.57">
        <goal x="9" y="-2"/>
        <drive type="differential-drive"/>
        <navigator type="external"/>
        <sensor name="rings" type="lidar3d" z="0.9" rate="25" columns="120"/>
      </robot>
      <end collision="false" goal="false"/>
      <recording period="0.04"/>
    </trial>""")


def run(trial: Trial, orders: dict[int, list[Order]], steps: int, seeds: Any = 3) -> SimulationRun:
    simulation_run = SimulationRun(Simulation(trial, seeds))
    for k in range(steps):
        simulation_run.step(orders.get(k, ()))
    return simulation_run


def yaw(simulation: Simulation, environment: int = 0, sensor: int = 0) -> float:
    """Return the heading of a sensor of Pepper relative to the robot [rad]."""
    control = simulation.robots[0]
    pose: Any = control.sensors[sensor].pose(control.agent, simulation.around, environment)
    pose = pose if hasattr(pose, "heading") else pose.planar
    return float(np.atleast_1d(pose.heading)[0] - simulation.world.pose(control.agent).heading[environment])


def turn(position: float, **others: Any) -> JointOrder:
    return JointOrder(robot="pepper", joint="HeadYaw", position=position, **others)


def test_an_order_is_written_and_read() -> None:
    text = '{"order": "joint", "robot": "pepper", "joint": "HeadYaw", "position": 0.5}'
    assert write_order(turn(0.5)) == text
    assert read_order(text) == turn(0.5)


@pytest.mark.parametrize("world", WORLDS)
@pytest.mark.parametrize("bodies", ["", "limbs"])
def test_a_sensor_on_the_head_turns_with_it_and_keeps_the_target(world: str, bodies: str) -> None:
    simulation = run(lab(world, bodies), {2: [turn(1.2)]}, 25).simulation
    tolerance = 1e-6 if world == "planar" else 0.05
    assert yaw(simulation) == pytest.approx(1.2, abs=tolerance)
    assert yaw(simulation, sensor=1) == pytest.approx(0.0, abs=1e-6)
    back = run(lab(world, bodies), {2: [turn(1.2)], 12: [turn(-0.4)]}, 25).simulation
    assert yaw(back) == pytest.approx(-0.4, abs=tolerance)


def test_the_scan_in_the_plane_is_that_of_a_turned_sensor() -> None:
    turned = run(lab(), {0: [turn(math.pi / 2)]}, 2).simulation
    straight = run(lab(), {}, 2).simulation
    ahead = [item.robots[0].sensors[0].reading(0).ranges[0, 15] for item in (turned, straight)]
    assert ahead[0] == pytest.approx(3.0, abs=0.1)
    assert ahead[1] > 5.0


@pytest.mark.parametrize("world", WORLDS)
def test_other_robots_see_the_moved_arm(world: str) -> None:
    lift = [JointOrder(robot="pepper", joint="LShoulderPitch", position=-0.2)]
    moved, same = (run(lab(world, "limbs"), orders, 25).simulation for orders in ({1: lift}, {}))
    found = [item.world.body_scene().bodies for item in (moved, same)]
    assert not np.array_equal(found[0].start, found[1].start) or not np.array_equal(
        found[0].box_centre, found[1].box_centre
    )
    scans = [item.robots[1].sensors[0].reading(0).ranges for item in (moved, same)]
    assert not np.array_equal(*scans)


@pytest.mark.parametrize("world", WORLDS)
@pytest.mark.parametrize("bodies", ["", "limbs"])
def test_joints_of_environments_are_independent(world: str, bodies: str) -> None:
    trial = lab(world, bodies)
    many = run(trial, {2: [turn(0.3, environment=0), turn(-0.7, environment=2)]}, 9, [3, 4, 5]).simulation
    for e, target in enumerate((0.3, None, -0.7)):
        alone = run(trial, {} if target is None else {2: [turn(target)]}, 9, 3 + e).simulation
        for reading, other in zip(many.new_readings(e), alone.new_readings(), strict=True):
            np.testing.assert_array_equal(reading[2].ranges, other[2].ranges)  # type: ignore[attr-defined]
        assert yaw(many, e) == pytest.approx(yaw(alone), abs=1e-12)


@pytest.mark.parametrize("world", WORLDS)
def test_copies_keep_the_posture_and_restarts_lose_it(world: str) -> None:
    simulation = run(lab(world), {1: [turn(1.0, environment=1)]}, 20, [3, 4]).simulation
    some = simulation.select([1, 0, 1])
    some.restart([0], [9])
    simulation.advance()
    some.advance()
    assert yaw(some, 0) == pytest.approx(0.0, abs=0.02)
    assert yaw(some, 2) == pytest.approx(yaw(simulation, 1), abs=1e-12)
    assert yaw(some, 2) == pytest.approx(1.0, abs=0.05)


@pytest.mark.parametrize("world", WORLDS)
@pytest.mark.parametrize("bodies", ["", "limbs"])
def test_a_run_with_joint_orders_replays_and_can_be_branched(world: str, bodies: str, tmp_path: Path) -> None:
    file = tmp_path / "episode.mcap"
    with open_run(lab(world, bodies), 3, out=file) as running:
        while running.outcome is None:
            tick = running.simulation.tick
            running.step([turn(0.1 * tick)] if tick % 5 == 1 and tick < 20 else [])
    done = replay(file)
    assert done.equal
    assert branch(file, at=0.32).digest == done.recorded
    assert branch(file, at=0.32, orders=False).digest != done.recorded
    changed = branch(file, at=0.6, changes={"robot[watch].drive.max-speed": 0.2}, out=tmp_path / "b.mcap")
    assert replay(tmp_path / "b.mcap").replayed == changed.digest


def test_a_changed_trial_keeps_the_posture() -> None:
    running = run(lab("planar", "limbs"), {1: [turn(0.8)]}, 4)
    apply_overrides(running.simulation, apply_values(running.simulation.trial, {"robot[pepper].latency": 0.1}))
    running.step()
    assert yaw(running.simulation) == pytest.approx(0.8)
    assert running.simulation.world._bodies[0].joints  # type: ignore[attr-defined]


def test_a_joint_without_a_position_motor_is_held() -> None:
    simulation = Simulation(lab("physics"), 3)
    simulation.begin()
    body = simulation.world.robot_body(simulation.robots[0].agent)  # type: ignore[attr-defined]
    motor = body._motor("HeadYaw")
    body._model.actuator_biasprm[motor, 1] = 0.0  # as a velocity motor
    turn(0.9).apply(simulation)
    for _ in range(5):
        simulation.advance()
    assert body.joints()["HeadYaw"][0] == pytest.approx(0.9, abs=0.01)


@pytest.mark.parametrize(
    ("order", "sentence"),
    [
        ({"robot": "hal"}, "there is no robot 'hal'; the trial has pepper, watch"),
        (
            {"joint": "HeadYaww"},
            "robot 'pepper': pepper has no joint 'HeadYaww' that can be moved, did you mean 'HeadYaw'",
        ),
        ({"joint": "WheelFL"}, "pepper has no joint 'WheelFL' that can be moved"),
        ({"robot": "watch"}, "has no joint 'HeadYaw' that can be moved; it has none"),
        ({"position": 3.0}, "cannot be at 3 rad; it moves from -2.08567 to 2.08567 rad"),
        ({"position": math.nan}, "cannot be at nan rad"),
        ({"joint": "HeadPitch", "position": 0.2}, "would tilt the sensor 'eyes', which measures discs in the plane"),
        ({"environment": 3}, "environment = 3 must be from 0 to 0"),
    ],
)
def test_an_impossible_order_is_refused(order: dict[str, Any], sentence: str) -> None:
    simulation = Simulation(lab(), 3)
    simulation.begin()
    with pytest.raises(InputError, match=sentence):
        JointOrder(**{"robot": "pepper", "joint": "HeadYaw", "position": 0.1, **order}).check(simulation)
    assert np.isnan(simulation.robots[0].joints).all()


@settings(max_examples=25, deadline=None)
@given(name=st.sampled_from(free_joints(Robot.load("pepper"))), share=st.floats(-0.5, 1.5))
def test_positions_within_the_limits_are_taken(name: str, share: float) -> None:
    simulation = Simulation(lab("planar", "limbs"), 3)
    simulation.begin()
    joint = simulation.robots[0].robot.body.model.joints[name]
    position = joint.lower + share * (joint.upper - joint.lower)
    order = JointOrder(robot="pepper", joint=name, position=position)
    if not joint.lower <= position <= joint.upper:
        with pytest.raises(InputError, match="it moves from"):
            order.check(simulation)
        return
    order.check(simulation)
    order.apply(simulation)
    simulation.advance()
    assert simulation.record().scene.active.all()
    assert np.nansum(simulation.robots[0].joints) == pytest.approx(position)
