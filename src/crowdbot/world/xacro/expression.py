"""Parser of xacro expressions: a small part of Python's syntax, turned into a tree.

Nothing is evaluated as Python. The tree consists of tuples whose first item names the operation.
"""

from __future__ import annotations

import re
from typing import Any, NamedTuple

from crowdbot.core import InputError

MOST_CHARACTERS = 4000
"""Maximum length of one expression."""
PATTERN = re.compile(
    r"\s*(?:(?P<number>(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d{1,4})?)"
    r"|(?P<text>'[^']*'|\"[^\"]*\")"
    r"|(?P<name>[A-Za-z_]\w*)"
    r"|(?P<sign>\*\*|//|<=|>=|==|!=|[-+*/%<>()\[\]{},.:=]))",
    re.ASCII,
)


class Token(NamedTuple):
    """A token: its kind (``number``, ``text``, ``name``, ``sign``, ``end``) and its characters."""

    kind: str
    text: str


class TextPart(NamedTuple):
    """A part of a text: plain ``text``, the inside of ``${...}`` (``expression``) or of ``$(...)`` (``call``)."""

    kind: str
    text: str


def tokens(text: str) -> list[Token]:
    """Return the tokens of an expression, with an ``end`` token.

    Raises:
        InputError: the text is too long or has a character that no expression contains.

    >>> [token.text for token in tokens("a + 2.5")]
    ['a', '+', '2.5', '']
    """
    if len(text) > MOST_CHARACTERS:
        raise InputError(f"an expression has {len(text)} characters, at most {MOST_CHARACTERS} are allowed")
    found: list[Token] = []
    place, text = 0, text.rstrip()
    while place < len(text):
        match = PATTERN.match(text, place)
        if match is None or match.lastgroup is None:
            raise InputError(f"the expression {_cut(text)} has an unexpected {text[place:].lstrip()[:1]!r}")
        found.append(Token(match.lastgroup, match.group(match.lastgroup)))
        place = match.end()
    return [*found, Token("end", "")]


def split_text(text: str) -> list[TextPart]:
    """Return the parts of a text; ``$${`` and ``$$(`` stand for ``${`` and ``$(``.

    Raises:
        InputError: a bracket is not closed.

    >>> [tuple(part) for part in split_text("x${1 + 2}$(arg a)")]
    [('text', 'x'), ('expression', '1 + 2'), ('call', 'arg a')]
    """
    parts: list[TextPart] = []
    plain, place = "", 0
    while place < len(text):
        two = text[place : place + 2]
        if two in ("${", "$("):
            end = _closing(text, place + 1)
            parts += [TextPart("text", plain)] if plain else []
            parts.append(TextPart("expression" if two == "${" else "call", text[place + 2 : end]))
            plain, place = "", end + 1
        elif two == "$$" and re.match(r"\$+[{(]", text[place:]):
            run = re.match(r"\$+[{(]", text[place:])
            assert run is not None
            plain, place = plain + run.group()[1:], place + run.end()
        else:
            plain, place = plain + text[place], place + 1
    return [*parts, TextPart("text", plain)] if plain or not parts else parts


def _closing(text: str, opening: int) -> int:
    """Return the index of the bracket that closes the one at ``opening``, outside of quotes."""
    pair = {"{": "}", "(": ")"}
    first, last, depth, quote = text[opening], pair[text[opening]], 0, ""
    for k in range(opening, len(text)):
        letter = text[k]
        if quote:
            quote = "" if letter == quote else quote
        elif letter in "'\"" and letter in text[k + 1 :]:
            quote = letter
        elif letter == first:
            depth += 1
        elif letter == last:
            depth -= 1
            if depth == 0:
                return k
    raise InputError(f"{_cut(text[opening - 1 :])} has no closing {last!r}")


def _cut(text: str) -> str:
    return repr(text if len(text) <= 80 else text[:77] + "...")


Tree = tuple[Any, ...]
MOST_DEPTH = 40
"""Maximum nesting of one expression."""
BINARY = (("+", "-"), ("*", "/", "//", "%"))
CONSTANTS = {"True": True, "False": False, "None": None, "true": True, "false": False}
RESERVED = ("and", "or", "not", "in", "is", "if", "else", "for", "lambda")


def parse_expression(text: str) -> Tree:
    """Return the tree of an expression.

    Supported are numbers, strings, names, lists, tuples, dictionaries, calls with keywords, indices and slices,
    attributes, list comprehensions, arithmetic, comparisons, ``and``, ``or``, ``not`` and ``a if condition else b``.

    Raises:
        InputError: the text is not such an expression.

    >>> parse_expression("1 + a")
    ('binary', '+', ('value', 1), ('name', 'a'))
    """
    parser = _Parser(text)
    tree = parser.whole()
    if parser.now.kind != "end":
        parser.refuse()
    return tree


class _Parser:
    """Recursive descent over the tokens."""

    def __init__(self, text: str) -> None:
        self.text, self.tokens = text.strip(), tokens(text)
        self.place, self.depth = 0, 0

    @property
    def now(self) -> Token:
        return self.tokens[self.place]

    def refuse(self, wanted: str = "") -> None:
        """Raise an error at the current token."""
        shown = self.text if len(self.text) <= 80 else self.text[:77] + "..."
        found = repr(self.now.text) if self.now.text else "its end"
        raise InputError(f"the expression {shown!r} is not understood at {found}{wanted}")

    def accept(self, *texts: str) -> str:
        """Return the current token and advance if it is one of these signs or words; otherwise return ''."""
        if self.now.kind in ("sign", "name") and self.now.text in texts:
            self.place += 1
            return self.tokens[self.place - 1].text
        return ""

    def expect(self, text: str) -> None:
        if not self.accept(text):
            self.refuse(f"; {text!r} is expected")

    def whole(self) -> Tree:
        """Return an expression or a tuple without brackets."""
        first = self.conditional()
        if self.now.text != "," or self.now.kind != "sign":
            return first
        rows = [first]
        while self.accept(","):
            if self.now.kind == "end":
                break
            rows.append(self.conditional())
        return ("tuple", *rows)

    def conditional(self) -> Tree:
        self.depth += 1
        if self.depth > MOST_DEPTH:
            raise InputError(f"an expression is nested more than {MOST_DEPTH} levels deep")
        tree = self.either()
        if self.accept("if"):
            condition = self.either()
            self.expect("else")
            tree = ("if", condition, tree, self.conditional())
        self.depth -= 1
        return tree

    def either(self) -> Tree:
        tree = self.both()
        while self.accept("or"):
            tree = ("or", tree, self.both())
        return tree

    def both(self) -> Tree:
        tree = self.negation()
        while self.accept("and"):
            tree = ("and", tree, self.negation())
        return tree

    def negation(self) -> Tree:
        count = 0
        while self.accept("not"):
            count += 1
        tree = self.comparison()
        for _ in range(min(count, 2 + count % 2)):
            tree = ("not", tree)
        return tree

    def comparison(self) -> Tree:
        first = self.binary(0)
        pairs: list[tuple[str, Tree]] = []
        while True:
            sign = self.accept("<", ">", "<=", ">=", "==", "!=", "in", "is")
            if sign == "is" and self.accept("not"):
                sign = "is not"
            elif not sign and self.now.text == "not" and self.tokens[self.place + 1].text == "in":
                self.place += 2
                sign = "not in"
            if not sign:
                return ("compare", first, *pairs) if pairs else first
            pairs.append((sign, self.binary(0)))

    def binary(self, level: int) -> Tree:
        if level == len(BINARY):
            return self.sign()
        tree = self.binary(level + 1)
        while self.now.kind == "sign" and (sign := self.accept(*BINARY[level])):
            tree = ("binary", sign, tree, self.binary(level + 1))
        return tree

    def sign(self) -> Tree:
        signs = []
        while self.now.kind == "sign" and (sign := self.accept("-", "+")):
            signs.append(sign)
        if len(signs) > MOST_DEPTH:
            raise InputError(f"an expression has more than {MOST_DEPTH} signs in a row")
        tree = self.power()
        for sign in reversed(signs):
            tree = ("sign", sign, tree)
        return tree

    def power(self) -> Tree:
        base = self.postfix()
        if self.accept("**"):
            self.depth += 1
            if self.depth > MOST_DEPTH:
                raise InputError(f"an expression is nested more than {MOST_DEPTH} levels deep")
            base = ("binary", "**", base, self.sign())
            self.depth -= 1
        return base

    def postfix(self) -> Tree:
        found, count = self.atom(), 0
        while self.now.kind == "sign" and (sign := self.accept("(", "[", ".")):
            count += 1
            if count > MOST_DEPTH:
                raise InputError(f"an expression has more than {MOST_DEPTH} calls and indices in a row")
            if sign == "(":
                found = self.call(found)
            elif sign == "[":
                found = ("index", found, self.subscript())
                self.expect("]")
            else:
                if self.now.kind != "name" or self.now.text.startswith("_"):
                    self.refuse("; a name is expected after '.'")
                found = ("attribute", found, self.now.text)
                self.place += 1
        return found

    def call(self, function: Tree) -> Tree:
        rows: list[Tree] = []
        named: list[tuple[str, Tree]] = []
        while not self.accept(")"):
            if rows or named:
                self.expect(",")
                if self.accept(")"):
                    break
            if self.now.kind == "name" and self.tokens[self.place + 1].text == "=":
                name = self.now.text
                self.place += 2
                named.append((name, self.conditional()))
            else:
                rows.append(self.conditional())
        return ("call", function, tuple(rows), tuple(named))

    def subscript(self) -> Tree:
        parts: list[Tree | None] = [None]
        while self.now.text != "]" or self.now.kind != "sign":
            if self.accept(":"):
                parts.append(None)
                if len(parts) > 3:
                    self.refuse()
            elif parts[-1] is None:
                parts[-1] = self.conditional()
            else:
                self.refuse("; ']' is expected")
        if len(parts) > 1:
            return ("slice", *parts)
        if parts[0] is None:
            self.refuse("; an index is expected")
        return parts[0] or ()

    def atom(self) -> Tree:
        token = self.now
        self.place += token.kind != "end"
        if token.kind == "number":
            return ("value", _number(token.text))
        if token.kind == "text":
            text = token.text[1:-1]
            while self.now.kind == "text":  # 'a' 'b' is 'ab'
                text += self.now.text[1:-1]
                self.place += 1
            return ("value", text)
        if token.kind == "name" and token.text not in RESERVED:
            if token.text.startswith("__"):
                raise InputError(f"the name {token.text[:40]!r} is not allowed; names do not begin with '__'")
            return ("value", CONSTANTS[token.text]) if token.text in CONSTANTS else ("name", token.text)
        if token.kind == "sign" and token.text in ("(", "[", "{"):
            return {"(": self.brackets, "[": self.row, "{": self.table}[token.text]()
        self.place -= token.kind != "end"
        self.refuse()
        return ()

    def brackets(self) -> Tree:
        if self.accept(")"):
            return ("tuple",)
        rows, single = [self.conditional()], True
        while self.accept(","):
            single = False
            if self.now.text == ")":
                break
            rows.append(self.conditional())
        self.expect(")")
        return rows[0] if single else ("tuple", *rows)

    def row(self) -> Tree:
        rows: list[Tree] = []
        while not self.accept("]"):
            if rows and self.accept("for"):
                return self.comprehension(rows)
            if rows:
                self.expect(",")
                if self.accept("]"):
                    break
            rows.append(self.conditional())
        return ("list", *rows)

    def comprehension(self, rows: list[Tree]) -> Tree:
        if len(rows) != 1 or self.now.kind != "name" or self.now.text in RESERVED:
            self.refuse()
        name = self.now.text
        self.place += 1
        self.expect("in")
        source = self.either()
        condition = self.either() if self.accept("if") else None
        self.expect("]")
        return ("each", rows[0], name, source, condition)

    def table(self) -> Tree:
        rows: list[tuple[Tree, Tree]] = []
        while not self.accept("}"):
            if rows:
                self.expect(",")
                if self.accept("}"):
                    break
            key = self.conditional()
            self.expect(":")
            rows.append((key, self.conditional()))
        return ("dict", *rows)


def _number(text: str) -> int | float:
    if text.isdigit():
        if len(text) > 300:
            raise InputError(f"the number {text[:20]}... has too many digits")
        return int(text)
    return float(text)
