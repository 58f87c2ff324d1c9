"""Images and videos from the cameras of a trial, and plots of episodes."""

from .camera_images import SMOOTH, RenderedImage, RenderRequest, SimulationCamera, camera_names, render_images
from .image_writer import ImageWriter, color_segmentation
from .reaction_plot import plot_reactions
from .video_writer import VideoWriter, reel

__all__ = [
    "SMOOTH",
    "ImageWriter",
    "RenderRequest",
    "RenderedImage",
    "SimulationCamera",
    "VideoWriter",
    "camera_names",
    "color_segmentation",
    "plot_reactions",
    "reel",
    "render_images",
]
