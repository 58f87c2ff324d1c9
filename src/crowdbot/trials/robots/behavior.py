"""Behaviour trees of people in a trial."""

from __future__ import annotations

import dataclasses
import functools
from dataclasses import dataclass
from pathlib import Path

from crowdbot.core.fields import attribute, check
from crowdbot.trials.files.trial_files import read_beside, resolve_file
from crowdbot.world import BehaviorTree, parse_behavior_tree

MOST_BYTES = 1_000_000
"""Largest size of a file with behaviour trees [bytes]."""


@dataclass(frozen=True, kw_only=True)
class BehaviorSpec:
    """A behaviour tree of a share of people, which chooses what they do at each step.

    Each person draws one of the behaviours and reactions of their element by the shares. The file is XML of
    BehaviorTree.CPP, as HuNavSim has it. Files that it includes lie in the folder of the trial, too.

    Raises:
        InputError: a value is not allowed.

    >>> BehaviorSpec(file="visitor.xml", share=0.5).regular
    'regular'
    """

    file: str = attribute(
        about="behaviour tree in the folder of the trial: XML of BehaviorTree.CPP", pattern=r"[^\x00]{1,500}"
    )
    tree: str = attribute("", about="name of the tree (default: main_tree_to_execute of the file)")
    share: float = attribute(1.0, about="share of the people with this behaviour", min=0.0, max=1.0)
    regular: str = attribute(
        "regular",
        about="how robots are seen while people walk to their goal, as by the reaction of this name",
        choices=("regular", "ignore", "impassive"),
    )
    folder: Path | None = dataclasses.field(default=None, compare=False, repr=False)
    trust: bool = dataclasses.field(default=True, compare=False, repr=False)
    """Folder of the file, and whether it may lie outside; not part of the XML."""

    def __post_init__(self) -> None:
        check(self)

    def behavior(self) -> BehaviorTree:
        """Return the tree; the files are read once.

        Raises:
            InputError: a file is missing, lies outside the folder, or is no behaviour tree.
        """
        return self._read[0]

    def files(self) -> tuple[Path, ...]:
        """Return the files of the tree; errors as for :meth:`behavior`."""
        return self._read[1]

    @functools.cached_property
    def _read(self) -> tuple[BehaviorTree, tuple[Path, ...]]:
        paths: list[Path] = []

        def load(name: str) -> bytes:
            paths.append(resolve_file(name, self.folder, self.trust))
            return read_beside(paths[-1], MOST_BYTES)

        made = parse_behavior_tree(load(self.file), self.file, load, tree=self.tree, regular=self.regular)
        return made, tuple(paths)
