"""The list of documents for language models, llms.txt, has the form of https://llmstxt.org and leaves no page out."""

from __future__ import annotations

import re

from tests.worlds.files.checkout import ROOT
from tests.worlds.files.documents import DOCUMENTS, name_of

TEXT = (ROOT / "llms.txt").read_text(encoding="utf-8")
ENTRY = re.compile(r"- \[([^\]]+)\]\(([^)\s]+)\): (\S.*)")
OF_THE_SITE = {"docs/index.md", "docs/changelog.md", "docs/contributing.md"}  # a menu, and pages that include others
LONGEST = 160  # of an entry [characters]: one line of a screen


def faults(text: str) -> list[str]:
    """What of a text is not as llms.txt must be: a title, a quotation, prose, then sections with lists of links."""
    top, *sections = re.split(r"^## .+\n", text, flags=re.M)
    wrong = [] if re.fullmatch(r"# .+\n\n> .+\n(?:\n[^#>-].*\n)*\n", top) else [top]
    for section in sections:
        lines = section.strip().splitlines()
        wrong += [line for line in lines if not ENTRY.fullmatch(line) or len(line) > LONGEST] or (
            [] if lines else ["empty"]
        )
    return wrong


def test_it_has_its_form() -> None:
    assert faults(TEXT) == [] and re.findall(r"^## (.+)", TEXT, re.M)[-1] == "Optional"
    assert faults("# a\n\ntext\n\n## b\n\n- [c](d): e\n") and faults("# a\n\n> b\n\n## c\n\n- [d](e)\n")
    assert faults("# a\n\n> b\n\n## c\n\n## d\n\n- [e](f): g\n") == ["empty"]


def test_every_link_leads_to_a_page_and_every_page_is_listed_once() -> None:
    links = [link for _, link, _ in ENTRY.findall(TEXT)]
    assert [link for link in links if not (ROOT / link).is_file()] == [] and len(set(links)) == len(links)
    assert {name_of(path) for path in DOCUMENTS} - set(links) == OF_THE_SITE
