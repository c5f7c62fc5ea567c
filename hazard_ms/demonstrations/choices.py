"""Choices of teachers, out of recorded episodes."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np

from hazard_ms.agents.learned.choices import Choices
from hazard_ms.agents.learned.set_policy import worthwhile
from hazard_ms.demonstrations.layout import datasets
from hazard_ms.demonstrations.reading import Demonstration, demonstrations
from hazard_ms.skills.options.features import Encoder
from hazard_ms.skills.options.options import COUNT


def choices(folder: Path, env_id: str, physics: str, layout: Encoder) -> Choices:
    """The choices in all datasets of a task and a preset in `folder`; `layout`: of the features.

    Left out are choices of what only the teacher knew, and to stop while something is left to do.

    Raises ValueError where there are none, and for features of another layout.
    """
    made = []
    for number, demonstration in enumerate(_episodes(folder, env_id, physics)):
        decisions = demonstration.decisions
        features, option = decisions["features"], decisions["option"].astype(np.int64)
        if features.ndim != 2 or features.shape[1] != layout.size:
            raise ValueError(
                f"features of an episode must be {layout.size} numbers, got {features.shape[-1]} in "
                f"{demonstration.folder}; record it again"
            )
        if not np.isfinite(features).all():
            raise ValueError(f"features of an episode must be finite, got NaN or infinity in {demonstration.folder}")
        if decisions["mask"].shape[1:] != (COUNT,):
            raise ValueError(f"mask must have {COUNT} options, got another number in {demonstration.folder}")
        mask = worthwhile(decisions["mask"])
        begins = decisions["option_start"] & (option >= 0)
        begins[begins] &= mask[begins, option[begins]]
        made.append(Choices(features, mask, option, np.full(len(option), number)).of(begins))
    if not sum(len(each.option) for each in made):
        raise ValueError(f"demos must hold choices in {env_id} with physics {physics}, got none in {folder}")
    return Choices(*(np.concatenate([getattr(e, name) for e in made]) for name in vars(made[0])))


def _episodes(folder: Path, env_id: str, physics: str) -> Iterator[Demonstration]:
    for dataset in datasets(folder):
        for demonstration in demonstrations(dataset):
            if (demonstration.result.env_id, demonstration.result.settings.get("physics")) != (env_id, physics):
                break  # a dataset is of one recipe
            yield demonstration
