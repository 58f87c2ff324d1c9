"""SimulatorDesk: opens trials and episodes, plays and steers them, and saves what was recorded."""

from __future__ import annotations

import dataclasses
import functools
import json
import math
import shlex
import threading
import time
from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar
from xml.sax.saxutils import quoteattr

import numpy as np

from crowdbot import prediction
from crowdbot.catalogue import builtin_names
from crowdbot.core import CrowdbotError, InputError, builtin_classes, builtin_name, did_you_mean
from crowdbot.metrics import wall_clearance
from crowdbot.navigation import ExternalNavigator, Navigator
from crowdbot.prediction import ConstantVelocity, Predictor
from crowdbot.recording import branch
from crowdbot.simulation import (
    AddElementOrder,
    AvatarOrder,
    Order,
    ParameterOrder,
    Simulation,
    VelocityOrder,
    read_order,
)
from crowdbot.trials import (
    RobotSpec,
    Trial,
    add_element,
    expand_sweeps,
    override_remarks,
    trial_groups,
    trial_remarks,
    trial_titles,
)
from crowdbot.web.command import command
from crowdbot.web.desk import Desk, DeskWindows, Resource
from crowdbot.web.scene import LAYERS, scene_resource
from crowdbot.web.workspace import shown_path
from crowdbot.world import worlds_of

from .beginning_player import BeginningPlayer
from .camera_feed import CameraFeed
from .first_trial import FIRST, RunAddress, read_link
from .inspection import inspect_agent, people_rows
from .live_run import LiveRun
from .live_values import LIVE_VALUES
from .playback import Playback
from .recorded_beginning import RecordedBeginning, shipped_beginning
from .stage_view import StageView
from .trial_preview import thumbnail, trial_preview
from .value_rows import parameter_rows, value_rows

HISTORY = 1500
"""Instants of the live values that a new window gets."""
AVATAR = "you"
"""Name of the person that the user moves."""
WAIT = 8.0
"""Longest time [s] that closing waits for a run, which may be compiling and then ends by itself."""
PREPARING = "the simulation is being prepared; try again as soon as it runs"
MOST_IMAGES = 16
"""Largest number of camera images that are sent."""
Player = LiveRun | Playback
EXTERNAL = "external"
SOURCE = "app"
"""Source of the orders of the page."""
REPEAT = 0.2
"""Simulated time [s] after which a velocity is ordered again."""
LET_GO = 1.0
"""Real time [s] after which a control counts as let go if the page does not repeat it."""
WALK, RUN = 1.4, 3.0
"""Speed [m/s] of an avatar, and its highest speed."""


class SimulatorDesk(Desk):
    """The simulator tab of a session: at most one trial runs, or one episode plays."""

    _player: Player | None = None

    name = "simulator"
    first: ClassVar[str | None] = None
    """Trial or episode that a new session opens instead of :data:`FIRST`."""

    def __init__(self, session: DeskWindows) -> None:
        super().__init__(session)
        self._layers: frozenset[str] = frozenset()
        self._predictor: Predictor = ConstantVelocity()
        self._cameras = CameraFeed(session)
        self._opening = threading.RLock()
        self._number = 0
        self._source: dict[str, Any] = {}
        self._history: deque[list[Any]] = deque(maxlen=HISTORY)
        self._visited = False
        self._branching: threading.Thread | None = None
        self._problem = ""

    def visit(self, address: Mapping[str, str]) -> None:
        if not self._visited:
            self._visited = True
            threading.Thread(target=self._open_first, args=(address,), name="crowdbot-open", daemon=True).start()

    def greet(self) -> dict[str, Any]:
        return {
            "status": self._status(), "source": self._source, "layers": sorted(self._layers),
            "cameras": sorted(self._cameras.chosen), "predictor": builtin_name(type(self._predictor), Predictor),
            "known_layers": [{"name": name, "title": title} for name, title in LAYERS.items()],
            "plots": [item._asdict() for item in LIVE_VALUES], "history": list(self._history),
        }  # fmt: skip

    @command
    def trials(self) -> list[dict[str, Any]]:
        """Return the trial files of the folder, and the built-in trials by group with their parameters."""
        titles = trial_titles()
        found = [
            {"name": name, "group": group, "title": titles[name], "built_in": True, "parameters": parameter_rows(name)}
            for name, group in trial_groups().items()
        ]
        own = [
            {"name": name, "group": "Files of the folder", "title": "", "built_in": False, "parameters": []}
            for name in self.session.workspace.trials()
        ]
        return own + found

    @command
    def episodes(self) -> list[str]:
        """Return the episode files of the folder."""
        return self._files("*.mcap")

    @command
    def names(self) -> dict[str, list[str]]:
        """Return built-in navigators, types of robots, and predictors."""
        return {kind: list(builtin_names(kind)[kind]) for kind in ("navigators", "robots", "predictors")}

    @command
    def open(
        self,
        name: str,
        settings: dict[str, Any] | None = None,
        seed: int | None = None,
        variant: int = 1,
        paused: bool = False,
    ) -> dict[str, Any]:
        """Run a trial: a built-in name or a file of the folder, with values as for ``--set``."""
        values = {key: str(value) for key, value in (settings or {}).items()}
        trial = self._load(name, values, variant)
        self._start(trial, name, values, trial.seed if seed is None else seed, variant, paused)
        return {"remarks": [*override_remarks(trial.robots), *trial_remarks(trial)]}

    @command
    def open_episode(self, name: str, at: float | None = None, paused: bool = True) -> None:
        """Play a recorded episode of the folder."""
        view = self._view()
        player = Playback(self.session.workspace.readable(name), name, view, self._tell, at, paused)
        self._replace(player, {"kind": "episode", "name": name})

    @command
    def restart(self, seed: int | None = None, settings: dict[str, Any] | None = None) -> None:
        """Run the same trial again, with another seed or other values if they are given."""
        run, source = self._live(), self._source
        values = source["settings"] | {key: str(value) for key, value in (settings or {}).items()}
        trial = run.trial if not settings else self._load(source["name"], values, source["variant"])
        chosen = run.seed if seed is None else seed
        self._start(trial, source["name"], values, chosen, source["variant"], run.loop.paused and run.state != "ended")

    @command
    def become_person(self, x: float, y: float, heading: float = 0.0) -> str:
        """Run the trial again with an avatar that the user moves, and return its name."""
        run = self._live()
        old = run.trial
        if any(avatar.name == AVATAR for avatar in old.avatars):
            return AVATAR
        xml = f'<avatar name="{AVATAR}" source="external" x="{x:g}" y="{y:g}" heading="{heading:g}"/>'
        trial = add_element(old, xml, place=f"trial {old.name!r} with a person", trust=False)
        source = self._source
        self._start(trial, source["name"], source["settings"], run.seed, source["variant"], False)
        return AVATAR

    def run_trial(self, trial: Trial) -> None:
        """Run a changed trial from its start, with the seed of the run before."""
        source, seed = self._source, self.run.seed
        self._start(trial, source["name"], source["settings"], seed, source["variant"], False)

    @command
    def play(self) -> None:
        """Run."""
        player = self._any()
        if isinstance(player, Playback) and player.state == "ended":
            player.seek(player.begin_time)
        player.loop.resume()
        self._tell(player)

    @command
    def pause(self) -> None:
        """Pause."""
        player = self._any()
        player.loop.pause()
        self._tell(player)

    @command
    def step(self, count: int = 1) -> None:
        """Pause, and advance by some steps."""
        if not 1 <= count <= 10_000:
            raise InputError(f"count = {count}: expected 1 to 10000")
        self._any().loop.take_steps(count)

    @command
    def speed(self, speed: float | None) -> None:
        """Set simulated time over real time; null is as fast as possible."""
        player = self._any()
        player.loop.speed = speed
        self._tell(player)

    @command
    def seek(self, time: float) -> None:
        """Jump to an instant of a recorded episode."""
        self._playback().seek(float(time))

    @command
    def episode(self) -> dict[str, Any]:
        """Return events and series of the recorded episode."""
        player = self._playback()
        result: dict[str, Any] = player.do(
            lambda: {"events": [event._asdict() for event in player.events], "series": player.series}
        )
        return result

    @command
    def branch(self, at: float, changes: dict[str, Any], name: str | None = None) -> str:
        """Continue the episode from an instant with other values, in the background; returns the name of the file.

        The event ``simulator.branch`` tells the progress, and the end.
        """
        player = self._playback()
        if self._branching is not None and self._branching.is_alive():
            raise InputError("a branch is being made; wait for its end")
        values = {key: str(value) for key, value in changes.items()}
        stem = Path(player.name).stem
        target = name or self._free_name(f"{stem}-from-{at:g}s")
        path = self.session.workspace.writable(target)
        work = functools.partial(
            self._branch, player.recorded.path, _recorded_instant(player, at), values, path, target
        )
        self._branching = threading.Thread(target=work, name="crowdbot-branch", daemon=True)
        self._branching.start()
        return target

    @command
    def save(self, name: str | None = None) -> str:
        """Save the recording of the run so far, and return the name of the file."""
        run = self._prepared()
        target = name or self._free_name(f"{run.trial.name}-seed-{run.seed}")
        if not target.endswith(".mcap"):
            target += ".mcap"
        path = self.session.workspace.writable(target)
        if path.exists():
            raise InputError(f"file {target!r} exists; choose another name")
        run.save(path)
        return target

    @command
    def command_line(self) -> str:
        """Return the command that gives the same run, or replays the episode."""
        return run_command(*self._words())

    @command
    def python(self) -> str:
        """Return a Python program that gives the same run, or reads the episode."""
        return run_python(*self._words())

    def _words(self) -> tuple[dict[str, Any], str, str]:
        player, name = self._any(), self._source["name"]
        is_file = name.endswith((".xml", ".mcap"))
        place = shown_path(self.session.workspace.readable(name)) if is_file else name
        changes = list[str]()
        if isinstance(player, LiveRun):
            changes += [f"{player.given} order{'s' * (player.given > 1)}"] if player.given else []
            changes += (
                ["the person that you move"] if any(avatar.name == AVATAR for avatar in player.trial.avatars) else []
            )
        return self._source, place, " and ".join(changes)

    @command
    def ping(self) -> None:
        """Do nothing, to measure the latency."""

    def resource(self, path: str, query: dict[str, str]) -> Resource:
        kind, _, name = path.partition("/")
        if kind == "thumbnail":
            name = name.removesuffix(".svg")
            file = self.session.workspace.readable(name) if name.endswith(".xml") else None
            return Resource(thumbnail(name, file), "image/svg+xml")
        if kind == "bodies":  # the same in all trials
            return scene_resource(None, path, query)
        player = self._any()
        if (recorded := self._beginning()) is not None:
            return recorded.resource(path)
        if player.state in ("preparing", "failed"):  # a mesh of the scene before, which is no longer shown
            return Resource(b"")
        result: Resource = player.do(lambda: scene_resource(player.view.simulation, path, query))
        return result

    def close(self) -> None:
        player, self._player = self._player, None
        if player is not None:
            player.close(WAIT)
        self._cameras.close()
        if self._branching is not None:
            self._branching.join(WAIT)

    def _open_first(self, address: Mapping[str, str]) -> None:
        try:
            link = read_link(address)
            own = bool(self.first and self.first.endswith(".mcap"))
            if self.first is not None and (link is None or link.name != self.first):  # with --open
                link = RunAddress(self.first, episode=own, paused=own)
            link = link or RunAddress(*FIRST)
            if self._player is not None:
                return
            if link.episode:
                self.open_episode(link.name, link.time, link.paused)
                return
            values = dict(link.values)
            trial = self._load(link.name, values, link.variant)
            seed = trial.seed if link.seed is None else link.seed
            beginning = shipped_beginning() if (link.name, values, seed) == FIRST else None
            with self._opening:
                if self._player is None:  # a window may have opened another one meanwhile
                    self._start(trial, link.name, values, seed, link.variant, link.paused, beginning, link.time)
        except (CrowdbotError, OSError) as error:
            self._problem = str(error)
            self.session.tell("simulator.status", self._status())

    def _load(self, name: str, values: dict[str, str], variant: int) -> Trial:
        trial = self.session.workspace.trial(name, values)
        if trial.sweeps:
            variants = expand_sweeps(trial)
            if not 1 <= variant <= len(variants):
                raise InputError(f"variant = {variant}: {name} has {len(variants)} variants")
            trial = variants[variant - 1]
        return trial

    def _start(
        self,
        trial: Trial,
        name: str,
        values: dict[str, str],
        seed: int,
        variant: int,
        paused: bool,
        beginning: RecordedBeginning | None = None,
        at: float | None = None,
    ) -> None:
        self._number += 1
        file = self.session.workspace.writable(f".running/{self._number}.mcap")
        run = LiveRun(trial, int(seed), file, self._view(), self._tell, paused, beginning, at or 0.0)
        source = {"kind": "run", "name": name, "settings": values, "variant": variant, "seed": int(seed)}
        self._replace(run, source | {"preview": trial_preview(trial)})

    def _replace(self, player: Player, source: dict[str, Any]) -> None:
        with self._opening:
            old, self._player, self._source, self._problem = self._player, player, source, ""
            if old is not None:
                player.loop.speed = old.loop.speed
                old.close(0.0)
            self._history.clear()
            self.session.discard("scene")  # a frame of the run before would hide the preview of this one
            self.session.tell("simulator.opened", {"source": source, "status": player.status()})
            player.start()

    def _tell(self, player: Player) -> None:
        if player is not self._player:
            return
        status = player.status()
        if status["values"] and (not self._history or self._history[-1][0] != status["time"]):
            self._history.append([round(status["time"], 3), status["values"]])
        self.session.tell("simulator.status", status)

    def _status(self) -> dict[str, Any]:
        if self._player is None:
            return {
                "state": "failed" if self._problem else "none",
                "problems": [self._problem] if self._problem else [],
            }
        return self._player.status()

    def _playback(self) -> Playback:
        player = self._any()
        if not isinstance(player, Playback):
            raise InputError("this is a running trial; save it and open the episode to jump in time")
        return player

    def _files(self, pattern: str) -> list[str]:
        return [name for name in self.session.workspace.files(pattern) if not name.startswith((".", "sessions/"))]

    def _free_name(self, stem: str) -> str:
        taken = set(self._files("*.mcap"))
        names = (f"{stem}{'' if k == 1 else f'-{k}'}.mcap" for k in range(1, 10_000))
        return next(name for name in names if name not in taken)

    def _branch(self, source: Path, at: float, values: dict[str, str], path: Path, target: str) -> None:
        def progress(share: float) -> None:
            self.session.tell("simulator.branch", {"name": target, "share": round(share, 3)})

        try:
            done = branch(source, at, changes=values, out=path, progress=progress)
            tell = {"name": target, "share": 1.0, "done": True, "at": at, "outcome": done.outcome}
        except (CrowdbotError, OSError) as error:
            tell = {"name": target, "error": str(error)}
        self.session.tell("simulator.branch", tell)

    @command
    def description(self) -> dict[str, Any]:
        """Return what stands still in the picture; nothing while the simulation is being prepared."""
        player, recorded = self._any(), self._beginning()
        if recorded is not None:
            return recorded.description()
        result: dict[str, Any] = {} if player.state == "preparing" else player.do(player.view.description)
        return result

    @command
    def show_frame(self) -> None:
        """Send the current state again, for a new window."""
        self._any()
        self._cameras.renew()
        self._show()

    def _show(self) -> None:
        """Send the current state, and of the images those that the windows do not have."""
        player = self._any()
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
            self._show()
        self.session.tell("simulator.layers", sorted(self._layers))

    @command
    def cameras(self, names: list[str]) -> None:
        """Choose the camera images that are sent, by their names in the description."""
        self._cameras.choose(frozenset(names[:MOST_IMAGES]))
        if self._player is not None:
            self._show()
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
            self._show()
        self.session.tell("simulator.predictor", name)

    def _view(self) -> StageView:
        return StageView(self.session, self._layers, predictor=self._predictor, cameras=self._cameras)

    @property
    def run(self) -> LiveRun:
        """The running trial; raises InputError if there is none."""
        return self._live()

    @command
    def order(self, order: dict[str, Any]) -> None:
        """Give an order, in the JSON form of an order in an episode file."""
        self._prepared().order(read_order(json.dumps({**order, "source": SOURCE})))

    @command
    def inspect(self, id: int) -> dict[str, Any]:
        """Return the state of a person or robot."""
        player = self._any()
        result: dict[str, Any] = self._asked(lambda: inspect_agent(player.simulation, id))
        return result

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
        self._prepared().order(ParameterOrder(path=path, value=text, source=SOURCE))

    @command
    def add_robot(
        self, type: str, x: float, y: float, goal_x: float, goal_y: float, navigator: str = "orca"
    ) -> str:  # fmt: skip
        """Add a robot of a built-in type, and return its name.

        It has the sensors of its type if the people of the trial have limbs for them, otherwise a planar laser scanner.
        """
        run = self._prepared()
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
        """Let the user drive a robot: its navigator becomes ``external``.

        A run that is being prepared does so as soon as it is ready, because the stop button of a headset must not fail.
        """
        run = self._live()
        if robot in run.controls:
            return
        prepares = run.state == "preparing"
        spec = _robot(run.trial if prepares else run.do(lambda: run.simulation.trial), robot)
        if spec.mirror is not None or bool(getattr(spec.navigator, "source", "")):
            raise InputError(f"robot {robot!r} is moved over its own connection; the app cannot drive it")
        if not isinstance(spec.navigator, ExternalNavigator):
            run.order_in_turn([ParameterOrder(path=f"robot[{robot}]/navigator/type", value=EXTERNAL, source=SOURCE)])
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
        run = self._prepared()
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
            raise InputError(PREPARING)
        return player.do(action)

    def _beginning(self) -> BeginningPlayer | None:
        """Return what shows a recording while the run is prepared."""
        found = self._player.beginning if isinstance(self._player, LiveRun) else None
        return found if found is not None and found.active else None

    def _any(self) -> Player:
        if self._player is None:
            raise InputError("nothing is open: open a trial or an episode")
        return self._player

    def _prepared(self) -> LiveRun:
        """Return the run if it can take orders now: the thread of the desk must not wait while it is compiled."""
        run = self._live()
        if run.state == "preparing":
            raise InputError(PREPARING)
        return run

    def _live(self) -> LiveRun:
        player = self._any()
        if not isinstance(player, LiveRun):
            raise InputError("a recorded episode cannot be steered; branch it, or open its trial")
        return player


def _recorded_instant(player: Playback, at: float) -> float:
    times = player.episode.times
    return float(times[int(abs(times - at).argmin())])


def _free_name(simulation: Simulation) -> tuple[str, bool]:
    """Return a new name of a robot, and whether people have limbs."""
    names = {robot.name for robot in simulation.trial.robots} | {
        former_robot.robot.name for former_robot in simulation.former_robots
    }
    name = next(name for k in range(1, 1000) if (name := f"added{k}") not in names)
    return name, worlds_of(simulation.world)[0].people is not None


def _robot(trial: Trial, name: str) -> RobotSpec:
    robots = {robot.name: robot for robot in trial.robots}
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
    known = [avatar.name for avatar in trial.avatars]
    if name not in known:
        raise InputError(f"there is no avatar {name!r}{did_you_mean(name, known)}; the trial has {known or 'none'}")
    recorded = sum(len(item.walks(trial.duration)) for item in trial.recorded)
    slot = trial.people - recorded - len(known) + known.index(name)
    scene = simulation.world.environment_scene(0)
    x, y = scene.position[0, slot].tolist()
    return HeldAvatar(name, x, y, float(scene.heading[0, slot]), float(scene.radius[0, slot]))


def run_command(source: Mapping[str, Any], place: str, steered: str = "") -> str:
    """Return the command that gives the same run, or that replays the episode.

    Args:
        source: what is open: ``kind``, ``name``, and for a run ``settings``, ``variant`` and ``seed``.
        place: path of the file, or name of the built-in trial.
        steered: what the user did to the run, which only its recording has; empty for nothing.

    >>> source = {"kind": "run", "name": "frontal", "settings": {"duration": "5"}, "variant": 1, "seed": 3}
    >>> run_command(source, "frontal")
    'crowdbot run frontal --seed 3 --set duration=5'
    """
    if source["kind"] == "episode":
        return f"crowdbot replay {shlex.quote(place)}"
    words = ["crowdbot run", shlex.quote(place), f"--seed {source['seed']}"]
    words += [f"--set {shlex.quote(f'{name}={value}')}" for name, value in source["settings"].items()]
    words += [f"--variant {source['variant']}"] if source["variant"] != 1 else []
    lines = [f"# without {steered}: save the run and use crowdbot replay for the same run"] if steered else []
    return "\n".join([*lines, " ".join(words)])


def run_python(source: Mapping[str, Any], place: str, steered: str = "") -> str:
    """Return a program that gives the same run, or that reads the episode; arguments as of :func:`run_command`."""
    if source["kind"] == "episode":
        return f"""from crowdbot.recording import replay

found = replay({place!r})
print(found.outcomes[1], found.replayed, found.replayed == found.recorded)
"""
    values = f", **{dict(source['settings'])!r}" if source["settings"] else ""
    note = f"# without {steered}: save the run and replay it for the same run\n" if steered else ""
    variant = f"trial = expand_sweeps(trial)[{source['variant'] - 1}]\n" if source["variant"] != 1 else ""
    names = "expand_sweeps, load_trial" if variant else "load_trial"
    return f"""{note}from crowdbot.recording import record
from crowdbot.trials import {names}

trial = load_trial({place!r}{values})
{variant}run = record(trial, {source["seed"]}, "episode.mcap")
print(run.outcome, run.digest)
"""


@dataclass
class HeldVelocity:
    """The velocity at which a user drives a robot.

    Fields:
        robot: name of the robot.
        forward, turn, left: [m/s], [rad/s], [m/s].
    """

    robot: str
    forward: float = 0.0
    turn: float = 0.0
    left: float = 0.0

    def __post_init__(self) -> None:
        self._held = time.monotonic()
        self._sent: tuple[float, float, float] | None = None
        self._tick = 0

    def hold(self, forward: float, turn: float, left: float) -> None:
        """Set the velocity."""
        self.forward, self.turn, self.left = forward, turn, left
        self._held = time.monotonic()

    def orders(self, simulation: Simulation) -> list[Order]:
        """Return the order for this step: if the velocity has changed, and often enough for the timeout."""
        if time.monotonic() - self._held > LET_GO:
            self.forward = self.turn = self.left = 0.0
        now, step = (self.forward, self.turn, self.left), simulation.world.clock.dt
        if now == self._sent and (simulation.tick - self._tick) * step < REPEAT:
            return []
        self._sent, self._tick = now, simulation.tick
        return [VelocityOrder(robot=self.robot, forward=now[0], turn=now[1], left=now[2], source=SOURCE)]


@dataclass
class HeldAvatar:
    """The velocity at which a user walks an avatar, and its pose.

    Fields:
        avatar: name of the avatar.
        x, y, heading: pose [m], [rad].
        forward, left, turn: velocity in the frame of the avatar [m/s], [m/s], [rad/s].
    """

    avatar: str
    x: float
    y: float
    heading: float
    radius: float = 0.25
    forward: float = 0.0
    left: float = 0.0
    turn: float = 0.0

    def __post_init__(self) -> None:
        self._held = time.monotonic()

    def hold(self, forward: float, left: float, turn: float) -> None:
        """Set the velocity; its length is limited."""
        speed = math.hypot(forward, left)
        share = min(1.0, RUN / speed) if speed > 0.0 else 1.0
        self.forward, self.left, self.turn = forward * share, left * share, turn
        self._held = time.monotonic()

    def orders(self, simulation: Simulation) -> list[Order]:
        """Return the pose at the end of the next step; walls are not passed."""
        if time.monotonic() - self._held > LET_GO:
            self.forward = self.left = self.turn = 0.0
        step = simulation.world.clock.dt
        self.heading += self.turn * step
        cos, sin = math.cos(self.heading), math.sin(self.heading)
        x = self.x + (self.forward * cos - self.left * sin) * step
        y = self.y + (self.forward * sin + self.left * cos) * step
        for place in ((x, y), (x, self.y), (self.x, y)):
            if self._is_free(place, simulation.world.environment_scene(0)):
                self.x, self.y = place
                break
        now = float(simulation.world.times[0]) + step
        values: dict[str, Any] = {"x": self.x, "y": self.y, "heading": self.heading}
        return [AvatarOrder(avatar=self.avatar, time=round(now, 9), source=SOURCE, **values)]

    def _is_free(self, place: tuple[float, float], scene: Any) -> bool:
        path = np.array([(self.x, self.y), place])
        before, after = wall_clearance(path, self.radius, scene.walls.segments())
        return bool(after >= 0.0 or after > before)
