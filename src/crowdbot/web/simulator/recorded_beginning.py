"""RecordedBeginning: the first trial as it was simulated once, shown while the simulation is prepared."""

from __future__ import annotations

import functools
import io
import json
import lzma
from collections.abc import Sequence
from importlib import resources
from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.humans import shapes
from crowdbot.simulation import Simulation, SimulationRun
from crowdbot.trials import Trial
from crowdbot.typing import Floats
from crowdbot.web.desk import Resource
from crowdbot.web.scene import WalkingBodies, scene_description, scene_frame, scene_resource, scene_revision
from crowdbot.web.state_frame import StateFrame

Arrays = dict[str, NDArray[Any]]
FILE = "first-trial.xz"
MILLIMETRE = 1e-3
BONE = 1023
"""Quaternions of bones relative to their parents are stored in units of 1 / BONE, 0.1 degrees."""
SENT = 32767.0
"""Unit of the quaternions in a state frame."""
PERIOD = 0.2
"""Time between two frames [s]; the page blends them."""


class RecordedBeginning:
    """Frames, description and meshes of a trial that was simulated once.

    The run that is prepared meanwhile is the same to the last bit, so it can go on where the recording is.

    Args:
        arrays: as from :func:`record`: ``times`` ``[T]`` [s], ``present`` and ``ids`` ``[T, N]``, ``place``
            ``[T, N, 5]`` and ``pelvis`` ``[T, N, 3]`` in millimetres and milliradians, ``root`` ``[T, N, 4]`` the
            quaternion of the first bone, ``joints`` ``[T, N, 27, 3]`` x, y, z of those of the others relative to their
            parents, ``botplace``, ``links``, and bytes ``description`` and ``meshes``.

    >>> beginning = shipped_beginning()
    >>> beginning.frame(0, revision=7).arrays["bones"].shape[1]
    112
    """

    def __init__(self, arrays: Arrays) -> None:
        self._arrays = arrays
        self.times: Floats = arrays["times"].astype(np.float64)
        """Time of each frame [s]."""
        self._description = json.loads(arrays["description"].tobytes())

    def __len__(self) -> int:
        return len(self.times)

    @property
    def seconds(self) -> float:
        """Time of the last frame [s]."""
        return float(self.times[-1])

    def revision(self, trial: Trial) -> int:
        """Return the revision that the description of a simulation of the trial will have."""
        people = SimpleNamespace(agents=self._arrays["ids"][0])
        return scene_revision(SimpleNamespace(trial=trial), people)

    def description(self, revision: int) -> dict[str, Any]:
        """Return the description of the scene, see :func:`crowdbot.web.scene_description`."""
        return {**self._description, "revision": revision}

    def resource(self, path: str) -> Resource:
        """Return a mesh of the scene.

        Raises:
            KeyError: there is no such mesh.
        """
        names = [item["mesh"] for item in self._description["robots"]]
        if path in names:
            ends = self._arrays["meshends"]
            place = names.index(path)
            return Resource(self._arrays["meshes"][ends[place] : ends[place + 1]].tobytes())
        return scene_resource(SimpleNamespace(robots=()), path, {})

    def frame(self, index: int, revision: int) -> StateFrame:
        """Return a frame, see :func:`crowdbot.web.scene_frame`."""
        own = self._arrays
        who = np.flatnonzero(own["present"][index])
        place = own["place"][index, who].astype(np.float32) * np.float32(MILLIMETRE)
        pelvis = own["pelvis"][index, who].astype(np.float32) * np.float32(MILLIMETRE)
        pelvis[:, :2] += place[:, :2]
        arrays: Arrays = {
            "revision": np.array([revision], dtype=np.uint32),
            "who": who.astype(np.uint16),
            "ids": own["ids"][index, who],
            "place": place,
            "pelvis": pelvis,
            "bones": _bones(own["root"][index, who], own["joints"][index, who]),
            "bots": own["bots"],
            "botplace": own["botplace"][index],
            "links": own["links"][index],
        }
        return StateFrame("scene", float(self.times[index]), arrays)

    def encode(self) -> bytes:
        """Return the bytes of a file."""
        buffer = io.BytesIO()
        np.savez(buffer, **self._arrays)  # type: ignore[arg-type]
        return lzma.compress(buffer.getvalue(), preset=9)

    @staticmethod
    def decode(data: bytes) -> RecordedBeginning:
        """Return the recording in ``data``."""
        with np.load(io.BytesIO(lzma.decompress(data))) as found:
            return RecordedBeginning(dict(found))

    @staticmethod
    def record(trial: Trial, seed: int, seconds: float) -> RecordedBeginning:
        """Simulate a trial, to which nobody comes later, for some seconds or up to its end."""
        simulation = Simulation(trial, seed)
        run = SimulationRun(simulation)
        bodies, frames = WalkingBodies(simulation), list[StateFrame]()
        description = scene_description(simulation, bodies.motion)
        schedule = simulation.world.clock.schedule(PERIOD)
        while run.outcome is None and float(simulation.world.times[0]) < seconds:
            bodies.follow(simulation)
            if schedule.is_due(simulation.ticks)[0]:
                frames.append(scene_frame(simulation, (), bodies.motion))
            run.step()
        meshes = [scene_resource(simulation, item["mesh"], {}).data for item in description["robots"]]
        return RecordedBeginning(_packed(frames, description, meshes))


@functools.cache
def shipped_beginning() -> RecordedBeginning:
    """Return the recording of the first trial of the app."""
    return RecordedBeginning.decode(resources.files("crowdbot").joinpath("assets", "app", FILE).read_bytes())


def _packed(frames: Sequence[StateFrame], description: dict[str, Any], meshes: Sequence[bytes]) -> Arrays:
    count = len(description["people"]["body"])
    present, ids = np.zeros((2, len(frames), count), dtype=np.int32)
    rows = {name: np.zeros((*present.shape, size)) for name, size in (("place", 5), ("pelvis", 3), ("bones", 112))}
    for at, frame in enumerate(frames):
        who = frame.arrays["who"]
        present[at, who], ids[at, who] = 1, frame.arrays["ids"]
        for name, values in rows.items():
            values[at, who] = frame.arrays[name]
    rows["pelvis"][..., :2] -= rows["place"][..., :2]
    return {
        "times": np.array([frame.time for frame in frames], dtype=np.float32),
        "present": present.astype(bool), "ids": ids, "bots": frames[0].arrays["bots"],
        "place": np.round(rows["place"] / MILLIMETRE).astype(np.int16),
        "pelvis": np.round(rows["pelvis"] / MILLIMETRE).astype(np.int16),
        "root": rows["bones"][..., :4].astype(np.int16), "joints": _joints(rows["bones"]),
        "botplace": np.stack([frame.arrays["botplace"] for frame in frames]),
        "links": np.stack([frame.arrays["links"] for frame in frames]),
        "description": np.frombuffer(json.dumps(description).encode(), dtype=np.uint8),
        "meshes": np.frombuffer(b"".join(meshes), dtype=np.uint8),
        "meshends": np.cumsum([0, *map(len, meshes)]),
    }  # fmt: skip


def _joints(bones: Floats) -> NDArray[np.int16]:
    """Return x, y, z of the quaternions ``[T, N, 27, 3]`` relative to the parents; w is not negative."""
    world = bones.reshape(*bones.shape[:2], -1, 4) / SENT
    parents = list(shapes().parents)[1:]
    found = _product(world[..., parents, :] * (1.0, -1.0, -1.0, -1.0), world[..., 1:, :])
    found *= np.where(found[..., :1] < 0.0, -1.0, 1.0)
    return np.round(found[..., 1:] * BONE).astype(np.int16)


def _bones(root: NDArray[np.int16], joints: NDArray[np.int16]) -> NDArray[np.int16]:
    """Return the quaternions of a frame ``[N, 112]`` from those of :func:`_packed`."""
    xyz = joints / BONE
    w = np.sqrt(np.maximum(0.0, 1.0 - (xyz**2).sum(axis=-1, keepdims=True)))
    world = np.concatenate([root[:, None] / SENT, np.concatenate([w, xyz], axis=-1)], axis=1)
    for bone, parent in enumerate(shapes().parents):
        if parent >= 0:
            world[:, bone] = _product(world[:, parent], world[:, bone])
    world /= np.linalg.norm(world, axis=-1, keepdims=True)
    largest = np.take_along_axis(world, np.abs(world).argmax(axis=-1)[..., None], axis=-1)
    world *= np.where(largest < 0.0, -1.0, 1.0)
    return np.round(world * SENT).astype(np.int16).reshape(len(joints), -1)


def _product(a: Floats, b: Floats) -> Floats:
    """Return the product of quaternions w, x, y, z."""
    w, x, y, z = np.moveaxis(a, -1, 0)
    t, u, v, s = np.moveaxis(b, -1, 0)
    parts = (
        w * t - x * u - y * v - z * s,
        w * u + x * t + y * s - z * v,
        w * v - x * s + y * t + z * u,
        w * s + x * v - y * u + z * t,
    )
    return np.stack(parts, axis=-1)
