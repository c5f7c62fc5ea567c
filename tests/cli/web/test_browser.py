"""The page in a real browser: rescues from the first page to the result, and what happens when things break."""

from __future__ import annotations

import os
import signal
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest

from hazard_ms.evaluation.result import EpisodeResult
from tests.worlds.serving import Server, asked, browsing, choose, decisions, needs_browser, press, serving, text, until

pytestmark = [pytest.mark.long, pytest.mark.render, pytest.mark.timeout(900), needs_browser]


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Server]:
    with serving(tmp_path_factory.mktemp("served") / "rescues", "--sessions", "4") as made:
        made.folder = tmp_path_factory.getbasetemp()  # type: ignore[attr-defined]
        yield made


def begin(browser: Any, server: Server, task: str = "HazardFire-v1") -> None:
    browser.get(server.address)
    until(lambda: browser.find_elements("css selector", "#play form"))
    browser.find_element("css selector", f"#play select[name=env_id] option[value={task}]").click()
    browser.find_element("css selector", "#play button.main").click()


@pytest.mark.parametrize("task", ["HazardFire-v1", "HazardFlood-v1", "HazardWind-v1"])
def test_a_rescue_from_the_first_page_to_the_result(tmp_path: Path, task: str) -> None:
    """Its replay, by the command, is bit-equal."""
    folder = tmp_path / "rescues"
    with serving(folder) as server, browsing() as browser:
        begin(browser, server, task)
        asked(browser)
        press(browser, "1")
        until(lambda: decisions(browser) > 0)
        choose(browser, "look around here")
        choose(browser, "stop")
        until(lambda: "exact" in text(browser, "#play .film"))
        links = [a.text for a in browser.find_elements("css selector", "#play .files a")]
        assert [name.rsplit(".")[-1] for name in links] == ["html", "mp4", "json"]
        severe = [line for line in browser.get_log("browser") if line["level"] == "SEVERE"]
        assert severe == []
    result = EpisodeResult.read(next(folder.glob("*.json")))
    assert result.agent == "human" and result.env_id == task and result.frames > 100
    from hazard_ms.evaluation.options import ReplayOptions
    from hazard_ms.evaluation.replay import replay

    assert replay(ReplayOptions((folder,), workers=1)) == 0


def test_two_browsers_at_once(server: Server) -> None:
    with browsing() as one, browsing() as two:
        begin(one, server)
        begin(two, server, "HazardFlood-v1")
        assert asked(one) and asked(two)
        press(one, "1")
        press(two, "1")
        until(lambda: decisions(one) > 0 and decisions(two) > 0)
        assert "HazardFire-v1" in text(one, "#play .title") and "HazardFlood-v1" in text(two, "#play .title")


def test_a_reload_in_the_middle_shows_the_same_rescue(server: Server) -> None:
    with browsing() as browser:
        begin(browser, server)
        choose(browser, "look around here")
        until(lambda: decisions(browser) == 1)
        asked(browser)
        before = text(browser, "#play .title"), text(browser, "#play tbody"), text(browser, "#play .targets")
        browser.refresh()
        asked(browser)
        assert (text(browser, "#play .title"), text(browser, "#play tbody"), text(browser, "#play .targets")) == before


def test_a_killed_server_is_told_of_and_the_next_one_goes_on(tmp_path: Path) -> None:
    folder = tmp_path / "rescues"
    with browsing() as browser:
        with serving(folder) as first:
            begin(browser, first)
            choose(browser, "look around here")
            until(lambda: decisions(browser) == 1)
            asked(browser)
            before = text(browser, "#play tbody")
            first.kill()
            until(lambda: "does not answer" in text(browser, "#play .banner"), 30)
        with serving(folder) as second:
            assert second.address.partition("#")[2] != first.address.partition("#")[2]
            browser.get(second.address)
            until(lambda: browser.find_elements("css selector", "#play ul.plain button"), 60)
            browser.find_element("css selector", "#play ul.plain button").click()
            until(lambda: text(browser, "#play tbody") == before)
            choose(browser, "stop")
            until(lambda: "exact" in text(browser, "#play .film"))


def test_a_process_that_dies_is_told_of_and_the_rescue_goes_on(server: Server) -> None:
    with browsing() as browser:
        begin(browser, server)
        choose(browser, "look around here")
        until(lambda: decisions(browser) == 1)
        asked(browser)
        own = [p for p in children(server.process.pid) if "spawn_main" in Path(f"/proc/{p}/cmdline").read_text()]
        os.kill(max(own, key=started), signal.SIGKILL)
        until(lambda: "process ended: signal 9" in text(browser, "#play .banner"), 30)
        browser.find_element("css selector", "#play .banner button").click()
        until(lambda: decisions(browser) == 1 and asked(browser))


def started(process: int) -> int:
    """The time at which a process began, in ticks of the clock since the machine did."""
    return int(Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[19])


def children(parent: int) -> list[int]:
    tasks = Path(f"/proc/{parent}/task").glob("*/children")
    return [int(child) for task in tasks for child in task.read_text().split()]


def test_everything_can_be_done_by_keys(server: Server) -> None:
    from selenium.webdriver.common.keys import Keys

    with browsing() as browser:
        browser.get(server.address)
        until(lambda: browser.find_elements("css selector", "#play form"))
        for _ in range(30):
            press(browser, Keys.TAB)
            focused = browser.switch_to.active_element
            assert browser.execute_script("return getComputedStyle(arguments[0]).outlineStyle", focused) != "none"
            if "main" in (focused.get_attribute("class") or ""):
                break
        press(browser, Keys.ENTER)
        asked(browser)
        press(browser, "m", Keys.ARROW_DOWN)
        until(lambda: browser.find_elements("css selector", "#play .menu button"), 30)
        press(browser, Keys.ENTER)
        until(lambda: decisions(browser) == 1)


@pytest.mark.parametrize("width", [1280, 400])
@pytest.mark.parametrize("dark", [True, False])
def test_the_page_is_as_wide_as_the_screen_and_readable(server: Server, width: int, dark: bool) -> None:
    with browsing(width, dark=dark) as browser:
        browser.get(server.address)
        for tab in ("play", "watch"):
            browser.find_element("id", f"tab-{tab}").click()
            until(lambda: browser.find_elements("css selector", f"#{tab} form"))  # noqa: B023 it is called at once
            assert browser.execute_script("return document.documentElement.scrollWidth") <= width
            for name in ("--text", "--soft", "--accent", "--good", "--bad", "--gold", "--focus"):
                assert contrast(browser, name, "--panel") >= 4.5, name


@pytest.mark.parametrize("width", [1280, 400])
def test_a_rescue_in_the_dark_fits_the_screen_and_its_pictures_can_be_read(server: Server, width: int) -> None:
    """Writing in the map, 12 pixels of 320, is shown at 8 pixels and more; nothing is wider than the screen."""
    with browsing(width) as browser:
        begin(browser, server)
        asked(browser)
        until(lambda: browser.execute_script("return document.querySelector('.picture-m img').naturalWidth") == 480)
        assert browser.execute_script("return document.documentElement.scrollWidth") <= width
        sizes = "return ['r', 'm', 'h'].map(k => document.querySelector(`.picture-${k} img`).clientWidth)"
        room, plan, head = browser.execute_script(sizes)
        assert min(room, plan) >= 350 and head >= 170


def contrast(browser: Any, first: str, second: str) -> float:
    """The contrast of two colours of the page, as WCAG 2.2 defines it [-]."""
    script = "return getComputedStyle(document.documentElement).getPropertyValue(arguments[0])"
    lights = []
    for name in (first, second):
        digits = browser.execute_script(script, name).strip().lstrip("#")
        parts = [int(digits[i : i + 2], 16) / 255 for i in (0, 2, 4)]
        linear = [p / 12.92 if p <= 0.04045 else ((p + 0.055) / 1.055) ** 2.4 for p in parts]
        lights.append(0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2])
    return (max(lights) + 0.05) / (min(lights) + 0.05)


def test_hostile_names_do_not_reach_the_page(server: Server) -> None:
    """Every message is shown as text, whatever is in it."""
    evil = "<img src=x onerror=\"document.title='owned'\">"
    with browsing() as browser:
        begin(browser, server)
        asked(browser)
        script = """
            const done = arguments[1], evil = arguments[0]
            import('/static/rescue.js').then(({ Rescue }) => {
              const r = Object.create(Rescue.prototype)
              Object.assign(r, { name: evil, api: null, report() {}, rows: [], state: null, begun: null })
              r.build(); document.body.append(r.root)
              const c = { key: evil, words: evil, thing: evil }
              r.heard({ type: 'begun', task: evil, scene: evil, seed: evil, agent: evil, text: evil,
                room: true, max_frames: 1 })
              r.heard({ type: 'state', phase: 'asking', number: 0, frame: 0, value: 0, held: evil,
                choices: [c], things: [evil], targets: [{ name: evil, value: 5 }],
                last: { ok: false, action: evil, reason: evil }, note: evil })
              r.heard({ type: 'pointed', name: evil, why: evil, choices: [c] })
              r.heard({ type: 'row', number: 0, frame: 0, verb: evil, target: evil, ok: false,
                reason: evil, note: evil })
              r.heard({ type: 'over', ended: evil, files: [{ name: evil, address: '/files/0/' + evil }] })
              r.heard({ type: 'kept', replay: evil, demonstration: evil, files: [{ name: evil, address: '/' }] })
              r.heard({ type: 'failed', why: evil }); r.heard({ type: 'died', why: evil })
              const found = r.root.querySelectorAll('img:not([alt])').length
              setTimeout(() => done([found, document.title, r.root.textContent.includes(evil)]), 500)
            })"""
        assert browser.execute_async_script(script, evil) == [0, "hazard_ms", True]
