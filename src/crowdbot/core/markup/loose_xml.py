"""XML as TinyXML reads it, the parser of Gazebo, URDF, JuPedSim and Menge, which is less strict than the standard."""

from __future__ import annotations

import re

COMMENT = re.compile(rb"<!\[CDATA\[.*?\]\]>|<!--.*?-->", re.DOTALL)
DECLARATION = re.compile(rb"(\xef\xbb\xbf)?\s+(<\?xml\b[^>]{0,200}\?>)", re.DOTALL)
KEPT_ENCODING = re.compile(rb"encoding\s*=\s*[\"'](?!utf-?8)", re.IGNORECASE)
NO_LINE_END = re.compile(rb"[^\r\n]")


def strict_xml(data: bytes) -> bytes:
    """Return well-formed XML of a text that TinyXML reads, with all elements on their lines.

    Comments, in which ``--`` is not allowed by XML, become blanks: they end at the first ``-->``. So does a declaration
    in UTF-8 that does not begin the text.

    >>> strict_xml(b"\\n<?xml version='1.0'?>\\n<!-- run -- it -->\\n<a/>").split()
    [b'<a/>']
    >>> strict_xml(b"<a><!-- b\\nc --></a>").count(b"\\n")
    1
    """
    text = COMMENT.sub(_blank_comment, data)
    declaration = DECLARATION.match(text)
    if declaration and not KEPT_ENCODING.search(declaration[2]):
        text = NO_LINE_END.sub(b" ", declaration[0]) + text[declaration.end() :]
    return text


def _blank_comment(match: re.Match[bytes]) -> bytes:
    return NO_LINE_END.sub(b" ", match[0]) if match[0].startswith(b"<!--") else match[0]
