"""Commands of the pages about the examples, so that the tests run what a reader types."""

import re
import shlex
from pathlib import Path

ROOT = Path(__file__).parents[2]


def page_commands(page, program):
    """Return the words after the program of each command of a page in docs/how-to that starts with it."""
    text = (ROOT / "docs" / "how-to" / f"{page}.md").read_text(encoding="utf-8")
    fences = "\n".join(re.findall(r"^```\n(.*?)^```", text, flags=re.S | re.M)).replace("\\\n", " ")
    return [shlex.split(line)[1:] for line in fences.splitlines() if line.startswith(f"{program} ")]
