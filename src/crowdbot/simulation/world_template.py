"""WorldTemplate: everything of the worlds of a trial that does not depend on the seed, made once."""

from __future__ import annotations

import functools
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from crowdbot.core import InputError, Scene, TrialError
from crowdbot.models import CrowdModel
from crowdbot.trials import (
    UNEVEN,
    Agent,
    Crowds,
    InitialPeople,
    PeopleAppearance,
    PeopleBatch,
    PlacementPlan,
    RandomizedModel,
    RobotSpec,
    Trial,
    crowd_names,
    element_word,
    expand_sweeps,
    people_appearance,
    place,
    robot_reactions,
)
from crowdbot.typing import Ints
from crowdbot.world import PeopleSource, PlanarWorld, Router, World, arrival_counts, join_worlds

from .mounted_sensor import needs_bodies
from .robot_control import RobotControl
from .world_builder import (
    avatars_of,
    doors_of,
    journeys_of,
    model_of,
    own_walls,
    people_at_rest,
    script_of,
    set_off,
    start_scenes,
)


class WorldTemplate:
    """Makes the initial worlds of a trial for any seeds.

    Walls, paths, zones, drives and models of the trial are made once. Worlds of the plane without bodies are made as
    arrays with all environments; each environment is bit-identical to the world of its seed alone.

    Args:
        trial: the trial. A trial never changes, so a template is never stale.
        posed: add bodies of people even if no sensor needs them.

    >>> from crowdbot.trials import load_trial
    >>> world, people = WorldTemplate(load_trial("frontal")).begin([3, 4])
    >>> world.scene.shape, len(people)
    ((2, 2), 1)
    """

    def __init__(self, trial: Trial, posed: bool = False) -> None:
        self.trial, self.posed = trial, posed
        self._begun = 0

    def of_trial(self, trial: Trial) -> WorldTemplate:
        """Return this template if it is of this trial, otherwise a new one."""
        return self if trial is self.trial else WorldTemplate(trial, self.posed)

    def trial_of(self, environment: int) -> Trial:
        """Return the trial of an environment."""
        return self.trial

    def set_goals(self, robots: Sequence[RobotControl]) -> None:
        """Set the goals of robots at the start where they differ between environments."""

    def of_environments(self, environments: Sequence[int] | Ints) -> WorldTemplate:
        """Return the template of some environments."""
        return self

    def with_environments(self, environments: Sequence[int] | Ints, other: WorldTemplate) -> WorldTemplate:
        """Return the template in which some environments are those of another one."""
        return self

    def begin(self, seeds: Sequence[int]) -> tuple[World, InitialPeople]:
        """Return the world of some seeds at its start, and the people of the first seed.

        Raises:
            TrialError: people cannot be placed with a seed, or the trial has sweeps.
        """
        people = self._place(seeds)
        self._begun += len(seeds)
        if len(seeds) > 1 and not self._is_alone:
            try:
                return self.build(people, seeds), people.first
            except InputError:  # the sentence says which agent of a world is wrong, so the worlds are made alone
                pass
        worlds = [self._embody(people.environment(k), seed) for k, seed in enumerate(seeds)]
        return join_worlds(worlds), people.first

    def build(self, people: PeopleBatch, seeds: Sequence[int]) -> PlanarWorld:
        """Return the world of the plane, without bodies, in which given people start."""
        self._check()
        first = len(people.first)
        spare = self._spare(seeds, first)
        scene = start_scenes(self.trial, people, spare, self._walls)
        agents, robots = scene.shape[1], self._robots(first)
        drives = {agent: robot.drive for agent, robot in robots.items()}
        latency = {agent: robot.latency for agent, robot in robots.items()}
        ghosts = [agent for agent, robot in robots.items() if robot.ghost]
        outlines = {agent: shape for agent, robot in robots.items() if (shape := robot.body.outline) is not None}
        how = self._parameters(people.first, agents)
        slots = first + len(robots) + spare
        models = self._models(people, slots, seeds)
        seed = list(seeds) if len(seeds) > 1 else seeds[0]
        bodies = {"drives": drives, "latency": latency, "ghosts": ghosts, "outlines": outlines}
        world = PlanarWorld.of_environments(scene, models, slots, seed=seed, **bodies, **how)
        self._set_off(world, people)
        return world

    def build_alone(self, people: InitialPeople, seed: int) -> tuple[PlanarWorld, PeopleAppearance | None]:
        """Return the world in which given people start, in the plane or with bodies, and their appearance if needed.

        Ids are assigned to people first, then to robots, then to people who enter; initial ids equal indices. Free
        slots have negative ids.
        """
        trial, batch, first = self.trial, PeopleBatch.of([people]), len(people)
        if trial.world != "physics":
            planar = self.build(batch, [seed])
            return planar, people_appearance(trial, people, planar.scene.shape[1], seed) if self._embodied else None
        self._check()
        scene = start_scenes(trial, batch, self._spare([seed], first), self._walls)
        agents = scene.shape[1]
        figures = people_appearance(trial, people, agents, seed)
        how = self._parameters(people, agents) | {"seed": seed}
        model = model_of(trial, people, agents, seed)
        world: Any = self._with_bodies(scene, model, self._robots(first), figures, how)
        self._set_off(world, batch)
        return world, figures

    @functools.cached_property
    def _is_alone(self) -> bool:
        """Whether worlds are made one by one: with bodies or avatars, or if people enter a mixture of crowds."""
        mixed = isinstance(self.trial.crowd, Crowds) and bool(self.trial.sources)
        led = bool(self.trial.avatars) or any(robot.mirror is not None for robot in self.trial.robots)
        return self.posed or self._embodied or mixed or led or bool(self.trial.stage.doors)

    @functools.cached_property
    def _embodied(self) -> bool:
        """Whether anything needs the bodies of people."""
        return needs_bodies(self.trial)

    @functools.cached_property
    def _walls(self) -> Any:
        return self.trial.stage.as_walls()

    @functools.cached_property
    def _router(self) -> Router | None:
        return None if self.trial.routing is None else self.trial.routing.router(self.trial.stage.walking_walls())

    @functools.cached_property
    def _sources(self) -> list[PeopleSource]:
        return [source.source(self.trial.journeys, crowd_names(self.trial.crowd)) for source in self.trial.sources]

    @functools.cached_property
    def _recorded(self) -> list[tuple[Any, Any]]:
        return [(item, item.walks(self.trial.duration)) for item in self.trial.recorded]

    @functools.cached_property
    def _plan(self) -> PlacementPlan:
        trial = self.trial
        return PlacementPlan.of(trial.stage, trial.spawners, trial.robots, trial.agents, self._recorded)

    @functools.cached_property
    def _own_models(self) -> bool:
        """Whether the model depends on the seed."""
        trial = self.trial
        drawn = isinstance(trial.crowd, Crowds | RandomizedModel) or trial.crowd.is_individual
        return drawn or any(isinstance(agent, Agent) and agent.parameters for agent in trial.agents)

    @functools.cached_property
    def _shared(self) -> dict[str, Any]:
        """Parameters of a world that depend on the trial only."""
        trial = self.trial
        return {
            "dt": trial.step,
            "robot_margin": trial.robot_margin,
            "router": self._router,
            "contact": trial.contact,
            "limits": None if trial.limits is None else trial.limits.limits(),
            "sources": self._sources,
            "exits": trial.exits,
            "portals": trial.portals,
            "heading_jitter": trial.heading_jitter,
            "substeps": trial.substeps,
        }

    def _check(self) -> None:
        if self.trial.sweeps:
            count = len(expand_sweeps(self.trial))
            raise TrialError(f"trial {self.trial.name!r} has {count} variants in its sweeps; run one of them")
        if self.trial.world != "physics" and self.trial.stage.ground:
            raise TrialError(f"trial {self.trial.name!r}: the stage {UNEVEN}")

    def _place(self, seeds: Sequence[int]) -> PeopleBatch:
        """Return the people of some seeds; a single seed is placed faster than the kernel is loaded."""
        trial = self.trial
        if self._begun + len(seeds) > 1 and not trial.avatars:
            people_batch = self._plan.place(seeds)
            if isinstance(people_batch, PeopleBatch):
                return people_batch
            problems = people_batch[1]
        else:
            who = (trial.agents, self._recorded, trial.avatars)
            rows = [place(trial.stage, trial.spawners, trial.robots, seed, *who) for seed in seeds]
            problems = next((wrong for _, wrong in rows if wrong), [])
            if not problems:
                return PeopleBatch.of([people for people, _ in rows])
        what = ((element_word(type(item)), item.name, sentence) for item, sentence in problems)
        raise TrialError(*(f"trial {trial.name!r}: {word} {name!r}: {sentence}" for word, name, sentence in what))

    def _spare(self, seeds: Sequence[int], first: int) -> Ints:
        """Return ``[E]`` the number of free slots: the maximum number of people who enter, up to the capacity."""
        trial, end = self.trial, self.trial.ticks * self.trial.step
        if not self._sources:
            return np.zeros(len(seeds), dtype=np.int64)
        come: Ints = arrival_counts(self._sources, seeds, end).sum(axis=1)
        return come if trial.capacity is None else np.minimum(come, max(0, trial.capacity - first))

    def _robots(self, first: int) -> dict[int, RobotSpec]:
        return {first + k: robot for k, robot in enumerate(self.trial.robots)}

    def _parameters(self, people: InitialPeople, agents: int) -> dict[str, Any]:
        """Return the parameters of a world except those of robots, model and seed."""
        there = len(people) + len(self.trial.robots)
        return {
            **self._shared,
            "journeys": journeys_of(self.trial, people, agents),
            "script": script_of(people),
            "reactions": robot_reactions(people.owners, people.owner.tolist(), self.trial.sources, agents),
            "avatars": avatars_of(self.trial, len(people) - len(people.walks), len(people)),
            "doors": doors_of(self.trial),
            "ids": np.concatenate([np.arange(there), -1 - np.arange(agents - there)]),
        }

    def _models(self, people: PeopleBatch, agents: Ints, seeds: Sequence[int]) -> list[CrowdModel]:
        """Return the crowd model of each environment."""
        trial = self.trial
        if not self._own_models:
            model: CrowdModel = trial.crowd
            return [model] * len(seeds)
        rows = zip(agents.tolist(), seeds, strict=True)
        return [model_of(trial, people.first, count, seed) for count, seed in rows]

    def _set_off(self, world: PlanarWorld, people: PeopleBatch) -> None:
        first, journeys = people.first, world.journeys
        walkers = len(first) - len(first.walks) - len(self.trial.avatars)
        if walkers and (self._router or journeys):
            scene, resting = world.scene, np.flatnonzero(people_at_rest(first))
            world.scene = set_off(scene, walkers, self._router, journeys, people.heading)
            world.scene.velocity[:, resting] = 0.0

    def _with_bodies(
        self, scene: Scene, model: CrowdModel, robots: Mapping[int, RobotSpec], figures: Any, how: dict[str, Any]
    ) -> PlanarWorld:
        from crowdbot.world import PhysicsWorld

        stage = self.trial.stage
        return PhysicsWorld(
            scene.replace(walls=stage.as_walls(props=False), wall_height=stage.wall_height),
            model,
            {agent: robot.body for agent, robot in robots.items()},
            stage=stage.physical(),
            people=figures.people,
            riders=figures.riders,
            physics_dt=self.trial.physics_step,
            balance=self.trial.balance,
            get_up=self.trial.get_up,
            ghosts=[agent for agent, robot in robots.items() if robot.ghost],
            **how,
        )

    def _embody(self, people: InitialPeople, seed: int) -> PlanarWorld:
        """Return the world of one seed, with bodies of people where they are needed."""
        world, figures = self.build_alone(people, seed)
        trial, first = self.trial, self.trial.people
        if self.posed and figures is None:
            figures = people_appearance(trial, people, world.scene.shape[1], seed)
        if figures is not None:
            world.embody(
                {first + k: robot.body for k, robot in enumerate(trial.robots)},
                trial.stage.physical(),
                figures.people,
                riders=figures.riders,
                activity=figures.activity,
                walls=own_walls(trial),
                seed=seed,
            )
        if world.avatars is not None:
            world.avatars.pose(world)
        return world
