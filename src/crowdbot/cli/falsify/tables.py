"""Tables of a search for failures for the terminal."""

from __future__ import annotations

from typing import TYPE_CHECKING

from crowdbot.cli.output import print_table

if TYPE_CHECKING:
    from crowdbot.falsification import FalsificationResult

MOST = 20
"""Largest number of clusters and messages that are printed."""


def print_result(result: FalsificationResult, wall: float) -> None:
    """Print the estimate, the clusters, and the failures that are kept."""
    from crowdbot.falsification import describe_rarity

    first = "-" if result.first_failure is None else str(result.first_failure)
    estimate = "-" if result.estimate is None else str(result.estimate)
    head = ("navigator", "search", "runs", "failures", "first", "invalid", "probability [95 %]")
    row = (
        result.method,
        result.search,
        str(len(result.samples)),
        str(result.failures),
        first,
        str(result.invalid),
        estimate,
    )
    print_table(f"{result.title}: {result.failure}", head, [row], words=2)
    _print_clusters(result)
    _print_found(result)
    for message, count in list(result.errors.items())[:MOST]:
        print(f"failed: {count} runs: {message}")
    invalid = next((sample.message for sample in result.samples if not sample.valid), "")
    if invalid:
        print(f"invalid: {result.invalid} runs, such as: {invalid}")
    for remark in result.remarks:
        print(f"note: {remark}")
    print(f"{describe_rarity(result)}\n{len(result.samples)} runs in {wall:.1f} s")


def _print_clusters(result: FalsificationResult) -> None:
    rows = []
    for number, cluster in enumerate(result.clusters[:MOST], 1):
        shifts = sorted(zip(result.factors, cluster.shifts, strict=True), key=lambda pair: -abs(pair[1]))[:3]
        causes = ", ".join(f"{factor.path} {shift:+.1f} sd" for factor, shift in shifts)
        worst = f"{result.samples[cluster.worst].robustness:.3g}"
        rows.append((str(number), cluster.event, causes, str(len(cluster.members)), f"{cluster.share:.3g}", worst))
    if rows:
        head = ("cluster", "event", "largest shifts of factors", "failures", "share", "least robustness")
        print_table("clusters of failures", head, rows, words=3)
    if len(result.clusters) > MOST:
        print(f"{len(result.clusters) - MOST} more clusters, see --json or --out")


def _print_found(result: FalsificationResult) -> None:
    rows = [
        (
            one.file,
            result.samples[one.sample].event,
            str(one.cluster),
            str(result.samples[one.sample].seed),
            f"{result.samples[one.sample].robustness:.3g}",
            "yes" if one.same else "no",
        )
        for one in result.found
        if one.file
    ]
    if rows:
        head = ("trial", "event", "cluster", "seed", "robustness", "same digest")
        print_table("failures that are kept", head, rows, words=2)
