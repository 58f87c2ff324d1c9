"""Presets: crowd models with the headway layer and calibrated parameters, read from data files."""

from __future__ import annotations

import dataclasses
import functools
import importlib.resources
import json
import typing
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from crowdbot.core import kebab_case

from .headway.layer import HeadwayLayer, arguments_of, copy_field, make_class
from .model import CrowdModel
from .speed_models.collision_free_speed import CollisionFreeSpeed
from .valid_range import ModelRange

BASES: dict[str, type[CrowdModel]] = {"collision-free-speed": CollisionFreeSpeed}
"""Models that a preset file may name."""
DENSITY = "Walking speed and density in the documentation"
RANGES = {"people": ModelRange(2.0, "narrow two-way corridors are slower than in experiments", 0.05, DENSITY, DENSITY)}
"""Ranges of the presets."""


@dataclass(frozen=True)
class CrowdPreset:
    """A crowd model with calibrated parameters: what is in its file.

    Fields:
        name: name of the class, such as ``People``.
        about: one line.
        model: name of the model under the headway layer.
        parameters: value, and bounds of a calibration, of every parameter that differs from its default.
        data: recordings and published curves that the parameters are fitted to.
        held_back: recordings and starts that the errors are measured on.
        method: how the parameters are found.
        errors: measured errors, by check or recording.
        weaknesses: what the preset does not reproduce.
    """

    name: str
    about: str
    model: str
    parameters: Mapping[str, Mapping[str, float]]
    data: tuple[str, ...]
    held_back: tuple[str, ...]
    method: str
    errors: Mapping[str, str]
    weaknesses: tuple[str, ...]

    @property
    def key(self) -> str:
        """Name in trials and on the command line."""
        return kebab_case(self.name)


@functools.cache
def crowd_presets() -> Mapping[str, CrowdPreset]:
    """Return the presets by name.

    >>> crowd_presets()["people"].model
    'collision-free-speed'
    """
    folder = importlib.resources.files("crowdbot").joinpath("assets", "presets")
    files = sorted((item for item in folder.iterdir() if item.name.endswith(".json")), key=lambda one: one.name)
    found = (_preset(json.loads(file.read_text(encoding="utf-8"))) for file in files)
    return {preset.key: preset for preset in found}


def _preset(row: dict[str, Any]) -> CrowdPreset:
    lists = {name: tuple(row[name]) for name in ("data", "held_back", "weaknesses")}
    return CrowdPreset(**row | lists)


def _preset_class(name: str) -> type[CrowdModel]:
    """Return the class of a preset: the model with the layer, whose defaults are the values of the preset."""
    preset = crowd_presets()[name]
    kind = BASES[preset.model]
    fields = []
    for owner in (HeadwayLayer, kind):
        hints = typing.get_type_hints(owner)
        for field in dataclasses.fields(owner):
            fields.append((field.name, hints[field.name], _field(field, preset)))
    doc = (
        f"{preset.about}\n\nPreset of {preset.model} with the headway layer. {preset.method}\n\n"
        f"Args:\n{arguments_of(HeadwayLayer)}\n{arguments_of(kind)}"
    )
    made = make_class(preset.name, fields, kind, doc, RANGES.get(name))
    made.__module__ = __name__
    return made


def _field(field: dataclasses.Field[Any], preset: CrowdPreset) -> Any:
    row, given = field.metadata.get("parameter"), preset.parameters.get(field.name)
    if row is None or given is None:
        return copy_field(field)
    value = given["value"]
    low, high = given.get("low", row.low), given.get("high", row.high)
    source = f"preset {preset.key}"
    fitted = dataclasses.replace(row, default=value, low=low, high=high, source=source)
    return copy_field(field, default=value, metadata={**field.metadata, "parameter": fitted})


People = _preset_class("people")
