"""EvaluationRequest: what an evaluation of the app runs, as JSON beside its results."""

from __future__ import annotations

import json
import shlex
from dataclasses import asdict, dataclass
from pathlib import Path

from crowdbot.core import InputError
from crowdbot.evaluation import EvaluationPlan, families_of, parse_methods, parse_seeds, parse_statistic, with_safety
from crowdbot.metrics import LOG_FAMILIES
from crowdbot.trials import builtin_trials, load_builtin_trial, load_trial
from crowdbot.web.jobs.job_forms import check_text
from crowdbot.web.workspace import shown_path

__all__ = ["FILE", "EvaluationRequest"]

FILE = "request.json"
MOST_RUNS = 100_000


@dataclass(frozen=True)
class EvaluationRequest:
    """Trials, navigators and seeds of an evaluation, in the words of ``crowdbot evaluate``.

    Fields:
        trials: built-in names, or trial files relative to the folder.
        navigators: as for ``--navigators``.
        seeds: as for ``--seeds``.
        metrics: statistics, the columns of the table.
        safety: each navigator without and with a safety layer.
    """

    trials: tuple[str, ...]
    navigators: str
    seeds: str
    metrics: tuple[str, ...]
    safety: bool = False

    def plan(self, folder: Path) -> EvaluationPlan:
        """Return the plan.

        Args:
            folder: folder of the trial files.

        Raises:
            InputError: a trial, navigator, seed or metric is wrong, or there are more than 100 000 runs.
        """
        check_text(self.navigators, "navigators")
        if not self.trials:
            raise InputError("an evaluation needs a trial")
        found = [
            load_builtin_trial(one) if one in builtin_trials() else load_trial(_inside(folder, one))
            for one in self.trials
        ]
        statistics = [parse_statistic(check_text(name, "metrics")) for name in self.metrics]
        families = (*LOG_FAMILIES, *families_of([one.metric for one in statistics]))
        methods = parse_methods(self.navigators)
        methods = with_safety(methods) if self.safety else methods
        plan = EvaluationPlan(found, methods, seeds=parse_seeds(self.seeds), families=families, trust=False)
        if (runs := len(plan.cells) * len(plan.seeds)) > MOST_RUNS:
            raise InputError(f"the evaluation has {runs} runs, at most {MOST_RUNS}; take fewer seeds or trials")
        return plan

    def command(self, folder: Path) -> str:
        """Return the same evaluation on the command line; trial files are in the folder."""
        places = [shlex.quote(one) for one in self._places(folder)]
        words = ["crowdbot evaluate", *places, f'--navigators "{self.navigators}"', f"--seeds {self.seeds}"]
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
        return f"""from crowdbot.evaluation import {", ".join(names)}
from crowdbot.trials import load_trial

trials = [load_trial(name) for name in {list(self._places(folder))!r}]
methods = {f"with_safety({methods})" if self.safety else methods}
result = evaluate(EvaluationPlan(trials, methods, seeds=parse_seeds({self.seeds!r})))
for cell in result.cells:
    print(cell.trial, cell.method, *(cell.estimate(name) for name in {list(self.metrics)!r}), sep="; ")
"""

    def _places(self, folder: Path) -> list[str]:
        """Return names of built-in trials, and paths of files from the working folder."""
        return [one if one in builtin_trials() else shown_path(folder / one) for one in self.trials]

    @property
    def words(self) -> tuple[str, ...]:
        """The words of the command line, without ``--out``."""
        safety = ["--safety=both"] if self.safety else []
        return (
            "evaluate", *self.trials, f"--navigators={self.navigators}", f"--seeds={self.seeds}",
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
            rows = {name: tuple(map(str, values[name])) for name in ("trials", "metrics")}
            return EvaluationRequest(
                navigators=str(values["navigators"]), seeds=str(values["seeds"]), safety=bool(values["safety"]), **rows
            )
        except OSError:
            raise InputError(f"{folder.name} was not made by the app; its runs cannot be repeated here") from None
        except (ValueError, KeyError, TypeError):
            raise InputError(f"{FILE} of {folder.name} is damaged; run the evaluation again") from None


def _inside(folder: Path, name: str) -> Path:
    path = (folder / name).resolve()
    if not path.is_relative_to(folder.resolve()) or path.suffix != ".xml":
        load_builtin_trial(name) if not path.suffix else None  # raises the sentence with near names
        raise InputError(f"{name!r} is neither a built-in trial nor a trial file in the folder of the app")
    return path
