"""Services with types of ``std_srvs``, for systems without ``simulation_interfaces``."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from .inbox import Inbox
from .run_control import PAUSED, PLAYING
from .verbs.results import OK

SAME_STATE = 101
"""Result of ``set_simulation_state`` for the state in which the simulation is."""


@dataclass(frozen=True)
class PlainService:
    """A service that calls a service of the port.

    Fields:
        kind: ``Empty`` or ``Trigger`` of ``std_srvs``.
        verb: the last part of the name of the service of the port.
        request: fields of its request.
        about: one line for people.
    """

    kind: str
    verb: str
    request: Mapping[str, Any]
    about: str

    def call(self, inbox: Inbox, answer: Callable[[str], None], sender: str) -> None:
        """Ask the simulation; ``answer`` later gets an empty text, or the problem.

        Raises:
            InputError: the run has ended, or too many calls wait.
        """

        def read(response: Mapping[str, Any]) -> None:
            result = response["result"]
            answer("" if result["result"] in (OK, SAME_STATE) else str(result["error_message"]) or "refused")

        inbox.call(f"/crowdbot/{self.verb}", self.request, read, sender)


PLAIN_SERVICES = {
    "/crowdbot/pause": PlainService("Empty", "set_simulation_state", {"state": {"state": PAUSED}}, "pause"),
    "/crowdbot/unpause": PlainService("Empty", "set_simulation_state", {"state": {"state": PLAYING}}, "go on"),
    "/crowdbot/reset": PlainService("Empty", "reset_simulation", {}, "begin the trial again, as another episode"),
    "/crowdbot/step": PlainService("Trigger", "step_simulation", {"steps": 1}, "one step while paused"),
}
"""The services by their name."""
