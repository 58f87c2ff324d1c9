"""Results of services, ``simulation_interfaces/Result``."""

from __future__ import annotations

from typing import Any

from crowdbot.core import InputError

UNSUPPORTED, OK, NOT_FOUND, INCORRECT_STATE, FAILED = 0, 1, 2, 3, 4


class UnsupportedFeature(InputError):
    """A request uses an optional feature of the standard that this program does not have."""


def result(code: int = OK, message: str = "", **fields: Any) -> dict[str, Any]:
    """Return a response with its result and other fields.

    >>> result(NOT_FOUND, "no robot")
    {'result': {'result': 2, 'error_message': 'no robot'}}
    """
    return {"result": {"result": code, "error_message": message}, **fields}
