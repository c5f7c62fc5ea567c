"""A person plays a home in a real browser: shuts a door, picks up an extinguisher, and reads what was averted."""

from __future__ import annotations

from pathlib import Path

import pytest

from hazard_ms.evaluation.result import EpisodeResult
from tests.worlds.serving import asked, browsing, choose, decisions, needs_browser, serving, text, until

pytestmark = [pytest.mark.long, pytest.mark.render, pytest.mark.timeout(1800), needs_browser]


def test_a_door_is_shut_and_an_extinguisher_picked_up(tmp_path: Path) -> None:
    """The scene of seed 3: an extinguisher stands in the hall, where the robot begins, beside open door 5."""
    folder = tmp_path / "rescues"
    with serving(folder) as server, browsing() as browser:
        browser.get(server.address)
        until(lambda: browser.find_elements("css selector", "#play form"))
        browser.find_element("css selector", "#play select[name=env_id] option[value=HazardHouseFire-v1]").click()
        seed = browser.find_element("css selector", "#play input[name=seed]")
        seed.clear()
        seed.send_keys("3")
        browser.find_element("css selector", "#play button.main").click()
        asked(browser)
        choose(browser, "look around here")
        until(lambda: decisions(browser) > 0)
        asked(browser)
        assert "door_5: open" in text(browser, "#play .doors")
        (chip,) = [c for c in browser.find_elements("css selector", "#play .doors .chip") if "door_5" in c.text]
        chip.click()
        until(lambda: browser.find_elements("css selector", "#play .menu button"), 30)
        assert [b.text.split(" ", 1)[1] for b in browser.find_elements("css selector", "#play .menu button")] == [
            "shut door_5"
        ]
        browser.find_element("css selector", "#play .menu button").click()
        until(lambda: "door_5: shut" in text(browser, "#play .doors"))
        choose(browser, "pick up fire_extinguisher_1")
        until(lambda: "In the hand: fire_extinguisher_1" in text(browser, "#play"))
        choose(browser, "put down fire_extinguisher_1")
        until(lambda: "The hand is empty" in text(browser, "#play"))
        asked(browser)
        choose(browser, "stop")
        until(lambda: "%" in text(browser, "#play .averted"), 600)  # the same episode is played with nobody acting
        until(lambda: "exact" in text(browser, "#play .film"), 600)
        assert [line for line in browser.get_log("browser") if line["level"] == "SEVERE"] == []
    result = EpisodeResult.read(next(folder.glob("*.json")))
    verbs = [(d.verb, d.target) for d in result.decisions if d.ok]
    assert ("shut", "door_5") in verbs and ("pick_up", "fire_extinguisher_1") in verbs
    assert result.averted is not None and result.lost is not None and result.lost_alone is not None
    assert result.averted == pytest.approx(1.0 - result.lost.targets / result.lost_alone.targets)
