"""Hundreds of hostile scenes and folders of the original end as is documented, within a gigabyte and a minute."""

from __future__ import annotations

import pytest

from tests.worlds.hostile.reading import read_corpus


@pytest.mark.parametrize("corpus", ["scenes", "originals"])
def test_a_dozen_hostile_files(corpus: str) -> None:
    read_corpus(corpus, 0, 12)


@pytest.mark.long
@pytest.mark.timeout(3600)
@pytest.mark.parametrize(("corpus", "count"), [("scenes", 200), ("originals", 100)])
def test_hundreds_of_hostile_files(corpus: str, count: int) -> None:
    read_corpus(corpus, 0, count)
