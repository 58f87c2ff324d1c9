"""The headway layer on a crowd model: one class for each model, with the parameters of both."""

from __future__ import annotations

import abc
import dataclasses
import functools
import importlib
import inspect
import re
import typing
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from crowdbot.core import InputError, Neighbors, PerAgent, Scene, parameter, per_agent, unread_fields
from crowdbot.core.neighbors import nearest
from crowdbot.models.agent_rows import begin_rows
from crowdbot.models.mixture import Mixture
from crowdbot.models.model import CrowdModel, begin_step, launch, rows
from crowdbot.models.parameter_rows import parameter_rows
from crowdbot.models.valid_range import ModelRange
from crowdbot.typing import Floats

from .robot_avoidance import AVOIDANCE, avoid_robots, avoid_robots_part, robots_in
from .space_ahead import HeadwayRows, limit_speeds, limit_speeds_part

MOST = 16
"""Number of nearest agents that are compared: more do not fit around a body within the corridor."""
DEVIATIONS = 2.0
"""Limit of the caution of a person, in standard deviations."""
OWN = "crowdbot, fitted to single file"


@dataclass(frozen=True, kw_only=True)
class HeadwayLayer(CrowdModel):
    """Headway layer: a crowd model chooses the velocity, and the space ahead limits its speed.

    Args:
        headway_time_gap: time gap T to the next person ahead [s]: the speed is at most (space - spacing) / T.
        headway_spacing: space between bodies at which people stand [m].
        headway_width: half width of the corridor ahead, relative to the sum of the two radii.
        headway_taper: decrease of the time gap from the middle of the corridor to its edge (quadratic), 0 to 1.
        headway_anticipation: look-ahead time for people who walk ahead in the same direction [s].
        headway_oncoming: share of the time gap that people keep to those who walk towards them, 0 to 1.
        headway_sidestep: speed with which people who slide step past somebody who wants to walk the other way [m/s].
        headway_step_back: speed with which people who slide and are stuck step back from those whom they touch [m/s].
        headway_reaction_time: time constant with which the speed limit follows the space ahead [s]; 0: no delay.
        headway_sliding: share of the velocity alongside others and walls that people keep when their way ends there, 0
            to 1. Above 0, each person takes at most half of the gap to others in a step, and none enters a wall.
        headway_distance: maximum distance of people ahead [m].

        robot_gap: clearance to robots that people try to keep [m]; 0: a robot is one more person.
        robot_horizon: time ahead for which people foresee the way of robots [s].
        robot_weight: cost of a gap that is missing as a whole, relative to 1 for a turn by 1 rad.
        robot_slowing: cost of standing, relative to 1 for a turn by 1 rad.
        robot_behind: share of gap and horizon for robots behind the person, 0 to 1.
        robot_caution: standard deviation of the logarithm of gap and horizon between people, the same draw for both.

    The corridor lies along the velocity that the model chooses. The space is the way to contact of the two discs, and
    the speed never exceeds what this way allows in one step. Without sliding, the layer turns nobody, does not look at
    walls, and changes nothing for people without anybody ahead. With sliding, two people side by side before a door
    pass one after the other, where both would stand. Robots are people ahead, too.

    This class is abstract: :func:`with_headway` returns the class for a model.

    Source: optimal velocity function of Tordeux, Chraibi, Seyfried 2016, doi:10.1007/978-3-319-33482-0_29; time gap of
    Seyfried et al. 2005, doi:10.1088/1742-5468/2005/10/P10002.

    >>> from crowdbot.models import ORCA, with_headway
    >>> file = Scene.of([[0, 0], [0.93, 0]], [[0.5, 0], [0.5, 0]], radius=0.2, preferred_velocity=[[1.3, 0], [1.3, 0]])
    >>> with_headway(ORCA)().velocity(file, dt=0.1).round(2).tolist()
    [[[0.5, 0.0], [1.3, 0.0]]]
    """

    headway_time_gap: PerAgent = parameter(
        1.06, unit="s", low=0.3, high=2.0, source="Seyfried et al. 2005, single file", min=1e-2
    )
    headway_spacing: PerAgent = parameter(0.0, unit="m", low=0.0, high=0.3, source=OWN)
    headway_width: PerAgent = parameter(1.0, unit="1", low=0.4, high=1.5, source="Tordeux et al. 2016", min=1e-2)
    headway_taper: PerAgent = parameter(0.0, unit="1", low=0.0, high=1.0, source="Tordeux et al. 2016", max=1.0)
    headway_anticipation: PerAgent = parameter(0.0, unit="s", low=0.0, high=1.0, source="off by default")
    headway_oncoming: PerAgent = parameter(1.0, unit="1", low=0.0, high=1.0, source="off by default", max=1.0)
    headway_sidestep: PerAgent = parameter(0.3, unit="m/s", low=0.1, high=0.8, source=OWN)
    headway_step_back: PerAgent = parameter(0.0, unit="m/s", low=0.0, high=0.5, source="off by default")
    headway_reaction_time: PerAgent = parameter(0.0, unit="s", low=0.0, high=1.0, source="Tordeux et al. 2016")
    headway_sliding: PerAgent = parameter(0.0, unit="1", low=0.0, high=1.0, source="off by default", max=1.0)
    headway_distance: PerAgent = parameter(4.0, unit="m", low=1.0, high=10.0, source="free speed times time gap")
    robot_gap: PerAgent = parameter(0.0, unit="m", low=0.2, high=2.0, source="off by default")
    robot_horizon: PerAgent = parameter(4.0, unit="s", low=1.0, high=8.0, source="off by default", min=1e-2)
    robot_weight: PerAgent = parameter(4.0, unit="1", low=0.5, high=20.0, source="off by default")
    robot_slowing: PerAgent = parameter(1.0, unit="1", low=0.1, high=5.0, source="off by default")
    robot_behind: PerAgent = parameter(0.5, unit="1", low=0.0, high=1.0, source="off by default", max=1.0)
    robot_caution: PerAgent = parameter(0.0, unit="1", low=0.0, high=0.6, source="off by default", max=2.0)

    suffix: ClassVar[str] = "+headway"
    """End of the names of models with the layer, such as ``orca+headway``."""

    @property
    @abc.abstractmethod
    def base(self) -> type[CrowdModel]:
        """Class of the model under the layer."""

    def __post_init__(self) -> None:
        super().__post_init__()
        names = (field.name for field in dataclasses.fields(self.base) if field.init)
        object.__setattr__(self, "_model", self.base(**{name: getattr(self, name) for name in names}))

    @property
    def model(self) -> CrowdModel:
        """The model under the layer."""
        crowd_model: CrowdModel = self.__dict__["_model"]
        return crowd_model

    @property
    def memory_at_start(self) -> Mapping[str, float]:
        return self.model.memory_at_start

    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Floats:
        scene = self._avoid_robots(scene, dt)
        return self._limit(scene, self.model.velocity(scene, dt, rng), dt)

    def step(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Scene:
        seen = self._avoid_robots(scene, dt)
        after = self.model.step(seen, dt, rng)
        later = scene.advance(self._limit(seen, after.velocity, dt), dt)
        return later.replace(heading=after.heading, memory=after.memory)

    @property
    def is_individual(self) -> bool:
        return bool(np.any(self.robot_caution) and np.any(self.robot_gap))

    def individual(self, agents: int, rng: np.random.Generator) -> CrowdModel:
        """Return the model with a gap and a horizon for each of ``agents`` people, drawn around the common ones.

        Values that differ from person to person already are kept.

        >>> from crowdbot.models import People
        >>> People(robot_gap=0.8, robot_caution=0.3).individual(3, np.random.default_rng(1)).robot_gap.round(2).tolist()
        [0.89, 1.02, 0.88]
        """
        if not self.is_individual:
            return self
        changed: dict[str, Floats] = {}
        factor = np.exp(self.robot_caution * np.clip(rng.standard_normal(agents), -DEVIATIONS, DEVIATIONS))
        for name in ("robot_gap", "robot_horizon"):
            if np.ndim(value := getattr(self, name)) == 0:
                changed[name] = value * factor
        return dataclasses.replace(self, **changed, robot_caution=0.0)

    def __reduce__(self) -> Any:
        """Pickle the class by the model under the layer: classes with the layer are made on demand."""
        values = {field.name: getattr(self, field.name) for field in dataclasses.fields(self)}
        return _restore, (type(self).base, type(self).__name__, values)

    def _avoid_robots(self, scene: Scene, dt: float) -> Scene:
        """Return the scene with the desired velocities of people who keep away from robots."""
        for name in AVOIDANCE:  # a wrong number of values is an error without robots, too
            if np.ndim(value := getattr(self, name)):
                per_agent(value, scene.shape, name)
        if scene.robot is None or not np.any(self.robot_gap):
            return scene
        robots = robots_in(scene.robot & scene.active & scene.visible)
        if robots.shape[1] == 0:
            return scene
        laws = parameter_rows(self, AVOIDANCE, scene.shape)
        start = begin_rows(scene, dt)
        wish = np.empty((*scene.shape, 2))
        values = start.agents, start.walking, robots, laws
        launch(avoid_robots, avoid_robots_part, rows(wish), *values, scene.walls.segments())
        return scene.replace(preferred_velocity=wish)

    def _limit(self, scene: Scene, chosen: Floats, dt: float) -> Floats:
        wish, walking, seen, _ = begin_step(scene, dt)

        def each(name: str) -> Floats:
            return rows(per_agent(getattr(self, f"headway_{name}"), scene.shape, f"headway_{name}"))

        near: Neighbors = nearest(
            scene.position,
            per_agent(self.headway_distance, scene.shape, "headway_distance"),
            MOST,
            seen,
            walking,
        )
        crowd = HeadwayRows(
            rows(scene.position),
            rows(np.where(scene.active[..., None], scene.velocity, 0.0)),
            rows(chosen),
            rows(wish),
            rows(scene.radius),
            each("time_gap"),
            each("spacing"),
            each("width"),
            each("taper"),
            each("anticipation"),
            each("oncoming"),
            each("sidestep"),
            each("step_back"),
            each("reaction_time"),
            each("sliding"),
            rows(walking),
        )
        out = np.array(chosen)
        launch(limit_speeds, limit_speeds_part, rows(out), crowd, near, scene.walls.segments(), float(dt))
        return out


@functools.cache
def with_headway(kind: type[CrowdModel]) -> type[CrowdModel]:
    """Return the class of a crowd model with the headway layer: the parameters of both, in one dataclass.

    Its name in trials and on the command line is that of the model with ``+headway``.

    Args:
        kind: class of the model.

    Raises:
        InputError: the class is a mixture, has the layer already, or is no complete crowd model.

    >>> from crowdbot.models import SocialForce
    >>> slower = with_headway(SocialForce)(headway_time_gap=1.2, relaxation_time=0.4)
    >>> slower.model == SocialForce(relaxation_time=0.4)
    True
    """
    name = f"{kind.__name__}{HeadwayLayer.suffix}"
    if inspect.isabstract(kind) or not issubclass(kind, CrowdModel) or issubclass(kind, HeadwayLayer | Mixture):
        raise InputError(
            f"{kind.__name__}{HeadwayLayer.suffix} is not a model: the layer is for a single crowd model without it"
        )
    if clash := {field.name for field in dataclasses.fields(kind)} & {*HeadwayLayer.__dataclass_fields__}:
        raise InputError(f"{name} is not a model: both have a parameter {min(clash)}")
    hints = typing.get_type_hints(kind)
    fields = [(field.name, hints[field.name], copy_field(field)) for field in dataclasses.fields(kind) if field.init]
    return make_class(name, fields, kind, _description(kind))


def make_class(
    name: str,
    fields: Sequence[tuple[str, Any, Any]],
    kind: type[CrowdModel],
    doc: str,
    valid_range: ModelRange | None = None,
) -> type[CrowdModel]:
    """Return a class with the headway layer on a model.

    Args:
        name: name of the class.
        fields: name, type and ``dataclasses.Field`` of every parameter of the model, and of the layer if it differs.
        kind: class of the model.
        doc: docstring.
        valid_range: density and time step that the class is made for, None if they are not known.
    """
    space = {"base": kind, "paper": getattr(kind, "paper", None), "__doc__": doc, "_unread_fields": unread_fields(kind)}
    space |= {"batched": kind.batched, "valid_range": valid_range}
    made = dataclasses.make_dataclass(name, fields, bases=(HeadwayLayer,), namespace=space, frozen=True, kw_only=True)
    made.__module__ = kind.__module__
    return made


def copy_field(field: dataclasses.Field[Any], **changes: Any) -> Any:
    """Return a field for another dataclass, with some changes such as ``default``."""
    values: dict[str, Any] = {"metadata": field.metadata, "repr": field.repr, "compare": field.compare}
    if field.default is not dataclasses.MISSING:
        values["default"] = field.default
    if field.default_factory is not dataclasses.MISSING:
        values["default_factory"] = field.default_factory
    return dataclasses.field(**values | changes)


def arguments_of(kind: type) -> str:
    """Return the list of parameters in the docstring of a model, with its indentation; empty if there is none."""
    match = re.search(r"^Args:\n((?:[ ]{4}.*\n|\n(?=[ ]{4}))+)", (inspect.getdoc(kind) or "") + "\n", re.MULTILINE)
    return match[1].rstrip("\n") if match else ""


def find_layered(name: str, find: Callable[[str], type]) -> type | None:
    """Return the class of a name such as ``orca+headway``, None for names without the layer.

    Args:
        name: name of a model.
        find: function that returns the class of a name without the layer.

    Raises:
        InputError: there is no such model, or it takes no layer.
    """
    plain = name.strip()
    if not plain.lower().endswith(HeadwayLayer.suffix):
        return None
    return with_headway(find(plain[: -len(HeadwayLayer.suffix)]))


def _description(kind: type) -> str:
    title = (inspect.getdoc(kind) or kind.__name__).split("\n\n")[0]
    return f"{title} The space ahead limits the speed.\n\nArgs:\n{arguments_of(HeadwayLayer)}\n{arguments_of(kind)}"


def _restore(base: type[CrowdModel], name: str, values: dict[str, Any]) -> CrowdModel:
    if name.endswith(HeadwayLayer.suffix):
        return with_headway(base)(**values)
    models = importlib.import_module("crowdbot.models")
    crowd_model: CrowdModel = getattr(models, name)(**values)
    return crowd_model
