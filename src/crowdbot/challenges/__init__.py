"""Challenges: fixed trials and seeds, submissions that nobody has to trust, verified results, and a board."""

from .board import write_board
from .challenge import Challenge, builtin_challenges, load_challenge
from .entry import ChallengeEntry, entry_differences, load_entry
from .runner import enter
from .secret_seeds import SecretSeeds, commit_seeds, load_seeds
from .submission import Submission, load_submission, pack_submission, unpack_submission

__all__ = [
    "Challenge",
    "ChallengeEntry",
    "SecretSeeds",
    "Submission",
    "builtin_challenges",
    "commit_seeds",
    "enter",
    "entry_differences",
    "load_challenge",
    "load_entry",
    "load_seeds",
    "load_submission",
    "pack_submission",
    "unpack_submission",
    "write_board",
]
