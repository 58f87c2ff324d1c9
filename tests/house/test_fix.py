"""`make fix` writes the generated files, tells what it changed, and protects results that are kept."""

import re
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
sys.path.insert(0, str(ROOT / "tools"))

import fix  # noqa: E402


@pytest.fixture
def tree(monkeypatch, tmp_path):
    """A folder with a file; one step writes it anew, one finds it right, one fails, one lacks something."""

    def write(name, text):
        (tmp_path / name).write_text(text)

    def fail():
        write("a.txt", "half")
        raise fix.StepFailure("no model of that name")

    def lack():
        raise fix.LeftOut("no libraries")

    steps = (
        fix.Step("table", "a table", ("*.txt",), lambda: [write("a.txt", "new"), write("b.txt", "more")]),
        fix.Step("same", "a page", ("*.txt",), lambda: None),
        fix.Step("broken", "a page", ("*.txt",), fail),
        fix.Step("bundle", "a bundle", ("*.js",), lack),
    )
    monkeypatch.setattr(fix, "ROOT", tmp_path)
    monkeypatch.setattr(fix, "STEPS", steps)
    write("a.txt", "old")
    return tmp_path


def test_a_step_that_fails_does_not_stop_the_others(tree, capsys):
    assert fix.main([]) == 1
    printed = re.sub(r" +\d+\.\d s", " 0 s", capsys.readouterr().out).splitlines()
    assert printed[:3] == ["table 0 s  changed 2", "    a.txt", "    b.txt"]
    assert printed[3] == "same 0 s  nothing to change"
    assert printed[4] == "broken 0 s  FAILED: no model of that name"
    assert printed[6] == "bundle 0 s  left out: no libraries"
    assert printed[-2:] == ["fix: changed: table, broken", "fix: failed: broken"]
    assert (tree / "b.txt").read_text() == "more"


def test_steps_are_chosen_by_name(tree, capsys):
    assert fix.main(["same", "bundle"]) == 0
    assert (tree / "a.txt").read_text() == "old"
    with pytest.raises(SystemExit):
        fix.main(["tabel"])
    assert "no step is called tabel; the steps are table, same" in capsys.readouterr().err


def test_a_check_fails_and_leaves_the_tree_as_it_was(tree, capsys):
    assert fix.main(["--check", "table"]) == 1
    assert {file.name: file.read_text() for file in tree.iterdir()} == {"a.txt": "old"}
    assert "fix: would change: table" in capsys.readouterr().out
    assert fix.main(["--check", "same"]) == 0


def test_a_check_that_is_interrupted_leaves_the_tree_as_it_was(tree, monkeypatch):
    def stop():
        (tree / "a.txt").unlink()
        raise KeyboardInterrupt

    monkeypatch.setattr(fix, "STEPS", (fix.Step("slow", "a page", ("*.txt",), stop),))
    assert fix.main(["--check"]) == 130
    assert (tree / "a.txt").read_text() == "old"


def test_kept_results_are_written_only_if_they_are_missing(tree, monkeypatch):
    started = []
    monkeypatch.setattr(fix, "command", lambda *words: started.append(words))
    fix.write_if_missing("a.txt", "tools/golden.py")
    assert started == []
    (tree / "a.txt").unlink()
    fix.write_if_missing("a.txt", "tools/golden.py")
    assert started == [("tools/golden.py",)]


def test_constraints_are_added_and_never_changed(tree, monkeypatch):
    import pin

    (tree / "constraints.txt").write_text("# head\nnumpy==1.0\n")
    monkeypatch.setattr(pin, "pinned", lambda: {"attrs": "3.1", "numpy": "2.0"})
    fix.add_constraints()
    assert (tree / "constraints.txt").read_text() == "# head\nattrs==3.1\nnumpy==1.0\n"


def test_the_version_of_the_package_is_written_to_its_copies(tree):
    package = tree / "src" / "crowdbot"
    package.mkdir(parents=True)
    (package / "__init__.py").write_text('__version__ = "0.3.0"\n')
    (tree / "pyproject.toml").write_text('[project]\nversion = "0.2.0"\n')
    (tree / "CITATION.cff").write_text("cff-version: 1.2.0\nversion: 0.2.0\n")
    (tree / ".zenodo.json").write_text('{"version": "0.2.0"}')
    fix.write_versions()
    texts = [(tree / name).read_text() for name in ("pyproject.toml", "CITATION.cff", ".zenodo.json")]
    assert texts == ['[project]\nversion = "0.3.0"\n', "cff-version: 1.2.0\nversion: 0.3.0\n", '{"version": "0.3.0"}']
    (tree / ".zenodo.json").write_text("{}")
    with pytest.raises(fix.StepFailure, match=r"\.zenodo\.json has 0 places"):
        fix.write_versions()


def test_every_page_that_says_it_is_generated_has_a_step_or_a_long_command():
    pages = {path.relative_to(ROOT).as_posix(): path for path in (ROOT / "docs").rglob("*.md")}
    said = re.compile(r"is generated[: ]|made from the code by|makes the pictures and this page")
    generated = {name for name, path in pages.items() if said.search(path.read_text(encoding="utf-8")[:1500])}
    written = {name for step in fix.STEPS for name in step.writes}
    assert len(generated) > 5
    assert generated <= written | fix.LONG.keys()
    assert fix.LONG.keys() <= pages.keys()


def test_every_pattern_of_a_step_names_files():
    missing = [p for step in fix.STEPS for p in step.writes if "golden" not in step.name and not list(ROOT.glob(p))]
    assert missing == []


def test_the_gallery_lists_the_trials_of_today(tmp_path):
    import trial_pictures

    trial_pictures.page(tmp_path / "trials.md")
    kept = (ROOT / "docs" / "gallery" / "trials.md").read_text(encoding="utf-8")
    assert (tmp_path / "trials.md").read_text(encoding="utf-8") == kept, "run make fix"


def test_digests_of_trials_that_are_gone_are_dropped_and_others_stay(monkeypatch, tmp_path):
    import json

    import builtin_digests

    file = tmp_path / "digests.json"
    row = {"digest": dict.fromkeys(builtin_digests.LEVELS, "ab"), "outcome": "timeout", "steps": 3, "state": [1.0]}
    other = {**builtin_digests.machine(), "libc": "other"}
    keys = [f"one/{form}" for form in builtin_digests.FORMS]
    file.write_text(json.dumps({"machine": other, "runs": dict.fromkeys([*keys, "gone/planar/0/2"], row)}))
    monkeypatch.setattr(builtin_digests, "builtin_trials", lambda: ["one"])
    builtin_digests.write(file)
    assert json.loads(file.read_text()) == {"machine": other, "runs": dict.fromkeys(keys, row)}
    monkeypatch.setattr(builtin_digests, "builtin_trials", lambda: ["one", "two"])
    with pytest.raises(
        SystemExit, match=r"3 runs are missing, and the others are of another machine: libc \S.* instead of other"
    ):
        builtin_digests.write(file)
