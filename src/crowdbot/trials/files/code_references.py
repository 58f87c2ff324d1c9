"""Code references: the Python files that the trial of an episode would run, found without running any."""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterator, Mapping
from pathlib import Path, PurePosixPath

from crowdbot.core import Element, InputError, parse_xml, plugin_sources, read_bytes, source_digest
from crowdbot.trials.xml.trial_text import parse_trial_xml

ENDINGS = (".py", ".pyc", ".pyo", ".pyw", ".pyd", ".so")
ADDRESS = re.compile(r"([^\s,;|\"':=]+):[A-Za-z_]")


def is_code(name: str) -> bool:
    """Return whether Python loads a file of this name as code, on any system.

    >>> is_code("shy.py"), is_code("mine/SHY.PY"), is_code("__pycache__/shy.cpython-312.pyc"), is_code("hall.pgm")
    (True, True, True, False)
    """
    plain = name.lower().rstrip(". ")  # Windows ignores case and trailing dots and blanks
    return plain.endswith(ENDINGS) or "__pycache__" in PurePosixPath(plain).parts


def code_digest(xml: str, folder: Path | None, *more: str) -> str:
    """Return a hash of all code that a run of a trial depends on: of crowdbot, the trial and the files beside it.

    Args:
        xml: text of the trial.
        folder: folder of the trial, or None for the working directory.
        more: further texts that the result depends on.

    >>> code_digest("<trial/>", None) == code_digest("<trial/>", None, "seed 1")
    False
    """
    found, place = hashlib.blake2b(digest_size=12), folder or Path.cwd()
    for part in (source_digest(), xml, *more):
        found.update(part.encode() + b"\0")
    for name in code_references({"trial": xml}, place):
        found.update(name.encode() + b"\0" + (place / name).read_bytes())
    return found.hexdigest()


def code_references(known: Mapping[str, str], folder: Path) -> list[str]:
    """Return the Python files named by the trials of an episode and by their robot folders.

    Args:
        known: metadata of the episode.
        folder: folder of the trial and of its robot folders.
    """
    found: list[str] = []
    for text in _trials(known):
        try:
            root = parse_trial_xml(text.encode("utf-8", "replace"), "trial", "utf-8")
            for element in _all(root):
                found += _files(element, folder)
                robot = folder / element.attributes.get("type", "") / "robot.xml"
                if element.tag == "robot" and robot.is_file():
                    parts = _all(parse_xml(read_bytes(robot), str(robot)))
                    found += [
                        f"{element.attributes['type']}/{name}" for part in parts for name in _files(part, robot.parent)
                    ]
        except (InputError, OSError, ValueError):
            continue  # nothing of it runs; the parser reports the error
    return sorted(set(found))


def _trials(known: Mapping[str, str]) -> Iterator[str]:
    yield known["trial"]
    try:
        yield from (str(load["trial"]) for load in json.loads(known.get("origin", "[]")))
    except (ValueError, TypeError, KeyError):
        return  # the loader reports the damaged file


def _all(element: Element) -> Iterator[Element]:
    yield element
    for child in element.children:
        yield from _all(child)


def _files(element: Element, folder: Path) -> list[str]:
    """Return the Python files in the addresses of an element or in the values of a sweep."""
    if element.tag == "sweep":
        places = [name for text in element.attributes.values() for name in ADDRESS.findall(text)]
    else:
        named = ("type", "function") if element.tag in ("avatar", "pose") else ("type",)
        places = [element.attributes.get(name, "").rpartition(":")[0] for name in named]
    return [name for place in places if place for name in plugin_sources(place, folder)]
