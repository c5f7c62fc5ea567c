"""Hundreds of hostile models end as is documented, and within the budget of one model."""

from __future__ import annotations

import pytest

from tests.worlds.hostile.reading import read_corpus


def test_a_dozen_hostile_models() -> None:
    read_corpus("models", 0, 12)


@pytest.mark.long
@pytest.mark.timeout(3600)
def test_two_hundred_hostile_models() -> None:
    read_corpus("models", 0, 200)
