"""Two real short episodes, played once for all tests of submissions."""

from __future__ import annotations

import pytest

from hazard_ms.evaluation.result import EpisodeResult
from tests.worlds.submissions import TRIAL_TEAMS, honest, short_episode, team_episodes


@pytest.fixture(scope="session")
def episodes() -> list[EpisodeResult]:
    """The two episodes of the track `trial`, each of three decisions."""
    return [short_episode(seed) for seed in (0, 1)]


@pytest.fixture(scope="session")
def submission(episodes: list[EpisodeResult]) -> bytes:
    """The honest submission of these."""
    return honest(episodes)


@pytest.fixture(scope="session")
def pairs() -> list[EpisodeResult]:
    """The two episodes of the track `trial-teams`, each of five decisions, two of which are messages."""
    return team_episodes()


@pytest.fixture(scope="session")
def of_team(pairs: list[EpisodeResult]) -> bytes:
    """The honest submission of these."""
    return honest(pairs, track=TRIAL_TEAMS)
