"""Record the beginning of the first trial of the app, which is shown while it is compiled: python tools/first_trial.py.

To be called again when the results of this trial or the bodies of people change; tests/web compares them.
"""

from __future__ import annotations

from pathlib import Path

from crowdbot.trials import load_trial
from crowdbot.web.simulator import FIRST
from crowdbot.web.simulator.recorded_beginning import RecordedBeginning

FILE = Path(__file__).parents[1] / "src/crowdbot/assets/app/first-trial.xz"
SECONDS = 40.0


def main() -> None:
    """Write the file."""
    name, values, seed = FIRST
    found = RecordedBeginning.record(load_trial(name, **values), seed, SECONDS)
    FILE.write_bytes(found.encode())
    print(f"{FILE}: {len(found)} frames, {found.seconds:g} s, {FILE.stat().st_size} bytes")


if __name__ == "__main__":
    main()
