"""Lines of a text file of bounded size."""

from __future__ import annotations

from pathlib import Path

from crowdbot.core import DataError


def read_text_lines(path: Path, largest: int, what: str) -> list[str]:
    """Return the lines of a file in UTF-8.

    Args:
        path: the file.
        largest: largest size [bytes].
        what: content of the file with its verb in messages, such as ``a sequence has``.

    Raises:
        DataError: the file cannot be read, or is larger.
    """
    try:
        if path.stat().st_size > largest:
            raise DataError(f"{path}: {what} at most {largest / 1e6:g} MB")
        return path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise DataError(f"{path} cannot be read: {error}") from None
