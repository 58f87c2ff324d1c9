"""Content of XML, YAML and JSON files of other simulators, with limits."""

from __future__ import annotations

import json
import re
from pathlib import Path
from typing import Any

from crowdbot.core import Element, InputError, TrialError, parse_yaml, strict_xml
from crowdbot.trials.xml.trial_text import parse_trial_xml, read_trial_bytes

MOST_BYTES = 4_000_000
COMMENT = re.compile(r'"(?:[^"\\]|\\.)*"|//[^\n]*')


def xml_of(path: Path, place: str = "") -> Element:
    """The root element of an XML file that its own simulator reads, see :func:`crowdbot.core.strict_xml`.

    Args:
        path: the file.
        place: name for messages (default: the path).

    Raises:
        TrialError: the file is missing, too large or not XML.
    """
    return parse_trial_xml(strict_xml(read_trial_bytes(path)), place or str(path))


def yaml_of(path: Path) -> Any:
    """The content of a YAML file.

    Raises:
        TrialError: the file is missing, too large, not UTF-8 or not YAML.
    """
    try:
        return parse_yaml(_text(path), str(path))
    except InputError as error:
        raise TrialError(str(error)) from None


def json_of(path: Path) -> Any:
    """The content of a JSON file; comments from ``//`` to the end of a line are skipped.

    Raises:
        TrialError: the file is missing, too large, not UTF-8 or not JSON.
    """
    text = COMMENT.sub(lambda match: "" if match[0].startswith("//") else match[0], _text(path))
    try:
        return json.loads(text)
    except (ValueError, RecursionError) as error:
        raise TrialError(f"{path} is not JSON: {error}") from None


def _text(path: Path) -> str:
    data = read_trial_bytes(path)
    if len(data) > MOST_BYTES:
        raise TrialError(f"{path} is larger than {MOST_BYTES} bytes, the limit of a file to import")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise TrialError(f"{path} is not a text in UTF-8") from None
