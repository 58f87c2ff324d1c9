"""Who rides in a wheelchair: seated, seen as a part of the robot, and refused where there is no seat."""

from __future__ import annotations

import numpy as np
import pytest

from crowdbot.core import Scene, TrialError
from crowdbot.humans import LIMBS
from crowdbot.rendering import RenderRequest, render_images
from crowdbot.simulation import Simulation, SimulationRun
from crowdbot.trials import parse_trial, trial_xml
from crowdbot.world import PeopleMotion
from trial_schema import valid

ROOM = """<trial name="ride" duration="4" seed="3" step="0.05">
  <stage walkable="-6,-4 6,-4 6,4 -6,4"/>
  <crowd type="orca"/>
  <agent x="2" y="1.5" goal="-5,1.5" body="man"/>
  <robot name="scout" x="1" y="-2">
    <goal x="5" y="-2"/><drive type="differential-drive"/><navigator type="straight"/>
    <sensor name="scan" type="lidar2d" rays="2" z="0.9" heading="2.356" field-of-view="0.02"/>
  </robot>
  <robot name="chair" type="wheelchair" rider="woman-36" default-sensors="false" x="-1" y="0" heading="0.3">
    <goal x="4" y="0"/><navigator type="orca" speed="0.8"/>
  </robot>
  <camera name="side" x="-0.5" y="-3.4" z="1.5" heading="1.57" pitch="0.2" width="96" height="72"/>
</trial>"""
NAMES = [limb.name for limb in LIMBS]


def simulated(world: str, text: str = ROOM) -> Simulation:
    trial = parse_trial(text.replace('seed="3"', f'seed="3" world="{world}"'))
    simulation = Simulation(trial, 3, posed=True)
    running = SimulationRun(simulation)
    for _ in range(40):
        running.step()
    return simulation


def walkers_of(simulation: Simulation) -> PeopleMotion:
    found = simulation.world.people
    assert found is not None
    return found


@pytest.mark.parametrize("world", ["planar", "physics"])
def test_the_rider_sits_in_the_chair_wherever_it_goes(world: str) -> None:
    simulation = simulated(world)
    walkers, scene = walkers_of(simulation), simulation.world.scene
    chair = simulation.trial.people + 1
    assert walkers.agents.tolist() == [0, chair]
    assert walkers.afoot.tolist() == [0]
    assert walkers.people.persons[1].name == "woman-36"
    ends = walkers.ends[1].reshape(-1, 2, 3)
    heading = float(scene.heading[0, chair])
    turn = np.array([[np.cos(heading), np.sin(heading)], [-np.sin(heading), np.cos(heading)]])
    own = (ends[..., :2] - scene.position[0, chair]) @ turn.T
    hip, knee = own[NAMES.index("thigh_l")], ends[NAMES.index("thigh_l")]
    assert np.hypot(*(scene.position[0, chair] - (-1.0, 0.0))) > 0.5
    assert abs(hip[0, 0]) < 0.2
    assert hip[1, 0] > hip[0, 0] + 0.2
    assert np.all(np.abs(knee[:, 2] - 0.62) < 0.1)
    assert ends[NAMES.index("foot_l"), :, 2].min() > 0.1


@pytest.mark.usefixtures("drawing")
@pytest.mark.parametrize("world", ["planar", "physics"])
def test_a_picture_shows_the_rider_as_a_part_of_the_robot(world: str) -> None:
    counts = []
    for text in (ROOM, ROOM.replace(' rider="woman-36"', "")):
        trial = parse_trial(text.replace('seed="3"', f'seed="3" world="{world}"'))
        (shot,) = render_images(trial, "side", RenderRequest(0.1), segmentation=True)
        assert shot.segmentation is not None
        counts.append(int((shot.segmentation == 2).sum()))
        assert set(np.unique(shot.segmentation)) <= {-3, -2, -1, 0, 1, 2}
    assert counts[0] > 1.15 * counts[1]


@pytest.mark.parametrize("world", ["planar", "physics"])
def test_a_rider_changes_nothing_of_how_everybody_moves(world: str) -> None:
    with_rider, without = simulated(world), simulated(world, ROOM.replace(' rider="woman-36"', ""))
    assert np.array_equal(with_rider.world.scene.position, without.world.scene.position)
    assert np.array_equal(walkers_of(with_rider).ends[0], walkers_of(without).ends[0])


def test_a_trial_with_a_rider_is_written_and_read() -> None:
    trial = parse_trial(ROOM)
    assert trial.robots[1].rider == "woman-36"
    assert parse_trial(trial_xml(trial)) == trial
    assert valid(trial_xml(trial))


@pytest.mark.parametrize(
    ("old", "new", "sentence"),
    [
        ('rider="woman-36"', 'rider="womn"', "rider=\"womn\" has 'womn', did you mean 'woman'?; it takes man, woman"),
        ('x="1" y="-2"', 'x="1" y="-2" rider="man"', 'rider="man" needs type="wheelchair": other robots have no seat'),
    ],
)
def test_who_cannot_ride_is_told(old: str, new: str, sentence: str) -> None:
    with pytest.raises(TrialError) as found:
        parse_trial(ROOM.replace(old, new))
    assert sentence in str(found.value)


def test_activities_are_those_of_people_on_foot() -> None:
    scene = Scene.of([[0.0, 0.0], [3.0, 0.0]], external=[True, False])
    walkers = PeopleMotion(scene, np.array([1]), riders=[0])
    walkers.begin(scene, ["phone"])
    assert walkers.row.tolist() == [1, 0]
    assert walkers.limbs(np.array([True, True])).owner[-1] == 0
