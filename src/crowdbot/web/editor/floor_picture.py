"""Floor pictures: a picture of a floor plan as a ROS map."""

from __future__ import annotations

from pathlib import Path

from crowdbot.core import InputError

__all__ = ["map_of_picture"]

MOST_CELLS = 16_000_000


def map_of_picture(picture: Path, resolution: float) -> Path:
    """Write a picture as the map of a stage and return its ``.yaml`` file.

    Pixels darker than 35 % are walls, the others are free; the lower left corner is the origin. The grey picture is
    written beside it as ``.pgm``.

    Args:
        picture: PNG or JPEG.
        resolution: size of a pixel [m].

    Raises:
        InputError: the file is not a picture or too large, or the resolution is not between 1 mm and 10 m.
    """
    from PIL import Image, UnidentifiedImageError

    if not 0.001 <= resolution <= 10.0:
        raise InputError(f"size of a pixel = {resolution:g} m: expected 0.001 to 10 m")
    try:
        with Image.open(picture, formats=("PNG", "JPEG")) as image:
            if image.width * image.height > MOST_CELLS:
                raise InputError(
                    f"{picture.name} has {image.width} x {image.height} pixels, at most {MOST_CELLS} in all"
                )
            paper = Image.new("RGBA", image.size, "white")
            grey = Image.alpha_composite(paper, image.convert("RGBA")).convert("L")
    except (UnidentifiedImageError, OSError, Image.DecompressionBombError, ValueError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{picture.name} is not a PNG or JPEG picture") from None
    grey.save(picture.with_suffix(".pgm"))
    path = picture.with_suffix(".yaml")
    rows = {
        "image": picture.with_suffix(".pgm").name,
        "resolution": f"{resolution:g}",
        "origin": "[0.0, 0.0, 0.0]",
        "negate": "0",
        "occupied_thresh": "0.65",
        "free_thresh": "0.65",
    }
    path.write_text("".join(f"{name}: {value}\n" for name, value in rows.items()), encoding="utf-8")
    return path
