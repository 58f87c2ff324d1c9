"""Mutate trial files and see that each is read, or refused in a sentence: no stack trace, no hang, no stray file.

    python tools/fuzz_trials.py --count 5000 --seed 0

A file that can be read is also written, read again, and run for a few steps with a recording. With ``--new`` all files
begin as one with bodies, props, links and cameras, half of them in the physics world. With ``--ends`` every number in a
few files is in turn next to nothing and huge.
"""

from __future__ import annotations

import argparse
import random
import shutil
import signal
import sys
import tempfile
import time
import traceback
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from types import FrameType

sys.path.insert(0, str(Path(__file__).parent))

from fuzzing import XML_NUMBER, mutate_xml

from crowdbot.core import CrowdbotError
from crowdbot.recording import open_run
from crowdbot.trials import builtin_trials, expand_spawners, expand_sweeps, load_trial, parse_trial, trial_xml

LIMIT = 60
"""No file may take longer than this [s]."""
STEPS = 3
OUT = "out"
"""The folder of recordings in that of the files."""
MOST_PEOPLE = 2000
"""Files with more people are read and checked, but not run."""

ENDS = ("-1e300", "-1e-320", "1e-320", "1e-40", "1e-12", "1e-6", "1e-3", "1e3", "1e6", "1e9", "1e40", "1e300")

EXTRA = """<trial name="extra" duration="5" capacity="40">
  <stage area="POLYGON ((0 0, 12 0, 12 9, 0 9, 0 0), (5 5, 6 5, 6 6, 5 6, 5 5))"/>
  <routing radius="0.2" unreachable="nearest"/>
  <crowd name="a" type="orca" time-horizon="normal(2, 0.1)"/>
  <crowd name="b" type="social-force"/>
  <contact/>
  <journey name="lap" then="again"><zone points="1,1 2,1 2,2" aim="random"/><point x="3" y="3"/></journey>
  <agent x="1" y="1" heading="-2" goal="3,3" group="0"><parameter name="time-horizon" value="2"/></agent>
  <agent x="2" y="7" journey="lap" crowd="b"/>
  <spawner count="4" zone="7,1 10,1 10,4" stands="true"><group size="2" share="0.5"/><group size="1"/></spawner>
  <source zone="7,6 9,6 9,8" goal="1,1 2,1 2,2" rate="1" end="4"/>
  <portal zone="10,5 11,5 11,6" dx="-8"/>
  <end empty="true"><when what="people" below="2" outcome="success"/></end>
  <recording period="0.2"/>
  <sweep path="agent[1]/speed" values="1 1.5"/>
</trial>
"""

NEW = """<trial name="new" duration="2" step="0.04" seed="4" world="planar" physics-step="0.005" bodies="limbs">
  <stage walkable="0,0 12,0 12,8 0,8" wall-height="2.2" friction="0.9">
    <cube x="4" y="2" size="0.6" fixed="true"/>
    <cube x="6" y="1" size="0.3" mass="2"/>
    <table x="9" y="6.5" heading="0.3"/>
    <tree x="2" y="7" height="4"/>
    <light x="6" y="4" shadows="true"/>
  </stage>
  <crowd type="orca"/>
  <agent x="6" y="4" goal="1,4" body="woman-36" outfit="3"/>
  <agent x="7" y="2.2" heading="3" body="man" activity="phone"/>
  <spawner count="3" zone="9,1 11,1 11,5 9,5" goal="1,1 2,1 2,5 1,5" body="adult child" activity="talk bottle"/>
  <robot name="pepper" type="pepper" sensor-rates="nearest" x="2" y="4" control-period="0.08">
    <goal x="10" y="4"/>
    <navigator type="orca"/>
    <sensor name="eyes" type="rgbcamera" link="CameraTop_frame" width="32" height="24" rate="5" segmentation="true"/>
    <sensor name="depth" type="depth-camera" x="0.1" z="1" pitch="0.2" rate="5" width="24" height="18"/>
    <sensor name="imu" type="imu" rate="25"/>
    <sensor name="wheels" type="wheel-odometry" rate="25" delay="0.08"/>
    <sensor name="rings" type="lidar3d" z="1.3" rate="5" columns="36"/>
  </robot>
  <robot name="puck" x="2" y="2.2" height="0.4" mass="15" latency="0.12" control-period="0.04">
    <goal x="10" y="2"/>
    <drive type="differential-drive"/>
    <navigator type="straight"/>
    <sensor name="scan" type="lidar2d" rays="60" rate="12.5"/>
  </robot>
  <camera name="door" x="0.5" y="0.5" heading="0.7" z="2" pitch="0.2" width="64" height="48"/>
  <camera name="head" robot="pepper" link="Head" x="0.1" z="0" width="64" height="48"/>
  <end collision="false" goal="false"/>
  <recording period="0.04" markers="0.4"/>
</trial>
"""


def texts(new: bool = False) -> list[str]:
    """Return good files to begin with."""
    bodies = [NEW, NEW.replace("planar", "physics")]
    if new:
        return bodies
    small = [name for name in builtin_trials() if not name.startswith("challenge") and load_trial(name).people < 80]
    return [
        EXTRA,
        *bodies,
        *(trial_xml(load_trial(name)) for name in small),
        trial_xml(expand_spawners(load_trial("frontal"))),
    ]


def ends() -> Iterator[str]:
    """Yield files in which one number is an end of what a number can be."""
    for text in (EXTRA, *texts(new=True)):
        for found in XML_NUMBER.finditer(text):
            yield from (text[: found.start()] + end + text[found.end() :] for end in ENDS)


def drawn(count: int, seed: int, new: bool = False) -> Iterator[str]:
    """Yield so many mutated files; every third begins as one in the physics world, whatever trials are built in."""
    good, physics = texts(new), texts(new=True)[1]
    for k in range(count):
        chance = random.Random(f"{seed} {k}")  # noqa: S311
        yield mutate_xml(physics if k % 3 == 0 else chance.choice(good), chance)


def judged(text: str, folder: Path) -> str:
    """Return what became of a file: ``refused``, ``read`` or ``run``; anything but a sentence of ours is raised."""
    try:
        trial = parse_trial(text, place="t.xml", folder=folder)
    except CrowdbotError as error:
        sentence = str(error)
        if not sentence.strip() or "Traceback" in sentence or "object at 0x" in sentence:
            raise AssertionError(f"this is no sentence: {sentence!r}") from None
        return "refused"
    if parse_trial(trial_xml(trial), folder=folder) != trial:
        raise AssertionError("written and read again it is another trial")
    one = expand_sweeps(trial)[0]
    if one.people > MOST_PEOPLE or (one.capacity or 0) > MOST_PEOPLE:
        return "read"
    try:
        with open_run(one, out=folder / OUT) as running:
            for _ in range(STEPS):
                if running.outcome is None:
                    running.step()
    except CrowdbotError:
        return "read"
    return f"run in the {one.world} world"


class TooSlow(Exception):
    """A file took longer than the limit."""


def _late(number: int, frame: FrameType | None) -> None:
    raise TooSlow(f"more than {LIMIT} s")


def fuzz(files: Iterable[str], folder: Path, say=print) -> Counter[str]:
    """Judge files and return how many were refused, read, run, and wrong."""
    done: Counter[str] = Counter()
    for text in texts(new=True):  # kernels are compiled once, and that takes longer than any file may
        assert judged(text, folder).startswith("run")
        shutil.rmtree(folder / OUT)
    before = signal.signal(signal.SIGALRM, _late)
    slowest = 0.0
    try:
        for k, text in enumerate(files):
            begin = time.perf_counter()
            signal.alarm(LIMIT)
            try:
                done[judged(text, folder)] += 1
            except Exception:
                done["wrong"] += 1
                say(f"--- file {k}\n{text.encode('utf-8', 'replace').decode()}\n{traceback.format_exc()}")
            finally:
                signal.alarm(0)
            slowest = max(slowest, time.perf_counter() - begin)
            shutil.rmtree(folder / OUT, ignore_errors=True)
            if any(folder.iterdir()):
                raise AssertionError(f"file {k} wrote {sorted(folder.iterdir())}")
    finally:
        signal.signal(signal.SIGALRM, before)
    done["slowest_ms"] = round(slowest * 1e3)
    return done


def main() -> int:
    """Run and print the counts; status 1 when anything was wrong."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=2000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--new", action="store_true", help="only files with bodies, props, links and cameras")
    parser.add_argument("--ends", action="store_true", help="every number in turn next to nothing and huge")
    options = parser.parse_args()
    files = ends() if options.ends else drawn(options.count, options.seed, options.new)
    with tempfile.TemporaryDirectory() as folder:
        done = fuzz(files, Path(folder))
    print(dict(done))
    return 1 if done["wrong"] else 0


if __name__ == "__main__":
    sys.exit(main())
