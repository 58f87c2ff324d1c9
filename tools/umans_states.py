"""Velocities that cost functions of UMANS choose in random states, against which the tests hold our cost terms.

``python tools/umans_states.py libumans.so`` writes ``tests/models/golden/umans_states.npz``. The library is that of
amiryanj/UMANS (commit ef4b934): ``src/Library/APIFunctions.cpp``, ``src/Engine`` and ``src/3rd-party`` in one shared
object. 25 crowds with 40 people each: states, and the velocity that each policy chooses for everyone.
"""

from __future__ import annotations

import ctypes
import sys
import tempfile
from pathlib import Path

import numpy as np

FILE = Path(__file__).parents[1] / "tests/models/golden/umans_states.npz"
CROWDS, PEOPLE, ROOM, DT = 25, 40, 7.5, 0.1
RADIUS, NEAREST, MAX_SPEED = 0.25, 0.45, 1.8
"""Radius and smallest distance of two people [m], some of whom touch, and maximum speed [m/s]."""
STANDING = 4
"""People of each crowd without a velocity."""
RINGS = 'OptimizationMethod="sampling" SamplingType="regular" SamplingBase="zero" SamplingRadius="maximum speed"'
NO_CONTACT = 'RelaxationTime="0" ContactForceScale="0"'
CIRCLE = f'{RINGS} SamplingBaseDirection="unit" SamplingAngle="360" AngleSamples="36" SpeedSamples="4" {NO_CONTACT}'
HALF = f'{RINGS} SamplingBaseDirection="preferred velocity" SamplingAngle="180" AngleSamples="19" {NO_CONTACT}'
POLICIES = {
    "RVO": (CIRCLE, '<costfunction name="RVO"/>'),
    "Paris": (CIRCLE, '<costfunction name="Paris"/>'),
    "FOEAvoidance": (CIRCLE, '<costfunction name="FOEAvoidance"/>'),
    "Karamouzas": (f'{HALF} SpeedSamples="18"', '<costfunction name="Karamouzas"/>'),
    "FOEAvoidance-gradient": (
        'OptimizationMethod="gradient" RelaxationTime="0.5" ContactForceScale="0"',
        '<costfunction name="FOEAvoidance" coeff="3"/><costfunction name="GoalReachingForce"/>',
    ),
}
"""Attributes and cost functions of each policy; the range of all is 5 m, their default."""


class AgentData(ctypes.Structure):
    """State of an agent in the interface of the library."""

    _fields_ = [("id", ctypes.c_int)] + [
        (name, ctypes.c_float) for name in ("x", "y", "vx", "vy", "ahead_x", "ahead_y")
    ]


def states(rng: np.random.Generator) -> dict[str, np.ndarray]:
    """Return people at random places, with velocities, goals and preferred speeds, in single precision."""
    place: list[np.ndarray] = []
    while len(place) < PEOPLE:
        new = rng.uniform(-ROOM, ROOM, 2)
        if all(np.hypot(*(new - other)) >= NEAREST for other in place):
            place.append(new)
    way, speed = rng.uniform(-np.pi, np.pi, PEOPLE), rng.uniform(0.1, 1.6, PEOPLE)
    speed[:STANDING] = 0.0
    values = {
        "position": np.array(place),
        "velocity": np.stack([speed * np.cos(way), speed * np.sin(way)], axis=-1),
        "goal": np.array(place) + rng.uniform(4.0, 9.0, (PEOPLE, 2)) * rng.choice([-1.0, 1.0], (PEOPLE, 2)),
        "preferred_speed": rng.uniform(0.9, 1.6, PEOPLE),
    }
    return {name: value.astype(np.float32) for name, value in values.items()}


def chosen(library: ctypes.CDLL, policy: str, people: dict[str, np.ndarray]) -> np.ndarray:
    """Return the velocities ``[A, 2]`` after a step of a policy, which no acceleration limits."""
    attributes, costs = POLICIES[policy]
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "simulation.xml"
        file.write_text(
            f'<Simulation delta_time="{DT}"><World type="Infinite"/><Policies><Policy id="0" {attributes}>{costs}'
            "</Policy></Policies></Simulation>",
            encoding="utf-8",
        )
        if not library.StartSimulation(str(file).encode(), 1):
            raise SystemExit(f"{policy}: the library refused the policy")
    numbers = [ctypes.c_float(value) for value in (RADIUS, 0.0, MAX_SPEED, 1e4)]
    data = (AgentData * PEOPLE)()
    for a in range(PEOPLE):
        (x, y), (vx, vy) = people["position"][a].tolist(), people["velocity"][a].tolist()
        numbers[1] = ctypes.c_float(people["preferred_speed"][a])
        number = ctypes.c_int()
        library.AddAgent(ctypes.c_float(x), ctypes.c_float(y), *numbers, 0, ctypes.byref(number), a)
        library.SetAgentGoal(number, *(ctypes.c_float(value) for value in people["goal"][a].tolist()))
        data[a] = AgentData(number.value, x, y, vx, vy, 1.0, 0.0)
    library.SetAgentPositions(data, PEOPLE)
    library.DoSimulationSteps(1)
    after, count = ctypes.POINTER(AgentData)(), ctypes.c_int()
    library.GetAgentPositions(ctypes.byref(after), ctypes.byref(count))
    velocity = {after[k].id: (after[k].vx, after[k].vy) for k in range(count.value)}
    return np.array([velocity[a] for a in range(PEOPLE)], dtype=np.float32)


def main() -> None:
    """Write the file."""
    library = ctypes.CDLL(sys.argv[1])
    rng = np.random.default_rng(2020)
    crowds = [states(rng) for _ in range(CROWDS)]
    values = {name: np.stack([people[name] for people in crowds]) for name in crowds[0]}
    for policy in POLICIES:
        values[policy] = np.stack([chosen(library, policy, people) for people in crowds])
    np.savez_compressed(FILE, **values)
    print(f"{FILE}: {FILE.stat().st_size} bytes")


if __name__ == "__main__":
    main()
