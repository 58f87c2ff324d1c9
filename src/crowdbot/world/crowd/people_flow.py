"""People flow of a world: goals, routes, arrivals and departures of people."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Scene, Storage
from crowdbot.models import CrowdModel, Mixture
from crowdbot.models.mixture import MODEL
from crowdbot.typing import Floats

from .arrivals import Arrivals
from .journey import JourneyAssignment
from .person_random import uniform
from .routing import WAY, Router, fresh
from .source import PeopleSource

Numbers = NDArray[np.int64]


HeadingTurns = tuple[float, Numbers, Numbers, Floats, Floats]
"""Constant angles between the directions of people and those to their goals: the largest [rad], identities ``[E, A]``
and seeds ``[E]`` to which they belong, and their cosine and sine ``[E, A]``."""


@dataclass
class PeopleFlow:
    """Routes, journeys and arrivals of one world.

    Attributes:
        seeds: ``[E]`` seeds of the environments.
        ids: ``[E, A]`` identities.
        following: ``[E]`` identity of the next person to enter.
        router: guides people around walls.
        journeys: journeys of all people; those of sources come last.
        arrivals: people who enter through sources.
    """

    seeds: Numbers
    ids: Numbers
    following: Numbers
    router: Router | None
    journeys: JourneyAssignment | None
    arrivals: Arrivals | None
    mixture: Mixture | None
    _turns: HeadingTurns | None = field(default=None, init=False, repr=False)
    storage = Storage(constants=("router", "journeys", "mixture"), shared=("_turns",))

    @classmethod
    def of(
        cls,
        scene: Scene,
        model: CrowdModel,
        seeds: Sequence[int],
        ids: Any,
        router: Router | None,
        journeys: JourneyAssignment | None,
        sources: Sequence[PeopleSource],
    ) -> PeopleFlow:
        """Create the people flow of a world with this initial scene.

        Raises:
            InputError: identities are not unique, or goals do not match preferred velocities or the model.
        """
        if scene.preferred_velocity is not None and (router or journeys or sources):
            raise InputError(
                "the scene has preferred velocities instead of goals; routers, journeys and sources need goals"
            )
        keys = np.array([int(seed) % 2**63 for seed in seeds], dtype=np.int64)
        who = _identities(ids, scene.shape)
        following = who.max(axis=1, initial=-1) + 1
        mixture = model if isinstance(model, Mixture) and sources else None
        for source in sources:
            if not 0 <= source.model < (1 if mixture is None else len(mixture.models)):
                raise InputError(
                    f"PeopleSource: model = {source.model}, but the crowd has no mixture with a model of this index"
                )
        if sources:
            first = journeys or JourneyAssignment((), -1)
            start = {WAY: fresh((1, 1))[0, 0], **model.memory_at_start}
            arrivals = Arrivals(tuple(sources), keys.tolist(), len(first.journeys), start)
            journeys = JourneyAssignment((*first.journeys, *(source.journey for source in sources)), first.which)
            return cls(keys, who, following, router, journeys, arrivals, mixture)
        return cls(keys, who, following, router, journeys, None, mixture)

    def reconfigure(self, router: Router | None, sources: Sequence[PeopleSource], seed: int | None) -> None:
        """Change the router and the sources. A seed restarts the random numbers."""
        self.router = router
        if seed is not None:
            self.seeds = np.array([item % 2**63 for item in environment_seeds(seed, len(self.seeds))], dtype=np.int64)
        if self.arrivals is not None:
            self.arrivals.reconfigure(sources, None if seed is None else self.seeds.tolist())
        elif sources:
            raise InputError("sources cannot be added to a running world")

    @property
    def waiting_count(self) -> Numbers:
        """Number of people waiting to enter, ``[E]``."""
        return np.zeros(len(self.seeds), dtype=np.int64) if self.arrivals is None else self.arrivals.waiting_count

    def start(self, scene: Scene) -> Scene:
        """Return the initial scene with the first goal and path of each person."""
        if self.mixture is not None:
            scene = scene.replace(memory={**scene.memory, MODEL: self.mixture.of(scene).astype(np.float64)})
        if self.journeys is not None:
            scene = self.journeys.start(scene, self.seeds, self.ids, self._holds)
        if self.router is not None:
            scene = scene.replace(memory=self.router.guide(scene, self._routed(scene)).memory)
        return scene

    def guide(self, scene: Scene) -> Scene:
        """Return the scene with the next point of each path as the goal."""
        return scene if self.router is None else self.router.guide(scene, self._routed(scene))

    def advance(self, scene: Scene, time: float | Floats) -> Scene:
        """Return the scene at a time [s], one or ``[E]``, after journeys have advanced and new people have entered."""
        if self.journeys is not None:
            scene = self.journeys.advance(scene, self.seeds, self.ids, self._holds, time)
        if self.arrivals is None or self.journeys is None:
            return scene
        scene, new = self.arrivals.let_in(scene, time, self.ids, self.following)
        if not np.any(new):
            return scene
        return self._launch(self.journeys.aim(scene, new, self.seeds, self.ids, self._holds), new)

    def _launch(self, scene: Scene, new: NDArray[np.bool_]) -> Scene:
        """Return the scene in which the new people walk at their preferred speed."""
        aim = scene.goal
        if self.router is not None:
            aim = self.router.follow(scene.position, aim, None, new & self._routed(scene)).subgoal
        away = aim - scene.position
        distance = np.maximum(np.sqrt(away[..., 0] ** 2 + away[..., 1] ** 2), 1e-12)
        moving = away * (scene.preferred_speed / distance)[..., None]
        return scene.replace(
            velocity=np.where(new[..., None], moving, scene.velocity),
            heading=np.where(new, np.arctan2(away[..., 1], away[..., 0]), scene.heading),
        )

    def _holds(self, points: Floats) -> NDArray[np.bool_]:
        return np.ones(len(points), dtype=np.bool_) if self.router is None else self.router.holds(points)

    def _routed(self, scene: Scene) -> NDArray[np.bool_]:
        if self.journeys is None:
            return np.greater(scene.active, scene.external)
        return self.journeys.walks_on_routes(scene)

    def turns(self, heading_jitter: float, anew: bool = False) -> HeadingTurns:
        """Return the constant angles by which people deviate from their goals, those known unless ``anew``."""
        known, none = self._turns, np.full(self.ids.shape, np.nan)
        if heading_jitter == 0.0:
            return heading_jitter, self.ids, self.seeds, none, none
        if known is None or known[0] != heading_jitter or known[1].shape != self.ids.shape:
            known, anew = (heading_jitter, self.ids - 1, self.seeds, none, none), True
        _, ids, seeds, cos, sin = known
        if anew:
            new = (ids != self.ids) | (seeds != self.seeds)[:, None]
            seed = np.broadcast_to(self.seeds[:, None], ids.shape)[new]
            angle = heading_jitter * (2.0 * uniform(seed, self.ids[new], "symmetry") - 1.0)
            cos, sin = cos.copy(), sin.copy()
            cos[new], sin[new] = np.cos(angle), np.sin(angle)
            known = (heading_jitter, self.ids.copy(), self.seeds.copy(), cos, sin)
        self._turns = known
        return known


def environment_seeds(seed: int | Sequence[int], count: int) -> list[int]:
    """Return the seed of each environment: those given, or ``seed + e`` for environment e.

    Raises:
        InputError: there is not one seed for each environment.
    """
    if isinstance(seed, int | np.integer):
        return [int(seed) + e for e in range(count)]
    seeds = [int(item) for item in seed]
    if len(seeds) != count:
        raise InputError(f"{len(seeds)} seeds are given for {count} environments; give one for each, or one number")
    return seeds


def _identities(ids: Any, shape: tuple[int, int]) -> Numbers:
    try:
        who = np.broadcast_to(np.arange(shape[1]) if ids is None else np.asarray(ids), shape)
    except ValueError:
        raise InputError(f"ids have shape {list(np.shape(ids))}, expected [E, A] = {list(shape)}") from None
    different = np.sort(who, axis=1)
    if who.dtype.kind not in "iu" or np.any(different[:, 1:] == different[:, :-1]):
        raise InputError("ids must be integers, unique in each environment")
    return who.astype(np.int64)
