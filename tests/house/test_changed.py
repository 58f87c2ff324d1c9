"""`make test-changed` runs the tests that call what changed, within a time, and says what it leaves out."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tools"))

import calls  # noqa: E402
import changed  # noqa: E402

SOURCE = '''"""Doc."""
import functools
# a comment

LIMIT = 3


@functools.cache
def table():
    return 1


class Car:
    wheels: int = 4

    def drive(self):
        """Drive."""
        def turn():
            return table()
        return turn()


def park(car,
         place=2):
    return car
'''
OTHER = """from .car import table
def drawn(): return table()
"""


def line(text, source=SOURCE):
    return source.splitlines().index(text) + 1


@pytest.mark.parametrize(
    ("text", "name"),
    [
        ("    return 1", "table"),
        ("@functools.cache", "table"),
        ("    wheels: int = 4", "Car"),
        ("            return table()", "Car.drive.<locals>.turn"),
        ("        return turn()", "Car.drive"),
        ("         place=2):", "park"),
        ("LIMIT = 3", None),
    ],
)
def test_a_line_belongs_to_the_innermost_function_or_class(text, name):
    found = calls.place_at(SOURCE, line(text))
    assert (found and found.name) == name


def test_names_are_those_that_python_gives():
    scope = {}
    exec(SOURCE, scope)
    assert scope["Car"].drive.__code__.co_qualname == "Car.drive"
    inner = next(constant for constant in scope["Car"].drive.__code__.co_consts if hasattr(constant, "co_qualname"))
    assert inner.co_qualname == calls.place_at(SOURCE, line("            return table()")).name


def test_only_lines_in_a_body_count_for_a_changed_constant():
    assert calls.function_body_at(SOURCE, line("         place=2):")) == ""
    assert calls.function_body_at(SOURCE, line("    return car")) == "park"
    assert calls.function_body_at(SOURCE, line("    wheels: int = 4")) == ""


def test_texts_imports_and_empty_lines_change_nothing():
    idle = calls.idle_lines(SOURCE)
    for text in ('"""Doc."""', "import functools", "# a comment", "", '        """Drive."""'):
        assert line(text) in idle
    assert idle.isdisjoint({line("LIMIT = 3"), line("    return 1"), line("@functools.cache")})


def test_who_mentions_a_function_that_the_records_lack_counts_as_its_caller(tmp_path):
    (tmp_path / "car.py").write_text(SOURCE)
    (tmp_path / "other.py").write_text(OTHER)
    (tmp_path / "foreign.py").write_text("def table(): return table\n")
    place = next(place for place in calls.places(SOURCE) if place.name == "table")
    assert place.hidden
    mentions = calls.mentions(tmp_path, "car.py", place)
    assert mentions == {("car.py", "Car.drive.<locals>.turn"), ("other.py", "drawn")}


def test_tests_fit_into_a_time():
    seconds = {"a": 2.0, "b": 9.0, "c": 1.0}
    assert calls.within("abc", seconds, 5.0) == ["a"]
    assert calls.within("acb", seconds, 5.0) == ["a", "c"]
    assert calls.within("b", seconds, 5.0) == ["b"]


DIFF = """diff --git a/src/a.py b/src/a.py
index 1..2 100644
--- a/src/a.py
+++ b/src/a.py
@@ -3,2 +3 @@ def one():
-old
-old
+new
@@ -9 +8,3 @@
-old
+new
@@ -20,2 +21,0 @@
-old
-old
diff --git a/gone.py b/gone.py
deleted file mode 100644
--- a/gone.py
+++ /dev/null
@@ -1 +0,0 @@
-x
"""


def test_lines_of_a_diff():
    assert changed.lines_of_diff(DIFF) == {"src/a.py": {3, 8, 9, 10, 21, 22}, "gone.py": {1}}


@pytest.fixture
def tree(monkeypatch, tmp_path):
    """A package of one room with three test files, of which two have a record."""
    files = {
        "src/crowdbot/cars/car.py": SOURCE,
        "src/crowdbot/cars/other.py": OTHER,
        "tests/cars/test_car.py": "",
        "tests/cars/test_new.py": "from garage import build\n",
        "tests/cars/garage.py": "",
        "tests/boats/test_boat.py": "",
        "tests/house/test_rules.py": "",
    }
    for name, text in files.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    monkeypatch.setattr(changed, "ROOT", tmp_path)
    record(["cars/car.py:park"], "tests/cars/test_car.py::test_park", 2.0)
    record(["cars/car.py:Car.drive"], "tests/boats/test_boat.py::test_drive", 4.0)
    record(["cars/other.py:drawn"], "tests/house/test_rules.py::test_rules", 1.0)
    return tmp_path


def record(names, test, seconds, starts=False):
    file = test.split("::")[0]
    known = changed.load_record(file)
    one = {"passed": True, "seconds": seconds, "starts": starts, "calls": set(names)}
    changed.store_record(file, (known[1] if known else {}) | {test: one})


CAR = "src/crowdbot/cars/car.py"
RULES, DRIVE = "tests/house/test_rules.py::test_rules", "tests/boats/test_boat.py::test_drive"
PARK = "tests/cars/test_car.py::test_park"


@pytest.mark.parametrize(
    ("text", "tests"),
    [
        ("    return car", {PARK, RULES}),
        ("        return turn()", {DRIVE, RULES}),
        ("    wheels: int = 4", {DRIVE, RULES}),
        ("LIMIT = 3", {PARK, DRIVE, RULES}),
        ("# a comment", {RULES}),
    ],
)
def test_tests_that_call_what_changed_are_chosen(tree, text, tests):
    choice = changed.choose({CAR: {line(text)}}, 100.0)
    assert set(choice.tests) == tests
    assert choice.files == ["tests/cars/test_new.py"]  # has no record, and its room has changed
    assert "1 test files have no record" in choice.notes[-1]


def test_the_output_says_what_is_not_in_the_records(tree):
    choice = changed.choose({CAR: {line("            return table()")}, "docs/index.md": {1}}, 100.0)
    assert set(choice.tests) == {PARK, DRIVE, RULES}
    assert "cars/car.py:Car.drive.<locals>.turn is in no record; 2 tests call something in its file" in choice.notes
    assert choice.notes[-1] == "of 1 other files no tests are known: docs/index.md"


def test_the_shortest_tests_are_chosen_and_the_others_are_counted(tree):
    choice = changed.choose({CAR: {line("LIMIT = 3")}}, 1.6)
    assert choice.tests == [RULES, PARK]
    assert "2 tests are chosen by their records (2 s), 1 more are left out by the budget of 1.6 s" in choice.notes


def test_changed_test_files_and_users_of_changed_helpers_run_whole_and_first(tree):
    choice = changed.choose({"tests/cars/garage.py": {1}, "tests/cars/test_car.py": {1}}, 100.0)
    assert sorted(choice.first) == ["tests/cars/test_car.py", "tests/cars/test_new.py"]
    assert choice.tests == [RULES]
    assert choice.files == []


def test_a_conftest_concerns_its_folder_and_that_of_all_tests_is_named(tree):
    assert changed.choose({"tests/boats/conftest.py": {1}}, 100.0).first == []  # it is gone
    (tree / "tests/boats/conftest.py").write_text("")
    (tree / "tests/conftest.py").write_text("")
    choice = changed.choose({"tests/boats/conftest.py": {1}, "tests/conftest.py": {1}}, 100.0)
    assert choice.first == ["tests/boats/test_boat.py"]
    assert "tests/conftest.py concerns all tests; none of them run for it" in choice.notes


def test_tests_that_start_processes_count_in_their_room(tree):
    record([], "tests/cars/test_car.py::test_command", 1.0, starts=True)
    record([], "tests/boats/test_boat.py::test_command", 1.0, starts=True)
    choice = changed.choose({CAR: {line("    return car")}}, 100.0)
    assert set(choice.tests) == {PARK, RULES, "tests/cars/test_car.py::test_command"}


def test_a_module_that_is_gone_concerns_all_its_callers(tree):
    (tree / CAR).unlink()
    assert {PARK, DRIVE} <= set(changed.choose({CAR: set()}, 100.0).tests)


def test_a_source_that_is_no_python_is_named(tree):
    (tree / CAR).write_text("def f(:\n")
    with pytest.raises(SystemExit, match=r"changed: src/crowdbot/cars/car\.py is no Python, line 1"):
        changed.choose({CAR: {1}}, 100.0)


def test_only_old_records_are_made_again(tree, monkeypatch, capsys):
    started = []

    def run(plan, words):
        started.append(words[-1])
        test = f"{words[-1]}::test_one"
        text = json.dumps({test: {"passed": True, "seconds": 1.0, "starts": False, "calls": ["cars/car.py:park"]}})
        Path(plan["out"]).write_text(text, encoding="utf-8")
        return 0

    monkeypatch.setattr(changed, "run_pytest", run)
    monkeypatch.setattr(changed, "CHUNK", 1)
    assert changed.main(["--record"]) == 0
    assert started == ["tests/cars/test_new.py"]
    (tree / CAR).write_text(SOURCE + "\n")
    started.clear()
    assert changed.main(["--record", "tests/cars", "tests/house"]) == 0
    assert started == ["tests/cars/test_car.py", "tests/cars/test_new.py"]
    assert "3 test files, 1 have a record that is up to date" in capsys.readouterr().out
    monkeypatch.setattr(changed, "run_pytest", lambda plan, words: 1)
    (tree / "tests/cars/test_new.py").write_text("broken")
    assert changed.main(["--record"]) == 1
    assert "tests/cars/test_new.py is not recorded" in capsys.readouterr().out


SAMPLES = """
import time, pytest, made
@pytest.fixture(scope="module")
def car(): return made.build()
def test_first(car): assert car
def test_second(car): assert [made.wheel() for _ in "ab"]
def test_third(): pass
"""
MADE = """
def build(): return 1
def wheel(): return 2
"""


@pytest.mark.program
def test_the_recorder_notes_calls_and_runs_chosen_tests_until_the_time_is_over(tmp_path):
    (tmp_path / "src").mkdir()
    (tmp_path / "src" / "made.py").write_text(MADE)
    (tmp_path / "test_samples.py").write_text(SAMPLES)
    out = tmp_path / "out.json"

    def run(plan):
        (tmp_path / "plan.json").write_text(json.dumps(plan))
        paths = [str(ROOT / "tools"), str(tmp_path / "src")]
        environment = os.environ | {"PYTHONPATH": os.pathsep.join(paths), "CALL_RECORDER": str(tmp_path / "plan.json")}
        command = [sys.executable, "-m", "pytest", "-v", "-p", "no:cacheprovider", "-p", "call_recorder", "."]
        return subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, env=environment).stdout

    run({"sources": f"{tmp_path}/src/", "out": str(out), "seconds": 60.0, "total": 1e9})
    found = {test.split("::")[1]: record["calls"] for test, record in json.loads(out.read_text()).items()}
    assert found["test_first"] == ["made.py:build"]
    assert found["test_second"] == ["made.py:build", "made.py:wheel"]
    assert found["test_third"] == []
    chosen = ["test_samples.py::test_third", "test_samples.py::test_first"]
    printed = run({"tests": chosen})
    assert printed.index("test_third PASSED") < printed.index("test_first PASSED")
    assert "test_second" not in printed
    assert "3 passed" in run({"tests": ["test_samples.py"], "until": 600.0})
    assert "3 tests left out: -1 s are over" in run({"tests": ["test_samples.py"], "until": -1.0})
