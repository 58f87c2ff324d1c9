"""Time steps: `crowdbot check` accepts any step that no period is shorter than."""

from pathlib import Path

import pytest

from crowdbot.cli import main
from crowdbot.core import FreeClock, TrialError
from crowdbot.trials import parse_trial, trial_remarks

HALL = """<trial name="hall" duration="2" step="{step}">
  <crowd type="orca"/>
  <robot x="0" y="0" control-period="{control}" radius="0.3">
    <goal x="3" y="0"/><drive type="omnidirectional"/><navigator type="straight"/>
    <sensor name="laser" type="lidar-2d" rays="4" rate="{rate}" delay="0.03"/>
  </robot>
  <recording period="{period}"/>
</trial>
"""
PEPPER = """<trial name="pepper" duration="2" step="{step}">
  <crowd type="orca"/>
  <robot type="pepper" x="0" y="0" sensor-rates="{rates}"><goal x="3" y="0"/><navigator type="straight"/></robot>
</trial>
"""
FIT = {"control": 0.1, "rate": 10, "period": 0.1}


@pytest.mark.parametrize("step", ["0.016666667", "0.0138888889", "0.0111111111", "0.07", "0.1"])
def test_steps_that_divide_no_period_pass(step: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    place = tmp_path / "hall.xml"
    place.write_text(HALL.format(step=step, **FIT))
    assert main(["check", str(place)]) == 0
    assert "OK" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("changed", "sentence"),
    [
        (
            {"control": 0.05},
            "<robot> control-period 0.05 s is shorter than the time step of 0.07 s; take at least 0.07 s",
        ),
        ({"rate": 20}, "<sensor> rate 20 Hz: 0.05 s is shorter than the time step of 0.07 s"),
        ({"period": 0.06}, "<recording> period 0.06 s is shorter than the time step of 0.07 s"),
    ],
)
def test_a_period_shorter_than_the_step_is_an_error(changed: dict[str, float], sentence: str) -> None:
    with pytest.raises(TrialError, match=sentence):
        parse_trial(HALL.format(step=0.07, **FIT | changed), place="hall.xml")


def test_exact_rates_of_a_type_are_kept_on_average() -> None:
    trial = parse_trial(PEPPER.format(step="0.01", rates="exact"), place="pepper.xml")
    robot, clock = trial.robots[0], FreeClock(0.01)
    plans = {mount.name: robot.schedule(mount, clock) for mount in robot.sensors}
    depth = plans["laser_front"]  # 6.25 Hz
    assert sum(depth.measures(tick) for tick in range(1600)) == 100
    assert trial_remarks(trial) == []
    with pytest.raises(TrialError, match=r"measure more than once per time step of 0.04 s: .*imu 100 Hz"):
        parse_trial(PEPPER.format(step="0.04", rates="exact"), place="pepper.xml")


def test_rounded_rates_are_named_with_a_way_to_keep_them() -> None:
    trial = parse_trial(PEPPER.format(step="0.009", rates="nearest"), place="pepper.xml")
    assert any("rounds the periods of its sensors" in sentence for sentence in trial_remarks(trial))
    coarse = parse_trial(PEPPER.format(step="0.05", rates="nearest"), place="pepper.xml")
    assert not any('sensor-rates="exact"' in sentence for sentence in trial_remarks(coarse))
