"""Bytes that are packed at once are those of the message library."""

from __future__ import annotations

from typing import Any

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.messages import Messages, Shape, marker_bytes, people_bytes

MAKE = Messages()
NOW = 12_345_678_901


@given(ids=st.lists(st.integers(0, 10**9), max_size=9, unique=True), seed=st.integers(0, 99))
@settings(deadline=None, max_examples=40)
def test_people(ids: list[int], seed: int) -> None:
    rng = np.random.default_rng(seed)
    position, velocity = rng.normal(0, 10, (2, len(ids), 2))
    radius, heading = rng.uniform(0.1, 1, (2, len(ids))).round(int(rng.integers(1, 17)))
    everyone = [
        MAKE.make(
            "people_msgs/msg/Person",
            name=str(who),
            position=MAKE.point(*position[k]),
            velocity=MAKE.point(*velocity[k]),
            reliability=1.0,
            tagnames=["radius", "heading"],
            tags=[repr(float(radius[k])), repr(float(heading[k]))],
        )
        for k, who in enumerate(ids)
    ]
    slow = MAKE.encode_message(MAKE.make("people_msgs/msg/People", header=MAKE.header(NOW), people=everyone))
    assert people_bytes(NOW, np.array(ids, dtype=np.int64), position, velocity, radius, heading) == slow


def slow_marker(shape: Shape) -> Any:
    make = MAKE.make
    red, green, blue = shape.color
    return make(
        "visualization_msgs/msg/Marker",
        header=MAKE.header(NOW),
        ns=shape.group,
        id=shape.number,
        type=shape.kind,
        action=shape.action,
        pose=make("geometry_msgs/msg/Pose", position=MAKE.point(*shape.place), orientation=MAKE.quaternion(0.0)),
        scale=MAKE.vector(*shape.size),
        color=make("std_msgs/msg/ColorRGBA", r=red, g=green, b=blue, a=1.0),
        lifetime=make("builtin_interfaces/msg/Duration", sec=0, nanosec=0),
        frame_locked=False,
        points=[MAKE.point(x, y) for x, y in shape.points],
        colors=[],
        texture_resource="",
        texture=make(
            "sensor_msgs/msg/CompressedImage", header=MAKE.header(NOW), format="", data=np.zeros(0, dtype=np.uint8)
        ),
        uv_coordinates=[],
        text="",
        mesh_resource="",
        mesh_file=make("visualization_msgs/msg/MeshFile", filename="", data=np.zeros(0, dtype=np.uint8)),
        mesh_use_embedded_materials=False,
    )


NUMBER = st.floats(-1e6, 1e6)
SHAPES = st.builds(
    Shape,
    group=st.text("abcdefghij", max_size=9),
    number=st.integers(0, 2**31 - 1),
    kind=st.integers(0, 11),
    action=st.integers(0, 3),
    place=st.tuples(NUMBER, NUMBER, NUMBER),
    size=st.tuples(NUMBER, NUMBER, NUMBER),
    color=st.tuples(*[st.floats(0, 1)] * 3),
    points=st.lists(st.tuples(NUMBER, NUMBER), max_size=4).map(tuple),
)


@given(shapes=st.lists(SHAPES, max_size=6))
@settings(deadline=None, max_examples=60)
def test_markers(shapes: list[Shape]) -> None:
    slow = MAKE.make("visualization_msgs/msg/MarkerArray", markers=[slow_marker(shape) for shape in shapes])
    assert marker_bytes(NOW, shapes) == MAKE.encode_message(slow)
