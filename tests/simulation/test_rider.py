"""Who rides in a wheelchair: seated, seen as a part of the robot, and refused where there is no seat."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from crowdbot.core import Scene, TrialError
from crowdbot.humans import LIMBS
from crowdbot.rendering import RenderRequest, render_images
from crowdbot.simulation import AvatarOrder, Simulation, SimulationRun, VelocityOrder
from crowdbot.trials import Trial, parse_trial, trial_xml
from crowdbot.world import PeopleMotion, Robot
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
    people_motion = simulation.world.people
    assert people_motion is not None
    return people_motion


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


def test_a_rider_changes_nothing_of_how_everybody_moves_in_the_plane() -> None:
    with_rider, without = (simulated("planar", text) for text in (ROOM, ROOM.replace(' rider="woman-36"', "")))
    assert np.array_equal(with_rider.world.scene.position, without.world.scene.position)
    assert np.array_equal(walkers_of(with_rider).ends[0], walkers_of(without).ends[0])


def chair_world(attributes: str, others: str = "") -> Simulation:
    return Simulation(
        parse_trial(f"""<trial name="ride" duration="6" world="physics"><stage/><crowd type="orca"/>
        <agent x="9" y="9"/><robot name="chair" {attributes} x="0" y="0" default-sensors="false"><goal x="9" y="0"/>
        <navigator type="external"/></robot>{others}<end collision="false" goal="false"/></trial>""")
    )


def test_a_rider_has_mass_and_the_chair_still_drives() -> None:
    empty, seated = (chair_world(f'type="wheelchair" {rider}') for rider in ("", 'rider="woman-36"'))
    bodies: list[Any] = [item.world.robot_bodies[1] for item in (empty, seated)]  # type: ignore[attr-defined]
    mass = float(walkers_of(seated).people.mass[1])
    assert mass > 40.0
    assert bodies[1].mass == pytest.approx(bodies[0].mass + mass)
    engine = [float(body._model.body_subtreemass[body.body]) for body in bodies]
    assert engine[1] - engine[0] == pytest.approx(mass)
    again: Any = Simulation(seated.trial, 7).world
    assert again.engine_model is seated.world.engine_model  # type: ignore[attr-defined]
    run = SimulationRun(seated)
    for _ in range(60):
        run.step([VelocityOrder(robot="chair", forward=0.6)])
    assert seated.world.twists[1].forward[0] == pytest.approx(0.6, rel=0.03)
    assert bodies[1].tilt < 0.02


def test_a_robot_that_hits_a_rider_hits_a_person() -> None:
    pepper = """<robot name="pepper" type="pepper" x="1.4" y="0" heading="3.14159" default-sensors="false">
    <goal x="9" y="0"/><navigator type="external"/></robot>"""
    simulation = chair_world('type="wheelchair" rider="man-36"', pepper)
    run = SimulationRun(simulation)
    contacts: set[tuple[int, int]] = set()
    for _ in range(70):
        run.step([VelocityOrder(robot="pepper", forward=0.8)])
        contacts |= {(contact.robot, contact.other) for contact in simulation.contacts()}
    (event,) = [
        contact_event for contact_event in simulation.world.contact_events if contact_event.second.kind == "person"
    ]
    assert (event.first.number, event.second.number) == (2, 1)
    assert event.limb in NAMES
    assert event.peak_force > 50.0
    assert event.severity > 0.0
    assert contacts == {(1, 2)}


def test_a_person_who_walks_into_a_rider_touches_the_robot() -> None:
    person = '<avatar name="guide" source="external" x="0" y="1.2" heading="-1.5708"/>'
    trial = simulated_chair(person)
    run = SimulationRun(Simulation(trial))
    links: set[str] = set()
    rest = [1.0, 0.0, 0.0, 0.0] * 28
    for tick in range(1, 24):
        y = 1.2 - 0.04 * tick
        order = AvatarOrder(avatar="guide", time=0.05 * tick, x=0, y=y, heading=-1.5708, skeleton=(0.0, y, 1.35, *rest))
        run.step([order])
        links |= {force.first_part for force in run.simulation.world.forces if force.second.kind == "person"}
    assert any(link.startswith("rider/") for link in links), links


def simulated_chair(people: str) -> Trial:
    return parse_trial(f"""<trial name="ride" duration="6" world="physics"><stage/><crowd type="orca"/>{people}
    <robot name="chair" type="wheelchair-rider" rider="man-36" x="0" y="0" default-sensors="false"><goal x="9" y="0"/>
    <navigator type="external"/></robot><end collision="false" goal="false"/></trial>""")


def test_the_wheelchair_with_a_rider_seats_an_adult_and_that_with_other_sensors_nobody() -> None:
    for name, riders in (("wheelchair", 0), ("wheelchair-rider", 1), ("wheelchair-3d", 0)):
        people = walkers_of(chair_world(f'type="{name}"'))
        assert len(people.agents) - len(people.afoot) == riders
    trial = parse_trial(ROOM.replace('type="wheelchair" rider="woman-36"', 'type="wheelchair-rider"'))
    assert trial.robots[1].rider == ""
    assert parse_trial(trial_xml(trial)) == trial
    names = [mount.name for mount in Robot.load("wheelchair-3d").mounts]
    assert names == ["velodyne", "depth_front", "depth_rear", "color_front", "odometry", "imu"]


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
