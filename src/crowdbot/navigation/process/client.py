"""The end of the protocol in the process of the navigator: ``python -m crowdbot.navigation.process.client ADDRESS``."""

from __future__ import annotations

import argparse
import contextlib
import json
import os
import shlex
import shutil
import sys
import sysconfig
import traceback
from collections.abc import Callable
from pathlib import Path
from typing import Any, BinaryIO, NoReturn

import crowdbot.navigation
from crowdbot.core import find_class, from_attributes
from crowdbot.navigation.navigator import Navigator

from .messages import (
    LONGEST_LINE,
    decode_memory,
    decode_observation,
    encode_action,
    encode_memory,
)
from .sandbox import enter_sandbox


def answer(navigator: Navigator, request: dict[str, Any]) -> dict[str, Any]:
    """Return the answer to a request; an exception becomes ``error``.

    >>> from crowdbot.navigation import DriveLimits, Observation, Straight
    >>> from crowdbot.navigation.process.messages import encode_observation
    >>> here = Observation(pose=(0.0, 0.0, 0.0), goal=(4.0, 0.0), radius=0.3, limits=DriveLimits(1.0, 2.0), dt=0.1)
    >>> request = {"call": "act", "observation": encode_observation(here), "memory": "null"}
    >>> answer(Straight(), request)["twist"]
    [1.0, 0.0, 0.0]
    """
    try:
        observation = decode_observation(request["observation"])
        if request["call"] == "begin":
            return {"memory": encode_memory(navigator.begin(observation))}
        action, memory = navigator.decide(observation, decode_memory(request["memory"]))
        return encode_action(action) | {"memory": encode_memory(memory)}
    except Exception as error:  # code of users may raise anything
        frames = traceback.extract_tb(error.__traceback__)
        place = f" ({Path(frames[-1].filename).name}, line {frames[-1].lineno})" if frames else ""
        return {"error": " ".join(f"{type(error).__name__}: {error}".split())[:500] + place}


def serve(navigator: Navigator, requests: BinaryIO, answers: BinaryIO) -> None:
    """Answer requests until their stream ends."""
    while line := requests.readline(LONGEST_LINE + 1):
        found = answer(navigator, json.loads(line))
        answers.write(json.dumps(found, separators=(",", ":")).encode() + b"\n")
        answers.flush()


def _system_folders() -> list[Path]:
    """Return the folders that Python and its libraries are loaded from."""
    names = ("/usr", "/lib", "/lib64", "/etc/ld.so.cache", "/etc/localtime", "/dev/null", "/dev/urandom", "/proc/self")
    python = [Path(path) for path in (sys.prefix, sys.base_prefix, *sysconfig.get_paths().values())]
    return [*map(Path, names), *python, Path(__file__).parents[2]]


def run_command(options: argparse.Namespace) -> NoReturn:
    """Become another program, in the sandbox."""
    words = shlex.split(options.address)
    program = shutil.which(words[0]) or words[0]
    folder = Path(program).resolve().parent
    files = [Path(word).resolve() for word in words[1:] if Path(word).exists()]
    enter_sandbox(
        [*_system_folders(), folder, *(file.parent for file in files)],
        [options.sandbox],
        memory=options.memory,
        cpu=options.cpu,
        programs=True,
    )
    os.execv(program, words)  # noqa: S606 (the trial names the program)


def main(words: list[str] | None = None) -> None:
    """Load a navigator and serve its process."""
    parser = argparse.ArgumentParser(prog="crowdbot.navigation.process.client")
    parser.add_argument("address")
    parser.add_argument("folder", type=Path)
    parser.add_argument("--parameters", default="{}")
    parser.add_argument("--command", action="store_true", help="run a program instead")
    parser.add_argument("--sandbox", type=Path, metavar="DIR", help="sandbox with this folder to write in")
    parser.add_argument("--memory", type=int)
    parser.add_argument("--cpu", type=int)
    options = parser.parse_args(words)
    if options.command:
        run_command(options)
    requests, answers = os.fdopen(os.dup(0), "rb"), os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what the navigator prints must not end up among the answers
    os.dup2(os.open(os.devnull, os.O_RDONLY), 0)
    if options.sandbox is not None:
        readable = [*_system_folders(), options.folder.resolve()]
        enter_sandbox(readable, [options.sandbox], memory=options.memory, cpu=options.cpu)
    ready: dict[str, Any] = {"ready": True}
    make: Callable[[], Any] = lambda: from_attributes(  # noqa: E731
        find_class(options.address, crowdbot.navigation, Navigator, folder=options.folder.resolve(), trust=False),
        json.loads(options.parameters),
    )
    navigator = None
    try:
        navigator = make()
    except Exception as error:  # code of users may raise anything
        ready = {"error": " ".join(f"{type(error).__name__}: {error}".split())[:500]}
    answers.write(json.dumps(ready).encode() + b"\n")
    answers.flush()
    if navigator is not None:
        with contextlib.suppress(BrokenPipeError):
            serve(navigator, requests, answers)


if __name__ == "__main__":
    main()
