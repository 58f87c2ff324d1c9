"""``crowdbot new KIND FILE``: write a file that is ready to run, with its contract test."""

from __future__ import annotations

import argparse
import contextlib
import re
import shutil
from pathlib import Path
from typing import TYPE_CHECKING

from .output import note
from .recordings import add_file_options, check_parts, value_for
from .settings import add_settings, settings
from .templates import (
    CLASSES,
    FOLLOW_UP,
    challenge_files,
    class_files,
    robot_files,
    stage_files,
    submission_files,
    trial_test,
)
from .templates.maker_file import add_robot_options, convert_robot, is_robot_file

if TYPE_CHECKING:
    from crowdbot.trials import Trial

    from .parser import CommandParser

COPIED = "copied {} to the folder of the trial, since a trial reads only files in its folder"
KINDS = (*CLASSES, "robot", "stage", "trial", "challenge", "submission", "clip", "body", "schema")


def arguments(parser: CommandParser) -> None:
    """Declare the options."""
    parser.add_argument("kind", metavar="KIND", choices=KINDS, help=f"one of {', '.join(KINDS)}")
    parser.add_argument(
        "file",
        metavar="FILE",
        type=Path,
        help="file to write: .py, .geojson (stage), .xml (trial), .toml (challenge) or folder (robot, submission),"
        " or a .bvh file that becomes a clip, or a .glb or .gltf file that becomes a body; or a robot file to convert",
    )
    parser.add_argument("--force", action="store_true", help="replace existing files")
    parser.add_argument("--trust", action="store_true", help="allow code and files outside the folder of the trial")
    group = parser.add_argument_group("trial")
    begin = group.add_mutually_exclusive_group()
    begin.add_argument(
        "--from", dest="source", metavar="TRIAL", help="built-in name or file to copy (default: frontal)"
    )
    begin.add_argument(
        "--import",
        dest="original",
        type=Path,
        metavar="FILE",
        help="file of Vadere, UMANS, pedsim, HuNavSim, IR-SIM, Arena-Rosnav, Gazebo, JuPedSim, Menge or the CrowdBot"
        " simulator (2021), a drawing (DXF), or a building (.glb)",
    )
    begin.add_argument(
        "--recorded",
        type=Path,
        metavar="PATH",
        help="recording that provides the people: a file, or a folder that is one recording",
    )
    group.add_argument(
        "--root",
        type=Path,
        metavar="DIR",
        help="project folder of the CrowdBot simulator, for files that FILE refers to (default: folder of FILE)",
    )
    group.add_argument(
        "--layer", metavar="NAME", action="append", default=[], help="layer of a drawing (default: all visible ones)"
    )
    group.add_argument(
        "--unit", choices=("mm", "cm", "m", "km", "in", "ft"), help="unit of a drawing (default: from the file)"
    )
    add_settings(group)
    group.add_argument("--explicit", action="store_true", help="write each initial person as a separate agent")
    group.add_argument("--seed", type=int, help="seed of the trial (default: from the copied trial)")
    add_robot_options(parser)
    _add_body_options(parser)
    group = parser.add_rare_group("trial from a recording")
    add_file_options(group, agents="all")
    group.add_argument("--reactive", action="store_true", help="simulate people near the robot with a crowd model")
    group.add_argument("--replace", type=int, metavar="ID", help="id of the person that the robot replaces")


def main(options: argparse.Namespace) -> int:
    """Write the files."""
    from crowdbot.core import InputError
    from crowdbot.trials import trial_xml

    if options.kind == "robot" and is_robot_file(options.file):
        return convert_robot(options)
    if options.kind == "clip":
        return _write_clip_file(options)
    if options.kind == "body":
        return _write_body_file(options)
    if options.json:
        raise InputError("--json is for a robot from a file")
    files = _files(options)
    for file in (options.file, *files):
        if file.exists() and not options.force:
            raise InputError(f"{file} already exists; use another name, or --force to replace it")
        if file.exists() and not (file.is_file() or file.is_dir()):
            raise InputError(f"{file} is a device; give the path of a file")
    if not options.file.parent.is_dir():
        raise InputError(f"the folder {options.file.parent} of {options.file.name} does not exist")
    if options.kind == "schema":
        from crowdbot.trials import schema

        files = {options.file: schema()}
    elif options.original is not None:
        return _import_trials(options)
    elif options.kind == "trial":
        files = {options.file: trial_xml(_trial(options)), **files}
    for file, text in files.items():
        _write(file, text)
        print(f"wrote {file}")
    if options.kind in FOLLOW_UP:
        test = next(file for file in files if file.name.startswith("test_"))
        cls = f":{_class_name(files[options.file])}" if options.kind in CLASSES else ""
        use = FOLLOW_UP[options.kind].format(name=options.file.name + cls, address=f"{options.file}{cls}")
        print(f"test it   pytest {test}")
        print(f"use it    {use}")
    return 0


def _files(options: argparse.Namespace) -> dict[Path, str]:
    """Return the texts of files that do not depend on other options."""
    if options.kind in CLASSES:
        return class_files(options.kind, options.file)
    if options.kind == "robot":
        return robot_files(options.file)
    for kind, make in (("stage", stage_files), ("challenge", challenge_files), ("submission", submission_files)):
        if options.kind == kind:
            return make(options.file)
    return trial_test(options.file) if options.kind == "trial" and options.original is None else {}


def _class_name(text: str) -> str:
    return text.partition("\nclass ")[2].partition("(")[0]


def _trial(options: argparse.Namespace) -> Trial:
    trial = _recorded_trial(options) if options.recorded is not None else _copied_trial(options)
    return _place(trial, options) if options.seed is not None or options.explicit else trial


def _copied_trial(options: argparse.Namespace) -> Trial:
    from crowdbot.trials import load_trial

    return load_trial(options.source or "frontal", settings(options), trust=options.trust)


def _place(trial: Trial, options: argparse.Namespace) -> Trial:
    import dataclasses

    from crowdbot.trials import expand_spawners

    seed = trial.seed if options.seed is None else options.seed
    return expand_spawners(trial, seed) if options.explicit else dataclasses.replace(trial, seed=seed)


def _recorded_trial(options: argparse.Namespace) -> Trial:
    from crowdbot.core import InputError
    from crowdbot.trials import recorded_trial

    check_parts(options, [options.recorded])
    if options.scale is not None and options.homography is not None:
        raise InputError("--scale and --homography are given; coordinates have one scale")
    values = {name: value_for(options.recorded, getattr(options, name)) for name in ("fps", "units", "scale")}
    values |= {name: getattr(options, name) for name in ("format", "topic", "frame", "time_base", "agents")}
    values |= {"columns": " ".join(options.columns), "homography": options.homography and options.homography.name}
    paths = [path for path in (options.recorded, options.homography) if path is not None]
    beside = [(path, options.file.parent / path.resolve().name) for path in paths]
    copied = [target for path, target in beside if _copy_beside(path, target)]
    try:
        trial = recorded_trial(
            options.file.parent / options.recorded.resolve().name,
            mode="reactive" if options.reactive else "scripted",
            replace=options.replace,
            name=options.file.stem,
            **{name: value for name, value in values.items() if value is not None},
        )
    except InputError:
        for copy in copied:
            _remove(copy)
        raise
    for copy in copied:
        note(COPIED.format(copy.name))
    for sentence in (sentence for item in trial.recorded for sentence in item.remarks()):
        note(sentence)
    return trial


def _copy_beside(path: Path, beside: Path) -> bool:
    """Copy a file, or the files of a folder, to a place in the folder of the trial; False: it is there.

    Raises:
        InputError: the file does not exist, another one has its place, or the folder cannot be written.
    """
    from crowdbot.core import InputError, explain_write_errors
    from crowdbot.data import folder_files

    if not (path.is_file() or path.is_dir()):
        raise InputError(f"there is no file {path.name!r} in {path.parent}")
    if beside.resolve() == path.resolve():
        return False
    pairs = [(path, beside)] if path.is_file() else [(file, beside / file.name) for file in folder_files(path)]
    if beside.exists():
        held = [beside] if beside.is_file() else folder_files(beside)
        if held != [copy for _, copy in pairs] or any(copy.read_bytes() != file.read_bytes() for file, copy in pairs):
            raise InputError(f"{beside} exists with a different content; write the trial to another folder")
        return False
    try:
        with explain_write_errors(beside):
            if path.is_dir():
                beside.mkdir()
            for file, copy in pairs:
                copy.write_bytes(file.read_bytes())
    except InputError:
        _remove(beside)
        raise
    return True


def _remove(copy: Path) -> None:
    """Remove a copy of a file or a folder."""
    if copy.is_dir():
        shutil.rmtree(copy)
    else:
        copy.unlink(missing_ok=True)


def _import_trials(options: argparse.Namespace) -> int:
    """Write the trials of a file of another simulator; return 2 if one cannot run as it is, like ``check``."""
    from crowdbot.core import TrialError
    from crowdbot.trials import check_trial, import_trial, trial_xml

    done = import_trial(options.original, options.root, options.layer, options.unit or "")
    problems: list[str] = []
    for k, (name, trial) in enumerate(done.trials):
        single = len(done.trials) == 1
        file = options.file if single else options.file.with_stem(f"{options.file.stem}-{k + 1:02d}-{Path(name).stem}")
        if trial.stage.building and _copy_beside(options.original, file.parent / options.original.name):
            print(COPIED.format(options.original.name))
        for copy in (*_copy_map(trial, file.parent), *_copy_trees(trial, file.parent)):
            print(COPIED.format(copy))
        _write(file, trial_xml(trial))
        print(f"wrote {file}")
        try:
            check_trial(trial)
        except TrialError as error:
            problems += [f"{file.name}: {sentence}" for sentence in error.problems]
    for title, rows in (("not imported", done.left_out), ("errors, mend them before a run", problems)):
        if rows:
            print(f"{title}:")
            for sentence in rows:
                print(f"  - {sentence}")
    return 2 if problems else 0


def _copy_map(trial: Trial, folder: Path) -> list[str]:
    """Copy the files of the map of an imported trial to its folder; return the names of those that were not there."""
    from crowdbot.trials import map_files

    if not trial.stage.map:
        return []
    copied = []
    for name, path in map_files(trial.stage.map, trial.stage.folder, trial.stage.trust).items():
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        copied += [name] if _copy_beside(path, folder / name) else []
    return copied


def _copy_trees(trial: Trial, folder: Path) -> list[str]:
    """Copy the behaviour trees of an imported trial to its folder; return the names of those that were not there."""
    copied = []
    for behavior in {one.file: one for agent in trial.agents for one in agent.behaviors}.values():
        home = (behavior.folder or Path.cwd()).resolve()
        for path in behavior.files():
            name = path.relative_to(home).as_posix()
            (folder / name).parent.mkdir(parents=True, exist_ok=True)
            copied += [name] if _copy_beside(path, folder / name) else []
    return copied


def _write(file: Path, content: str | bytes) -> None:
    """Write a file atomically."""
    from crowdbot.core import InputError

    part = file.with_name(file.name + ".part")
    try:
        file.parent.mkdir(exist_ok=True)
        part.write_bytes(content.encode() if isinstance(content, str) else content)
        part.replace(file)
    except OSError as error:
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)
        raise InputError(f"cannot write {file}: {error.strerror or error}") from None


def _add_body_options(parser: CommandParser) -> None:
    """Declare the options of a body."""
    group = parser.add_rare_group("body")
    group.add_argument("--height", type=float, metavar="M", help="stature in metres (default: that in the file)")
    group.add_argument(
        "--mass", type=float, metavar="KG", help="mass in kg (default: from the stature, with the mean body mass index)"
    )


def _write_clip_file(options: argparse.Namespace) -> int:
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
    _write(out, write_clip(clip))
    kind = "a cycle of a gait, in step with the way" if clip.cyclic else "played in time"
    print(f"{out}: {len(clip.lift)} frames at {clip.rate:g} Hz, {len(clip.bones)} bones, {kind}")
    print(f'use it    <agent activity="{out.name}" .../> in a trial beside it')
    return 0


def _write_body_file(options: argparse.Namespace) -> int:
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
