"""Description of a scene: everything that does not move, for a page that draws it."""

from __future__ import annotations

import zlib
from typing import Any

import numpy as np

from crowdbot.humans import region_colors, shapes, worn_parts
from crowdbot.sensors import DepthCamera, Infrared, Lidar2D, Lidar3D, RGBCamera, Ultrasound
from crowdbot.simulation import Simulation
from crowdbot.world import PeopleMotion, Robot, worlds_of

from .camera_images import image_descriptions
from .frame import LAYERS
from .meshes import shown_links
from .scene_revision import scene_revision
from .sensor_arrays import cone_angle
from .stage_description import scene_bounds, scene_focus, stage_description, zone_descriptions

KINDS: dict[type, str] = {
    Lidar2D: "scan", Lidar3D: "cloud", Ultrasound: "cone", Infrared: "cone", RGBCamera: "camera", DepthCamera: "camera",
}  # fmt: skip


def scene_description(simulation: Simulation, people: PeopleMotion | None = None) -> dict[str, Any]:
    """Return what a page needs to draw a simulation, as JSON; the page asks again when the revision changes.

    Keys: ``revision``; ``name``, ``about``, ``world``, ``duration``; ``bounds`` x0, y0, x1, y1 and ``focus`` x, y [m];
    ``stage`` (walls, ground, doors, props); ``zones``; ``regions`` and ``parts`` of bodies; ``people`` with lists for
    all people: ``body`` (row of the asset), ``kind`` (its name), ``scale``, ``height`` [m], ``colors`` (six digits for
    each region), ``cuts`` (of shirt, sleeves and trousers: 0 tight, 1 long, 2 short), ``parts`` (bits of the parts that
    are worn), ``radius`` [m] and ``rider``; ``robots``; ``sensors``; ``images`` of cameras, see
    :func:`image_descriptions`; ``layers`` (names and titles of :data:`crowdbot.web.scene.LAYERS`).

    Args:
        simulation: the simulation.
        people: bodies and gaits, for a simulation without them.

    >>> from crowdbot.trials import load_trial
    >>> found = scene_description(Simulation(load_trial("frontal"), posed=True))
    >>> found["robots"][0]["type"], found["people"]["kind"], found["stage"]["height"]
    ('cylinder', ['man-72'], 2.5)
    """
    motion = people or worlds_of(simulation.world)[0].people
    trial = simulation.trial
    return {
        "revision": 0 if motion is None else scene_revision(simulation, motion),
        "name": trial.name,
        "about": trial.about,
        "world": trial.world,
        "duration": trial.duration,
        "bounds": scene_bounds(simulation),
        "focus": scene_focus(simulation),
        "stage": stage_description(trial.stage),
        "zones": zone_descriptions(trial),
        "regions": list(shapes().regions),
        "parts": list(shapes().parts),
        "people": _people(simulation, motion) if motion is not None else {},
        "robots": [_robot(robot, simulation) for robot in simulation.robots],
        "sensors": [
            _sensor(robot, sensor) for robot, item in enumerate(simulation.robots) for sensor in item.sensors
        ],
        "images": image_descriptions(simulation),
        "layers": [{"name": name, "title": title} for name, title in LAYERS.items()],
    }  # fmt: skip


def _people(simulation: Simulation, motion: PeopleMotion) -> dict[str, Any]:
    people = motion.people
    body, scale = people.asset_rows
    riders = np.isin(motion.agents, [robot.agent for robot in simulation.robots])
    return {
        "body": body.tolist(),
        "kind": [person.name for person in people.persons],
        "scale": scale.round(6).tolist(),
        "height": people.height.round(4).tolist(),
        "colors": [_hex(region_colors(outfit)) for outfit in people.outfits],
        "cuts": people.cuts.tolist(),
        "parts": [sum(1 << part for part in worn_parts(outfit)) for outfit in people.outfits],
        "radius": simulation.world.environment_scene(0).radius[0, motion.agents].round(4).tolist(),
        "rider": riders.tolist(),
    }


def _hex(colors: Any) -> str:
    return bytes(np.round(255.0 * np.clip(colors, 0.0, 1.0)).astype(np.uint8).ravel()).hex()


def _robot(control: Any, simulation: Simulation) -> dict[str, Any]:
    spec, body = control.robot, control.robot.body
    goal = control.goal[0]
    return {
        "name": spec.name,
        "type": spec.type or "cylinder",
        "id": int(simulation.world.ids[0, control.agent]),
        "radius": round(float(spec.radius), 4),
        "height": round(float(body.height), 4),
        "ghost": bool(spec.ghost),
        "footprint": body.footprint.round(4).tolist(),
        "goal": {"x": float(goal[0]), "y": float(goal[1]), "tolerance": float(control.tolerance[0])},
        "links": shown_links(body),
        "mesh": f"robots/{spec.name}.bin",
        "key": _mesh_key(body),
    }


def _mesh_key(robot: Robot) -> str:
    """Return a text that differs for robots with other meshes, so that a browser loads them again."""
    words = [robot.name, *shown_links(robot)]
    for name in shown_links(robot):
        link = robot.model.links[name]
        words += [
            f"{visual.color}{visual.origin.tobytes().hex()}{visual.shape}" for visual in link.visuals or link.collisions
        ]
    return format(zlib.crc32("|".join(words).encode()), "08x")


def _sensor(robot: int, sensor: Any) -> dict[str, Any]:
    kind = sensor.mount.sensor
    found: dict[str, Any] = {"robot": robot, "name": sensor.name, "type": type(kind).__name__}
    found["kind"] = next((word for cls, word in KINDS.items() if isinstance(kind, cls)), "other")
    if isinstance(kind, Lidar2D):
        angles = kind.angles
        step = float(angles[1] - angles[0]) if len(angles) > 1 else 0.0
        found |= {"first": float(angles[0]), "step": step, "beams": len(angles), "range": float(kind.range_max)}
    elif found["kind"] == "cone":
        found |= {"angle": cone_angle(kind), "range": float(kind.range_max)}
    elif found["kind"] == "camera":
        found |= {"width": int(kind.width), "height": int(kind.height), "image": True}
    return found
