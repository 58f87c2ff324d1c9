"""Draw the pictures of docs/how-to/leader-follower.md, crossing.md and encounters.md from rehearsed sessions.

for n in 1 2 3 4 5 6 7 8; do crowdbot experiment run leader-follower --participant $n --out data --rehearse; done
python tools/study_pictures.py data measures docs/how-to/leader-follower.png
for n in 1 2 3; do crowdbot experiment run crossing --participant $n --out ways --rehearse; done
python tools/study_pictures.py ways motion docs/how-to/crossing.png
"""

from __future__ import annotations

import sys
from pathlib import Path

from crowdbot.experiments import analyse_sessions, measures_figure


def main(folder: str, what: str, out: str) -> None:
    """Write the plot of the measures, or that of the motion in the trials."""
    found = analyse_sessions(folder)
    trials = [trial for trial in found.trials if not trial.reason]
    figure = measures_figure(found) if what == "measures" else found.study.draw(trials)
    figure.savefig(Path(out), dpi=90)


if __name__ == "__main__":
    main(*sys.argv[1:4])
