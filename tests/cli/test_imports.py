"""Commands that print names import no more than they need."""

import subprocess
import sys

import pytest

from crowdbot import trials
from crowdbot.trials import PRESETS, builtin_trials, load_trial, trial_titles

HEAVY = ("scipy", "shapely", "PIL", "numba", "matplotlib", "pandas", "h5py", "mujoco", "torch", "urllib.request")
UNBUILT = (
    "crowdbot.trials.trial",
    "crowdbot.trials.parser",
    "crowdbot.trials.scenarios",
    "crowdbot.models",
    "crowdbot.sensors",
    "crowdbot.world",
    "crowdbot.navigation",
    "crowdbot.simulation",
)


def imported(*words: str) -> set[str]:
    """Return the modules that a command imports."""
    code = (
        "import contextlib, io, sys\n"
        "from crowdbot.cli import main\n"
        "with contextlib.redirect_stdout(io.StringIO()), contextlib.suppress(SystemExit):\n"
        "    main(sys.argv[1:])\n"
        "print(*sorted(sys.modules))"
    )
    done = subprocess.run([sys.executable, "-c", code, *words], capture_output=True, text=True, check=True)
    return set(done.stdout.split())


@pytest.mark.program
@pytest.mark.parametrize("words", [("list", "trials"), ("list", "trials", "--json"), ("--help",), ("--version",)])
def test_names_are_printed_without_importing_what_they_name(words: tuple[str, ...]) -> None:
    modules = imported(*words)
    assert "crowdbot.cli" in modules
    assert modules & {*HEAVY, *UNBUILT} == set()


@pytest.mark.program
@pytest.mark.parametrize("word", ["--help", "--version"])
def test_help_and_version_do_not_import_numpy(word: str) -> None:
    assert modules_of_numpy(imported(word)) == set()


@pytest.mark.program
def test_a_trial_without_tracked_people_loads_no_tracker() -> None:
    modules = imported("check", "crossing-flows")
    assert {"crowdbot.trials.robot", "crowdbot.navigation"} <= modules
    assert modules & {"crowdbot.perception.trackers", "crowdbot.calibration"} == set()


@pytest.mark.program
def test_the_app_starts_without_what_its_results_need() -> None:
    code = "import sys\nfrom crowdbot.vr import *\nfrom crowdbot.web import *\nprint(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    modules = set(done.stdout.split())
    assert {"crowdbot.web.app_server", "crowdbot.vr.vr_server"} <= modules
    assert modules & {"scipy.stats", "scipy.optimize", "matplotlib", "pandas", "h5py", "mujoco", "torch"} == set()


def modules_of_numpy(modules: set[str]) -> set[str]:
    """Return the modules of NumPy and of the core room."""
    return {name for name in modules if name.split(".")[0] == "numpy" or name.startswith("crowdbot.core")}


def test_titles_are_those_of_the_trials() -> None:
    titles = trial_titles()
    assert tuple(titles) == builtin_trials()
    assert set(PRESETS) <= set(titles)
    for name, title in titles.items():
        assert title == (PRESETS[name].about if name in PRESETS else load_trial(name).about)
        assert title


def test_every_public_name_of_trials_is_found() -> None:
    for name in trials.__all__:
        assert getattr(trials, name) is not None
    assert set(trials.__all__) <= set(dir(trials))
    with pytest.raises(AttributeError, match="module 'crowdbot.trials' has no attribute 'Trail'"):
        _ = trials.Trail
