"""``crowdbot falsify TRIAL``: search a trial for failures of its navigator, and estimate how likely they are."""

from __future__ import annotations

import argparse
import time
from pathlib import Path
from typing import TYPE_CHECKING

from crowdbot.cli.output import add_json, note, print_json, print_robots, progress
from crowdbot.cli.settings import add_robots, add_settings, add_world, load_settings_trial, settings

from .tables import print_result

if TYPE_CHECKING:
    from crowdbot.falsification import SearchSpace


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the options."""
    parser.add_argument("trial", metavar="TRIAL", help="trial file or built-in name")
    parser.add_argument(
        "--navigator",
        default="own",
        metavar="NAME",
        help='navigator with parameters, such as "orca safety=0.15" or mine.py:Mine (default: own, that of the trial)',
    )
    add_robots(parser)
    parser.add_argument(
        "--over",
        action="append",
        default=[],
        metavar="PATH=DISTRIBUTION",
        help="value that varies, such as agent[1]/speed=uniform(0.8,1.6); uniform, normal, log-uniform, integer or"
        " choice; repeatable; the seed always varies",
    )
    parser.add_argument(
        "--failure",
        default="collision",
        metavar="WHAT",
        help="collision, timeout, severity or any; or a requirement that must hold, such as min-clearance>0.2"
        " (default: collision)",
    )
    parser.add_argument(
        "--search",
        default="cross-entropy",
        metavar="NAME",
        help="cross-entropy, splitting or plain, which estimate the probability; or a search of calibration such as"
        " cma-es (default: cross-entropy)",
    )
    parser.add_argument("--aim", default="worst", metavar="AIM", help="of such a search: worst or likely")
    parser.add_argument("--runs", type=int, default=1000, metavar="N", help="number of runs (default: 1000)")
    parser.add_argument("--seed", type=int, default=0, metavar="N", help="seed of the search (default: 0)")
    parser.add_argument("--keep", type=int, default=10, metavar="N", help="failures to keep as trials (default: 10)")
    parser.add_argument(
        "--out", type=Path, metavar="DIR", help="folder of result.json, report.html and found/1.xml ..."
    )
    parser.add_argument("--workers", type=int, default=1, metavar="N", help="number of processes")
    parser.add_argument("--cluster", metavar="ADDRESS", help="address of a Ray cluster, auto, or local")
    parser.add_argument("--trust", action="store_true", help="allow code outside the folder of the trial")
    add_world(parser)
    add_settings(parser)
    add_json(parser)


def main(options: argparse.Namespace) -> int:
    """Search for failures; the status is 0 whether or not there are any."""
    from crowdbot.falsification import falsify, parse_failure, parse_sampling, write_report
    from crowdbot.trials import remarks_at_end

    with remarks_at_end():
        space = _space(options)
    print_robots([space.trial], options.json)
    begin = time.perf_counter()
    try:
        with progress(options.json) as report:
            result = falsify(
                space,
                parse_failure(options.failure),
                parse_sampling(options.search, options.aim),
                runs=options.runs,
                seed=options.seed,
                folder=options.out,
                keep=options.keep,
                method=options.navigator,
                workers=options.workers,
                cluster=options.cluster,
                progress=lambda share: report("falsify", share),
            )
    except KeyboardInterrupt:
        if options.out is not None:
            note(f"crowdbot: what is done is stored in {options.out}; the same command continues")
        raise
    if options.out is not None:
        result.save(options.out / "result.json")
        write_report(result, space, options.out / "report.html")
    if options.json:
        print_json(result.table())
    else:
        print_result(result, time.perf_counter() - begin)
        if options.out is not None:
            print(f"report    {options.out / 'report.html'}\nresult    {options.out / 'result.json'}")
    return 0


def _space(options: argparse.Namespace) -> SearchSpace:
    """Return the trial with its navigator and what varies in it."""
    from crowdbot.core import InputError
    from crowdbot.evaluation import parse_methods, parse_robots
    from crowdbot.falsification import SearchSpace, parse_factor

    methods = parse_methods(options.navigator)
    if len(methods) != 1:
        raise InputError(f"--navigator {options.navigator!r} names {len(methods)} navigators; give one")
    kinds = parse_robots(options.robots)
    if len(kinds) != 1:
        raise InputError(f"--robots {options.robots!r} names {len(kinds)} robots; give one")
    trial = load_settings_trial(options.trial, settings(options), options.trust)
    return SearchSpace(methods[0].put_into(trial, kinds[0]), tuple(parse_factor(text) for text in options.over))
