"""Words about people: the bodies and activities that their elements name."""

from __future__ import annotations

from crowdbot import humans
from crowdbot.core import InputError
from crowdbot.core.errors import did_you_mean

from .attribute import shown

__all__ = ["ABOUT_ACTIVITY", "ABOUT_BODY", "KINDS", "check_words"]

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
    "name of a body (woman-36) or kind (man, woman, adult, boy, girl, child, mannequin); of several one is drawn"
)
ABOUT_ACTIVITY = "walk, talk, phone, bottle, text or sit; of several one is drawn"


def check_words(body: str, activity: str) -> None:
    """Raise unless every word is a body or an activity.

    Raises:
        InputError: one is not.

    >>> check_words("woman-36 child", "talk phone")
    >>> check_words("womn", "")
    Traceback (most recent call last):
    crowdbot.core.errors.InputError: body="womn" has 'womn', did you mean 'woman'?; it takes man, woman, boy, girl, \
adult, child, mannequin or a name from crowdbot list humans
    """
    known = (*KINDS, *humans.names())
    for word in body.split():
        if word not in known:
            raise InputError(
                f"body={shown(body)} has {word[:40]!r}{did_you_mean(word, known)}; it takes {', '.join(KINDS)} or a"
                " name from crowdbot list humans"
            )
    for word in activity.split():
        if word not in humans.ACTIVITIES:
            raise InputError(
                f"activity={shown(activity)} has {word[:40]!r}{did_you_mean(word, humans.ACTIVITIES)}; it takes"
                f" {', '.join(humans.ACTIVITIES)}"
            )
