"""Thousands of hostile records of earlier runs end as is documented, within a gigabyte and ten seconds."""

from __future__ import annotations

import pytest

from tests.worlds.hostile.corpus import BATCH, RECORDS
from tests.worlds.hostile.reading import read_corpus


def test_ten_hostile_records_of_each_kind() -> None:
    read_corpus("records", 0, len(RECORDS))


@pytest.mark.long
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("corpus", RECORDS)
def test_two_thousand_hostile_records(corpus: str) -> None:
    read_corpus(corpus, 0, 2000 // BATCH)
