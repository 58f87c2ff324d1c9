"""Desk: the state behind one tab of the app."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar, Protocol

from .jobs.job_board import JobBoard
from .state_frame import StateFrame
from .workspace import Workspace

if TYPE_CHECKING:
    from crowdbot.simulation import OrderSource
    from crowdbot.trials import Trial


class DeskWindows(Protocol):
    """What a desk knows of its session: the windows that show it and the folder that it may use."""

    name: str
    """Name of the session."""
    workspace: Workspace
    """Files of the session."""
    jobs: JobBoard
    """Long work of the session."""

    def tell(self, event: str, data: Any) -> None:
        """Send an event ``desk.name`` with JSON data to all windows, from any thread."""

    def show(self, frame: StateFrame) -> None:
        """Send a state frame to all windows, from any thread; a slow window gets the newest of each channel."""

    def discard(self, channel: str) -> None:
        """Forget a frame of a channel that no window has got yet, since what it shows is over. From any thread.

        Events that are sent afterwards then never come before a frame of what was shown before.
        """

    def is_ready(self, channel: str | None = None) -> bool:
        """Return whether a window could take a frame of a channel, or of any, now. From any thread.

        Otherwise computing one is of no use: the windows are busy, or show something else, or are hidden.
        """


class Resource:
    """A file that a desk makes for the browser, such as the meshes of the bodies.

    Args:
        data: content; empty if it belonged to something that is no longer shown (status 204).
        kind: media type.
        name: name of the file if it is to be saved, or None to show it.
        sandbox: whether it is a page with scripts of its own, which the browser then keeps apart from the app.
    """

    def __init__(
        self, data: bytes, kind: str = "application/octet-stream", name: str | None = None, sandbox: bool = False
    ) -> None:
        self.data, self.kind, self.name, self.sandbox = data, kind, name, sandbox


class Desk:
    """The state and the commands behind one tab of the app, of one session.

    A desk has no logic of its own: its methods marked with :func:`crowdbot.web.command` call the same functions as the
    command line. Commands of one desk run one after the other in a thread. A desk sends events and state frames to all
    windows of its session.

    Args:
        session: the windows and the folder of the session.
    """

    name: ClassVar[str]
    """Name in the address of its commands: ``name.command``."""

    def __init__(self, session: DeskWindows) -> None:
        self.session = session

    def visit(self, address: Mapping[str, str]) -> None:
        """Open what the address of a page names, if nothing is open; called before :meth:`greet` of a new window.

        Called in the event loop, so it starts a thread for what takes long.

        Args:
            address: values of the address of the page, from the browser; empty for other windows.
        """

    def greet(self) -> dict[str, Any]:
        """Return the present state, JSON, for a new window and for a tab that is opened later.

        Called in the event loop, so it waits for nothing.
        """
        return {}

    def resource(self, path: str, query: dict[str, str]) -> Resource:
        """Return a file for ``GET /api/SESSION/DESK/path``.

        Raises:
            KeyError: there is no such file.
        """
        raise KeyError(path)

    def join_trial(self, trial: Trial, folder: Path) -> tuple[Trial, Sequence[OrderSource]]:
        """Take part in a trial that another desk is about to run.

        Args:
            trial: the trial.
            folder: folder for files about this run.

        Returns:
            The trial to run, perhaps with changes, and programs that steer it.

        Raises:
            InputError: the desk cannot take part, so the trial must not run.
        """
        return trial, ()

    def leave_trial(self) -> None:
        """Finish with the trial of :meth:`join_trial`, which has ended."""

    def close(self) -> None:
        """Stop runs, threads and processes of the desk."""
