"""Challenges: fixed trials and seeds, submissions that nobody has to trust, verified results, and a board."""

from .challenge import Challenge, SecretSeeds, builtin_challenges, commit_seeds, load_challenge, load_seeds
from .entry import ChallengeEntry, entry_differences, load_entry
from .runner import enter, write_board
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
