"""Appearance of people: bodies, outfits and activities."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from crowdbot import humans
from crowdbot.core import InputError, stream
from crowdbot.trials.agent import Agent, Avatar
from crowdbot.trials.files.trial_files import resolve_file
from crowdbot.trials.human_kinds import KINDS, clip_names, own_body_names
from crowdbot.trials.people import Spawner

from .spawn_placement import InitialPeople

if TYPE_CHECKING:
    from crowdbot.trials.trial import Trial


OUTFITS = 1000


class PersonAppearance(NamedTuple):
    """Body, outfit and activity of one person; empty or -1 if not given."""

    body: str
    outfit: int
    activity: str


class PeopleAppearance(NamedTuple):
    """Appearance of all people of a trial, followed by the riders of robots.

    Fields:
        people: bodies of people and riders.
        activity: activities of people, without riders.
        riders: indices of the robots with a rider.
    """

    people: humans.People
    activity: tuple[str, ...]
    riders: tuple[int, ...] = ()


def body_names(text: str) -> tuple[str, ...]:
    """Return the names of the bodies in ``body``, which lists bodies and kinds of bodies.

    >>> len(body_names("man")), body_names("woman-36 mannequin")
    (20, ('woman-36', 'mannequin'))
    """
    everyone = humans.names()
    found: list[str] = []
    for word in text.split():
        kinds = KINDS.get(word, ())
        found += [name for name in everyone if name == word or name.split("-")[0] in kinds]
        found += own_body_names([word])
    return tuple(dict.fromkeys(found))


def trial_clips(trial: Trial) -> dict[str, Path]:
    """Return the files of the clips that people of a trial play, by name.

    Raises:
        InputError: the trial has no folder.
    """
    owners = (trial.agents, trial.spawners, trial.sources)
    names = clip_names(item.activity for group in owners for item in group)
    return _files_beside(trial, "activity", names)


def read_clips(trial: Trial) -> tuple[humans.Clip, ...]:
    """Return the clips that people of a trial play.

    Raises:
        InputError: a file is missing or no clip.
    """
    found = []
    for name, path in trial_clips(trial).items():
        try:
            found.append(humans.read_clip(path.read_text(encoding="utf-8"), name))
        except (OSError, UnicodeDecodeError) as error:
            raise InputError(f"cannot read the clip {path}: {error}; crowdbot new clip FILE.bvh writes one") from None
    return tuple(found)


def trial_bodies(trial: Trial) -> dict[str, Path]:
    """Return the files of the imported bodies of a trial, by name.

    Raises:
        InputError: the trial has no folder, or a file is missing.
    """
    owners = (trial.agents, trial.spawners, trial.sources, trial.avatars)
    names = own_body_names(item.body for group in owners for item in group)
    return _files_beside(trial, "body", names)


def _files_beside(trial: Trial, word: str, names: Sequence[str]) -> dict[str, Path]:
    """Return the files of names in a trial; ``word`` is the attribute that holds them."""
    if names and trial.folder is None:
        raise InputError(f"{word} {names[0]!r} is a file beside the trial, but {trial.name} has no folder")
    return {name: resolve_file(name, trial.folder, trust=False) for name in names}


def read_bodies(trial: Trial) -> tuple[humans.RiggedBody, ...]:
    """Return the imported bodies of a trial.

    Raises:
        InputError: a file is missing or no body.
    """
    return tuple(humans.read_body(path) for path in trial_bodies(trial).values())


def draw_appearances(people: InitialPeople, seed: int) -> list[PersonAppearance]:
    """Return the appearance of the people at the beginning, in the order of their indices."""
    person_appearances: list[PersonAppearance] = []
    agents = sum(isinstance(owner, Agent) for owner in people.owners)
    counts = np.bincount(people.owner, minlength=len(people.owners)).tolist()
    for k, (owner, count) in enumerate(zip(people.owners, counts, strict=True)):
        keys: tuple[Any, ...] = ("agent", k) if k < agents else ("spawner", k - agents)
        if isinstance(owner, Agent | Spawner):
            outfit = getattr(owner, "outfit", None)
            person_appearances += _draw(owner.body, owner.activity, count, (seed, *keys), outfit)
        elif isinstance(owner, Avatar):
            person_appearances += _draw(owner.body, "", count, (seed, "avatar", owner.name), owner.outfit)
        else:
            person_appearances += [PersonAppearance("", -1, "")] * count
    return person_appearances


def people_appearance(trial: Trial, people: InitialPeople, agents: int, seed: int) -> PeopleAppearance:
    """Return bodies and activities of all ``agents`` except robots, and of riders.

    The default is a random adult, drawn as in a world. People of sources take free indices in any order, so the bodies
    and activities of several sources are mixed.
    """
    count = agents - len(trial.robots)
    default = humans.People.sample(count, stream(seed, "people"))
    said = draw_appearances(people, seed)
    bodies = " ".join(source.body for source in trial.sources)
    busy = " ".join(source.activity or "walk" for source in trial.sources) if any(
        source.activity for source in trial.sources) else ""  # fmt: skip
    said += _draw(bodies, busy, count - len(said), (seed, "sources"), None)
    names = [figure.body or person.name for figure, person in zip(said, default.persons, strict=True)]
    outfits = [
        figure.outfit if figure.outfit >= 0 else int(own) for figure, own in zip(said, default.variation, strict=True)
    ]
    carriers = [k for k, robot in enumerate(trial.robots) if robot.rider_kind]
    for k in carriers:
        (figure,) = _draw(trial.robots[k].rider_kind, "", 1, (seed, "rider", k), None)
        names.append(figure.body)
        outfits.append(figure.outfit)
    busy_with = tuple(figure.activity or "walk" for figure in said)
    own = read_bodies(trial)
    whole = humans.People.of(names, outfits, own=own)
    tall = [owner.height if isinstance(owner, Avatar) else None for owner in people.owners]
    if any(tall):
        heights = [tall[k] for k in people.owner.tolist()] + [None] * (len(names) - len(people))
        given = [own if height is None else height for height, own in zip(heights, whole.height.tolist(), strict=True)]
        whole = humans.People.of(names, outfits, given, own)
    clips = read_clips(trial)
    whole = dataclasses.replace(whole, clips=clips) if clips else whole
    return PeopleAppearance(whole, busy_with, tuple(len(people) + k for k in carriers))


def _draw(body: str, activity: str, count: int, keys: tuple[Any, ...], outfit: int | None) -> list[PersonAppearance]:
    """Draw ``count`` appearances; bodies and activities have separate random streams."""
    names, busy = body_names(body), activity.split()
    seed, *rest = keys
    clothes = stream(seed, *rest, "body")
    who = clothes.integers(len(names), size=count).tolist() if names else [-1] * count
    outfits = clothes.integers(OUTFITS, size=count).tolist() if names else [-1] * count
    doing = stream(seed, *rest, "activity").integers(len(busy), size=count).tolist() if busy else [-1] * count
    return [
        PersonAppearance(
            names[who[k]] if names else "",
            (outfits[k] if outfit is None else outfit) if names else (-1 if outfit is None else outfit),
            busy[doing[k]] if busy else "",
        )
        for k in range(count)
    ]
