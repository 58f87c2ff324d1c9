"""Reader: from XML to frozen dataclasses, with every problem and its line.

The reader knows no element by name: it follows the outline of the dataclasses, so a new element only needs a new
dataclass.
"""

from __future__ import annotations

import dataclasses
from collections import Counter
from collections.abc import Collection
from pathlib import Path
from typing import Any

from crowdbot.core import (
    Element,
    InputError,
    attribute_names,
    attribute_problems,
    builtin_classes,
    did_you_mean,
    find_class,
    from_attributes,
    nearest_name,
    parse_number,
    required_fields,
)
from crowdbot.trials.distribution import Distribution
from crowdbot.trials.fields import FieldSpec, PluginSpec, outline, quote_value
from crowdbot.trials.notation import unit_hint
from crowdbot.trials.partial_element import PartialElement, is_partial, post_init_problem, readable
from crowdbot.trials.randomized_model import RandomizedModel, is_drawn

from .reader_result import ReaderResult

ROOT = "trial"


class XmlReader:
    """Reads a tree of XML elements as frozen dataclasses, and collects every problem.

    A misspelt name is read as the nearest known name. An element with a problem is read as a
    :class:`~crowdbot.trials.partial_element.PartialElement`, so no problem hides another.

    Args:
        place: name of the file for messages.
        folder: folder of the code and files that the tree names.
        trust: whether they may lie outside the folder, or the only values of ``type`` that may name one that does.
    """

    def __init__(self, place: str, folder: Path, trust: bool | Collection[str]) -> None:
        self.place, self.folder, self.trust = place, folder, trust
        self._result = ReaderResult(place, Element(ROOT))

    def read(self, cls: type, root: Element) -> ReaderResult:
        """Return the object of the root element, the objects of all elements, and every problem."""
        self._result = ReaderResult(self.place, root)
        self._result.value = self._element(cls, root)
        return self._result

    def _report(self, element: Element, sentence: str) -> None:
        self._result.add_problem(element, sentence)

    def _element(self, cls: type, element: Element) -> Any:
        """Return the object of an element, a partial one if the element or one in it has a problem."""
        before = len(self._result.problems)
        parts = outline(cls)
        kind = self._check_names(element, parts)
        values = self._attributes(element, parts, kind)
        values |= self._children(element, parts)
        unreadable = set()
        for part in parts:
            if part.name in values:
                continue
            if not _is_present(element, part) and not part.required:
                values[part.name] = part.default
                continue
            unreadable.add(part.name)
            if not _is_present(element, part):
                self._report(element, f"needs {_describe(part)}")
        values |= self._files(cls, element)
        if hasattr(cls, "mistakes"):
            for names, sentence in cls.mistakes(values):
                self._report(element, sentence)
                unreadable |= set(names)
        made = self._build(cls, element, values, unreadable, before)
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

    def _build(self, cls: type, element: Element, values: dict[str, Any], unreadable: set[str], before: int) -> Any:
        """Return the object of an element; a partial one if there are more problems than ``before``, or one now."""
        known = [problem.sentence for problem in self._result.problems[before:]]
        if not known:
            try:
                return cls(**values)
            except InputError as error:
                self._report(element, str(error))
        made = PartialElement(cls, values, unreadable)
        sentence = post_init_problem(made)
        if known and sentence and sentence not in known:
            self._report(element, sentence)
        made.mark_unreadable({p.name for p in outline(cls) if not p.optional and (0, None) in readable([made], p.name)})
        return made

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
            value = None
            try:
                value = _convert(text, part.kind)
                wrong = part.wrong(value)
            except InputError as error:
                wrong = f"{error}{unit_hint(text, part.unit) if part.kind is not str else ''}"
            if wrong:
                self._report(element, f"{part.word}={quote_value(text)} {wrong}")
            if not wrong or (part.word == "name" and value is not None):  # other elements may refer to a wrong name
                values[part.name] = value
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
        problems = list(part.into.problems(made))
        for k, sentence in problems:
            self._result.report(made[k], sentence)
        right = made and not problems and not any(is_partial(one) for one in made)
        return part.into.gather(made) if right else None

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
        """Return the plugin with these attributes, a partial one if there is a problem."""
        if cls is None:
            return PartialElement(what.places()[1], {}, None)
        texts = {key: text for key, text in attributes.items() if key != "type"}
        draws = {key: text for key, text in texts.items() if what.drawn and is_drawn(text)}
        fixed = {key: text for key, text in texts.items() if key not in draws}
        wrong = attribute_problems(cls, fixed)
        made, more = _build_plugin(cls, {key: text for key, text in fixed.items() if key not in wrong})
        wrong |= more
        if made is not None and draws:
            randomized, more = _randomize(made, draws)
            wrong |= more
            made = made if wrong else randomized
        for sentence in wrong.values():
            self._report(element, sentence)
        if not wrong and made is not None:
            return made
        unreadable = {key.replace("-", "_") for key in wrong}
        values = {} if made is None else {field.name: getattr(made, field.name) for field in dataclasses.fields(cls)}
        unreadable |= {field.name for field in dataclasses.fields(cls) if field.name not in values}
        return PartialElement(cls, values, unreadable, default=made)


def _is_present(element: Element, part: FieldSpec) -> bool:
    """Return whether an element has the attribute or child of a field, even a wrong one."""
    if part.role == "attribute":
        return any(key.replace("_", "-") == part.word for key in element.attributes)
    if part.role == "mounted":
        return True
    return any(inner.tag in part.words for inner in element.children)


def _build_plugin(cls: type, attributes: dict[str, str]) -> tuple[Any, dict[str, str]]:
    """Return the plugin with these attributes, None if it needs others, and a problem for each attribute left out.

    A class reports one problem at a time. The attribute without which the same problem is not reported again is the
    cause: it is left out, and the others are checked.
    """
    if attribute_problems(cls, attributes):
        return None, {}
    problems: dict[str, str] = {}
    while True:
        made, sentence = _from_attributes(cls, attributes)
        if not sentence:
            return made, problems
        needed = {name.replace("_", "-") for name in required_fields(cls)}
        for cause in attributes:
            fewer = {key: text for key, text in attributes.items() if key != cause}
            if cause.replace("_", "-") not in needed and _from_attributes(cls, fewer)[1] != sentence:
                break
        else:
            return None, problems | {"": sentence}
        problems[cause], attributes = sentence, fewer


def _from_attributes(cls: type, attributes: dict[str, str]) -> tuple[Any, str]:
    """Return the plugin with these attributes, or None and the problem."""
    try:
        return from_attributes(cls, attributes), ""
    except InputError as error:
        return None, str(error)


def _randomize(model: Any, draws: dict[str, str]) -> tuple[Any, dict[str, str]]:
    """Return a model with distributions for some of its parameters, or None and a problem for each parameter."""
    distributions, wrong = {}, {}
    for key, text in draws.items():
        try:
            one = Distribution.parse(text)
            distributions[key.replace("-", "_")] = one
            if sentences := [*RandomizedModel.problems(model, {key.replace("-", "_"): one})]:
                wrong[key] = sentences[0]
        except InputError as error:
            wrong[key] = f"{key[:40]}={quote_value(text)} {error}"
    return (None, wrong) if wrong else (RandomizedModel(model, tuple(distributions.items())), {})


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
