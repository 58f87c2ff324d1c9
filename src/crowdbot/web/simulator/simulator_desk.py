"""SimulatorDesk: opens trials and episodes, plays them, and saves what was recorded."""

from __future__ import annotations

import functools
import threading
from collections import deque
from pathlib import Path
from typing import Any, ClassVar

from crowdbot.catalogue import builtin_names
from crowdbot.core import CrowdbotError, InputError, builtin_name
from crowdbot.prediction import Predictor
from crowdbot.recording import branch
from crowdbot.trials import (
    Trial,
    add_element,
    expand_sweeps,
    override_remarks,
    trial_remarks,
    trial_titles,
)  # fmt: skip
from crowdbot.web.command import command
from crowdbot.web.desk import DeskWindows, Resource
from crowdbot.web.scene import LAYERS, scene_resource
from crowdbot.web.workspace import shown_path

from .first_trial import FIRST
from .live_run import LiveRun
from .live_values import LIVE_VALUES
from .picture_desk import PictureDesk
from .playback import Playback
from .recorded_beginning import RecordedBeginning, shipped_beginning
from .run_source import run_command, run_python
from .steering_desk import Player
from .thumbnail import thumbnail
from .trial_parameters import parameter_rows
from .trial_preview import trial_preview

__all__ = ["SimulatorDesk"]

HISTORY = 1500
"""Instants of the live values that a new window gets."""
AVATAR = "you"
"""Name of the person that the user moves."""
WAIT = 8.0
"""Longest time [s] that closing waits for a run, which may be compiling and then ends by itself."""


class SimulatorDesk(PictureDesk):
    """The simulator tab of a session: at most one trial runs, or one episode plays."""

    name = "simulator"
    first: ClassVar[str | None] = None
    """Trial or episode that a new session opens instead of :data:`FIRST`."""

    def __init__(self, session: DeskWindows) -> None:
        super().__init__(session)
        self._opening = threading.RLock()
        self._number = 0
        self._source: dict[str, Any] = {}
        self._history: deque[list[Any]] = deque(maxlen=HISTORY)
        self._greeted = False
        self._branching: threading.Thread | None = None
        self._problem = ""

    def greet(self) -> dict[str, Any]:
        """Return what is open; the first window of a session opens the first trial."""
        if not self._greeted:
            self._greeted = True
            threading.Thread(target=self._open_first, name="crowdbot-open", daemon=True).start()
        return {
            "status": self._status(), "source": self._source, "layers": sorted(self._layers),
            "cameras": sorted(self._cameras.chosen), "predictor": builtin_name(type(self._predictor), Predictor),
            "known_layers": [{"name": name, "title": title} for name, title in LAYERS.items()],
            "plots": [one._asdict() for one in LIVE_VALUES], "history": list(self._history),
        }  # fmt: skip

    @command
    def trials(self) -> list[dict[str, Any]]:
        """Return the built-in trials with their parameters, and the trial files of the folder."""
        titles = trial_titles()
        found = [
            {"name": name, "title": titles[name], "built_in": True, "parameters": parameter_rows(name)}
            for name in sorted(titles, key=lambda one: (one.startswith("challenge"), one))
        ]
        own = [
            {"name": name, "title": "", "built_in": False, "parameters": []} for name in self.session.workspace.trials()
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
        if any(one.name == AVATAR for one in old.avatars):
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
        found: dict[str, Any] = player.do(
            lambda: {"events": [one._asdict() for one in player.events], "series": player.series}
        )
        return found

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
        run = self._live()
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
            changes += ["the person that you move"] if any(one.name == AVATAR for one in player.trial.avatars) else []
        return self._source, place, " and ".join(changes)

    @command
    def ping(self) -> None:
        """Do nothing, to measure the latency."""

    def resource(self, path: str, query: dict[str, str]) -> Resource:
        """Return a thumbnail of a trial, or meshes of the picture."""
        kind, _, name = path.partition("/")
        if kind == "thumbnail":
            name = name.removesuffix(".svg")
            file = self.session.workspace.readable(name) if name.endswith(".xml") else None
            return Resource(thumbnail(name, file), "image/svg+xml")
        player = self._any()
        if (recorded := self._beginning()) is not None:
            return recorded.resource(path)
        found: Resource = player.do(lambda: scene_resource(player.view.simulation, path, query))
        return found

    def close(self) -> None:
        """Stop the run."""
        player, self._player = self._player, None
        if player is not None:
            player.close(WAIT)
        self._cameras.close()
        if self._branching is not None:
            self._branching.join(WAIT)

    def _open_first(self) -> None:
        try:
            if self._player is not None:
                return
            if self.first is None:
                name, values, seed = FIRST
                trial = self._load(name, values, 1)
                with self._opening:
                    if self._player is None:  # a window may have opened another one meanwhile
                        self._start(trial, name, dict(values), seed, 1, False, shipped_beginning())
            elif self.first.endswith(".mcap"):
                self.open_episode(self.first)
            else:
                self.open(self.first)
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
    ) -> None:
        self._number += 1
        file = self.session.workspace.writable(f".running/{self._number}.mcap")
        run = LiveRun(trial, int(seed), file, self._view(), self._tell, paused, beginning)
        source = {"kind": "run", "name": name, "settings": values, "variant": variant, "seed": int(seed)}
        self._replace(run, source | {"preview": trial_preview(trial)})

    def _replace(self, player: Player, source: dict[str, Any]) -> None:
        with self._opening:
            old, self._player, self._source, self._problem = self._player, player, source, ""
            if old is not None:
                player.loop.speed = old.loop.speed
                old.close(0.0)
            self._history.clear()
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


def _recorded_instant(player: Playback, at: float) -> float:
    times = player.episode.times
    return float(times[int(abs(times - at).argmin())])
