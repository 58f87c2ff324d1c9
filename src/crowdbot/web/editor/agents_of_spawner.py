"""Spawners as single people, and single people as a spawner."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, TrialError
from crowdbot.trials import Avatar, Points, Trial, expand_spawners, place, trial_xml

from .xml_document import XmlDocument

__all__ = ["agents_of_spawner", "spawner_of_agents"]

ROOM = 0.3
"""Distance between the people and the border of their zone [m]."""
SAME = ("journey", "speed", "radius", "arrival", "crowd", "body", "activity")
"""Attributes that a spawner takes over if all its people have the same value."""


def agents_of_spawner(document: XmlDocument, path: Sequence[int], trial: Trial, seed: int) -> XmlDocument:
    """Return a document with the people of a spawner as single agents, at the places drawn with a seed.

    Args:
        document: the text of the trial.
        path: the spawner.
        trial: the trial in the text.
        seed: seed of the placement.

    Raises:
        InputError: the element is not a spawner, or people do not fit with this seed.
    """
    node = document.node(path)
    if node.tag != "spawner" or len(path) != 1:
        raise InputError(f"<{node.tag}> is not a spawner")
    if trial.sweeps:
        raise TrialError("the trial has sweeps; take one of its variants")
    number = [one for one in document.root.children if one.tag == "spawner"].index(node)
    spawner = trial.spawners[number]
    people, _ = place(trial.stage, trial.spawners, trial.robots, seed, trial.agents, avatars=trial.avatars)
    owners = [people.owners[int(one)] for one in people.owner]
    walking = [owner for owner in owners if not isinstance(owner, Avatar)]
    agents = expand_spawners(trial, seed).agents
    mine = tuple(agent for agent, owner in zip(agents, walking, strict=True) if owner is spawner)
    text = trial_xml(dataclasses.replace(trial, agents=mine, spawners=()))
    source = XmlDocument(text)
    for one in source.root.children:
        if one.tag == "agent":
            document = document.insert((), source.text[one.begin : one.end])
    return document.remove(path)


def spawner_of_agents(document: XmlDocument, paths: Sequence[Sequence[int]]) -> XmlDocument:
    """Return a document with a spawner in the place of single agents.

    Its zone is the rectangle around the agents and its goal the rectangle around their goals; attributes that all of
    them have are kept.

    Raises:
        InputError: an element is not an agent, or there is none.
    """
    nodes = [document.node(path) for path in paths]
    if not nodes or any(one.tag != "agent" for one in nodes):
        raise InputError("choose one or more agents")
    rows = [one.attributes for one in nodes]
    try:
        starts = np.array([[float(row["x"]), float(row["y"])] for row in rows])
        goals = [point for row in rows for point in Points.parse(row.get("goal") or row.get("goal-zone") or "")]
    except (KeyError, ValueError):
        raise InputError("an agent has no readable place or goal; correct it first") from None
    words = {"count": str(len(rows)), "zone": _rectangle(starts)}
    if goals:
        words["goal"] = _rectangle(np.array(goals))
    for name in SAME:
        if len(values := {row.get(name) for row in rows}) == 1 and (value := values.pop()) is not None:
            words[name] = value
    for path in sorted((tuple(one) for one in paths), reverse=True):
        document = document.remove(path)
    document = document.insert((), "<spawner/>")
    last = (len(document.root.children) - 1,)
    for name, value in words.items():
        document = document.set(last, name, value)
    return document


def _rectangle(points: NDArray[np.float64]) -> str:
    (left, low), (right, high) = points.min(axis=0) - ROOM, points.max(axis=0) + ROOM
    return str(Points.of(np.round([(left, low), (right, low), (right, high), (left, high)], 3)))
