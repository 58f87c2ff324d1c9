"""Calls with hostile values to every command of the simulator, experiments and virtual reality: a sentence, no bug."""

import asyncio
import inspect
import math
import random
import types
import typing

import pytest
from hostile_frames import NASTY
from simulator_session import ready

from crowdbot.core import CrowdbotError
from crowdbot.vr import VR_DESKS
from crowdbot.web import AppSession, Workspace, call_command, command_names

CALLS = 40
"""Calls of each command."""
NUMBERS = {int: (-1, 0, 2**63, 10**30, -(10**30)), float: (-1.0, 0.0, 1e308, math.nan, math.inf, -math.inf, 10**400)}


@pytest.fixture
def session(tmp_path):
    """A session with all desks, and a file outside its folder."""
    (tmp_path / "secret.xml").write_text("<trial/>")
    loop = asyncio.new_event_loop()
    made = AppSession("main", Workspace(tmp_path / "files"), VR_DESKS, loop)
    yield made
    made.close()
    loop.close()


def value(rng, hint):
    """Return a hostile value that passes the check of types."""
    if typing.get_origin(hint) in (typing.Union, types.UnionType):
        hint = rng.choice(typing.get_args(hint))
    kind = typing.get_origin(hint) or hint
    if kind is types.NoneType:
        return None
    if kind is bool:
        return rng.random() < 0.5
    return rng.choice(NUMBERS.get(kind) or [item for item in NASTY if isinstance(item, kind)])


def attack(session, name):
    """Call every command of a desk; return the errors that are bugs, and the number of sentences."""
    rng, desk = random.Random(name), session.desk(name)
    bugs, sentences = [], 0
    for command in command_names(desk):
        method = getattr(type(desk), command)
        hints = typing.get_type_hints(method)
        keys = [key for key in inspect.signature(method).parameters if key != "self"]
        for _ in range(CALLS if keys else 1):
            arguments = {key: value(rng, hints[key]) for key in keys}
            try:
                call_command(desk, command, arguments)
            except CrowdbotError:
                sentences += 1
            except OSError as error:  # told with the name of the file
                bugs += [] if error.filename else [(command, arguments, repr(error))]
            except Exception as error:
                bugs.append((command, f"{arguments!r:.200}", f"{error!r:.200}"))
    return bugs, sentences


@pytest.mark.parametrize("name", ["simulator", "experiments", "vr"])
def test_hostile_values_are_told_and_nothing_is_written_outside(session, tmp_path, name):
    bugs, sentences = attack(session, name)
    assert bugs == []
    assert sentences > 100
    assert sorted(item.name for item in tmp_path.iterdir()) == ["files", "secret.xml"]
    assert (tmp_path / "secret.xml").read_text() == "<trial/>"


def test_a_paused_run_survives_hostile_values(session):
    desk = session.desk("simulator")
    desk.open("frontal", paused=True)
    assert ready(desk)["state"] == "paused"
    bugs, sentences = attack(session, "simulator")
    assert bugs == []
    assert sentences > 100
    desk.open("frontal", paused=True)
    assert ready(desk)["state"] == "paused"
