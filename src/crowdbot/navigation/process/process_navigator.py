"""A navigator that runs in a process of its own, with a sandbox for code that is not trusted."""

from __future__ import annotations

import json
import math
import shlex
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from crowdbot.core import InputError, check_number
from crowdbot.navigation.action import Action
from crowdbot.navigation.navigator import Navigator
from crowdbot.navigation.observation import Observation

from .child_process import ChildProcess, check_pipes, child_process
from .messages import decode_action, encode_observation
from .sandbox import sandbox_problem


@dataclass(frozen=True)
class ProcessNavigator(Navigator):
    """Asks a navigator in another process, by lines of JSON on its standard streams.

    The process is started at the first decision and answers all environments in turn. It gets what the robot knows,
    without the truth in readings (who is hit, biases) and without predictors. Its memory comes back with each answer,
    so replay and branches work as for other navigators; it must consist of numbers, texts, lists, dictionaries and
    arrays. A process that ends, hangs or answers something else fails the run in which it happens, and is started again
    for the next one. It works on Linux and macOS.

    Fields:
        address: navigator in a Python file, ``mine.py:Mine``, relative to the working folder.
        command: another program, instead of an address; see ``docs/how-to/process-navigator.md`` for the protocol.
        parameters: parameters of the navigator, ``name=value`` separated by blanks.
        sandbox: whether the process has no network, no other processes and no files but those of its folder and of the
            system; only on Linux.
        timeout: longest real time of an answer [s].
        memory: largest address space in the sandbox [MB].
        cpu: largest CPU time of the process in the sandbox [s].

    Raises:
        InputError: a value is not allowed, this system has no sandbox, or it is Windows.

    >>> ProcessNavigator(address="mine.py:Mine", sandbox=False).title()
    'mine.py:Mine'
    """

    always_returns = True

    address: str = ""
    command: str = ""
    parameters: str = ""
    sandbox: bool = True
    timeout: float = 10.0
    memory: float = 4000.0
    cpu: float = 3600.0

    def __post_init__(self) -> None:
        for name in ("timeout", "memory", "cpu"):
            unit = "MB" if name == "memory" else "s"
            check_number("ProcessNavigator", name, getattr(self, name), unit, exclusive_min=0.0)
        if bool(self.address) == bool(self.command):
            raise InputError("ProcessNavigator: give either an address such as mine.py:Mine, or a command")
        if self.command and self.parameters:
            raise InputError("ProcessNavigator: parameters belong to an address; write them into the command")
        if any("=" not in word for word in self.parameters.split()):
            raise InputError(f"ProcessNavigator: parameters = {self.parameters!r} must be name=value, by blanks")
        check_pipes("ProcessNavigator: a navigator in a process of its own")
        if self.sandbox and (problem := sandbox_problem()):
            raise InputError(f"ProcessNavigator: {problem}; sandbox=false runs the code without one")

    def title(self, robot: str = "") -> str:
        return self.address or shlex.split(self.command)[0]

    def begin(self, observation: Observation) -> Any:
        found = self._ask({"call": "begin", "observation": encode_observation(observation)})
        return self._memory(found)

    def act(self, observation: Observation, memory: Any) -> tuple[Action, Any]:
        found = self._ask({"call": "act", "observation": encode_observation(observation), "memory": memory})
        try:
            action = decode_action(found)
        except (KeyError, TypeError, ValueError) as error:
            raise InputError(f"navigator {self.title()}: the answer has no valid twist: {error}") from None
        if not all(map(math.isfinite, action.joints.values())):
            raise InputError(f"navigator {self.title()}: the joints {action.joints} must be finite")
        return action, self._memory(found)

    def _ask(self, request: dict[str, Any]) -> dict[str, Any]:
        ask = self._process().ask(request, self.timeout)
        if "error" in ask:
            raise InputError(f"navigator {self.title()}: {str(ask['error'])[:600]}")
        return ask

    def _memory(self, found: dict[str, Any]) -> str:
        memory = found.get("memory", "null")
        if not isinstance(memory, str):
            raise InputError(f"navigator {self.title()}: the memory in the answer must be a text")
        return memory

    def _process(self) -> ChildProcess:
        return child_process(self._words(), self.title())

    def _words(self) -> list[str]:
        if self.command and not self.sandbox:
            return shlex.split(self.command)
        file = Path(self.address.rpartition(":")[0] or ".")
        words = [sys.executable, "-m", "crowdbot.navigation.process.client"]
        if self.command:
            words += [self.command, ".", "--command"]
        else:
            settings = dict(word.split("=", 1) for word in self.parameters.split())
            name = f"{file.name}:{self.address.rpartition(':')[2]}"
            words += [name, str(file.resolve().parent), "--parameters", json.dumps(settings)]
        if self.sandbox:
            words += [
                "--sandbox",
                "{scratch}",
                "--memory",
                str(int(self.memory * 1e6)),
                "--cpu",
                str(int(self.cpu) + 1),
            ]
        return words
