"""Repair of the files of killed runs: outcome, metrics and file summary."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from crowdbot.core import EpisodeError, InputError, Walls, release_stale_lock
from crowdbot.core.outlines import outline_of
from crowdbot.data import MCAP_MAGIC, McapReader, has_summary
from crowdbot.messages import ContactEventRecord, FallRecord
from crowdbot.metrics import NavigationMetrics, fall_metrics, impact_metrics
from crowdbot.simulation import robot_metrics

from .mcap_writer import finish
from .metadata import END_KEYS, ENDING, METADATA, as_json
from .step_records import RecordedStep, read_steps


class EpisodeEnd:
    """Computes the end metadata of a run as if it was interrupted at its last recorded step.

    Args:
        known: metadata at the start of the file.
    """

    def __init__(self, known: Mapping[str, str]) -> None:
        self.known = known
        self.robots = json.loads(known["robots"])
        rings = [np.array(ring, dtype=np.float64) for ring in json.loads(known["walls"])]
        walls = Walls.of(rings).segments()
        ghosts = [int(robot["id"]) for robot in self.robots if robot.get("ghost")]
        self.impacts: list[ContactEventRecord] = []
        self.falls: list[FallRecord] = []
        self.balanced = known.get("balance") == "true"
        self.travels = [
            NavigationMetrics(
                int(robot["id"]),
                float(robot["radius"]),
                (robot["goal"][0], robot["goal"][1]),
                float(robot["tolerance"]),
                walls=walls,
                ghost=bool(robot.get("ghost")),
                outline=outline_of(robot["footprint"]) if robot.get("footprint") else None,
                ignored=[ghost for ghost in ghosts if ghost != int(robot["id"])],
            )
            for robot in self.robots
        ]
        self.bodies = {robot["name"]: (int(robot["id"]), float(robot["radius"])) for robot in self.robots}
        self.count = 1 + max([-1, *(travel.robot for travel in self.travels)])
        self.last: RecordedStep | None = None
        self.touching: set[int] = set()

    def take(self, moment: RecordedStep) -> None:
        """Add a step."""
        self.count = max(self.count, *(1 + who for who in moment.largest_ids()), 0)
        names = {name for contact in moment.contacts for name in (contact.robot, contact.other)}
        self.touching |= {body[0] for name, body in self.bodies.items() if name in names}
        self.falls += moment.falls
        self.impacts += [
            collision for collision in moment.collisions if collision.first in self.bodies and collision.region
        ]
        if moment.people is not None:
            self.last = moment
            if self.travels:
                now = moment.everyone(self.bodies)
                for travel in self.travels:
                    if travel.robot not in now.ids:  # an order has removed it: its metrics end before
                        continue
                    travel.update(now, travel.robot in self.touching)
            self.touching = set()

    def metadata(self) -> dict[str, str]:
        """Return the end metadata."""
        assert self.last is not None
        names = [robot["name"] for robot in self.robots]
        metrics = robot_metrics(self.travels, names, "interrupted")
        for k, name in enumerate(names if self.known.get("world") == "physics" else ()):
            values = impact_metrics(impact for impact in self.impacts if impact.first == name)
            if self.balanced:
                values |= fall_metrics(self.falls, [fall for fall in self.falls if fall.cause == name])
                values["max_severity"] = max(values["max_severity"], values["fall_severity"])
            metrics |= {(key if k == 0 else f"{name}.{key}"): value for key, value in values.items()}
        return {
            "digest": self.last.digest,
            "outcome": "interrupted",
            "steps": str(self.last.nanoseconds // int(self.known["step_ns"])),
            "people": str(self.count - len(self.robots)),
            "metrics": as_json(metrics),
        }


def repair(path: Path | str) -> float | None:
    """Complete the file of a killed run: add the end metadata of an interrupted run and the file summary.

    Recorded data are not changed; an incomplete record at the end is removed.

    Returns:
        Time [s] of the last recorded step; None if the file is already complete.

    Raises:
        EpisodeError: the file is damaged, not an episode of crowdbot, or cannot be written.
        InputError: the run is still in progress.
    """
    path = Path(path)
    try:
        release_stale_lock(path)
        with path.open("r+b") as stream:
            if has_summary(stream):
                return None
            stream.seek(0)
            if stream.read(len(MCAP_MAGIC)) != MCAP_MAGIC:
                raise EpisodeError(f"{path} is not an MCAP file")
            stream.seek(0)
            tape, ending = McapReader(stream), None
            for moment in read_steps(tape, path):
                ending = ending or EpisodeEnd(tape.metadata.get(METADATA, {}))
                ending.take(moment)
            if ending is None or ending.last is None:
                raise EpisodeError(f"{path} has no recorded steps: the run was killed before the first one")
            added = {} if END_KEYS[0] in tape.metadata.get(ENDING, {}) else {ENDING: ending.metadata()}
            finish(stream, added)
            return ending.last.time
    except OSError as error:
        raise EpisodeError(f"cannot repair {path}: {error.strerror}") from None
    except (EpisodeError, InputError):
        raise
    except Exception as error:  # damaged bytes make their readers fail in many ways
        raise EpisodeError(f"{path} is damaged: {type(error).__name__}: {str(error)[:80]}") from error
