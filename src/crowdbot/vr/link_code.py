"""Addresses as QR codes, for headsets and phones."""

from __future__ import annotations

import io
from typing import Any

from crowdbot.core import import_optional


def link_picture(address: str) -> bytes:
    """Return an address as a QR code in SVG.

    Raises:
        MissingExtra: the package ``segno`` is not installed.

    >>> link_picture("https://192.0.2.1:8700/vr")[:5]
    b'<?xml'
    """
    out = io.BytesIO()
    _code(address).save(out, kind="svg", scale=5, border=4, dark="#000", light="#fff")
    return out.getvalue()


def link_text(address: str) -> str:
    """Return an address as a QR code for a terminal with dark background, two rows of the code in a line.

    Raises:
        MissingExtra: the package ``segno`` is not installed.

    >>> len(link_text("https://192.0.2.1:8700/vr").splitlines()) > 10
    True
    """
    rows = [list(row) for row in _code(address).matrix_iter(border=2)]
    rows += [[0] * len(rows[0])] if len(rows) % 2 else []
    blocks = {(0, 0): "█", (0, 1): "▀", (1, 0): "▄", (1, 1): " "}
    pairs = zip(rows[::2], rows[1::2], strict=True)
    return "\n".join("".join(blocks[a, b] for a, b in zip(up, low, strict=True)) for up, low in pairs)


def _code(address: str) -> Any:
    return import_optional("segno", "the picture of a link", "vr").make(address, error="m", micro=False)
