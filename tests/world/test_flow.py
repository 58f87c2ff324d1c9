"""Sources and exits: rates, room, identities, places in the arrays that are used again."""

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest

from crowdbot.core import InputError, Scene, Twist
from crowdbot.models import ORCA, Mixture, SocialForce
from crowdbot.models.mixture import MODEL
from crowdbot.world import (
    ContactModel,
    DifferentialDrive,
    JourneyAssignment,
    PeopleSource,
    PlanarWorld,
    Point,
    Router,
    WaypointSequence,
    Zone,
)
from crowdbot.world.crowd.journey import JOURNEY, STOP
from crowdbot.world.crowd.routing import CORNER, UNPLANNED, WAY

DOOR = Zone(((0.0, 0.0), (1.0, 0.0), (1.0, 4.0), (0.0, 4.0)))
FAR = Zone(((9.0, 0.0), (10.0, 0.0), (10.0, 4.0), (9.0, 4.0)), aim="random")
ACROSS = WaypointSequence((FAR,))


@dataclass(frozen=True)
class Between:
    """Draws evenly from a range, as distributions of trials do."""

    low: float
    high: float

    def draw(self, rng, count):
        return rng.uniform(self.low, self.high, count)


def empty(A=20, E=1, **more):
    return Scene.of(np.zeros((E, A, 2)), active=False, **more)


def world_of(*sources, scene=None, dt=0.1, model=None, **more):
    return PlanarWorld(empty() if scene is None else scene, model or ORCA(), {}, dt, sources=sources, **more)


def entries(world, seconds):
    """Run, and return time, identity, place in the arrays and position of everybody who came in."""
    found, known = [], set(world.ids[0, world.scene.active[0]].tolist())
    while world.clock.time < seconds - 1e-9:
        scene = world.step({})
        for a in np.flatnonzero(scene.active[0]):
            if int(world.ids[0, a]) not in known:
                known.add(int(world.ids[0, a]))
                found.append((world.clock.time, int(world.ids[0, a]), int(a), scene.position[0, a].copy()))
    return found


def test_people_come_regularly_at_the_rate():
    world = world_of(PeopleSource(DOOR, ACROSS, rate=0.5, timing="regular", begin=1.0, end=9.5))
    found = entries(world, 15.0)
    assert [time for time, *_ in found] == pytest.approx([1.0, 3.0, 5.0, 7.0, 9.0])
    assert [who for _, who, *_ in found] == [20, 21, 22, 23, 24]
    for *_, place in found:
        assert DOOR.contains(place[None])[0]


def test_people_come_at_random_at_the_rate():
    source = PeopleSource(
        Zone(((0, 0), (40, 0), (40, 40), (0, 40))), WaypointSequence((Point(20.0, 20.0, 0.5),)), rate=4.0
    )
    world = world_of(source, scene=empty(400), dt=0.5)
    times = [time for time, *_ in entries(world, 100.0)]
    assert len(times) == pytest.approx(400, abs=60)
    counts = np.histogram(times, 100, (0.0, 100.0))[0]
    assert np.var(counts) / np.mean(counts) == pytest.approx(1.0, abs=0.5)


def test_no_more_come_than_asked_for():
    assert len(entries(world_of(PeopleSource(DOOR, ACROSS, rate=5.0, max_count=7)), 30.0)) == 7
    assert entries(world_of(PeopleSource(DOOR, ACROSS, rate=5.0, max_count=0)), 3.0) == []


def test_who_comes_walks_with_a_speed_and_a_body_that_were_drawn():
    world = world_of(PeopleSource(DOOR, ACROSS, rate=5.0, speed=Between(1.0, 1.4), radius=Between(0.2, 0.3)))
    entries(world, 5.0)
    here = world.scene.active[0]
    assert np.count_nonzero(here) > 5
    speed, radius = world.scene.preferred_speed[0, here], world.scene.radius[0, here]
    assert (speed.min() >= 1.0, speed.max() <= 1.4, len(np.unique(speed)) == len(speed)) == (True, True, True)
    assert (radius.min() >= 0.2, radius.max() <= 0.3) == (True, True)
    assert world.scene.max_speed[0, here] == pytest.approx(1.3 * speed)
    newest = here.nonzero()[0][np.argmax(world.ids[0, here])]
    velocity = world.scene.velocity[0, newest]
    assert np.hypot(*velocity) > 0.5
    assert velocity[0] > 0.0


def test_nobody_comes_in_where_there_is_no_room_and_all_wait_in_order():
    narrow = Zone(((0.0, 0.0), (0.6, 0.0), (0.6, 0.6), (0.0, 0.6)))
    blocked = Scene.of(np.zeros((10, 2)) + 0.3, active=np.arange(10) == 0, external=np.arange(10) == 0)
    world = world_of(PeopleSource(narrow, ACROSS, rate=1.0, timing="regular"), scene=blocked)
    assert entries(world, 5.0) == []
    assert world.waiting_count.tolist() == [6]
    world.scene = world.scene.replace(active=np.zeros((1, 10), dtype=bool))
    found = entries(world, 12.0)
    assert len(found) > 3
    assert world.waiting_count[0] < 6
    assert all(a > 0 for _, _, a, _ in found), "the place of a robot is not used"


def test_nobody_begins_in_a_wall_or_in_somebody():
    pillar = [(0.2, 0.2), (0.8, 0.2), (0.8, 1.8), (0.2, 1.8)]
    world = world_of(PeopleSource(DOOR, ACROSS, rate=8.0), scene=empty(80, walls=[pillar]))
    for _ in range(60):
        scene = world.step({})
        new = world.scene.active[0] & (world.scene.position[0, :, 0] <= 1.0)
        for a in np.flatnonzero(new & (world.ids[0] >= 80)):
            away = np.hypot(*(scene.position[0] - scene.position[0, a]).T)
            assert np.count_nonzero(scene.active[0] & (away < 0.45)) == 1
    assert np.count_nonzero(world.scene.active) > 10


def test_places_of_people_who_left_are_used_again_with_new_identities():
    world = world_of(PeopleSource(DOOR, ACROSS, rate=1.0), scene=empty(8))
    found = entries(world, 90.0)
    assert len(found) > 40
    assert len({who for _, who, *_ in found}) == len(found)
    assert {a for _, _, a, _ in found} <= set(range(8))
    assert len(np.unique(world.ids[0])) == 8


def test_a_full_scene_lets_nobody_in():
    stay = WaypointSequence((FAR,), then="stay")
    world = world_of(PeopleSource(DOOR, stay, rate=2.0), scene=empty(3))
    assert len(entries(world, 20.0)) == 3
    assert world.waiting_count[0] > 20


def test_memories_of_who_left_are_forgotten():
    walls = [[(5.0, -3.0), (5.0, 3.0)]]
    keeps = {"kept": np.ones((1, 4))}
    scene = empty(4, walls=walls).replace(memory=keeps)
    world = world_of(PeopleSource(DOOR, ACROSS, rate=1.0, max_count=2), scene=scene, router=Router.of(walls))
    while not np.any(world.scene.active):
        world.step({})
    a = int(np.flatnonzero(world.scene.active[0])[0])
    memory = world.scene.memory
    assert (memory["kept"][0, a], memory[STOP][0, a], memory[JOURNEY][0, a]) == (0.0, 0.0, 0.0)
    assert memory[WAY][0, a, CORNER] == UNPLANNED
    assert memory[JOURNEY][0, 3] == -1.0


def test_memories_begin_as_the_model_says():
    class Calm(ORCA):
        memory_at_start: ClassVar[dict[str, float]] = {"kept": 0.5}

    scene = empty(4).replace(memory={"kept": np.ones((1, 4))})
    world = world_of(PeopleSource(DOOR, ACROSS, rate=9.0, max_count=1), scene=scene, model=Calm())
    entries(world, 2.0)
    assert sorted(world.scene.memory["kept"][0].tolist()) == [0.5, 1.0, 1.0, 1.0]


def test_sources_do_not_change_each_other_nor_the_rest_of_the_crowd():
    one = PeopleSource(DOOR, ACROSS, rate=0.3)
    other = PeopleSource(Zone(((0, 50), (1, 50), (1, 54), (0, 54))), WaypointSequence((Point(9.0, 52.0),)), rate=0.4)
    alone = entries(world_of(one, scene=empty(30), seed=3), 20.0)
    both = entries(world_of(one, other, scene=empty(30), seed=3), 20.0)
    assert [(t, *p) for t, _, _, p in alone] == [(t, *p) for t, _, _, p in both if p[1] < 40.0]
    assert len(both) > len(alone)


def test_a_batch_gives_the_bytes_of_each_alone():
    source = PeopleSource(DOOR, ACROSS, rate=1.5, speed=Between(1.0, 1.5))
    batch = world_of(source, scene=empty(15, E=3), seed=10)
    alone = [world_of(source, scene=empty(15), seed=10 + e) for e in range(3)]
    for _ in range(150):
        batch.step({})
        for world in alone:
            world.step({})
    for e, world in enumerate(alone):
        assert world.scene.position[0].tobytes() == batch.scene.position[e].tobytes()
        assert world.ids[0].tolist() == batch.ids[e].tolist()
    assert alone[0].scene.digest() != alone[1].scene.digest()


def test_people_leave_at_exits_and_robots_do_not():
    places = [[0.0, 0.0], [8.0, 2.0], [8.0, 3.0]]
    scene = Scene.of(places, goal=[[0.0, 0.0], [20.0, 2.0], [8.0, 3.0]], external=[True, False, False])
    everywhere = Zone(((-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)))
    world = PlanarWorld(scene, ORCA(), {0: DifferentialDrive()}, 0.1, exits=(FAR, everywhere))
    for _ in range(30):
        world.step({0: Twist()})
    assert world.scene.active[0].tolist() == [True, False, True]


def test_who_comes_may_walk_by_a_model_of_a_mixture():
    mixture = Mixture((ORCA(), SocialForce()))
    sources = (PeopleSource(DOOR, ACROSS, rate=1.0, model=1), PeopleSource(DOOR, ACROSS, rate=1.0))
    world = world_of(*sources, scene=empty(30), model=mixture, seed=1)
    entries(world, 8.0)
    here = world.scene.active[0]
    assert world.scene.memory[MODEL][0, here].tolist() == (1.0 - world.scene.memory[JOURNEY][0, here]).tolist()
    assert set(world.scene.memory[MODEL][0, here].tolist()) == {0.0, 1.0}
    for _ in range(200):  # places are used again by people of either kind
        world.step({})
    new = world.scene.active[0] & (world.ids[0] >= 30)
    assert world.scene.memory[MODEL][0, new].tolist() == (1.0 - world.scene.memory[JOURNEY][0, new]).tolist()


def test_a_flow_through_a_door_goes_on_and_on():
    walls = [[(5.0, -10.0), (5.0, 1.4)], [(5.0, 2.6), (5.0, 14.0)]]
    journeys = JourneyAssignment((ACROSS,), -1)
    world = world_of(
        PeopleSource(DOOR, ACROSS, rate=0.8), scene=empty(40, walls=walls), router=Router.of(walls),
        contact=ContactModel(), journeys=journeys, heading_jitter=1e-3,
    )  # fmt: skip
    found = entries(world, 60.0)
    assert len(found) - np.count_nonzero(world.scene.active) > 25
    assert np.all(world.scene.memory[JOURNEY][world.scene.active] == 1.0)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"rate": 0.0}, "rate = 0.0 people/s must be above 0"),
        ({"rate": np.nan}, "rate = nan"),
        ({"timing": "regula"}, "did you mean 'regular'"),
        ({"begin": 5.0, "end": 5.0}, "begin = 5.0 s must be finite and before end = 5.0 s"),
        ({"max_count": -1}, "max_count = -1 people"),
        ({"speed": 0.0}, "speed = 0.0 must be finite and above 0"),
        ({"radius": np.inf}, "radius = inf"),
    ],
)
def test_a_wrong_source_is_explained(values, message):
    with pytest.raises(InputError, match=message):
        PeopleSource(**({"zone": DOOR, "journey": ACROSS, "rate": 1.0} | values))


def test_wrong_worlds_of_sources_are_explained():
    for model in (ORCA(), Mixture((ORCA(),))):
        with pytest.raises(InputError, match="model = 1, but the crowd has no mixture with"):
            world_of(PeopleSource(DOOR, ACROSS, rate=1.0, model=1), model=model)
    with pytest.raises(InputError, match="the sampled radius -1.0 must be finite"):
        entries(world_of(PeopleSource(DOOR, ACROSS, rate=9.0, radius=Between(-1.0, -1.0))), 2.0)
    with pytest.raises(InputError, match="ids must be integers, unique in each environment"):
        world_of(scene=empty(3), ids=[0, 1, 1])
    with pytest.raises(InputError, match=r"ids have shape \[2\]"):
        world_of(scene=empty(3), ids=[0, 1])
