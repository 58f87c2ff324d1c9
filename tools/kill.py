"""Kill ``crowdbot run`` with ``kill -9`` at random moments and look at what is left: python tools/kill.py [50]."""

from __future__ import annotations

import os
import random
import subprocess
import sys
import tempfile
import time
from pathlib import Path

from mcap.reader import make_reader
from rosbags.highlevel import AnyReader

from crowdbot.core import EpisodeError
from crowdbot.recording import read_episode, repair
from crowdbot.trials import load_trial

RUN = """import sys
from crowdbot.trials import load_trial
from crowdbot.recording import open_run
with open_run(load_trial(sys.argv[1]), out=sys.argv[2]) as running:
    while running.step() is None:
        print(running.simulation.world.clock.time, flush=True)
"""
TRIAL = "crossing-flows"
LIMIT = 60.0


def killed(folder: Path, chance: random.Random) -> tuple[float, float]:
    """Run the trial, kill it at a random moment of its run, and return wall time [s] and the last time told [s]."""
    process = subprocess.Popen([sys.executable, "-c", RUN, TRIAL, str(folder)], stdout=subprocess.PIPE)
    assert process.stdout is not None
    os.set_blocking(process.stdout.fileno(), False)
    wait = chance.uniform(0.0, 3.0) if chance.random() < 0.2 else None  # some while it is still starting
    begin, told, rest = time.monotonic(), -1.0, chance.uniform(0.0, 1.0)
    while time.monotonic() - begin < LIMIT:
        words = (process.stdout.read() or b"").split()
        if words and told < 0.0:
            begin, wait = time.monotonic(), wait or rest
        told = float(words[-1]) if words else told
        if wait is not None and time.monotonic() - begin > wait:
            break
        time.sleep(0.001)
    process.kill()
    words = (process.stdout.read() or b"").split()
    process.wait()
    process.stdout.close()
    return time.monotonic() - begin, float(words[-1]) if words else told


def main() -> None:
    """Kill as often as asked and print one line for each."""
    count = int(sys.argv[1]) if len(sys.argv) > 1 else 50
    chance = random.Random(1)  # noqa: S311
    worst, direct, empty = 0.0, 0, 0
    step = load_trial(TRIAL).step
    with tempfile.TemporaryDirectory() as place:
        top = Path(place)
        for number in range(count):
            folder = top / "out" / str(number)
            _, told = killed(folder, chance)
            left = sorted(entry.name for entry in folder.iterdir()) if folder.exists() else []
            left = [name for name in left if not name.endswith(".lock")]  # the next run takes it over
            if "episode.mcap" not in left:
                assert told < 0.0, (told, left)
                empty += 1
                print(f"{number:3} killed before the first step: {left or 'nothing'} left")
                continue
            assert left == ["episode.mcap"], left
            read = read_episode(folder / "episode.mcap")
            missing = max(0.0, told + step - float(read.times[-1]))
            worst = max(worst, missing)
            direct += _opens(folder / "episode.mcap", len(read.times))
            try:
                end = repair(folder / "episode.mcap")
            except EpisodeError as error:
                raise SystemExit(str(error)) from None
            assert end in (None, read.times[-1])
            assert _opens(folder / "episode.mcap", len(read.times))
            print(f"{number:3} killed at {told:6.2f} s, recorded to {read.times[-1]:6.2f} s, complete {read.complete}")
        assert sorted(entry.name for entry in top.iterdir()) == ["out"]
    print(f"{count} killed: {count - empty} files, all open; {direct} of them by rosbags and mcap before a repair;")
    print(f"at most {worst:.2f} s of simulated time missing; {empty} killed before the first step left no episode")


def _opens(path: Path, count: int) -> bool:
    """Return whether rosbags and mcap read every instant."""
    try:
        with AnyReader([path]) as bag:
            heard = sum(1 for connection, _, _ in bag.messages() if connection.topic == "/people")
        with path.open("rb") as stream:
            alone = sum(1 for _ in make_reader(stream).iter_messages(topics=["/people"]))
    except Exception as error:  # what readers of others make of a torn record is for the line that is printed
        print(f"    {type(error).__name__}: {error}")
        return False
    return heard == alone == count


if __name__ == "__main__":
    main()
