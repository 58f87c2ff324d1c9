"""``crowdbot calibrate``: fit the parameters of a crowd model to recordings of people."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from .output import Progress, add_json, json_text, note, number, print_json, print_table, progress
from .recordings import add_recordings, print_notes, recordings
from .schemes import add_scheme, crowd_model, frame_line, named_search, prior
from .settings import add_settings, parse_settings

if TYPE_CHECKING:
    from crowdbot.calibration import CalibrationChunk, Calibrator, Fit, ParameterProfile
    from crowdbot.data import Recording, Windows

    from .parser import CommandParser


def arguments(parser: CommandParser) -> None:
    """Declare the options."""
    add_recordings(parser)
    add_scheme(parser, many=False)
    add = parser.add_argument
    add_settings(parser, "initial parameters of the crowd model")
    add("--shared", action="store_true", help="one common set of parameters instead of individual ones")
    add(
        "--profile",
        type=int,
        metavar="N",
        help="profile and interval of each parameter at N values; requires --shared (default: none)",
    )
    add("--workers", type=int, default=1, metavar="N", help="number of processes (default: 1)")
    add("--cluster", metavar="ADDRESS", help="address of a Ray cluster, such as auto; requires crowdbot[cluster]")
    add("--out", type=Path, metavar="DIR", help="folder for parameters, prior and resumable results (default: none)")
    add("--seed", type=int, default=0, help="random seed (default: 0)")
    add_json(parser)


def main(options: argparse.Namespace) -> int:
    """Calibrate on the observed rows of every window of every recording."""
    from crowdbot.core import InputError

    if options.profile is not None and not options.shared:
        raise InputError("--profile requires --shared: individual parameters have a spread over people instead")
    calibrator, goal = _calibrator(options)
    found = recordings(options)
    with progress(options.json) as report:
        if options.shared:
            calibrator = _with_goal(calibrator, goal, found)
            fits = {
                "together": calibrator.fit(
                    _pasts(found), options.seed, lambda share: report("shared parameters", share)
                )
            }
        else:
            fits = {one.path: _each(calibrator, goal, one, options, report) for one in found}
        profiles = _profiles(calibrator, fits["together"], found, options, report) if options.profile else ()
    if options.out is not None:
        _write_results(options.out, fits, options.shared)
        _write_profiles(options.out, profiles)
    if options.json:
        shown = {name: as_json(fit) for name, fit in fits.items()}
        print_json({**shown, **({"profiles": [profile.as_dict() for profile in profiles]} if profiles else {})})
        return 0
    print_notes(found)
    for name, fit in fits.items():
        _table(Path(name).name, fit)
    _print_profiles(profiles)
    return 0


def _profiles(
    calibrator: Calibrator, fit: Fit, found: tuple[Recording, ...], options: argparse.Namespace, report: Progress
) -> tuple[ParameterProfile, ...]:
    """Return the profiles of a shared fit; each value has a tenth of the budget."""
    from crowdbot.calibration import profile_parameters

    budget = max(1, options.budget // 10)
    return profile_parameters(
        calibrator, fit, _pasts(found), options.profile, budget, options.seed, lambda share: report("profiles", share)
    )


def _write_profiles(folder: Path, profiles: tuple[ParameterProfile, ...]) -> None:
    from crowdbot.calibration import plot_profiles

    if profiles:
        text = json_text([profile.as_dict() for profile in profiles])
        (folder / "profiles.json").write_text(text + "\n", encoding="utf-8")
        plot_profiles(profiles, folder / "profiles.png")
        note(f"wrote profiles.json, profiles.png in {folder}")


def _print_profiles(profiles: tuple[ParameterProfile, ...]) -> None:
    rows = [
        (
            profile.name,
            number(profile.best),
            f"{profile.interval[0]:.3g} to {profile.interval[1]:.3g}",
            f"{profile.bootstrap[0]:.3g} to {profile.bootstrap[1]:.3g}",
            profile.identified,
            profile.unit,
        )
        for profile in profiles
    ]
    if rows:
        head = ("parameter", "value", "95 % by profile", "95 % by bootstrap", "identified", "unit")
        print_table("profiles", head, rows)


def _calibrator(options: argparse.Namespace) -> tuple[Calibrator, str | None]:
    """Return the calibrator, and the name of the goal if it depends on the recording."""
    from crowdbot.calibration import Calibrator, goal_class

    kind = goal_class(options.goal or "current-direction")
    late = kind.knows_future or kind.learns
    parts: dict[str, Any] = {} if late or options.goal is None else {"goal": options.goal}
    parts |= {"cost": options.cost} if options.cost else {}
    parts["search"] = named_search(options.search or "genetic", options)
    calibrator = Calibrator(
        crowd_model(options.model or "orca", parse_settings(options.set)),
        budget=options.budget,
        shared=options.shared,
        free=tuple(options.free),
        prior=prior(options.prior),
        **parts,
    )
    return calibrator, options.goal if late else None


def _each(
    calibrator: Calibrator, goal: str | None, recording: Recording, options: argparse.Namespace, report: Progress
) -> Fit:
    from crowdbot.calibration import RecordingCalibration
    from crowdbot.core import InputError

    campaign = RecordingCalibration(recording, calibrator, goal, options.seed)
    keep = None if options.out is None else options.out / "parts"
    pieces: list[CalibrationChunk] = []
    whole, done = len(campaign.past), 0
    report(recording.name, 0.0)
    if not options.json:
        note(frame_line())
    for piece in campaign.run(options.workers, options.cluster, keep):
        pieces.append(piece)
        done += piece.last - piece.first
        if not options.json:
            _print_frames(piece)
        report(recording.name, done / whole)
    fit = campaign.merge(pieces)
    if fit.persons == 0:
        raise InputError(
            f"{recording.path}: nobody in {fit.windows} windows can be scored by {fit.scheme.split(', ')[1]};"
            " people need enough observed rows, and others nearby if the cost uses distances between people"
        )
    return fit


def _with_goal(calibrator: Calibrator, goal: str | None, found: tuple[Recording, ...]) -> Calibrator:
    """Return the calibrator of a shared fit with the goal of its recording, if it depends on the recording."""
    import dataclasses

    from crowdbot.calibration import goal_for
    from crowdbot.core import InputError

    if goal is None:
        return calibrator
    if len(found) > 1:
        raise InputError(
            f"the goal {goal} depends on the recording: calibrate one recording at a time, not {len(found)}"
        )
    return dataclasses.replace(calibrator, goal=goal_for(goal, found[0]))


def _pasts(found: tuple[Recording, ...]) -> list[Windows]:
    return [one.windows[0] for one in found]


def _print_frames(piece: CalibrationChunk) -> None:
    arrays = piece.arrays
    seconds = float(arrays["seconds"].sum()) / max(1, piece.last - piece.first)
    for frame, people, cost, count in zip(
        piece.frame, piece.people, arrays["cost"], arrays["evaluations"], strict=True
    ):
        note(frame_line(frame, people, cost, count, seconds))


def _table(name: str, fit: Fit) -> None:
    import numpy as np

    own = {row.name: row for row in fit.space.table}
    rows = [
        (parameter, number(median), "" if fit.shared else number(spread), own[parameter].unit)
        for parameter, (median, spread) in fit.table().items()
    ]
    caption = (
        f"mean cost {np.nanmean(fit.cost):.4f} m, {np.nanmean(fit.given_cost):.4f} m before;"
        f" {fit.persons} persons in {fit.windows} windows, {int(fit.evaluations.sum())} evaluations,"
        f" {fit.seconds:.1f} s"
    )
    middle = ("shared", "", "unit") if fit.shared else ("median", "sd over people", "unit")
    print_table(f"{name}: {fit.scheme}", ("parameter", *middle), rows, caption=caption)


def as_json(fit: Fit) -> dict[str, Any]:
    """Return the output of ``--json`` for a fit."""
    import numpy as np

    return {
        "scheme": fit.scheme,
        "cost": float(np.nanmean(fit.cost)),
        "given_cost": float(np.nanmean(fit.given_cost)),
        "persons": fit.persons,
        "windows": fit.windows,
        "evaluations": int(fit.evaluations.sum()),
        "seconds": fit.seconds,
        "shared": fit.shared,
        "parameters": {name: {"median": m, "sd": s} for name, (m, s) in fit.table().items()},
    }


def _write_results(folder: Path, fits: dict[str, Fit], shared: bool) -> None:
    """Write the summary and, for individual parameters, the table of parameters and the population prior."""
    from crowdbot.calibration import PopulationPrior
    from crowdbot.core import explain_write_errors

    text = json_text({name: as_json(fit) for name, fit in fits.items()})
    names = ["calibration.json"]
    with explain_write_errors(folder):
        folder.mkdir(parents=True, exist_ok=True)
        (folder / "calibration.json").write_text(text + "\n", encoding="utf-8")
        if not shared:
            _people(fits).to_parquet(folder / "parameters.parquet", index=False)
            PopulationPrior.from_fits(list(fits.values())).save(folder / "prior.json")
            names += ["parameters.parquet", "prior.json"]
    note(f"wrote {', '.join(names)} in {folder}")


def _people(fits: dict[str, Fit]) -> Any:
    """Return one row for each person and window: recording, window, id, cost of the window, parameters."""
    import numpy as np
    import pandas as pd

    tables = []
    for name, fit in fits.items():
        window, person = np.nonzero(fit.counted)
        columns = {"recording": name, "window": window, "id": fit.id[window, person], "window_cost": fit.cost[window]}
        values = fit.values[window, person]
        tables.append(pd.DataFrame(columns | {key: values[:, k] for k, key in enumerate(fit.space.names)}))
    return pd.concat(tables, ignore_index=True)
