"""The site is built without a warning, loads nothing from outside, and every link leads somewhere (a sweep)."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest
from pages import ROOT

pytestmark = pytest.mark.sweep
LOADED = {"audio", "embed", "iframe", "img", "link", "object", "script", "source", "track", "video"}
"""Elements whose address is fetched when the page is read."""
OWNER = {"author", "canonical", "license", "next", "prev"}
"""Kinds of <link> that are not fetched."""


class Page(HTMLParser):
    """The addresses in one page: those that it loads, those that it links to, and its anchors."""

    def __init__(self, file: Path) -> None:
        super().__init__()
        self.loaded: list[str] = []
        self.links: list[str] = []
        self.anchors: set[str] = set()
        self.classes: set[str] = set()
        self.feed(file.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = {name: value or "" for name, value in attrs}
        self.anchors |= {values[name] for name in ("id", "name") if name in values}
        self.classes |= set(values.get("class", "").split()) | {values.get("data-md-component", "")}
        address = values.get("href") if tag in ("a", "link") else values.get("src", values.get("data"))
        if address is None:
            return
        if tag == "a":
            self.links.append(address)
        elif tag in LOADED and not set(values.get("rel", "").split()) & OWNER:
            self.loaded.append(address)


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Return the folder of the site, built as `make docs` does."""
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "--site-dir", str(folder)]
    done = subprocess.run(
        command, cwd=ROOT, capture_output=True, text=True, env={**os.environ, "NO_MKDOCS_2_WARNING": "1"}
    )
    assert done.returncode == 0, done.stderr
    return folder


@pytest.fixture(scope="module")
def pages(site: Path) -> dict[Path, Page]:
    """Return every page of the site."""
    return {file: Page(file) for file in site.rglob("*.html")}


def outside(address: str) -> bool:
    return bool(urlsplit(address).netloc)


def test_the_site_has_every_room_and_command(site: Path) -> None:
    from crowdbot.cli import COMMANDS

    assert {file.stem for file in (site / "reference" / "cli").glob("*.html")} == {*COMMANDS, "index"}
    assert {"core", "data", "models", "prediction", "world"} <= {
        file.stem for file in (site / "reference" / "api").glob("*.html")
    }


def test_nothing_is_loaded_from_outside(site: Path, pages: dict[Path, Page]) -> None:
    loaded = {address for page in pages.values() for address in page.loaded if outside(address)}
    assert loaded == set()
    for sheet in site.rglob("*.css"):
        text = sheet.read_text(encoding="utf-8")
        assert re.findall(r"(?:url\(|@import)\s*[\"']?(?:https?:)?//[^)\"']+", text) == [], sheet


def test_no_page_asks_for_what_the_theme_would_fetch(pages: dict[Path, Page]) -> None:
    """Material fetches its diagram library and the counts of a repository when a page has such an element."""
    seen = set().union(*(page.classes for page in pages.values()))
    assert "md-content" in seen
    assert not seen & {"mermaid", "source"}


def test_every_link_leads_somewhere(site: Path, pages: dict[Path, Page]) -> None:
    broken = []
    for file, page in pages.items():
        for address in [*page.links, *page.loaded]:
            parts = urlsplit(address)
            if parts.scheme or parts.netloc or file.name == "404.html":
                continue
            target = (file.parent / unquote(parts.path)).resolve() if parts.path else file
            target = target / "index.html" if target.is_dir() else target
            anchor = unquote(parts.fragment)
            if not target.is_file() or (anchor and target in pages and anchor not in pages[target].anchors):
                broken.append((str(file.relative_to(site)), address))
    assert broken == []
