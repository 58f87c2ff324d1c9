"""The command line. Each command is a module of this package with ``arguments(parser)`` and ``main(options)``."""

from __future__ import annotations

import argparse
import contextlib
import importlib
import io
import logging
import os
import shlex
import sys
import tempfile
import textwrap
import traceback
from collections.abc import Iterator, Sequence

from .parser import CommandParser, unknown_words

__all__ = ["main"]

COMMAND_GROUPS = {
    "first steps": {
        "demo": "run a demonstration on built-in data and write a report",
        "app": "open the app in the browser: simulator, prediction, editor",
        "list": "list built-in names: models, predictors, trials and others",
        "new": "create a trial, robot, crowd model or another extension, with its test",
        "check": "report all errors in trials, experiments and robots",
    },
    "test a robot in a crowd": {
        "run": "run one trial and record it",
        "evaluate": "compare navigators in many trials and seeds, with intervals and requirements",
        "falsify": "search a trial for failures of its navigator, and estimate how likely they are",
        "challenge": "run, verify and rank submissions to a competition of navigators",
        "join": "let a real robot drive among the people of a trial",
        "experiment": "run trials with participants, instructions and questionnaires",
    },
    "recorded runs": {
        "replay": "run a recorded episode again and check its digest",
        "branch": "continue a recorded episode from a given time with other settings",
        "render": "render a trial or an episode as an image or a video",
        "export": "write an episode as a table, Parquet or CSV",
        "repair": "repair the episode file of a killed run",
        "generate": "write labelled sensor data of many runs, with true people",
    },
    "predict and track people": {
        "predict": "score predictors on recordings of people",
        "calibrate": "fit the parameters of a crowd model to recordings of people",
        "train": "train a predictor on recordings of people, or a detector on generated scans",
        "degrade": "score predictors on degraded tracks, or write a degraded recording",
        "track": "find and track people in laser scans, and score the tracks",
    },
    "crowds": {
        "measure": "measure density, speed and flow in recordings, episodes and trials",
        "validate": "compare crowd models with experiments",
    },
    "this installation": {
        "bench": "measure speed on this machine",
        "cite": "print the references of built-in names",
    },
}
"""Commands and what they do, by the job of the user."""
COMMANDS = {name: line for group in COMMAND_GROUPS.values() for name, line in group.items()}


def main(arguments: Sequence[str] | None = None) -> int:
    """Run one command and return the exit status.

    The status is 0 if the command succeeded, 1 if a check failed or the program has a bug, 2 for wrong input, and 130
    after an interruption.
    """
    words = [*(sys.argv[1:] if arguments is None else arguments)]
    debug = os.environ.get("CROWDBOT_DEBUG", "0") not in ("", "0")
    _open_standard_streams()
    try:
        options = _parse(words)
        debug |= options.debug
        with _notices():
            status: int = options.main(options)
        sys.stdout.flush()
        return status
    except SystemExit as end:  # from --help, --version and wrong options
        try:
            sys.stdout.flush()
        except OSError:
            _discard_output()
        if isinstance(end.__context__, BrokenPipeError):  # rich ends with this exception
            return 0
        raise
    except BrokenPipeError:  # the output is closed, as in `| head`
        _discard_output()
        return 0
    except KeyboardInterrupt:
        print("crowdbot: interrupted", file=sys.stderr)
        return 130
    except Exception as error:
        return _report(error, debug)


def _open_standard_streams() -> None:
    """Replace closed standard streams by the null device; characters that the encoding lacks are printed as ``?``."""
    if None in (sys.stdin, sys.stdout, sys.stderr):
        while (free := os.open(os.devnull, os.O_RDWR)) <= 2:  # the lowest free number; 0 to 2 are the standard streams
            os.set_inheritable(free, True)
        os.close(free)
        sys.stdin = sys.stdin or open(0, encoding="utf-8", closefd=False)  # noqa: SIM115
        sys.stdout = sys.stdout or open(1, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
        sys.stderr = sys.stderr or open(2, "w", encoding="utf-8", closefd=False)  # noqa: SIM115
    if isinstance(sys.stdout, io.TextIOWrapper) and sys.stdout.errors == "strict":
        sys.stdout.reconfigure(errors="replace")


class _Notices(logging.Handler):
    """Prints on stderr, once each, the files that code is loaded from and the robots that replace those of trials."""

    def __init__(self) -> None:
        super().__init__()
        self._printed: set[str] = set()

    def emit(self, record: logging.LogRecord) -> None:
        """Print one line, unless it was printed."""
        message = record.getMessage()
        if message not in self._printed:  # a sweep replaces a robot in each of its variants
            self._printed.add(message)
            print(f"crowdbot: {message}", file=sys.stderr)


@contextlib.contextmanager
def _notices() -> Iterator[None]:
    """Print the log of crowdbot on stderr inside the block."""
    logger, handler = logging.getLogger("crowdbot"), _Notices()
    level = logger.level
    logger.addHandler(handler)
    logger.setLevel(logging.INFO)
    for name in [name for name in logging.root.manager.loggerDict if name.startswith("crowdbot")]:
        logging.getLogger(name).disabled = False  # logging.config.dictConfig of other packages disables all loggers
    try:
        yield
    finally:
        logger.removeHandler(handler)
        logger.setLevel(level)


def _discard_output() -> None:
    """Redirect the standard output to the null device after a write error, since Python flushes it again at exit."""
    null = os.open(os.devnull, os.O_WRONLY)
    with contextlib.suppress(OSError):  # a stream without a file descriptor
        os.dup2(null, sys.stdout.fileno())
    os.close(null)


def _report(error: Exception, debug: bool) -> int:
    """Print one sentence about an error, with its traceback if ``debug``, and return the exit status."""
    from crowdbot.core import CrowdbotError

    if debug:
        traceback.print_exception(error)
    status, message = 2, str(error)
    if isinstance(error, EOFError):
        message = "standard input ended before all questions were answered"
    elif isinstance(error, OSError) and not isinstance(error, CrowdbotError) and error.strerror:
        message = f"{error.filename or 'standard output'}: {error.strerror}"
    elif not isinstance(error, CrowdbotError):
        status, message = 1, _describe(error, debug)
    print(f"crowdbot: {message}", file=sys.stderr)
    if isinstance(error, OSError):
        try:
            sys.stdout.flush()
        except OSError:
            _discard_output()
    return status


def _describe(error: Exception, debug: bool) -> str:
    """Return a sentence about an unexpected error; its traceback is written to a file unless it was printed."""
    frames = traceback.extract_tb(error.__traceback__)
    what = " ".join(f"{type(error).__name__}: {error}".split()).removesuffix(":")
    place = f" ({frames[-1].filename}, line {frames[-1].lineno})" if frames else ""
    bug = f"{what}{place}; this is a bug in crowdbot or in your code"
    if debug:
        return bug
    try:
        with tempfile.NamedTemporaryFile(
            "w", prefix="crowdbot-trace-", suffix=".txt", delete=False, encoding="utf-8", errors="backslashreplace"
        ) as file:
            file.write(f"{shlex.join(['crowdbot', *sys.argv[1:]])}\n\n")
            traceback.print_exception(error, file=file)
    except OSError:
        traceback.print_exception(error)
        return bug
    return f"{bug}; the traceback is in {file.name}"


def _parse(words: Sequence[str]) -> argparse.Namespace:
    """Return the options; ends the program with a suggestion if an option is unknown."""
    parser = _parser(words)
    options, unknown = parser.parse_known_args(words)
    if unknown:  # before the name of the command, whose own parser refuses those after it
        parser.exit(2, unknown_words(parser.prog, unknown, ("--help", "--version", "--debug")))
    return options


def _list_commands(parser: argparse.ArgumentParser) -> None:
    """Add the commands and what they do to the help, by the job of the user, in lines of at most 80 characters."""
    for title, group in COMMAND_GROUPS.items():
        lines = []
        for name, line in group.items():
            first = f"{name:<12}"
            lines += textwrap.wrap(line, 78, initial_indent=first, subsequent_indent=" " * len(first))
        parser.add_argument_group(title, "\n".join(lines))


def _parser(words: Sequence[str]) -> argparse.ArgumentParser:
    from crowdbot import __version__

    parser = argparse.ArgumentParser(
        prog="crowdbot",
        usage="crowdbot [-h] [--version] [--debug] COMMAND ...",
        description="Predict how a crowd moves in the next seconds, and test robots in crowds.",
        epilog="Options of a command: crowdbot COMMAND --help. Start with: crowdbot demo",
        formatter_class=argparse.RawDescriptionHelpFormatter,
        allow_abbrev=False,
    )
    parser.add_argument("--version", action="version", version=f"crowdbot {__version__}")
    parser.add_argument("--debug", action="store_true", help="print the traceback of an error (also: CROWDBOT_DEBUG=1)")
    commands = parser.add_subparsers(
        prog="crowdbot",
        metavar="COMMAND",
        help=argparse.SUPPRESS,
        required=True,
        dest="command",
        parser_class=CommandParser,
    )
    _list_commands(parser)
    wanted = next((word for word in words if not word.startswith("-")), None)
    if wanted is not None and wanted not in COMMANDS:
        from crowdbot.core import did_you_mean

        meant = did_you_mean(wanted, COMMANDS)
        parser.exit(2, f"crowdbot: error: {wanted!r} is not a command{meant}; crowdbot --help lists them\n")
    for name, line in COMMANDS.items():
        command = commands.add_parser(name, description=line[0].upper() + line[1:] + ".")
        if name == wanted:  # only the chosen command is imported, so that --help stays fast
            module = importlib.import_module(f"crowdbot.cli.{name}")
            command.add_argument(
                "--debug", action="store_true", default=argparse.SUPPRESS, help="print the traceback of an error"
            )
            module.arguments(command)
            command.set_defaults(main=module.main)
    return parser
