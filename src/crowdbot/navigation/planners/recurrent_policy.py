"""The recurrent policy: a graph of recurrent networks over where people were, without their velocities."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Paper, Twist, kernel
from crowdbot.navigation.action import Action
from crowdbot.navigation.observation import Observation
from crowdbot.navigation.observation_batch import ObservationBatch
from crowdbot.navigation.track_batch import TrackBatch
from crowdbot.typing import Floats, Ints

from .attention_policy import FACING_VALUES, MOST_ATTENDED, WALL_DIRECTIONS, attention_inputs
from .learned_policy import LearnedNavigator, as_batch
from .policy_kernels import OWN_VALUES, SCALE, SIGHT, apply_layer
from .policy_weights import NetworkWeights, Singles, dense_layers, read_layers

WINDOW_STEPS = 6
"""Number of steps of a window of positions: the newest is now, the oldest 1.25 s ago."""
STEP = 0.25
"""Time between two steps of a window [s]; positions between two rows of the memory are interpolated."""
WINDOW_VALUES = ("x", "y", "dx", "dy")
"""Values of a step of a window, seen from where the robot is now, in the goal frame: position [m] divided by SCALE, and
the way since the step before divided by its time [m/s], 0 in the first step."""
BODY_VALUES = ("radii", "distance", "clearance")
"""Values of a person now [m]: sum of both radii, distance of the centres divided by SCALE, and clearance."""
SPACING = 0.05
"""Smallest time between two rows of the memory [s]."""
SAME = 1e-6
"""Tolerance of times [s]."""
ESTIMATE = 0.5
"""Longest time over which the velocity of a person is estimated for the realisation [s]."""
TEMPORAL, SPATIAL, EMBEDDING, MATCH, WIDE = 16, 32, 64, 32, 128
"""Widths of the states of both recurrent networks, of a person, of the attention and of the layers of the action."""
ROBOT = -(2**63)
"""Identity of the robot in its memory, below those of people."""
_OWN = len(OWN_VALUES) + len(FACING_VALUES)


@kernel
def _place_at(times: Floats, past: Floats, p: int, when: float, out: Floats) -> bool:
    """Write where somebody was at a time, between the rows before and after it; return whether that is known."""
    later = -1
    for t in range(len(times) - 1, -1, -1):
        if np.isnan(times[t]):
            return False
        if np.isnan(past[t, p, 0]):
            continue
        if times[t] <= when + SAME:
            share = 0.0
            if later >= 0:
                share = min(max((when - times[t]) / (times[later] - times[t]), 0.0), 1.0)
                out[0] = past[t, p, 0] + share * (past[later, p, 0] - past[t, p, 0])
                out[1] = past[t, p, 1] + share * (past[later, p, 1] - past[t, p, 1])
            else:
                out[0], out[1] = past[t, p, 0], past[t, p, 1]
            return True
        later = t
    return False


@kernel
def _write_window(
    times: Floats, past: Floats, p: int, now: float, here: Floats, place: Floats, ax: float, ay: float, was: Floats,
    out: Floats,
) -> int:  # fmt: skip
    """Write WINDOW_VALUES ``[6, 4]`` of somebody who is at a place now, and return the number of known steps.

    Args:
        times, past: rows of the memory ``[T]``, ``[T, P, 2]``.
        p: place of the person there, -1: not there.
        now: time [s].
        here: ``[2]`` position of the robot now [m].
        place: ``[2]`` position of the person now [m].
        ax, ay: x axis of the goal frame.
        was: ``[2]`` space for a position.
        out: the window.
    """
    last = len(out) - 1
    x, y = place[0], place[1]
    for k in range(last + 1):
        row = out[last - k]
        dx, dy = x - here[0], y - here[1]
        row[0], row[1] = (ax * dx + ay * dy) / SCALE, (ax * dy - ay * dx) / SCALE
        row[2], row[3] = 0.0, 0.0
        if k == last or p < 0 or not _place_at(times, past, p, now - (k + 1) * STEP, was):
            return k + 1
        dx, dy = (x - was[0]) / STEP, (y - was[1]) / STEP
        row[2], row[3] = ax * dx + ay * dy, ax * dy - ay * dx
        x, y = was[0], was[1]
    return last + 1


@kernel
def _find(ids: Ints, count: int, wanted: int) -> int:
    """Return the place of an identity among the first ones, or -1."""
    for p in range(count):
        if ids[p] == wanted:
            return p
    return -1


@kernel
def _estimate_velocities(
    time: Floats, position: Floats, seen: NDArray[np.bool_], ids: Ints, times: Floats, who: Ints, count: Ints,
    past: Floats, velocity: Floats,
) -> None:  # fmt: skip
    """Write the velocities ``[N, A, 2]`` of people from where they were [m/s]; those of the others stay as they are."""
    was = np.empty(2)
    for e in range(len(time)):
        for a in range(seen.shape[1]):
            p = _find(who[e], count[e], ids[e, a]) if seen[e, a] else -1
            for k in range(2 if p >= 0 else 0):
                since = ESTIMATE / (k + 1)
                if _place_at(times[e], past[e], p, time[e] - since, was):
                    velocity[e, a, 0] = (position[e, a, 0] - was[0]) / since
                    velocity[e, a, 1] = (position[e, a, 1] - was[1]) / since
                    break


@kernel
def _write_windows(
    asking: NDArray[np.bool_], time: Floats, pose: Floats, radius: Floats, axis: Floats, position: Floats, size: Floats,
    seen: NDArray[np.bool_], ids: Ints, times: Floats, who: Ints, count: Ints, past: Floats,
    windows: Floats, steps: Ints, bodies: Floats, present: Ints,
) -> None:  # fmt: skip
    """Write the fields of :class:`RecurrentInputs` that come from the memory."""
    K = bodies.shape[1]
    chosen, gaps, was = np.empty(K, dtype=np.int64), np.empty(K), np.empty(2)
    for e in range(len(pose)):
        if not asking[e]:
            continue
        here, ax, ay, now = pose[e, :2], axis[e, 0], axis[e, 1], time[e]
        p = _find(who[e], count[e], ROBOT)
        steps[e, 0] = _write_window(times[e], past[e], p, now, here, here, ax, ay, was, windows[e, 0])
        n = int(np.int64(0))
        for a in range(size.shape[1]):
            if not seen[e, a]:
                continue
            dx, dy = position[e, a, 0] - here[0], position[e, a, 1] - here[1]
            gap = math.sqrt(dx * dx + dy * dy) - size[e, a] - radius[e]
            if gap > SIGHT or (n == K and gap >= gaps[K - 1]):
                continue
            k = min(n, K - 1)
            while k > 0 and gaps[k - 1] > gap:
                gaps[k], chosen[k] = gaps[k - 1], chosen[k - 1]
                k -= 1
            gaps[k], chosen[k] = gap, a
            n = min(n + 1, K)
        present[e] = n
        for k in range(n):
            a = chosen[k]
            p = _find(who[e], count[e], ids[e, a])
            steps[e, 1 + k] = _write_window(
                times[e], past[e], p, now, here, position[e, a], ax, ay, was, windows[e, 1 + k]
            )
            radii = size[e, a] + radius[e]
            bodies[e, k, 0], bodies[e, k, 1] = radii, min(gaps[k] + radii, SIGHT) / SCALE
            bodies[e, k, 2] = min(max(gaps[k], -0.5), 1.0)


def remember(memory: TrackBatch, batch: ObservationBatch) -> TrackBatch:
    """Return the memory after N observations: where the robot, which is ROBOT, and people were.

    An observation before the newest row begins a new memory in its environment; one that is less than SPACING after it
    changes nothing.

    Args:
        memory: the memory of N environments, empty before the first observation.
        batch: what the robot knows in N environments.

    >>> from crowdbot.navigation import DriveLimits
    >>> batch = ObservationBatch(pose=np.ones((1, 3)), goal=np.array([[4.0, 0.0]]), radius=np.full(1, 0.3),
    ...     limits=DriveLimits(1.0, 2.0), dt=0.25)
    >>> remember(empty_memory(1, 0.25), batch).position[0, -1].tolist()
    [[1.0, 1.0]]
    """
    newest = memory.times[:, -1]
    back = np.flatnonzero(batch.time < newest)
    if len(back):
        memory = memory.put(back, TrackBatch.empty(len(back), memory.length))
        newest = memory.times[:, -1]
    people, N = batch.people, len(batch)
    return memory.update(
        batch.time,
        np.concatenate([np.full((N, 1), ROBOT), people.ids], axis=1),
        np.concatenate([batch.pose[:, None, :2], people.position], axis=1),
        np.concatenate([np.ones((N, 1), np.bool_), people.seen], axis=1),
        ~(batch.time < newest + SPACING - SAME),  # NaN before the first row
    )


def empty_memory(count: int, dt: float) -> TrackBatch:
    """Return the memory before the first observation.

    Args:
        count: number of environments.
        dt: time between two decisions [s].

    >>> empty_memory(2, 0.1).length
    14
    """
    longest = (WINDOW_STEPS - 1) * STEP
    return TrackBatch.empty(count, math.ceil(longest / max(dt, SPACING) - SAME) + 1)


def with_memory(batch: ObservationBatch, memory: TrackBatch) -> ObservationBatch:
    """Return the observations with a memory instead of the velocities of people.

    A velocity becomes that from where the person was ESTIMATE or half of it ago, or 0 for who was not seen then.

    Args:
        batch: what the robot knows in N environments.
        memory: where the robot and people were, after :func:`remember` of this batch.

    >>> from crowdbot.navigation import DriveLimits
    >>> batch = with_memory(ObservationBatch(pose=np.zeros((1, 3)), goal=np.ones((1, 2)), radius=np.full(1, 0.3),
    ...     limits=DriveLimits(1.0, 2.0), dt=0.25), empty_memory(1, 0.25))
    >>> len(batch.tracks)
    1
    """
    people = batch.people
    velocity = np.zeros(people.position.shape)
    _estimate_velocities(
        batch.time, people.position, people.seen, people.ids, memory.times, memory.ids, memory.people,
        memory.position, velocity,
    )  # fmt: skip
    return dataclasses.replace(batch, people=dataclasses.replace(people, velocity=velocity), tracks=memory)


class RecurrentInputs(NamedTuple):
    """Inputs of the recurrent policy in N environments, in the goal frame: x towards the waypoint.

    Fields:
        axis: ``[N, 2]`` x axis of the goal frame, in the world.
        own: ``[N, 8]`` OWN_VALUES and FACING_VALUES.
        windows: ``[N, 1 + K, 6, 4]`` WINDOW_VALUES of the robot and of the nearest people, nearest first, oldest step
            first.
        steps: ``[N, 1 + K]`` number of steps that are known; they are the last ones.
        bodies: ``[N, K, 3]`` BODY_VALUES.
        present: ``[N]`` number of people.
        walls: ``[N, 32]`` nearness of walls, as in :class:`AttentionInputs`.
    """

    axis: Floats
    own: Floats
    windows: Floats
    steps: Ints
    bodies: Floats
    present: Ints
    walls: Floats


def recurrent_inputs(
    batch: ObservationBatch, asking: NDArray[np.bool_] | None = None, speed: float = np.inf
) -> RecurrentInputs:
    """Return the inputs of the recurrent policy for N observations; the velocities of people have no effect.

    Args:
        batch: what the robot knows in N environments, from :func:`with_memory`.
        asking: ``[N]`` environments to fill; default all.
        speed: largest speed [m/s], limited by the drive.

    >>> from crowdbot.navigation import DriveLimits
    >>> batch = ObservationBatch(pose=np.zeros((1, 3)), goal=np.array([[4.0, 0.0]]), radius=np.full(1, 0.3),
    ...     limits=DriveLimits(1.0, 2.0), dt=0.25)
    >>> found = recurrent_inputs(with_memory(batch, remember(empty_memory(1, 0.25), batch)))
    >>> found.windows.shape, found.steps[0, :2].tolist()
    ((1, 13, 6, 4), [1, 0])
    """
    N, K, people, memory = len(batch), MOST_ATTENDED, batch.people, TrackBatch.of(batch.tracks)
    chosen = np.ones(N, np.bool_) if asking is None else asking
    known = attention_inputs(batch, chosen, speed)
    windows, steps = np.zeros((N, 1 + K, WINDOW_STEPS, len(WINDOW_VALUES))), np.zeros((N, 1 + K), np.int64)
    bodies, present = np.zeros((N, K, len(BODY_VALUES))), np.zeros(N, np.int64)
    _write_windows(
        chosen, batch.time, batch.pose, batch.radius, known.axis, people.position, people.radius, people.seen,
        people.ids, memory.times, memory.ids, memory.people, memory.position, windows, steps, bodies, present,
    )  # fmt: skip
    return RecurrentInputs(known.axis, known.own, windows, steps, bodies, present, known.walls)


@dataclass(frozen=True)
class RecurrentWeights(NetworkWeights):
    """Layers of the navigator ``recurrent-policy``; gates of the recurrent networks: reset, update, new.

    >>> RecurrentWeights.shapes()["spatial_state_weight"]
    (32, 96)
    """

    navigator: ClassVar[str] = "recurrent-policy"
    widths: ClassVar[Mapping[str, tuple[int, int]]] = (
        {
            "temporal_input": (len(WINDOW_VALUES), 3 * TEMPORAL),
            "temporal_state": (TEMPORAL, 3 * TEMPORAL),
            "spatial_input": (len(WINDOW_VALUES), 3 * SPATIAL),
            "spatial_state": (SPATIAL, 3 * SPATIAL),
        }
        | dense_layers("person", SPATIAL + len(BODY_VALUES) + _OWN, EMBEDDING, EMBEDDING)
        | {"query": (TEMPORAL + _OWN, MATCH), "key": (EMBEDDING, MATCH)}
        | dense_layers("action", EMBEDDING + TEMPORAL + _OWN + WALL_DIRECTIONS, WIDE, WIDE, 2)
    )

    temporal_input_weight: Singles
    temporal_input_bias: Singles
    temporal_state_weight: Singles
    temporal_state_bias: Singles
    spatial_input_weight: Singles
    spatial_input_bias: Singles
    spatial_state_weight: Singles
    spatial_state_bias: Singles
    person1_weight: Singles
    person1_bias: Singles
    person2_weight: Singles
    person2_bias: Singles
    query_weight: Singles
    query_bias: Singles
    key_weight: Singles
    key_bias: Singles
    action1_weight: Singles
    action1_bias: Singles
    action2_weight: Singles
    action2_bias: Singles
    action3_weight: Singles
    action3_bias: Singles


@kernel
def _run_over(
    window: Floats, steps: int, weight: Floats, bias: Floats, state_weight: Floats, state_bias: Floats, gates: Floats,
    state: Floats,
) -> None:  # fmt: skip
    """Write the state ``[H]`` of a gated recurrent unit after the last steps of a window ``[T, F]``, from 0.

    ``gates [2, 3 H]`` is space for the gates reset, update and new, of the input and of the state (Cho et al. 2014).
    """
    H = len(state)
    state[:] = 0.0
    for t in range(len(window) - steps, len(window)):
        apply_layer(window[t], window.shape[1], weight, bias, False, gates[0])
        apply_layer(state, H, state_weight, state_bias, False, gates[1])
        for j in range(H):
            reset = 1.0 / (1.0 + math.exp(-(gates[0, j] + gates[1, j])))
            update = 1.0 / (1.0 + math.exp(-(gates[0, H + j] + gates[1, H + j])))
            new = math.tanh(gates[0, 2 * H + j] + reset * gates[1, 2 * H + j])
            state[j] = new + update * (state[j] - new)


@kernel
def apply_recurrent(
    asking: NDArray[np.bool_], own: Floats, windows: Floats, steps: Ints, bodies: Floats, count: Ints, walls: Floats,
    out: Floats, ti: Floats, tib: Floats, ts: Floats, tsb: Floats, si: Floats, sib: Floats, ss: Floats, ssb: Floats,
    w1: Floats, b1: Floats, w2: Floats, b2: Floats, wq: Floats, bq: Floats, wk: Floats, bk: Floats,
    w3: Floats, b3: Floats, w4: Floats, b4: Floats, w5: Floats, b5: Floats,
) -> None:  # fmt: skip
    """Write the outputs ``[N, 2]`` of the network for inputs of :func:`recurrent_inputs`.

    A recurrent network runs over the window of the robot, another one over that of each person. Two layers embed the
    state of a person with its values and those of the robot. The scalar product of a key of each embedding with a query
    of the robot weighs, through the softmax, the sum of the embeddings. Sum, state and values of the robot, and walls
    pass two layers and a linear one.
    """
    F, G, K, D, S, R, M = own.shape[1], bodies.shape[2], bodies.shape[1], len(b2), len(ss), len(ts), len(bq)
    joined, asked = np.empty(D + R + F + walls.shape[1]), np.empty(R + F)
    person, first, embedded = np.empty(S + G + F), np.empty(len(b1)), np.empty((K, D))
    query, key, weight = np.empty(M), np.empty(M), np.empty(K)
    third, fourth = np.empty(len(b3)), np.empty(len(b4))
    temporal, spatial = np.empty((2, 3 * R)), np.empty((2, 3 * S))
    for e in range(len(own)):
        if not asking[e]:
            continue
        n = count[e]
        joined[:D] = 0.0
        joined[D + R : D + R + F], joined[D + R + F :], asked[R:] = own[e], walls[e], own[e]
        _run_over(windows[e, 0], steps[e, 0], ti, tib, ts, tsb, temporal, asked[:R])
        joined[D : D + R] = asked[:R]
        apply_layer(asked, R + F, wq, bq, False, query)
        person[S + G :] = own[e]
        largest = -math.inf
        for k in range(n):
            _run_over(windows[e, 1 + k], steps[e, 1 + k], si, sib, ss, ssb, spatial, person[:S])
            person[S : S + G] = bodies[e, k]
            apply_layer(person, S + G + F, w1, b1, True, first)
            apply_layer(first, len(b1), w2, b2, True, embedded[k])
            apply_layer(embedded[k], D, wk, bk, False, key)
            weight[k] = 0.0
            for j in range(M):
                weight[k] += query[j] * key[j] / math.sqrt(M)
            largest = max(largest, weight[k])
        total = 0.0
        for k in range(n):
            weight[k] = math.exp(weight[k] - largest)
            total += weight[k]
        for k in range(n):
            for j in range(D):
                joined[j] += weight[k] / total * embedded[k, j]
        apply_layer(joined, len(joined), w3, b3, True, third)
        apply_layer(third, len(b3), w4, b4, True, fourth)
        apply_layer(fourth, len(b4), w5, b5, False, out[e])


@dataclass(frozen=True)
class RecurrentPolicyNavigator(LearnedNavigator):
    """Moves as a graph of recurrent networks over where people were, without their velocities, trained in crowds.

    The network knows where the nearest 12 people within 10 m, and the robot, were in the last 1.25 s, in 6 steps that
    its memory is interpolated to, the radii, and the walls within 4 m in 32 directions. Somebody who was seen for a
    shorter time has fewer steps. A recurrent network for the robot (temporal edge) and one for each person, with shared
    weights (spatial edges), run over these steps, and attention weighs the people. With neither people nor walls there,
    the robot goes to its waypoint. The decision does not depend on the velocities of an observation, in which the
    motion of people is often less certain than their places: the realisation of the velocity is that of ``policy`` and
    ``attention-policy``, with velocities of people from where they were up to 0.5 s ago, 0 for who was not seen then.

    It is a form of DS-RNN with a finite past: the states of DS-RNN run over the whole episode, and its node of the
    robot is recurrent; here the states begin anew at every decision, from a window, and the node is not recurrent. So
    plain PPO trains it, and the memory is a list of positions. DS-RNN knows no walls.

    Fields:
        speed: largest speed [m/s], limited by the drive.
        horizon: time for which people are expected to walk straight [s]; 0: the velocity of the network is not changed.
        margin: clearance to people that is kept for this time [m].
        file: file of weights from ``examples/train_navigator.py``, in a trial relative to its folder (default: the
            weights of the package).

    Sources: structure, Liu et al. 2021, doi:10.1109/ICRA48506.2021.9561595; gated recurrent unit, Cho et al. 2014,
    doi:10.3115/v1/D14-1179; proximal policy optimisation, Schulman et al. 2017, https://arxiv.org/abs/1707.06347.

    Raises:
        InputError: a number is out of its range.

    >>> from crowdbot.navigation import DriveLimits
    >>> limits = DriveLimits(1.0, 2.0, holonomic=True)
    >>> here = Observation(pose=(0.0, 0.0, 0.0), goal=(0.0, 4.0), radius=0.3, limits=limits, dt=0.25)
    >>> navigator = RecurrentPolicyNavigator()
    >>> action, memory = navigator.act(here, navigator.begin(here))
    >>> action.twist.left > 0.5, len(memory[0].times)
    (True, 1)
    """

    paper: ClassVar[Paper] = Paper(
        "Liu et al.",
        2021,
        "Decentralized structural-RNN for robot crowd navigation with deep reinforcement learning",
        "ICRA",
        "10.1109/ICRA48506.2021.9561595",
    )
    network = RecurrentWeights
    always_returns = True

    def begin(self, observation: Observation) -> TrackBatch:
        return empty_memory(1, observation.dt)

    def act(  # type: ignore[override]  # the form of a navigator with memory
        self, observation: Observation, memory: TrackBatch
    ) -> tuple[Action, TrackBatch]:
        batch, out, asking = as_batch(observation), np.zeros((1, 3)), np.ones(1, np.bool_)
        memory = remember(memory, batch)
        self._move(with_memory(batch, memory), asking, out)
        return Action(Twist(*out[0].tolist())), memory

    def shares(self, batch: ObservationBatch, asking: NDArray[np.bool_]) -> tuple[Floats, Floats]:
        inputs, shares = recurrent_inputs(batch, asking, self.speed), np.zeros((len(batch), 2))
        layers: Any = read_layers(self.network, self.file)
        apply_recurrent(
            asking, inputs.own, inputs.windows, inputs.steps, inputs.bodies, inputs.present, inputs.walls, shares,
            *layers,
        )  # fmt: skip
        shares[(inputs.present == 0) & ~inputs.walls.any(axis=1)] = (1.0, 0.0)  # towards the waypoint
        return inputs.axis, shares
