"""The documentation: it builds without a warning, and every link in it leads somewhere."""

from __future__ import annotations

import re
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote

import pytest

from tests.project.test_architecture import layer
from tests.worlds.files.checkout import ROOT
from tests.worlds.files.documents import DOCUMENTS, anchors, links, name_of

MENU = {"index", "installation", "usage", "architecture", "adding", "contributing", "physics", "gallery/README"}
CODE_WIDTH = 92  # characters that the column of the site holds
DRAWING = "docs/architecture.svg"


def dead_links(path: Path) -> list[str]:
    """Links of a document to files or headings that do not exist."""
    dead = []
    for link in links(path):
        place, _, anchor = link.partition("#")
        target = (path.parent / unquote(place)).resolve() if place else path
        if not target.exists() or (anchor and anchor not in anchors(target)):
            dead.append(link)
    return dead


@pytest.mark.parametrize("path", DOCUMENTS, ids=name_of)
def test_links_of_documents_lead_somewhere(path: Path) -> None:
    assert dead_links(path) == []


def test_dead_links_are_noticed(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text(
        "# A heading: `x`, 2.1\n[a](page.md#a-heading-x-21) [b](#a-heading-x-21) [c](page.md#b) [d](gone.md)\n"
        "![e](gone.png) [f](https://example.org/gone) `[g](gone.md)`\n```text\n[h](gone.md)\n```\n"
    )
    assert dead_links(page) == ["page.md#b", "gone.md", "gone.png"]


class Page(HTMLParser):
    """Ids and local references of a page of the site."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.ids: set[str] = set()
        self.references: set[str] = set()
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        for name, value in attrs:
            if name == "id" and value:
                self.ids.add(value)
            elif (
                name in ("href", "src") and value and "://" not in value and not value.startswith(("data:", "mailto:"))
            ):
                self.references.add(value)


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site")
    command = [
        sys.executable,
        "-m",
        "sphinx",
        "--quiet",
        "--fail-on-warning",
        "--keep-going",
        "-d",
        str(folder / "trees"),
    ]
    done = subprocess.run(
        [*command, str(ROOT / "docs"), str(folder / "html")], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return folder / "html"


def test_the_site_has_its_pages(site: Path) -> None:
    built = {str(path.relative_to(site))[: -len(".html")] for path in site.rglob("*.html")}
    assert built >= MENU
    assert built >= {name_of(path)[len("docs/") : -len(".md")] for path in DOCUMENTS if "docs" in path.parts}


def test_references_of_the_site_lead_somewhere(site: Path) -> None:
    pages = {path: Page(path) for path in site.rglob("*.html")}
    dead = []
    for path, page in pages.items():
        for reference in page.references:
            place, _, anchor = reference.partition("#")
            target = (path.parent / unquote(place.partition("?")[0])).resolve() if place else path
            known = pages[target].ids if target in pages else set()
            if not target.exists() or (anchor and target in pages and unquote(anchor) not in known):
                dead.append(f"{path.name}: {reference}")
    assert len(pages) > len(MENU) and sum(len(page.references) for page in pages.values()) > 100
    assert dead == []


@pytest.mark.parametrize("path", DOCUMENTS, ids=name_of)
def test_code_fits_the_column(path: Path) -> None:
    fenced = re.findall(r"^```.*?^```", path.read_text(encoding="utf-8"), re.S | re.M)
    wide = [line for block in fenced for line in block.splitlines() if len(line) > CODE_WIDTH]
    assert not wide


def test_the_architecture_names_and_draws_every_room() -> None:
    folders = {path.parent.name for path in (ROOT / "hazard_ms").glob("*/__init__.py")}
    text = (ROOT / "docs/architecture.md").read_text(encoding="utf-8")
    table = next(part for part in text.split("\n\n") if part.startswith("| room "))
    assert set(re.findall(r"`(\w+)/`", table)) == folders
    assert folders <= set(drawn_rooms())


def test_the_drawing_stacks_the_rooms_as_imports_go() -> None:
    heights = drawn_rooms()
    for below in heights:
        for above in heights:
            if layer(below) < layer(above):
                assert heights[below] > heights[above], f"{below} must be drawn below {above}"


def drawn_rooms() -> dict[str, int]:
    """Where each room is drawn: name -> y, which grows downwards."""
    text = (ROOT / DRAWING).read_text(encoding="utf-8")
    return {name: int(y) for y, name in re.findall(r'y="(\d+)"><tspan class="n">(\w+)<', text)}
