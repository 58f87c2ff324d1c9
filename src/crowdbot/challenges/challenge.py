"""Challenges: trials, seeds and scores of a competition, and their secret seeds."""

from __future__ import annotations

import hashlib
import importlib.resources
import json
import secrets
import tomllib
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from crowdbot.core import InputError, UnknownName, did_you_mean, explain_write_errors
from crowdbot.evaluation import parse_seeds, parse_statistic
from crowdbot.trials import Trial, expand_sweeps, load_trial, trial_xml

MOST_BYTES = 1_000_000
KEYS = ("title", "about", "source", "trials", "public-seeds", "held-back", "statistics", "rank", "limits")
NEEDED = ("title", "trials", "public-seeds", "statistics", "rank")
LIMITS = {"answer": 5.0, "memory": 4000.0, "cpu": 36000.0}
"""Limits of a submission: longest answer [s], memory [MB] and CPU time of its process [s]."""
ORDERS = ("high", "low")


@dataclass(frozen=True)
class Challenge:
    """What all submissions have in common.

    Fields:
        name: name of the file without ending.
        title, about, source: for people.
        trials: the trials.
        public_seeds: seeds that everybody can run.
        held_back: SHA-256 of the seeds that are held back, see :class:`SecretSeeds`; empty if there are none.
        statistics: columns of the board.
        rank: statistics that order the board, the first one first, each with ``high`` or ``low`` for what is better.
        limits: limits of a submission, see :data:`LIMITS`.

    >>> challenge = load_challenge("crowd-against-the-machine")
    >>> len(challenge.trials), challenge.public_seeds
    (21, (0, 1, 2, 3, 4))
    """

    name: str
    title: str
    about: str
    source: str
    trials: tuple[Trial, ...]
    public_seeds: tuple[int, ...]
    held_back: str
    statistics: tuple[str, ...]
    rank: tuple[tuple[str, str], ...]
    limits: Mapping[str, float]

    @property
    def hash(self) -> str:
        """SHA-256 of everything that a result depends on: trials, seeds, statistics and limits."""
        content = {
            "trials": [trial_xml(trial) for trial in self.trials],
            "public-seeds": list(self.public_seeds),
            "held-back": self.held_back,
            "statistics": list(self.statistics),
            "rank": [list(item) for item in self.rank],
            "limits": dict(self.limits),
        }
        return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def builtin_challenges() -> dict[str, Path]:
    """Return the files of the built-in challenges by name."""
    folder = Path(str(importlib.resources.files("crowdbot"))) / "assets" / "challenges"
    return {file.stem: file for file in sorted(folder.glob("*.toml"))}


def load_challenge(source: str | Path) -> Challenge:
    """Read a challenge from a file, or a built-in one by its name.

    Trials are built-in names, or files beside the challenge.

    Raises:
        UnknownName: there is neither a file nor a built-in challenge of this name.
        InputError: the file is damaged, or a value is not allowed.
        TrialError: a trial is impossible.
    """
    file = Path(source)
    if not file.is_file():
        known = builtin_challenges()
        if str(source) not in known:
            raise UnknownName("challenge", str(source), known)
        file = known[str(source)]
    if file.stat().st_size > MOST_BYTES:
        raise InputError(f"{file} has more than {MOST_BYTES} bytes; this is no challenge")
    try:
        values = tomllib.loads(file.read_text(encoding="utf-8"))
    except (UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        raise InputError(f"{file} is not a challenge: {error}") from None
    try:
        return _challenge(file, values)
    except InputError as error:
        raise type(error)(f"{file}: {error}") from None


def _challenge(file: Path, values: Mapping[str, Any]) -> Challenge:
    for name in values:
        if name not in KEYS:
            raise InputError(f"{name!r} is unknown{did_you_mean(name, KEYS)}; known are {', '.join(KEYS)}")
    for name in NEEDED:
        if name not in values:
            raise InputError(f"{name!r} is missing; a challenge needs {', '.join(NEEDED)}")
    statistics = _texts("statistics", values["statistics"])
    for name in statistics:
        parse_statistic(name)
    return Challenge(
        file.stem,
        _text("title", values["title"]),
        _text("about", values.get("about", "")),
        _text("source", values.get("source", "")),
        _trials(file, _texts("trials", values["trials"])),
        parse_seeds(_text("public-seeds", values["public-seeds"])),
        _held_back(values.get("held-back", "")),
        statistics,
        tuple(_rank(text, statistics) for text in _texts("rank", values["rank"])),
        _limits(values.get("limits", {})),
    )


def _text(name: str, value: Any) -> str:
    if not isinstance(value, str):
        raise InputError(f"{name} = {value!r} must be a text")
    return value


def _texts(name: str, value: Any) -> tuple[str, ...]:
    if not isinstance(value, list) or not value or not all(isinstance(item, str) for item in value):
        raise InputError(f"{name} = {value!r} must be a list of texts that is not empty")
    if len(set(value)) < len(value):
        raise InputError(f"{name}: an entry is there twice")
    return tuple(value)


def _trials(file: Path, names: tuple[str, ...]) -> tuple[Trial, ...]:
    trials: list[Trial] = []
    for name in names:
        beside = file.parent / name
        if Path(name).is_absolute() or ".." in Path(name).parts:
            raise InputError(f"trials: {name!r} must be a built-in name or a file beside the challenge")
        trials += expand_sweeps(load_trial(str(beside) if beside.is_file() else name))
    for trial in trials:
        if not trial.robots:
            raise InputError(f"trials: {trial.name!r} has no robot")
    return tuple(trials)


def _held_back(value: Any) -> str:
    text = _text("held-back", value)
    if text and (len(text) != 64 or set(text) - set("0123456789abcdef")):
        raise InputError(f"held-back = {text!r} must be the 64 digits that `crowdbot challenge seal` prints")
    return text


def _rank(text: str, statistics: tuple[str, ...]) -> tuple[str, str]:
    name, _, order = text.rpartition(" ")
    if order not in ORDERS or name not in statistics:
        raise InputError(f"rank: {text!r} must be one of the statistics, followed by high or low")
    return name, order


def _limits(values: Any) -> dict[str, float]:
    if not isinstance(values, dict):
        raise InputError(f"limits = {values!r} must be a table")
    for name, value in values.items():
        if name not in LIMITS:
            raise InputError(f"limits: {name!r} is unknown; known are {', '.join(LIMITS)}")
        if isinstance(value, bool) or not isinstance(value, int | float) or not 0.0 < value < 1e9:
            raise InputError(f"limits: {name} = {value!r} must be a number above 0")
    return LIMITS | {name: float(value) for name, value in values.items()}


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
        secret_seeds = SecretSeeds(str(values["seeds"]), str(values["salt"]))
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise InputError(f"{path} has no secret seeds ({type(error).__name__})") from None
    if secret_seeds.hash != expected:
        raise InputError(
            f"{path}: these seeds have the hash {secret_seeds.hash[:12]}..., the challenge has {expected[:12]}..."
        )
    return secret_seeds
