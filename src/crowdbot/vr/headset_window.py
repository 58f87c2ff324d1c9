"""HeadsetWindow: what the page of a participant sees of a session, and what it may do."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.web import StateFrame, Window

HEADSET_COMMANDS = frozenset(
    ("simulator.description", "simulator.show_frame", "experiments.description", "experiments.show_frame",
     "experiments.draft", "experiments.finish_screen", "vr.pause", "vr.stop_robots")
)  # fmt: skip
"""Commands of the page of a participant: the picture, answers to the present screen, and what makes it safe."""
CHANNELS = frozenset(("scene", "trial"))
STATES = {
    "vr": ("participants", "settings", "rooms", "mirror", "own_body", "robot_margin", "pose", "warnings"),
    "simulator": ("status",),
    "experiments": ("open", "phase", "waiting", "index", "text", "questions", "answers"),
}
"""Parts of the states of the desks: nothing about files, conditions or other participants' answers."""
EVENTS = frozenset(("vr.state", "simulator.status", "simulator.opened", "experiments.state"))

UNIT = 32767.0
"""Unit of the quaternions in frames of the picture."""
HALF = 16383.0 * np.sqrt(2.0)
"""Unit of the parts of triples: none is above the square root of 1/2."""
OTHERS = np.array([[1, 2, 3], [0, 2, 3], [0, 1, 3], [0, 1, 2]])


class HeadsetWindow(Window):
    """A window with the rights of a participant.

    It gets the picture, the screen of the experiment and the state of its headset, and may call
    :data:`HEADSET_COMMANDS` only.
    """

    def tell(self, event: str, data: Any) -> None:
        """Send an event, if it is one for participants."""
        if event == "hello":
            desks = {name: _part(name, state) for name, state in data["desks"].items() if name in STATES}
            super().tell(event, {"session": data["session"], "desks": desks})
        elif event in EVENTS:
            desk, _, what = event.partition(".")
            super().tell(event, _part(desk, data) if what == "state" else data if what == "status" else {})

    def show(self, frame: StateFrame) -> None:
        """Send a frame of the picture."""
        if frame.channel in CHANNELS:
            super().show(headset_frame(frame))

    async def _call(self, number: int, address: str, arguments: dict[str, Any]) -> None:
        if address in HEADSET_COMMANDS:
            await super()._call(number, address, arguments)
        else:
            self._put({"id": number, "error": f"a headset may not call {address!r:.80}"})


def _part(desk: str, state: Mapping[str, Any]) -> dict[str, Any]:
    return {name: state[name] for name in STATES[desk] if name in state}


def pack_triples(bones: NDArray[np.int16]) -> NDArray[np.int16]:
    """Return quaternions ``[N, 4 B]`` without the largest part of each, which is positive: ``[N, 3 B]``.

    The lowest bits of the first and second part tell which one is missing. The error is below 0.0001.

    >>> pack_triples(np.array([[0, 32767, 0, 0]], dtype=np.int16)).tolist()
    [[1, 0, 0]]
    """
    parts = bones.reshape(-1, 4).astype(np.float64) / UNIT
    parts /= np.linalg.norm(parts, axis=1, keepdims=True)
    largest = np.argmax(np.abs(parts), axis=1)
    rows = np.arange(len(parts))
    parts *= np.where(parts[rows, largest] < 0.0, -1.0, 1.0)[:, None]
    found = 2 * np.round(parts[rows[:, None], OTHERS[largest]] * HALF).astype(np.int16)
    found[:, 0] |= (largest & 1).astype(np.int16)
    found[:, 1] |= (largest >> 1).astype(np.int16)
    return np.asarray(found.reshape(len(bones), -1), dtype=np.int16)


def headset_frame(frame: StateFrame) -> StateFrame:
    """Return a frame of the picture with triples instead of bones, a quarter smaller."""
    if "bones" not in frame.arrays:
        return frame
    arrays = {name: values for name, values in frame.arrays.items() if name != "bones"}
    return replace(frame, arrays={**arrays, "triples": pack_triples(frame.arrays["bones"])})
