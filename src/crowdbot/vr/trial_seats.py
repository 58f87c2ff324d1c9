"""TrialSeats: the participants of a trial of an experiment, as one source of orders."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path

from crowdbot.core import InputError
from crowdbot.navigation import ExternalNavigator
from crowdbot.simulation import Order, Simulation
from crowdbot.trials import Trial

from .calibration_pose import BodyMeasure
from .headset_recording import HeadsetRecorder
from .robot_stop import RobotStop
from .vr_participant import VrParticipant

__all__ = ["TrialSeats", "external_avatars", "with_bodies"]

Watch = Callable[[Simulation], bool]


class TrialSeats:
    """Gives the avatars of one trial to participants; those who come late, or again, take their seat while it runs.

    Args:
        trial: the trial.
        folder: folder of the trial, for the raw messages of each participant.
        stop: holds the robots.
        watch: returns whether the robots must stop; called in the thread of the run.

    Raises:
        InputError: a robot of the trial is driven over a connection of its own, which a source of orders replaces.
    """

    def __init__(self, trial: Trial, folder: Path, stop: RobotStop, watch: Watch) -> None:
        driven = [one.name for one in trial.robots if _has_source(one.navigator)]
        if driven:
            raise InputError(
                f"robot {driven[0]!r} is driven over a connection of its navigator, which does not work together with"
                " a headset yet; give it another navigator"
            )
        self.trial, self.folder = trial, folder
        self.names = external_avatars(trial)
        self._stop, self._watch = stop, watch
        self._seated: dict[str, VrParticipant] = {}

    def seat(self, person: VrParticipant) -> None:
        """Give a participant the avatar with its name, and record its messages in the folder of the trial."""
        if person.avatar not in self.names:
            return
        person.record_to(HeadsetRecorder(_free_file(self.folder, person.avatar)))
        self._seated[person.avatar] = person

    def leave(self, person: VrParticipant) -> None:
        """Take the avatar away from a participant."""
        if self._seated.get(person.avatar) is person:
            del self._seated[person.avatar]
            person.record_to(None)

    def orders(self, simulation: Simulation) -> list[Order]:
        """Return the orders of the participants for this step, and those that hold the robots."""
        if self._watch(simulation):
            self._stop.set = True
        found = self._stop.orders(simulation)
        for person in list(self._seated.values()):
            found += person.orders(simulation)
        return found

    def close(self) -> None:
        """Close the recordings."""
        for person in list(self._seated.values()):
            self.leave(person)


def external_avatars(trial: Trial) -> list[str]:
    """Return the names of the avatars of a trial that participants can move."""
    return [one.name for one in trial.avatars if one.source == "external"]


def with_bodies(trial: Trial, bodies: dict[str, BodyMeasure]) -> Trial:
    """Return a trial whose avatars have the size of their participants, by the names of the avatars."""
    avatars = tuple(
        dataclasses.replace(one, height=bodies[one.name].stature, body=bodies[one.name].body)
        if one.name in bodies and one.source == "external"
        else one
        for one in trial.avatars
    )
    return dataclasses.replace(trial, avatars=avatars)


def _has_source(navigator: object) -> bool:
    return isinstance(navigator, ExternalNavigator) and bool(navigator.source)


def _free_file(folder: Path, avatar: str) -> Path:
    for count in range(1, 1000):
        file = folder / f"{avatar}{'' if count == 1 else f'-{count}'}.headset"
        if not file.exists():
            return file
    raise InputError(f"{folder} has 999 recordings of a headset")
