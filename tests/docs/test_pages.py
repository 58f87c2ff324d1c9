"""The pages are true: their files, commands and Python blocks run in order, and print what the page shows."""

from __future__ import annotations

import doctest
import re
import shlex
import sys
from pathlib import Path

import pytest
from pages import DOCS, ROOT, Block, blocks

from crowdbot.cli import COMMANDS, main
from samples import sample

OWN_TEST = {"tutorials/first-trial.md", "tutorials/first-experiment.md"}
"""Pages that tests of their own follow, since a reader types or edits in between."""
PAGES = [str(page.relative_to(DOCS)) for page in sorted(DOCS.rglob("*.md"))]
RUN = [
    page
    for page in PAGES
    if page not in OWN_TEST and any(b.language == "python" or b.commands for b in blocks(DOCS / page))
]
SAMPLE = ["how-to/crowd-model.md", "tutorials/first-prediction.md"]
"""Pages that `make test` runs; the others are sweeps."""
LINK = re.compile(r"\]\(([^)#\s]+)")
CODE = re.compile(r"```.*?```|`[^`]*`", flags=re.S)
GENERATED = re.compile(r"reference/(?P<kind>api|cli)/(?P<name>[a-z._]+)\.md")
ELEMENTS = "reference/trial-elements.md"


@pytest.mark.parametrize("page", PAGES)
def test_every_link_of_a_page_leads_to_a_file(page: str) -> None:
    links = LINK.findall(CODE.sub("", (DOCS / page).read_text(encoding="utf-8")))
    targets = [((DOCS / page).parent / link).resolve() for link in links if "://" not in link]
    assert [str(target) for target in targets if not target.exists() and not generated(target)] == []


def generated(target: Path) -> bool:
    """Return whether the build of the site makes this page."""
    found = GENERATED.fullmatch(target.relative_to(DOCS).as_posix()) if target.is_relative_to(DOCS) else None
    if found is None:
        return target == DOCS / ELEMENTS
    if found["kind"] == "cli":
        return found["name"] in {*COMMANDS, "index"}
    return found["name"] == "index" or (ROOT / "src" / "crowdbot" / found["name"].replace(".", "/")).is_dir()


@pytest.mark.parametrize("page", sample(RUN, SAMPLE))
def test_a_page_runs_from_top_to_bottom(
    page: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.syspath_prepend(str(tmp_path))
    before = set(sys.modules)
    names: dict[str, object] = {"__name__": "page"}
    printed = ""
    for block in blocks(DOCS / page):
        if block.title:
            write(tmp_path / block.title, block.text)
        elif block.language == "python":
            capsys.readouterr()
            exec(compile(block.text, page, "exec"), names)
            printed = capsys.readouterr().out
        elif block.language == "text" and printed:
            assert same(block.text, printed), f"{page} shows\n{block.text}but this is printed:\n{printed}"
            printed = ""
        else:
            run(block)
    for name in set(sys.modules) - before:  # files of one page are no modules of the next
        if str(getattr(sys.modules[name], "__file__", "") or "").startswith(str(tmp_path)):
            del sys.modules[name]


def write(file: Path, text: str) -> None:
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(text, encoding="utf-8")


def run(block: Block) -> None:
    for command in block.commands:
        words = shlex.split(command)
        assert words[0] == "crowdbot", command
        assert main(words[1:]) == 0, command


def same(wanted: str, got: str) -> bool:
    return doctest.OutputChecker().check_output(wanted, got, doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE)


def test_every_section_of_the_site_has_pages() -> None:
    sections = {page.split("/")[0] for page in PAGES}
    assert {"tutorials", "how-to", "concepts", "results", "gallery", "reference", "about"} <= sections
    assert len(RUN) >= 15
