"""From XML to a trial: every problem at once, each with its file and line.

The reader knows no element by name. It walks over the outline of the dataclasses, so that a new element is a new
dataclass and nothing more.
"""

from __future__ import annotations

import dataclasses
from collections import Counter
from pathlib import Path
from typing import Any

from crowdbot.core import InputError, TrialError, plug
from crowdbot.core.errors import did_you_mean

from .attribute import Part, Plug, outline, shown
from .checked import Checked
from .checks import problems_of
from .distribution import Distribution
from .drawn import Drawn, is_drawn
from .markup import Element, parse
from .notation import number
from .sweep import sweep_problems
from .trial import Trial

__all__ = ["Reader", "read_trial"]

MOST_PROBLEMS = 100
ROOT = "trial"


def read_trial(text: str | bytes, *, place: str = "trial", folder: Path | None = None, trust: bool = False) -> Trial:
    """Read a trial from XML and check it.

    Args:
        text: the XML.
        place: name of the file for messages.
        folder: of the trial; code that the trial names is looked up here (default: the working folder).
        trust: whether code from outside the folder may be loaded.

    Raises:
        TrialError: with every problem found, one sentence each, in the order of the lines.

    >>> read_trial('<trial name="t" duration="-1"><crowd type="orca" time-horizn="2"/></trial>')
    Traceback (most recent call last):
    crowdbot.core.errors.TrialError: trial:1: <trial> duration="-1" must be above 0 s and at most 86400 s
    trial:1: <crowd> has no attribute 'time-horizn', did you mean 'time-horizon'?; it takes neighbor-distance, \
max-neighbors, time-horizon, time-horizon-walls, max-speed, name
    """
    try:
        data = text.encode() if isinstance(text, str) else text
    except UnicodeEncodeError:
        raise TrialError(f"{place}: this is not well-formed XML: it holds half a character") from None
    root = parse(data, place, "utf-8" if isinstance(text, str) else None)
    reader = Reader(place, folder or Path.cwd(), trust)
    if root.tag != ROOT:
        raise TrialError(f"{place}:{root.line}: the root element is <{root.tag[:40]}>, it must be <{ROOT}>")
    trial, values = reader.element(Trial, root)
    for thing, sentence in problems_of(Checked.of(values, reader.broken)):
        reader.say(reader.lines.get(id(thing), root.line), reader.words.get(id(thing), ROOT), sentence)
    reader.finish()
    assert isinstance(trial, Trial)
    trial = dataclasses.replace(trial, folder=folder)
    for sentence in sweep_problems(trial, None, trust) if trial.sweeps else ():
        line = next(inner.line for inner in root.children if inner.tag == "sweep")
        reader.say(line, "sweep", sentence)
    reader.finish()
    return trial


class Reader:
    """Makes a tree of frozen dataclasses of XML elements, and collects every problem meanwhile.

    Args:
        place: name of the file for messages.
        folder: where code and files that the tree names lie.
        trust: whether they may lie elsewhere.

    Attributes:
        made: everything that could be made.
        lines, words: line and tag of it, by its ``id``.
        broken: tags of elements that could not be read.
    """

    def __init__(self, place: str, folder: Path, trust: bool) -> None:
        self.place, self.folder, self.trust = place, folder, trust
        self.found: list[tuple[int, str]] = []
        self.lines: dict[int, int] = {}
        self.words: dict[int, str] = {}
        self.made: list[Any] = []
        self.broken: set[str] = set()
        """Elements of which one could not be read, so that others may well have named it."""

    def say(self, line: int, tag: str, sentence: str) -> None:
        """Add a problem of an element."""
        self.found.append((line, f"{self.place}:{line}: <{tag[:40]}> {sentence}"))

    def finish(self) -> None:
        """Raise when anything was said."""
        sentences = [sentence for _, sentence in sorted(self.found, key=lambda row: row[0])]
        if len(sentences) > MOST_PROBLEMS:
            more = len(sentences) - MOST_PROBLEMS
            sentences = [*sentences[:MOST_PROBLEMS], f"{self.place}: and {more} more problems"]
        if sentences:
            raise TrialError(*sentences)

    def element(self, cls: type, element: Element) -> tuple[Any, dict[str, Any]]:
        """Return what the element means, None when it has a problem; and the fields that are right or left out."""
        before = len(self.found)
        parts = outline(cls)
        values = self._attributes(element, parts)
        values |= self._children(element, parts)
        for part in parts:
            if part.name in values or self._tried(element, part):
                continue
            if part.required:
                self.say(element.line, element.tag, f"needs {_kind(part)}")
            else:
                values[part.name] = part.default
        files = self._files(cls)
        if hasattr(cls, "mistakes"):
            for sentence in cls.mistakes(values | files):
                self.say(element.line, element.tag, sentence)
        if len(self.found) > before:
            return None, values
        return self._make(cls, element, values | files), values

    def _files(self, cls: type) -> dict[str, Any]:
        """Return where the files lie that an element names, as fields of it."""
        named = any(field.name == "trust" for field in dataclasses.fields(cls))
        return {"folder": self.folder, "trust": self.trust} if named else {}

    def _make(self, cls: type, element: Element, values: dict[str, Any]) -> Any:
        try:
            made = cls(**values)
        except InputError as error:
            self.say(element.line, element.tag, str(error))
            return None
        self.lines[id(made)] = element.line
        self.words[id(made)] = element.tag
        self.made.append(made)  # keeps it alive, so that its id stays its own
        return made

    def _tried(self, element: Element, part: Part) -> bool:
        """Whether the field was given, however wrong; that was said already."""
        if part.role == "attribute":
            return any(key.replace("_", "-") == part.word for key in element.attributes)
        if part.role == "mounted":
            return True
        return any(inner.tag in part.words for inner in element.children)

    def _attributes(self, element: Element, parts: tuple[Part, ...]) -> dict[str, Any]:
        own = {part.word: part for part in parts if part.role == "attribute"}
        mount = next((part for part in parts if part.role == "mounted"), None)
        values: dict[str, Any] = {}
        rest: dict[str, str] = {}
        for key, text in element.attributes.items():
            part = own.get(key.replace("_", "-"))
            if part is None:
                rest[key] = text
                continue
            if part.name in values:
                self.say(element.line, element.tag, f"has the attribute {part.word} twice")
            try:
                value = _converted(text, part.kind)
                wrong = part.wrong(value)
            except InputError as error:
                wrong = str(error)
            if wrong:
                self.say(element.line, element.tag, f"{part.word}={shown(text)} {wrong}")
            else:
                values[part.name] = value
        if mount is not None and mount.plug is not None:
            made = self._plug(mount.plug, element, rest, list(own))
            if made is not None:
                values[mount.name] = made
            return values
        for key in rest:
            known = ", ".join(own) or "none"
            self.say(
                element.line, element.tag, f"has no attribute {key[:40]!r}{did_you_mean(key, own)}; it takes {known}"
            )
        return values

    def _children(self, element: Element, parts: tuple[Part, ...]) -> dict[str, Any]:
        known = {word: part for part in parts for word in part.words}
        found: dict[str, list[Any]] = {part.name: [] for part in known.values()}
        if element.stray:
            self.say(
                element.line, element.tag, f"holds the text {element.stray[:40]!r}; values are written as attributes"
            )
        count: Counter[str] = Counter()
        for inner in element.children:
            part = known.get(inner.tag)
            if part is None:
                words = ", ".join(f"<{word}>" for word in known) or "none"
                meant = did_you_mean(inner.tag, known)
                self.say(inner.line, inner.tag, f"is no element of <{element.tag}>{meant}; it takes {words}")
                continue
            count[part.name] += 1
            if count[part.name] > part.at_most:
                often = "twice; one is allowed" if part.at_most == 1 else f"more than {part.at_most} times"
                self.say(inner.line, inner.tag, f"stands in <{element.tag}> {often}")
                continue
            made = self._child(part, inner)
            if made is None:
                self.broken.add(inner.tag)
            else:
                found[part.name].append(made)
        gathered = {part.name: self._gathered(part, found[part.name]) for part in known.values()}
        return {name: value for name, value in gathered.items() if value is not None}

    def _gathered(self, part: Part, made: list[Any]) -> Any:
        """Return the value of a field of which these child elements could be read, None when there is none."""
        if part.role != "children":
            return made[0] if made else None
        if part.into is None:
            return tuple(made) if made or not part.required else None
        problems = list(part.into.problems(made))
        for k, sentence in problems:
            self.say(self.lines[id(made[k])], self.words[id(made[k])], sentence)
        return part.into.gathered(made) if made and not problems else None

    def _child(self, part: Part, inner: Element) -> Any:
        if part.plug is None:
            return self.element(part.elements[inner.tag], inner)[0]
        for deeper in inner.children:
            self.say(deeper.line, deeper.tag, f"is no element of <{inner.tag}>; it takes none")
        if inner.stray:
            self.say(inner.line, inner.tag, f"holds the text {inner.stray[:40]!r}; values are written as attributes")
        return self._plug(part.plug, inner, dict(inner.attributes), [])

    def _plug(self, what: Plug, element: Element, attributes: dict[str, str], also: list[str]) -> Any:
        """Return the part that ``type`` names, made of the attributes; None when that is impossible."""
        room, contract = what.places()
        name = attributes.pop("type", None)
        if name is None:
            known = ", ".join(plug.built_in(room, contract))
            self.say(element.line, element.tag, f"needs the attribute 'type': {known} or an address")
            return None
        try:
            cls = plug.find(name, room, contract, folder=self.folder, trust=self.trust)
        except InputError as error:
            self.say(element.line, element.tag, str(error))
            return None
        draws = {key: text for key, text in attributes.items() if what.drawn and is_drawn(text)}
        fixed = {key: text for key, text in attributes.items() if key not in draws}
        problems = plug.problems(cls, fixed, also)
        made, more = _made(cls, {key: text for key, text in fixed.items() if _fits(cls, key, text)})
        problems += more
        if made is not None and draws:
            made, more = _drawn(made, draws)
            problems += more
        for problem in problems:
            self.say(element.line, element.tag, problem)
        return None if problems else made


def _fits(cls: type, key: str, text: str) -> bool:
    """Whether a class has an attribute that takes this text."""
    return all(sentence.startswith("needs the attribute") for sentence in plug.problems(cls, {key: text}))


def _made(cls: type, attributes: dict[str, str]) -> tuple[Any, list[str]]:
    """Return what the attributes make, None when it needs others; and what is wrong with each that has to be left out.

    What a class says of its values it says one at a time. So an attribute without which the same is not said again
    is the one that it is about; it is left out, and the others are judged.
    """
    if plug.problems(cls, attributes):
        return None, []
    said: list[str] = []
    while True:
        made, sentence = _tried(cls, attributes)
        if not sentence:
            return made, said
        said.append(sentence)
        needed = {name.replace("_", "-") for name in plug.needs(cls)}
        fewer = [
            {key: text for key, text in attributes.items() if key != left}
            for left in attributes
            if left.replace("_", "-") not in needed
        ]
        right = next((rest for rest in fewer if _tried(cls, rest)[1] != sentence), None)
        if right is None:
            return None, said
        attributes = right


def _tried(cls: type, attributes: dict[str, str]) -> tuple[Any, str]:
    try:
        return plug.read(cls, attributes), ""
    except InputError as error:
        return None, str(error)


def _drawn(model: Any, draws: dict[str, str]) -> tuple[Any, list[str]]:
    """Return a model some of whose parameters are distributions, or why they cannot be."""
    found, problems = {}, []
    for key, text in draws.items():
        try:
            found[key.replace("-", "_")] = Distribution.parse(text)
        except InputError as error:
            problems.append(f"{key[:40]}={shown(text)} {error}")
    problems += Drawn.problems(model, found)
    return (None, problems) if problems else (Drawn(model, tuple(found.items())), [])


def _converted(text: str, kind: Any) -> Any:
    if hasattr(kind, "parse"):
        return kind.parse(text)
    if kind is str:
        return text
    if kind is bool:
        if text.strip() in ("true", "false"):
            return text.strip() == "true"
        raise InputError("must be true or false")
    value = number(text)
    if kind is int:
        if value != int(value) or abs(value) > 2**53:
            raise InputError("must be a whole number")
        return int(value)
    return value


def _kind(part: Part) -> str:
    if part.role == "attribute":
        unit = f" [{part.rule.unit}]" if part.rule and part.rule.unit else ""
        return f"the attribute {part.word!r}: {part.about}{unit}"
    if part.role == "mounted":
        return "the attribute 'type'"
    return f"the element {' or '.join(f'<{word}>' for word in part.words)}: {part.about}"
