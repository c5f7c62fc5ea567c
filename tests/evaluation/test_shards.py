"""Shards: every episode belongs to one, everywhere the same, and a scheduler's variables say which is played."""

from __future__ import annotations

import hashlib
from collections import Counter

import pytest

from hazard_ms.evaluation.spread import in_shard, shard

NAMES = [f"HazardFire-v1-test-paper-fetch-greedy-{seed:04d}.json" for seed in range(300)]


@pytest.mark.parametrize("parts", [1, 3, 7])
def test_every_name_belongs_to_one_shard(parts: int) -> None:
    held = Counter(part for name in NAMES for part in range(1, parts + 1) if in_shard(name, part, parts))
    assert sum(held.values()) == len(NAMES) and set(held) == set(range(1, parts + 1))
    assert max(held.values()) < 1.5 * len(NAMES) / parts


def test_the_shard_of_a_name_is_its_hash() -> None:
    for name in NAMES[:20]:
        first_words = int(hashlib.sha256(name.encode()).hexdigest()[:16], 16)
        assert in_shard(name, first_words % 3 + 1, 3)


@pytest.mark.parametrize(
    ("text", "variables", "told"),
    [
        (None, {}, (1, 1)),
        ("2/3", {}, (2, 3)),
        ("2/3", {"ID": "7", "COUNT": "8"}, (2, 3)),
        (None, {"ID": "0", "COUNT": "4", "MIN": "0"}, (1, 4)),
        (None, {"ID": "4", "COUNT": "4", "MIN": "1"}, (4, 4)),
        (None, {"ID": "14", "COUNT": "3", "MIN": "10", "STEP": "2"}, (3, 3)),
    ],
)
def test_the_text_or_else_the_scheduler_says_the_shard(
    text: str | None, variables: dict[str, str], told: tuple[int, int]
) -> None:
    assert shard(text, {f"SLURM_ARRAY_TASK_{name}": value for name, value in variables.items()}) == told


@pytest.mark.parametrize("text", ["", "3", "0/3", "4/3", "-1/3", "1/0", "a/b", "1/3 ", "1.0/3", "1/1000000"])
def test_other_texts_are_refused(text: str) -> None:
    with pytest.raises(ValueError, match="shard must be i/N"):
        shard(text, {})


def test_variables_that_are_not_numbers_are_refused() -> None:
    with pytest.raises(ValueError, match="SLURM_ARRAY_TASK_ID"):
        shard(None, {"SLURM_ARRAY_TASK_ID": "two", "SLURM_ARRAY_TASK_COUNT": "3"})
