"""Print the versions of everything that the tests install: ``.venv/bin/python tools/pin.py > constraints.txt``.

These are the packages that crowdbot with the extra ``dev`` needs, and all that they need in turn, as installed. ``make
test`` installs JuPedSim without the packages of its viewer, so these have no version here.
"""

from __future__ import annotations

from importlib.metadata import distribution

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

HEADER = "# The versions that crowdbot is tested with: pip install -c constraints.txt ."
ALONE = "jupedsim"
"""Installed without its requirements, of which the core needs only ``deprecated``, ``numpy`` and ``shapely``."""


def pinned() -> dict[str, str]:
    """Return the installed versions by name."""
    found: dict[str, str] = {}
    waiting = [Requirement("crowdbot[dev]"), Requirement(ALONE)]
    seen: set[tuple[str, frozenset[str]]] = set()
    while waiting:
        requirement = waiting.pop()
        name = canonicalize_name(requirement.name)
        if (name, frozenset(requirement.extras)) in seen:
            continue
        seen.add((name, frozenset(requirement.extras)))
        one = distribution(name)
        if name != "crowdbot":
            found[name] = one.version.partition("+")[0]
        for text in () if name == ALONE else one.requires or ():
            needed = Requirement(text)
            extras = ("", *requirement.extras)
            if needed.marker is None or any(needed.marker.evaluate({"extra": extra}) for extra in extras):
                waiting.append(needed)
    return dict(sorted(found.items()))


if __name__ == "__main__":
    print(HEADER, *(f"{name}=={version}" for name, version in pinned().items()), sep="\n")
