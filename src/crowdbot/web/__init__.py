"""The app in the browser: server, sessions, and a desk for each tab.

A desk has no logic of its own: each of its commands is a call or an order that the command line has, too. Names are
loaded on first use, so that the worker processes of jobs start fast.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from crowdbot.lazy import lazy_exports

if TYPE_CHECKING:
    from .app_server import AppServer
    from .app_session import AppSession, Viewer
    from .command import call_command, command, command_names
    from .desk import Desk, DeskWindows, Resource
    from .experiments import ExperimentDesk
    from .jobs import JobBoard
    from .scene import PlayerFile, scene_description, scene_frame, scene_resource, write_player
    from .scene.measurements import app_measurements
    from .session_limits import CLASSROOM, SessionLimits
    from .simulator import LiveRun, SimulatorDesk, navigator_orders
    from .state_frame import StateFrame
    from .tabs import DESKS, FirstView, opened_first, with_streams
    from .window import CREDIT, Window
    from .workspace import Workspace

__getattr__, __dir__, _ = lazy_exports(__name__)
# A submodule has the name of this function and would hide it.
from .command import command  # noqa: E402

__all__ = [
    "CLASSROOM",
    "CREDIT",
    "DESKS",
    "AppServer",
    "AppSession",
    "Desk",
    "DeskWindows",
    "ExperimentDesk",
    "FirstView",
    "JobBoard",
    "LiveRun",
    "PlayerFile",
    "Resource",
    "SessionLimits",
    "SimulatorDesk",
    "StateFrame",
    "Viewer",
    "Window",
    "Workspace",
    "app_measurements",
    "call_command",
    "command",
    "command_names",
    "navigator_orders",
    "opened_first",
    "scene_description",
    "scene_frame",
    "scene_resource",
    "with_streams",
    "write_player",
]
