"""Mutations and checks for fuzzers: hostile values, changed texts and bytes, error messages that are sentences."""

from __future__ import annotations

import io
import random
import re
import struct
from collections.abc import Callable

import numpy as np

_VALUES = """
nan inf -inf 1e999 1e308 -1e308 1e-320 0 -0 -1 1 2 1e6 1e7 99999 100000 100001 2147483648 9007199254740993 0x10 1_000
true false 1,0 0,0 1e6,1e6 0,0,0 normal(1,1) uniform(2,1) normal(1) x(1) () ( , ; : / .. ../x /etc/passwd ~ - é
${HOME} %s {0} \\ ' &amp; &lt; &#0; &#x41; <!--x--> ]]> POLYGON
"""
HOSTILE = _VALUES.split()
"""Values that parsers often get wrong."""
FACTORS = (-1.0, 0.1, 0.5, 0.9, 1.1, 2.0, 3.0, 100.0)
"""Factors for numbers."""
ENDS = (b"\x00", b"\xff", b"\xff\xff\xff\xff", b"\xff\xff\xff\x7f", b"\x00\x00\x00\x80", b"\x00" * 8, b"\xff" * 8)
"""Bytes of integers at the ends of their ranges."""
NUMBER = re.compile(r"-?[0-9]+(?:\.[0-9]+)?(?:e[+-]?[0-9]+)?")
WORD = re.compile(r"[^\s,;:]+")
XML_NUMBER = re.compile(r'(?<=[ ",])-?[0-9]+(?:\.[0-9]+)?(?=[ ",])')
XML_VALUE = re.compile(r'(?<=")[^"<>]*(?=")')
XML_ELEMENT = re.compile(r"<[^<>]+/>")
XML_NAME = re.compile(r"(?<= )[a-z][a-z-]*(?==)|(?<=<)[a-z][a-z-]*")


def replace_one(text: str, pattern: re.Pattern[str], rng: random.Random, change: Callable[[str], str]) -> str:
    """Return the text with one match of the pattern changed."""
    found = list(pattern.finditer(text))
    if not found:
        return text
    one = rng.choice(found)
    return text[: one.start()] + change(one.group()) + text[one.end() :]


def mutate_lines(text: str, rng: random.Random) -> str:
    """Return the text with lines dropped, doubled, swapped, or cut."""
    lines = text.splitlines(keepends=True)
    at, other = rng.randrange(len(lines)), rng.randrange(len(lines))
    kind = rng.randrange(5)
    if kind == 0:
        del lines[at : at + rng.choice((1, 2, 50))]
    elif kind == 1:
        lines[at:at] = lines[other : other + rng.choice((1, 3))]
    elif kind == 2:
        lines[at], lines[other] = lines[other], lines[at]
    elif kind == 3:
        lines[at] = lines[at][: rng.randrange(len(lines[at]) + 1)]
    else:
        lines[at] = lines[at].rstrip("\n") + rng.choice((" ", ",", ";", "\t", '"', " # ", "\r")) + lines[at]
    return "".join(lines)


def mutate_text(text: str, rng: random.Random) -> str:
    """Return a table or a list of records with one to four changes."""
    for _ in range(rng.choice((1, 1, 2, 4))):
        kind = rng.random()
        if not text.strip():
            return text
        if kind < 0.25:
            text = replace_one(text, NUMBER, rng, lambda word: f"{float(word) * rng.choice(FACTORS):g}")
        elif kind < 0.6:
            text = replace_one(text, WORD, rng, lambda _: rng.choice(HOSTILE))
        elif kind < 0.8:
            text = mutate_lines(text, rng)
        else:
            at = rng.randrange(len(text) + 1)
            odd = rng.choice(('"', "{", "}", "[", "#", "\x00", "\x1a", "", " ", "\n", "é", "\u2028", "9" * 400))
            text = text[:at] + odd + text[at + rng.choice((0, 0, 1, 5, 200)) :]
    return text


def mutate_bytes(data: bytes, rng: random.Random) -> bytes:
    """Return a binary file with one to four changes; half of them near its ends, where headers and indexes are."""
    raw = bytearray(data)
    for _ in range(rng.choice((1, 1, 2, 4))):
        if not raw:
            break
        reach = rng.choice((len(raw), len(raw), 64, 512, 4096))
        at = rng.randrange(min(reach, len(raw)))
        at = len(raw) - 1 - at if rng.random() < 0.5 else at
        kind = rng.random()
        if kind < 0.4:
            raw[at] ^= 1 << rng.randrange(8)
        elif kind < 0.7:
            end = rng.choice(ENDS)
            raw[at : at + len(end)] = end
        elif kind < 0.8:
            del raw[at : at + rng.choice((1, 8, 4096))]
        elif kind < 0.9:
            other = rng.randrange(len(raw))
            raw[at : at + 64] = raw[other : other + 64]
        else:
            del raw[at:]
    return bytes(raw)


def mutate_xml(text: str, rng: random.Random) -> str:
    """Return an XML file with one to four changes: of characters, values, names or whole elements."""
    for _ in range(rng.choice((1, 1, 2, 4))):
        kind = rng.random()
        if kind < 0.4:
            text = replace_one(text, XML_NUMBER, rng, lambda word: f"{float(word) * rng.choice(FACTORS):g}")
        elif kind < 0.6:
            text = replace_one(text, XML_VALUE, rng, lambda _: rng.choice(HOSTILE))
        elif kind < 0.7:
            text = replace_one(text, XML_NAME, rng, lambda word: misspell(word, rng))
        elif kind < 0.8:
            text = replace_one(text, XML_ELEMENT, rng, lambda element: element * rng.choice((0, 2, 30)))
        elif kind < 0.9:
            words = XML_VALUE.findall(text) or [""]
            text = replace_one(text, XML_VALUE, rng, lambda _, words=words: rng.choice(words))
        else:
            at = rng.randrange(len(text) + 1)
            end = min(len(text), at + rng.choice((0, 0, 1, 5, 200)))
            text = text[:at] + rng.choice(('"', "<", ">", "/", "&", "\x00", "\ud800", "", " ", "\n", "é")) + text[end:]
    return text


def misspell(word: str, rng: random.Random) -> str:
    """Return a word with one character left out, replaced or doubled."""
    at = rng.randrange(len(word))
    return word[:at] + rng.choice(("", "x", word[at] * 2)) + word[at + 1 :]


def mutate_arrays(data: bytes, rng: random.Random) -> bytes:
    """Return a NumPy ``.npz`` file with one array changed: values, shape, type, name, or left out."""
    with np.load(io.BytesIO(data), allow_pickle=False) as file:
        arrays = {name: file[name] for name in file.files}
    name = rng.choice(list(arrays))
    array, kind = arrays[name], rng.randrange(8)
    if kind == 0:
        del arrays[name]
    elif kind == 1:
        arrays[name] = array[: rng.choice((0, 1, len(array) // 2))] if array.ndim else array[None]
    elif kind == 2:
        arrays[name] = array[..., None] if array.ndim < 2 or rng.random() < 0.5 else array.T
    elif kind == 3:
        arrays[name] = array.astype(rng.choice(("U8", "complex128", "bool", "int8", "datetime64[s]", "object")))
    elif kind == 4:
        arrays[name] = arrays[rng.choice(list(arrays))]
    elif kind == 5:
        arrays[name] = np.resize(array, (rng.choice((0, 1, 3, 200)), *array.shape[1:])) if array.ndim else array
    elif kind == 6 and array.dtype.kind == "u" and array.dtype.itemsize == 1:  # the JSON text of a checkpoint
        text = mutate_text(array.tobytes().decode("utf-8", "replace"), rng)
        arrays[name] = np.frombuffer(text.encode("utf-8", "surrogatepass"), np.uint8)
    else:
        arrays[name] = array.copy()
        if array.size:
            with np.errstate(all="ignore"):
                value = np.array(rng.choice((np.nan, np.inf, -1.0, 0.0, 1e300, 1e9))).astype(array.dtype)
            arrays[name].flat[rng.randrange(array.size)] = value
    stream = io.BytesIO()
    np.savez(stream, **arrays)
    return stream.getvalue()


def flatten_mcap(data: bytes) -> bytes:
    """Return an MCAP file without chunks, checksums and summary, so that changed bytes reach its messages."""
    from crowdbot.data import MCAP_MAGIC, McapOpcode, McapReader

    dropped = (McapOpcode.MESSAGE_INDEX, McapOpcode.CHUNK)
    out = [MCAP_MAGIC]
    for kind, _, body in McapReader(io.BytesIO(data)).records():
        if kind == McapOpcode.CHUNK:
            out.append(_chunk_records(body))
        elif kind == McapOpcode.ATTACHMENT:
            out.append(struct.pack("<BQ", kind, len(body)) + body[:-4] + bytes(4))
        elif kind not in dropped:
            out.append(struct.pack("<BQ", kind, len(body)) + body)
    return b"".join((*out, struct.pack("<BQI", McapOpcode.DATA_END, 4, 0)))


def _chunk_records(body: bytes) -> bytes:
    (size,) = struct.unpack_from("<Q", body, 16)
    (length,) = struct.unpack_from("<I", body, 28)
    how, packed = body[32 : 32 + length], body[32 + length + 8 :]
    if how == b"zstd":
        import zstandard

        return zstandard.ZstdDecompressor().decompress(packed, max_output_size=size)
    if how:
        raise ValueError(f"the compression {how!r} is not known")
    return packed


def check_sentence(message: str) -> None:
    """Raise :class:`AssertionError` unless an error message is text for a user: no trace, no address of an object."""
    if not message.strip() or "Traceback" in message or "object at 0x" in message:
        raise AssertionError(f"not a sentence: {message!r}")
