"""Write docs/models.md from the models themselves: ``python tools/models.py > docs/models.md``."""

from __future__ import annotations

import inspect

from crowdbot import models
from crowdbot.core import builtin_classes, parameters

HEAD = """# Crowd models

`python tools/models.py > docs/models.md` makes this page from the models. `low` and `high` are the box in which a
calibration searches; every parameter is a number for all or an array `[E, A]`. How the models compare with other
engines stands in [measured.md](results/measured.md); how they behave, in [validation.md](validation.md)."""


def main() -> None:
    """Print the page."""
    print(HEAD)
    for name, kind in builtin_classes(models, models.CrowdModel).items():
        text = (inspect.getdoc(kind) or "").replace("``", "`")
        print(f"\n## {name}\n\n{text.split(chr(10) * 2)[0]}\n\n{kind.paper}")
        rows = parameters(kind)
        if rows:
            print("\n| parameter | unit | default | low | high | source |\n|---|---|---|---|---|---|")
        for row in rows:
            print(f"| {row.name} | {row.unit} | {row.default:g} | {row.low:g} | {row.high:g} | {row.source} |")


if __name__ == "__main__":
    main()
