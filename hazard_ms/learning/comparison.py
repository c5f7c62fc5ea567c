"""Compares policies in the sketch, in the same episodes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from hazard_ms.learning.cloning import JUDGE, scores
from hazard_ms.learning.playing import TRIALS, SixPolicy, at_random, possible_at_random, six_scores
from hazard_ms.sketch.policies import POLICIES, Policy, fighter
from hazard_ms.sketch.rescues.scene import Floats, SketchScene
from hazard_ms.sketch.skill_times import SkillTimes

RANDOM = "random six actions"


def table(scenes: Sequence[SketchScene], times: SkillTimes, policies: Mapping[str, Policy]) -> str:
    """The mean Values of `policies` over options and of plain rules in `scenes`, and by how much they differ.

    They are compared with JUDGE; the error is that of the mean difference over the scenes.
    """
    plain = POLICIES | ({"fighter": fighter} if any(len(scene.fire_site) for scene in scenes) else {})
    return _lines({name: scores(scenes, times, policy) for name, policy in {**plain, **policies}.items()}, JUDGE)


def six_table(scenes: Sequence[SketchScene], times: SkillTimes, policies: Mapping[str, SixPolicy]) -> str:
    """The same of `policies` over the six actions, beside what chance does with them, and beside JUDGE over options.

    They are compared with RANDOM.
    """
    chance = {RANDOM: at_random, f"{RANDOM}, of what can be done": possible_at_random}
    found = {name: six_scores(scenes, times, policy) for name, policy in {**chance, **policies}.items()}
    return _lines({**found, f"{JUDGE}, over options": scores(scenes, times, POLICIES[JUDGE])}, RANDOM)


def _lines(values: Mapping[str, Floats], judge: str) -> str:
    """A table of `values` [TRIALS, W] by name, compared with those of `judge`."""
    found = {name: each.mean(axis=0) for name, each in values.items()}
    count = len(found[judge])
    lines = [f"{count} scenes, {TRIALS} rescues in each: mean Value, and what it is more than that of {judge}"]
    for name, value in sorted(found.items(), key=lambda item: -float(item[1].mean())):
        more = value - found[judge]
        error = float(more.std(ddof=1)) / np.sqrt(count) if count > 1 else 0.0
        lines.append(f"  {float(value.mean()):.3f}  {float(more.mean()):+.3f} +- {error:.3f}  {name}")
    return "\n".join(lines)
