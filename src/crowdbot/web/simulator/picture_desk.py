"""PictureDesk: the commands of the simulator tab that choose what the picture shows."""

from __future__ import annotations

from typing import Any

from crowdbot import prediction
from crowdbot.core import InputError, builtin_classes, did_you_mean
from crowdbot.prediction import ConstantVelocity, Predictor
from crowdbot.web.command import command
from crowdbot.web.desk import DeskWindows
from crowdbot.web.scene import LAYERS

from .camera_feed import CameraFeed
from .stage_view import StageView
from .steering_desk import SteeringDesk

__all__ = ["PictureDesk"]

MOST_IMAGES = 16
"""Largest number of camera images that are sent."""


class PictureDesk(SteeringDesk):
    """A desk with a picture of what runs or plays."""

    def __init__(self, session: DeskWindows) -> None:
        super().__init__(session)
        self._layers: frozenset[str] = frozenset()
        self._predictor: Predictor = ConstantVelocity()
        self._cameras = CameraFeed(session)

    @command
    def description(self) -> dict[str, Any]:
        """Return what stands still in the picture; nothing while the simulation is being prepared."""
        player, recorded = self._any(), self._beginning()
        if recorded is not None:
            return recorded.description()
        found: dict[str, Any] = {} if player.state == "preparing" else player.do(player.view.description)
        return found

    @command
    def show_frame(self) -> None:
        """Send the current state again, for a new window."""
        player = self._any()
        self._cameras.renew()
        if (recorded := self._beginning()) is not None:
            recorded.show()
        elif player.state != "preparing":  # its first frame comes by itself
            player.do(lambda: player.view.show(always=True))

    @command
    def layers(self, names: list[str]) -> None:
        """Choose the layers that the frames contain."""
        self._layers = frozenset(name for name in names if name in LAYERS)
        if self._player is not None:
            self._player.view.layers = self._layers
            self.show_frame()
        self.session.tell("simulator.layers", sorted(self._layers))

    @command
    def cameras(self, names: list[str]) -> None:
        """Choose the camera images that are sent, by their names in the description."""
        self._cameras.choose(frozenset(names[:MOST_IMAGES]))
        if self._player is not None:
            self.show_frame()
        self.session.tell("simulator.cameras", sorted(self._cameras.chosen))

    @command
    def predictor(self, name: str) -> None:
        """Choose the built-in predictor of the layer ``paths``."""
        kinds = builtin_classes(prediction, Predictor)
        if name not in kinds:
            raise InputError(f"there is no predictor {name!r}{did_you_mean(name, kinds)}; known are {', '.join(kinds)}")
        chosen: Predictor = kinds[name]()
        self._predictor = chosen
        if self._player is not None:
            self._player.view.predictor = chosen
            self.show_frame()
        self.session.tell("simulator.predictor", name)

    def _view(self) -> StageView:
        return StageView(self.session, self._layers, predictor=self._predictor, cameras=self._cameras)
