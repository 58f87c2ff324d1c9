"""``crowdbot render TRIAL --camera NAME``: render an image or a video of a trial or an episode."""

from __future__ import annotations

import argparse
import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .output import add_json, number, print_json, print_table, progress
from .settings import add_settings, add_world, load_variant, settings

if TYPE_CHECKING:
    from crowdbot.rendering import RenderRequest
    from crowdbot.trials import Trial


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument(
        "trial", metavar="TRIAL", help="trial file, built-in name such as crossing-flows, or an episode (.mcap)"
    )
    parser.add_argument(
        "--camera",
        metavar="NAME",
        help="camera of the trial, robot/sensor, or overview (default: first camera of the trial, or overview)",
    )
    parser.add_argument(
        "--out",
        type=Path,
        metavar="FILE",
        help=".png, .jpg or .webp for an image, .mp4, .gif or .webp for a video, or a folder for numbered images",
    )
    parser.add_argument("--force", action="store_true", help="overwrite an existing file")
    parser.add_argument("--at", type=float, metavar="T", help="time of an image in s (default: 0)")
    parser.add_argument("--from", dest="begin", type=float, metavar="T", help="start of a video in s (default: 0)")
    parser.add_argument("--to", dest="end", type=float, metavar="T", help="end of a video in s")
    parser.add_argument("--fps", type=float, metavar="F", help="frame rate of a video in Hz (default: about 25)")
    parser.add_argument(
        "--depth", action="store_true", help="also write depth images: PNG in millimetres, or grey levels in a video"
    )
    parser.add_argument(
        "--segmentation", action="store_true", help="also write segmentation images, with one colour per object"
    )
    parser.add_argument("--list", action="store_true", help="list the cameras of the trial and exit")
    parser.add_argument("--seed", type=int, help="random seed (default: the seed of the trial)")
    parser.add_argument(
        "--folder",
        type=Path,
        metavar="DIR",
        help="folder of the trial files of an episode (default: the folder of the episode)",
    )
    parser.add_argument("--trust", action="store_true", help="allow code outside the folder of the trial")
    add_world(parser)
    add_settings(parser)
    parser.add_argument("--variant", type=int, metavar="N", help="variant of a trial with sweeps, counted from 1")
    add_json(parser)


def main(options: argparse.Namespace) -> int:
    """Render the image or the video."""
    from crowdbot.core import InputError

    if options.trial.lower().endswith(".mcap"):
        return _render_episode(options)
    if options.folder is not None:
        raise InputError("--folder is for an episode; the files of a trial are in its own folder")
    trial = load_variant(options)
    return _render(options, trial, trial.seed if options.seed is None else options.seed)


def _render_episode(options: argparse.Namespace) -> int:
    """Render a recorded episode: its trial runs again with its seed and its orders."""
    from crowdbot.core import InputError
    from crowdbot.recording import open_rerun

    if settings(options) or options.variant is not None or options.seed is not None:
        raise InputError("an episode is rendered as it was recorded; leave out settings, --variant and --seed")
    with open_rerun(options.trial, folder=options.folder, trust=options.trust) as rerun:
        return _render(options, rerun.trial, rerun.seed, sources=rerun.sources, prepare=rerun.prepare)


def _render(options: argparse.Namespace, trial: Trial, seed: int, **steering: Any) -> int:
    from crowdbot.rendering import ImageWriter, camera_names, render_images
    from crowdbot.trials import camera_remarks

    if options.list:
        return _list_cameras(trial, options.json)
    take = _take(options, trial.duration)
    camera = options.camera or camera_names(trial)[0]
    video = take.end is not None
    album = ImageWriter(
        options.out or _default(trial.name, camera, video), video, _rate(take, trial.step), options.force
    )
    with progress(options.json) as report:
        found = render_images(
            trial,
            camera,
            take,
            seed=seed,
            depth=options.depth,
            segmentation=options.segmentation,
            progress=lambda share: report(f"render {trial.name}", share),
            **steering,
        )
        files, count = album.write(found)
    summary = {
        "trial": trial.name,
        "seed": seed,
        "world": trial.world,
        "camera": camera,
        "images": count,
        "rate": album.rate if video else None,
    }
    remarks = camera_remarks(trial, camera)
    if options.json:
        print_json({**summary, "files": [str(path) for path in files], "remarks": remarks})
        return 0
    shown = [str(path) for path in files] if len(files) <= 3 else [f"{len(files)} files in {files[0].parent}"]
    rows = [(f"{key} [Hz]" if key == "rate" else key, number(value)) for key, value in summary.items()]
    rows += [("file", name) for name in shown]
    print_table(f"{trial.name}, seen by {camera}", ("", ""), rows)
    for remark in remarks:
        print(f"note: {remark}")
    return 0


def _take(options: argparse.Namespace, duration: float) -> RenderRequest:
    from crowdbot.core import InputError
    from crowdbot.rendering import RenderRequest

    span = [word for word, value in (("--from", options.begin), ("--to", options.end)) if value is not None]
    if options.at is not None and span:
        raise InputError(f"--at is for an image and {span[0]} for a video; give one of them")
    out = options.out
    if options.at is not None or (not span and (out is None or out.suffix.lower() not in (".mp4", ".gif"))):
        if options.fps is not None:
            raise InputError("--fps requires a video; add --to T")
        return RenderRequest(options.at or 0.0)
    return RenderRequest(options.begin or 0.0, duration if options.end is None else options.end, options.fps)


def _rate(take: RenderRequest, step: float) -> float:
    """Return the frame rate of a video [Hz]."""
    import math

    from crowdbot.rendering import SMOOTH

    return take.rate or 1.0 / (step * max(1, math.ceil(SMOOTH / step - 1e-9)))


def _default(trial: str, camera: str, video: bool) -> Path:
    name = re.sub(r"[^A-Za-z0-9]+", "-", f"{trial}-{camera}").strip("-").lower() or "trial"
    return Path(f"{name}{'.mp4' if video else '.png'}")


def _list_cameras(trial: Trial, as_json: bool) -> int:
    from crowdbot.rendering import camera_names

    names = camera_names(trial)
    if as_json:
        print_json({"trial": trial.name, "cameras": list(names)})
    else:
        print_table(f"cameras of {trial.name}", ("name",), [(name,) for name in names])
    return 0
