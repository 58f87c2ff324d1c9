"""CapturesDesk: the commands of the operator about motion capture."""

from __future__ import annotations

import threading
from collections.abc import Sequence
from typing import Any, ClassVar

from crowdbot import web
from crowdbot.bridges import CaptureSet, MotionCapture, RealRobotLink, parse_binding
from crowdbot.core import InputError
from crowdbot.trials import Trial
from crowdbot.vr.rooms_desk import RoomsDesk
from crowdbot.web import AppSession, DeskWindows

from .suit import Suit

__all__ = ["CapturesDesk", "link_captures"]

LIVE = ("xsens:", "natnet:")


class CapturesDesk(RoomsDesk):
    """A desk with motion capture systems that stay open from one trial to the next.

    A system moves robots, and avatars of participants without a headset; the origin of one without ``@X,Y,HEADING`` is
    that of the room of the robot. A participant with a headset wears it as a :class:`Suit`.
    """

    first_captures: ClassVar[tuple[str, ...]] = ()
    """Motion capture that the session ``main`` opens at its start, such as ``xsens:9763=guest``."""

    def __init__(self, session: DeskWindows) -> None:
        super().__init__(session)
        self.captures = CaptureSet()
        self._opening = threading.Lock()
        self.capture_problem = ""
        """Why the motion capture of the start could not be opened."""
        if isinstance(session, AppSession) and session.name == "main":
            self._open_first()

    @web.command
    def add_capture(self, capture: str) -> None:
        """Open motion capture that moves an avatar or robot, such as xsens:9763=guest or natnet:HOST#Cart=robot.

        The connection to a NatNet server is made in the background, since the stop button must not wait for it; the
        event ``vr.problem`` says why it failed.
        """
        if not capture.startswith(LIVE):
            raise InputError(f"motion capture {capture!r:.80}: expected xsens:PORT=NAME or natnet:SERVER#SUBJECT=NAME")
        parse_binding(capture)
        if capture.startswith("natnet:"):
            threading.Thread(target=self._connect, args=(capture,), name="crowdbot-natnet", daemon=True).start()
        else:
            self._open(capture)

    def _connect(self, capture: str) -> None:
        try:
            self._open(capture)
        except InputError as error:
            self.session.tell("vr.problem", str(error))

    def _open(self, capture: str) -> None:
        with self._opening:
            self.captures.add(capture)
        with self._lock:
            self._apply_captures()
        self._tell_state()

    @web.command
    def remove_capture(self, capture: str) -> None:
        """Release what motion capture moves; a system without targets is closed."""
        with self._opening:
            self.captures.remove(capture)
        with self._lock:
            self._apply_captures()
        self._tell_state()

    def capture_states(self) -> list[dict[str, Any]]:
        """Return each binding with number, rate, losses and age of its samples, JSON."""
        found = []
        for text, binding in self.captures.bindings.items():
            target, known = binding.target, self.captures.stream_of(binding.target)
            if known is None:
                continue
            stream, subject = known
            counts, latency = stream.statistics(subject), stream.latency()
            age = None if latency is None else round(1e3 * latency[0], 1)
            found.append(
                {"capture": text, "target": target, "samples": counts.samples, "rate": round(counts.rate, 1),
                 "lost": counts.lost, "refused": counts.refused, "reason": counts.reason, "age": age}
            )  # fmt: skip
        return found

    def suit_of(self, avatar: str) -> Suit | None:
        """Return the suit of a participant with a headset, or None."""
        known = self.captures.stream_of(avatar)
        return None if known is None else Suit(*known)

    def captures_of(self, trial: Trial, worn: Sequence[str]) -> list[MotionCapture]:
        """Return what moves the robots of a trial and avatars without a headset.

        Args:
            trial: the trial.
            worn: names of avatars whose participants have a headset.
        """
        place = self.rooms.room("robot").place

        def origin() -> tuple[float, float, float]:
            return float(place.translation[0]), float(place.translation[1]), place.heading

        return self.captures.captures_of(trial, worn, origin)

    def close_captures(self) -> None:
        """Close all systems."""
        with self._opening:
            self.captures.close()

    def _apply_captures(self) -> None:
        """Let what runs use other motion capture."""

    def _open_first(self) -> None:
        for text in self.first_captures:
            try:
                self.captures.add(text)
            except InputError as error:
                self.capture_problem = str(error)


def link_captures(captures: Sequence[MotionCapture], links: Sequence[object]) -> list[MotionCapture]:
    """Give motion capture of real robots to their connections, and return what moves everybody else."""
    rest = []
    for one in captures:
        targets = [binding.target for binding in one.bindings]
        own = [link for link in links if isinstance(link, RealRobotLink) and link.robot in targets]
        for link in own:
            link.use_capture(MotionCapture(one.stream, [b for b in one.bindings if b.target == link.robot]))
        others = [b for b in one.bindings if b.target not in {link.robot for link in own}]
        if others:
            rest.append(MotionCapture(one.stream, others))
    return rest
