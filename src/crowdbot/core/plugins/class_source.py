"""Class descriptions from source code, which is parsed with ``ast`` and never run.

They are used to check files from untrusted sources. A described class has the fields, literal defaults, class
attributes and built-in base classes of the class in the file. Its methods raise :class:`UnreadableValue`.
"""

from __future__ import annotations

import ast
import contextlib
import dataclasses
import importlib
import inspect
import types
import typing
from collections.abc import Callable, Iterator
from contextvars import ContextVar
from pathlib import Path
from typing import Any, NoReturn

from crowdbot.core.errors import InputError

MOST_BYTES = 1_000_000
FIELD_MAKERS = ("parameter", "per_agent")
_READS_ONLY: ContextVar[bool] = ContextVar("crowdbot_reads_only", default=False)


class UnreadableValue(Exception):
    """A value that cannot be determined without running code."""


class UnreadText(float):
    """Text of a value whose type cannot be determined without running code; as a number it is NaN."""

    text: str

    @classmethod
    def parse(cls, text: str) -> UnreadText:
        """Keep the text."""
        made = cls("nan")
        made.text = text
        return made

    def __str__(self) -> str:
        """Return the text."""
        return self.text

    def __eq__(self, other: object) -> bool:
        """Return whether the texts are equal."""
        return isinstance(other, UnreadText) and other.text == self.text

    def __hash__(self) -> int:
        """Return the hash of the text."""
        return hash(self.text)


UNREAD = UnreadText.parse("")


@contextlib.contextmanager
def without_running_code() -> Iterator[None]:
    """Within this context, :func:`find_class` describes classes of Python files instead of running the files.

    >>> with without_running_code():
    ...     reads_only()
    True
    """
    token = _READS_ONLY.set(True)
    try:
        yield
    finally:
        _READS_ONLY.reset(token)


def reads_only() -> bool:
    """Return whether classes of Python files are described instead of loaded."""
    return _READS_ONLY.get()


def unread_fields(cls: type) -> frozenset[str]:
    """Return the fields of a described class whose defaults cannot be determined without running code."""
    return frozenset(getattr(cls, "_unread_fields", ()))


def class_file(cls: type) -> Path | None:
    """Return the file of a described class, None for any other class."""
    return getattr(cls, "_described_file", None)


def describe_class(path: Path, name: str, contract: type, address: str) -> type:
    """Return a class with the fields of a class in a Python file, without running the file.

    Args:
        path: Python file.
        name: name of the class.
        contract: required base class.
        address: address for messages, such as ``shy.py:Shy``.

    Raises:
        InputError: the file is not valid Python, or has no concrete class with this name and base class.
    """
    try:
        with path.open("rb") as stream:
            data = stream.read(MOST_BYTES + 1)
        if len(data) > MOST_BYTES:
            raise InputError(f"{path} is larger than {MOST_BYTES} bytes")
        tree = ast.parse(data, path.name)
    except OSError as error:
        raise InputError(f"{path} cannot be read: {error.strerror}") from None
    except (SyntaxError, ValueError, RecursionError, MemoryError) as error:
        raise InputError(f"{path} cannot be loaded: {type(error).__name__}: {error}") from None
    source = _Source(path, tree)
    result = source.described(name, contract, 0) if name in source.classes else None
    if result is None or inspect.isabstract(result) or not issubclass(result, contract):
        raise InputError(
            f"{address} is not a concrete {contract.__name__}; {path.name} defines"
            f" {', '.join(source.classes) or 'none'}"
        )
    return result


class _Source:
    """The classes, imports and constants of a Python file."""

    def __init__(self, path: Path, tree: ast.Module) -> None:
        self.path = path
        self.classes = {node.name: node for node in tree.body if isinstance(node, ast.ClassDef)}
        self.names: dict[str, Any] = {"float": float, "int": int, "bool": bool, "str": str}
        for node in tree.body:
            if isinstance(node, ast.Import | ast.ImportFrom):
                self._import(node)
            elif isinstance(node, ast.Assign | ast.AnnAssign):
                self.names |= dict(self._assignments(node))

    def _import(self, node: ast.Import | ast.ImportFrom) -> None:
        for name in node.names:
            if isinstance(node, ast.Import):
                where = name.name if name.asname else name.name.partition(".")[0]
                if (module := _module(where)) is not None and _module(name.name) is not None:
                    self.names[name.asname or where] = module
            elif node.level == 0 and node.module and (module := _module(node.module)) is not None:
                value = getattr(module, name.name, None) or _module(f"{node.module}.{name.name}")
                if value is not None:
                    self.names[name.asname or name.name] = value

    def _assignments(self, node: ast.Assign | ast.AnnAssign) -> Iterator[tuple[str, Any]]:
        targets = node.targets if isinstance(node, ast.Assign) else [node.target]
        with contextlib.suppress(UnreadableValue):
            value = UNREAD if node.value is None else self.value(node.value)
            yield from ((target.id, value) for target in targets if isinstance(target, ast.Name))

    def value(self, node: ast.expr) -> Any:
        """Return the value of an expression of literals, constants and classes of crowdbot.

        Raises:
            UnreadableValue: it is any other expression.
        """
        try:
            return ast.literal_eval(node)
        except (ValueError, TypeError, SyntaxError, MemoryError, RecursionError):
            pass
        if isinstance(node, ast.Name) and node.id in self.names:
            return self.names[node.id]
        if isinstance(node, ast.Attribute) and isinstance(owner := self.value(node.value), types.ModuleType):
            if not node.attr.startswith("_") and hasattr(owner, node.attr):
                return getattr(owner, node.attr)
        elif isinstance(node, ast.BinOp) and type(node.op) in _OPERATORS:
            left, right = self.value(node.left), self.value(node.right)
            if all(type(item) in (int, float) and abs(item) < 1e12 for item in (left, right)):
                with contextlib.suppress(ArithmeticError):
                    return _OPERATORS[type(node.op)](left, right)
        elif isinstance(node, ast.Call) and all(word.arg for word in node.keywords):
            maker = self.value(node.func)
            if _is_safe(maker):
                given = {str(word.arg): self.value(word.value) for word in node.keywords}
                return maker(*[self.value(argument) for argument in node.args], **given)
        raise UnreadableValue(ast.unparse(node)[:60])

    def described(self, name: str, contract: type, depth: int) -> type | None:
        """Return the description of a class, or None if it does not extend the contract."""
        node = self.classes[name]
        bases = tuple(base for item in node.bases if (base := self._base(item, contract, depth)) is not None)
        if not any(issubclass(base, contract) for base in bases):
            return None
        space: dict[str, Any] = {"__module__": f"crowdbot_source_{self.path.stem}", "_described_file": self.path}
        rows: list[tuple[str, Any, Any]] = []
        unread = {field for base in bases for field in unread_fields(base)}
        own = any("dataclass" in ast.dump(item) for item in node.decorator_list)
        for inner in node.body:
            if isinstance(inner, ast.FunctionDef | ast.AsyncFunctionDef):
                space[inner.name] = _placeholder(inner)
            elif isinstance(inner, ast.Assign):
                space |= dict(self._assignments(inner))
            elif isinstance(inner, ast.AnnAssign) and isinstance(inner.target, ast.Name):
                if not own or "ClassVar" in ast.dump(inner.annotation):
                    space |= dict(self._assignments(inner)) if inner.value is not None else {}
                elif (row := self._field(inner, inner.target.id)) is not None:
                    rows.append(row)
                    unread -= {row[0]}
                    unread |= {row[0]} if getattr(row[2], "default", None) is UNREAD else set()
        space["_unread_fields"] = frozenset(unread)
        frozen = [base.__dataclass_params__.frozen for base in bases if dataclasses.is_dataclass(base)]  # type: ignore[attr-defined]
        try:
            return dataclasses.make_dataclass(
                name, rows, bases=bases, namespace=space, kw_only=True, frozen=all(frozen)
            )
        except (TypeError, ValueError) as error:
            raise InputError(f"{self.path} cannot be loaded: {type(error).__name__}: {error}") from None

    def _base(self, node: ast.expr, contract: type, depth: int) -> type | None:
        if isinstance(node, ast.Name) and node.id in self.classes and depth < 20:
            return self.described(node.id, contract, depth + 1)
        with contextlib.suppress(UnreadableValue):
            base = self.value(node)
            return base if inspect.isclass(base) and base.__module__.startswith("crowdbot.") else None
        return None

    def _field(self, node: ast.AnnAssign, name: str) -> tuple[str, Any, Any] | None:
        """Return the name, the type and the ``dataclasses.Field`` of an attribute, or None if it is not a field."""
        kind = self._kind(node.annotation)
        if node.value is None:
            return name, kind, dataclasses.field()
        if isinstance(node.value, ast.Call) and _function_name(node.value) == "field":
            words = {word.arg: word.value for word in node.value.keywords}
            if isinstance(off := words.get("init"), ast.Constant) and off.value is False:
                return None
            if "default" in words:
                return name, kind, dataclasses.field(default=self._default(words["default"]))
            return name, kind, dataclasses.field(default=UNREAD) if "default_factory" in words else dataclasses.field()
        made = self._default(node.value)
        return name, kind, made if isinstance(made, dataclasses.Field) else dataclasses.field(default=made)

    def _default(self, node: ast.expr) -> Any:
        try:
            value = self.value(node)
        except UnreadableValue:
            return UNREAD
        return UNREAD if isinstance(value, list | dict | set) else value

    def _kind(self, node: ast.expr) -> Any:
        """Return the type of an annotation, or :class:`UnreadText` if it cannot be determined without running code."""
        if isinstance(node, ast.Constant) and isinstance(node.value, str):
            try:
                return self._kind(ast.parse(node.value, mode="eval").body)
            except (SyntaxError, ValueError, RecursionError):
                return UnreadText
        if isinstance(node, ast.BinOp) and isinstance(node.op, ast.BitOr):
            left, right = self._kind(node.left), self._kind(node.right)
            return left if right is type(None) else right if left is type(None) else left | right
        if isinstance(node, ast.Subscript):
            with contextlib.suppress(UnreadableValue):
                if self.value(node.value) is typing.Optional:
                    return self._kind(node.slice)
            return tuple[float, ...] if ast.unparse(node).lower().startswith("tuple[float") else UnreadText
        if isinstance(node, ast.Constant) and node.value is None:
            return type(None)
        with contextlib.suppress(UnreadableValue):
            kind = self.value(node)
            if kind in (float, int, bool, str) or hasattr(kind, "parse") or isinstance(kind, types.UnionType):
                return kind
        return UnreadText


def _module(name: str) -> types.ModuleType | None:
    """Return a module of crowdbot, or ``math``, ``typing``, ``dataclasses``; None for any other."""
    safe = name in ("crowdbot", "math", "typing", "dataclasses") or name.startswith("crowdbot.")
    if not safe or any(part.startswith("_") for part in name.split(".")):
        return None
    try:
        return importlib.import_module(name)
    except ImportError:
        return None


def _is_safe(maker: Any) -> bool:
    """Return whether a call only makes a value: a dataclass of crowdbot, or the field of a parameter."""
    inside = getattr(maker, "__module__", "").startswith("crowdbot.")
    return inside and (dataclasses.is_dataclass(maker) or getattr(maker, "__name__", "") in FIELD_MAKERS)


def _function_name(node: ast.Call) -> str:
    return node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")


def _placeholder(node: ast.FunctionDef | ast.AsyncFunctionDef) -> Any:
    """Return a method that raises :class:`UnreadableValue`, with the parameter names of the method in the file."""
    if node.name == "__post_init__":
        return lambda self: None

    def unread(*args: Any, **more: Any) -> NoReturn:
        raise UnreadableValue(node.name)

    names = dict.fromkeys(argument.arg for argument in (*node.args.posonlyargs, *node.args.args, *node.args.kwonlyargs))
    rows = [inspect.Parameter(name, inspect.Parameter.POSITIONAL_OR_KEYWORD) for name in names]
    unread.__signature__ = inspect.Signature(rows)  # type: ignore[attr-defined]
    marks = ast.unparse(ast.Tuple([*node.decorator_list]))
    if "property" in marks:
        return property(unread)
    wrap: Callable[[Any], Any] = staticmethod if "staticmethod" in marks else (lambda one: one)
    return classmethod(unread) if "classmethod" in marks else wrap(unread)


_OPERATORS: dict[type, Callable[[Any, Any], Any]] = {
    ast.Add: lambda a, b: a + b,
    ast.Sub: lambda a, b: a - b,
    ast.Mult: lambda a, b: a * b,
    ast.Div: lambda a, b: a / b,
}
