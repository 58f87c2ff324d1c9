"""EpisodeRerun: what a recorded episode needs to run again, for films of it."""

from __future__ import annotations

import contextlib
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import NamedTuple

from crowdbot.core import EpisodeError
from crowdbot.simulation import OrderSource, Simulation
from crowdbot.trials import Trial

from .attachments import unpack_attachments
from .episode_reader import read_metadata
from .provenance import OrderReplay, Provenance, replay_decisions


class EpisodeRerun(NamedTuple):
    """The trial of an episode with its seed and its orders.

    Fields:
        trial, seed: the trial and its seed.
        sources: the recorded orders.
        prepare: to be called with a new simulation; decisions miss their deadline or hang as recorded.
    """

    trial: Trial
    seed: int
    sources: tuple[OrderSource, ...]
    prepare: Callable[[Simulation], None]


@contextlib.contextmanager
def open_rerun(path: Path | str, *, folder: Path | None = None, trust: bool = False) -> Iterator[EpisodeRerun]:
    """Return a context in which an episode can run again, with the files that it holds.

    Args:
        path: the episode, which is not a branch.
        folder, trust: see :func:`crowdbot.recording.replay`.

    Raises:
        EpisodeError: the file cannot be read, is a branch, or a file of its trial is missing or not trusted.

    >>> from crowdbot.models import ORCA
    >>> from crowdbot.recording import record
    >>> from tempfile import TemporaryDirectory
    >>> with TemporaryDirectory() as out:
    ...     summary = record(Trial(name="empty", duration=1.0, crowd=ORCA()), out=out)
    ...     with open_rerun(f"{out}/episode.mcap") as rerun:
    ...         rerun.trial.name, rerun.seed
    ('empty', 0)
    """
    path = Path(path)
    with unpack_attachments(path, read_metadata(path), folder, trust) as place:
        provenance = Provenance.of(path, place.folder, trust)
        if len(provenance.parts) > 1:
            raise EpisodeError(f"{path} is a branch; render the episode from which it was made")
        (part,) = provenance.parts
        yield EpisodeRerun(
            part.trial, part.seed, (OrderReplay(part.orders),), lambda one: replay_decisions(one, part.orders)
        )
