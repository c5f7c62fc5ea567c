"""What tests of the original's fire share: its presets, and one or many copies of a world."""

from __future__ import annotations

import pytest

from hazard_ms.hazards.fire.fire import Fire
from hazard_ms.hazards.presets import fire
from tests.worlds.fire_worlds import ORIGINAL


@pytest.fixture(params=ORIGINAL)
def preset(request: pytest.FixtureRequest) -> Fire:
    return fire(request.param)


@pytest.fixture(params=[1, 64])
def copies(request: pytest.FixtureRequest) -> int:
    return request.param
