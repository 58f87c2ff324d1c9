"""Plot of the scores of scan predictors over the horizon."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from .scan_scores import SCAN_SCORES, ScanScores

COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#000000")


def plot_scan_scores(scores: dict[str, ScanScores], title: str, file: Path) -> Path:
    """Draw each score over the horizon with 95 % intervals as PNG, and return the file.

    Args:
        scores: scores by the name of the predictor.
        title: title of the figure.
        file: output file.
    """
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    figure, axes = pyplot.subplots(2, 3, figsize=(13, 7), dpi=110, sharex=True)
    axes[1, 2].set_visible(False)
    axes[0, 2].tick_params(labelbottom=True)
    for axis, (name, unit) in zip(axes.flat, SCAN_SCORES.items(), strict=False):
        for color, (label, item) in zip(COLORS * len(scores), scores.items(), strict=False):
            rows = np.array([estimate[:3] for estimate in item.estimates()[name]])
            axis.plot(item.horizons, rows[:, 0], "o-", color=color, label=label, markersize=4)
            axis.fill_between(item.horizons, rows[:, 1], rows[:, 2], color=color, alpha=0.2, linewidth=0)
        axis.set_ylabel(name.replace("_", " ") + (f" [{unit}]" if unit else ""))
        axis.set_ylim(bottom=0.0)
        axis.grid(alpha=0.3)
    for axis in (*axes[1, :2], axes[0, 2]):
        axis.set_xlabel("horizon [s]")
    axes[0, 0].legend(frameon=False)
    figure.suptitle(title)
    figure.tight_layout()
    figure.savefig(file)
    pyplot.close(figure)
    return file
