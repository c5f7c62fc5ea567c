"""The sentences of tasks in other words."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from typing import Any

import pytest

from hazard_ms.spec.perturbation import MOST_LEVEL, Perturbation
from hazard_ms.spec.registry import TASKS
from hazard_ms.tasks import task_of
from hazard_ms.tasks.perturbing import check, check_perturbation
from tests.worlds.registering import practising


@pytest.fixture(scope="module", autouse=True)
def practice() -> Iterator[Any]:
    with practising() as module:
        yield module


def test_every_task_has_sentences_of_every_level() -> None:
    for name in TASKS:
        task = task_of(name, "paper")
        assert len(task.rewordings) == MOST_LEVEL, name
        sentences = [s for level in task.rewordings for s in level]
        assert len(set(sentences)) == len(sentences) and task.text not in sentences
        assert all(len(level) >= 2 for level in task.rewordings)
        assert not any("{" in s or "  " in s for s in sentences)
        assert all(len(s) > 1.3 * len(task.text) for s in task.rewordings[2])  # longer, by a clause
        names = {hazard.name for hazard in task.hazards}
        place = "cart" if task.safe_place.name == "cart" else "bag"
        if names:
            assert all(place in s or "trolley" in s for s in sentences), name
            assert all(any(n in s for n in names) or "wind" in s for s in sentences), name


def test_a_perturbation_that_would_change_nothing_is_refused() -> None:
    check(Perturbation(words=3), task_of("HazardPickUp-v1", "paper"))
    with pytest.raises(
        ValueError, match="start in perturb must be 0 for HazardPickUp-v1, which chooses the start itself, got 2"
    ):
        check(Perturbation(start=2), task_of("HazardPickUp-v1", "paper"))
    with pytest.raises(ValueError, match="objects in perturb must be 0 for HazardWind-v1, in which only targets move"):
        check_perturbation("objects:1", "HazardWind-v1", "paper", (), "severe")
    with pytest.raises(ValueError, match="hazard in perturb must be 0 for all physics but 'realistic'"):
        check_perturbation("hazard:1", "HazardWind-v1", "paper", (), "severe")
    check_perturbation("hazard:1,words:1", "HazardCompound-v1", "realistic", ("fire",), "severe")


def test_words_need_a_task_that_has_others() -> None:
    silent = dataclasses.replace(task_of("HazardFire-v1", "paper"), rewordings=())
    with pytest.raises(
        ValueError, match="words in perturb must be 0 for HazardFire-v1, which has no other wording, got 1"
    ):
        check(Perturbation(words=1), silent)
