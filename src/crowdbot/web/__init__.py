"""The app in the browser: server, sessions, and a desk for each tab.

A desk has no logic of its own: each of its commands is a call or an order that the command line has, too.
"""

from .access import AccessPolicy, is_loopback
from .app_server import AppServer
from .app_session import AppSession, Viewer
from .command import call_command, command, command_names
from .desk import Desk, DeskWindows, Resource
from .scene import PlayerFile, scene_description, scene_frame, scene_resource, write_player
from .state_frame import StateFrame
from .tabs import DESKS, opened_first
from .window import CREDIT, Window
from .workspace import Workspace

__all__ = [
    "CREDIT",
    "DESKS",
    "AccessPolicy",
    "AppServer",
    "AppSession",
    "Desk",
    "DeskWindows",
    "PlayerFile",
    "Resource",
    "StateFrame",
    "Viewer",
    "Window",
    "Workspace",
    "call_command",
    "command",
    "command_names",
    "is_loopback",
    "opened_first",
    "scene_description",
    "scene_frame",
    "scene_resource",
    "write_player",
]
