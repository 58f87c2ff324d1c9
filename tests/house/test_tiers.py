"""The border between the tiers of tests: what the guard of the gate refuses, and what `make live` makes of failures."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tools"))

import failed_tests  # noqa: E402
import live  # noqa: E402

CONFTEST = """
from gate_guard import GateGuard
def pytest_configure(config):
    config.pluginmanager.register(GateGuard())
    for name in ("live", "program", "sweep", "soak"):
        config.addinivalue_line("markers", name)
"""
SAMPLES = """
import multiprocessing, os, socket, subprocess, sys, threading, time
import pytest
RUN = [sys.executable, "-c", "pass"]
def test_computes(): time.sleep(0.01)
def test_process(): subprocess.run(RUN)
@pytest.mark.program
def test_process_that_says_so(): subprocess.run(RUN)
def test_copy():
    if not (child := os.fork()): os._exit(0)
    os.waitpid(child, 0)
def test_worker():
    multiprocessing.get_context("spawn").Process(target=print).start()
@pytest.mark.program
def test_sleep(): time.sleep(0.11)
@pytest.mark.program
def test_port():
    with socket.socket() as one: one.bind(("127.0.0.1", 0))
def test_port_in_a_thread():
    thread = threading.Thread(target=test_port)
    thread.start()
    thread.join()
@pytest.fixture
def sender():
    with socket.socket(type=socket.SOCK_DGRAM) as one: one.sendto(b"1", ("127.0.0.1", 9))
def test_network_of_a_fixture(sender): pass
@pytest.fixture(scope="module")
def shared(): subprocess.run(RUN)
@pytest.mark.live
def test_first_user_of_a_fixture(shared): pass
def test_second_user_of_a_fixture(shared): pass
def test_third_user_of_a_fixture(shared): pass
def test_local_pair(): socket.socketpair()
@pytest.mark.live
def test_real_time(): subprocess.run(RUN), time.sleep(0.11), test_port()
@pytest.mark.sweep
def test_long(): time.sleep(0.11)
"""
NEEDS = {
    "test_process": ("program", "subprocess.Popen"),
    "test_copy": ("program", "os.fork"),
    "test_worker": ("program", "a process of multiprocessing"),
    "test_sleep": ("live", "time.sleep(0.11)"),
    "test_port": ("live", "socket.bind ('127.0.0.1', 0)"),
    "test_port_in_a_thread": ("live", "socket.bind ('127.0.0.1', 0)"),
    "test_second_user_of_a_fixture": ("program", "subprocess.Popen"),
    "test_third_user_of_a_fixture": ("program", "subprocess.Popen"),
    "test_network_of_a_fixture": ("live", "socket.sendto ('127.0.0.1', 9)"),
}


@pytest.mark.program
def test_a_test_that_depends_on_the_machine_fails_with_the_marker_that_it_lacks(tmp_path):
    (tmp_path / "conftest.py").write_text(CONFTEST)
    (tmp_path / "test_samples.py").write_text(SAMPLES)
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "-p", "no:randomly", str(tmp_path)]
    done = subprocess.run(
        command, cwd=tmp_path, capture_output=True, text=True, env={"PYTHONPATH": str(ROOT / "tests"), "PATH": ""}
    )
    told = {}
    for line in done.stdout.splitlines():
        if line.startswith("____"):
            name = line.strip("_ ")
        elif line.startswith("a test of the gate needs"):
            told[name] = line
    assert set(told) == set(NEEDS), done.stdout + done.stderr
    for name, (marker, what) in NEEDS.items():
        assert told[name].startswith(f"a test of the gate needs @pytest.mark.{marker} for this: {what}")
        assert told[name].endswith("(see CONTRIBUTING.md, Tiers of tests)")
    assert "9 failed, 6 passed" in done.stdout


GROUPS = """
import os, pytest
@pytest.fixture(scope="module")
def process(): return os.getpid()
@pytest.mark.parametrize("k", range(8))
def test_process(k, process, request):
    with open(request.fspath.dirpath("processes"), "a") as file: print(request.fspath.purebasename, process, file=file)
"""


@pytest.mark.program
def test_the_live_tests_of_a_file_run_in_one_process_and_so_do_those_of_a_group(tmp_path):
    (tmp_path / "conftest.py").write_text(CONFTEST)
    for name in ("alone", "first", "second"):
        mark = "import pytest\npytestmark = [pytest.mark.xdist_group('pair')]\n" if name != "alone" else ""
        (tmp_path / f"test_{name}.py").write_text(mark + GROUPS)
    words = ["-q", "-p", "no:cacheprovider", "-p", "no:randomly", "-n", "2", "--dist", "loadfile", str(tmp_path)]
    done = subprocess.run(
        [sys.executable, "-m", "pytest", *words],
        cwd=tmp_path, capture_output=True, text=True, env={"PYTHONPATH": str(ROOT / "tests"), "PATH": ""},
    )  # fmt: skip
    assert "24 passed" in done.stdout, done.stdout + done.stderr
    lines = set((tmp_path / "processes").read_text().splitlines())
    assert len(lines) == 3
    processes = dict(line.split() for line in lines)
    assert processes["test_first"] == processes["test_second"] != processes["test_alone"]


HIDDEN = {
    "from marks import real\n@real\ndef test_x(): pass\n":
        "make live would miss test_hidden.py::test_x: test_hidden.py has neither @pytest.mark.live nor one of browser",
    "import pytest\n@pytest.mark.xdist_group('pair')\ndef test_x(): pass\n":
        "the group of test_hidden.py::test_x has no effect: give it to the file, as pytestmark",
}  # fmt: skip


@pytest.mark.program
@pytest.mark.parametrize("text", HIDDEN)
def test_a_marker_that_is_not_seen_in_the_text_of_a_file_stops_the_run(tmp_path, text):
    (tmp_path / "conftest.py").write_text(CONFTEST)
    (tmp_path / "marks.py").write_text("import pytest\nreal = pytest.mark.live\n")
    (tmp_path / "test_hidden.py").write_text(text)
    command = [sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", "--collect-only", str(tmp_path)]
    done = subprocess.run(
        command, cwd=tmp_path, capture_output=True, text=True, env={"PYTHONPATH": str(ROOT / "tests"), "PATH": ""}
    )
    assert done.returncode == pytest.ExitCode.USAGE_ERROR
    assert HIDDEN[text] in done.stderr


def test_make_live_collects_the_files_that_may_hold_live_tests(monkeypatch, tmp_path):
    monkeypatch.setattr(live, "ROOT", tmp_path)
    texts = {
        "test_marked.py": "@pytest.mark.live\ndef test_x(): pass",
        "web/test_page.py": "def test_x(tmp_path,\n           page): pass",
        "web/test_text.py": "def test_x():\n    assert 'page' in 'browser page'",
    }
    for name, text in texts.items():
        (tmp_path / "tests" / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / "tests" / name).write_text(text)
    assert live.live_files(["tests"]) == ["tests/test_marked.py", "tests/web/test_page.py"]
    assert live.live_files(["tests/web", "tests/test_marked.py::test_x"]) == [
        "tests/web/test_page.py", "tests/test_marked.py::test_x",
    ]  # fmt: skip


@pytest.fixture
def runs(monkeypatch, tmp_path):
    """The words of the runs of pytest; ``failed`` fail together, ``alone`` also when they are repeated."""
    seen = []

    def start(failed, alone):
        def run_tests(cache, words):
            seen.append((cache, *words))
            return int(bool(failed) if cache == "live" else words[-1] in alone)

        monkeypatch.setattr(live, "run_tests", run_tests)
        monkeypatch.setattr(live, "failed_tests", lambda tier: failed)
        for module in (live, failed_tests):
            monkeypatch.setattr(module, "REPORT", tmp_path / "live.json")
        monkeypatch.setattr(live, "commit", lambda: "abc")
        monkeypatch.setattr(sys, "argv", ["live.py", "tests/web/test_vr_page.py"])
        return live.main()

    return start, seen


@pytest.mark.parametrize(
    ("failed", "alone", "status"), [([], [], 0), (["a", "b"], [], 0), (["a", "b"], ["b"], 1), (["a"], ["a"], 1)]
)
def test_a_live_test_counts_as_failed_if_it_fails_twice(runs, capsys, failed, alone, status):
    start, seen = runs
    assert start(failed, alone) == status
    assert [words[0] for words in seen] == ["live"] + ["repeat"] * len(failed)
    assert seen[0][-1] == "tests/web/test_vr_page.py"
    report = json.loads(live.REPORT.read_text())
    assert report["repeats"] == [{"test": name, "passed": name not in alone} for name in failed]
    assert report["commit"] == "abc"
    assert failed_tests.failed_twice() == alone
    printed = capsys.readouterr().out
    for name in failed:
        assert f"live: {name} failed once and {'failed' if name in alone else 'passed'} alone" in printed


def test_a_run_that_did_not_end_is_a_failure(runs, monkeypatch):
    runs[0]([], [])
    monkeypatch.setattr(live, "run_tests", lambda cache, words: 3)
    assert live.main() == 3
    assert not live.REPORT.exists()


def test_the_failed_tests_are_named(monkeypatch, tmp_path, capsys):
    for module in (live, failed_tests):
        monkeypatch.setattr(module, "ROOT", tmp_path)
        monkeypatch.setattr(module, "REPORT", tmp_path / "live.json")
    failed_tests.main()
    assert capsys.readouterr().out == "no test failed: the error is in an earlier line\n"
    cache = tmp_path / failed_tests.CACHES["gate"] / "v" / "cache"
    cache.mkdir(parents=True)
    (cache / "lastfailed").write_text('{"tests/b.py::test_two": true, "tests/a.py::test_one[x]": true}')
    (tmp_path / "live.json").write_text('{"repeats": [{"test": "c", "passed": false}, {"test": "d", "passed": true}]}')
    failed_tests.main()
    assert capsys.readouterr().out.splitlines() == [
        "make test: tests/a.py::test_one[x] failed",
        "make test: tests/b.py::test_two failed",
        "make live: c failed",
    ]
