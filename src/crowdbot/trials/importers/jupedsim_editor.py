"""Trials from scenarios of the JuPedSim editor (JSON): areas where people begin, checkpoints, exits and journeys.

The format is that of https://github.com/PedestrianDynamics/jupedsim-scenarios: ``config.json`` with the walkable area
in ``geometry.wkt`` beside it, or in ``walkable_area_wkt``.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from crowdbot.core import InputError
from crowdbot.core.fields import Points
from crowdbot.models import CollisionFreeSpeed, CrowdModel, SocialForce
from crowdbot.trials.distribution import Distribution
from crowdbot.trials.files.trial_files import read_beside
from crowdbot.trials.people import SourceSpec, Spawner
from crowdbot.world import Zone

from .foreign_text import json_of
from .original import ImportedTrial
from .scene_parts import MOST_CORNERS, ImportedScene, as_number, number_in

Spot = tuple[float, float]
MODELS: dict[str, type[CrowdModel]] = {"CollisionFreeSpeedModel": CollisionFreeSpeed, "SocialForceModel": SocialForce}
READ = {
    "config", "distributions", "checkpoints", "exits", "zones", "journeys", "journeys_v2", "walkable_area_wkt",
    "model_type", "seed", "project_version", "transitions", "obstacles",
}  # fmt: skip
PARAMETERS = {
    "number", "initial_number", "radius", "radius_std", "radius_distribution", "v0", "v0_std", "v0_distribution",
    "desired_speed", "desired_speed_std", "desired_speed_distribution", "distribution_mode", "use_flow_spawning",
    "flow_start_time", "flow_end_time", "flow_schedule",
}  # fmt: skip
BY_NUMBER = ("by_number", "")
MOST_WKT = 4_000_000
MOST_PEOPLE = 20_000


def is_editor(content: Any) -> bool:
    """Whether the content of a JSON file is a scenario of the JuPedSim editor."""
    return isinstance(content, dict) and {"distributions", "exits"} <= set(content)


def import_jupedsim_editor(path: str | Path) -> ImportedTrial:
    """Read a scenario of the JuPedSim editor (``config.json``).

    Raises:
        TrialError: the file or its walkable area is missing or malformed.
    """
    path = Path(path)
    content = json_of(path)
    scene = ImportedScene(path, "the JuPedSim editor")
    if not is_editor(content):
        raise scene.error("is not a scenario of the JuPedSim editor: it has no distributions and exits")
    with scene.named_errors():
        return _Reader(scene, content).trial()


class _Reader:
    """Converts a scenario."""

    def __init__(self, scene: ImportedScene, content: dict[str, Any]) -> None:
        self.scene, self.content = scene, content
        self.zones = {
            name: Zone(
                Points.of(self._corners(name, row)),
                aim="random" if key == "checkpoints" else "nearest",
                wait=min(86_400.0, max(0.0, number_in(row, "waiting_time", name, 0.0)))
                if key == "checkpoints"
                else 0.0,
            )
            for key in ("checkpoints", "exits")
            for name, row in self._rows(key)
        }
        self.exits = [name for name, _ in self._rows("exits")]
        self.journeys = self._journeys()
        self.count = 0

    def trial(self) -> ImportedTrial:
        """The trial."""
        for key, value in self.content.items():
            if key not in READ and value and not str(key).startswith("_"):
                self.scene.note(f"{str(key)[:40]} is not imported")
        for key in ("zones", "transitions", "obstacles"):
            if value := self.content.get(key):
                what = "people keep their speed in them" if key == "zones" else "add them by hand"
                self.scene.note(
                    f"the {len(value) if isinstance(value, list | dict) else 1} {key} are not imported: {what}"
                )
        for name, row in self._rows("checkpoints"):
            if row.get("waiting_time_distribution") not in (None, "", "constant"):
                self.scene.note(f"{name}: all people wait for the mean time; the distribution of waits is not imported")
        for name, row in self._rows("exits"):
            if row.get("enable_throughput_throttling"):
                self.scene.note(
                    f"{name}: its largest flow of {str(row.get('max_throughput'))[:10]} per s is not imported"
                )
        for name, row in self._rows("distributions"):
            self._distribution(name, row)
        settings = self.content.get("config")
        for key in ("simulation_settings", "simulationParams"):
            settings = settings.get(key) if isinstance(settings, dict) else None
        values = settings if isinstance(settings, dict) else {}
        duration = number_in(values, "max_simulation_time", "config") if "max_simulation_time" in values else None
        model = str(values.get("model_type") or self.content.get("model_type") or "CollisionFreeSpeedModel")
        if model not in MODELS:
            self.scene.note(f"the model {model[:40]!r}: the collision-free speed model replaces it")
        crowd = MODELS.get(model, CollisionFreeSpeed)()
        ((name, trial),) = (done := self.scene.trial(duration=duration, crowd=crowd, area=self._area())).trials
        end = dataclasses.replace(trial.end, empty=bool(trial.spawners or trial.sources))
        return ImportedTrial(((name, dataclasses.replace(trial, end=end)),), done.left_out)

    def _rows(self, key: str) -> Iterator[tuple[str, dict[str, Any]]]:
        """Elements of a kind by name."""
        rows = self.content.get(key) or {}
        if not isinstance(rows, dict):
            raise self.scene.error(f"{key} must be an object")
        for name, row in rows.items():
            if not isinstance(row, dict):
                raise self.scene.error(f"{str(name)[:40]} of {key} must be an object with coordinates")
            yield str(name), row

    def _corners(self, name: str, row: dict[str, Any]) -> list[Spot]:
        spots = row.get("coordinates")
        if not isinstance(spots, list) or not all(isinstance(spot, list) and len(spot) > 1 for spot in spots):
            raise self.scene.error(f"{name[:40]}: coordinates must be a list of points [x, y]")
        corners = [(as_number(spot[0], name[:40]), as_number(spot[1], name[:40])) for spot in spots[:MOST_CORNERS]]
        corners = corners[:-1] if len(corners) > 1 and corners[0] == corners[-1] else corners
        if len(corners) < 3:
            raise self.scene.error(f"{name[:40]}: coordinates must have at least 3 different points")
        return corners

    def _area(self) -> str:
        """The walkable area as WKT."""
        text = self.content.get("walkable_area_wkt")
        if not text:
            folder = self.scene.path.resolve().parent
            files = [folder / "geometry.wkt"] if (folder / "geometry.wkt").is_file() else sorted(folder.glob("*.wkt"))
            if len(files) != 1:
                raise self.scene.error(
                    "its walkable area is missing: put its geometry.wkt beside it"
                    + (f"; there are {len(files)} other .wkt files" if files else "")
                )
            try:
                text = read_beside(files[0], MOST_WKT).decode("utf-8-sig")
            except (InputError, UnicodeDecodeError) as error:
                raise self.scene.error(f"its walkable area cannot be read: {error}") from None
        return str(text).strip()

    def _journeys(self) -> dict[str, list[str]]:
        """Names of areas, checkpoints and exits of each journey in order."""
        journeys: dict[str, list[str]] = {}
        for key, order in (("journeys", "stages"), ("journeys_v2", "sequence")):
            for k, row in enumerate(self.content.get(key) or []):
                if not isinstance(row, dict) or not isinstance(row.get(order, []), list):
                    raise self.scene.error(f"journey {k + 1} of {key} must be an object with the list {order}")
                journeys[str(row.get("id", k))] = [str(name) for name in row.get(order, [])]
        return journeys

    def _ways(self, name: str, row: dict[str, Any], zone: list[Spot]) -> list[tuple[float, list[Zone]]]:
        """Stops of the people of an area, with their weights; the nearest exit without a journey."""
        ways: list[tuple[float, list[str]]] = []
        for weight in row.get("journey_weights") or []:
            if isinstance(weight, dict) and str(weight.get("journey_id")) in self.journeys:
                share = number_in(weight, "weight", name, 100.0)
                ways.append((share, self.journeys[str(weight["journey_id"])]))
        ways = ways or [(100.0, stages) for stages in self.journeys.values() if name in stages]
        found = []
        for share, stages in ways:
            after = stages[stages.index(name) + 1 :] if name in stages else stages
            lost = [stage for stage in after if stage not in self.zones]
            if lost:
                self.scene.note(f"{name}: there is no checkpoint or exit {lost[0][:30]!r}, people skip it")
            stops = [self.zones[stage] for stage in after if stage in self.zones]
            if stops and share > 0.0:
                found.append((share, stops))
        if not found and self.exits:
            self.scene.note(f"{name} has no journey: its people go to the nearest exit")
            x, y = _middle(zone)
            ends = [self.zones[item] for item in self.exits]
            found = [(1.0, [min(ends, key=lambda one: math.dist(_middle(one.points), (x, y)))])]
        return found

    def _distribution(self, name: str, row: dict[str, Any]) -> None:
        """Add the people who begin in an area, and those who enter there later."""
        zone = self._corners(name, row)
        values = row.get("parameters") or {}
        if not isinstance(values, dict):
            raise self.scene.error(f"{name[:40]}: parameters must be an object")
        if extra := sorted(str(key)[:30] for key in set(values) - PARAMETERS if values[key]):
            self.scene.note(f"{name}: not imported are {', '.join(extra[:12])}")
        mode = str(values.get("distribution_mode") or "")
        if mode not in BY_NUMBER:
            self.scene.note(f"{name}: the mode {mode[:30]!r} is not imported: it has the number of people in the file")
        ways = self._ways(name, row, zone)
        schedule = values.get("flow_schedule") or []
        if not isinstance(schedule, list) or not all(isinstance(item, dict) for item in schedule):
            raise self.scene.error(f"{name[:40]}: flow_schedule must be a list of objects")
        number = number_in(values, "number", name, 0.0)
        if values.get("use_flow_spawning") and not schedule:
            schedule = [{key: values.get(key) for key in ("flow_start_time", "flow_end_time")} | {"number": number}]
        if schedule:
            number = number_in(values, "initial_number", name, 0.0)
        options: dict[str, Any] = {
            key: value
            for key, value in (("speed", self._drawn(name, values, ("v0", "desired_speed"), 10.0)),
                               ("radius", self._drawn(name, values, ("radius",), 5.0)))
            if value is not None
        }  # fmt: skip
        for label, journey, count in self._shares(name, ways, number):
            self.scene.spawners.append(
                Spawner(name=label, count=count, zone=Points.of(zone), journey=journey, stands=not journey, **options)
            )
        for item in schedule:
            begin, end = (self._time(name, item, *keys) for keys in (("flow_start_time", "start_time_s"),
                                                                     ("flow_end_time", "end_time_s")))  # fmt: skip
            coming = number_in(item, "number" if "number" in item else "sim_count", name)
            if not 0.0 <= begin < end or not ways:
                self.scene.note(
                    f"{name}: its flow from {begin:g} s to {end:g} s is left out: it needs a time and a goal"
                )
                continue
            for label, journey, count in self._shares(name, ways, coming):
                self.scene.sources.append(
                    SourceSpec(
                        name=label, zone=Points.of(zone), journey=journey, timing="regular", begin=begin,
                        rate=min(1e4, count / (end - begin)), end=end, max_count=count, **options,
                    )
                )  # fmt: skip

    def _time(self, name: str, item: dict[str, Any], key: str, other: str) -> float:
        value = item.get(key) if item.get(key) is not None else item.get(other)
        return min(86_400.0, as_number(0.0 if value is None else value, f"{name[:40]}: {key}"))

    def _shares(self, name: str, ways: list[tuple[float, list[Zone]]], number: float) -> Iterator[tuple[str, str, int]]:
        """Name, journey and number of people of each way, which add up to the number."""
        self.count += int(number)
        if self.count > MOST_PEOPLE:
            raise self.scene.error(f"more than {MOST_PEOPLE} people are too many")
        total, given, weight = sum(share for share, _ in ways), 0, 0.0
        for k, (share, stops) in enumerate(ways):
            weight += share
            count = round(int(number) * weight / total) - given
            given += count
            if count > 0:
                yield (name if len(ways) == 1 else f"{name}-{k + 1}")[:40], self.scene.journey(stops, "leave"), count
        if not ways and number >= 1.0:
            self.scene.note(f"{name} has neither a journey nor an exit, and stands")
            yield name[:40], "", int(number)

    def _drawn(self, name: str, values: dict[str, Any], keys: tuple[str, ...], most: float) -> Distribution | None:
        """A speed or radius, drawn if the file says so."""
        key = next((key for key in keys if values.get(key) is not None), "")
        if not key:
            return None
        mean = min(most, max(0.05, number_in(values, key, name)))
        deviation = number_in(values, f"{key}_std", name, 0.0) if values.get(f"{key}_std") is not None else 0.0
        low, high = max(0.05, round(mean - 3.0 * deviation, 6)), min(most, round(mean + 3.0 * deviation, 6))
        if str(values.get(f"{key}_distribution") or "constant") == "constant" or deviation <= 0.0 or not low < high:
            return Distribution.of(mean)
        return Distribution("normal", (mean, deviation, low, high))


def _middle(corners: Any) -> Spot:
    return sum(x for x, _ in corners) / len(corners), sum(y for _, y in corners) / len(corners)
