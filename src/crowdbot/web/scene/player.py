"""Player: a recorded episode as one HTML file that plays without a server."""

from __future__ import annotations

import base64
import gzip
import html
import json
import struct
from collections.abc import Callable, Sequence
from importlib import resources
from pathlib import Path
from typing import Any, NamedTuple

from crowdbot.core import InputError, lock_output
from crowdbot.recording import RecordedEpisode, open_rerun, read_episode
from crowdbot.simulation import Simulation, SimulationRun

from .camera_images import encode_image, image_descriptions, sensor_images
from .description import scene_description
from .episode_events import EpisodeEvent, episode_events
from .frame import LAYERS, scene_frame
from .meshes import scene_resource

SHOWN = ("scans", "ranges", "forces", "goals")
"""Layers in a file."""
LEVELS = (1, 2)
"""Levels of detail of bodies in a file."""
LARGEST = 400_000_000
"""Largest size of the frames before compression [B]; a browser holds all of them."""


class PlayerFile(NamedTuple):
    """What was written: the path, the number of frames, the simulated time [s] and the size [B]."""

    path: Path
    frames: int
    seconds: float
    size: int


class _Pack:
    """Collects the files and frames of an episode.

    A pack is the length of a JSON text (uint32), the text, a list of names and lengths, and the parts one after the
    other, all of it compressed by gzip.
    """

    def __init__(self) -> None:
        self.parts: list[tuple[str, bytes]] = []
        self.size = 0
        self._known: set[str] = set()

    def add(self, name: str, data: bytes) -> None:
        """Add a file once."""
        if name not in self._known:
            self._known.add(name)
            self.parts.append((name, data))

    def add_frame(self, data: bytes) -> None:
        """Add a frame."""
        self.parts.append(("frame", data))
        self.size += len(data)

    def encode(self) -> str:
        """Return the pack as base64 text."""
        names = json.dumps([(name, len(data)) for name, data in self.parts]).encode()
        whole = b"".join((struct.pack("<I", len(names)), names, *(data for _, data in self.parts)))
        return base64.b64encode(gzip.compress(whole, 6, mtime=0)).decode()


def write_player(
    episode: Path | str,
    to: Path | str,
    *,
    period: float | None = None,
    force: bool = False,
    trust: bool = False,
    folder: Path | None = None,
    images: bool = False,
    progress: Callable[[float], None] | None = None,
) -> PlayerFile:
    """Write an episode as one HTML file that plays in any browser, without a server and without the net.

    The episode runs again with its seed and its orders, with bodies of people. Between two frames the page blends.
    Images of cameras are those of the records, if they are wanted.

    Args:
        episode: the episode, which is not a branch.
        to: the file, ``.html``.
        period: time between two frames [s] (default: that of the recording), a multiple of the time step.
        force: whether an existing file is replaced.
        trust, folder: see :func:`crowdbot.recording.replay`.
        images: whether the file holds the images of cameras.
        progress: called with the completed fraction, 0 to 1.

    Raises:
        InputError: ``to`` exists or is not HTML, the period does not fit, or the episode is too long for one file.
        EpisodeError: the episode cannot be read or run again.

    >>> import tempfile
    >>> from crowdbot.recording import record
    >>> from crowdbot.trials import load_trial
    >>> folder = Path(tempfile.mkdtemp())
    >>> summary = record(load_trial("frontal", duration=1.0), out=folder)
    >>> write_player(folder / "episode.mcap", folder / "player.html").frames
    11
    """
    path = Path(to)
    if path.suffix.lower() != ".html":
        raise InputError(f"{path}: the file of a player must end in .html")
    recorded = read_episode(episode)
    pack, frames, last = _Pack(), 0, 0.0
    with lock_output(path, force), open_rerun(episode, folder=folder, trust=trust) as rerun:
        simulation = Simulation(rerun.trial, rerun.seed, posed=True)
        rerun.prepare(simulation)
        schedule = simulation.world.clock.schedule(rerun.trial.recording.period if period is None else period)
        running = SimulationRun(simulation, sources=rerun.sources, ticks=recorded.steps)
        while True:
            if running.outcome is not None or schedule.is_due(simulation.ticks)[0]:
                _add_instant(pack, simulation)
                frames, last = frames + 1, float(simulation.world.times[0])
                if pack.size > LARGEST:
                    raise InputError(f"{episode} is too long for one file: its first {last:g} s need"
                                     f" {LARGEST / 1e6:g} MB; give a longer period")  # fmt: skip
            if running.outcome is not None:
                break
            running.step()
            if progress is not None:
                progress(simulation.tick / max(1, recorded.steps))
        shown = _add_images(pack, simulation, recorded) if images else []
        text = _page(pack, simulation, episode_events(recorded), shown)
        path.write_text(text, encoding="utf-8")
    return PlayerFile(path, frames, last, len(text.encode()))


def _add_instant(pack: _Pack, simulation: Simulation) -> None:
    frame = scene_frame(simulation, SHOWN)
    name = f"description/{int(frame.arrays['revision'][0])}.json"
    if name not in {known for known, _ in pack.parts if known.startswith("description/")}:
        found = scene_description(simulation)
        pack.add(name, json.dumps(found).encode())
        for robot in found["robots"]:
            pack.add(robot["mesh"], scene_resource(simulation, robot["mesh"], {}).data)
    pack.add_frame(frame.encode())


def _add_images(pack: _Pack, simulation: Simulation, recorded: RecordedEpisode) -> list[dict[str, Any]]:
    """Add the recorded images ``image/NUMBER/ROW``; return the description, type and times [s] of those of a number."""
    images: list[dict[str, Any]] = []
    for image, about in zip(sensor_images(simulation), image_descriptions(simulation), strict=True):
        times, kind = list[float](), ""
        for reading in recorded.readings.get(f"{image.control.robot.name}/{image.sensor.name}", ()):
            frame = encode_image(reading, image, "image")
            kind = "png" if "png" in frame.arrays else "jpeg"
            data = frame.arrays[kind].tobytes()
            pack.add(f"image/{len(images)}/{len(times)}", data)
            pack.size += len(data)
            times.append(frame.time)
            if pack.size > LARGEST:
                raise InputError(f"{recorded.name} is too long for one file: with its camera images it needs more than"
                                 f" {LARGEST / 1e6:g} MB")  # fmt: skip
        if times:
            images.append({"image": about, "type": f"image/{kind}", "times": times})
    return images


def _page(pack: _Pack, simulation: Simulation, events: Sequence[EpisodeEvent], images: Sequence[dict[str, Any]]) -> str:
    trial = simulation.trial
    for level in LEVELS:
        pack.add(f"bodies/{level}.bin", scene_resource(simulation, f"bodies/{level}.bin", {}).data)
    index: dict[str, Any] = {"name": trial.name, "about": trial.about, "layers": SHOWN, "optional": list(LAYERS)}
    index |= {"events": [event._asdict() for event in events], "images": images}
    pack.add("index.json", json.dumps(index).encode())
    folder = resources.files("crowdbot").joinpath("assets", "web")
    page, style, script, licenses = (
        folder.joinpath(name).read_text("utf-8") for name in ("player.html", "player.css", "player.js", "licenses.txt")
    )
    values = {
        "title": html.escape(trial.name),
        "style": style,
        "licenses": html.escape(licenses),
        "episode": pack.encode(),
        "script": script,
    }
    first, *rest = page.split("{{")
    pieces = [first]
    for part in rest:
        name, _, after = part.partition("}}")
        pieces += [values[name], after]
    return "".join(pieces)
