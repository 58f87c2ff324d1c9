"""Rendering: images and films of the cameras of a trial."""

from .camera_images import SMOOTH, Shot, Take, camera_names, shots
from .image_writer import Album, painted_segmentation

__all__ = ["SMOOTH", "Album", "Shot", "Take", "camera_names", "painted_segmentation", "shots"]
