"""``crowdbot check TRIAL``: read a trial and say everything that is wrong with it."""

from __future__ import annotations

import argparse
from pathlib import Path

from .output import add_json, print_json
from .settings import add_settings, settings


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("trials", metavar="TRIAL", nargs="+", help="trial files or built-in names")
    parser.add_argument("--trust", action="store_true", help="let trials load code from outside their own folder")
    add_settings(parser)
    add_json(parser)


def main(options: argparse.Namespace) -> int:
    """Check each trial; status 2 when one is wrong."""
    from crowdbot.core import InputError, TrialError
    from crowdbot.trials import load_trial

    found: dict[str, list[str]] = {}
    variants: dict[str, list[str]] = {}
    for name in options.trials:
        try:
            trial = load_trial(name, trust=options.trust, **settings(options))
            found[name] = []
            variants[name] = [one.name for one in trial.variants()] if trial.sweeps else []
        except TrialError as error:
            found[name] = list(error.problems)
        except InputError as error:
            found[name] = [str(error)]
    if options.json:
        print_json(
            {
                name: {"right": not problems, "problems": problems, "variants": variants.get(name, [])}
                for name, problems in found.items()
            }
        )
    else:
        for name, problems in found.items():
            for problem in problems:
                print(problem)
            print(f"{Path(name).name}: {'right' if not problems else f'{len(problems)} to mend'}")
            for k, variant in enumerate(variants.get(name, ()), 1):
                print(f"  {k:4d}  {variant}")
    return 2 if any(found.values()) else 0
