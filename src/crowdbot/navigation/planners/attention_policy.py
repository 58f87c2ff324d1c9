"""The attention policy: a network that weighs people by attention and knows the walls around the robot."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Paper, kernel
from crowdbot.core.geometry import ray_to_segment
from crowdbot.navigation.observation_batch import ObservationBatch
from crowdbot.navigation.wall_arrays import wall_arrays
from crowdbot.typing import Floats

from .learned_policy import LearnedNavigator, policy_inputs
from .policy_kernels import OWN_VALUES, PERSON_VALUES, apply_layer
from .policy_weights import NetworkWeights, Singles, dense_layers, read_layers

MOST_ATTENDED = 12
"""Number of nearest people that the policy knows."""
FACING_VALUES = ("facing_x", "facing_y")
"""Inputs after OWN_VALUES: direction of the robot in the goal frame, 0 for a drive that moves in every direction."""
WALL_DIRECTIONS = 32
"""Number of directions of the goal frame in which walls are known, counterclockwise from its x axis."""
WALL_SIGHT = 4.0
"""Distance [m] beyond which walls are ignored."""
ATTENTION_LAYERS = (64, 64, 32, 128)
"""Widths of the two layers of a person, of the layer of scores, and of the layers of the action."""
_OWN = len(OWN_VALUES) + len(FACING_VALUES)


class AttentionInputs(NamedTuple):
    """Inputs of the attention policy in N environments, in the goal frame: x towards the waypoint.

    Fields:
        axis: ``[N, 2]`` x axis of the goal frame, in the world.
        own: ``[N, 8]`` OWN_VALUES and FACING_VALUES.
        people: ``[N, K, 11]`` PERSON_VALUES of the nearest people, nearest first.
        present: ``[N]`` number of people.
        walls: ``[N, 32]`` nearness of walls in WALL_DIRECTIONS: 1 at the edge of the robot, 0 from WALL_SIGHT.
    """

    axis: Floats
    own: Floats
    people: Floats
    present: NDArray[np.int64]
    walls: Floats


def attention_inputs(
    batch: ObservationBatch, asking: NDArray[np.bool_] | None = None, speed: float = np.inf
) -> AttentionInputs:
    """Return the inputs of the attention policy for N observations.

    Args:
        batch: what the robot knows in N environments.
        asking: ``[N]`` environments to fill; default all.
        speed: largest speed [m/s], limited by the drive.

    >>> from crowdbot.core import Walls
    >>> from crowdbot.navigation import DriveLimits
    >>> batch = ObservationBatch(pose=np.zeros((1, 3)), goal=np.array([[4.0, 0.0]]), radius=np.full(1, 0.3),
    ...     limits=DriveLimits(1.0, 2.0), dt=0.1, walls=Walls.of([[(2.3, -1.0), (2.3, 1.0)]]))
    >>> attention_inputs(batch).walls[0, [0, 1, 16]].round(3).tolist()
    [0.5, 0.489, 0.0]
    """
    N = len(batch)
    chosen = np.ones(N, np.bool_) if asking is None else asking
    found = policy_inputs(batch, MOST_ATTENDED, chosen, speed)
    facing, walls = np.zeros((N, len(FACING_VALUES))), np.zeros((N, WALL_DIRECTIONS))
    segments = wall_arrays(batch.walls).segments
    _look_around(chosen, batch.pose, batch.radius, found.axis, segments, not batch.limits.holonomic, facing, walls)
    return AttentionInputs(found.axis, np.concatenate([found.own, facing], axis=1), found.people, found.present, walls)


@kernel
def _look_around(
    asking: NDArray[np.bool_], pose: Floats, radius: Floats, axis: Floats, segments: Floats, faces: bool,
    facing: Floats, walls: Floats,
) -> None:  # fmt: skip
    """Write the direction of the robot in the goal frame, if it matters, and the nearness of walls."""
    for e in range(len(pose)):
        if not asking[e]:
            continue
        x, y, ax, ay = pose[e, 0], pose[e, 1], axis[e, 0], axis[e, 1]
        if faces:
            cos, sin = math.cos(pose[e, 2]), math.sin(pose[e, 2])
            facing[e, 0], facing[e, 1] = ax * cos + ay * sin, ax * sin - ay * cos
        reach = WALL_SIGHT + radius[e]
        for m in range(len(segments)):
            px, py, qx, qy = segments[m, 0], segments[m, 1], segments[m, 2], segments[m, 3]
            if min(px, qx) > x + reach or max(px, qx) < x - reach or min(py, qy) > y + reach or max(py, qy) < y - reach:
                continue
            for k in range(WALL_DIRECTIONS):
                angle = 2.0 * math.pi * k / WALL_DIRECTIONS
                cos, sin = math.cos(angle), math.sin(angle)
                away = ray_to_segment(x, y, ax * cos - ay * sin, ay * cos + ax * sin, px, py, qx, qy) - radius[e]
                if away < WALL_SIGHT:
                    walls[e, k] = max(walls[e, k], 1.0 - max(away, 0.0) / WALL_SIGHT)


@dataclass(frozen=True)
class AttentionWeights(NetworkWeights):
    """Layers of the navigator ``attention-policy``.

    >>> AttentionWeights.shapes()["score1_weight"]
    (128, 32)
    """

    navigator: ClassVar[str] = "attention-policy"
    widths: ClassVar[Mapping[str, tuple[int, int]]] = (
        dense_layers("person", _OWN + len(PERSON_VALUES), *ATTENTION_LAYERS[:2])
        | dense_layers("score", 2 * ATTENTION_LAYERS[1], ATTENTION_LAYERS[2], 1)
        | dense_layers("action", ATTENTION_LAYERS[1] + _OWN + WALL_DIRECTIONS, *ATTENTION_LAYERS[3:] * 2, 2)
    )

    person1_weight: Singles
    person1_bias: Singles
    person2_weight: Singles
    person2_bias: Singles
    score1_weight: Singles
    score1_bias: Singles
    score2_weight: Singles
    score2_bias: Singles
    action1_weight: Singles
    action1_bias: Singles
    action2_weight: Singles
    action2_bias: Singles
    action3_weight: Singles
    action3_bias: Singles


@kernel
def apply_attention(
    asking: NDArray[np.bool_], own: Floats, people: Floats, count: NDArray[np.int64], walls: Floats, out: Floats,
    w1: Floats, b1: Floats, w2: Floats, b2: Floats, w3: Floats, b3: Floats, w4: Floats, b4: Floats,
    w5: Floats, b5: Floats, w6: Floats, b6: Floats, w7: Floats, b7: Floats,
) -> None:  # fmt: skip
    """Write the outputs ``[N, 2]`` of the network for inputs of :func:`attention_inputs`.

    Two layers embed each person with the values of the robot. Two layers score each embedding beside the mean of all,
    and the softmax of the scores weighs the sum of embeddings. Sum, robot and walls pass two layers and a linear one.
    """
    F, G, K, D = own.shape[1], people.shape[2], people.shape[1], len(b2)
    person, first, embedded, mean = np.empty(G + F), np.empty(len(b1)), np.empty((K, D)), np.empty(D)
    common, hidden, score, weight = np.empty(len(b3)), np.empty(len(b3)), np.empty(1), np.empty(K)
    joined = np.empty(D + F + walls.shape[1])
    third, fourth = np.empty(len(b5)), np.empty(len(b6))
    for e in range(len(own)):
        if not asking[e]:
            continue
        n = count[e]
        joined[:D], mean[:] = 0.0, 0.0
        joined[D : D + F], joined[D + F :] = own[e], walls[e]
        person[G:] = own[e]
        for k in range(n):
            person[:G] = people[e, k]
            apply_layer(person, G + F, w1, b1, True, first)
            apply_layer(first, len(b1), w2, b2, True, embedded[k])
            for j in range(D):
                mean[j] += embedded[k, j] / n
        apply_layer(mean, D, w3[D:], b3, False, common)  # the same for all people
        largest = -math.inf
        for k in range(n):
            apply_layer(embedded[k], D, w3[:D], common, True, hidden)
            apply_layer(hidden, len(b3), w4, b4, False, score)
            weight[k] = score[0]
            largest = max(largest, score[0])
        total = 0.0
        for k in range(n):
            weight[k] = math.exp(weight[k] - largest)
            total += weight[k]
        for k in range(n):
            for j in range(D):
                joined[j] += weight[k] / total * embedded[k, j]
        apply_layer(joined, len(joined), w5, b5, True, third)
        apply_layer(third, len(b5), w6, b6, True, fourth)
        apply_layer(fourth, len(b6), w7, b7, False, out[e])


@dataclass(frozen=True)
class AttentionPolicyNavigator(LearnedNavigator):
    """Moves as a network with attention to people and distances to walls, trained by reinforcement learning.

    The network knows the nearest 12 people within 10 m and the walls within 4 m in 32 directions. It embeds each person
    together with the robot, and attention weighs the embeddings. With neither people nor walls there, the robot goes to
    its waypoint. It is invariant to rotations and to the order of people, but may prefer a side. It was trained in
    crossings, corridors, doors and halls, for drives that move in every direction and differential drives, through the
    realisation of its velocity, which is that of ``policy``: with walls, or with a drive that cannot move sideways,
    :func:`dynamic_window_twist` selects a twist near it, otherwise a near velocity that keeps a margin to people who
    walk straight.

    Fields:
        speed: largest speed [m/s], limited by the drive.
        horizon: time for which people are expected to walk straight [s]; 0: the velocity of the network is not changed.
        margin: clearance to people that is kept for this time [m].
        file: file of weights from ``examples/train_navigator.py``, in a trial relative to its folder (default: the
            weights of the package).

    Sources: attention, Chen et al. 2019, doi:10.1109/ICRA.2019.8794134; proximal policy optimisation, Schulman et al.
    2017, https://arxiv.org/abs/1707.06347. Their value network has no walls; a policy is learned instead of a value.

    Raises:
        InputError: a number is out of its range.

    >>> from crowdbot.navigation import DriveLimits, Observation
    >>> limits = DriveLimits(1.0, 2.0, holonomic=True)
    >>> here = Observation(pose=(0.0, 0.0, 0.0), goal=(0.0, 4.0), radius=0.3, limits=limits, dt=0.25)
    >>> AttentionPolicyNavigator().act(here).left > 0.5
    True
    """

    paper: ClassVar[Paper] = Paper(
        "Chen et al.",
        2019,
        "Crowd-robot interaction: Crowd-aware robot navigation with attention-based deep reinforcement learning",
        "ICRA",
        "10.1109/ICRA.2019.8794134",
    )
    network = AttentionWeights
    always_returns = True

    def shares(self, batch: ObservationBatch, asking: NDArray[np.bool_]) -> tuple[Floats, Floats]:
        inputs, shares = attention_inputs(batch, asking, self.speed), np.zeros((len(batch), 2))
        layers: Any = read_layers(self.network, self.file)
        apply_attention(asking, inputs.own, inputs.people, inputs.present, inputs.walls, shares, *layers)
        shares[(inputs.present == 0) & ~inputs.walls.any(axis=1)] = (1.0, 0.0)  # towards the waypoint
        return inputs.axis, shares
