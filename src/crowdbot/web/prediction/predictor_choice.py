"""PredictorChoice: a predictor as the dialogs describe it, with its command line and its Python text."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from crowdbot.calibration import goal_class, resolve_search
from crowdbot.core import InputError, did_you_mean, from_attributes, kebab_case
from crowdbot.prediction import WEIGHTS_FIELDS, PredictorSpec, Simulated

from .form_rows import builtin_kinds, form_rows, written_values

MOST_SAMPLES = 100
MOST_BUDGET = 100_000
SIMULATED = "simulated"
LEARNT = ("", "prior", "shared")


@dataclass(frozen=True)
class PredictorChoice:
    """A predictor that was chosen in a dialog.

    Fields:
        predictor: name of the predictor.
        samples: number of futures per person.
        model, cost, search, goal: names of the parts of a simulated predictor; None takes the default.
        budget: candidate crowds per window.
        tolerance, patience: when a search stops early; None takes the default.
        free: calibrated parameters; empty means all.
        learnt: ``prior`` or ``shared`` if the learning part of the recording gives a prior or one set of parameters.
        values: parameters that differ from their defaults, as words.
        weights: file of trained weights of a learned predictor; empty means those that ship.

    >>> choice = PredictorChoice.of({"predictor": "simulated", "model": "orca", "values": {"time_horizon": 3.0}})
    >>> " ".join(choice.words())
    '--predictor simulated --model orca --set time_horizon=3.0'
    """

    predictor: str
    samples: int = 1
    model: str | None = None
    cost: str | None = None
    search: str | None = None
    goal: str | None = None
    budget: int = 500
    tolerance: float | None = None
    patience: int | None = None
    free: tuple[str, ...] = ()
    learnt: str = ""
    values: tuple[tuple[str, str], ...] = ()
    weights: str = ""

    @classmethod
    def of(cls, settings: Mapping[str, Any]) -> PredictorChoice:
        """Return the choice of a dialog, checked.

        Raises:
            InputError: a name is unknown or a value is not allowed.
        """
        known = {field.name for field in dataclasses.fields(cls)}
        wrong = next((key for key in settings if key not in known), None)
        if wrong is not None:
            raise InputError(f"a predictor has no setting {wrong!r}{did_you_mean(wrong, known)}")
        kind = _named("predictors", settings.get("predictor"))
        values = settings.get("values") or {}
        if not isinstance(values, dict):
            raise InputError("values of a predictor must be an object of names and values")
        own: dict[str, Any] = {"predictor": settings["predictor"], "samples": _count(settings, "samples", MOST_SAMPLES)}
        if kind is not Simulated:
            found = written_values(kind, values, own["predictor"])
            weights = settings.get("weights") or ""
            if weights and own["predictor"] not in WEIGHTS_FIELDS:
                raise InputError(f"{own['predictor']} has no weights; known are {', '.join(WEIGHTS_FIELDS)}")
            if weights:
                found[WEIGHTS_FIELDS[own["predictor"]]] = str(weights)
            return cls(**own, values=tuple(found.items()), weights=str(weights))
        parts = (("model", "models"), ("cost", "costs"), ("search", "searches"), ("goal", "goals"))
        for part, kinds in parts:
            if settings.get(part):
                _named(kinds, settings[part])
                own[part] = settings[part]
        model = own.setdefault("model", "orca")
        crowd = {name: values[name] for name in _crowd_names() if name in values}
        rest = {key: value for key, value in values.items() if key not in crowd}
        found = written_values(Simulated, crowd, SIMULATED) | written_values(
            builtin_kinds("models")[model], rest, model
        )
        own["values"] = tuple(found.items())
        if "cost" in own or "search" in own:
            own |= _search_settings(settings)
        return cls(**own)

    @property
    def calibrated(self) -> bool:
        """Whether a crowd is calibrated."""
        return self.cost is not None or self.search is not None

    @property
    def settings(self) -> dict[str, Any]:
        """The choice as JSON."""
        values = dict(self.values)
        if self.weights:
            values.pop(WEIGHTS_FIELDS[self.predictor])
        return {**dataclasses.asdict(self), "free": list(self.free), "values": values}

    def spec(self) -> PredictorSpec:
        """Return the predictor.

        Raises:
            InputError: a value is outside its range, or the parts do not fit together.
        """
        values = dict(self.values)
        if self.predictor != SIMULATED:
            return PredictorSpec(from_attributes(builtin_kinds("predictors")[self.predictor], values))
        own = {key: value for key, value in values.items() if key in _crowd_names()}
        rest = {key: value for key, value in values.items() if key not in own}
        fields: dict[str, Any] = {"model": from_attributes(builtin_kinds("models")[str(self.model)], rest)}
        if self.calibrated:
            fields |= {"cost": self.cost, "search": self._search(), "budget": self.budget, "free": self.free}
        if self.goal is not None and not self._late:
            fields["goal"] = self.goal
        predictor = dataclasses.replace(from_attributes(Simulated, own), **fields)
        late = self.goal if self._late else None
        return PredictorSpec(predictor, late, self.learnt == "prior", self.learnt == "shared")

    def words(self) -> list[str]:
        """Return the options of `crowdbot predict` for this predictor."""
        found = ["--predictor", self.predictor]
        for name in ("model", "cost", "search", "goal"):
            if getattr(self, name) is not None:
                found += [f"--{name}", getattr(self, name)]
        if self.calibrated:
            found += ["--budget", str(self.budget)]
            found += ["--tolerance", str(self.tolerance)] if self.tolerance is not None else []
            found += ["--patience", str(self.patience)] if self.patience is not None else []
            found += ["--free", *self.free] if self.free else []
        found += {"prior": ["--prior", "learn"], "shared": ["--shared"]}.get(self.learnt, [])
        found += ["--set", *(f"{name}={value}" for name, value in self.values)] if self.values else []
        return found + (["--samples", str(self.samples)] if self.samples > 1 else [])

    def python(self) -> str:
        """Return Python text that makes the predictor; ``cb`` is crowdbot, its classes come from there."""
        spec = self.spec()
        made = _expression(spec.predictor)
        more = [f"goal={spec.goal!r}"] if spec.goal is not None else []
        more += [f"{word}=True" for word in ("prior", "shared") if getattr(spec, word)]
        return f"PredictorSpec({', '.join([made, *more])})"

    @property
    def _late(self) -> bool:
        kind = goal_class(self.goal or "current-direction")
        return kind.knows_future or kind.learns

    def _search(self) -> Any:
        given = {key: value for key in ("tolerance", "patience") if (value := getattr(self, key)) is not None}
        if self.search is None and given:
            raise InputError(f"{next(iter(given))} requires a search")
        return None if self.search is None else dataclasses.replace(resolve_search(self.search), **given)


def _crowd_names() -> list[str]:
    """Return the values of the simulated predictor itself; all others are parameters of its crowd model."""
    return [row["name"] for row in form_rows(Simulated)]


def _named(kind: str, name: Any) -> type:
    known = builtin_kinds(kind)
    if name not in known:
        near = did_you_mean(str(name), known)
        raise InputError(f"unknown {kind.removesuffix('s')} {name!r:.60}{near}; known are {', '.join(known)}")
    return known[name]


def _count(settings: Mapping[str, Any], name: str, most: int, default: int = 1) -> int:
    value = settings.get(name)
    value = default if value is None else value
    if not isinstance(value, int) or isinstance(value, bool) or not 1 <= value <= most:
        raise InputError(f"{name} = {value!r:.60} must be a whole number from 1 to {most}")
    return value


def _search_settings(settings: Mapping[str, Any]) -> dict[str, Any]:
    found: dict[str, Any] = {"budget": _count(settings, "budget", MOST_BUDGET, 500)}
    tolerance, patience = settings.get("tolerance"), settings.get("patience")
    if tolerance is not None:
        if isinstance(tolerance, bool) or not isinstance(tolerance, int | float):
            raise InputError(f"tolerance = {tolerance!r:.60} must be a number")
        found["tolerance"] = float(tolerance)
    if patience is not None:
        found["patience"] = _count(settings, "patience", MOST_BUDGET)
    free = settings.get("free") or []
    if not isinstance(free, list) or not all(isinstance(item, str) for item in free):
        raise InputError("free must be a list of names of parameters")
    learnt = settings.get("learnt") or ""
    if learnt not in LEARNT:
        raise InputError(f"learnt = {learnt!r:.60} is unknown; known are prior and shared")
    return {**found, "free": tuple(free), "learnt": learnt}


def _expression(value: Any) -> str:
    """Return Python text for a predictor or a part of one; fields with their default values are omitted."""
    if not dataclasses.is_dataclass(value):
        return repr(value)
    words = []
    for field in dataclasses.fields(value):
        if not field.init or not field.repr:
            continue
        default = field.default_factory() if field.default_factory is not dataclasses.MISSING else field.default
        own = getattr(value, field.name)
        same = type(own) is type(default) and own == default
        if not same:
            words.append(f"{field.name}={_expression(own)}")
    return f"{_home(type(value))}({', '.join(words)})"


def _home(kind: type) -> str:
    """Return the name of a class in the text: its room and its name."""
    room = kind.__module__.split(".")[1]
    sub = ".goals" if kind in builtin_kinds("goals").values() else ""
    assert kebab_case(kind.__name__)
    return f"crowdbot.{room}{sub}.{kind.__name__}"
