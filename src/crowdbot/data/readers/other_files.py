"""What a file is that is of no supported format, and what to do with it."""

from __future__ import annotations

import re
import zipfile

from crowdbot.data.source import Source

TABLE = "write it as a CSV table with the columns id, frame or time, x and y"
PICKLE = re.compile(rb"\x80[\x02-\x05]")
"""Beginning of a pickle, with its protocol."""
BINARIES = (
    (
        PICKLE,
        f"a pickle of Python, which is not read, because reading one can run any code; load it yourself, and {TABLE}",
    ),
    (re.compile(rb"\x93NUMPY"), f"an array of NumPy, which does not say what its columns are; {TABLE}"),
    (re.compile(rb"MATLAB 5\.0 MAT-file"), f"a MATLAB file, which is not read; {TABLE}, such as by writetable"),
    (re.compile(rb"\xd0\xcf\x11\xe0"), "an old Excel or Office file; save it as CSV"),
    (re.compile(rb"%PDF"), "a PDF document, not a table of positions"),
    (re.compile(rb"\x89PNG|\xff\xd8\xff|GIF8|BM....\x00{4}", re.DOTALL), "a picture, not a table of positions"),
    (
        re.compile(rb"....ftyp|RIFF....AVI |\x1a\x45\xdf\xa3", re.DOTALL),
        "a video; people in it are found by crowdbot track --video",
    ),
    (re.compile(rb"BZh|\xfd7zXZ|7z\xbc\xaf|Rar!|\x28\xb5\x2f\xfd"), "an archive; unpack it, only .gz is unpacked"),
)  # fmt: skip
"""Beginnings of binary files, with what they are."""
XML_ROOT = re.compile(r"<\s*([A-Za-z_][\w.:-]{0,60})[\s/>]")
JSON_KEY = re.compile(r'"([^"\\\n]{1,40})"\s*:')
MOST_KEYS = 6


def describe(source: Source) -> str:
    """Return what a file is and what to do with it, after its path: "is ..."; empty if its kind is not known."""
    for beginning, what in BINARIES:
        if beginning.match(source.head):
            return f"is {what}"
    if source.kind == "zip":
        return _describe_zip(source)
    if source.kind != "text" or not source.lines:
        return ""
    first = source.lines[0].lstrip()
    if first.startswith("<"):
        root = next((found[1] for line in source.lines[:50] for found in XML_ROOT.finditer(line)), "")
        held = f" of <{root}>" if root else ""
        return f"is XML{held}; recordings in XML are those of CVML (frame, objectlist, object, box); {TABLE}"
    if first[0] in "{[":
        keys = list(dict.fromkeys(JSON_KEY.findall("\n".join(source.lines[:200]))))[:MOST_KEYS]
        held = f" with {', '.join(keys)}" if keys else ""
        return (
            f"is JSON{held}, but recordings in JSON are those of TrajNet++ (scene and track), JRDB (labels) and"
            f" WILDTRACK (personID and positionID); {TABLE}"
        )
    return ""


def _describe_zip(source: Source) -> str:
    try:
        with zipfile.ZipFile(source.path) as archive:
            names = archive.namelist()[:1000]
    except (OSError, zipfile.BadZipFile, ValueError):
        return "is a damaged zip archive; fetch it again"
    if any(name.startswith("xl/") for name in names):
        return "is an Excel workbook; save its sheet as CSV"
    if any(name.startswith("content.xml") for name in names):
        return "is an OpenDocument file; save its sheet as CSV"
    held = ", ".join(name for name in names[:MOST_KEYS] if not name.endswith("/")) or "nothing"
    return f"is a zip archive of {held}; unpack it and give the files"
