"""Contract of the files that a xacro file may read, and their elements."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Protocol

from crowdbot.core import Element


class FileSource(Protocol):
    """Finds the files of a robot; nothing outside its folders is found."""

    def find(self, reference: str, beside: Path | None = None) -> Path | None:
        """Return the file of ``package://NAME/PATH`` or of a path relative to ``beside``, or None if it is missing."""

    def lack(self, reference: str) -> str:
        """Return why a file that was not found is missing and what to do; empty if nothing more is known."""


def with_place(element: Element, place: str) -> Element:
    """Return a copy of an element and its children with the name of their file."""
    children = [with_place(child, place) for child in element.children]
    return replace(element, attributes=dict(element.attributes), children=children, place=place)
