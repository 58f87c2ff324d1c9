"""Challenges: entries are made again to the byte, submissions are hostile until run, seeds are committed to."""

from __future__ import annotations

import contextlib
import json
import subprocess
import sys
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

from crowdbot.challenges import (
    ChallengeEntry,
    SecretSeeds,
    builtin_challenges,
    commit_seeds,
    enter,
    entry_differences,
    load_challenge,
    load_entry,
    load_seeds,
    load_submission,
    pack_submission,
    unpack_submission,
    write_board,
)
from crowdbot.challenges.runner import sort_entries
from crowdbot.cli import main
from crowdbot.core import CrowdbotError, InputError, UnknownName
from crowdbot.evaluation import RunRow
from crowdbot.navigation.process.sandbox import sandbox_problem

SANDBOX = sandbox_problem() is None
"""Whether this system has a sandbox; without one, only own code can be run."""
CODE = """
from dataclasses import dataclass
from crowdbot.navigation import Navigator

@dataclass(frozen=True)
class Mine(Navigator):
    speed: float = 0.8
    def act(self, observation):
        return observation.towards_goal(self.speed)

@dataclass(frozen=True)
class Curious(Navigator):
    def act(self, observation):
        open("{elsewhere}").read()
        return observation.towards_goal(0.8)
"""
CHALLENGE = """
title = "Small"
trials = ["frontal"]
public-seeds = "0:2"
held-back = "{hash}"
statistics = ["success-rate", "time-to-goal"]
rank = ["success-rate high", "time-to-goal low"]
"""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    place = tmp_path / "own"
    place.mkdir()
    secret = tmp_path / "secret.json"
    (place / "mine.py").write_text(CODE.replace("{elsewhere}", str(secret)), encoding="utf-8")
    write_description(place, navigator="mine.py:Mine", name="mine", authors="A. Nobody")
    made = commit_seeds(secret, 3)
    (tmp_path / "small.toml").write_text(CHALLENGE.replace("{hash}", made.hash), encoding="utf-8")
    return place


def write_description(place: Path, **values: str) -> None:
    text = "".join(f"{name} = {json.dumps(value)}\n" for name, value in values.items())
    (place / "submission.toml").write_text(text, encoding="utf-8")


@pytest.fixture
def challenge_command(capsys: pytest.CaptureFixture[str]) -> Callable[..., subprocess.CompletedProcess[str]]:
    """Return a function that runs ``crowdbot challenge`` in this process."""

    def call(*words: object) -> subprocess.CompletedProcess[str]:
        status = main(["challenge", *map(str, words)])
        return subprocess.CompletedProcess(words, status, *capsys.readouterr())

    return call


@pytest.mark.live
def test_a_submission_is_run_packed_verified_and_ranked(
    folder: Path, tmp_path: Path, challenge_command: Callable[..., subprocess.CompletedProcess[str]]
) -> None:
    file = tmp_path / "small.toml"
    own = () if SANDBOX else ("--no-sandbox",)
    program = [sys.executable, "-m", "crowdbot", "challenge", "run", str(file), str(folder)]
    program += ["--out", str(tmp_path / "entry"), *own]
    done = subprocess.run(program, capture_output=True, text=True, check=False, timeout=300)
    assert done.returncode == 0, done.stderr
    assert "1 [0.158, 1]" in done.stdout
    done = challenge_command(
        "pack", file, folder, "--entry", tmp_path / "entry" / "entry.json", "--out", tmp_path / "s.zip"
    )
    assert done.returncode == 0, done.stderr
    done = challenge_command("verify", file, tmp_path / "s.zip", "--out", tmp_path / "again")
    if not SANDBOX:
        assert (done.returncode, "sandbox=false runs the code without one" in done.stderr) == (2, True)
        return
    assert done.returncode == 0, done.stderr
    assert "verified  yes: all digests are equal" in done.stdout
    assert load_entry(tmp_path / "again" / "entry.json").verified
    assert "worst" in (tmp_path / "again" / "report.html").read_text().lower()
    done = challenge_command(
        "verify", file, tmp_path / "s.zip", "--secret", tmp_path / "secret.json", "--out", tmp_path / "held"
    )
    assert done.returncode == 0, done.stderr
    held = load_entry(tmp_path / "held" / "entry.json")
    assert (held.seeds, len(held.runs["frontal"])) == ("held back", 3)
    done = challenge_command(
        "board", file, *(tmp_path / item / "entry.json" for item in ("again", "held")), "--out", tmp_path / "b.html"
    )
    assert done.returncode == 0, done.stderr
    page = (tmp_path / "b.html").read_text()
    assert page.count("A. Nobody") == 2
    assert "http" not in page


@pytest.mark.live
def test_a_false_entry_is_found(
    folder: Path, tmp_path: Path, challenge_command: Callable[..., subprocess.CompletedProcess[str]]
) -> None:
    challenge = load_challenge(tmp_path / "small.toml")
    entry, _, _ = enter(challenge, load_submission(folder), sandbox=SANDBOX)
    values = json.loads(entry.text())
    values["runs"]["frontal"][1]["metrics"]["time_to_goal"] = 1.0
    claimed = load_entry(json.dumps(values).encode(), challenge)
    assert entry_differences(claimed, entry) == ["frontal, seed 1: same digest, other metrics"]
    values["runs"]["frontal"][0]["digest"] = "0" * 32
    pack_submission(load_submission(folder), tmp_path / "s.zip", {"entry.json": json.dumps(values).encode()})
    if not SANDBOX:
        return
    done = challenge_command("verify", tmp_path / "small.toml", tmp_path / "s.zip", "--out", tmp_path / "again")
    assert done.returncode == 1
    assert "differs   frontal, seed 0: success 000000000000 claimed" in done.stdout
    assert not load_entry(tmp_path / "again" / "entry.json").verified


@pytest.mark.live
def test_code_that_looks_for_the_seeds_fails(folder: Path, tmp_path: Path) -> None:
    write_description(folder, navigator="mine.py:Curious", name="curious")
    if not SANDBOX:
        with pytest.raises(InputError, match="sandbox=false runs the code without one"):
            enter(load_challenge(tmp_path / "small.toml"), load_submission(folder))
        return
    entry, _, _ = enter(load_challenge(tmp_path / "small.toml"), load_submission(folder))
    assert [row.outcome for row in entry.runs["frontal"]] == ["error", "error"]
    assert "Permission denied" in entry.runs["frontal"][0].message


def test_a_pack_depends_on_the_files_only(folder: Path, tmp_path: Path) -> None:
    pack_submission(load_submission(folder), tmp_path / "one.zip")
    (folder / "mine.py").touch()
    pack_submission(load_submission(folder), tmp_path / "two.zip")
    assert (tmp_path / "one.zip").read_bytes() == (tmp_path / "two.zip").read_bytes()
    found, extra = unpack_submission(tmp_path / "one.zip", tmp_path / "there")
    assert (found.hash, extra) == (load_submission(folder).hash, {})


@pytest.mark.parametrize("name", ["submission/../evil.py", "submission//etc/evil", "submission/a\\..\\b"])
def test_names_that_lead_outside_are_refused(tmp_path: Path, name: str) -> None:
    with zipfile.ZipFile(tmp_path / "s.zip", "w") as archive:
        archive.writestr(name, "x")
    with pytest.raises(InputError, match="(leads outside|is no submission)"):
        unpack_submission(tmp_path / "s.zip", tmp_path / "there" / "files")
    assert not (tmp_path / "there" / "evil.py").exists()


def test_damaged_packs_are_refused(folder: Path, tmp_path: Path) -> None:
    pack_submission(load_submission(folder), tmp_path / "s.zip")
    data = (tmp_path / "s.zip").read_bytes()
    for k in range(0, len(data), 7):
        (tmp_path / "d.zip").write_bytes(data[:k] + bytes([data[k] ^ 0x55]) + data[k + 1 :])
        with contextlib.suppress(CrowdbotError):
            found, _ = unpack_submission(tmp_path / "d.zip", tmp_path / f"there-{k}")
            assert found.name
    names = {path.name for path in tmp_path.iterdir() if path.is_file()}
    assert names == {"s.zip", "d.zip", "secret.json", "small.toml"}


def test_seeds_are_committed_to(tmp_path: Path) -> None:
    made = commit_seeds(tmp_path / "s.json", 4)
    assert len(made.values) == 4
    assert load_seeds(tmp_path / "s.json", made.hash) == made
    with pytest.raises(InputError, match="these seeds have the hash"):
        load_seeds(tmp_path / "s.json", SecretSeeds(made.seeds, "other").hash)
    with pytest.raises(InputError, match="exists; seeds that were published cannot be drawn again"):
        commit_seeds(tmp_path / "s.json", 4)
    with pytest.raises(InputError, match="count = 0 must be from 1 to 10000"):
        commit_seeds(tmp_path / "t.json", 0)
    (tmp_path / "bad.json").write_text("{}")
    with pytest.raises(InputError, match=r"has no secret seeds \(KeyError\)"):
        load_seeds(tmp_path / "bad.json", "")


def test_the_board_orders_by_the_rank(folder: Path, tmp_path: Path) -> None:
    challenge = load_challenge(tmp_path / "small.toml")

    def entry(name: str, success: float, time: float) -> ChallengeEntry:
        rows = (RunRow(0, "success", "d", {"success": success, "time_to_goal": time}),)
        return ChallengeEntry("small", challenge.hash, name, name, "", "public", {"frontal": rows})

    entries = [entry("slow", 1.0, 9.0), entry("bad", 0.0, float("nan")), entry("fast", 1.0, 5.0)]
    assert [entry.submission for entry in sort_entries(challenge, entries)] == ["fast", "slow", "bad"]
    with pytest.raises(InputError, match="'slow' with public seeds is there twice"):
        write_board(challenge, [entries[0], entries[0]], tmp_path / "b.html")
    with pytest.raises(InputError, match="a board needs at least one entry"):
        write_board(challenge, [], tmp_path / "b.html")


def test_the_hash_changes_with_everything(folder: Path, tmp_path: Path) -> None:
    file, hashes = tmp_path / "small.toml", set()
    text = file.read_text()
    changes = [("", ""), ("0:2", "0:3"), ('"frontal"', '"doorway"'), ("time-to-goal low", "time-to-goal high")]
    for old, new in changes:
        file.write_text(text.replace(old, new) if old else text)
        hashes.add(load_challenge(file).hash)
    assert len(hashes) == len(changes)


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        ("title", "titel", "'titel' is unknown, did you mean 'title'"),
        ('title = "Small"', "", "'title' is missing"),
        ('"frontal"', '"../frontal.xml"', "must be a built-in name or a file beside the challenge"),
        ('["frontal"]', "[]", "must be a list of texts that is not empty"),
        ('"success-rate high"', '"success-rate"', "must be one of the statistics, followed by high or low"),
        ('statistics = ["success-rate"', 'statistics = ["wrong:x"', "'wrong' is unknown"),
        ('"0:2"', '"2:0"', "must have 1 to 1000000 seeds"),
        ("title =", "title", "is not a challenge"),
    ],
)
def test_wrong_challenges_are_explained(folder: Path, tmp_path: Path, old: str, new: str, message: str) -> None:
    file = tmp_path / "small.toml"
    file.write_text(file.read_text().replace(old, new, 1))
    with pytest.raises(InputError) as caught:
        load_challenge(file)
    assert message in str(caught.value)


@pytest.mark.parametrize(
    ("values", "message"),
    [
        ({"name": "x"}, "give either navigator = 'mine.py:Mine' or command"),
        ({"navigator": "mine.py:Mine"}, "'name' is missing"),
        ({"name": "x", "navigator": "../other.py:Mine"}, "must be a file of the submission"),
        ({"name": "x", "navigator": "mine.py:1"}, "must be a class in a file beside submission.toml"),
        ({"name": "x", "navigator": "mine.py:Mine", "author": "y"}, "'author' is unknown, did you mean 'authors'"),
        ({"name": "x" * 201, "navigator": "mine.py:Mine"}, "must be a text of at most 200 characters"),
    ],
)
def test_wrong_submissions_are_explained(folder: Path, values: dict[str, Any], message: str) -> None:
    write_description(folder, **values)
    with pytest.raises(InputError) as caught:
        load_submission(folder)
    assert message in str(caught.value)


def test_links_are_refused(folder: Path) -> None:
    (folder / "link").symlink_to("/etc/passwd")
    with pytest.raises(InputError, match="is not a plain file"):
        load_submission(folder)


def test_the_built_in_challenge_has_the_scenarios_of_the_original() -> None:
    assert list(builtin_challenges()) == ["crowd-against-the-machine"]
    challenge = load_challenge("crowd-against-the-machine")
    assert len(challenge.trials) == 21
    with pytest.raises(UnknownName, match="challenge 'crowd'"):
        load_challenge("crowd")
