"""Parameters that a ROS 1 node sets on the parameter server, and restores at its end."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from crowdbot.bridges.interface import RobotInterface

from .master import Master

TIME, DESCRIPTION = "/use_sim_time", "robot_description"


class Parameters:
    """``/use_sim_time``, and the URDF of each robot as ``/ROBOT/robot_description``.

    The description of the first robot is ``/robot_description``, too, where RViz and the navigation stack look. Other
    nodes wait for ``/clock`` as long as ``/use_sim_time`` is true, so it must not stay.

    Args:
        master: calls the parameter server.
        interface: the topics; with a received ``/clock``, the time is left alone.
    """

    def __init__(self, master: Master, interface: RobotInterface) -> None:
        self.interface = interface
        self._master = master
        self._before: dict[str, Any] = {}
        self._texts: dict[str, str] = {}

    def describe(self, texts: Mapping[str, str]) -> bool:
        """Take descriptions by their topic, and return whether one is new."""
        new = {topic: text for topic, text in texts.items() if self._texts.get(topic) != text}
        self._texts |= new
        return bool(new)

    async def set(self) -> None:
        """Set the parameters.

        Raises:
            InputError: there is no master.
        """
        values: dict[str, Any] = dict(self._texts)
        first = f"/{self.interface.trial.robots[0].name}/{DESCRIPTION}" if self.interface.trial.robots else ""
        if first in values:
            values[f"/{DESCRIPTION}"] = values[first]
        if all(one.name != "/clock" for one in self.interface.inputs):
            values[TIME] = True
        for name, value in values.items():
            if name not in self._before:
                self._before[name] = await self._get(name)
            await self._master.call("setParam", name, value)

    async def restore(self) -> None:
        """Give the parameters their earlier values.

        Raises:
            InputError: there is no master.
        """
        for name, value in self._before.items():
            if value is None:
                await self._master.call("deleteParam", name)
            else:
                await self._master.call("setParam", name, value)
        self._before.clear()

    async def _get(self, name: str) -> Any:
        if not await self._master.call("hasParam", name):
            return None
        return await self._master.call("getParam", name)
