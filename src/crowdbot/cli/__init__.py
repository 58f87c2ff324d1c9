"""Floor 8: the command line. Each command is a module here with ``arguments(parser)`` and ``main(options)``."""

from __future__ import annotations

import argparse
import importlib
import os
import sys
from collections.abc import Sequence

__all__ = ["main"]

COMMANDS = {
    "demo": "the main job on built-in input, then a report",
    "run": "run one trial and record it",
    "render": "make an image or a film of a trial",
    "replay": "run a recorded episode again and check its digest",
    "branch": "go on from an instant of a recorded episode, with other values",
    "repair": "give the file of a run that was killed its end and its index",
    "export": "write an episode as a table, Parquet or CSV",
    "experiment": "run trials with participants, with screens and questions around them",
    "predict": "score predictors on recordings of people",
    "calibrate": "fit the parameters of a crowd model to recordings of people",
    "train": "learn a predictor from recordings of people",
    "study": "compare GANs on the toy set of the report: which find all the ways that people may go",
    "degrade": "score predictors on noisy, hidden, swapped and false tracks, or write such a recording",
    "list": "name what is built in: models, predictors, trials, ...",
    "new": "write a trial to begin with, or one from a recording, or import one",
    "check": "read a trial or a robot and say everything that is wrong with it",
    "cite": "print the papers behind a name",
    "bench": "measure speed on this machine",
    "validate": "hold the crowd models against experiments with people",
}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return the exit status: 0 done, 1 the check failed, 2 wrong input, 130 interrupted."""
    words = [*(sys.argv[1:] if arguments is None else arguments)]
    options = _parser(words).parse_args(words)
    from crowdbot.core import CrowdbotError

    try:
        status: int = options.main(options)
        sys.stdout.flush()
        return status
    except CrowdbotError as error:
        print(f"crowdbot: {error}", file=sys.stderr)
        return 2
    except KeyboardInterrupt:
        print("crowdbot: interrupted", file=sys.stderr)
        return 130
    except BrokenPipeError:  # the reader of our output has gone, as with `| head`
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 0


def _parser(words: Sequence[str]) -> argparse.ArgumentParser:
    from crowdbot import __version__

    parser = argparse.ArgumentParser(
        prog="crowdbot",
        description="Predict how a crowd moves in the next seconds, and test robots in simulated crowds.",
        epilog="crowdbot COMMAND --help tells more. Start with: crowdbot demo",
        allow_abbrev=False,
    )
    parser.add_argument("--version", action="version", version=f"crowdbot {__version__}")
    commands = parser.add_subparsers(metavar="COMMAND", required=True, dest="command")
    wanted = next((word for word in words if not word.startswith("-")), None)
    for name, line in COMMANDS.items():
        command = commands.add_parser(name, help=line, description=line[0].upper() + line[1:] + ".", allow_abbrev=False)
        if name == wanted:  # only the chosen command is imported, so that --help stays fast
            module = importlib.import_module(f"crowdbot.cli.{name}")
            module.arguments(command)
            command.set_defaults(main=module.main)
    return parser
