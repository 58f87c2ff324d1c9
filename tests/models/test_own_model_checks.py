"""check_model and check_goal accept models and goals that keep the contract, and name the rule that others break."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest

from crowdbot import models
from crowdbot.core import InputError, Paper, Scene, builtin_classes
from crowdbot.data import Windows
from crowdbot.models import CrowdModel, Goal, check_goal, check_model
from crowdbot.models.goals import Choices
from crowdbot.models.model import desired_velocity

PAPER = Paper("Nobody", 2020, "Walking straight", "Nowhere")
CHEAP = ("orca", "power-law", "social-force", "boids")


def model(velocity: Callable[[Scene, np.random.Generator | None], np.ndarray], **attributes: object) -> CrowdModel:
    """Return a model with this rule."""

    def rule(self: CrowdModel, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> np.ndarray:
        return velocity(scene, rng)

    kind = type("Own", (CrowdModel,), {"velocity": rule, "paper": PAPER, **attributes})
    return dataclass(frozen=True)(kind)()  # type: ignore[no-any-return]


def walk(scene: Scene, rng: np.random.Generator | None = None) -> np.ndarray:
    return np.where(scene.external[..., None], scene.velocity, desired_velocity(scene, 0.1))


def push_external(scene: Scene, rng: np.random.Generator | None) -> np.ndarray:
    return desired_velocity(scene, 0.1) * np.where(scene.active, 1.0, 0.0)[..., None]


def move_absent(scene: Scene, rng: np.random.Generator | None) -> np.ndarray:
    return np.where(scene.active[..., None], walk(scene), 1.0)


def write(scene: Scene, rng: np.random.Generator | None) -> np.ndarray:
    result = walk(scene)
    scene.position.flags.writeable = True
    scene.position[...] += 1.0
    return result


def mix_environments(scene: Scene, rng: np.random.Generator | None) -> np.ndarray:
    own = scene.active & ~scene.external
    return walk(scene) + np.where(own[..., None], 0.01 * scene.shape[0], 0.0)


def vanish(scene: Scene, rng: np.random.Generator | None) -> np.ndarray:
    found = walk(scene)
    return np.where(scene.time > 1.85, np.inf, found) if scene.shape[1] == 1 else found


class Chance:
    """A generator of its own, outside of the one that is given."""

    rng = np.random.default_rng(0)


def gamble(scene: Scene, rng: np.random.Generator | None) -> np.ndarray:
    own = scene.active & ~scene.external
    return walk(scene) + np.where(own[..., None], Chance.rng.random(), 0.0)


@pytest.mark.parametrize(
    ("rule", "message"),
    [
        (lambda scene, rng: walk(scene)[0], r"Own.velocity returned shape \[12, 2\], it must be \[E, A, 2\] = "),
        (lambda scene, rng: walk(scene) * np.nan, "Own.velocity returned values that are not finite"),
        (gamble, "Own.velocity is not deterministic"),
        (push_external, "Own.velocity changes external agents"),
        (move_absent, "Own.velocity moves absent agents"),
        (write, "Own.velocity (changes the scene|is not deterministic)"),
        (mix_environments, "Own.velocity of environment 0 differs when it is computed alone"),
        (vanish, "the position of a single person is not finite after 20 steps"),
    ],
)
def test_a_model_that_breaks_a_rule_is_told_which(rule: Callable[..., np.ndarray], message: str) -> None:
    with pytest.raises(InputError, match=message), np.errstate(invalid="ignore"):
        check_model(model(rule))


def test_a_model_that_keeps_the_rules_passes() -> None:
    assert check_model(model(walk)) is None


@pytest.mark.parametrize("name", CHEAP)
def test_models_of_the_package_pass(name: str) -> None:
    assert check_model(builtin_classes(models, CrowdModel)[name]()) is None


class Thawed(CrowdModel):
    paper = PAPER

    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> np.ndarray:
        return walk(scene)


def test_what_is_no_frozen_model_with_a_paper_is_refused() -> None:
    with pytest.raises(InputError, match="str is not a CrowdModel"):
        check_model("orca")  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r"Own.paper is missing"):
        check_model(model(walk, paper=None))
    thawed = type("Thawed", (), {"velocity": Thawed.velocity, "paper": PAPER})
    CrowdModel.register(thawed)
    with pytest.raises(InputError, match=r"Thawed is not frozen; decorate the class with @dataclass\(frozen=True\)"):
        check_model(thawed())  # type: ignore[arg-type]


def goal(resolve: Callable[[Windows], np.ndarray], choices: Callable[[Windows], Choices] | None = None) -> Goal:
    """Return a goal with this rule."""
    body: dict[str, object] = {"resolve": lambda self, past: resolve(past)}
    if choices is not None:
        body["choices"] = lambda self, past: choices(past)
    return dataclass(frozen=True)(type("Own", (Goal,), body))()  # type: ignore[no-any-return]


def stay(past: Windows) -> np.ndarray:
    return np.where(past.present[:, -1, :, None], past.position[:, -1], 0.0)


def spoil(past: Windows) -> np.ndarray:
    result = stay(past).copy()
    past.position[...] += 1.0
    return result


def weigh(factor: float) -> Callable[[Windows], Choices]:
    return lambda past: Choices(stay(past)[:, :, None], factor * past.present[:, -1, :, None])


def off_center(past: Windows) -> np.ndarray:
    return np.where(past.present[:, -1, :, None], past.position[:, -1] + len(past), 0.0)


@pytest.mark.parametrize(
    ("own", "message"),
    [
        (goal(lambda past: stay(past)[..., 0]), r"Own.resolve returned shape .* it must be \[W, A, 2\]"),
        (goal(lambda past: stay(past) / 0.0), "Own.resolve must be finite"),
        (goal(lambda past: stay(past) + 1.0), "and 0 for people who are absent at the last row"),
        (goal(spoil), "Own.resolve changes past.position"),
        (goal(lambda past: stay(past) * (1.0 + past.scored[..., None])), "Own.resolve uses past.scored"),
        (goal(off_center), "Own.resolve of window 0 differs when it is computed alone"),
        (goal(stay, weigh(0.5)), "Own.choices: the weights of a person who is present must sum to 1"),
        (goal(stay, weigh(-1.0)), "Own.choices: the weights"),
    ],
)
def test_a_goal_that_breaks_a_rule_is_told_which(own: Goal, message: str) -> None:
    with pytest.raises(InputError, match=message), np.errstate(all="ignore"):
        check_goal(own)


def test_goals_that_keep_the_rules_pass() -> None:
    assert check_goal(goal(stay)) is None
    assert check_goal(goal(stay, weigh(1.0))) is None
    assert check_goal(models.CurrentDirection()) is None
    with pytest.raises(InputError, match="int is not a Goal"):
        check_goal(3)  # type: ignore[arg-type]
