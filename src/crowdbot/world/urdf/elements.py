"""UrdfReader: shared parts of the URDF parser for problems with line numbers, numbers, frames and meshes."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np

from crowdbot.core import Element, InputError, RobotError, parse_number
from crowdbot.typing import Floats

from .folders import Folders
from .mesh_files import MeshFiles
from .meshes import Submesh, read_mesh, with_pieces
from .model import Remark
from .shapes import Mesh
from .transforms import frame, roll_pitch_yaw

MOST_PROBLEMS = 100
LARGEST = 1e6
"""Largest number of a row, and length [m] of a shape."""
Color = tuple[float, float, float, float]


class UrdfReader:
    """Collects problems and remarks while parsing a URDF.

    Args:
        place: file name for messages.
        folders: folders from which files may be read.
        colliders: conversion of meshes to convex shapes.
    """

    def __init__(self, place: str, folders: Folders, colliders: str) -> None:
        self.place, self.folders, self.colliders = place, folders, colliders
        self.found: list[tuple[int, str]] = []
        self.remarks: list[Remark] = []
        self.files: dict[str, Path] = {}
        self.textures: dict[str, dict[str, Path]] = {}
        self.materials: dict[str, Color] = {}
        self.mean_colors: dict[str, Color | None] = {}
        self.friction: dict[str, float] = {}
        self.springs: dict[str, dict[str, float]] = {}
        self.motors: dict[str, str] = {}
        self.missing: dict[str, set[str]] = {}
        self._read: dict[tuple[str, tuple[float, float, float], Submesh], Mesh | str] = {}

    def say(self, element: Element, sentence: str) -> None:
        """Record an error."""
        self.found.append((element.line, f"{self._where(element)} {sentence}"))

    def remark(self, kind: str, element: Element, sentence: str) -> None:
        """Record something that was ``replaced``, ``repaired`` or ``ignored``."""
        self.remarks.append(Remark(kind, f"{self._where(element)} {sentence}"))

    def _where(self, element: Element) -> str:
        name = element.attributes.get("name", "")
        named = f" {name[:60]!r}" if name and element.tag in ("link", "joint") else ""
        place = element.place or self.place  # an element of a xacro file knows its own file
        return f"{place}:{element.line}: <{element.tag[:40]}>{named}"

    def finish(self) -> None:
        """Raise :class:`RobotError` if there are errors."""
        sentences = [sentence for _, sentence in sorted(self.found, key=lambda row: row[0])]
        if len(sentences) > MOST_PROBLEMS:
            more = len(sentences) - MOST_PROBLEMS
            sentences = [*sentences[:MOST_PROBLEMS], f"{self.place}: and {more} more problems"]
        if sentences:
            raise RobotError(*sentences)

    def new(self, element: Element, name: str, known: Iterable[str]) -> bool:
        """Return whether a name is new; record an error if it is not."""
        if name in known:
            self.say(element, "has a name that is already in use; names must be unique")
            return False
        return True

    def first(self, element: Element, tag: str) -> Element | None:
        """Return the first child with this tag, as the parser of ROS does, or None; remark on others."""
        found = element.each(tag)
        if len(found) > 1:
            self.remark("ignored", found[1], f"occurs more than once in <{element.tag}>; the first one is used")
        return found[0] if found else None

    def value(self, element: Element, key: str, default: float | None = None, least: float = -np.inf) -> float | None:
        """Return a finite number from an attribute, or the default; record an error if it is invalid."""
        text = element.attributes.get(key)
        if text is None:
            return default
        try:
            number = parse_number(text)
        except InputError as error:
            self.say(element, f'{key}="{text[:40]}" {error}')
            return default
        if number < least:
            self.say(element, f'{key}="{text[:40]}" must be at least {least:g}')
            return default
        return number

    def optional_value(self, element: Element, key: str, least: float = -np.inf) -> float:
        """Return the number of an attribute that few robots have; 0 without one, or with a remark if it is invalid."""
        text = element.attributes.get(key, "0")
        try:
            number = parse_number(text)
            if number >= least:
                return number
            problem = f"must be at least {least:g}"
        except InputError as error:
            problem = str(error)
        self.remark("ignored", element, f'{key}="{text[:40]}" {problem}; it is ignored')
        return 0.0

    def required_value(self, element: Element, key: str, least: float = -np.inf) -> float | None:
        """Return a required number; record an error and return None if it is invalid or missing."""
        if key not in element.attributes:
            self.say(element, f"needs the attribute {key!r}, a number")
        return self.value(element, key, None, least)

    def row(self, element: Element, key: str, count: int, default: tuple[float, ...] | None) -> Floats | None:
        """Return ``count`` finite numbers from an attribute, or the default; None if they are invalid."""
        text = element.attributes.get(key)
        if text is None:
            return None if default is None else np.array(default)
        words = text.split()
        if len(words) != count:
            self.say(element, f'{key}="{text[:40]}" must be {count} numbers')
            return None
        try:
            values = np.array([parse_number(word) for word in words])
        except InputError as error:
            self.say(element, f'{key}="{text[:60]}" {error}')
            return None
        if np.abs(values).max() > LARGEST:
            self.say(element, f'{key}="{text[:60]}" contains a number above {LARGEST:g}')
            return None
        return values

    def origin(self, element: Element) -> Floats:
        """Return the frame ``[4, 4]`` of <origin xyz rpy>; the identity without one."""
        origin = self.first(element, "origin")
        if origin is None:
            return np.eye(4)
        place, angles = self.row(origin, "xyz", 3, (0.0,) * 3), self.row(origin, "rpy", 3, (0.0,) * 3)
        if place is None or angles is None:
            return np.eye(4)
        return frame(place, roll_pitch_yaw(*angles))

    def mesh(self, element: Element, collision: bool) -> Mesh | str | None:
        """Return the mesh of <mesh>, the reason why it is unavailable, or None after an error.

        The attributes ``submesh`` and ``center`` stand for <submesh> of SDF.

        Raises:
            MissingExtra: trimesh is not installed.
        """
        source = element.attributes.get("filename", "").strip()
        if not source:
            self.say(element, "needs the attribute 'filename'")
            return None
        scale = self.row(element, "scale", 3, (1.0, 1.0, 1.0))
        if scale is None:
            return None
        if np.any(scale == 0.0):
            self.say(element, f'scale="{element.attributes["scale"][:40]}" must not be 0')
            return None
        try:
            path = self.folders.find(source)
        except InputError as error:  # a path of another computer, for example
            return f"the mesh file {error}"
        factors = (float(scale[0]), float(scale[1]), float(scale[2]))
        part = Submesh(element.attributes.get("submesh", "").strip(), element.attributes.get("center") == "true")
        return self._load_trimesh(element, source, path, factors, part, collision)

    def _load_trimesh(
        self,
        element: Element,
        source: str,
        path: Path | None,
        scale: tuple[float, float, float],
        part: Submesh,
        collision: bool,
    ) -> Mesh | str:
        if path is None:
            package = self.folders.missing_package(source)
            if package:
                self.missing.setdefault(package, set()).add(source)
            return f"the mesh file {source[:200]} is missing"
        key = (str(path), scale, part)
        if key not in self._read:
            try:
                files = MeshFiles(self.folders, path)
                self._read[key] = read_mesh(path, source, scale, files, part)
                self.files[source] = path
                self.textures[source] = files.found
                for sentence in files.remarks:
                    self.remark("ignored", element, sentence)
            except (InputError, OSError) as error:
                self._read[key] = f"the mesh {source[:200]} cannot be used: {error}"
        mesh = self._read[key]
        if isinstance(mesh, str) or not collision or mesh.pieces:
            return mesh
        whole, coarse = with_pieces(mesh, self.colliders)
        self._read[key] = whole
        if coarse:
            self.remark("replaced", element, f"the mesh {source[:200]} {coarse}")
        return whole

    def notes(self, root: Element) -> None:
        """Read the elements beside links and joints: friction and springs of Gazebo, motors of transmissions."""
        for gazebo in root.each("gazebo"):
            name = gazebo.attributes.get("reference", "")
            for tag in ("mu1", "mu"):
                for inner in gazebo.each(tag):
                    self.friction[name] = self._text(inner, self.friction.get(name, 1.0))
            for tag in ("springStiffness", "springReference"):
                for inner in gazebo.each(tag):
                    self.springs.setdefault(name, {})[tag] = self._text(inner, 0.0)
        for transmission in root.each("transmission"):
            for joint in transmission.each("joint"):
                for interface in joint.each("hardwareInterface"):
                    self._motor(joint, interface.stray)
        for control in root.each("ros2_control"):
            for joint in control.each("joint"):
                for interface in joint.each("command_interface"):
                    self._motor(joint, interface.attributes.get("name", ""))

    def _motor(self, joint: Element, words: str) -> None:
        kind = next((kind for kind in ("velocity", "position", "effort") if kind in words.lower()), "")
        if kind:
            self.motors.setdefault(joint.attributes.get("name", ""), kind)

    def _text(self, element: Element, default: float) -> float:
        """Return the number between the tags. In these extensions an invalid number gives only a remark."""
        text = element.stray or element.attributes.get("value", "")
        try:
            return max(0.0, parse_number(text)) if element.tag != "springReference" else parse_number(text)
        except InputError:
            self.remark("ignored", element, f"contains {text[:40]!r}, which is not a number; it is ignored")
            return default
