"""Data card of generated data, and the generation itself."""

from __future__ import annotations

import dataclasses
import json
import platform
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from crowdbot.core import explain_write_errors, run_saved_jobs, source_digest
from crowdbot.trials import Trial, code_digest

from .image_formats import join_annotations
from .plan import GenerationPlan, ShardJob, reading_rate
from .shard import Shard, make_shard, read_shard, write_shard

SCHEMA = "crowdbot-data-card-1"
LIMITS = (
    "The data is simulated. People follow the crowd model of each trial; how well it agrees with experiments is in the"
    " documentation (validation).",
    "All beams of a scan and all pixels of an image are measured at the same instant.",
    "Without noise, readings are exact; noise of presets is independent from reading to reading.",
    "`occluded` is the share of the width of a person that others and walls hide in a plan view: discs and walls"
    " without height. It is NaN for readings between recorded instants.",
)


@dataclass(frozen=True)
class DataCard:
    """What generated data holds.

    Fields:
        title: one line.
        trials: facts about each trial by name: duration, time step, people, crowd model, sensors.
        seeds: seeds of the runs.
        form: format of the shards.
        outcomes: number of runs by outcome.
        seconds: simulated time of all runs [s].
        rows: number of rows of each table.
        arrays: type and shape of one sample of each array.
        files: size [bytes] and SHA-256 of each file.
        limits: what the data does not show.
        provenance: version of the program, of its source and of the machine.
    """

    title: str
    trials: Mapping[str, Mapping[str, Any]]
    seeds: tuple[int, ...]
    form: str
    outcomes: Mapping[str, int]
    seconds: float
    rows: Mapping[str, int]
    arrays: Mapping[str, str]
    files: Mapping[str, tuple[int, str]]
    limits: tuple[str, ...]
    provenance: Mapping[str, str]

    @property
    def size(self) -> int:
        """Size of all files [bytes]."""
        return sum(size for size, _ in self.files.values())

    def values(self) -> dict[str, Any]:
        """Return the card as JSON values."""
        return {"schema": SCHEMA} | dataclasses.asdict(self)


def card_of(plan: GenerationPlan, shards: Sequence[Shard]) -> DataCard:
    """Return the card of finished shards."""
    rows: Counter[str] = Counter()
    arrays: dict[str, str] = {}
    files: dict[str, tuple[int, str]] = {}
    for shard in shards:
        rows.update(shard.rows)
        arrays |= {name: text for name, text in shard.arrays.items() if name not in arrays}
        files |= shard.files
    facts = {name: _facts(variant) for name, variant in zip(plan.names, plan.variants, strict=True)}
    return DataCard(
        f"Simulated runs of {', '.join(facts)} with {len(plan.seeds)} seeds each",
        facts,
        tuple(int(seed) for seed in plan.seeds),
        plan.kind,
        dict(Counter(end for shard in shards for end in shard.outcomes)),
        float(np.sum([shard.seconds for shard in shards])),
        dict(sorted(rows.items())),
        arrays,
        files,
        LIMITS,
        {"source": source_digest(), "python": platform.python_version(), "processor": platform.machine()},
    )


def _facts(trial: Trial) -> dict[str, Any]:
    sensors = {
        f"{robot.name}/{mount.name}": {
            "type": type(mount.sensor).__name__,
            "rate": reading_rate(mount.sensor, trial),
            "settings": {
                field.name: _plain(getattr(mount.sensor, field.name)) for field in dataclasses.fields(mount.sensor)
            },
            "mount": {name: getattr(mount, name) for name in ("link", "x", "y", "z", "roll", "pitch", "heading")},
        }
        for robot in trial.robots
        for mount in robot.sensors
    }
    return {
        "world": trial.world,
        "duration": trial.duration,
        "step": trial.step,
        "recording_period": trial.recording.period,
        "people": trial.people,
        "crowd": type(trial.crowd).__name__,
        "robots": {robot.name: {"type": robot.type, "radius": robot.radius} for robot in trial.robots},
        "sensors": sensors,
    }


def _plain(value: Any) -> Any:
    if isinstance(value, tuple | list):
        return [_plain(item) for item in value]
    return value if isinstance(value, int | float | str | bool) else repr(value)


def card_text(card: DataCard) -> str:
    """Return the card as Markdown."""
    lines = [f"# {card.title}", "", "Made by `crowdbot generate`; `card.json` has the same facts for programs.", ""]
    lines += [
        f"* {sum(card.outcomes.values())} runs, {card.seconds / 60.0:.1f} simulated minutes;"
        f" outcomes: {', '.join(f'{count} {name}' for name, count in sorted(card.outcomes.items()))}",
        f"* {len(card.files)} files, {card.size / 1e6:.1f} MB, format {card.form}",
        f"* crowdbot source {card.provenance['source']}, Python {card.provenance['python']}",
        "",
        "| trial | world | duration [s] | step [s] | people | crowd | sensors |",
        "| --- | --- | --- | --- | --- | --- | --- |",
    ]
    for name, facts in card.trials.items():
        sensors = ", ".join(f"{key} ({item['type']}, {item['rate']:g} Hz)" for key, item in facts["sensors"].items())
        numbers = f"{facts['duration']:g} | {facts['step']:g} | {facts['people']}"
        lines.append(f"| {name} | {facts['world']} | {numbers} | {facts['crowd']} | {sensors} |")
    lines += ["", "| table | rows |", "| --- | --- |"]
    lines += [f"| {name} | {count} |" for name, count in card.rows.items()]
    if card.arrays:
        lines += ["", "| array | type and shape of a sample |", "| --- | --- |"]
        lines += [f"| {name} | {text} |" for name, text in sorted(card.arrays.items())]
        lines += ["", *_CODES]
    lines += ["", "## What the data does not show", "", *(f"* {text}" for text in card.limits), ""]
    return "\n".join(lines)


_CODES = (
    "Lengths are in metres, angles in radians, times in nanoseconds of simulated time. `hit` is the id of a person or"
    " robot; -1 nothing, -2 a wall, -3 the floor, -4 a prop. `ranges` and `depth` are infinite without a return."
    " `returns` counts beams or pixels of each agent in `ids`; an agent is visible if it has one. `boxes` are left,"
    " top, width and height in pixels.",
)


PARTS = "parts"
"""Folder of the descriptions of finished shards."""


def generate(
    plan: GenerationPlan,
    folder: Path | str,
    *,
    workers: int = 1,
    cluster: str | None = None,
    progress: Callable[[float], None] | None = None,
) -> DataCard:
    """Generate all data of a plan and return its card, which is also written as ``card.json`` and ``README.md``.

    The files depend on the plan only, not on workers or interruptions. The same call continues after an interruption.

    Args:
        plan: what to generate.
        folder: folder of the data.
        workers: number of processes.
        cluster: address of a Ray cluster with a shared file system; see :func:`crowdbot.core.each`.
        progress: called with the completed share, 0 to 1.

    Raises:
        InputError: ``workers`` is below 1, the folder holds data of another plan, or a part is damaged.
        MissingExtra: a sensor or the cluster needs a package that is not installed.

    >>> import tempfile
    >>> from crowdbot.generation import GenerationPlan, generate
    >>> from crowdbot.trials import load_trial
    >>> plan = GenerationPlan([load_trial("frontal", duration=1.0)], range(2), sensors=["sick-tim571"])
    >>> with tempfile.TemporaryDirectory() as place:
    ...     card = generate(plan, place)
    >>> card.rows["robot/sick_tim571"]
    30
    """
    out = Path(folder)
    jobs = plan.jobs(out)
    files = [out / PARTS / f"{job.name}-{_key(job)}.json" for job in jobs]
    shards: dict[int, Shard] = {}
    for number, shard in run_saved_jobs(make_shard, jobs, files, write_shard, read_shard, workers, cluster):
        shards[number] = shard
        if progress is not None:
            progress(len(shards) / len(jobs))
    made = [shards[number] for number in range(len(jobs))]
    card = card_of(plan, made)
    with explain_write_errors(out):
        (out / "card.json").write_text(json.dumps(card.values(), indent=1) + "\n", encoding="utf-8")
        (out / "README.md").write_text(card_text(card), encoding="utf-8")
        if plan.coco:
            parts = [out / name for shard in made for name in shard.files if name.endswith("/annotations.json")]
            joined = join_annotations(parts, {"description": card.title})
            (out / "coco.json").write_text(json.dumps(joined), encoding="utf-8")
    return card


def _key(job: ShardJob) -> str:
    """Return a name for a job, which changes with everything that its files depend on."""
    return code_digest(
        job.xml, job.folder, job.files, str(job.seeds), job.kind, str(job.compressed), str(job.images), str(job.kitti)
    )
