"""SteeringDesk: the commands of the simulator tab that steer what runs; each is an order of the simulation."""

from __future__ import annotations

import dataclasses
import json
from typing import Any
from xml.sax.saxutils import quoteattr

from crowdbot.core import InputError, builtin_name, did_you_mean
from crowdbot.navigation import ExternalNavigator, Navigator
from crowdbot.simulation import AddElementOrder, Order, ParameterOrder, Simulation, read_order
from crowdbot.trials import RobotSpec
from crowdbot.web.command import command
from crowdbot.web.desk import Desk
from crowdbot.world import worlds_of

from .beginning_player import BeginningPlayer
from .held_control import SOURCE, HeldAvatar, HeldVelocity
from .inspection import inspect_agent, people_rows
from .live_run import LiveRun
from .playback import Playback
from .value_rows import value_rows

__all__ = ["Player", "SteeringDesk", "navigator_orders"]

Player = LiveRun | Playback
EXTERNAL = "external"


class SteeringDesk(Desk):
    """A desk with a running trial or a recorded episode."""

    _player: Player | None = None

    @property
    def run(self) -> LiveRun:
        """The running trial; raises InputError if there is none."""
        return self._live()

    @command
    def order(self, order: dict[str, Any]) -> None:
        """Give an order, in the JSON form of an order in an episode file."""
        self._live().order(read_order(json.dumps({**order, "source": SOURCE})))

    @command
    def inspect(self, id: int) -> dict[str, Any]:
        """Return the state of a person or robot."""
        player = self._any()
        found: dict[str, Any] = self._asked(lambda: inspect_agent(player.simulation, id))
        return found

    @command
    def people(self) -> list[dict[str, Any]]:
        """Return everybody who is present; nobody while the simulation is being prepared, which may take long."""
        player = self._any()
        if player.state == "preparing":
            return []
        rows: list[dict[str, Any]] = player.do(
            lambda: people_rows(player.view.simulation, player.view.recording_instant)
        )
        return rows

    @command
    def values(self) -> list[dict[str, Any]]:
        """Return the values of the trial by their paths."""
        player = self._any()
        rows: list[dict[str, Any]] = self._asked(lambda: value_rows(player.view.simulation.trial))
        return rows

    @command
    def set_value(self, path: str, text: str) -> None:
        """Change a value of the running trial, as ``--set`` does before a run."""
        self._live().order(ParameterOrder(path=path, value=text, source=SOURCE))

    @command
    def add_robot(
        self, type: str, x: float, y: float, goal_x: float, goal_y: float, navigator: str = "orca"
    ) -> str:  # fmt: skip
        """Add a robot of a built-in type, and return its name.

        It has the sensors of its type if the people of the trial have limbs for them, otherwise a planar laser scanner.
        """
        run = self._live()
        free: tuple[str, bool] = run.do(lambda: _free_name(run.simulation))
        name, limbs = free
        scan = "" if limbs else '<sensor type="lidar2d"/>'
        xml = (
            f'<robot name="{name}" type={quoteattr(type)} x="{x:g}" y="{y:g}" default-sensors="{str(limbs).lower()}">'
            f'<goal x="{goal_x:g}" y="{goal_y:g}"/><navigator type={quoteattr(navigator)}/>{scan}</robot>'
        )
        run.order(AddElementOrder(xml=xml, source=SOURCE))
        return name

    @command
    def take_over(self, robot: str) -> None:
        """Let the user drive a robot: its navigator becomes ``external``."""
        run = self._live()
        if robot in run.controls:
            return
        spec = run.do(lambda: _robot(run.simulation, robot))
        if spec.mirror is not None or bool(getattr(spec.navigator, "source", "")):
            raise InputError(f"robot {robot!r} is moved over its own connection; the app cannot drive it")
        if not isinstance(spec.navigator, ExternalNavigator):
            run.order(ParameterOrder(path=f"robot[{robot}]/navigator/type", value=EXTERNAL, source=SOURCE))
            run.taken[robot] = spec.navigator
        run.controls[robot] = HeldVelocity(robot)

    @command
    def release(self, robot: str) -> None:
        """Give a robot back to its navigator, with the parameters that it had."""
        run = self._live()
        run.controls.pop(robot, None)
        navigator = run.taken.pop(robot, None)
        if navigator is not None:
            run.order_in_turn(navigator_orders(robot, navigator))

    @command
    def drive(self, robot: str, forward: float, turn: float, left: float = 0.0) -> None:
        """Hold the velocity of a robot that was taken over; to be repeated at least every second."""
        control = self._live().controls.get(robot)
        if not isinstance(control, HeldVelocity):
            raise InputError(f"robot {robot!r} is not driven by the user; take it over first")
        control.hold(float(forward), float(turn), float(left))

    @command
    def walk(self, avatar: str, forward: float, left: float = 0.0, turn: float = 0.0) -> None:
        """Hold the velocity of an avatar; to be repeated at least every second."""
        run = self._live()
        control = run.controls.get(avatar)
        if control is None:
            control = run.do(lambda: _held_avatar(run.simulation, avatar))
            run.controls[avatar] = control
        if not isinstance(control, HeldAvatar):
            raise InputError(f"{avatar!r} is a robot, not an avatar")
        control.hold(float(forward), float(left), float(turn))

    def _asked(self, action: Any) -> Any:
        player = self._any()
        if player.state == "preparing":
            raise InputError("the simulation is being prepared; values come as soon as it runs")
        return player.do(action)

    def _beginning(self) -> BeginningPlayer | None:
        """Return what shows a recording while the run is prepared."""
        found = self._player.beginning if isinstance(self._player, LiveRun) else None
        return found if found is not None and found.active else None

    def _any(self) -> Player:
        if self._player is None:
            raise InputError("nothing is open: open a trial or an episode")
        return self._player

    def _live(self) -> LiveRun:
        player = self._any()
        if not isinstance(player, LiveRun):
            raise InputError("a recorded episode cannot be steered; branch it, or open its trial")
        return player


def _free_name(simulation: Simulation) -> tuple[str, bool]:
    """Return a new name of a robot, and whether people have limbs."""
    names = {robot.name for robot in simulation.trial.robots} | {one.robot.name for one in simulation.former_robots}
    name = next(name for k in range(1, 1000) if (name := f"added{k}") not in names)
    return name, worlds_of(simulation.world)[0].people is not None


def _robot(simulation: Simulation, name: str) -> RobotSpec:
    robots = {robot.name: robot for robot in simulation.trial.robots}
    if name not in robots:
        raise InputError(f"there is no robot {name!r}{did_you_mean(name, robots)}; the trial has {', '.join(robots)}")
    return robots[name]


def navigator_orders(robot: str, navigator: Navigator) -> list[Order]:
    """Return orders that give a robot a navigator: its type, then each parameter that is not the default."""
    path = f"robot[{robot}]/navigator"
    values = {"type": builtin_name(type(navigator), Navigator)}
    for field in dataclasses.fields(navigator) if dataclasses.is_dataclass(navigator) else ():
        value = getattr(navigator, field.name)
        if field.init and isinstance(value, bool | int | float | str) and value != field.default:
            text = str(value).lower() if isinstance(value, bool) else str(value)
            values[field.name.replace("_", "-")] = text
    return [ParameterOrder(path=f"{path}/{name}", value=text, source=SOURCE) for name, text in values.items()]


def _held_avatar(simulation: Simulation, name: str) -> HeldAvatar:
    trial = simulation.trial
    known = [one.name for one in trial.avatars]
    if name not in known:
        raise InputError(f"there is no avatar {name!r}{did_you_mean(name, known)}; the trial has {known or 'none'}")
    recorded = sum(len(one.walks(trial.duration)) for one in trial.recorded)
    slot = trial.people - recorded - len(known) + known.index(name)
    scene = simulation.world.environment_scene(0)
    x, y = scene.position[0, slot].tolist()
    return HeldAvatar(name, x, y, float(scene.heading[0, slot]), float(scene.radius[0, slot]))
