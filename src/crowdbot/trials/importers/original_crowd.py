"""Crowd models of the original files, with the parameters of each person."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from crowdbot import models
from crowdbot.core import Element, InputError, TrialError, parameters, parse_number
from crowdbot.models import CrowdModel
from crowdbot.trials.agent import AgentParameter
from crowdbot.trials.crowd import Crowds

KINDS: dict[str, tuple[type[CrowdModel], dict[str, str]]] = {
    "RVOconfig": (
        models.ORCA,
        {
            "neighborDist": "neighbor_distance",
            "maxNeighbors": "max_neighbors",
            "timeHorizon": "time_horizon",
            "timeHorizonObst": "time_horizon_walls",
        },
    ),
    "VOGConfig": (
        models.VOG,
        {
            "neighborDist": "neighbor_distance",
            "maxNeighbors": "max_neighbors",
            "timeHorizon": "time_horizon",
            "timeHorizonObst": "wall_horizon",
            "weightPrefVel": "preference_weight",
            "weightGroup": "group_weight",
            "neighbourNum": "group_neighbors",
            "neighbourDist": "group_radius",
            "neighbourDetectionDist": "group_distance",
            "horizonTime": "group_horizon",
        },
    ),
    "VBMConfig": (
        models.VBM,
        {
            "neighborAgentDist": "neighbor_distance",
            "neighborWallDist": "wall_distance",
            "sigTtca": "time_scale",
            "sigDca": "distance_scale",
            "sigSpeed": "speed_scale",
            "sigAngle": "angle_scale",
        },
    ),
    "HelbingConfig": (models.SocialForce, {"neighborDist": "neighbor_distance"}),
    "TangentConfig": (
        models.Tangent,
        {
            "personalArea": "personal_area",
            "g_beta": "direction_error",
            "g_gamma": "speed_error",
            "timeHorizon": "time_horizon",
            "maxNeighbors": "max_neighbors",
        },
    ),
    "UMANSconfig": (models.ORCA, {}),
}
KINDS["RosSimConfig"] = KINDS["RVOconfig"]
CLOSED = {
    "HelbingConfig": "its binary is closed: the social force model replaces it",
    "TangentConfig": "its binary is closed: the tangent model replaces it",
    "UMANSconfig": "its policies are in another file: ORCA replaces it",
}


@dataclass(frozen=True)
class Walker:
    """An agent of an original trial: its element, control law, simulator and radius [m]."""

    element: Element
    law: Element
    sim: Element | None
    radius: float

    @property
    def kind(self) -> str:
        """Type of its simulator."""
        return self.sim.tag if self.sim is not None and self.sim.tag in KINDS else "RVOconfig"

    @property
    def crowd(self) -> str:
        """Name of its crowd."""
        return self.kind.removesuffix("onfig").removesuffix("C").removesuffix("c")

    @property
    def speed(self) -> float:
        """Preferred speed [m/s], from the simulator if it has one, otherwise from the control law."""
        return max(
            0.05,
            _value(self.sim, "prefered_speed")
            or _value(self.sim, "speedComfort")
            or _value(self.law, "speedDefault")
            or 1.33,
        )

    @property
    def group(self) -> int:
        """Number of its group, -1 without a group."""
        inner = [child for child in self.sim.children if child.tag == "group"] if self.sim else []
        found = _value(inner[0], "groupID") if inner else _value(self.sim, "groupID")
        return int(found) if found is not None and found >= 0.0 else -1

    def parameters(self) -> dict[str, float]:
        """Return the parameters of the model in the file."""
        if self.sim is None:
            return {}
        model, words = KINDS[self.kind]
        known = {row.name for row in parameters(model)}
        places = (self.sim, *(child for child in self.sim.children if child.tag == "group"))
        result = {}
        for place in places:
            for word, name in words.items():
                value = _value(place, word)
                if value is not None and name in known:
                    result[name] = value
        return result


def crowds_of(walkers: Sequence[Walker], note: Callable[[str], None]) -> tuple[CrowdModel, list[dict[str, Any]]]:
    """Return the crowd model of all agents, and the individual fields of each :class:`Agent`."""
    kinds = list(dict.fromkeys(walker.kind for walker in walkers)) or ["RVOconfig"]
    rows = [walker.parameters() for walker in walkers]
    made: dict[str, CrowdModel] = {}
    for kind in kinds:
        if kind in CLOSED:
            note(f"the simulator {kind}: {CLOSED[kind]}")
        first = next((row for row, walker in zip(rows, walkers, strict=True) if walker.kind == kind), {})
        made[kind] = _model(KINDS[kind][0], first, note)
    for walker in walkers:
        if walker.sim is not None and walker.sim.tag not in KINDS:
            note(f"the simulator {walker.sim.tag}: ORCA replaces it")
    own = []
    for row, walker in zip(rows, walkers, strict=True):
        model = made[walker.kind]
        different = [
            AgentParameter(name.replace("_", "-"), value)
            for name, value in row.items()
            if getattr(model, name) != value
        ]
        own.append({"parameters": tuple(different)} if different else {})
    if len(kinds) == 1:
        return made[kinds[0]], own
    names = [Walker(Element(""), Element(""), Element(kind), 0.0).crowd for kind in kinds]
    return Crowds(tuple(made.values()), names=tuple(names)), own


def _model(kind: type[CrowdModel], values: dict[str, float], note: Callable[[str], None]) -> CrowdModel:
    try:
        return kind(**values)
    except InputError as error:
        note(f"parameters of {kind.__name__}: {error}")
        return kind()


def _value(element: Element | None, key: str) -> float | None:
    if element is None:
        return None
    inner = next((child.stray for child in element.children if child.tag == key), "")
    text = element.attributes.get(key, inner)
    if not text:
        return None
    try:
        value = parse_number(text.replace(",", "."))
    except InputError as error:
        raise TrialError(f"line {element.line}: <{element.tag[:40]}> {key}={text[:40]!r} {error}") from None
    return min(max(value, -1e6), 1e6)
