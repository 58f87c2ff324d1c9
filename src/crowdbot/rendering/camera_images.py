"""Images of a camera during a run of a trial."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, did_you_mean, import_optional, stream
from crowdbot.sensors import NOTHING, DepthCamera, RGBCamera, distort_image, spatial_pose
from crowdbot.simulation import OrderSource, RobotControl, Simulation, SimulationRun
from crowdbot.trials import OVERVIEW, Camera, Mount, Trial, check_trial, overview

SMOOTH = 0.04
"""Default time between two images of a video [s], rounded to time steps."""
STRIP, WIDEST = 5.0, 0.3
"""Width [pixels] of the strips on the tops of walls in the overview, and their largest width [m]."""


@dataclass(frozen=True, eq=False)
class RenderedImage:
    """One image.

    Fields:
        time: simulated time [s].
        rgb: ``[H, W, 3]`` red, green, blue from 0 to 255.
        depth: ``[H, W]`` [m] along the axis of the camera, infinite without a surface; None if not requested.
        segmentation: ``[H, W]`` id of the person or robot; -1 background, -2 wall, -3 floor, -4 prop; None if not
            requested.
    """

    time: float
    rgb: NDArray[np.uint8]
    depth: NDArray[np.float64] | None = None
    segmentation: NDArray[np.int64] | None = None


class RenderRequest(NamedTuple):
    """Times of images: from ``begin`` to ``end`` [s] at a ``rate`` [Hz].

    Without an end, there is one image. The default rate is about 25 Hz, depending on the time step.
    """

    begin: float = 0.0
    end: float | None = None
    rate: float | None = None


def camera_names(trial: Trial) -> tuple[str, ...]:
    """Return the cameras of a trial: its cameras, ``overview``, and cameras of robots as ``robot/sensor``.

    >>> from crowdbot.trials import load_trial
    >>> camera_names(load_trial("frontal"))
    ('overview',)
    """
    own = [camera.name for camera in trial.cameras]
    carried = [f"{robot.name}/{mount.name}" for robot in trial.robots for mount in robot.sensors if _looks(mount)]
    return (*own, *([] if OVERVIEW in own else [OVERVIEW]), *carried)


def render_images(
    trial: Trial,
    camera: str | None = None,
    take: RenderRequest = RenderRequest(),  # noqa: B008
    *,
    seed: int | None = None,
    depth: bool = False,
    segmentation: bool = False,
    progress: Callable[[float], None] | None = None,
    sources: Sequence[OrderSource] = (),
    prepare: Callable[[Simulation], None] | None = None,
) -> Iterator[RenderedImage]:
    """Run a trial and yield images of a camera.

    Args:
        trial: the trial, without sweeps.
        camera: see :func:`camera_names`; default: the first camera of the trial, or the overview.
        take: times of the images.
        seed: random seed (default: the seed of the trial).
        depth, segmentation: whether to render these images, too.
        progress: called with the completed fraction, 0 to 1.
        sources: programs that steer the simulation, or the recorded orders of an episode.
        prepare: called with the simulation before its first step.

    Raises:
        InputError: the camera is unknown, no OpenGL backend works, or the run ends before the first image or with an
            exception.
        MissingExtra: mujoco is not installed.

    >>> from crowdbot.trials import load_trial
    >>> [shot.rgb.shape for shot in render_images(load_trial("frontal"), take=RenderRequest(1.0))]
    [(600, 960, 3)]
    """
    chosen = trial.seed if seed is None else int(seed)
    check_trial(trial, chosen)
    name = camera or camera_names(trial)[0]
    _check_drawing(trial, name)
    simulation = Simulation(trial, chosen, posed=True)
    ticks = _ticks(simulation, take)
    first, last = ticks[0], ticks[-1]
    if prepare is not None:
        prepare(simulation)
    running = SimulationRun(simulation, sources=sources)
    lens = SimulationCamera(simulation, name, chosen, depth, segmentation)
    for tick in ticks:
        while simulation.tick < tick and running.outcome is None:
            running.step()
            if progress is not None:
                progress(simulation.tick / max(1, last))
        if simulation.failures[0] is not None:
            raise InputError(f"cannot render {trial.name}: the trial ended with an error: {simulation.failures[0]}")
        if simulation.tick < tick:
            break
        yield lens.shot()
    if simulation.tick < first:
        time = simulation.world.clock.time
        raise InputError(f"{trial.name} ended at {time:g} s ({running.outcome}), before the image at"
f" {take.begin:g} s; give an earlier time")  # fmt: skip
    if progress is not None:
        progress(1.0)


def _ticks(simulation: Simulation, take: RenderRequest) -> Sequence[int]:
    """Return the ticks of the images; image k of a video is at the first tick at or after its time."""
    clock, lasts = simulation.world.clock, simulation.trial.duration
    for value in (take.begin, take.begin if take.end is None else take.end):
        if not 0.0 <= value <= lasts:
            raise InputError(f"there is no image at {value:g} s: {simulation.trial.name} lasts from 0 to {lasts:g} s")
    first = round(take.begin / clock.dt)
    if take.end is None:
        return (first,)
    if take.end < take.begin:
        raise InputError(f"the end of the video ({take.end:g} s) must be after its start ({take.begin:g} s)")
    last = round(take.end / clock.dt)
    if take.rate is None:
        return range(first, last + 1, max(1, math.ceil(SMOOTH / clock.dt - 1e-9)))
    if not 0.0 < take.rate < math.inf:
        raise InputError(f"the rate {take.rate:g} Hz must be finite and above 0")
    try:
        schedule = clock.schedule(1.0 / take.rate)
    except InputError:
        raise InputError(
            f"the rate {take.rate:g} Hz gives a period of {1.0 / take.rate:g} s, which is shorter than the time step"
            f" {clock.dt:g} s; the highest possible rate is {1.0 / clock.dt:g} Hz"
        ) from None
    return [first + schedule.tick_of(k) for k in range(schedule.index(last - first) + 1)]


def _check_drawing(trial: Trial, name: str) -> None:
    """Check that the trial has the camera and that rendering works."""
    known = camera_names(trial)
    if name not in known:
        raise InputError(f"{trial.name} has no camera {name!r}{did_you_mean(name, known)}; it has {', '.join(known)}")
    import_optional("mujoco", "an image of a trial", "sim")


def _strip_width(camera: Camera) -> float:
    """Return the width [m] of the strips on the tops of walls that shows in an image from above."""
    pixel = camera.z / math.sin(camera.pitch) * 2.0 * math.tan(0.5 * camera.field_of_view) / camera.width
    return min(STRIP * pixel, WIDEST)


def _looks(mount: Mount) -> bool:
    return isinstance(mount.sensor, RGBCamera | DepthCamera)


class SimulationCamera:
    """A camera of a running simulation with one environment.

    Args:
        simulation: the simulation, with body poses (``posed=True``).
        name: a name of :func:`camera_names`.
        seed: seed of the noise of a camera of a robot.
        depth, segmentation: whether to render these images, too.

    Raises:
        InputError: the camera is unknown.
        MissingExtra: mujoco is not installed.

    >>> from crowdbot.trials import load_trial
    >>> simulation = Simulation(load_trial("frontal"), 0, posed=True)
    >>> simulation.begin()
    >>> SimulationCamera(simulation, "overview").shot().rgb.shape
    (600, 960, 3)
    """

    def __init__(
        self, simulation: Simulation, name: str, seed: int = 0, depth: bool = False, segmentation: bool = False
    ) -> None:
        _check_drawing(simulation.trial, name)
        self.simulation, self.depth, self.segmentation = simulation, depth, segmentation
        self.rng = stream(seed, "render", name)
        self.control: RobotControl | None = None
        own = {camera.name: camera for camera in simulation.trial.cameras}
        robot, _, self.sensor = name.partition("/")
        if self.sensor:
            self.control = next(item for item in simulation.robots if item.robot.name == robot)
            return
        scene = simulation.world.scene
        self.camera: Camera = own[name] if name in own else overview(
            simulation.trial.stage, scene.position[0, scene.active[0]])  # fmt: skip
        self.agent = next((c.agent for c in simulation.robots if c.robot.name == self.camera.robot), None)

    def shot(self) -> RenderedImage:
        """Return the current image."""
        rgb, depth, who = self._by_sensor() if self.control else self._standing()
        ids = self.simulation.world.ids[0]
        named = None if who is None else np.where(who >= 0, ids[np.maximum(who, 0)], who)
        return RenderedImage(self.simulation.world.clock.time, rgb, depth, named)

    def _standing(self) -> tuple[Any, Any, Any]:
        view = self.camera.view(self.agent)
        if self.camera.name == OVERVIEW and self.camera not in self.simulation.trial.cameras:
            view = replace(view, wall_tops=_strip_width(self.camera))
        images = self.simulation.world.renderer.images(view, depth=self.depth, segmentation=self.segmentation)
        return (
            images.rgb,
            None if images.depth is None else images.depth.astype(np.float64),
            None if images.segmentation is None else images.segmentation.astype(np.int64),
        )

    def _by_sensor(self) -> tuple[Any, Any, Any]:
        assert self.control is not None
        around = self.simulation.around
        probe = next(sensor for sensor in self.control.sensors if sensor.mount.name == self.sensor)
        sensor: Any = probe.mount.sensor
        camera = sensor if isinstance(sensor, RGBCamera) else RGBCamera(
            width=sensor.width, height=sensor.height, field_of_view=sensor.field_of_view, distortion=sensor.distortion,
            near=max(0.05, 0.25 * sensor.range_min),  # clip the housing around the lens
            renderer="software", shadows=True, antialiasing=4,
        )  # fmt: skip
        pose, studio = probe.pose(self.control.agent, around), self.simulation.world.environment_renderer(0)
        picture = camera.read(around.flat, pose, self.rng, studio)
        if not (self.depth or self.segmentation):
            return picture.rgb[0], None, None
        images = studio.render(replace(camera, segmentation=True), spatial_pose(pose))
        depth = distort_image(images["depth"], camera.lens, np.inf)[0] if self.depth else None
        who = distort_image(images["hit"], camera.lens, NOTHING)[0] if self.segmentation else None
        return picture.rgb[0], depth, who
