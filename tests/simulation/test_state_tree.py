"""The state of a simulation as plain values: complete, exact, and refused when it does not fit."""

from __future__ import annotations

import dataclasses
import hashlib
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import InputError
from crowdbot.navigation import Navigator, Observation
from crowdbot.simulation import (
    AddPersonOrder,
    EpisodeDigest,
    RemoveOrder,
    ResumableHash,
    Simulation,
    StateError,
    StateMark,
    decode_state,
    encode_state,
    restore_state,
    state_of,
)
from crowdbot.trials import Trial, builtin_trials, load_trial, parse_trial
from samples import sample
from space_trials import LEAN, room
from trial_texts import FLOW

SENSORS = """<trial name="eyes" duration="4" step="0.05" seed="4">
  <stage walkable="-6,-3 6,-3 6,3 -6,3"/>
  <crowd type="orca"/>
  <spawner name="east" count="3" zone="-1,-2 3,-2 3,1 -1,1" goal="4,-2 5,-2 5,1 4,1"/>
  <robot name="robot" x="-3" y="-2.4" radius="0.3" latency="0.2">
    <goal x="3" y="-2.4"/>
    <drive type="differential-drive" max-speed="1"/>
    <navigator type="straight"/>
    <sensor name="scan" x="0.1" type="lidar2d" rays="90" noise="gaussian(0.01)" delay="0.12"/>
    <sensor name="us" x="0.2" heading="0.5" type="ultrasound"/>
    <sensor name="imu" type="imu" rate="20"/>
    <sensor name="wheels" type="wheel-odometry" noise="gaussian(0.01)"/>
    <sensor name="bumper" type="bumper"/>
    <sensor name="people" type="ground-truth-people"/>
  </robot>
  <end collision="false"/>
</trial>
"""
TRIALS = {
    "flow": parse_trial(FLOW),
    "sensors": parse_trial(SENSORS),
    "planar": parse_trial(room("planar", LEAN)),
    "physics": parse_trial(room("physics", LEAN)),
}


def advanced(trial: Trial, seeds: Any, steps: int) -> Simulation:
    simulation = Simulation(trial, seeds)
    for _ in range(steps):
        simulation.advance()
    return simulation


def digest(simulation: Simulation, steps: int) -> str:
    """Advance, and return the digest of the records of all environments."""
    episode_digest = EpisodeDigest()
    for _ in range(steps):
        simulation.advance()
        for e in range(simulation.count):
            episode_digest.take(simulation.record(e))
    return episode_digest.hexdigest("")


def restored(trial: Trial, seeds: Any, simulation: Simulation) -> Simulation:
    new = Simulation(trial, seeds)
    restore_state(new, decode_state(encode_state(state_of(simulation))))
    return new


@pytest.mark.parametrize(
    ("name", "seeds"), [("flow", 3), ("flow", [1, 2, 3]), ("sensors", 5), ("planar", 2), ("physics", 2)]
)
@given(tick=st.integers(0, 25))
@settings(max_examples=4, deadline=None)
def test_a_restored_simulation_continues_to_the_last_bit(name: str, seeds: Any, tick: int) -> None:
    trial = TRIALS[name]
    first = advanced(trial, seeds, tick)
    second = restored(trial, seeds, first)
    assert encode_state(state_of(second)) == encode_state(state_of(first))
    assert digest(second, 8) == digest(first, 8)
    assert encode_state(state_of(second)) == encode_state(state_of(first))


@pytest.mark.parametrize("name", sample(builtin_trials(), ["frontal", "bottleneck", "two-crowds"]))
def test_every_field_of_the_state_of_a_builtin_trial_is_stored_or_constant(name: str) -> None:
    """This fails if somebody adds state that is neither stored nor declared constant by its class."""
    trial = load_trial(name)
    tick = 10 + int(hashlib.blake2b(name.encode()).hexdigest(), 16) % 60
    first = advanced(trial, 7, tick)
    second = restored(trial, 7, first)
    assert digest(second, 30) == digest(first, 30)
    assert encode_state(state_of(second)) == encode_state(state_of(first))


@pytest.mark.parametrize("name", sample(["frontal", "passing-group"], []))
def test_every_field_of_the_state_of_a_builtin_physics_trial_is_stored_or_constant(name: str) -> None:
    trial = load_trial(name, world="physics")
    first = advanced(trial, 7, 30)
    second = restored(trial, 7, first)
    assert digest(second, 15) == digest(first, 15)


def test_an_added_field_is_stored_and_an_unknown_class_is_refused_with_its_place() -> None:
    simulation = advanced(TRIALS["flow"], 1, 2)
    assert "simulation/world/_traffic/extra" not in state_of(simulation)
    simulation.world._traffic.extra = 0.5  # type: ignore[attr-defined]
    assert state_of(simulation)["simulation/world/_traffic/extra"] == 0.5
    simulation.world._traffic.extra = object()  # type: ignore[attr-defined]
    with pytest.raises(StateError, match="simulation/world/_traffic/extra is a object, which cannot be stored"):
        state_of(simulation)


def engine_arrays(simulation: Simulation) -> dict[str, np.ndarray]:
    """Return the arrays of all engine states that a step reads, and the limbs of people in the models."""
    rigid: Any = simulation.world.rigid  # type: ignore[attr-defined]
    names = ["qpos", "qvel", "qacc_warmstart", "ctrl", "qfrc_applied", "xpos", "xquat", "xmat", "geom_xpos", "cvel"]
    found = {f"{k}/{name}": np.array(getattr(part.data, name)) for k, part in enumerate(rigid.parts) for name in names}
    return found | {f"shapes/{name}": array for name, array in rigid.people.shapes._asdict().items()}


def test_all_arrays_of_the_physics_engine_are_equal_after_a_restore() -> None:
    first = advanced(TRIALS["physics"], 2, 25)
    second = restored(TRIALS["physics"], 2, first)
    one, two = engine_arrays(first), engine_arrays(second)
    assert [name for name in one if not np.array_equal(one[name], two[name])] == []
    assert len(one) > 15


def test_people_whom_orders_have_added_are_restored() -> None:
    first = advanced(TRIALS["planar"], 1, 5)
    for x in (1.0, 2.0, 3.0):
        AddPersonOrder(x=x, y=1.0, goal_x=x, goal_y=-1.0).apply(first)
    RemoveOrder(person=0).apply(first)
    first.advance()
    second = restored(TRIALS["planar"], 1, first)
    assert second.world.scene.shape == first.world.scene.shape
    assert digest(second, 10) == digest(first, 10)


class Diary:
    """A class of a user."""


class Keeper(Navigator):
    """A navigator whose memory is an object of an unknown class."""

    def begin(self, observation: Observation) -> Any:
        return Diary()

    def act(self, observation: Observation, memory: Any) -> Any:  # type: ignore[override]
        from crowdbot.core import Twist
        from crowdbot.navigation import Action

        return Action(Twist(0.1, 0.0)), memory


def test_a_memory_of_an_unknown_class_is_refused_in_a_sentence() -> None:
    trial = TRIALS["sensors"]
    robot = dataclasses.replace(trial.robots[0], navigator=Keeper())
    simulation = advanced(dataclasses.replace(trial, robots=(robot,)), 1, 2)
    with pytest.raises(StateError, match="simulation/robots/0/memories/0 is a Diary, which cannot be stored"):
        state_of(simulation)


CHANGES: dict[str, tuple[Any, str]] = {
    "simulation/world/scene/position": (np.zeros((1, 2, 2)), "has the shape"),
    "simulation/world/scene/active": (np.zeros((1, 3)), "of float64, but the trial has 2 of bool"),
    "simulation/world": (StateMark("list", 3), "lacks|is a list, but the trial has a PlanarWorld"),
    "simulation/robots/0/command": (StateMark("same", "simulation/nowhere"), "which is not before it"),
    "simulation/world/_rngs/_streams/0/made": (StateMark("random", {"bit_generator": "PCG64"}), "not the state of a"),
    "simulation/world/contacts": (StateMark("value", "Popen"), "'Popen', which is unknown"),
    "simulation/world/environment_time/ticks": (np.array([-1]), "outside 0 to 2"),
    "simulation/world/scene/time": ("now", "str"),
    "simulation/more": (1, "'simulation/more', which this trial does not have"),
}


@pytest.mark.parametrize("path", CHANGES)
def test_a_state_that_does_not_fit_is_refused_in_a_sentence(path: str) -> None:
    value, sentence = CHANGES[path]
    state = state_of(advanced(TRIALS["sensors"], 1, 3))
    with pytest.raises(StateError, match=sentence):
        restore_state(Simulation(TRIALS["sensors"], 1), state | {path: value})


@given(data=st.data())
@settings(max_examples=15, deadline=None)
def test_any_missing_path_is_refused(data: st.DataObject) -> None:
    state = state_of(advanced(TRIALS["planar"], 1, 1))
    path = data.draw(st.sampled_from(sorted(state)))
    with pytest.raises(StateError, match="lacks|not before it|does not have"):
        restore_state(Simulation(TRIALS["planar"], 1), {k: v for k, v in state.items() if k != path})


def test_the_state_of_another_trial_is_refused() -> None:
    with pytest.raises(StateError):
        restore_state(Simulation(TRIALS["planar"], 1), state_of(advanced(TRIALS["flow"], 1, 1)))


def answer(data: bytes, simulation: Simulation | None = None) -> object:
    """Return the state in bytes, or the sentence of its refusal; with a simulation, it is restored."""
    try:
        result = decode_state(data)
        if simulation is not None:
            restore_state(simulation, result)
    except StateError as error:
        return str(error)
    return result


@given(place=st.floats(0, 1, exclude_max=True), value=st.integers(0, 255), cut=st.booleans())
@settings(max_examples=150, deadline=None)
def test_damaged_bytes_are_a_state_or_refused_in_a_sentence(place: float, value: int, cut: bool) -> None:
    data = bytearray(PACKED)
    k = int(place * len(data))
    data[k] = value
    assert answer(bytes(data[:k]) if cut else bytes(data))


@given(place=st.floats(0, 1, exclude_max=True), value=st.integers(0, 255))
@settings(max_examples=25, deadline=None)
def test_a_damaged_table_is_a_state_or_refused_in_a_sentence(place: float, value: int) -> None:
    import zstandard

    whole = bytearray(zstandard.ZstdDecompressor().decompress(PACKED))
    whole[int(place * len(whole))] = value
    assert answer(zstandard.ZstdCompressor().compress(bytes(whole)), Simulation(TRIALS["planar"], 1))


def test_a_state_that_claims_too_much_is_not_read() -> None:
    import zstandard

    bomb = zstandard.ZstdCompressor().compress(b"\0" * ((1 << 28) + 1))
    with pytest.raises(StateError, match="a state claims 268435457 bytes; at most 268435456 are read"):
        decode_state(bomb)


PACKED = encode_state(state_of(advanced(TRIALS["planar"], 1, 3)))


@given(parts=st.lists(st.binary(max_size=700), max_size=8), cut=st.integers(0, 8))
@settings(max_examples=60, deadline=None)
def test_a_stored_hash_continues_as_that_of_hashlib(parts: list[bytes], cut: int) -> None:
    known, found = hashlib.blake2b(digest_size=16), ResumableHash()
    for k, part in enumerate(parts):
        found = ResumableHash.of(found.state) if k == cut else found
        found.update(part)
        known.update(part)
    assert found.copy().hexdigest() == known.hexdigest() == found.hexdigest()


@pytest.mark.parametrize("state", [{}, {"words": np.zeros(8), "length": 0, "rest": np.zeros(0, dtype=np.uint8)}])
def test_a_wrong_state_of_a_hash_is_refused(state: dict[str, Any]) -> None:
    with pytest.raises(InputError, match="the state of a hash needs words"):
        ResumableHash.of(state)
