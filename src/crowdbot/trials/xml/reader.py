"""From XML to a trial: every problem at once, each with its file and line.

The reader knows no element by name. It walks over the outline of the dataclasses, so that a new element is a new
dataclass and nothing more.
"""

from __future__ import annotations

import dataclasses
from collections import Counter
from pathlib import Path
from typing import Any

from crowdbot.core import (
    Element,
    InputError,
    TrialError,
    attribute_names,
    attribute_problems,
    builtin_classes,
    did_you_mean,
    find_class,
    from_attributes,
    nearest_name,
    parse_number,
    required_fields,
    unread_fields,
)
from crowdbot.trials.distribution import Distribution
from crowdbot.trials.fields import FieldSpec, PluginSpec, outline, quote_value
from crowdbot.trials.partial_element import EVERYTHING, begin_partial, is_partial, make_partial, readable
from crowdbot.trials.randomized_model import RandomizedModel, is_drawn

__all__ = ["ROOT", "XmlReader"]

MOST_PROBLEMS = 100
ROOT = "trial"


class XmlReader:
    """Makes a tree of frozen dataclasses of XML elements, and collects every problem meanwhile.

    A misspelt name is read as the nearest known name, and an element with a problem becomes a partial one, so that one
    problem hides no other.

    Args:
        place: name of the file for messages.
        folder: where code and files that the tree names lie.
        trust: whether they may lie elsewhere.
        seed: places people with it; None is that of the trial.

    Attributes:
        made: everything that was made, partial elements included.
        lines, words: line and tag of it, by its ``id``.
    """

    def __init__(self, place: str, folder: Path, trust: bool, seed: int | None = None) -> None:
        self.place, self.folder, self.trust, self.seed = place, folder, trust, seed
        self.found: list[tuple[int, str, str]] = []
        self.lines: dict[int, int] = {}
        self.words: dict[int, str] = {}
        self.made: list[Any] = []

    def say(self, line: int, tag: str, sentence: str) -> None:
        """Add a problem of an element."""
        self.found.append((line, tag[:40], sentence))

    def finish(self) -> None:
        """Raise when anything was said."""
        rows = sorted(self.found, key=lambda row: row[0])
        sentences = [f"{self.place}:{line}: <{tag}> {sentence}" for line, tag, sentence in rows]
        if len(sentences) > MOST_PROBLEMS:
            more = len(sentences) - MOST_PROBLEMS
            sentences = [*sentences[:MOST_PROBLEMS], f"{self.place}: and {more} more problems"]
        if sentences:
            raise TrialError(*sentences)

    def element(self, cls: type, element: Element) -> Any:
        """Return the object of an element, a partial one if the element or one in it has a problem."""
        before = len(self.found)
        parts = outline(cls)
        kind = self._names(element, parts)
        values = self._attributes(element, parts, kind)
        values |= self._children(element, parts)
        lost = set()
        for part in parts:
            if part.name in values:
                continue
            if not self._tried(element, part) and not part.required:
                values[part.name] = part.default
                continue
            lost.add(part.name)
            if not self._tried(element, part):
                self.say(element.line, element.tag, f"needs {_kind(part)}")
        values |= self._files(cls)
        if hasattr(cls, "mistakes"):
            for names, sentence in cls.mistakes(values):
                self.say(element.line, element.tag, sentence)
                lost |= set(names)
        return self._made(cls, element, values, lost, self.found[before:])

    def _files(self, cls: type) -> dict[str, Any]:
        """Return where the files lie that an element names, as fields of it."""
        named = any(field.name == "trust" for field in dataclasses.fields(cls))
        return {"folder": self.folder, "trust": self.trust} if named else {}

    def _made(self, cls: type, element: Element, values: dict[str, Any], lost: set[str], said: list[Any]) -> Any:
        made = None
        if not said:
            try:
                made = cls(**values)
            except InputError as error:
                self.say(element.line, element.tag, str(error))
        if made is None:
            made = make_partial(cls, values, lost)
            sentence = begin_partial(made)
            if said and sentence and all(sentence != known for _, _, known in said):
                self.say(element.line, element.tag, sentence)
            lost |= {p.name for p in outline(cls) if not p.optional and (0, None) in readable([made], p.name)}
        self.lines[id(made)] = element.line
        self.words[id(made)] = element.tag
        self.made.append(made)  # keeps it alive, so that its id stays its own
        return made

    def _tried(self, element: Element, part: FieldSpec) -> bool:
        """Whether the field was given, however wrong; that was said already."""
        if part.role == "attribute":
            return any(key.replace("_", "-") == part.word for key in element.attributes)
        if part.role == "mounted":
            return True
        return any(inner.tag in part.words for inner in element.children)

    def _names(self, element: Element, parts: tuple[FieldSpec, ...]) -> type | None:
        """Bring misspelt attributes to what they mean; return the class of what the element mounts, if it is known."""
        own = [part.word for part in parts if part.role == "attribute"]
        mount = next((part.plug for part in parts if part.role == "mounted"), None)
        kind = self._type(mount, element) if mount else None
        if not mount or kind:
            self._meant(element, [*(attribute_names(kind) if kind else ()), *own], ["type"] if mount else [])
        return kind

    def _meant(self, element: Element, known: list[str], also: list[str]) -> None:
        """Say which attributes are unknown, and read them as those that were meant."""
        given = {key.replace("_", "-") for key in element.attributes}
        for key in [key for key in element.attributes if key.replace("_", "-") not in (*known, *also)]:
            takes = ", ".join(known) or "none"
            meant = did_you_mean(key, known)
            self.say(element.line, element.tag, f"has no attribute {key[:40]!r}{meant}; it takes {takes}")
            text = element.attributes.pop(key)
            if meant and nearest_name(key, known) not in given:
                element.attributes[nearest_name(key, known)] = text
                given.add(nearest_name(key, known))

    def _attributes(self, element: Element, parts: tuple[FieldSpec, ...], kind: type | None) -> dict[str, Any]:
        own = {part.word: part for part in parts if part.role == "attribute"}
        values: dict[str, Any] = {}
        rest: dict[str, str] = {}
        for key, text in element.attributes.items():
            part = own.get(key.replace("_", "-"))
            if part is None:
                rest[key] = text
                continue
            if part.name in values:
                self.say(element.line, element.tag, f"has the attribute {part.word} twice")
            value = None
            try:
                value = _converted(text, part.kind)
                wrong = part.wrong(value)
            except InputError as error:
                wrong = str(error)
            if wrong:
                self.say(element.line, element.tag, f"{part.word}={quote_value(text)} {wrong}")
            if not wrong or (part.word == "name" and value is not None):  # a wrong name is still what others say
                values[part.name] = value
        mount = next((part for part in parts if part.role == "mounted"), None)
        if mount is not None and mount.plug is not None:
            values[mount.name] = self._plug(mount.plug, kind, element, rest)
        return values

    def _children(self, element: Element, parts: tuple[FieldSpec, ...]) -> dict[str, Any]:
        known = {word: part for part in parts for word in part.words}
        found: dict[str, list[Any]] = {part.name: [] for part in known.values()}
        self._stray(element)
        count: Counter[str] = Counter()
        for inner in element.children:
            if inner.tag not in known:
                words = ", ".join(f"<{word}>" for word in known) or "none"
                meant = did_you_mean(inner.tag, known)
                self.say(inner.line, inner.tag, f"is no element of <{element.tag}>{meant}; it takes {words}")
                if not meant:
                    continue
                inner.tag = nearest_name(inner.tag, known)
                if not (inner.attributes or inner.children):
                    continue
            part = known[inner.tag]
            count[part.name] += 1
            if count[part.name] > part.max:
                often = "twice; one is allowed" if part.max == 1 else f"more than {part.max} times"
                self.say(inner.line, inner.tag, f"stands in <{element.tag}> {often}")
                continue
            found[part.name].append(self._child(part, inner))
        gathered = {part.name: self._gather(part, found[part.name]) for part in known.values()}
        return {name: value for name, value in gathered.items() if value is not None}

    def _stray(self, element: Element) -> None:
        if element.stray:
            self.say(
                element.line, element.tag, f"holds the text {element.stray[:40]!r}; values are written as attributes"
            )

    def _gather(self, part: FieldSpec, made: list[Any]) -> Any:
        """Return the value of a field of which these are the child elements, None when there is none."""
        if part.role != "children":
            return made[0] if made else None
        if part.into is None:
            return tuple(made) if made or not part.required else None
        problems = list(part.into.problems(made))
        for k, sentence in problems:
            self.say(self.lines[id(made[k])], self.words[id(made[k])], sentence)
        right = made and not problems and not any(is_partial(one) for one in made)
        return part.into.gather(made) if right else None

    def _child(self, part: FieldSpec, inner: Element) -> Any:
        if part.plug is None:
            return self.element(part.elements[inner.tag], inner)
        for deeper in inner.children:
            self.say(deeper.line, deeper.tag, f"is no element of <{inner.tag}>; it takes none")
        self._stray(inner)
        kind = self._type(part.plug, inner)
        if kind is not None:
            self._meant(inner, attribute_names(kind), ["type"])
        return self._plug(part.plug, kind, inner, dict(inner.attributes))

    def _type(self, what: PluginSpec, element: Element) -> type | None:
        """Return the class that ``type`` names, or means most likely; None when nobody knows."""
        room, contract = what.places()
        known = builtin_classes(room, contract)
        name = element.attributes.get("type")
        if name is None:
            self.say(element.line, element.tag, f"needs the attribute 'type': {', '.join(known)} or an address")
            return None
        try:
            return find_class(name, room, contract, folder=self.folder, trust=self.trust)
        except InputError as error:
            self.say(element.line, element.tag, str(error))
            return known.get(nearest_name(name, known))

    def _plug(self, what: PluginSpec, cls: type | None, element: Element, attributes: dict[str, str]) -> Any:
        """Return the plugin that the attributes make, a partial one if they make none."""
        if cls is None:
            return make_partial(what.places()[1], {}, EVERYTHING)
        texts = {key: text for key, text in attributes.items() if key != "type"}
        draws = {key: text for key, text in texts.items() if what.drawn and is_drawn(text)}
        fixed = {key: text for key, text in texts.items() if key not in draws}
        wrong = attribute_problems(cls, fixed)
        made, more = _made(cls, {key: text for key, text in fixed.items() if key not in wrong})
        wrong |= more
        if made is not None and draws:
            drawn, more = _drawn(made, draws)
            wrong |= more
            made = made if wrong else drawn
        for sentence in wrong.values():
            self.say(element.line, element.tag, sentence)
        if not wrong and made is not None:
            unread = {name for name in unread_fields(cls) if name.replace("_", "-") not in texts and name not in texts}
            return made if not unread else make_partial(cls, vars(made), unread)
        lost = {key.replace("-", "_") for key in wrong}
        values = {} if made is None else {field.name: getattr(made, field.name) for field in dataclasses.fields(cls)}
        lost |= {field.name for field in dataclasses.fields(cls) if field.name not in values}
        return make_partial(cls, values, lost, whole=made)


def _made(cls: type, attributes: dict[str, str]) -> tuple[Any, dict[str, str]]:
    """Return what the attributes make, None when it needs others; and what is wrong with each that has to be left out.

    What a class says of its values it says one at a time. So an attribute without which the same is not said again
    is the one that it is about; it is left out, and the others are judged.
    """
    if attribute_problems(cls, attributes):
        return None, {}
    said: dict[str, str] = {}
    while True:
        made, sentence = _tried(cls, attributes)
        if not sentence:
            return made, said
        needed = {name.replace("_", "-") for name in required_fields(cls)}
        for left in attributes:
            fewer = {key: text for key, text in attributes.items() if key != left}
            if left.replace("_", "-") not in needed and _tried(cls, fewer)[1] != sentence:
                break
        else:
            return None, said | {"": sentence}
        said[left], attributes = sentence, fewer


def _tried(cls: type, attributes: dict[str, str]) -> tuple[Any, str]:
    try:
        return from_attributes(cls, attributes), ""
    except InputError as error:
        return None, str(error)


def _drawn(model: Any, draws: dict[str, str]) -> tuple[Any, dict[str, str]]:
    """Return a model some of whose parameters are distributions, or why they cannot be."""
    found, wrong = {}, {}
    for key, text in draws.items():
        try:
            one = Distribution.parse(text)
            found[key.replace("-", "_")] = one
            if sentences := [*RandomizedModel.problems(model, {key.replace("-", "_"): one})]:
                wrong[key] = sentences[0]
        except InputError as error:
            wrong[key] = f"{key[:40]}={quote_value(text)} {error}"
    return (None, wrong) if wrong else (RandomizedModel(model, tuple(found.items())), {})


def _converted(text: str, kind: Any) -> Any:
    if hasattr(kind, "parse"):
        return kind.parse(text)
    if kind is str:
        return text
    if kind is bool:
        if text.strip() in ("true", "false"):
            return text.strip() == "true"
        raise InputError("must be true or false")
    value = parse_number(text)
    if kind is int:
        if value != int(value) or abs(value) > 2**53:
            raise InputError("must be a whole number")
        return int(value)
    return value


def _kind(part: FieldSpec) -> str:
    if part.role == "attribute":
        unit = f" [{part.rule.unit}]" if part.rule and part.rule.unit else ""
        return f"the attribute {part.word!r}: {part.about}{unit}"
    if part.role == "mounted":
        return "the attribute 'type'"
    return f"the element {' or '.join(f'<{word}>' for word in part.words)}: {part.about}"
