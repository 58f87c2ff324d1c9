"""Secret seeds: seeds that are held back, committed to by their hash before the challenge and published after it."""

from __future__ import annotations

import hashlib
import json
import secrets
from dataclasses import asdict, dataclass
from pathlib import Path

from crowdbot.core import InputError, explain_write_errors
from crowdbot.evaluation import parse_seeds


@dataclass(frozen=True)
class SecretSeeds:
    """Seeds with a random salt, so that their hash can be published without telling them.

    Fields:
        seeds: text of the seeds, such as ``1000:1020``.
        salt: random digits.

    >>> SecretSeeds("5:7", "00").hash[:8], SecretSeeds("5:7", "00").values
    ('a435c815', (5, 6))
    """

    seeds: str
    salt: str

    @property
    def hash(self) -> str:
        """SHA-256 of salt and seeds; the value of ``held-back`` in a challenge."""
        return hashlib.sha256(f"{self.salt}:{self.seeds}".encode()).hexdigest()

    @property
    def values(self) -> tuple[int, ...]:
        """The seeds."""
        return parse_seeds(self.seeds)


def commit_seeds(path: Path, count: int) -> SecretSeeds:
    """Draw random seeds and write them to a file to keep secret.

    Raises:
        InputError: the file exists, or ``count`` is not from 1 to 10000.
    """
    if not 1 <= count <= 10_000:
        raise InputError(f"count = {count} must be from 1 to 10000")
    drawn: set[int] = set()
    while len(drawn) < count:
        drawn.add(secrets.randbelow(1_000_000_000))
    made = SecretSeeds(", ".join(map(str, sorted(drawn))), secrets.token_hex(16))
    with explain_write_errors(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        try:
            with path.open("x", encoding="utf-8") as stream:
                json.dump(asdict(made), stream)
        except FileExistsError:
            raise InputError(f"{path} exists; seeds that were published cannot be drawn again") from None
    return made


def load_seeds(path: Path, expected: str) -> SecretSeeds:
    """Read secret seeds and compare them with the hash in the challenge.

    Raises:
        InputError: the file is damaged, or its seeds are not those of the challenge.
    """
    try:
        values = json.loads(path.read_text(encoding="utf-8"))
        found = SecretSeeds(str(values["seeds"]), str(values["salt"]))
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(f"{path} has no secret seeds ({type(error).__name__})") from None
    if found.hash != expected:
        raise InputError(
            f"{path}: these seeds have the hash {found.hash[:12]}..., the challenge has {expected[:12]}..."
        )
    return found
