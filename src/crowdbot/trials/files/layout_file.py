"""Layout of a place from a trial, a ROS map, or an area as WKT or GeoJSON."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

import numpy as np

from crowdbot.core import InputError
from crowdbot.core.fields import Points
from crowdbot.data import PlaceLayout
from crowdbot.trials.builtin import load_trial
from crowdbot.trials.stage import Stage
from crowdbot.trials.trial import Trial
from crowdbot.world import Zone

_STAGES = Path(__file__).parents[2] / "assets" / "stages"

KINDS = ".xml (trial), .yaml (ROS map), .wkt, .txt or .geojson (walkable area)"


def load_layout(path: str | PathLike[str]) -> PlaceLayout:
    """Return the walls and exits of the place of a recording.

    The exits of a trial are its ``<exit>`` zones, or else the goal zones of spawners, sources and journeys. A map and
    an area have none; :class:`crowdbot.models.goals.EnvironmentLayout` then takes the openings of the outermost walls.

    Args:
        path: name of a built-in trial, or of a stage of :func:`.builtin_stages`; or a file: ``.xml``, ``.yaml``,
            ``.yml``, ``.wkt``, ``.txt`` or ``.geojson``,
            in the coordinates of the recording [m].

    Raises:
        InputError: the file is missing, of another kind, or has no valid stage.

    >>> layout = load_layout("bottleneck")
    >>> len(layout.walls) > 0, layout.name
    (True, 'bottleneck')
    """
    file = Path(path)
    kind = file.suffix.lower()
    if kind in ("", ".xml"):
        known = builtin_stages()
        trial = load_trial(str(known.get(str(path), path)))
        return _layout(trial.stage, trial, file.name)
    if kind not in (".yaml", ".yml", ".wkt", ".txt", ".geojson", ".json"):
        raise InputError(f"{path} is not a layout by its name; known are {KINDS}")
    folder = file.parent.resolve()
    ros = kind in (".yaml", ".yml")
    stage = Stage(area="" if ros else file.name, map=file.name if ros else "", folder=folder, trust=False)
    return _layout(stage, None, file.name)


def builtin_stages() -> dict[str, Path]:
    """Return the stages of published experiments by name: trial files in the coordinates of the recordings.

    >>> sorted(builtin_stages())[:2]
    ['hermes-bottleneck-070', 'hermes-corridor-180']
    """
    return {file.stem: file for file in sorted(_STAGES.glob("*.xml"))}


def _layout(stage: Stage, trial: Trial | None, name: str) -> PlaceLayout:
    walls = tuple(tuple(map(tuple, ring.tolist())) for ring in stage.rings)
    if not walls:
        raise InputError(f"{name} has no walls; a layout needs walls, obstacles or a walkable area")
    return PlaceLayout(walls, () if trial is None else tuple(map(_across, _zones(trial))), name)


def _zones(trial: Trial) -> list[Points]:
    """Return the zones where people leave, without duplicates."""
    found = [item.zone for item in trial.exits]
    if not found:
        found = [spawner.goal for spawner in trial.spawners if spawner.goal] + [
            source.goal for source in trial.sources if source.goal
        ]
        found += [
            journey.stops[-1].points
            for journey in trial.journeys
            if journey.stops and isinstance(journey.stops[-1], Zone)
        ]
    return list(dict.fromkeys(found))


def _across(zone: Points) -> tuple[tuple[float, float], tuple[float, float]]:
    """Return the longer middle line of the box around a zone."""
    low, high = np.min(zone, axis=0), np.max(zone, axis=0)
    middle = 0.5 * (low + high)
    if high[0] - low[0] >= high[1] - low[1]:
        return (float(low[0]), float(middle[1])), (float(high[0]), float(middle[1]))
    return (float(middle[0]), float(low[1])), (float(middle[0]), float(high[1]))
