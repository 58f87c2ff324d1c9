"""Trial files with flows: what is read, every kind of mistake with its sentence, and XML -> Trial -> XML."""

from __future__ import annotations

import dataclasses
import re

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError, TrialError
from crowdbot.models import ORCA, Mixture, SocialForce
from crowdbot.trials import (
    ContactModel,
    Crowds,
    Direction,
    Exit,
    Journey,
    Limits,
    Point,
    Routing,
    SourceSpec,
    Spawner,
    Stage,
    Trial,
    Wall,
    Zone,
    check_trial,
    parse_trial,
    trial_xml,
)
from trial_texts import FLOW, GOOD

ZONE = [(0.0, 0.0), (3.0, 0.0), (3.0, 3.0), (0.0, 3.0)]
FAR = [(6.0, 0.0), (8.0, 0.0), (8.0, 3.0)]


def test_a_file_with_flows_is_the_tree() -> None:
    trial = parse_trial(FLOW)
    assert (trial.substeps, trial.capacity, trial.robot_margin, trial.heading_jitter) == (2, 10, 0.2, 0.001)
    assert trial.routing == Routing(radius=0.25, unreachable="nearest")
    assert trial.contact == ContactModel(variant="force", stiffness=50.0, iterations=4)
    assert trial.limits == Limits(max_speed=2.5, max_acceleration=5.0)
    assert trial.crowd == Crowds((ORCA(time_horizon=2.0), SocialForce()), names=("calm", "hurried"))
    zone, point, direction = trial.journeys[0].stops
    assert zone == Zone([(-0.5, -1), (0.5, -1), (0.5, 1), (-0.5, 1)], aim="random")
    assert (point, direction) == (Point(4.0, -2.0, 0.5), Direction(0.3))
    assert [journey.then for journey in trial.journeys] == ["leave", "stay"]
    assert [spawner.journey for spawner in trial.spawners] == ["through", ""]
    west, north = trial.sources
    assert (west.rate, west.max_count, west.end, west.crowd) == (0.9, 90, float("inf"), "hurried")
    assert (north.timing, north.begin, north.end, north.max_count) == ("regular", 2.0, 15.0, None)
    assert trial.exits == (Exit(name="east", zone=[(6.5, -4), (8, -4), (8, 4), (6.5, 4)]),)


def test_reading_what_was_written_gives_the_same_flow() -> None:
    trial = parse_trial(FLOW)
    assert parse_trial(trial_xml(trial)) == trial
    assert trial_xml(parse_trial(trial_xml(trial))) == trial_xml(trial)
    assert "<zone" in trial_xml(trial)
    assert trial_xml(trial).index("<zone") < trial_xml(trial).index("<point") < trial_xml(trial).index("<direction")


def test_what_is_left_out_is_not_written() -> None:
    text = trial_xml(Trial(name="plain", duration=1, crowd=ORCA()))
    assert '<crowd type="orca"/>' in text
    assert not any(word in text for word in ("routing", "contact", "limits", "capacity", "robot-margin", 'name=""'))


amounts = st.floats(0.01, 50.0)
stops = st.one_of(
    st.builds(Point, st.floats(4.0, 9.0), st.floats(0.0, 9.0), amounts),
    st.builds(Zone, st.just(FAR), st.sampled_from(["nearest", "random"]), amounts),
)


@st.composite
def flows(draw: st.DrawFn) -> Trial:
    """Make trials with flows that are possible."""
    name = draw(st.from_regex(r"\A[A-Za-z][A-Za-z0-9_]{0,6}\Z"))
    other = Journey(
        name=f"{name}2", then=draw(st.sampled_from(["leave", "stay"])), stops=[Direction(draw(amounts) / 9)]
    )
    journey = Journey(name=name, stops=[*draw(st.lists(stops, min_size=1, max_size=3)), *other.stops])
    crowds = Crowds((ORCA(time_horizon=draw(amounts)), SocialForce()), names=(name, f"{name}_"))
    begin = draw(st.floats(0.0, 9.0))
    return Trial(
        name="flow",
        duration=draw(st.floats(0.2, 30.0)),
        substeps=draw(st.integers(1, 10_000)),
        capacity=draw(st.one_of(st.none(), st.integers(3, 100))),
        robot_margin=draw(st.floats(0.0, 2.0)),
        heading_jitter=draw(st.floats(0.0, 3.0)),
        crowd=draw(st.sampled_from([ORCA(), crowds, Crowds((ORCA(),), names=(name,))])),
        routing=draw(st.one_of(st.none(), st.builds(Routing, radius=st.floats(0.1, 0.4)))),
        contact=draw(st.one_of(st.none(), st.builds(ContactModel, stiffness=amounts, iterations=st.integers(1, 9)))),
        limits=draw(st.one_of(st.none(), st.builds(Limits, max_speed=st.one_of(st.none(), amounts)))),
        stage=Stage(walls=[Wall([(20, 0), (20, 5)])]),
        journeys=[journey, other],
        spawners=[Spawner(count=draw(st.integers(0, 3)), zone=ZONE, journey=name, crowd=name)],
        sources=[
            SourceSpec(zone=ZONE, goal=FAR, rate=draw(amounts), begin=begin, end=begin + draw(amounts)),
            SourceSpec(
                zone=ZONE, journey=other.name, rate=draw(amounts), timing="regular", max_count=draw(st.integers(0, 9))
            ),
        ],
        exits=draw(st.sampled_from([[], [Exit(zone=FAR)]])),
    )  # fmt: skip


@settings(max_examples=40, deadline=None)
@given(flows())
def test_any_flow_survives_the_way_through_xml(trial: Trial) -> None:
    if not isinstance(trial.crowd, Crowds):
        trial = dataclasses.replace(trial, spawners=[dataclasses.replace(trial.spawners[0], crowd="")])
    text = trial_xml(trial)
    assert parse_trial(text) == trial
    assert trial_xml(parse_trial(text)) == text


MISTAKES = {
    "unreachable": (
        '"nearest"/>',
        '"neerest"/>',
        r'<routing> unreachable="neerest" must be error or nearest, did you mean',
    ),
    "room for nobody": (
        'radius="0.25" un',
        'radius="6" un',
        r":7: <routing> is impossible on this stage: no space between",
    ),
    "name of a crowd taken": (
        '"hurried" type',
        '"calm" type',
        r":9: <crowd> name 'calm' is already used by another crowd",
    ),
    "crowd without a name": (
        'name="hurried" type',
        "type",
        r":9: <crowd> needs the attribute 'name': each of several crowds",
    ),
    "variant": ('"force"', '"forse"', r':10: <contact> variant="forse" must be position or force, did you mean'),
    "limit that is none": ('max-speed="2.5"', 'max-speed="none"', r':11: <limits> max-speed="none" is not a number'),
    "twice": ("<limits ", "<contact/><limits ", r":11: <contact> occurs in <trial> twice; one is allowed"),
    "substeps": ('substeps="2"', 'substeps="0"', r':2: <trial> substeps="0" must be at least 1'),
    "heading-jitter": (
        'heading-jitter="0.001"',
        'heading-jitter="4"',
        r':2: <trial> heading-jitter="4" must be at most 3.14159 rad',
    ),
    "robot-margin": ('robot-margin="0.2"', 'robot-margin="-1"', r':2: <trial> robot-margin="-1" must be at least 0 m'),
    "capacity": (
        'capacity="10"',
        'capacity="3"',
        r"<spawner> makes 4 people at the beginning, more than the capacity 3",
    ),
    "no stops": (
        '<point x="-2" y="0"/>',
        "",
        r":17: <journey> needs the element <point> or <direction> or <zone>: stops, in order",
    ),
    "unknown stop": (
        "<direction ",
        "<directoin ",
        r":15: <directoin> is not an element of <journey>, did you mean 'direction'",
    ),
    "zone without area": ("-0.5,-1 0.5,-1 0.5,1 -0.5,1", "0,0 1,1 2,2", r":13: <zone> points is not a simple polygon"),
    "tiny zone": (
        "-0.5,-1 0.5,-1 0.5,1 -0.5,1",
        "0,0 1e-3,0 0,1e-3",
        r":13: <zone> points has 5e-07 m2, it must have more",
    ),
    "zone outside": (
        "-0.5,-1 0.5,-1 0.5,1 -0.5,1",
        "7,0 9,0 9,1",
        r":13: <zone> zone reaches outside the walkable area",
    ),
    "endless stop": (
        '<point x="4"',
        '<direction heading="1"/><point x="4"',
        r":14: <direction> is stop 2 of 4 and has no end",
    ),
    "name of a journey taken": (
        '"in" then',
        '"through" then',
        r":17: <journey> name 'through' is already used by another journey",
    ),
    "two goals": (
        'goal="-5',
        'journey="in" goal="-5',
        r":21: <spawner> has both a goal and a journey; give one of them",
    ),
    "arrival": (
        'journey="through" rate',
        'arrival="stay" journey="through" rate',
        r"for a journey write then=\"stay\" in it",
    ),
    "rate": ('rate="0.9"', 'rate="0"', r':22: <source> rate="0" must be above 0 1/s'),
    "timing": ('"regular"', '"regulr"', r':23: <source> timing="regulr" must be poisson or regular, did you mean'),
    "crowd of people": (
        'max-count="90"',
        'begin="1" speed="1" radius="2" max-count="9" arrival="leave"',
        r":22: <source> zone of 6.00 m2",
    ),
    "source outside": ("-7.5,-3 -6.5,-3", "-9.5,-3 -6.5,-3", r":22: <source> zone reaches outside the walkable area"),
    "source in an exit": (
        'zone="-7.5,-3 -6.5,-3 -6.5,3 -7.5,3"',
        'zone="6,-3 7,-3 7,3 6,3"',
        r"<source> zone overlaps exit 'east'",
    ),
    "spawner in an exit": (
        'zone="4,1 5,1 5,2 4,2"',
        'zone="6,1 7,1 7,2 6,2"',
        r":21: <spawner> zone overlaps exit 'east'",
    ),
    "too many come": (
        'rate="0.9" max-count="90"',
        'rate="9999"',
        r"<source> produces about 1\d{5} people together with other",
    ),
    "obstacle in a source": (
        "</stage>",
        '<obstacle points="-7,0 -6,0 -6,1 -7,1"/></stage>',
        r":22: <source> zone reaches into obstacle 1 of the stage; move it, or cut it there",
    ),
}


@pytest.mark.parametrize("mistake", MISTAKES)
def test_a_mistake_is_named_with_its_line(mistake: str) -> None:
    old, new, sentence = MISTAKES[mistake]
    assert FLOW.count(old) >= 1, old
    with pytest.raises(TrialError) as found:
        parse_trial(FLOW.replace(old, new, 1), place="t.xml")
    assert re.search(sentence, str(found.value)), str(found.value)
    assert len(found.value.problems) == 1


def blocked(*walls: str) -> str:
    text = FLOW.replace(' unreachable="nearest"', "")
    return text.replace("</stage>", "".join(f'<wall points="{wall}"/>' for wall in walls) + "</stage>")


def test_ways_that_lead_nowhere_are_found() -> None:
    assert parse_trial(blocked()).routing == Routing(radius=0.25)
    with pytest.raises(TrialError) as found:
        parse_trial(blocked("-1,-4 -1,4"))
    sentences = "\n".join(found.value.problems)
    assert len(found.value.problems) == 3
    assert re.search(
        r":20: <spawner> there is no path from its zone to the first stop of journey 'through' for a", sentences
    )
    assert re.search(
        r":21: <spawner> there is no path from its zone to the goal zone for a body of radius 0.25 m", sentences
    )
    assert re.search(r":22: <source> there is no path from its zone to the first stop of journey 'through'", sentences)
    with pytest.raises(TrialError, match=r":14: <point> there is no path to stop 2 from the one before") as found:
        parse_trial(blocked("3,-4 3,-1.5 5,-1.5 5,-4"))
    assert len(found.value.problems) == 1


def test_zones_of_journeys_need_room() -> None:
    pillar = '<obstacle points="-1,-2 1,-2 1,2 -1,2"/></stage>'
    with pytest.raises(TrialError, match=r"<zone> zone lies inside obstacle 1 of the stage"):
        parse_trial(FLOW.replace("</stage>", pillar))
    bar = '<obstacle points="-0.2,-0.9 0.2,-0.9 0.2,0.9 -0.2,0.9"/></stage>'
    assert parse_trial(FLOW.replace("</stage>", bar)).routing is not None
    with pytest.raises(TrialError, match=r"<zone> zone reaches into obstacle 1 of the stage"):
        parse_trial(FLOW.replace("</stage>", bar).replace(' aim="random"', ""))
    screens = "".join(f'<wall points="{x},-0.99 {x},0.99"/>' for x in (-0.4, -0.2, 0, 0.2, 0.4)) + "</stage>"
    with pytest.raises(
        TrialError, match=r"<zone> zone leaves no room for a body of radius 0.25 m, which routing requires"
    ):
        parse_trial(FLOW.replace("</stage>", screens))
    inside = FLOW.replace("</stage>", '<obstacle points="3,-3 5,-3 5,-1 3,-1"/></stage>')
    with pytest.raises(TrialError, match=r"<point> at 4,-2 lies inside obstacle 1 of the stage"):
        parse_trial(inside)


@pytest.mark.parametrize(("way", "loop"), [(18, True), (16, False)])
def test_portals_that_lead_into_each_other_are_found(way: int, loop: bool) -> None:
    text = f"""<trial name="p" duration="60"><stage walkable="-11,-8 11,-8 11,8 -11,8"/><crowd type="orca"/>
    <journey name="on"><direction heading="0"/></journey>
    <spawner count="5" zone="-7,-7 7,-7 7,7 -7,7" journey="on"/>
    <portal zone="8,-8 11,-8 11,8 8,8" dx="-{way}"/>
    <portal name="west" zone="-11,-8 -8,-8 -8,8 -11,8" dx="{way}"/></trial>"""
    if loop:
        with pytest.raises(TrialError, match="<portal> leads into the portal 'west' that leads back into it; move its"):
            parse_trial(text)
    else:
        assert len(parse_trial(text).portals) == 2


def test_flows_made_in_python_are_checked_too() -> None:
    with pytest.raises(InputError, match="Journey: stops is empty; it must hold at least one: stops, in order"):
        Journey(name="none", stops=[])
    with pytest.raises(InputError, match="Journey: stops holds a Exit, it takes Point or Direction or Zone"):
        Journey(name="wrong", stops=[Exit(zone=ZONE)])  # type: ignore[list-item]
    with pytest.raises(InputError, match="Trial: contact is a Limits, it must be a Contact"):
        Trial(name="t", duration=1, crowd=ORCA(), contact=Limits())  # type: ignore[arg-type]
    with pytest.raises(InputError, match="Trial: sources is a SourceSpec, it must be a list"):
        Trial(name="t", duration=1, crowd=ORCA(), sources=SourceSpec(zone=ZONE, goal=FAR, rate=1))  # type: ignore[arg-type]
    with pytest.raises(InputError, match="Trial: crowd is a tuple, it must be a CrowdModel"):
        Trial(name="t", duration=1, crowd=(ORCA(),))  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r'SourceSpec: max_count="1.5" is not a int'):
        SourceSpec(zone=ZONE, goal=FAR, rate=1, max_count=1.5)  # type: ignore[arg-type]
    unnamed = Trial(name="t", duration=1, crowd=ORCA(), sources=[SourceSpec(zone=ZONE, goal=FAR, rate=1, crowd="calm")])
    with pytest.raises(TrialError, match=r"trial 't': source crowd=\"calm\" is not the name of a crowd; no crowd has"):
        check_trial(unnamed)


def test_crowds_need_names_of_their_own() -> None:
    models = (ORCA(), SocialForce())
    for names, sentence in (
        ((), r"Crowds: 2 models and the names none; give each model a name"),
        (("a", ""), r"Crowds: crowd 2 needs the attribute 'name'"),
        (("a", "a"), r"Crowds: crowd 2 name 'a' is already used by another crowd"),
        (("a", "b b"), r'Crowd: name="b b" must match'),
    ):
        with pytest.raises(InputError, match=sentence):
            Crowds(models, names=names)
    with pytest.raises(InputError, match="leave out which"):
        Crowds(models, which=1, names=("a", "b"))
    with pytest.raises(InputError, match="cannot be written as an attribute"):
        trial_xml(Trial(name="t", duration=1, crowd=Mixture(models)))


def test_the_older_trials_are_as_they_were() -> None:
    trial = parse_trial(GOOD)
    assert (trial.routing, trial.contact, trial.limits, trial.journeys, trial.sources, trial.exits) == (
        None, None, None, (), (), (),
    )  # fmt: skip
    assert (trial.robot_margin, trial.heading_jitter, trial.substeps, trial.capacity) == (0.1, 0.0, 1, None)
