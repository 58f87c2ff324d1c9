"""Check and rehearse a release.

``release.py check DIST``     checks wheel and sdist, and writes DIST/crowdbot-weights.zip
``release.py rehearse DIST``  installs the release from a package index in a temporary folder, as pip does from PyPI
``release.py wheels``         checks that every pinned dependency has a wheel for each system and Python version
"""

from __future__ import annotations

import argparse
import hashlib
import html
import json
import re
import subprocess
import sys
import tarfile
import tempfile
import tomllib
import venv
import zipfile
from pathlib import Path

from packaging.requirements import Requirement

ROOT = Path(__file__).parents[1]
LARGEST_WHEEL = 25e6
WEIGHTS = ROOT / "src" / "crowdbot" / "assets" / "predictors"
ARCHIVE = "crowdbot-weights.zip"
PLATFORMS = {
    "Linux": [f"manylinux_2_{minor}_x86_64" for minor in (28, 27, 26, 24, 17, 12, 5)] + ["manylinux2014_x86_64"],
    "Windows": ["win_amd64"],
    "macOS": [f"macosx_{major}_0_{chip}" for major in (14, 13, 12, 11) for chip in ("arm64", "universal2")],
}
"""Names of platforms that pip matches exactly; macOS means Apple silicon."""
MARKERS = {
    "Linux": {"sys_platform": "linux", "platform_machine": "x86_64"},
    "Windows": {"sys_platform": "win32", "platform_machine": "AMD64"},
    "macOS": {"sys_platform": "darwin", "platform_machine": "arm64"},
}
"""Environment of each system in the markers of dependencies."""
PYTHONS = ("3.11", "3.12", "3.13")
SOURCE_ONLY = {"rosbags", "pycollada"}
"""Pure Python packages that may lack a wheel; they build without a compiler."""


def main() -> int:
    """Run a command."""
    parser = argparse.ArgumentParser(description="check and rehearse a release")
    commands = parser.add_subparsers(dest="command", required=True)
    for name in ("check", "rehearse"):
        commands.add_parser(name).add_argument("dist", type=Path)
    commands.add_parser("wheels")
    options = parser.parse_args()
    if options.command == "wheels":
        return check_dependencies()
    return {"check": check, "rehearse": rehearse}[options.command](options.dist.resolve())


def project() -> dict[str, object]:
    """Return the table ``project`` of pyproject.toml."""
    return tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]


def built(dist: Path) -> tuple[Path, Path]:
    """Return the wheel and the sdist of the current version."""
    version = project()["version"]
    return dist / f"crowdbot-{version}-py3-none-any.whl", dist / f"crowdbot-{version}.tar.gz"


def check(dist: Path) -> int:
    """Check the content of wheel and sdist and the version in all files, and write the archive of the weights."""
    wheel, sdist = built(dist)
    with zipfile.ZipFile(wheel) as file:
        inside = set(file.namelist())
        hashes = file.read("crowdbot/assets/predictors/SHA256SUMS").decode()
    with tarfile.open(sdist) as file:
        sources = {name.partition("/")[2] for name in file.getnames()}
    names = [line.split(maxsplit=1)[1] for line in hashes.splitlines()]
    apart = [name for name in names if f"crowdbot/assets/predictors/{name}" not in inside]
    problems = [f"{wheel.name} has {wheel.stat().st_size} bytes"] if wheel.stat().st_size > LARGEST_WHEEL else []
    needed = needed_in_wheel(names)
    problems += [f"{wheel.name} has no {name}" for name in needed if name not in inside]
    problems += [f"{wheel.name} has {name}" for name in inside - set(needed) if name.startswith("crowdbot/")]
    problems += [f"{wheel.name} has {name}" for name in inside if re.search(r"__pycache__|\.py[co]$|^tests/", name)]
    problems += [f"{sdist.name} has no {name}" for name in tracked() if name not in sources]
    problems += assets_without_terms()
    problems += versions_that_differ(str(project()["version"]))
    write_weights(dist / ARCHIVE, apart)
    print(f"{wheel.name}: {wheel.stat().st_size / 1e6:.1f} MB, {len(inside)} files")
    print(f"{sdist.name}: {sdist.stat().st_size / 1e6:.1f} MB, {len(sources)} files")
    print(f"{ARCHIVE}: {(dist / ARCHIVE).stat().st_size / 1e6:.1f} MB, {len(apart)} files")
    print("".join(f"{problem}\n" for problem in problems), end="")
    return int(bool(problems))


def needed_in_wheel(weights: list[str]) -> list[str]:
    """Return what the wheel must have: every source and asset but the leave-one-out weights, and the licences."""
    version = project()["version"]
    shipped = {"anchor-net-open.npz", "anchors-open.npz", "social-ways-eth.npz"}
    apart = {f"crowdbot/assets/predictors/{name}" for name in weights if name not in shipped}
    package = {name.removeprefix("src/") for name in tracked() if name.startswith("src/crowdbot/")}
    licences = f"crowdbot-{version}.dist-info/licenses"
    return [*sorted(package - apart), f"{licences}/LICENSE", f"{licences}/src/crowdbot/assets/humans/LICENSE"]


def tracked() -> list[str]:
    """Return the files under version control but those about it."""
    run = subprocess.run(["git", "ls-files"], cwd=ROOT, capture_output=True, text=True, check=True)
    return [name for name in run.stdout.splitlines() if not name.startswith((".git",))]


def assets_without_terms() -> list[str]:
    """Return the files and folders of assets that LICENSE does not name."""
    text = (ROOT / "LICENSE").read_text("utf-8")
    assets = {"/".join(name.split("/")[:4]) for name in tracked() if name.startswith("src/crowdbot/assets/")}
    return [f"LICENSE does not name {name}" for name in sorted(assets) if name not in text]


def versions_that_differ(version: str) -> list[str]:
    """Return the files that name another version."""
    lines = {
        "CITATION.cff": f"version: {version}",
        ".zenodo.json": f'"version": "{version}"',
        "src/crowdbot/__init__.py": f'__version__ = "{version}"',
        "CHANGELOG.md": f"## {version}",
    }
    return [f"{name} lacks {line!r}" for name, line in lines.items() if line not in (ROOT / name).read_text("utf-8")]


def write_weights(path: Path, names: list[str]) -> None:
    """Write the archive of the weights that the wheel lacks; the same files give the same bytes."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_STORED) as file:
        for name in ["SHA256SUMS", *names]:
            file.writestr(zipfile.ZipInfo(name, (1980, 1, 1, 0, 0, 0)), (WEIGHTS / name).read_bytes())


def rehearse(dist: Path) -> int:
    """Upload wheel and sdist to a local index and install both from it by name."""
    with tempfile.TemporaryDirectory() as folder:
        index = make_index(Path(folder) / "simple", dist)
        for kind, option in (("wheel", "--only-binary"), ("sdist", "--no-binary")):
            place = Path(folder) / kind
            venv.create(place, with_pip=True)
            python = place / ("Scripts" if sys.platform == "win32" else "bin") / "python"
            words = ["-m", "pip", "install", "--quiet", "--no-deps", "--no-cache-dir", "--index-url", index.as_uri()]
            extra = ["--no-build-isolation"] if kind == "sdist" else []
            if extra:
                subprocess.run([python, "-m", "pip", "install", "--quiet", "setuptools>=77"], check=True)
            subprocess.run(
                [python, *words, option, "crowdbot", *extra, f"crowdbot=={project()['version']}"], check=True
            )
            show = "from importlib.metadata import version; print(version('crowdbot'))"
            run = subprocess.run([python, "-c", show], capture_output=True, text=True, check=True, cwd=folder)
            print(f"installed from the {kind} of a local index: crowdbot {run.stdout.strip()}")
    return 0


def make_index(folder: Path, dist: Path) -> Path:
    """Write a package index with the release (PEP 503) and return its folder."""
    page = folder / "crowdbot" / "index.html"
    page.parent.mkdir(parents=True)
    links = [
        f'<a href="{html.escape(path.as_uri())}#sha256={hashlib.sha256(path.read_bytes()).hexdigest()}">{path.name}</a>'
        for path in built(dist)
    ]
    page.write_text(f"<!DOCTYPE html><html><body>{'<br>'.join(links)}</body></html>", encoding="utf-8")
    return folder


def check_dependencies() -> int:
    """Ask the index for a wheel of every pinned dependency, for each system and Python version."""
    needs = [Requirement(line) for line in dependencies()]
    lines = (ROOT / "constraints.txt").read_text(encoding="utf-8").splitlines()
    missing = 0
    for system, platforms in PLATFORMS.items():
        here = [need for need in needs if need.marker is None or need.marker.evaluate(MARKERS[system])]
        wanted = {need.name.lower() for need in here}
        pins = [line for line in lines if line.partition("==")[0].lower() in wanted]
        for python in PYTHONS:
            lacking = [pin for pin in pins if not has_wheel(pin, platforms, python)]
            missing += len([pin for pin in lacking if pin.partition("==")[0] not in SOURCE_ONLY])
            print(
                f"{system:8s} Python {python}: {len(pins) - len(lacking)} of {len(pins)} wheels", *lacking, flush=True
            )
    return int(missing > 0)


def dependencies() -> list[str]:
    """Return what crowdbot needs with all extras of users."""
    table = project()
    extras: dict[str, list[str]] = table["optional-dependencies"]  # type: ignore[assignment]
    more = [need for name, needs in extras.items() if name not in ("all", "dev", "test") for need in needs]
    more = [need for need in more if not need.startswith("crowdbot[")]  # the former name of an extra
    return [*table["dependencies"], *more]  # type: ignore[misc]


def has_wheel(pin: str, platforms: list[str], python: str) -> bool:
    """Return whether the index has a wheel of a pinned package."""
    with tempfile.TemporaryDirectory() as folder:
        words = ["install", "--dry-run", "--quiet", "--ignore-installed", "--no-deps", "--only-binary=:all:"]
        words += [word for platform in platforms for word in ("--platform", platform)]
        words += ["--python-version", python, "--implementation", "cp", "--target", folder]
        words += ["--report", f"{folder}/report.json", pin]
        run = subprocess.run([sys.executable, "-m", "pip", *words], capture_output=True, text=True, check=False)
        return run.returncode == 0 and bool(
            json.loads(Path(folder, "report.json").read_text(encoding="utf-8"))["install"]
        )


if __name__ == "__main__":
    sys.exit(main())
