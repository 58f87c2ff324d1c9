"""The picture of a running simulation: what stands still, frames of what moves, and meshes."""

from .description import scene_description
from .frame import LAYERS, scene_frame
from .meshes import scene_resource
from .player import PlayerFile, write_player

__all__ = ["LAYERS", "PlayerFile", "scene_description", "scene_frame", "scene_resource", "write_player"]
