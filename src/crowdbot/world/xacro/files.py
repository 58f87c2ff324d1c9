"""Contract of the files that a xacro file may read, and elements that know their file."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from crowdbot.core import Element


class FileSource(Protocol):
    """Finds the files of a robot; nothing outside its folders is found."""

    def find(self, reference: str, beside: Path | None = None) -> Path | None:
        """Return the file of ``package://NAME/PATH`` or of a path relative to ``beside``, or None if it is missing."""


@dataclass
class SourceElement(Element):
    """An element that knows its file: ``place`` is the name of the file for messages."""

    place: str = ""


def with_place(element: Element, place: str) -> SourceElement:
    """Return an element and its children with the name of their file."""
    children: list[Element] = [with_place(child, place) for child in element.children]
    return SourceElement(
        element.tag, dict(element.attributes), children, line=element.line, stray=element.stray, place=place
    )
