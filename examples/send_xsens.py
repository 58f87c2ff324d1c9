"""Sends what Xsens MVN sends: an actor who walks along x at 1 m/s and waves, 60 times a second, by UDP (MXTP02).

    python send_xsens.py [PORT] [SECONDS]

It needs nothing but Python. Start it beside `crowdbot run led.xml --mocap xsens:9763=guide`.
"""

import math
import socket
import struct
import sys
import time

# id, parent and offset [m] from the parent in the T-pose of the 23 segments
SEGMENTS = [
    (1, 0, (0, 0, 0.95)), (2, 1, (0, 0, 0.1)), (3, 2, (0, 0, 0.11)), (4, 3, (0, 0, 0.1)), (5, 4, (0, 0, 0.1)),
    (6, 5, (0, 0, 0.14)), (7, 6, (0.02, 0, 0.09)),
    (8, 5, (0, -0.03, 0.09)), (9, 8, (0, -0.15, 0)), (10, 9, (0, -0.29, 0)), (11, 10, (0, -0.26, 0)),
    (12, 5, (0, 0.03, 0.09)), (13, 12, (0, 0.15, 0)), (14, 13, (0, 0.29, 0)), (15, 14, (0, 0.26, 0)),
    (16, 1, (0, -0.09, 0)), (17, 16, (0, 0, -0.44)), (18, 17, (0, 0, -0.42)), (19, 18, (0.15, 0, -0.07)),
    (20, 1, (0, 0.09, 0)), (21, 20, (0, 0, -0.44)), (22, 21, (0, 0, -0.42)), (23, 22, (0.15, 0, -0.07)),
]  # fmt: skip


def product(a, b):
    (w, x, y, z), (p, q, r, s) = a, b
    return (
        w * p - x * q - y * r - z * s, w * q + x * p + y * s - z * r,
        w * r - x * s + y * p + z * q, w * s + x * r - y * q + z * p,
    )  # fmt: skip


def turned(q, v):
    return product(product(q, (0, *v)), (q[0], -q[1], -q[2], -q[3]))[1:]


def about(axis, angle):
    return (math.cos(angle / 2), *(math.sin(angle / 2) * (axis == one) for one in "xyz"))


def pose(t):
    """Return position and rotation of each segment, which are global."""
    swing = 0.4 * math.sin(2 * math.pi * 0.9 * t)
    turns = {
        20: about("y", -swing), 16: about("y", swing), 21: about("y", 0.2), 17: about("y", 0.2),
        13: about("x", -1.3), 9: about("x", -0.6), 10: about("x", -1.0 + 0.4 * math.sin(6 * t)),
    }  # fmt: skip
    found = {0: ((t, 0, 0), (1, 0, 0, 0))}
    for number, parent, offset in SEGMENTS:
        place, above = found[parent]
        shift = turned(above, offset)
        found[number] = (
            tuple(a + b for a, b in zip(place, shift, strict=True)),
            product(above, turns.get(number, (1, 0, 0, 0))),
        )
    return [found[number] for number, _, _ in SEGMENTS]


def main(port=9763, seconds=10.0, rate=60):
    start = time.monotonic()
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as out:
        for sample in range(int(seconds * rate)):
            t = sample / rate
            time.sleep(max(0.0, start + t - time.monotonic()))
            items = b"".join(struct.pack(">i3f4f", k + 1, *p, *q) for k, (p, q) in enumerate(pose(t)))
            head = struct.pack(
                ">6sIBBIBBBBHH", b"MXTP02", sample, 0x80, 23, round(1000 * t), 0, 23, 0, 0, 0, len(items)
            )
            out.sendto(head + items, ("127.0.0.1", port))


if __name__ == "__main__":
    main(*(kind(word) for kind, word in zip((int, float), sys.argv[1:], strict=False)))
