"""Page: the content of a screen as text for a console and as sanitised HTML for a browser."""

from __future__ import annotations

import hashlib
import html
import re
from dataclasses import dataclass
from html.parser import HTMLParser
from pathlib import Path

from crowdbot.core import InputError

from .experiment import Screen

MOST_BYTES = 200_000
MOST_DEPTH = 100
KINDS = (".txt", ".html", ".htm")
PICTURES = (".png", ".jpg", ".jpeg", ".gif", ".webp")
KEPT = frozenset(
    re.findall(
        r"\w+",
        "h1 h2 h3 h4 h5 h6 p br hr ul ol li b strong i em u sub sup small blockquote pre code div span"
        " table caption thead tbody tr td th dl dt dd",
    )
)
"""Allowed elements, which only format text."""
VOID = frozenset(("br", "hr"))
DROPPED = frozenset(
    re.findall(r"\w+", "script style head title iframe object embed template noscript svg math select textarea")
)
"""Elements whose content is removed."""
LINES = KEPT - frozenset(re.findall(r"\w+", "b strong i em u sub sup small code span td th"))
CONTROL = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u200e\u200f\u202a-\u202e\u2066-\u2069\ud800-\udfff]")
"""Control characters of terminals and text directions."""


@dataclass(frozen=True)
class Page:
    """Content of a screen.

    Fields:
        text: text for a console.
        html: HTML for a browser, with text formatting only and pictures from the folder of the experiment.
        digest: hash of the source.
    """

    text: str
    html: str
    digest: str


def page_of(screen: Screen, folder: Path | None) -> Page:
    """Return the content of a screen.

    Args:
        screen: screen with a text or a file.
        folder: folder of the experiment (default: the working directory).

    Raises:
        InputError: the file is missing, outside the folder, too large, or not UTF-8 text.

    >>> page_of(Screen(name="welcome", text="a < b"), None).html
    '<p>a &lt; b</p>'
    """
    if not screen.file:
        data, plain = screen.text.encode(), True
    else:
        data, plain = _bytes(screen.file, folder), screen.file.lower().endswith(".txt")
    try:
        source = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise InputError(f"file={screen.file!r} is not UTF-8 at byte {error.start}; save it in UTF-8") from None
    digest = hashlib.blake2b(data, digest_size=16).hexdigest()
    if not plain:
        return Page(*sanitise_html(source), digest)
    text = CONTROL.sub("", source.replace("\r\n", "\n")).strip()
    paragraphs = [html.escape(part).replace("\n", "<br>") for part in re.split(r"\n\s*\n", text) if part]
    return Page(text, "".join(f"<p>{part}</p>" for part in paragraphs), digest)


def _bytes(name: str, folder: Path | None) -> bytes:
    if not name.lower().endswith(KINDS):
        raise InputError(f"file={name!r} must end in {', '.join(KINDS)}")
    root = (folder or Path.cwd()).resolve()
    try:
        path = (root / name).resolve()
        if not path.is_relative_to(root):
            raise InputError(f"file={name!r} is outside the folder of the experiment; move it into the folder")
        if not path.is_file():
            raise InputError(f"file={name!r} does not exist in the folder of the experiment")
        with path.open("rb") as stream:
            data = stream.read(MOST_BYTES + 1)
    except (OSError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"file={name!r} cannot be read: {getattr(error, 'strerror', None) or error}") from None
    if len(data) > MOST_BYTES:
        raise InputError(f"file={name!r} is larger than {MOST_BYTES} bytes, the maximum")
    return data


def sanitise_html(source: str) -> tuple[str, str]:
    """Return the plain text of an HTML source and its HTML reduced to text formatting.

    Scripts, styles, links, forms, event handlers and all attributes are removed. Pictures are kept if their source is a
    plain file name.

    >>> sanitise_html("<h1 onclick='x()'>Hi</h1><script>x()</script><p>a &amp; <b>b</p>")
    ('Hi\\n\\na & b', '<h1>Hi</h1><p>a &amp; <b>b</b></p>')
    """
    sieve = _Sieve()
    sieve.feed(source)
    sieve.close()
    return sieve.result()


class _Sieve(HTMLParser):
    """HTML sanitiser: the output consists only of allowed elements and escaped text."""

    def __init__(self) -> None:
        super().__init__(convert_charrefs=True)
        self.open: list[str] = []
        self.dropped: list[str] = []
        self.out: list[str] = []
        self.words: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        if self.dropped or tag in DROPPED:
            if tag in DROPPED and tag != "embed" and len(self.dropped) < MOST_DEPTH:
                self.dropped.append(tag)
            return
        if tag == "img":
            self._picture(dict(attrs))
        elif tag in KEPT and len(self.open) < MOST_DEPTH:
            self.out.append(f"<{tag}>")
            self._shape(tag)
            if tag not in VOID:
                self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.handle_starttag(tag, attrs)
        if tag not in VOID:
            self.handle_endtag(tag)

    def handle_endtag(self, tag: str) -> None:
        if self.dropped:
            if tag in self.dropped:
                del self.dropped[self.dropped.index(tag) :]
        elif tag in self.open:
            self._close(len(self.open) - 1 - self.open[::-1].index(tag))

    def handle_data(self, data: str) -> None:
        if self.dropped:
            return
        data = CONTROL.sub("", data)
        self.out.append(html.escape(data))
        self.words.append(data if "pre" in self.open else re.sub(r"\s+", " ", data))

    def result(self) -> tuple[str, str]:
        """Return the text and the HTML."""
        self._close(0)
        lines = [line.rstrip(" \t") for line in "".join(self.words).split("\n")]
        lines = [line[1:] if line[:1] == " " and line[1:2] not in ("", " ") else line for line in lines]
        return re.sub(r"\n{3,}", "\n\n", "\n".join(lines)).strip(), "".join(self.out).strip()

    def _close(self, depth: int) -> None:
        while len(self.open) > depth:
            tag = self.open.pop()
            self.out.append(f"</{tag}>")
            if tag in LINES:
                self.words.append("" if tag == "li" else "\n" if tag in ("tr", "dt", "dd", "div") else "\n\n")
            elif tag in ("td", "th"):
                self.words.append("  ")

    def _shape(self, tag: str) -> None:
        if tag == "li":
            self.words.append("\n- ")
        elif tag == "hr":
            self.words.append("\n----\n")
        elif tag in LINES:
            self.words.append("\n")

    def _picture(self, given: dict[str, str | None]) -> None:
        source, words = given.get("src") or "", CONTROL.sub("", given.get("alt") or "")
        if re.fullmatch(r"[A-Za-z0-9_][A-Za-z0-9_. -]*", source) and source.lower().endswith(PICTURES):
            self.out.append(f'<img src="{html.escape(source)}" alt="{html.escape(words)}">')
            self.words.append(f"[picture: {words or source}]")
