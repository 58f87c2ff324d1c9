"""Write the types of ``simulation_interfaces`` from its files: ``python tools/simulation_interfaces.py FOLDER``.

FOLDER is a copy of https://github.com/ros-simulation/simulation_interfaces at the tag of a release. The module that is
written holds what the files declare, names, types, defaults and constants, without their comments. ``--check`` writes
nothing, and fails if the module differs.
"""

from __future__ import annotations

import argparse
import re
import sys
from collections import defaultdict
from pathlib import Path

MODULE = Path(__file__).parents[1] / "src/crowdbot/bridges/simulation_interfaces.py"
CONSTANT = re.compile(r"u?int\d+ (\w+) = (\d+)")


def declarations(text: str) -> list[str]:
    """Return the lines of a definition without comments and repeated spaces.

    >>> declarations("# Steps of the clock.\\nuint64 steps 1     # default\\n---\\nResult result\\n")
    ['uint64 steps 1', '---', 'Result result']
    """
    lines = (" ".join(line.partition("#")[0].split()) for line in text.splitlines())
    return [line for line in lines if line]


def constants(definitions: dict[str, list[str]]) -> dict[str, int]:
    """Return the constants of definitions; if a name has two values, with the type in front.

    >>> constants({"A": ["uint8 OK = 1", "uint8 NO_POSE = 2"], "GetB": ["uint8 OK = 1", "uint8 NO_POSE = 3"]})
    {'OK': 1, 'A_NO_POSE': 2, 'GET_B_NO_POSE': 3}
    """
    rows = [
        (kind, match[1], int(match[2]))
        for kind, lines in definitions.items()
        for match in map(CONSTANT.fullmatch, lines)
        if match
    ]
    values = defaultdict(set)
    for _, name, value in rows:
        values[name].add(value)
    return {
        name if len(values[name]) == 1 else f"{re.sub('(?<=[a-z])(?=[A-Z])', '_', kind).upper()}_{name}": value
        for kind, name, value in rows
    }


def table(name: str, definitions: dict[str, list[str]], about: str) -> str:
    """Return the assignment of definitions by the name of their type."""
    rows = (
        f'    "{kind}": """\\\n' + "".join(f"{line}\n" for line in lines) + '""",\n'
        for kind, lines in definitions.items()
    )
    return f'{name} = {{\n{"".join(rows)}}}\n"""{about}"""\n'


def module_text(folder: Path) -> str:
    """Return the text of the module.

    Args:
        folder: copy of the package, with ``package.xml``, ``msg`` and ``srv``.

    Raises:
        SystemExit: the folder is no copy of the package.
    """
    try:
        version = re.search(r"<version>([\d.]+)</version>", (folder / "package.xml").read_text(encoding="utf-8"))
        messages, services = (
            {
                path.stem: declarations(path.read_text(encoding="utf-8"))
                for path in sorted((folder / part).glob(f"*.{part}"))
            }
            for part in ("msg", "srv")
        )
    except OSError as error:
        raise SystemExit(f"{folder} is no copy of simulation_interfaces: {error}") from None
    if not (version and messages and services):
        raise SystemExit(f"{folder} is no copy of simulation_interfaces: it lacks a version, or files in msg or srv")
    numbers = constants(messages | services)
    return "\n".join(
        (
            f'"""Types of ``simulation_interfaces`` {version[1]} (``python tools/simulation_interfaces.py``).\n',
            "Source: https://github.com/ros-simulation/simulation_interfaces (Apache License 2.0). Do not edit.",
            '"""\n',
            table("MESSAGE_TYPES", messages, "Definitions of the messages by the name of their type."),
            table(
                "SERVICE_TYPES",
                services,
                "Definitions of the services, request and response, by the name of their type.",
            ),
            *(f"{name} = {value}" for name, value in numbers.items()),
            "",
        )
    )


def main() -> int:
    """Write or check the module."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("folder", type=Path, help="copy of simulation_interfaces")
    parser.add_argument("--check", action="store_true", help="write nothing, and fail if the module differs")
    parser.add_argument("--out", type=Path, default=MODULE, help="file to write (default: %(default)s)")
    args = parser.parse_args()
    text = module_text(args.folder)
    if not args.check:
        args.out.write_text(text, encoding="utf-8")
        return 0
    if args.out.read_text(encoding="utf-8") == text:
        return 0
    print(f"{args.out} differs from the files in {args.folder}", file=sys.stderr)
    return 1


if __name__ == "__main__":
    raise SystemExit(main())
