"""Generate data: run a plan over processes, and describe what was made in a data card."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path

from crowdbot.core import explain_write_errors, run_saved_jobs
from crowdbot.trials import code_digest

from .card import DataCard, card_of, card_text
from .formats.coco import join_annotations
from .plan import GenerationPlan, ShardJob
from .shard import Shard, make_shard, read_shard, write_shard

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
        job.xml, job.folder, str(job.seeds), job.kind, str(job.compressed), str(job.images), str(job.kitti)
    )
