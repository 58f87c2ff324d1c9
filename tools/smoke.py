"""Try a built wheel in bare virtual environments: ``python tools/smoke.py DIST [--python 3.12 ...] [--extra sim]``.

Installs the wheel from DIST with each Python that is found and runs what a new user runs first: the command line, a
trial, its replay, predictions on a recording, and what happens without extras and without leave-one-out weights.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
import time
import zipfile
from pathlib import Path

ROOT = Path(__file__).parents[1]
PYTHONS = ("3.11", "3.12", "3.13")
LIMIT = 900.0


def main() -> int:
    """Try the wheel with every Python; return 1 if one fails."""
    parser = argparse.ArgumentParser(description="try a built wheel in bare virtual environments")
    parser.add_argument("dist", type=Path, help="folder of the wheel and of crowdbot-weights.zip")
    parser.add_argument("--python", nargs="+", default=PYTHONS, metavar="VERSION", help="default: 3.11 3.12 3.13")
    parser.add_argument("--extra", default="", metavar="NAME", help="extras to install with the wheel")
    parser.add_argument("--need", action="store_true", help="fail if one of the Pythons is not found")
    options = parser.parse_args()
    failed = 0
    for version in options.python:
        python = find_python(version)
        if python is None:
            print(f"Python {version}: not found")
            failed += options.need
            continue
        with tempfile.TemporaryDirectory() as folder:
            begin = time.monotonic()
            try:
                smoke(python, options.dist.resolve(), Path(folder), options.extra)
                print(f"Python {version}: passed in {time.monotonic() - begin:.0f} s", flush=True)
            except (AssertionError, subprocess.TimeoutExpired) as error:
                print(f"Python {version}: FAILED: {error}", flush=True)
                failed += 1
    return int(failed > 0)


def find_python(version: str) -> list[str] | None:
    """Return a command that runs this version of Python, or None."""
    home = os.environ.get("PYENV_ROOT", str(Path.home() / ".pyenv"))
    candidates = [[sys.executable], [f"python{version}"], ["py", f"-{version}"]]
    candidates += [[str(path)] for path in sorted(Path(home).glob(f"versions/{version}.*/bin/python"))]
    for command in candidates:
        if shutil.which(command[0]):
            show = "import sys; print('%d.%d' % sys.version_info[:2])"
            run = subprocess.run([*command, "-c", show], capture_output=True, text=True, check=False)
            if run.returncode == 0 and run.stdout.strip() == version:
                return command
    return None


def smoke(python: list[str], dist: Path, folder: Path, extra: str) -> None:
    """Install the wheel and run it.

    Raises:
        AssertionError: something does not work.
    """
    (wheel,) = dist.glob("crowdbot-*.whl")
    run([*python, "-m", "venv", folder / "venv"], folder)
    scripts = folder / "venv" / ("Scripts" if sys.platform == "win32" else "bin")
    pip = [scripts / "python", "-m", "pip", "install", "--quiet", "--disable-pip-version-check"]
    run([*pip, "-c", ROOT / "constraints.txt", f"{wheel}[{extra}]" if extra else wheel], folder)
    crowdbot = scripts / "crowdbot"
    assert "crowdbot" in run([crowdbot, "--version"], folder)
    assert "predict" in run([crowdbot, "--help"], folder)
    assert "orca" in run([crowdbot, "list", "models"], folder)
    try_python(scripts / "python", folder)
    try_trial(crowdbot, folder, physics="sim" in extra or "all" in extra)
    try_weights(crowdbot, folder, dist)


def try_python(python: Path, folder: Path) -> None:
    """Import the package where nothing else is, and step a crowd."""
    program = (
        "import crowdbot as cb\n"
        "scene = cb.Scene.of([[0.0, 0.0], [4.0, 0.1]], goal=[[4.0, 0.0], [0.0, 0.0]], preferred_speed=1.3)\n"
        "print(cb.ORCA().step(scene, dt=0.1).position.shape)\n"
    )
    assert "(1, 2, 2)" in run([python, "-W", "error", "-c", program], folder)


def try_trial(crowdbot: Path, folder: Path, physics: bool) -> None:
    """Run and replay a trial; without the extra, the physics world is refused in one sentence."""
    made = json.loads(run([crowdbot, "run", "frontal", "--seed", "1", "--out", folder / "one", "--json"], folder))
    assert made["digest"], made
    assert (folder / "one" / "episode.mcap").is_file(), made
    run([crowdbot, "replay", folder / "one" / "episode.mcap"], folder)
    words = [crowdbot, "run", "frontal", "--world", "physics", "--set", "duration=1", "--out", folder / "two"]
    if physics:
        run(words, folder)
    else:
        assert "pip install 'crowdbot[sim]'" in run(words, folder, status=2)


def try_weights(crowdbot: Path, folder: Path, dist: Path) -> None:
    """Predict a recording at a new place and one at a known place, without and with the leave-one-out weights."""
    rows = "".join(f"{10 * k}\t{who}\t{0.5 * k}\t{who}.0\n" for k in range(24) for who in range(1, 5))
    (folder / "street.txt").write_text(rows, encoding="utf-8")
    (folder / "biwi_hotel.txt").write_text(rows, encoding="utf-8")
    words = ["--predictor", "constant-velocity", "anchor-net", "--json"]
    assert "anchor-net" in run([crowdbot, "predict", "--data", folder / "street.txt", *words], folder)
    hotel = [crowdbot, "predict", "--data", folder / "biwi_hotel.txt", *words]
    assert "anchor-net-hotel.npz is not installed" in run(hotel, folder, status=2)
    with zipfile.ZipFile(dist / "crowdbot-weights.zip") as file:
        file.extractall(folder / "weights")
    assert "anchor-net" in run(hotel, folder, CROWDBOT_WEIGHTS=str(folder / "weights"))


def run(words: list[object], folder: Path, status: int = 0, **variables: str) -> str:
    """Return what a command prints; without the sources and the settings of the developer.

    Raises:
        AssertionError: it ends with another exit status.
    """
    names = ("PYTHONPATH", "CROWDBOT_CACHE", "CROWDBOT_SHARED", "CROWDBOT_WEIGHTS", "XDG_DATA_HOME")
    environment = {name: value for name, value in os.environ.items() if name not in names}
    environment |= {"CROWDBOT_CACHE": str(folder / "cache"), "PYTHONUTF8": "1", **variables}
    done = subprocess.run(
        list(map(str, words)), capture_output=True, text=True, cwd=folder, env=environment, timeout=LIMIT, check=False
    )
    shown = " ".join(Path(str(word)).name for word in words)
    assert done.returncode == status, f"`{shown}` ended with {done.returncode}: {done.stderr.strip()[-2000:]}"
    return done.stdout + done.stderr if status else done.stdout


if __name__ == "__main__":
    sys.exit(main())
