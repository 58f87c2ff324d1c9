"""Cases of the RiMEA guideline and of ISO 20414, and where each of them is run.

The components of ISO 20414:2020 are listed by name, after NIST TN 1822 (Ronchi, Kuligowski, Reneke, Peacock, Nilsson
2013, doi 10.6028/NIST.TN.1822), from which the standard was developed; its own numbers are not public.
"""

from __future__ import annotations

from typing import NamedTuple


class Case(NamedTuple):
    """One case of a guideline.

    Fields:
        name: number or name in the guideline.
        about: what it tests.
        where: names of the checks that run it, empty if none does.
        why: why it is not run, or how the check differs.
    """

    name: str
    about: str
    where: tuple[str, ...] = ()
    why: str = ""


STAIRS = "stairs and ramps slow people down by fixed shares in the physics world, for all crowd models alike"
CHOICE = "crowd models receive goals; the trial or the user chooses exits and routes"
STATE = "the preferred speed is an input of every crowd model"

RIMEA_CASES = (
    Case("1", "speed in a corridor", ("rimea-1",)),
    Case("2", "speed up stairs", (), STAIRS),
    Case("3", "speed down stairs", (), STAIRS),
    Case("4", "fundamental diagram", ("single-file", "corridor")),
    Case("5", "premovement times", ("premovement",)),
    Case("6", "movement around a corner", ("rimea-6",)),
    Case("7", "assignment of demographic parameters", ("rimea-7",)),
    Case("8", "parameter study in a building with storeys", (), "storeys are not supported"),
    Case("9", "crowd that leaves a large room", ("rimea-9",), "a quarter of the people and of the area"),
    Case("10", "assigned exits", ("exits",), "other dimensions of the cabins"),
    Case("11", "choice of an exit", (), CHOICE),
    Case("12", "effect of a bottleneck", ("rimea-12",)),
    Case("13", "jam in front of stairs", (), STAIRS),
    Case("14", "choice of a route", (), CHOICE),
    Case("15", "crowd around a corner", ("rimea-15",), "half of the lengths and a quarter of the people"),
)
"""Tests of the RiMEA guideline 3.0.0."""

ISO_CASES = (
    Case("pre-evacuation times", "people start at their times", ("premovement",)),
    Case("speed in a corridor", "a lone walker keeps the speed", ("rimea-1",)),
    Case("speed on stairs", "a lone walker on stairs", (), STAIRS),
    Case("movement around a corner", "nobody passes through walls", ("rimea-6", "rimea-15")),
    Case("assigned demographics", "free speeds of a population", ("rimea-7",)),
    Case("reduced visibility", "speed falls with visibility", (), STATE),
    Case("incapacitation", "people become unable to move", (), STATE),
    Case("elevators", "people use elevators", (), "elevators are not supported"),
    Case(
        "horizontal counter-flow", "time rises with the people against", ("counter-flow", "narrow"), "half the people"
    ),
    Case("group behaviour", "a group waits for its slow member", ("group",), "20 m in the open"),
    Case("people with disabilities", "slow and large bodies", (), "speed and radius of each person are inputs"),
    Case("exit route allocation", "people use assigned exits", ("exits",)),
    Case("social influence", "exits are chosen by imitation", (), CHOICE),
    Case("affiliation", "familiar exits are preferred", (), CHOICE),
    Case("dynamic availability of exits", "an exit closes", (), "doors of a trial open and close; " + CHOICE),
    Case("congestion", "a queue forms before a narrow passage", ("rimea-12",)),
    Case("maximum flow rates", "the flow through an exit is limited", ("bottleneck", "rimea-9")),
)
"""Components of ISO 20414 and NIST TN 1822."""
