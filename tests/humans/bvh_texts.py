"""Motion capture made of the gait of a body: BVH text with y up, and limbs that point to the sides at rest."""

import numpy as np
from scipy.spatial.transform import Rotation

from crowdbot.humans import Gait, People, shapes

NAMES = {
    "pelvis": "Hips", "spine_01": "Spine", "spine_02": "Spine1", "spine_03": "Spine2", "neck_01": "Neck",
    "head": "Head", "clavicle": "Shoulder", "upperarm": "Arm", "lowerarm": "ForeArm", "hand": "Hand", "thigh": "UpLeg",
    "calf": "Leg", "foot": "Foot", "ball": "ToeBase",
}  # fmt: skip
TO_FILE = np.array([[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]])
"""From x forward, y left, z up to the axes of the file: x left, y up, z forward."""
DT, SPEED = 1.0 / 60.0, 1.3


def joint_name(bone, prefix="mixamorig:"):
    """Return the name of a joint in the file."""
    stem, _, side = bone.rpartition("_")
    if side in ("l", "r"):
        return f"{prefix}{'Left' if side == 'l' else 'Right'}{NAMES[stem]}"
    return f"{prefix}{NAMES[bone]}"


def straight_arms(head, names):
    """Return offsets of bones with arms that point to the sides, and the rotation of each bone from that to rest."""
    offsets, turns = {}, {}
    parents = shapes().parents
    for k, name in enumerate(names):
        parent = int(parents[k])
        offset = head[k] - (head[parent] if parent >= 0 else 0.0)
        if name.startswith(("lowerarm", "hand")):
            length = float(np.linalg.norm(offset))
            aside = np.array([0.0, length if name.endswith("l") else -length, 0.0])
            turns[names[parent]] = Rotation.align_vectors([offset], [aside])[0].as_matrix()
            offset = aside
        offsets[name] = offset
    return offsets, turns


def walking_bvh(speed=SPEED, frames=240, heading=0.7, body="man-32"):
    """Return the BVH text of a person who walks (or stands, with speed 0) towards a heading [rad]."""
    gait = Gait(People.of([body]), seed=1)
    way = np.array([[np.cos(heading), np.sin(heading)]])
    state = gait.start(np.zeros((1, 2)), [heading], speed * way)
    bones = [b for b in shapes().bones if not b.startswith(("fingers", "thumb"))]
    index = [shapes().bone(b) for b in bones]
    head = gait.people.measures.head[0]
    offsets, straight = straight_arms(head, shapes().bones)
    rows = []
    for k in range(frames):
        state = gait.step(state, speed * way * DT * (k + 1), speed * way, [heading], DT)
        pose = gait.posture(state)
        world = {b: pose.rotation[0, i] @ straight.get(b, np.eye(3)) for b, i in zip(bones, index, strict=True)}
        row = list(100.0 * (TO_FILE @ pose.position[0, 0]))
        for b, i in zip(bones, index, strict=True):
            parent = int(shapes().parents[i])
            turn = world[b] if parent < 0 else world[shapes().bones[parent]].T @ world[b]
            row += Rotation.from_matrix(TO_FILE @ turn @ TO_FILE.T).as_euler("ZXY", degrees=True).tolist()
        rows.append(row)
    return _text(bones, offsets, rows)


def _text(bones, offsets, rows):
    lines, order = ["HIERARCHY"], []

    def write(name, depth):
        pad = "\t" * depth
        offset = 100.0 * (TO_FILE @ offsets[name]) * (0.0 if depth == 0 else 1.0)
        first = "Xposition Yposition Zposition " if depth == 0 else ""
        lines.extend([f"{pad}{'JOINT' if depth else 'ROOT'} {joint_name(name)}", f"{pad}{{"])
        lines.append(f"{pad}\tOFFSET {offset[0]:.6f} {offset[1]:.6f} {offset[2]:.6f}")
        lines.append(f"{pad}\tCHANNELS {6 if first else 3} {first}Zrotation Xrotation Yrotation")
        order.append(name)
        own = shapes().bone(name)
        children = [b for b in bones if int(shapes().parents[shapes().bone(b)]) == own]
        for child in children:
            write(child, depth + 1)
        if not children:
            lines.extend([f"{pad}\tEnd Site", f"{pad}\t{{", f"{pad}\t\tOFFSET 0 5 0", f"{pad}\t}}"])
        lines.append(f"{pad}}}")

    write("pelvis", 0)
    lines.extend(["MOTION", f"Frames: {len(rows)}", f"Frame Time: {DT:.6f}"])
    for row in rows:
        values = row[:3]
        for name in order:
            k = 3 + 3 * bones.index(name)
            values = values + row[k : k + 3]
        lines.append(" ".join(f"{value:.5f}" for value in values))
    return "\n".join(lines) + "\n"
