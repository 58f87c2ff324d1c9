"""A headset that is simulated: messages as the page sends them, with a clock of its own."""

import numpy as np

from crowdbot.web import StateFrame

AXES = np.array([[0.0, 0.0, -1.0], [-1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])


def quaternion(rotation):
    """Return x, y, z, w of a rotation matrix."""
    from scipy.spatial.transform import Rotation

    return Rotation.from_matrix(rotation).as_quat()


def pose(position, rotation=None):
    """Return a WebXR pose [7] of a point [m] and a rotation in the axes of the room (x forward, z up)."""
    rotation = np.eye(3) if rotation is None else rotation
    return np.concatenate([AXES.T @ position, quaternion(AXES.T @ rotation @ AXES)]).astype(np.float32)


def wrist(position, rotation=None):
    """Return the WebXR joint pose [7] of a wrist: -z to the fingers, y out of the back of the hand."""
    return pose(position, rotation)


def message(time, head=(0.0, 0.0, 1.6), turn=None, left=None, right=None, number=1, flags=1 | 4 | 8, **more):
    """Return the bytes of a message; hands are wrists of tracked hands in the axes of the room."""
    arrays = {"flags": np.array([flags], dtype=np.uint8)}
    if head is not None:
        arrays["head"] = pose(np.asarray(head, dtype=float), turn)
    for name, point in (("left", left), ("right", right)):
        if point is not None:
            arrays[name] = wrist(np.asarray(point, dtype=float))
    arrays |= more
    return StateFrame("headset", time, arrays, number).encode()
