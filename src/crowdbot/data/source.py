"""Source: an input file with its first bytes, its text and its numeric columns."""

from __future__ import annotations

import codecs
import contextlib
import gzip
import re
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError, InputError

MAX_BYTES = 2 * 1024**3
"""Largest file [bytes]."""
MAX_UNPACKED = 512 * 1024**2
"""Largest text in a gzip file [bytes]."""
MAX_ROWS = 20_000_000
"""Largest number of rows of a table, compressed or not."""
MOST_FILES = 100_000
"""Largest number of files of a folder."""
HEAD = 64 * 1024
DIGITS = re.compile(r"(\d+)")
GZIP = b"\x1f\x8b"
WIDE = (
    (codecs.BOM_UTF32_LE, "utf-32"), (codecs.BOM_UTF32_BE, "utf-32"), (codecs.BOM_UTF16_LE, "utf-16"),
    (codecs.BOM_UTF16_BE, "utf-16"),
)  # fmt: skip
"""Byte order marks of texts that spreadsheets write; that of UTF-32 begins with that of UTF-16."""

MAGIC = {
    b"\x89HDF\r\n\x1a\n": "hdf5",
    b"SQLite format 3\x00": "sqlite",
    b"PAR1": "parquet",
    b"\x89MCAP0\r\n": "mcap",
    b"PK\x03\x04": "zip",
    b"#ROSBAG V": "rosbag",
}


@dataclass(frozen=True)
class Source:
    """An existing, non-empty file of at most 2 GiB; a text may be packed by gzip."""

    path: Path
    head: bytes
    packed: bool = False
    """Whether the file is gzip of a text; ``head`` and :meth:`text` are unpacked."""

    @classmethod
    def of(cls, path: Path) -> Source:
        """Open a file and read its first bytes.

        Raises:
            DataError: it is missing, a folder, empty, larger than 2 GiB, or cannot be read.
        """
        if path.is_dir():
            raise DataError(f"{path} is a folder, not a file; name one file in it")
        try:
            size = path.stat().st_size
            if size > MAX_BYTES:
                raise DataError(f"{path} has {size} bytes, more than the limit of {MAX_BYTES}; split it in time")
            with path.open("rb") as file:
                head = file.read(HEAD)
        except FileNotFoundError:
            raise DataError(f"there is no file {path}") from None
        except (OSError, ValueError) as error:
            raise DataError(f"{path} cannot be read: {error}") from None
        packed = head.startswith(GZIP)
        if packed:
            head = _unpack(path, HEAD)
        head = _as_utf8(head)
        if not head.strip():
            raise DataError(f"{path} is empty")
        source = cls(path, head, packed)
        if packed and source.kind != "text":
            raise DataError(f"{path} is gzip of {source.kind}; only texts are read from gzip, unpack it first")
        return source

    @property
    def name(self) -> str:
        """The path as the user wrote it, for messages."""
        return str(self.path)

    @cached_property
    def kind(self) -> str:
        """``hdf5``, ``sqlite``, ``parquet``, ``mcap``, ``rosbag``, ``zip``, ``text`` or ``binary``."""
        for magic, kind in MAGIC.items():
            if self.head.startswith(magic):
                return kind
        control = np.frombuffer(self.head, np.uint8)
        strange = (control < 32) & ~np.isin(control, (9, 10, 12, 13))
        return "binary" if np.any(strange) else "text"

    @cached_property
    def lines(self) -> list[str]:
        """The first non-blank lines of a text, without an incomplete last line."""
        if self.kind != "text":
            return []
        text = _decode(self.head)
        lines = text.splitlines()
        if len(self.head) == HEAD and len(lines) > 1:
            lines = lines[:-1]
        return [line for line in lines if line.strip()]

    @cached_property
    def rows(self) -> list[list[str]]:
        """The first lines that are not comments, split at white space and commas."""
        return [_split(line) for line in self.lines if not line.lstrip().startswith("#")][:50]

    def numeric(self, columns: int) -> bool:
        """Return whether the first rows have this many columns and all of them are numbers."""
        return bool(self.rows) and all(len(row) == columns and all(map(_is_number, row)) for row in self.rows)

    def text(self) -> str:
        """Return the whole text."""
        data = _unpack(self.path, MAX_UNPACKED + 1) if self.packed else self.path.read_bytes()
        if self.packed and len(data) > MAX_UNPACKED:
            raise DataError(f"{self.path} unpacks to more than {MAX_UNPACKED} bytes; unpack it and split it in time")
        data = _as_utf8(data)
        if b"\x00" in data:
            raise DataError(f"{self.path} has binary bytes after text; the file is damaged")
        return _decode(data)

    def table(self, columns: int, text: str | None = None) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        """Return the numbers ``[N, columns]`` of a text and the line ``[N]`` of each row; "#" begins a comment.

        Raises:
            DataError: a line has another number of columns, or a word that is not a number.
        """
        lines = (self.text() if text is None else text).replace(",", " ").splitlines()
        kept = [k for k, line in enumerate(lines) if line.strip() and not line.lstrip().startswith("#")]
        if len(kept) < len(lines):
            lines = [lines[k] for k in kept]
        line = np.asarray(kept, dtype=np.int64) + 1
        if not lines:
            return np.empty((0, columns)), line
        try:
            values = np.loadtxt(lines, dtype=np.float64, comments=None, ndmin=2)
        except ValueError:
            values = np.empty((0, 0))
        if values.shape != (len(lines), columns):
            raise DataError(_describe_first_error(self.name, lines, line, columns))
        return values, line


def folder_files(folder: Path) -> list[Path]:
    """The files of a folder that is one recording, ordered by the numbers in their names, without hidden ones.

    Raises:
        DataError: the folder has none, too many, or too many bytes.
    """
    try:
        files = [path for path in folder.iterdir() if path.is_file() and not path.name.startswith((".", "_"))]
        size = sum(path.stat().st_size for path in files)
    except OSError as error:
        raise DataError(f"the folder {folder} cannot be read: {error.strerror}") from None
    if not files:
        raise DataError(f"the folder {folder} has no files")
    if len(files) > MOST_FILES or size > MAX_BYTES:
        raise DataError(
            f"the folder {folder} has {len(files)} files of {size} bytes, at most {MOST_FILES} of {MAX_BYTES} are read"
        )
    return sorted(files, key=lambda path: [part.zfill(20) for part in DIGITS.split(path.name)])


@contextlib.contextmanager
def parse_errors(source: Source, kind: str) -> Iterator[None]:
    """Convert any exception of a parser of a binary format to a :class:`DataError`.

    Raises:
        DataError: the file is cut short, damaged, or not of this kind.
    """
    try:
        yield
    except InputError:
        raise
    except Exception as error:  # parsers of damaged files raise anything: KeyError, UnicodeError, NotImplementedError
        lines = str(error).splitlines() or [type(error).__name__]
        raise DataError(f"{source.name} cannot be read as {kind}, it is truncated or damaged: {lines[0]}") from None


def _describe_first_error(name: str, lines: list[str], line: NDArray[np.int64], columns: int) -> str:
    for number, words in zip(line.tolist(), map(str.split, lines), strict=True):
        if len(words) != columns:
            return f"{name} line {number} has {len(words)} columns, the others have {columns}"
        bad = next((word for word in words if not _is_number(word)), None)
        if bad is not None:
            return f"{name} line {number}: {bad[:40]!r} is not a number"
    return f"{name} does not hold {columns} columns of numbers"


def _unpack(path: Path, most: int) -> bytes:
    """Return the first bytes of a gzip file, unpacked."""
    try:
        with gzip.open(path) as file:
            return file.read(most)
    except (OSError, EOFError, zlib.error) as error:
        raise DataError(f"{path} cannot be read as gzip, it is truncated or damaged: {error}") from None


def _as_utf8(data: bytes) -> bytes:
    """Return a text in UTF-16 or UTF-32 with a byte order mark as UTF-8, without an incomplete last character."""
    encoding = next((name for mark, name in WIDE if data.startswith(mark)), "")
    return data.decode(encoding, errors="ignore").encode() if encoding else data


def _decode(data: bytes) -> str:
    """Return the text, as UTF-8 or else Latin-1 (names in comments of old files)."""
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def _split(line: str) -> list[str]:
    return [word for word in re.split(r"[\s,]+", line) if word]


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return "_" not in word
