"""EvaluationRequest: what an evaluation of the app runs, as JSON beside its results."""

from __future__ import annotations

import contextlib
import itertools
import json
import posixpath
import shlex
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from crowdbot.core import InputError
from crowdbot.evaluation import (
    EvaluationPlan,
    families_of,
    parse_methods,
    parse_robots,
    parse_seeds,
    parse_statistic,
    with_safety,
)
from crowdbot.metrics import LOG_FAMILIES
from crowdbot.trials import Trial, builtin_trials, load_builtin_trial, load_trial, remarks_at_end, robot_lines
from crowdbot.web.jobs.job_forms import check_text
from crowdbot.web.workspace import shown_path
from crowdbot.world import Robot

FILE = "request.json"
MOST_RUNS = 100_000


@dataclass(frozen=True)
class EvaluationRequest:
    """Trials, navigators, robots and seeds of an evaluation, in the words of ``crowdbot evaluate``.

    Fields:
        trials: built-in names, or trial files relative to the folder.
        navigators: as for ``--navigators``.
        seeds: as for ``--seeds``.
        metrics: statistics, the columns of the table.
        safety: each navigator without and with a safety layer.
        robots: as for ``--robots``.
        lines: what ``crowdbot evaluate`` prints about the robots, as of the plan that was run.
    """

    trials: tuple[str, ...]
    navigators: str
    seeds: str
    metrics: tuple[str, ...]
    safety: bool = False
    robots: str = ""
    lines: tuple[str, ...] = ()

    def plan(self, folder: Path) -> EvaluationPlan:
        """Return the plan.

        Args:
            folder: folder of the trial files.

        Raises:
            InputError: a trial, navigator, robot, seed or metric is wrong, or there are more than 100 000 runs.
        """
        check_text(self.navigators, "navigators")
        trials = self.load_trials(folder)
        statistics = [parse_statistic(check_text(name, "metrics")) for name in self.metrics]
        families = (*LOG_FAMILIES, *families_of([statistic.metric for statistic in statistics]))
        methods = parse_methods(self.navigators)
        methods = with_safety(methods) if self.safety else methods
        own = self._robot_folders(trials, folder)
        plan = EvaluationPlan(
            trials,
            methods,
            self._robot_names,
            parse_seeds(self.seeds),
            families=families,
            trust=False,
            folder=folder,
        )
        for place in own:
            Robot.load(place)  # what it names must be in its own folder
        if (runs := len(plan.cells) * len(plan.seeds)) > MOST_RUNS:
            raise InputError(f"the evaluation has {runs} runs, at most {MOST_RUNS}; take fewer seeds or trials")
        return plan

    def load_trials(self, folder: Path) -> list[Trial]:
        """Return the trials; names of files and code in them and in the request start from the folder.

        Raises:
            InputError: there is none, or one is wrong or outside the folder.
        """
        if not self.trials:
            raise InputError("an evaluation needs a trial")
        return [
            load_builtin_trial(trial, folder=folder)
            if trial in builtin_trials()
            else load_trial(_inside(folder, trial))
            for trial in self.trials
        ]

    def _robot_folders(self, trials: Sequence[Trial], folder: Path) -> list[Path]:
        """Return the robot folders that the robots may name; an address outside the folder is an error."""
        check_text(self.robots, "robots")
        homes = dict.fromkeys([folder, *(trial.folder or folder for trial in trials)])
        found = []
        for name, home in itertools.product(filter(None, self._robot_names), homes):
            place = (home / name).resolve()
            if not place.is_relative_to(folder.resolve()):
                raise InputError(f"robots: file {name!r:.80} is outside the folder of the app")
            with contextlib.suppress(OSError):  # too long for a name
                found += [place] if (place / "robot.xml").is_file() else []
        return found

    def command(self, folder: Path) -> str:
        """Return the same evaluation on the command line; trial files are in the folder."""
        places = [shlex.quote(place) for place in self._places(folder)]
        words = ["crowdbot evaluate", *places, f'--navigators "{self.navigators}"', f"--seeds {self.seeds}"]
        robots = ",".join(self._robot_places(folder))
        words += [f"--robots {shlex.quote(robots)}"] if robots else []
        words += [f'--metrics "{", ".join(self.metrics)}"', *(["--safety both"] if self.safety else [])]
        return " ".join(words)

    def python(self, folder: Path) -> str:
        """Return a Python program that gives the same table; trial files are in the folder."""
        names = [
            "EvaluationPlan",
            "evaluate",
            "parse_methods",
            "parse_seeds",
            *(["with_safety"] if self.safety else []),
        ]
        methods = f"parse_methods({self.navigators!r})"
        robots, robot = (f"{self._robot_places(folder)!r}, ", "cell.robot, ") if self.robots.strip() else ("", "")
        return f"""from crowdbot.evaluation import {", ".join(names)}
from crowdbot.trials import load_trial

trials = [load_trial(name) for name in {list(self._places(folder))!r}]
methods = {f"with_safety({methods})" if self.safety else methods}
result = evaluate(EvaluationPlan(trials, methods, {robots}seeds=parse_seeds({self.seeds!r})))
for cell in result.cells:
    print(cell.trial, cell.method, {robot}*(cell.estimate(name) for name in {list(self.metrics)!r}), sep="; ")
"""

    def _places(self, folder: Path) -> list[str]:
        """Return names of built-in trials, and paths of files from the working folder."""
        return [trial if trial in builtin_trials() else shown_path(folder / trial) for trial in self.trials]

    def _robot_places(self, folder: Path) -> list[str]:
        """Return names of robots, and paths of robot folders from the working folder."""
        return [
            shown_path(folder / robot_name)
            if robot_name and (folder / robot_name / "robot.xml").is_file()
            else robot_name
            for robot_name in self._robot_names
        ]

    @property
    def _robot_names(self) -> list[str]:
        """Names of the robots; an empty name is the robot of the trial."""
        return [posixpath.normpath(name) if name else "" for name in parse_robots(self.robots)]

    @property
    def words(self) -> tuple[str, ...]:
        """The words of the command line, without ``--out``."""
        safety = ["--safety=both"] if self.safety else []
        robots = [f"--robots={','.join(self._robot_names)}"] if self.robots.strip() else []
        return (
            "evaluate", *self.trials, f"--navigators={self.navigators}", *robots, f"--seeds={self.seeds}",
            f"--metrics={','.join(self.metrics)}", *safety,
        )  # fmt: skip

    def save(self, folder: Path) -> None:
        """Write the request into the folder of the results."""
        folder.mkdir(parents=True, exist_ok=True)
        (folder / FILE).write_text(json.dumps(asdict(self), indent=1) + "\n", encoding="utf-8")

    @staticmethod
    def load(folder: Path) -> EvaluationRequest:
        """Read the request in the folder of results.

        Raises:
            InputError: there is none, or it is damaged.
        """
        try:
            values = json.loads((folder / FILE).read_text(encoding="utf-8"))
            trials, metrics, lines = (tuple(map(str, values[name])) for name in ("trials", "metrics", "lines"))
            navigators, seeds, robots = (str(values[name]) for name in ("navigators", "seeds", "robots"))
            return EvaluationRequest(trials, navigators, seeds, metrics, bool(values["safety"]), robots, lines)
        except OSError:
            raise InputError(f"{folder.name} was not made by the app; its runs cannot be repeated here") from None
        except (ValueError, KeyError, TypeError):
            raise InputError(f"{FILE} of {folder.name} is damaged; run the evaluation again") from None


def describe_robots(request: EvaluationRequest, folder: Path) -> tuple[EvaluationPlan, tuple[str, ...]]:
    """Return the plan, and the lines that ``crowdbot evaluate`` prints about its robots.

    The lines say what replaces the robots of the trials, then drive, size and sensors of each robot.

    Raises:
        InputError: the request is wrong.
    """
    with remarks_at_end() as replaced:
        plan = request.plan(folder)
    variants = [cell.variant for cell in plan.cells]
    return plan, tuple(dict.fromkeys([*replaced, *robot_lines((variant.name, variant.robots) for variant in variants)]))


def _inside(folder: Path, name: str) -> Path:
    path = (folder / name).resolve()
    if not path.is_relative_to(folder.resolve()) or path.suffix != ".xml":
        load_builtin_trial(name) if not path.suffix else None  # raises the sentence with near names
        raise InputError(f"{name!r} is neither a built-in trial nor a trial file in the folder of the app")
    return path
