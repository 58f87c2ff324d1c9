"""Trials from scenarios of Vadere: topography, sources, targets and pedestrians.

Vadere: Kleinmeier, Zönnchen, Gödel, Köster 2019, Vadere: an open-source simulation framework to promote
interdisciplinary understanding, doi 10.17815/CD.2019.21. Files of version 1 and later are read.
"""

from __future__ import annotations

import json
import math
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from crowdbot import models
from crowdbot.core import TrialError
from crowdbot.core.fields import Points
from crowdbot.trials.agent import Agent
from crowdbot.trials.crowd import Routing
from crowdbot.trials.distribution import Distribution
from crowdbot.trials.journey import Journey
from crowdbot.trials.people import SourceSpec, Spawner
from crowdbot.trials.stage import Obstacle, Stage
from crowdbot.trials.trial import End, Trial
from crowdbot.trials.xml.trial_text import read_trial_bytes
from crowdbot.world import Zone

from .original import ImportedTrial

CIRCLE = 16
"""Corners of a circle."""
SILENT = (
    "attributes",
    "obstacles",
    "targets",
    "sources",
    "dynamicElements",
    "attributesPedestrian",
    "measurementAreas",
)
"""Parts of a topography that are imported, or that do not act on people."""


def import_vadere(path: str | Path) -> ImportedTrial:
    """Read a scenario of Vadere (JSON).

    Sources that spawn at one instant become spawners, others become sources. Targets of a person are the stops of a
    journey. The routing avoids obstacles, as the floor field of Vadere does.

    Raises:
        TrialError: the file is missing or malformed, or a part of it is not what Vadere writes.
    """
    path = Path(path)
    try:
        whole = json.loads(read_trial_bytes(path))
    except (ValueError, RecursionError) as error:
        raise TrialError(f"{path} is not JSON: {error}") from None
    scenario = whole.get("scenario") if isinstance(whole, dict) else None
    if not isinstance(scenario, dict) or not isinstance(scenario.get("topography"), dict):
        raise TrialError(f"{path} is not a scenario of Vadere: it lacks scenario and topography")
    reader = _Reader(path, scenario["topography"])
    trial = reader.trial(str(whole.get("name") or path.stem), scenario)
    return ImportedTrial(((path.stem, trial),), tuple(reader.notes))


@dataclass
class _Reader:
    """Converts a scenario, and notes what is not imported."""

    path: Path
    topography: dict[str, Any]
    notes: dict[str, None] = field(default_factory=dict)
    journeys: dict[tuple[int, ...], Journey] = field(default_factory=dict)

    def trial(self, name: str, scenario: dict[str, Any]) -> Trial:
        """Return the trial."""
        for part, value in self.topography.items():
            if part not in SILENT and value:
                self.notes[f"{part[:40]} of the topography are not imported"] = None
        model = str(scenario.get("mainModel")).rpartition(".")[2]
        social = model == "SocialForceModel"
        kind = "the social force model" if social else "collision-free speed"
        self.notes[f"the model {model[:40]}: {kind} with its defaults replaces it"] = None
        simulation = scenario.get("attributesSimulation") or {}
        duration = self._number(simulation, "finishTime", 500.0)
        spawners: list[Spawner] = []
        sources: list[SourceSpec] = []
        for k, source in enumerate(self._list("sources")):
            one = self._source(source, k, duration)
            if isinstance(one, Spawner):
                spawners.append(one)
            else:
                sources.append(one)
        return Trial(
            name=(name.strip() or "imported")[:80],
            about="Imported from Vadere.",
            duration=min(86_400.0, max(0.1, duration)),
            stage=self._stage(),
            routing=Routing(radius=min(10.0, self._radius), unreachable="nearest"),
            crowd=models.SocialForce() if social else models.CollisionFreeSpeed(),
            agents=tuple(self._person(item, k) for k, item in enumerate(self._list("dynamicElements"))),
            spawners=tuple(spawners),
            sources=tuple(sources),
            journeys=tuple(self.journeys.values()),
            end=End(goal=False, collision=False, empty=True),
        )

    def _stage(self) -> Stage:
        about = self.topography.get("attributes") or {}
        obstacles = tuple(Obstacle(Points.of(self._shape(item))) for item in self._list("obstacles"))
        bounds = about.get("bounds")
        if not about.get("bounded", True) or not isinstance(bounds, dict):
            return Stage(obstacles=obstacles)
        edge = self._number(about, "boundingBoxWidth", 0.5)
        x0, y0 = self._number(bounds, "x") + edge, self._number(bounds, "y") + edge
        x1, y1 = x0 + self._number(bounds, "width") - 2.0 * edge, y0 + self._number(bounds, "height") - 2.0 * edge
        if x1 <= x0 or y1 <= y0:
            raise TrialError(f"{self.path}: nothing is left inside the bounds of the topography")
        return Stage(walkable=Points.of([(x0, y0), (x1, y0), (x1, y1), (x0, y1)]), obstacles=obstacles)

    def _source(self, source: dict[str, Any], k: int, duration: float) -> Spawner | SourceSpec:
        """Return a spawner for a source that acts once at the beginning, else a source."""
        new = source.get("spawner")
        data: dict[str, Any] = new if isinstance(new, dict) else source
        count = int(self._number(data, "eventElementCount" if new else "spawnNumber", 1.0))
        begin = self._number(data, "constraintsTimeStart" if new else "startTime", 0.0)
        end = self._number(data, "constraintsTimeEnd" if new else "endTime", begin)
        most = int(self._number(data, "constraintsElementsMax" if new else "maxSpawnNumberTotal", -1.0))
        sizes = source.get("groupSizeDistribution")
        if isinstance(sizes, list) and len(sizes) > 1:
            self.notes["sizes of groups are not imported"] = None
        common: dict[str, Any] = {
            "name": f"source{k + 1}",
            "zone": Points.of(self._shape(source)),
            "journey": self._journey(source.get("targetIds")),
            "speed": self._speed,
            "radius": Distribution.of(self._radius),
        }
        if begin <= 0.0 and end <= begin:
            return Spawner(count=count, stands=not common["journey"], **common)
        every = self._interval(data, new is not None)
        if not common["journey"]:
            raise TrialError(f"{self.path}: source {k + 1} has no target")
        if end <= begin:  # one instant during the simulation
            return SourceSpec(rate=1e4, timing="regular", begin=begin, end=begin + 1.0, max_count=count, **common)
        return SourceSpec(
            rate=min(1e4, count / every), timing="regular", begin=begin, end=min(end, max(duration, begin + every)),
            max_count=None if most < 0 else most, **common,
        )  # fmt: skip

    def _interval(self, data: dict[str, Any], new: bool) -> float:
        """Return the mean time between two events of a source [s]."""
        if new:
            law = data.get("distribution") or {}
            for key, inverse in (("updateFrequency", False), ("mean", False), ("numberPedsPerSecond", True)):
                if key in law:
                    value = self._number(law, key)
                    return max(1e-3, 1.0 / value if inverse and value > 0.0 else value)
        parameters = data.get("distributionParameters")
        if isinstance(parameters, list) and parameters:
            return max(1e-3, self._number({"distributionParameters": parameters[0]}, "distributionParameters"))
        self.notes["a source without a known distribution of times: 1 s between two events"] = None
        return 1.0

    def _person(self, one: dict[str, Any], k: int) -> Agent:
        place, own = one.get("position"), one.get("attributes")
        if not isinstance(place, dict):
            raise TrialError(f"{self.path}: person {k + 1} of dynamicElements has no position")
        radius = self._number(own, "radius", self._radius) if isinstance(own, dict) else self._radius
        return Agent(
            name=f"person{k + 1}",
            x=self._number(place, "x"),
            y=self._number(place, "y"),
            journey=self._journey(one.get("targetIds")),
            speed=min(10.0, max(0.05, self._number(one, "freeFlowSpeed", 1.34))),
            radius=radius,
        )

    def _journey(self, ids: Any) -> str:
        """Return the name of the journey through targets, which is made at its first use."""
        targets = {item.get("id"): item for item in self._list("targets")}
        stops = tuple(ids) if isinstance(ids, list) else ()
        for id in stops:
            if id not in targets:
                raise TrialError(f"{self.path}: there is no target {str(id)[:40]}")
        if stops and stops not in self.journeys:
            last = targets[stops[-1]]
            absorber = last.get("absorber")
            leaves = absorber.get("enabled", True) if isinstance(absorber, dict) else last.get("absorbing", True)
            self.journeys[stops] = Journey(
                name=f"way{len(self.journeys) + 1}",
                then="leave" if leaves else "stay",
                stops=tuple(Zone(Points.of(self._shape(targets[id])), wait=self._wait(targets[id])) for id in stops),
            )
        return self.journeys[stops].name if stops else ""

    def _wait(self, target: dict[str, Any]) -> float:
        """Return the time for which people wait at a target [s]."""
        waiter, wait = target.get("waiter"), self._number(target, "waitingTime", 0.0)
        name = f"target {str(target.get('id'))[:20]}"
        if isinstance(waiter, dict) and waiter.get("enabled"):
            distribution = waiter.get("distribution")
            law = distribution if isinstance(distribution, dict) else {}
            if not str(law.get("type")).endswith("AttributesConstantDistribution"):
                self.notes[f"{name}: people do not wait, since the time is drawn; a stop has one time"] = None
                return 0.0
            wait = self._number(law, "updateFrequency")
        if wait > 0.0 and (target.get("waitingTimeYellowPhase") or target.get("individualWaiting") is False):
            self.notes[f"{name}: people do not wait, since they wait together, as at a traffic light"] = None
            return 0.0
        return min(86_400.0, max(0.0, wait))

    @property
    def _pedestrian(self) -> dict[str, Any]:
        found = self.topography.get("attributesPedestrian")
        return found if isinstance(found, dict) else {}

    @property
    def _radius(self) -> float:
        return min(5.0, max(0.05, self._number(self._pedestrian, "radius", 0.2)))

    @property
    def _speed(self) -> Distribution:
        about = self._pedestrian
        mean, deviation = (
            self._number(about, f"speedDistribution{word}", otherwise)
            for word, otherwise in (("Mean", 1.34), ("StandardDeviation", 0.26))
        )
        low = max(0.05, self._number(about, "minimumSpeed", 0.5))
        high = min(10.0, self._number(about, "maximumSpeed", 2.2))
        if deviation <= 0.0 or low >= high:
            return Distribution.of(min(10.0, max(0.05, mean)))
        return Distribution("normal", (mean, deviation, low, high))

    def _list(self, name: str) -> list[dict[str, Any]]:
        result = self.topography.get(name) or []
        if not isinstance(result, list) or not all(isinstance(item, dict) for item in result):
            raise TrialError(f"{self.path}: {name} of the topography must be a list of objects")
        return result

    def _number(self, values: dict[str, Any], key: str, otherwise: float | None = None) -> float:
        value = values.get(key, otherwise)
        if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < 1e308:
            raise TrialError(f"{self.path}: {key} must be a finite number, not {str(value)[:40]!r}")
        return float(value)

    def _shape(self, one: dict[str, Any]) -> list[tuple[float, float]]:
        """Return the corners of a shape [m]."""
        shape = one.get("shape")
        kind = shape.get("type") if isinstance(shape, dict) else None
        if not isinstance(shape, dict) or kind not in ("RECTANGLE", "POLYGON", "CIRCLE"):
            raise TrialError(f"{self.path}: a shape must be a RECTANGLE, a POLYGON or a CIRCLE, not {str(kind)[:40]!r}")
        if kind == "RECTANGLE":
            x, y = self._number(shape, "x"), self._number(shape, "y")
            w, h = self._number(shape, "width"), self._number(shape, "height")
            return [(x, y), (x + w, y), (x + w, y + h), (x, y + h)]
        if kind == "CIRCLE":
            center, radius = shape.get("center") or {}, self._number(shape, "radius")
            x, y = self._number(center, "x"), self._number(center, "y")
            turns = [2.0 * math.pi * k / CIRCLE for k in range(CIRCLE)]
            return [(x + radius * math.cos(turn), y + radius * math.sin(turn)) for turn in turns]
        points = shape.get("points")
        if not isinstance(points, list) or len(points) < 3 or not all(isinstance(point, dict) for point in points):
            raise TrialError(f"{self.path}: a polygon needs at least three points")
        return [(self._number(point, "x"), self._number(point, "y")) for point in points]
