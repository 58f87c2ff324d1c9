"""Evaluation of texts with ``${expressions}`` and ``$(substitutions)``."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any, Protocol

from crowdbot.core import InputError, did_you_mean, parse_yaml

from .evaluation import TOKENIZE, Budget, evaluate
from .expression import parse_expression, split_text
from .scope import Scope

MOST_TEXT = 100_000
MOST_DEPTH = 20
MOST_YAML_BYTES = 1_000_000


class FileSource(Protocol):
    """Finds the files of a robot; nothing outside its folders is found."""

    def find(self, reference: str, beside: Path | None = None) -> Path | None:
        """Return the file of ``package://NAME/PATH`` or of a path relative to ``beside``, or None if it is missing."""

    def lack(self, reference: str) -> str:
        """Return why a file that was not found is missing and what to do; empty if nothing more is known."""


class Texts:
    """Values of texts.

    Args:
        files: files that may be read.
        arguments: values of ``$(arg NAME)``; defaults of ``<xacro:arg>`` are added.
        environment: values of ``$(env NAME)`` and ``$(optenv NAME DEFAULT)``; nothing else of the environment is read.
        budget: limit of steps.

    Attributes:
        file: the file that is being expanded; relative names are beside it.
        constants: name space ``xacro`` of expressions.
    """

    def __init__(
        self, files: FileSource, arguments: Mapping[str, str], environment: Mapping[str, str], budget: Budget
    ) -> None:
        self.files, self.environment, self.budget = files, dict(environment), budget
        self.arguments: dict[str, Any] = dict(arguments)
        self.file: Path | None = None
        self._depth = 0
        self._yaml: dict[Path, Any] = {}
        self._trees: dict[str, Any] = {}
        tools = {"load_yaml": self.load_yaml, "abs_filename": self.path, "arg": self.argument, "dotify": dict}
        tools |= {"fatal": _fail, "message": _skip, "warning": _skip, "error": _skip}
        self._local: dict[str, Any] = {"xacro": tools | TOKENIZE}
        self._local |= {"load_yaml": self.load_yaml}
        self._substitutions = {
            "arg": self.argument,
            "env": self.variable,
            "optenv": self.variable,
            "find": self.package,
        }

    def value(self, text: str, scope: Scope) -> Any:
        """Return the value of a text: typed if it is one expression, otherwise a string.

        Raises:
            InputError: an expression is wrong, or a limit is exceeded.
        """
        if "$" not in text:
            return text
        self._depth += 1
        if self._depth > MOST_DEPTH:
            self._depth = 0
            raise InputError(f"expressions are nested more than {MOST_DEPTH} levels deep")
        try:
            values = [self._part(part.kind, part.text, scope) for part in split_text(text)]
        finally:
            self._depth = max(0, self._depth - 1)
        if len(values) == 1:
            return values[0]
        joined = "".join(_shown(value) for value in values)
        if len(joined) > MOST_TEXT:
            raise InputError(f"a text is longer than {MOST_TEXT} characters after the expansion")
        self.budget.spend(len(joined) // 64)
        return joined

    def text(self, text: str, scope: Scope) -> str:
        """Return the value of a text as a string."""
        return _shown(self.value(text, scope))

    def _part(self, kind: str, text: str, scope: Scope) -> Any:
        self.budget.spend()
        if kind == "text":
            return text
        if kind == "call" and text.split(None, 1)[:1] == ["eval"]:
            return self._evaluated(text.split(None, 1)[1] if " " in text.strip() else "", scope, self._arguments())
        inner = self.text(text, scope)
        return self._evaluated(inner, scope, {}) if kind == "expression" else self.substitution(inner)

    def _arguments(self) -> dict[str, Any]:
        from .scope import literal

        return {name: literal(value) for name, value in self.arguments.items()} | self._substitutions

    def _evaluated(self, text: str, scope: Scope, local: Mapping[str, Any]) -> Any:
        if text not in self._trees:
            self._trees[text] = parse_expression(text)
        return evaluate(self._trees[text], scope, self.budget, {**self._local, **local})

    def substitution(self, text: str) -> Any:
        """Return the value of the inside of ``$(...)``.

        Raises:
            InputError: it is unknown, or has no value.
        """
        words = text.split()
        name, rest = (words[0], words[1:]) if words else ("", [])
        if name == "find" and len(rest) == 1:
            return self.package(rest[0])
        if name == "arg" and len(rest) == 1:
            return self.argument(rest[0])
        if name == "env" and len(rest) == 1:
            return self.variable(rest[0])
        if name == "optenv" and rest:
            return self.variable(rest[0], " ".join(rest[1:]))
        if name == "dirname" and self.file is not None:
            return str(self.file.parent)
        if name == "anon" and len(rest) == 1:
            return rest[0]
        known = ("find NAME", "arg NAME", "env NAME", "optenv NAME DEFAULT", "eval EXPRESSION", "dirname")
        raise InputError(f"$({text[:60]}) is not supported; use $({'), $('.join(known)})")

    def argument(self, name: str) -> Any:
        """Return the value of an argument."""
        if name not in self.arguments:
            raise InputError(
                f"the argument {name[:60]!r} has no value{did_you_mean(name, self.arguments)}; give --arg {name}:=VALUE"
            )
        return self.arguments[name]

    def variable(self, name: str, default: str | None = None) -> str:
        """Return the value of an environment variable from the given ones; the environment itself is not read."""
        result = self.environment.get(name, default)
        if result is None:
            raise InputError(
                f"$(env {name[:60]}) has no value, since the environment is not read; give --env {name}=VALUE"
            )
        return result

    def package(self, name: str) -> str:
        """Return the address of a package."""
        return f"package://{name}"

    def path(self, name: str) -> str:
        """Return a file name relative to the current file as a path."""
        return name if self.file is None or "://" in name else str(self.file.parent / name)

    def find(self, name: str) -> Path | None:
        """Return a file beside the current one or in a package, or None."""
        return self.files.find(name, None if self.file is None else self.file.parent)

    def load_yaml(self, name: str) -> Any:
        """Return the content of a YAML file.

        Raises:
            InputError: the file is missing, too large, outside the folders, or not supported.
        """
        path = self.find(str(name))
        if path is None:
            raise InputError(f"the YAML file {str(name)[:200]!r} is missing")
        if path not in self._yaml:
            if path.stat().st_size > MOST_YAML_BYTES:
                raise InputError(f"{path} is larger than {MOST_YAML_BYTES} bytes, the maximum of a YAML file")
            self._yaml[path] = parse_yaml(path.read_text(encoding="utf-8", errors="replace"), str(path))
            self.budget.spend(path.stat().st_size // 16)
        return self._yaml[path]


def _shown(value: Any) -> str:
    return value if isinstance(value, str) else str(value)


def _fail(*words: Any) -> None:
    raise InputError(" ".join(str(word)[:200] for word in words))


def _skip(*_: Any) -> str:
    return ""
