"""CaptureSet: open motion capture systems that move whoever of their targets is in a trial, trial after trial."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from types import TracebackType

from crowdbot.core import InputError
from crowdbot.trials import Trial

from .motion_capture import MotionBinding, MotionCapture
from .pose_stream import PoseStream
from .stream_address import open_stream, parse_binding

Origin = Callable[[], tuple[float, float, float]]


class CaptureSet:
    """Motion capture of a session: streams stay open from one trial to the next. Use it as a context.

    >>> with CaptureSet(["xsens:0=guest", "xsens:0#Cart=twin@2,0"]) as captures:
    ...     captures.targets, len(captures.streams)
    (('guest', 'twin'), 1)
    """

    def __init__(self, texts: Sequence[str] = ()) -> None:
        self.streams: dict[str, PoseStream] = {}
        """Open streams by their addresses."""
        self._bindings: dict[str, tuple[str, MotionBinding]] = {}
        self._texts = tuple(texts)

    def __enter__(self) -> CaptureSet:
        """Open the streams."""
        try:
            for text in self._texts:
                self.add(text)
        except BaseException:
            self.close()
            raise
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Close the streams."""
        self.close()

    @property
    def texts(self) -> tuple[str, ...]:
        """The texts of the bindings, such as ``xsens:9763=guest``."""
        return tuple(self._bindings)

    @property
    def targets(self) -> tuple[str, ...]:
        """Names of the avatars and robots that are moved."""
        return tuple(binding.target for _, binding in tuple(self._bindings.values()))

    @property
    def bindings(self) -> dict[str, MotionBinding]:
        """Who is moved, by the texts of the bindings; a copy."""
        return {text: binding for text, (_, binding) in tuple(self._bindings.items())}

    @property
    def live(self) -> bool:
        """Whether a stream comes in real time."""
        return any(one.live for one in self.streams.values())

    def add(self, text: str) -> None:
        """Open a stream, such as ``xsens:9763=guest``, and bind a target to it.

        Raises:
            InputError: the text is not valid, the target is moved already, or the stream cannot be opened.
        """
        address, binding = parse_binding(text)
        if binding.target in self.targets:
            raise InputError(f"motion capture moves {binding.target!r} already; remove that first")
        if address not in self.streams:
            self.streams[address] = open_stream(address).__enter__()
        self._bindings[text] = (address, binding)

    def remove(self, text: str) -> None:
        """Release a target; a stream without targets is closed.

        Raises:
            InputError: there is no such binding.
        """
        if text not in self._bindings:
            raise InputError(f"there is no motion capture {text!r}; there is {', '.join(self._bindings) or 'none'}")
        address, _ = self._bindings.pop(text)
        if all(other != address for other, _ in self._bindings.values()):
            self.streams.pop(address).__exit__(None, None, None)

    def close(self) -> None:
        """Close all streams."""
        for text in self.texts:
            self.remove(text)

    def stream_of(self, target: str) -> tuple[PoseStream, str] | None:
        """Return the stream of a target and the name of its subject; None: it is not moved."""
        found = next((pair for pair in tuple(self._bindings.values()) if pair[1].target == target), None)
        stream = None if found is None else self.streams.get(found[0])
        return None if found is None or stream is None else (stream, found[1].subject)

    def captures_of(self, trial: Trial, leave: Sequence[str] = (), origin: Origin | None = None) -> list[MotionCapture]:
        """Return what moves avatars and mirrored robots of a trial; targets that it lacks are left out.

        Args:
            trial: the trial.
            leave: names of targets that are moved in another way.
            origin: returns x, y [m] and heading [rad] of the origin of systems whose text has no ``@``.
        """
        mirrors = {one.name for one in trial.robots if one.mirror is not None and one.mirror.source == "external"}
        known = {one.name for one in trial.avatars if one.source == "external"} | mirrors
        found: dict[str, list[MotionBinding]] = {}
        for text, (address, binding) in tuple(self._bindings.items()):
            if binding.target not in known or binding.target in leave:
                continue
            x, y, heading = (binding.x, binding.y, binding.heading) if origin is None or "@" in text else origin()
            placed = dataclasses.replace(binding, x=x, y=y, heading=heading)
            found.setdefault(address, []).append(placed)
        return [MotionCapture(self.streams[address], bindings) for address, bindings in found.items()]
