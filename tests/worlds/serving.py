"""A server of `hazard-ms serve` in a process of its own, and a real browser, for tests of the page."""

from __future__ import annotations

import contextlib
import os
import re
import select
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

START = 90.0  # longest time until the server prints its address [s]
BUILD = 240.0  # longest time until a rescue asks, on a crowded machine [s]
ROOT = Path(__file__).resolve().parents[2]
CHROMIUM = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
DRIVER = shutil.which("chromedriver")
needs_browser = pytest.mark.skipif(not (CHROMIUM and DRIVER), reason="no chromium, or no chromium-driver")


class Server:
    """The process; `address` is what it printed."""

    def __init__(self, folder: Path, *words: str) -> None:
        command = [sys.executable, "-m", "hazard_ms.cli", "serve", "--folder", str(folder), *words]
        environment = {**os.environ, "PYTHONPATH": str(ROOT)}
        self.process = subprocess.Popen(
            command, cwd=folder.parent, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, env=environment
        )
        assert self.process.stdout is not None
        ready, _, _ = select.select([self.process.stdout], [], [], START)
        assert ready, "the server must print its address"
        self.address = self.process.stdout.readline().strip()
        assert re.fullmatch(r"http://127\.0\.0\.1:\d+/#token=[\w-]{32}", self.address)

    def kill(self) -> None:
        """End the server as a power failure would."""
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()

    def close(self) -> None:
        """End the server as Ctrl-C does."""
        self.process.send_signal(signal.SIGINT)
        with contextlib.suppress(subprocess.TimeoutExpired):
            self.process.wait(20)
        self.process.kill()


@contextlib.contextmanager
def serving(folder: Path, *words: str) -> Iterator[Server]:
    """A server of `folder`."""
    folder.mkdir(parents=True, exist_ok=True)
    made = Server(folder, *words)
    try:
        yield made
    finally:
        made.close()


@contextlib.contextmanager
def browsing(width: int = 1280, height: int = 900, dark: bool = True) -> Iterator[Any]:
    """A browser without a window, of the size of a page [pixels], that prefers dark or light pages."""
    from selenium import webdriver

    options = webdriver.ChromeOptions()
    options.binary_location = str(CHROMIUM)
    for word in ("--headless=new", "--no-sandbox", "--disable-gpu", "--disable-dev-shm-usage", "--hide-scrollbars"):
        options.add_argument(word)
    options.set_capability("goog:loggingPrefs", {"browser": "ALL"})
    made = webdriver.Chrome(options, webdriver.ChromeService(DRIVER))
    size = {"width": width, "height": height, "deviceScaleFactor": 1, "mobile": False}
    made.execute_cdp_cmd("Emulation.setDeviceMetricsOverride", size)
    scheme = {"name": "prefers-color-scheme", "value": "dark" if dark else "light"}
    made.execute_cdp_cmd("Emulation.setEmulatedMedia", {"features": [scheme]})
    try:
        yield made
    finally:
        made.quit()


def until(found: Callable[[], Any], seconds: float = BUILD) -> Any:
    """The first value of `found` that is true."""
    end = time.monotonic() + seconds
    while time.monotonic() < end:
        with contextlib.suppress(Exception):  # the page is being changed
            if value := found():
                return value
        time.sleep(0.2)
    raise AssertionError(f"what was waited for must come within {seconds} s")


def text(browser: Any, selector: str) -> str:
    """The text of the first element that a CSS selector finds; empty if there is none."""
    found = browser.find_elements("css selector", selector)
    return str(found[0].text) if found else ""


def press(browser: Any, *keys: str) -> None:
    """Press keys, one after the other, wherever the focus is."""
    from selenium.webdriver import ActionChains

    for key in keys:
        ActionChains(browser).send_keys(key).perform()


def asked(browser: Any) -> list[str]:
    """The choices, once it is the person's turn."""
    buttons = "#play .ask:not([hidden]) .choices button:enabled"
    until(lambda: browser.find_elements("css selector", buttons))
    return [str(b.text) for b in browser.find_elements("css selector", buttons)]


def choose(browser: Any, words: str) -> None:
    """Choose the first choice that has these words, once it is the person's turn."""

    def click() -> bool:
        for button in browser.find_elements("css selector", "#play .ask:not([hidden]) .choices button:enabled"):
            if words in str(button.text):
                browser.execute_script("arguments[0].scrollIntoView({block: 'center'})", button)
                button.click()
                return True
        return False

    until(click)


def decisions(browser: Any) -> int:
    """The number of decisions that have ended, as the page lists them."""
    return len(browser.find_elements("css selector", "#play tbody tr"))
