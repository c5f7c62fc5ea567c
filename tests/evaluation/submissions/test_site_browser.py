"""The leaderboard in a real browser: as wide as the screen, on a large one and on a phone, and its links lead on."""

from __future__ import annotations

from pathlib import Path

import pytest

from hazard_ms.evaluation.submissions.site import write_site
from hazard_ms.evaluation.submissions.standings import standings
from tests.worlds.serving import browsing, needs_browser, text, until
from tests.worlds.submissions import make_key, report_of, written

pytestmark = [pytest.mark.long, pytest.mark.timeout(300), needs_browser]
PLACES = [(f"Hazard{task}-v1", seed) for task in ("Fire", "Flood", "Wind") for seed in range(25)]
AGENTS = ("greedy", "a name of sixty characters, which is as long as names can be", "<b>random</b>")


@pytest.fixture(scope="module")
def site(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The site of three submissions of 75 episodes."""
    folder = tmp_path_factory.mktemp("board")
    key = make_key(folder, "anna")
    for number, name in enumerate(AGENTS):
        values = {place: ((7 * place[1] + 3 * number) % 10) / 12 + 0.05 * number for place in PLACES}
        written(report_of(name, values, number, track="published"), folder, key)
    (folder / "odd.report.json").write_text("{")
    return write_site(*standings(folder), folder / "site")


@pytest.mark.parametrize("width", [1280, 400])
def test_the_pages_are_as_wide_as_the_screen(width: int, site: Path) -> None:
    with browsing(width) as browser:
        browser.get(site.as_uri())
        until(lambda: browser.find_elements("css selector", "section#published"), 30)
        assert browser.execute_script("return document.documentElement.scrollWidth") <= width
        assert "<b>random</b>" in text(browser, "section") and not browser.find_elements("css selector", "td.who a b")
        assert len(browser.find_elements("css selector", "svg circle")) == len(AGENTS)
        small = (
            "return Math.min(...[...document.querySelectorAll('svg text')].map(t => t.getBoundingClientRect().height))"
        )
        assert browser.execute_script(small) >= 8  # [pixels]
        browser.find_element("css selector", "td.who a").click()
        until(lambda: "verified: all 75 episodes" in text(browser, "td.good"), 30)
        assert browser.execute_script("return document.documentElement.scrollWidth") <= width
        assert [line for line in browser.get_log("browser") if line["level"] == "SEVERE"] == []
