"""Recipe: a named set of trials, sensors and seeds to generate data from."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from crowdbot.core import UnknownName


@dataclass(frozen=True)
class Recipe:
    """A named set of trials, sensors and seeds.

    Fields:
        name: name of the recipe.
        about: one sentence.
        trials: names of built-in trials, each with the values of its parameters.
        sensors: sensor presets that the robot carries in addition to its own.
        seeds: number of seeds.
        source: where the set of data is described.
    """

    name: str
    about: str
    trials: tuple[tuple[str, Mapping[str, str]], ...]
    sensors: tuple[str, ...]
    seeds: int
    source: str = ""


REPORT = "CrowdBot deliverable D4.2, section 3.7: data for perception, with and against the flow of people"
_DENSITIES = tuple({"density": text} for text in ("0.1", "0.3", "0.6"))

RECIPES: Mapping[str, Recipe] = MappingProxyType(
    {
        one.name: one
        for one in (
            Recipe(
                "flow",
                "A robot goes with and against a flow of people at three densities, with a planar scanner.",
                tuple((name, values) for name in ("one-way-with", "one-way-against") for values in _DENSITIES),
                ("sick-tim571",),
                10,
                REPORT,
            ),
            Recipe(
                "corridor-clouds",
                "A robot crosses a two-way flow of people with a 3-D scanner.",
                (("crossing-flows", {}),),
                ("velodyne-vlp-16",),
                5,
            ),
        )
    }
)
"""Built-in recipes, by name."""


def find_recipe(name: str) -> Recipe:
    """Return a built-in recipe.

    Raises:
        UnknownName: there is no recipe of this name.

    >>> find_recipe("flow").sensors
    ('sick-tim571',)
    """
    if name not in RECIPES:
        raise UnknownName("recipe", name, RECIPES)
    return RECIPES[name]
