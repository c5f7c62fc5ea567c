"""Options and markers of all tests."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from pathlib import Path

import pytest


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--long", action="store_true", help="run the tests that take minutes, too")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Skip what this machine cannot do, and what was not asked for."""
    for item in items:
        if item.get_closest_marker("long") and not config.getoption("--long"):
            item.add_marker(pytest.mark.skip(reason="takes minutes: --long"))
        if item.get_closest_marker("gpu") and not Path("/dev/nvidiactl").exists():
            item.add_marker(pytest.mark.skip(reason="no NVIDIA GPU"))
        if item.get_closest_marker("render") and rendering_backend() == "none":
            item.add_marker(pytest.mark.skip(reason="nothing draws here: hazard-ms doctor"))


def pytest_collection_finish() -> None:
    """Spare the garbage collector, which runs at every change of scene, all that belongs to thousands of tests."""
    gc.freeze()


@pytest.fixture(scope="module", autouse=True)
def tasks_are_left_as_they_were() -> Iterator[None]:
    """A task that a test leaves registered breaks tests of all tasks, and only where both run in one process."""
    from hazard_ms.spec.registry import TASKS

    before = set(TASKS)
    yield
    assert set(TASKS) == before, "a test of this module leaves tasks registered, or takes some away"


def rendering_backend() -> str:
    from hazard_ms.machine.render_backend import backend

    return backend()
