"""Messages between a simulation and a navigator in another process: lines of JSON, with arrays as base64.

A request is ``{"call": "begin" | "act", "observation": {...}, "memory": ...}``, the answer
``{"memory": ..., "twist": [forward, turn, left], "joints": {...}}`` or ``{"error": "..."}``. An array is
``{"dtype": "<f8", "shape": [2, 3], "data": "..."}`` in little-endian C order. The protocol has no code in it: nothing
is pickled, and every message has a largest size.
"""

from __future__ import annotations

import base64
import dataclasses
import json
import math
from collections.abc import Mapping
from typing import Any

import numpy as np

import crowdbot.sensors
from crowdbot.core import InputError, Pose, SpatialPose, Twist, Walls
from crowdbot.navigation.action import Action
from crowdbot.navigation.observation import DriveLimits, Observation, VisiblePeople
from crowdbot.navigation.track_history import TrackHistory
from crowdbot.sensors import Reading

LONGEST_LINE = 64_000_000
"""Largest size of a message [bytes]."""
TRUTH = ("hit", "part", "direction", "velocity", "acceleration_bias", "turn_bias")
"""Fields of readings that no real sensor knows; they are left out, except the velocities of tracked people."""
PEOPLE_FIELDS = ("position", "velocity", "radius", "ids", "existence", "gesture")
"""Fields of the visible people."""
DTYPES = {"<f8", "<f4", "<f2", "<i8", "<i4", "<i2", "|i1", "|u1", "<u2", "<u4", "<u8", "|b1"}
DEEPEST = 20
"""Largest depth of a memory."""


def encode_array(value: Any) -> dict[str, Any]:
    """Return an array as JSON values.

    >>> decode_array(encode_array(np.arange(3.0))).tolist()
    [0.0, 1.0, 2.0]
    """
    array = np.ascontiguousarray(value, dtype=np.asarray(value).dtype.newbyteorder("<"))
    if array.dtype.str not in DTYPES:
        raise InputError(f"an array of type {array.dtype} cannot be sent; allowed are numbers and booleans")
    data = base64.b64encode(array.tobytes()).decode("ascii")
    return {"dtype": array.dtype.str, "shape": list(np.shape(value)), "data": data}


def decode_array(value: Mapping[str, Any]) -> Any:
    """Return the array of JSON values.

    Raises:
        ValueError: the values are damaged.
    """
    if value["dtype"] not in DTYPES:
        raise ValueError(f"dtype {value['dtype']!r} is not allowed")
    shape = tuple(int(size) for size in value["shape"])
    data = base64.b64decode(value["data"], validate=True)
    return np.frombuffer(data, dtype=value["dtype"]).reshape(shape).copy()


def encode_observation(observation: Observation) -> dict[str, Any]:
    """Return an observation as JSON values, without the truth that sensors carry along and without its predictor."""
    people, walls, tracks = observation.people, observation.walls, observation.tracks
    return {
        "pose": list(observation.pose),
        "goal": list(observation.goal),
        "waypoint": list(observation.waypoint),
        "radius": observation.radius,
        "outline": encode_array(observation.outline),
        "limits": [_number(value) for value in observation.limits],
        "dt": observation.dt,
        "time": observation.time,
        "twist": list(observation.twist),
        "people": {name: encode_array(getattr(people, name)) for name in PEOPLE_FIELDS},
        "walls": {field.name: encode_array(getattr(walls, field.name)) for field in dataclasses.fields(walls)},
        "readings": {name: _encode_reading(reading) for name, reading in observation.readings.items()},
        "tracks": None
        if tracks is None
        else {name: encode_array(getattr(tracks, name)) for name in ("times", "ids", "position")}
        | {"length": tracks.length},
    }


def decode_observation(values: Mapping[str, Any]) -> Observation:
    """Return the observation of JSON values.

    Raises:
        KeyError, TypeError, ValueError: the values are damaged.
    """
    people = {name: decode_array(array) for name, array in values["people"].items()}
    walls = {name: decode_array(array) for name, array in values["walls"].items()}
    tracks = values["tracks"]
    speed, turn, acceleration, turn_acceleration, holonomic = values["limits"]
    return Observation(
        pose=(values["pose"][0], values["pose"][1], values["pose"][2]),
        goal=(values["goal"][0], values["goal"][1]),
        waypoint=(values["waypoint"][0], values["waypoint"][1]),
        radius=values["radius"],
        outline=decode_array(values["outline"]),
        limits=DriveLimits(
            _limit(speed), _limit(turn), _limit(acceleration), _limit(turn_acceleration), bool(holonomic)
        ),
        dt=values["dt"],
        time=values["time"],
        twist=Twist(*values["twist"]),
        people=VisiblePeople(**people),
        walls=Walls(**walls),
        readings={name: _decode_reading(reading) for name, reading in values["readings"].items()},
        tracks=None
        if tracks is None
        else TrackHistory(
            decode_array(tracks["times"]),
            decode_array(tracks["ids"]),
            decode_array(tracks["position"]),
            tracks["length"],
        ),
    )


def _limit(value: float | None) -> float:
    return math.inf if value is None else float(value)


def _number(value: Any) -> Any:
    """Return a number for JSON; an infinite limit is None."""
    return None if isinstance(value, float) and math.isinf(value) else value


def _encode_reading(reading: Reading) -> dict[str, Any]:
    tracked = hasattr(reading, "present")
    encode_reading: dict[str, Any] = {"type": type(reading).__name__}
    for field in dataclasses.fields(reading):
        value = getattr(reading, field.name)
        if field.name in TRUTH and not tracked:
            encode_reading[field.name] = _blank(value)
        elif isinstance(value, Pose | SpatialPose):
            parts = {part.name: encode_array(getattr(value, part.name)) for part in dataclasses.fields(value)}
            encode_reading[field.name] = {"pose": type(value).__name__, **parts}
        elif isinstance(value, np.ndarray):
            encode_reading[field.name] = encode_array(value)
        elif dataclasses.is_dataclass(value):
            encode_reading[field.name] = {"lens": dataclasses.asdict(value)}  # type: ignore[arg-type]
        else:
            encode_reading[field.name] = value
    return encode_reading


def _blank(value: Any) -> Any:
    """Return an array of the same shape that says nothing: NaN, or -1 for integers."""
    if not isinstance(value, np.ndarray):
        return None
    return encode_array(np.full_like(value, np.nan if value.dtype.kind == "f" else -1))


def _decode_reading(values: Mapping[str, Any]) -> Reading:
    kind = getattr(crowdbot.sensors, values["type"], None)
    if not (isinstance(kind, type) and issubclass(kind, Reading)):
        raise ValueError(f"there is no reading {values['type']!r}")
    fields = {name: _decode_field(value) for name, value in values.items() if name != "type"}
    return kind(**fields)


def _decode_field(value: Any) -> Any:
    if not isinstance(value, Mapping):
        return value
    if "pose" in value:
        kind: Any = {"Pose": Pose, "SpatialPose": SpatialPose}[value["pose"]]
        return kind(**{name: decode_array(part) for name, part in value.items() if name != "pose"})
    if "lens" in value:
        lens: dict[str, Any] = {k: tuple(v) if isinstance(v, list) else v for k, v in value["lens"].items()}
        return crowdbot.sensors.Lens(**lens)
    return decode_array(value)


def encode_action(action: Action) -> dict[str, Any]:
    """Return an action as JSON values."""
    return {"twist": [float(value) for value in action.twist], "joints": dict(action.joints)}


def decode_action(values: Mapping[str, Any]) -> Action:
    """Return the action of JSON values.

    Raises:
        KeyError, TypeError, ValueError: the values are damaged.
    """
    forward, turn, left = (float(value) for value in values["twist"])
    joints = {str(name): float(value) for name, value in dict(values.get("joints") or {}).items()}
    return Action(Twist(forward, turn, left), joints)


def encode_memory(memory: Any) -> str:
    """Return the text of a memory of plain values: None, numbers, texts, lists, tuples, dictionaries and arrays.

    Raises:
        InputError: a part is another object, is too deep, or a key is not a text.

    >>> decode_memory(encode_memory({"seen": (1, 2.5, np.arange(2))}))["seen"][:2]
    (1, 2.5)
    """
    return json.dumps(_encode_part(memory, "memory", 0), separators=(",", ":"))


def decode_memory(text: str) -> Any:
    """Return the memory of a text.

    Raises:
        KeyError, TypeError, ValueError: the text is damaged.
    """
    return _decode_part(json.loads(text), 0)


def _encode_part(value: Any, path: str, depth: int) -> Any:
    if depth > DEEPEST:
        raise InputError(f"{path} is nested deeper than {DEEPEST}")
    if isinstance(value, np.ndarray | np.generic):
        return {"array": encode_array(value)}
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, list | tuple):
        parts = [_encode_part(part, f"{path}[{k}]", depth + 1) for k, part in enumerate(value)]
        return parts if isinstance(value, list) else {"tuple": parts}
    if isinstance(value, dict) and all(isinstance(key, str) for key in value):
        return {"dict": {key: _encode_part(part, f"{path}[{key!r}]", depth + 1) for key, part in value.items()}}
    raise InputError(f"{path} is a {type(value).__name__}; store numbers, texts, lists, dictionaries or arrays")


def _decode_part(value: Any, depth: int) -> Any:
    if depth > 3 * DEEPEST:
        raise ValueError("the memory is nested too deep")
    if isinstance(value, list):
        return [_decode_part(part, depth + 1) for part in value]
    if not isinstance(value, dict):
        return value
    ((kind, content),) = value.items()
    if kind == "array":
        return decode_array(content)
    if kind == "tuple":
        return tuple(_decode_part(part, depth + 1) for part in content)
    return {key: _decode_part(part, depth + 1) for key, part in content.items()}
