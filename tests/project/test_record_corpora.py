"""Thousands of hostile records of earlier runs end as is documented, within a gigabyte and ten seconds, and do nothing."""

from __future__ import annotations

import pytest

from tests.worlds.hostile.corpus import RECORDS
from tests.worlds.hostile.reading import read_corpus


@pytest.mark.parametrize("corpus", RECORDS)
def test_forty_hostile_records(corpus: str) -> None:
    read_corpus(corpus, 0, 40)


@pytest.mark.long
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("corpus", RECORDS)
def test_two_thousand_hostile_records(corpus: str) -> None:
    read_corpus(corpus, 0, 2000)
