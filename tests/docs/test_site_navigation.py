"""Every page stands in the navigation of the site."""

import re

from pages import DOCS, ROOT


def test_every_page_is_in_the_navigation_once():
    listed = re.findall(r"^ +- (?:[^:\n]+: )?(\S+\.md)$", (ROOT / "mkdocs.yml").read_text(), flags=re.M)
    pages = {str(page.relative_to(DOCS)) for page in DOCS.rglob("*.md")}
    assert sorted(listed) == sorted(set(listed))
    assert pages - set(listed) == set()
