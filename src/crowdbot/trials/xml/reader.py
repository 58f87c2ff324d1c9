"""Reader: from XML to frozen dataclasses, with every problem and its line.

The reader knows no element by name: it follows the outline of the dataclasses, so a new element only needs a new
dataclass.
"""

from __future__ import annotations

import dataclasses
from collections import Counter
from collections.abc import Collection
from pathlib import Path
from typing import Any, NamedTuple

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
)
from crowdbot.core.fields import FieldSpec, PluginSpec, outline, quote_value, unit_hint
from crowdbot.trials.distribution import Distribution
from crowdbot.trials.randomized_model import RandomizedModel, is_drawn

MOST_PROBLEMS = 100


class ReaderProblem(NamedTuple):
    """A problem of an XML element: its line, its tag, and the end of a sentence about it."""

    line: int
    tag: str
    sentence: str


class ReaderResult:
    """The object that was read from an XML file, and every problem that was found.

    Args:
        place: name of the file for messages.
        root: root of the XML tree; problems of unknown elements are reported there.

    Attributes:
        value: the object of the root element, None if there is a problem in it.
        problems: of the elements, in the order in which they were found.
    """

    def __init__(self, place: str, root: Element) -> None:
        self.place, self.root = place, root
        self.value: Any = None
        self.problems: list[ReaderProblem] = []
        self._sources: dict[int, tuple[Any, Element]] = {}

    def add_element(self, made: Any, source: Element) -> None:
        """Add the object that was made of an XML element."""
        self._sources[id(made)] = (made, source)  # keeps the object alive, so its id stays unique

    def add_problem(self, source: Element, sentence: str) -> None:
        """Add a problem of an XML element."""
        self.problems.append(ReaderProblem(source.line, source.tag[:40], sentence))

    def report(self, made: Any, sentence: str) -> None:
        """Add a problem of an object."""
        self.add_problem(self._sources.get(id(made), (None, self.root))[1], sentence)

    @property
    def sentences(self) -> list[str]:
        """A sentence for every problem, without the line."""
        return [f"<{problem.tag}> {problem.sentence}" for problem in self.problems]

    def raise_problems(self) -> None:
        """Raise :class:`TrialError` with every problem in the order of the lines; return if there is none."""
        rows = sorted(self.problems, key=lambda row: row.line)
        sentences = [f"{self.place}:{line}: <{tag}> {sentence}" for line, tag, sentence in rows]
        if len(sentences) > MOST_PROBLEMS:
            more = len(sentences) - MOST_PROBLEMS
            sentences = [*sentences[:MOST_PROBLEMS], f"{self.place}: and {more} more problems"]
        if sentences:
            raise TrialError(*sentences)


ROOT = "trial"


class XmlReader:
    """Reads a tree of XML elements as frozen dataclasses, and collects the problems of all their values.

    A misspelt name is read as the nearest known name, so that it is one problem. An element is made if it and those in
    it have no problem; what elements mean together is checked afterwards.

    Args:
        place: name of the file for messages.
        folder: folder of the code and files that the tree names.
        trust: whether they may lie outside the folder, or the only values of ``type`` that may name one that does.
    """

    def __init__(self, place: str, folder: Path, trust: bool | Collection[str]) -> None:
        self.place, self.folder, self.trust = place, folder, trust
        self._result = ReaderResult(place, Element(ROOT))

    def read(self, cls: type, root: Element) -> ReaderResult:
        """Return the object of the root element, None if there is a problem, and every problem."""
        self._result = ReaderResult(self.place, root)
        self._result.value = self._element(cls, root)
        return self._result

    def _report(self, element: Element, sentence: str) -> None:
        self._result.add_problem(element, sentence)

    def _element(self, cls: type, element: Element) -> Any:
        """Return the object of an element, None if the element or one in it has a problem."""
        before = len(self._result.problems)
        parts = outline(cls)
        kind = self._check_names(element, parts)
        values = self._attributes(element, parts, kind) | self._children(element, parts)
        for part in parts:
            if part.name in values or _is_present(element, part):
                continue
            if part.required:
                self._report(element, f"needs {_describe(part)}")
            values[part.name] = part.default
        if len(self._result.problems) > before:
            return None
        try:
            made = cls(**values, **self._files(cls, element))
        except InputError as error:
            self._report(element, str(error).removeprefix(f"{cls.__name__}: "))
            return None
        self._result.add_element(made, element)
        return made

    def _files(self, cls: type, element: Element) -> dict[str, Any]:
        """Return the fields of an element that say where its files are."""
        if not any(field.name == "trust" for field in dataclasses.fields(cls)):
            return {}
        # with a plugin, ``type`` names the code of the plugin, and the files of the element are other attributes
        own = any(part.role == "attribute" and part.word == "type" for part in outline(cls))
        return {"folder": self.folder, "trust": self._trusts(element.attributes.get("type", "") if own else "")}

    def _trusts(self, name: str) -> bool:
        """Return whether a value of ``type`` may name code or a folder outside of the folder of the trial."""
        return self.trust if isinstance(self.trust, bool) else name in self.trust

    def _check_names(self, element: Element, parts: tuple[FieldSpec, ...]) -> type | None:
        """Correct misspelt attributes; return the class of the plugin in the element, None if unknown."""
        own = [part.word for part in parts if part.role == "attribute"]
        mount = next((part.plug for part in parts if part.role == "mounted"), None)
        kind = self._type(mount, element) if mount else None
        if not mount or kind:
            self._correct(element, [*(attribute_names(kind) if kind else ()), *own], ["type"] if mount else [])
        return kind

    def _correct(self, element: Element, known: list[str], also: list[str]) -> None:
        """Report unknown attributes, and rename those with a similar known name."""
        given = {key.replace("_", "-") for key in element.attributes}
        for key in [key for key in element.attributes if key.replace("_", "-") not in (*known, *also)]:
            takes = ", ".join(known) or "none"
            meant = did_you_mean(key, known)
            self._report(element, f"has no attribute {key[:40]!r}{meant}; it takes {takes}")
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
                self._report(element, f"has the attribute {part.word} twice")
            try:
                values[part.name] = _convert(text, part.kind)
                wrong = part.wrong(values[part.name])
            except InputError as error:
                wrong = f"{error}{unit_hint(text, part.unit) if part.kind is not str else ''}"
            if wrong:
                self._report(element, f"{part.word}={quote_value(text)} {wrong}")
        mount = next((part for part in parts if part.role == "mounted"), None)
        if mount is not None and mount.plug is not None:
            values[mount.name] = self._plug(mount.plug, kind, element, rest)
        return values

    def _children(self, element: Element, parts: tuple[FieldSpec, ...]) -> dict[str, Any]:
        known = {word: part for part in parts for word in part.words}
        found: dict[str, list[Any]] = {part.name: [] for part in known.values()}
        self._check_text(element)
        count: Counter[str] = Counter()
        for inner in element.children:
            if inner.tag not in known:
                words = ", ".join(f"<{word}>" for word in known) or "none"
                meant = did_you_mean(inner.tag, known)
                self._report(inner, f"is not an element of <{element.tag}>{meant}; it takes {words}")
                if not meant:
                    continue
                inner.tag = nearest_name(inner.tag, known)
                if not (inner.attributes or inner.children):
                    continue
            part = known[inner.tag]
            count[part.name] += 1
            if count[part.name] > part.max:
                often = "twice; one is allowed" if part.max == 1 else f"more than {part.max} times"
                self._report(inner, f"occurs in <{element.tag}> {often}")
                continue
            found[part.name].append(self._child(part, inner))
        gathered = {part.name: self._gather(part, found[part.name]) for part in known.values()}
        return {name: value for name, value in gathered.items() if value is not None}

    def _check_text(self, element: Element) -> None:
        if element.stray:
            self._report(element, f"contains the text {element.stray[:40]!r}; values are written as attributes")

    def _gather(self, part: FieldSpec, made: list[Any]) -> Any:
        """Return the value of a field with these child elements, None if there are none."""
        if part.role != "children":
            return made[0] if made else None
        if part.into is None:
            return tuple(made) if made or not part.required else None
        if not made or any(item is None for item in made):
            return None
        problems = list(part.into.problems(made))
        for k, sentence in problems:
            self._result.report(made[k], sentence)
        return None if problems else part.into.gather(made)

    def _child(self, part: FieldSpec, inner: Element) -> Any:
        if part.plug is None:
            return self._element(part.elements[inner.tag], inner)
        for deeper in inner.children:
            self._report(deeper, f"is not an element of <{inner.tag}>; it takes none")
        self._check_text(inner)
        kind = self._type(part.plug, inner)
        if kind is not None:
            self._correct(inner, attribute_names(kind), ["type"])
        return self._plug(part.plug, kind, inner, dict(inner.attributes))

    def _type(self, what: PluginSpec, element: Element) -> type | None:
        """Return the class of ``type`` or of the most similar name, None if there is none."""
        room, contract = what.places()
        known = builtin_classes(room, contract)
        name = element.attributes.get("type")
        if name is None:
            self._report(element, f"needs the attribute 'type': {', '.join(known)} or an address")
            return None
        try:
            return find_class(name, room, contract, folder=self.folder, trust=self._trusts(name))
        except InputError as error:
            self._report(element, str(error))
            return known.get(nearest_name(name, known))

    def _plug(self, what: PluginSpec, cls: type | None, element: Element, attributes: dict[str, str]) -> Any:
        """Return the plugin with these attributes, None if there is a problem."""
        if cls is None:
            return None
        texts = {key: text for key, text in attributes.items() if key != "type"}
        draws = {key: text for key, text in texts.items() if what.drawn and is_drawn(text)}
        fixed = {key: text for key, text in texts.items() if key not in draws}
        made, wrong = None, [*attribute_problems(cls, fixed).values()]
        if not wrong:
            try:
                made = from_attributes(cls, fixed)
            except InputError as error:
                wrong = [str(error)]
        if made is not None and draws:
            made, wrong = _randomize(made, draws)
        for sentence in wrong:
            self._report(element, sentence)
        return made


def _is_present(element: Element, part: FieldSpec) -> bool:
    """Return whether an element has the attribute or child of a field, even a wrong one."""
    if part.role == "attribute":
        return any(key.replace("_", "-") == part.word for key in element.attributes)
    if part.role == "mounted":
        return True
    return any(inner.tag in part.words for inner in element.children)


def _randomize(model: Any, draws: dict[str, str]) -> tuple[Any, list[str]]:
    """Return a model with distributions for some of its parameters, or None and a problem for each parameter."""
    distributions: dict[str, Distribution] = {}
    wrong: list[str] = []
    for key, text in draws.items():
        try:
            one = {key.replace("-", "_"): Distribution.parse(text)}
        except InputError as error:
            wrong.append(f"{key[:40]}={quote_value(text)} {error}")
            continue
        wrong += [*RandomizedModel.problems(model, one)][:1]
        distributions |= one
    return (None, wrong) if wrong else (RandomizedModel(model, tuple(distributions.items())), [])


def _convert(text: str, kind: Any) -> Any:
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


def _describe(part: FieldSpec) -> str:
    if part.role == "attribute":
        unit = f" [{part.rule.unit}]" if part.rule and part.rule.unit else ""
        return f"the attribute {part.word!r}: {part.about}{unit}"
    if part.role == "mounted":
        return "the attribute 'type'"
    return f"the element {' or '.join(f'<{word}>' for word in part.words)}: {part.about}"
