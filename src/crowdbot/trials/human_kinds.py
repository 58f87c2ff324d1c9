"""Kinds of people: the bodies and activities that elements can name."""

from __future__ import annotations

from crowdbot import humans
from crowdbot.core import InputError, did_you_mean

from .fields import quote_value

__all__ = ["ABOUT_ACTIVITY", "ABOUT_BODY", "ABOUT_RIDER", "KINDS", "check_words", "rider_problems", "word_problems"]

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
    "name of a body (woman-36) or kind (man, woman, adult, boy, girl, child, mannequin); from a list, one is chosen at"
    " random"
)
ABOUT_RIDER = "person in the seat, as the body of a person (default: as the type); only wheelchairs have a seat"
ABOUT_ACTIVITY = "walk, talk, phone, bottle, text or sit; from a list, one is chosen at random"


def check_words(body: str, activity: str) -> None:
    """Check that every word is a known body or activity.

    Raises:
        InputError: a word is unknown.

    >>> check_words("woman-36 child", "talk phone")
    >>> check_words("womn", "")
    Traceback (most recent call last):
    crowdbot.core.errors.InputError: body="womn" has 'womn', did you mean 'woman'?; it takes man, woman, boy, girl, \
adult, child, mannequin or a name from crowdbot list humans
    """
    for problem in word_problems(body, activity):
        raise InputError(problem)


def word_problems(body: str, activity: str) -> list[str]:
    """Return a sentence for every unknown body or activity."""
    bodies = (*KINDS, *humans.names())
    takes = f"{', '.join(KINDS)} or a name from crowdbot list humans"
    wrong = [(word, "body", body, bodies, takes) for word in body.split() if word not in bodies]
    acts = ", ".join(humans.ACTIVITIES)
    wrong += [
        (word, "activity", activity, humans.ACTIVITIES, acts)
        for word in activity.split()
        if word not in humans.ACTIVITIES
    ]
    return [
        f"{what}={quote_value(text)} has {word[:40]!r}{did_you_mean(word, known)}; it takes {takes}"
        for word, what, text, known, takes in wrong
    ]


def rider_problems(rider: str, seat: bool) -> list[str]:
    """Return the problems of the rider of a robot with or without a seat.

    >>> rider_problems("woman-36", True), rider_problems("woman", False)
    ([], ['rider="woman" needs type="wheelchair": other robots have no seat; leave it out'])
    """
    if rider and not seat:
        return [f'rider={quote_value(rider)} needs type="wheelchair": other robots have no seat; leave it out']
    return [problem.replace("body=", "rider=", 1) for problem in word_problems(rider, "")]
