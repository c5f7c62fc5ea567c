"""Compare in a real browser, by keyboard alone: sort, choose an episode, read its decisions, open its page."""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import pytest
from selenium.webdriver.common.keys import Keys

from hazard_ms.evaluation.result import DecisionRecord
from tests.worlds.courses import course, drawn, fate
from tests.worlds.serving import browsing, needs_browser, serving, until

pytestmark = [pytest.mark.long, pytest.mark.timeout(300), needs_browser]
BAD = "<img src=x onerror=alert(1)>"
MOST_TABS = 60  # from one thing to the next


@pytest.fixture(scope="module")
def address(tmp_path_factory: pytest.TempPathFactory) -> Iterator[str]:
    """The address of a server of four episodes of two agents and one of a person with a hostile note."""
    folder = tmp_path_factory.mktemp("results")
    for agent, skill in {"greedy": 0.4, "oracle": 0.95}.items():
        for seed in range(4):
            drawn(agent, seed, skill).write(folder / f"{agent}-{seed}.json")
    notes = [DecisionRecord(0, "explore", None, True, "", 60), DecisionRecord(60, "walk_to", BAD, True, "", 90, BAD)]
    course("human", 0, [fate(5, 140), fate(5, None)], notes).write(folder / "human.json")
    (folder / f"{BAD[:4]}.json").write_text("{")
    with serving(folder) as server:
        yield server.address


class Keyboard:
    """Somebody who has no mouse."""

    def __init__(self, browser: Any) -> None:
        self.browser = browser

    def press(self, *keys: str) -> str:
        """Press keys one after the other. Returns what is in focus then, in words."""
        for key in keys:
            self.browser.switch_to.active_element.send_keys(key)
        return self.focus()

    def focus(self) -> str:
        told = "const a = document.activeElement; return a.getAttribute('aria-label') || a.textContent"
        return str(self.browser.execute_script(told))

    def tab_to(self, words: str) -> str:
        """Press Tab until something is in focus that is called so."""
        for _ in range(MOST_TABS):
            found = self.press(Keys.TAB)
            if re.search(words, found):
                return found
        raise AssertionError(f"nothing called {words} within {MOST_TABS} presses of Tab")

    def text(self, selector: str) -> str:
        return str(
            self.browser.execute_script("return document.querySelector(arguments[0])?.innerText || ''", selector)
        )

    def until(self, selector: str, words: str) -> None:
        until(lambda: re.search(words, self.text(selector)), 30.0)


def test_compare_by_keyboard_alone(address: str) -> None:
    with browsing() as browser:
        _compare(address, browser)


def _compare(address: str, browser: Any) -> None:
    browser.get(address)
    keyboard = Keyboard(browser)
    keyboard.tab_to("^Play$")
    assert keyboard.press(Keys.ARROW_RIGHT, Keys.ARROW_RIGHT) == "Compare"
    keyboard.until("#compare .compare-scores", "human")
    table = [line for line in keyboard.text("#compare .compare-scores").splitlines() if line.strip()]
    assert "a person" in " ".join(table) and "1 few" in " ".join(table)
    keyboard.until("#compare", "1 file cannot be shown")

    keyboard.tab_to("^oracle$")
    keyboard.press(Keys.ENTER)
    values = [drawn("oracle", seed, 0.95).tally.value for seed in range(4)]
    order = sorted(range(4), key=lambda seed: (-values[seed], seed))
    shown = [int(seed) for seed in re.findall(r"seed (\d)", keyboard.text(".compare-episodes tbody"))]
    assert shown == order
    keyboard.press(Keys.ENTER)
    shown = [int(seed) for seed in re.findall(r"seed (\d)", keyboard.text(".compare-episodes tbody"))]
    assert shown == sorted(range(4), key=lambda seed: (values[seed], seed))

    at = keyboard.tab_to(r"^kitchen_b/0\d, seed \d$")
    while not at.startswith("kitchen_b/00"):
        at = keyboard.press(Keys.ARROW_DOWN)
    assert keyboard.press(Keys.END).startswith("greedy, kitchen_b/00, seed 0: Value ")
    assert "Value 50.0 %" in keyboard.press(Keys.ARROW_LEFT) and keyboard.focus().startswith("human")
    keyboard.press(Keys.HOME, Keys.ENTER)
    keyboard.until(".compare-lanes", "(?s)oracle.*greedy|greedy.*oracle")
    assert browser.execute_script("return document.querySelectorAll('.compare-lanes article').length") == 3
    assert browser.execute_script("return document.querySelectorAll('[aria-pressed=true]').length") == 3

    keyboard.tab_to("^Remove human")
    assert keyboard.tab_to("^frame 0: ") == "frame 0: explore, done, 60 frames"
    assert keyboard.press(Keys.ARROW_RIGHT) == f"frame 60: walk to {BAD}, done, 90 frames; {BAD}"
    assert BAD in keyboard.text(".compare-said") and "frames 60 to 150" in keyboard.text(".compare-said")
    width = browser.execute_script("return document.querySelector('.compare-picture svg').clientWidth")
    keyboard.press("+")
    assert browser.execute_script("return document.querySelector('.compare-picture svg').clientWidth") == 2 * width
    assert keyboard.focus().startswith("frame 60")
    assert re.match(r"frame \d+: ", keyboard.press(Keys.ARROW_UP)) and "human" not in keyboard.text(".compare-said b")

    assert browser.execute_script("return document.querySelectorAll('#compare img, #compare script').length") == 0
    assert [line for line in browser.get_log("browser") if line["level"] == "SEVERE"] == []
    link = browser.execute_script("return document.querySelector('.compare-head a').href")
    browser.get(link)
    assert "HazardFire-v1" in keyboard.text("h1")


@pytest.mark.parametrize("width", [400, 1280])
def test_nothing_is_wider_than_the_page(width: int, address: str) -> None:
    with browsing(width) as browser:
        browser.get(address)
        browser.get(f"{address.split('#')[0]}#compare")
        browser.refresh()
        keyboard = Keyboard(browser)
        keyboard.until("#compare .compare-scores", "human")
        browser.execute_script("document.querySelector('.compare-episodes tbody th button').click()")
        keyboard.until(".compare-lanes", "greedy")
        assert browser.execute_script("return document.documentElement.scrollWidth <= innerWidth")
