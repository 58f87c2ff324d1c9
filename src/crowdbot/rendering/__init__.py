"""Images and videos from the cameras of a trial."""

from .camera_images import SMOOTH, RenderedImage, RenderRequest, camera_names, render_images
from .image_writer import ImageWriter, color_segmentation

__all__ = [
    "SMOOTH",
    "ImageWriter",
    "RenderRequest",
    "RenderedImage",
    "camera_names",
    "color_segmentation",
    "render_images",
]
