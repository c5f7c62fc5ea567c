"""Two real short episodes, played once for all tests of submissions."""

from __future__ import annotations

import pytest

from hazard_ms.evaluation.result import EpisodeResult
from tests.worlds.submissions import honest, short_episode


@pytest.fixture(scope="session")
def episodes() -> list[EpisodeResult]:
    """The two episodes of the track `trial`, each of three decisions."""
    return [short_episode(seed) for seed in (0, 1)]


@pytest.fixture(scope="session")
def submission(episodes: list[EpisodeResult]) -> bytes:
    """The honest submission of these."""
    return honest(episodes)
