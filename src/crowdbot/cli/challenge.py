"""``crowdbot challenge run|pack|verify|board|seal``: competitions of navigators with results that can be checked."""

from __future__ import annotations

import argparse
import json
import tempfile
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from crowdbot.cli.output import add_json, note, print_json, print_table, progress

if TYPE_CHECKING:
    from crowdbot.challenges import Challenge, ChallengeEntry, Submission


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the verbs and their options."""
    verbs = parser.add_subparsers(metavar="VERB", required=True, dest="verb")
    made = {name: verbs.add_parser(name, help=line, description=line[0].upper() + line[1:] + ".", allow_abbrev=False)
            for name, line in VERBS.items()}  # fmt: skip
    for name in ("run", "pack", "verify", "board"):
        made[name].add_argument("challenge", metavar="CHALLENGE", help="challenge file (.toml) or built-in name")
    for name in ("run", "pack"):
        made[name].add_argument("submission", type=Path, metavar="FOLDER", help="folder with submission.toml")
    made["verify"].add_argument("packed", type=Path, metavar="FILE", help="packed submission (.zip)")
    made["board"].add_argument("entries", type=Path, nargs="+", metavar="ENTRY", help="entry.json of a submission")
    made["seal"].add_argument("secret", type=Path, metavar="FILE", help="file to write the seeds to; keep it secret")
    made["seal"].add_argument("--count", type=int, default=20, metavar="N", help="number of seeds (default: 20)")
    for name in ("run", "verify"):
        add = made[name].add_argument
        add("--secret", type=Path, metavar="FILE", help="run the seeds that are held back (default: the public seeds)")
        add("--out", type=Path, required=True, metavar="DIR", help="folder of entry.json and report.html")
        add("--worst", type=int, default=5, metavar="N", help="worst runs to play in the report (default: 5)")
        add("--workers", type=int, default=1, metavar="N", help="number of processes (default: 1)")
    made["run"].add_argument("--no-sandbox", action="store_true", help="run your own code without the sandbox")
    made["pack"].add_argument("--entry", type=Path, metavar="FILE", help="entry.json to pack with the files")
    made["pack"].add_argument("--out", type=Path, required=True, metavar="FILE", help="packed submission (.zip)")
    made["board"].add_argument("--out", type=Path, required=True, metavar="FILE", help="page (.html)")
    for item in made.values():
        add_json(item)


VERBS = {
    "run": "run a submission with the public seeds and write its entry and report",
    "pack": "pack a submission into one file",
    "verify": "run a packed submission again and compare it with its entry, digest by digest",
    "board": "write the page of a challenge with its entries",
    "seal": "draw secret seeds and print the hash for the challenge file",
}


def main(options: argparse.Namespace) -> int:
    """Run a verb."""
    return {"run": _run, "pack": _pack, "verify": _verify, "board": _board, "seal": _seal}[options.verb](options)


def _run(options: argparse.Namespace) -> int:
    from crowdbot.challenges import load_challenge, load_submission

    challenge, submission = load_challenge(options.challenge), load_submission(options.submission)
    entry = _enter(options, challenge, submission, not options.no_sandbox)
    return _tell(options, challenge, entry)


def _enter(options: argparse.Namespace, challenge: Challenge, submission: Submission, sandbox: bool) -> ChallengeEntry:
    from crowdbot.challenges import enter
    from crowdbot.evaluation import parse_statistic, worst_runs, write_report

    seeds = _seeds(options.secret, challenge)
    try:
        with progress(options.json) as report:
            entry, plan, result = enter(
                challenge,
                submission,
                seeds,
                folder=options.out / "parts",
                workers=options.workers,
                sandbox=sandbox,
                progress=lambda share: report("challenge", share),
            )
    except KeyboardInterrupt:
        note(f"crowdbot: what is done is stored in {options.out}; the same command continues")
        raise
    entry.save(options.out / "entry.json")
    columns = [parse_statistic(name) for name in challenge.statistics]
    write_report(result, options.out / "report.html", columns, worst=worst_runs(plan, result, 1)[: options.worst])
    return entry


def _seeds(secret: Path | None, challenge: Challenge) -> Sequence[int] | None:
    from crowdbot.challenges import load_seeds
    from crowdbot.core import InputError

    if secret is None:
        return None
    if not challenge.held_back:
        raise InputError(f"challenge {challenge.name!r} holds no seeds back; leave out --secret")
    return load_seeds(secret, challenge.held_back).values


def _tell(options: argparse.Namespace, challenge: Challenge, entry: ChallengeEntry, differences: Any = None) -> int:
    if options.json:
        told = {} if differences is None else {"differences": differences}
        print_json(json.loads(entry.text()) | told)
        return 1 if differences else 0
    rows = [
        [trial, str(len(rows)), *(str(entry.estimate(name, trial)) for name in challenge.statistics)]
        for trial, rows in entry.runs.items()
    ]
    every = str(sum(len(rows) for rows in entry.runs.values()))
    rows.append(["all", every, *(str(entry.estimate(name)) for name in challenge.statistics)])
    title = f"{entry.submission} in {challenge.title}, {entry.seeds} seeds"
    print_table(title, ["trial", "runs", *challenge.statistics], rows, "Intervals are 95 %.")
    for trial, runs in entry.runs.items():
        for row in runs:
            if row.outcome == "error":
                print(f"failed    {trial}, seed {row.seed}: {row.message}")
    for line in differences or ():
        print(f"differs   {line}")
    if differences is not None:
        print(f"verified  {'no' if differences else 'yes: all digests are equal'}")
    print(f"entry     {options.out / 'entry.json'}\nreport    {options.out / 'report.html'}")
    return 1 if differences else 0


def _pack(options: argparse.Namespace) -> int:
    from crowdbot.challenges import load_challenge, load_entry, load_submission, pack_submission
    from crowdbot.core import InputError

    challenge, submission = load_challenge(options.challenge), load_submission(options.submission)
    extra = {}
    if options.entry is not None:
        entry = load_entry(options.entry, challenge)
        if entry.submission_hash != submission.hash:
            raise InputError(f"{options.entry} was made from other files; run the submission again")
        extra["entry.json"] = options.entry.read_bytes()
    pack_submission(submission, options.out, extra)
    told = {"file": str(options.out), "hash": submission.hash, "bytes": options.out.stat().st_size}
    if options.json:
        print_json(told)
    else:
        print(f"packed    {options.out}, {told['bytes']} bytes\nhash      {submission.hash}")
    return 0


def _verify(options: argparse.Namespace) -> int:
    import dataclasses

    from crowdbot.challenges import entry_differences, load_challenge, load_entry, unpack_submission

    challenge = load_challenge(options.challenge)
    with tempfile.TemporaryDirectory(prefix="crowdbot-submission-") as place:
        submission, extra = unpack_submission(options.packed, Path(place) / "files")
        claimed = (
            load_entry(extra["entry.json"], challenge) if "entry.json" in extra and options.secret is None else None
        )
        entry = _enter(options, challenge, submission, True)
    differences = [] if claimed is None else entry_differences(claimed, entry)
    entry = dataclasses.replace(entry, verified=not differences)
    entry.save(options.out / "entry.json")
    if claimed is None:
        note("crowdbot: nothing to compare with; these runs are the result")
    return _tell(options, challenge, entry, differences)


def _board(options: argparse.Namespace) -> int:
    from crowdbot.challenges import load_challenge, load_entry, write_board

    challenge = load_challenge(options.challenge)
    entries = [load_entry(path, challenge) for path in options.entries]
    write_board(challenge, entries, options.out)
    if options.json:
        print_json({"file": str(options.out), "entries": [entry.submission for entry in entries]})
    else:
        print(f"board     {options.out}, {len(entries)} entries")
    return 0


def _seal(options: argparse.Namespace) -> int:
    from crowdbot.challenges import commit_seeds

    made = commit_seeds(options.secret, options.count)
    if options.json:
        print_json({"file": str(options.secret), "held-back": made.hash})
    else:
        print(f'held-back = "{made.hash}"\nThe seeds are in {options.secret}; keep it secret until the end.')
    return 0
