"""Files made of other files: clips of motion capture, bodies of rigged characters, and buildings beside trials."""

from __future__ import annotations

import argparse
import re
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from crowdbot.cli.parser import CommandParser


def add_body_options(parser: CommandParser) -> None:
    """Declare the options of a body."""
    group = parser.add_rare_group("body")
    group.add_argument("--height", type=float, metavar="M", help="stature in metres (default: that in the file)")
    group.add_argument(
        "--mass", type=float, metavar="KG", help="mass in kg (default: from the stature, with the mean body mass index)"
    )


def write_clip_file(options: argparse.Namespace) -> int:
    """Turn motion capture (BVH) into a clip in the current folder."""
    from crowdbot.core import InputError
    from crowdbot.humans import clip_of, read_bvh, write_clip

    source = options.file
    if source.suffix.lower() != ".bvh":
        raise InputError(f"{source} must be a file of motion capture, .bvh")
    out = _target(source, ".clip", options.force)
    try:
        text = source.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"cannot read {source}: {error}") from None
    clip = clip_of(read_bvh(text, source.name), out.name)
    _write(out, write_clip(clip).encode())
    kind = "a cycle of a gait, in step with the way" if clip.cyclic else "played in time"
    print(f"{out}: {len(clip.lift)} frames at {clip.rate:g} Hz, {len(clip.bones)} bones, {kind}")
    print(f'use it    <agent activity="{out.name}" .../> in a trial beside it')
    return 0


def write_body_file(options: argparse.Namespace) -> int:
    """Turn a rigged character (glTF) into a body in the current folder."""
    from crowdbot.core import InputError
    from crowdbot.humans import import_body, write_body

    source = options.file
    if source.suffix.lower() not in (".glb", ".gltf"):
        raise InputError(f"{source} must be a rigged character in glTF, .glb or .gltf; Blender exports FBX files as it")
    out = _target(source, ".body", options.force)
    found = import_body(source, out.name, options.height, options.mass)
    body = found.body
    _write(out, write_body(body))
    levels = ", ".join(str(len(level.faces)) for level in body.levels)
    print(f"{out}: {body.height:.3f} m, {body.mass:.1f} kg, levels of {levels} triangles")
    if found.missing:
        print(f"bones that the skeleton lacks: {', '.join(found.missing)}")
    for sentence in found.remarks:
        print(f"left out: {sentence}")
    print(f'use it    <agent body="{out.name}" .../> in a trial beside it')
    return 0


def _target(source: Path, suffix: str, force: bool) -> Path:
    """Return the file to write: the stem of the source with allowed letters, in the current folder."""
    from crowdbot.core import InputError

    out = Path((re.sub(r"[^A-Za-z0-9_-]+", "-", source.stem).strip("-") or "own")[:60] + suffix)
    if out.exists() and not force:
        raise InputError(f"{out} already exists; use --force to replace it")
    return out


def _write(out: Path, data: bytes) -> None:
    from crowdbot.core import InputError

    try:
        out.write_bytes(data)
    except OSError as error:
        raise InputError(f"cannot write {out}: {error.strerror or error}") from None


def copy_beside(source: Path, trial: Path) -> None:
    """Copy a file to the folder of a trial, since a trial reads only files in its folder.

    Raises:
        InputError: there is another file of this name, or the folder cannot be written.
    """
    from crowdbot.core import InputError

    target = trial.parent / source.name
    if target.resolve() == source.resolve():
        return
    data = source.read_bytes()
    if target.exists() and target.read_bytes() != data:
        raise InputError(f"{target} exists with a different content; write the trial to another folder")
    _write(target, data)
    print(f"copied {source.name} to the folder of the trial, since a trial reads only files in its folder")
