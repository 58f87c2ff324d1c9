"""Report of the content and the remarks of a URDF as plain values."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping
from typing import Any

import numpy as np

from .model import RobotModel
from .shapes import Mesh


def describe(model: RobotModel, positions: Mapping[str, float] | None = None) -> dict[str, Any]:
    """Return counts, mass, inertia, footprint and remarks of a robot.

    Args:
        model: the robot.
        positions: joint positions for footprint and inertia (default: at rest).

    >>> from crowdbot.world import read_urdf
    >>> found = describe(read_urdf("<robot name='r'><link name='a'><visual><geometry><sphere radius='1'/></geometry>"
    ...                             "</visual></link></robot>"))
    >>> round(found["mass"]), len(found["repaired"]), found["footprint"]
    (4189, 1, [])
    """
    whole = model.inertial(positions)
    points = model.points(positions)
    shapes = [part.shape for link in model.links.values() for part in (*link.collisions, *link.visuals)]
    kinds = Counter(joint.kind for joint in model.joints.values())
    remarks: dict[str, list[str]] = {kind: [] for kind in ("replaced", "repaired", "ignored", "noted")}
    for remark in model.remarks:
        remarks[remark.kind].append(remark.text)
    return {
        "name": model.name,
        "root": model.root,
        "links": len(model.links),
        "links_with_mass": sum(link.inertial is not None for link in model.links.values()),
        "links_that_touch": sum(bool(link.collisions) for link in model.links.values()),
        "joints": len(model.joints),
        "joint_kinds": dict(sorted(kinds.items())),
        "joints_that_move": len(model.movable),
        "joints_that_mimic": sum(joint.mimic is not None for joint in model.joints.values()),
        "meshes": {source: str(path) for source, path in model.meshes.items()},
        "convex_pieces": sum(len(shape.pieces) for shape in shapes if isinstance(shape, Mesh)),
        "mass": whole.mass,
        "center_of_mass": whole.center.tolist(),
        "inertia": whole.tensor.tolist(),
        "size": np.ptp(points, axis=0).tolist() if len(points) else [],
        "footprint": model.footprint(positions).tolist(),
        **remarks,
    }
