"""Kinds of people: the bodies and activities that elements can name."""

from __future__ import annotations

import re
from collections.abc import Iterable

from crowdbot import humans
from crowdbot.core import InputError, did_you_mean
from crowdbot.core.fields import quote_value

KINDS = {
    "man": ("man",),
    "woman": ("woman",),
    "boy": ("boy",),
    "girl": ("girl",),
    "adult": ("man", "woman"),
    "child": ("boy", "girl"),
    "mannequin": ("mannequin",),
}
ABOUT_BODY = (
    "name of a body (woman-36), kind (man, woman, adult, boy, girl, child, mannequin) or file of an imported body"
    " (ann.body); from a list, one is chosen at random"
)
ABOUT_RIDER = "person in the seat, as the body of a person (default: as the type); only wheelchairs have a seat"
ABOUT_ACTIVITY = (
    "walk, talk, phone, bottle, text, sit, wave, carry, read, stick, pram, wheelchair, run, look, signal-wait,"
    " signal-proceed, or a file of motion capture (walk.clip); from a list, one is chosen at random"
)
CLIP_NAME = re.compile(r"[A-Za-z0-9_-]{1,60}\.clip")
"""Names of clips: files beside the trial."""


def check_words(body: str, activity: str) -> None:
    """Check that every word is a known body or activity.

    Raises:
        InputError: a word is unknown.

    >>> check_words("woman-36 child", "talk phone")
    >>> check_words("womn", "")
    Traceback (most recent call last):
    crowdbot.core.errors.InputError: body="womn" has 'womn', did you mean 'woman'?; it takes man, woman, boy, girl, \
adult, child, mannequin, a name from crowdbot list humans, or a body beside the trial such as ann.body
    """
    for problem in word_problems(body, activity):
        raise InputError(problem)


def word_problems(body: str, activity: str) -> list[str]:
    """Return a sentence for every unknown body or activity."""
    bodies = (*KINDS, *humans.names())
    takes = f"{', '.join(KINDS)}, a name from crowdbot list humans, or a body beside the trial such as ann.body"
    wrong = [
        (word, "body", body, bodies, takes)
        for word in body.split()
        if word not in bodies and not humans.BODY_NAME.fullmatch(word)
    ]
    acts = f"{', '.join(humans.ACTIVITIES)}, or a clip beside the trial such as walk.clip"
    wrong += [
        (word, "activity", activity, humans.ACTIVITIES, acts)
        for word in activity.split()
        if word not in humans.ACTIVITIES and not CLIP_NAME.fullmatch(word)
    ]
    return [
        f"{what}={quote_value(text)} has {word[:40]!r}{did_you_mean(word, known)}; it takes {takes}"
        for word, what, text, known, takes in wrong
    ]


def clip_names(activities: Iterable[str]) -> tuple[str, ...]:
    """Return the names of clips among activities, each once.

    >>> clip_names(["walk limp.clip", "limp.clip"])
    ('limp.clip',)
    """
    words = {word for text in activities for word in text.split() if CLIP_NAME.fullmatch(word)}
    return tuple(sorted(words))


def own_body_names(bodies: Iterable[str]) -> tuple[str, ...]:
    """Return the names of the files of imported bodies among bodies, each once.

    >>> own_body_names(["man ann.body", "ann.body"])
    ('ann.body',)
    """
    return tuple(sorted({word for text in bodies for word in text.split() if humans.BODY_NAME.fullmatch(word)}))


def rider_problems(rider: str, seat: bool) -> list[str]:
    """Return the problems of the rider of a robot with or without a seat.

    >>> rider_problems("woman-36", True), rider_problems("woman", False)
    ([], ['rider="woman" needs type="wheelchair": other robots have no seat; leave it out'])
    """
    if rider and not seat:
        return [f'rider={quote_value(rider)} needs type="wheelchair": other robots have no seat; leave it out']
    if own_body_names([rider]):
        return [f"rider={quote_value(rider)} is an imported body; riders take the included bodies"]
    return [problem.replace("body=", "rider=", 1) for problem in word_problems(rider, "")]
