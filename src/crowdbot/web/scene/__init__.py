"""The picture of a running simulation: what stands still, frames of what moves, and meshes."""

from .camera_images import SensorImage, encode_image, image_descriptions, sensor_images
from .crowd_layers import PredictedPaths
from .description import scene_description
from .episode_events import EpisodeEvent, episode_events, episode_series
from .frame import LAYERS, instant_frame, scene_frame
from .meshes import scene_resource
from .player import PlayerFile, write_player
from .recorded_scene import RecordedScene, simulation_reason
from .scene_instant import SceneInstant
from .scene_revision import scene_revision
from .walking_bodies import WalkingBodies

__all__ = [
    "LAYERS",
    "EpisodeEvent",
    "PlayerFile",
    "PredictedPaths",
    "RecordedScene",
    "SceneInstant",
    "SensorImage",
    "WalkingBodies",
    "encode_image",
    "episode_events",
    "episode_series",
    "image_descriptions",
    "instant_frame",
    "scene_description",
    "scene_frame",
    "scene_resource",
    "scene_revision",
    "sensor_images",
    "simulation_reason",
    "write_player",
]
