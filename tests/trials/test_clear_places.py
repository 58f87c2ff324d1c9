"""Imported scenes with people in walls, in each other and in exits: moved or cut, told, and free of errors."""

from __future__ import annotations

import dataclasses
import math

import pytest

from crowdbot.models import SocialForce
from crowdbot.recording import run
from crowdbot.trials import (
    Agent,
    Journey,
    Obstacle,
    RobotGoal,
    RobotSpec,
    Routing,
    SourceSpec,
    Spawner,
    Stage,
    Trial,
    Wall,
    check_trial,
    import_trial,
)
from crowdbot.trials.importers.clear_places import clear_places
from crowdbot.world import Exit, Point, Zone

BLOCK = Obstacle([(4, 1), (6, 1), (6, 3), (4, 3)])
WALL = Wall([(0, 0), (10, 0)])
GOAL = [(8, 1), (9, 1), (9, 2), (8, 2)]
BOX = [(1, 1), (3, 1), (3, 3), (1, 3)]


def trial(**parts):
    return Trial(
        name="t", duration=5.0, crowd=SocialForce(), **{"stage": Stage(walls=[WALL], obstacles=[BLOCK]), **parts}
    )


def cleared(before):
    notes = []
    after = clear_places(before, notes.append)
    check_trial(after)
    return after, notes


def agent(name, x, y, radius=0.2):
    return Agent(name=name, x=x, y=y, radius=radius, goal=[(9.0, 5.0)])


@pytest.mark.parametrize(
    ("x", "y", "place"),
    [
        (3.9, 2.0, (3.799, 2.0)),  # too near to a block
        (4.3, 2.0, (3.799, 2.0)),  # in it
        (7.0, 0.05, (7.0, 0.2)),  # too near to a thin wall: the same side
        (7.0, -0.05, (7.0, -0.2)),
        (5.0, 3.1, (5.0, 3.2)),
    ],
)
def test_a_person_in_a_wall_is_moved_to_the_nearest_place_with_room(x, y, place):
    before = trial(agents=[agent("ann", x, y), agent("bob", 1.0, 5.0)])
    with pytest.raises(Exception, match="from a wall"):
        check_trial(before)
    after, (note,) = cleared(before)
    assert math.dist(after.agents[0].position, place) < 0.04
    assert after.agents[1] == before.agents[1]
    assert note.startswith("1 person stands in walls, robots or each other, moved to the nearest place with room")
    assert note.endswith(": ann")


def test_people_who_overlap_are_moved_and_those_who_stand_right_are_not():
    before = trial(agents=[agent(f"a{k}", 2.0, 5.0) for k in range(8)])
    after, (note,) = cleared(before)
    assert after.agents[0] == before.agents[0]
    assert "7 people stand" in note
    assert note.endswith("a1, a2, a3, a4, a5 and 2 more")


def test_a_person_without_room_is_left_out():
    walls = [Wall([(20, 20), (21, 20), (21, 20.3), (20, 20.3), (20, 20)])]
    after, (note,) = cleared(trial(stage=Stage(walls=walls), agents=[agent("ann", 20.5, 20.15), agent("bob", 1, 5)]))
    assert [one.name for one in after.agents] == ["bob"]
    assert note == "1 person stands in walls, robots or each other, without room within 2 m, left out: ann"


def robot(name, x, y, goal=(9.0, 6.0), radius=0.3):
    from crowdbot.navigation import ORCANavigator
    from crowdbot.world import DifferentialDrive

    where = RobotGoal(*goal, tolerance=0.1)
    return RobotSpec(
        name=name, x=x, y=y, radius=radius, goal=where, drive=DifferentialDrive(), navigator=ORCANavigator()
    )


@pytest.mark.parametrize(
    ("robots", "words"),
    [
        ([robot("r1", 2, 5), robot("r2", 2, 5)], "r2 starts in a wall or a robot at 2,5, and is moved to"),
        ([robot("r1", 2, 5), robot("r2", 2.3, 5)], "r2 starts in a wall or a robot at 2.3,5"),
        ([robot("r1", 2, 0.1)], "r1 starts in a wall or a robot at 2,0.1, and is moved to 2,"),
        ([robot("r1", 5, 2)], "r1 starts in a wall or a robot at 5,2"),
        ([robot("r1", 2, 5, goal=(5, 2))], "the goal of r1 at 5,2 is in a wall, and is moved to"),
        ([robot("r1", 2, 5, goal=(8, 0.1))], "the goal of r1 at 8,0.1 is in a wall, and is moved to 8,"),
    ],
)
def test_robots_and_their_goals_are_moved_off_walls_and_each_other(robots, words):
    after, notes = cleared(trial(robots=robots))
    assert len(after.robots) == len(robots)
    assert len(notes) == 1
    assert notes[0].startswith(words)


@pytest.mark.parametrize(
    ("exits", "area"),
    [
        ([[(2.5, 1), (3.5, 1), (3.5, 3), (2.5, 3)]], 3.0),  # one side
        ([[(1.8, 0), (2.0, 0), (2.0, 9), (1.8, 9)]], 2.0),  # in two: the larger part
        ([[(1.9, 1.9), (2.1, 1.9), (2.1, 2.1), (1.9, 2.1)]], 2.0),  # in its middle: a half
        ([[(0, 0), (1.5, 0), (1.5, 9), (0, 9)], [(2.5, 0), (4, 0), (4, 9), (2.5, 9)]], 2.0),
        ([[(3, 1), (5, 1), (5, 3), (3, 3)]], 4.0),  # only touches
    ],
)
@pytest.mark.parametrize("coming", [False, True])
def test_the_zone_of_people_is_cut_by_exits(exits, area, coming):
    import shapely

    ways = [Exit(name=f"e{k}", zone=zone) for k, zone in enumerate(exits)]
    people = (
        {"sources": [SourceSpec(name="a", zone=BOX, goal=GOAL, rate=0.5)]}
        if coming
        else {"spawners": [Spawner(name="a", count=3, zone=BOX, goal=GOAL)]}
    )
    after, notes = cleared(trial(exits=ways, **people))
    (one,) = after.sources if coming else after.spawners
    assert shapely.Polygon(one.zone).area == pytest.approx(area, abs=0.03)
    assert len(notes) == (area < 4.0)
    assert all("it is cut from 4 to" in note for note in notes)


def test_a_zone_that_lies_in_an_exit_is_left_out():
    after, (note,) = cleared(
        trial(
            exits=[Exit(zone=[(0, 0), (4, 0), (4, 4), (0, 4)])], agents=[agent("ann", 9, 5)],
            spawners=[Spawner(name="a", count=3, zone=BOX, goal=GOAL)],
        )
    )  # fmt: skip
    assert not after.spawners
    assert note == "the zone of a lies in exits, where people would leave at once, and is left out"


@pytest.mark.parametrize(
    ("count", "zone", "least"),
    [(5, BOX, 5), (60, BOX, 12), (20, [(1, 1), (1.5, 1), (1.5, 1.5), (1, 1.5)], 1), (9, [(4, 1), (6, 1), (5, 2)], 0)],
)
def test_as_many_people_as_fit_for_any_seed(count, zone, least):
    before = trial(spawners=[Spawner(name="a", count=count, zone=zone, goal=GOAL)], agents=[agent("ann", 9, 5)])
    after, notes = cleared(before)
    kept = after.spawners[0].count if after.spawners else 0
    assert least <= kept <= count
    assert bool(notes) == (kept < count)
    assert all(f"{kept} of {count} people of a fit into their zone of" in note for note in notes)
    for seed in range(5):
        check_trial(dataclasses.replace(after, seed=seed))


def test_goals_of_people_are_moved_and_cut_off_solids():
    stops = (Point(5, 2, 0.3), Zone([(5, 2), (8, 2), (8, 2.9), (5, 2.9)]), Point(9, 5, 0.3))
    way = Journey(name="w", stops=stops, then="leave")
    after, notes = cleared(trial(journeys=[way], spawners=[Spawner(name="a", count=2, zone=BOX, journey="w")]))
    point, zone, last = after.journeys[0].stops
    assert last == stops[2]
    assert math.dist((point.x, point.y), (5, 2)) < 1.1
    assert min(x for x, _ in zone.points) == pytest.approx(6.001)
    assert [note.split(", and is ")[1] for note in notes] == [f"moved to {point.x:.3g},{point.y:.3g}", "cut there"]


@pytest.mark.parametrize("kind", ["agents", "spawners", "sources"])
def test_goals_without_room_are_left_out(kind):
    """The middle of a block of 8 m x 8 m is farther than 2 m from its sides."""
    block = Obstacle([(4, 1), (12, 1), (12, 9), (4, 9)])
    lost, zone, kept = Point(8, 5, 0.3), Zone([(7, 4), (8, 4), (8, 5), (7, 5)]), Point(2, 8, 0.3)
    ways = [
        Journey(name="none", stops=(lost, zone), then="leave"),
        Journey(name="one", stops=(lost, kept), then="leave"),
    ]
    people = {
        "agents": lambda way, k: Agent(name=way, x=1 + k, y=1, journey=way),
        "spawners": lambda way, k: Spawner(name=way, count=2, zone=BOX, journey=way),
        "sources": lambda way, k: SourceSpec(name=way, zone=BOX, journey=way, rate=0.5),
    }[kind]
    stage = Stage(obstacles=[block])
    before = trial(stage=stage, journeys=ways, **{kind: [people(way.name, k) for k, way in enumerate(ways)]})
    after, notes = cleared(before)
    assert [way.stops for way in after.journeys] == [(kept,)]
    assert [one.journey for one in getattr(after, kind)] == (["one"] if kind == "sources" else ["", "one"])
    assert "a goal at 8,5 lies in a solid, and is left out, without room" in notes


@pytest.mark.parametrize(("rows", "routed"), [(10, True), (20, False)])
def test_too_many_corners_for_routes_are_told(rows, routed):
    posts = [
        Obstacle([(x, y), (x + 0.1, y), (x + 0.1, y + 0.1), (x, y + 0.1)]) for x in range(rows) for y in range(rows)
    ]
    before = trial(stage=Stage(obstacles=posts), routing=Routing(radius=0.2), agents=[agent("ann", 0.5, 0.5)])
    after, notes = cleared(before)
    assert (after.routing is not None) == routed
    assert [note[:60] for note in notes] == (
        [] if routed else ["people find no ways around walls, and walk straight to their"]
    )


PEDSIM = """<scenario>
  <obstacle x1="0" y1="0" x2="10" y2="0"/>
  <waypoint id="a" x="8" y="2" r="0.5"/><waypoint id="b" x="2" y="2" r="0.5"/>
  <agent x="2" y="2" n="20" dx="1" dy="1" type="1"><addwaypoint id="a"/><addwaypoint id="b"/></agent>
  <agent x="5" y="0.05" n="1" dx="0" dy="0" type="1"><addwaypoint id="a"/></agent>
</scenario>"""


def test_an_imported_scene_runs_and_its_changes_are_told(tmp_path):
    (tmp_path / "a.xml").write_text(PEDSIM)
    done = import_trial(tmp_path / "a.xml")
    ((_, scene),) = done.trials
    check_trial(scene)
    told = " ".join(done.left_out)
    assert "of 20 people of agents1 fit into their zone of 1 m2" in told
    assert "1 person stands in walls" in told
    assert run(dataclasses.replace(scene, duration=5.0)).outcome == "finished"
