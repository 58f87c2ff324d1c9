"""Old names of attributes: files of earlier versions load, with one warning that lists the current names."""

from __future__ import annotations

import warnings

from crowdbot.core import Element, format_xml, parse_xml

__all__ = ["OLD_ATTRIBUTES", "OldNameWarning", "current_name", "restore_old_names", "update_names"]

OLD_ATTRIBUTES = {
    ("trial", "berth"): "robot-margin",
    ("trial", "symmetry"): "heading-jitter",
    ("source", "most"): "max-count",
    ("robot", "equipped"): "default-sensors",
    ("robot", "rates"): "sensor-rates",
    ("recorded", "near"): "reaction-distance",
    ("recorded", "without"): "exclude",
    ("choice", "several"): "multiple",
    ("number", "at-least"): "min",
    ("number", "at-most"): "max",
    ("number", "whole"): "integer",
    ("free-text", "at-most"): "max-length",
}
"""Element and attribute as version 0.1 writes them, and the name of the attribute now."""


NEW_ATTRIBUTES = {(tag, new): old for (tag, old), new in OLD_ATTRIBUTES.items()}


class OldNameWarning(UserWarning):
    """A file uses names of an earlier version."""


def current_name(tag: str, attribute: str) -> str:
    """Return the current name of an attribute.

    >>> current_name("trial", "berth"), current_name("trial", "duration")
    ('robot-margin', 'duration')
    """
    return OLD_ATTRIBUTES.get((tag, attribute.replace("_", "-")), attribute)


def update_names(root: Element, place: str, *, quiet: bool = False) -> None:
    """Rename old attributes in a tree, in place.

    An attribute keeps its old name if the element has the new one too; the reader then reports it.

    Args:
        root: the tree.
        place: name of the file for the warning.
        quiet: do not warn.

    Warns:
        OldNameWarning: one line that lists every old name of the file.

    >>> root = Element("trial", {"berth": "0.2"}, line=1)
    >>> update_names(root, "hall.xml", quiet=True)
    >>> root.attributes
    {'robot-margin': '0.2'}
    """
    found: dict[str, None] = {}
    first = _update(root, found)
    if found and not quiet:
        warnings.warn(f"{place}:{first}: old names of attributes: {'; '.join(found)}", OldNameWarning, stacklevel=3)


def restore_old_names(text: str) -> str:
    """Return XML as version 0.1 writes it, for hashes that were made of its text.

    >>> print(restore_old_names('<trial name="hall" robot-margin="0.2"/>').splitlines()[-1])
    <trial name="hall" berth="0.2"/>
    """
    root = parse_xml(text.encode(), "text", what="file")
    _restore(root)
    return format_xml(root)


def _restore(element: Element) -> None:
    old = {NEW_ATTRIBUTES.get((element.tag, key), key): value for key, value in element.attributes.items()}
    element.attributes = old
    for inner in element.children:
        _restore(inner)


def _update(element: Element, found: dict[str, None]) -> int:
    """Rename below an element, collect sentences, and return the first line with an old name (0: none)."""
    first = 0
    for key in list(element.attributes):
        new = current_name(element.tag, key)
        if new != key and new not in element.attributes:
            found[f"<{element.tag} {key}> is now {new}"] = None
            first = first or element.line
    element.attributes = {
        (current_name(element.tag, key) if current_name(element.tag, key) not in element.attributes else key): value
        for key, value in element.attributes.items()
    }
    for inner in element.children:
        line = _update(inner, found)
        first = first or line
    return first
