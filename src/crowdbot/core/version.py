"""Digest of the source code, which identifies the code that produced a stored result."""

from __future__ import annotations

import functools
import hashlib
from pathlib import Path


@functools.cache
def source_digest() -> str:
    """Return a hash of all source files of the package.

    >>> len(source_digest())
    16
    """
    root = Path(__file__).parent.parent
    found = hashlib.blake2b(digest_size=8)
    for file in sorted(root.rglob("*.py")):
        found.update(file.relative_to(root).as_posix().encode())
        found.update(file.read_bytes())
    return found.hexdigest()
