"""Compares policies in the sketch, in the same episodes."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from hazard_ms.learning.cloning import JUDGE, TRIALS, scores
from hazard_ms.sketch.policies import POLICIES, Policy
from hazard_ms.sketch.rescues.scene import SketchScene
from hazard_ms.sketch.skill_times import SkillTimes


def table(scenes: Sequence[SketchScene], times: SkillTimes, policies: Mapping[str, Policy]) -> str:
    """The mean Values of `policies` and of plain rules in `scenes`, and by how much they differ from JUDGE.

    The error is that of the mean difference over the scenes.
    """
    found = {name: scores(scenes, times, policy).mean(axis=0) for name, policy in {**POLICIES, **policies}.items()}
    lines = [f"{len(scenes)} scenes, {TRIALS} rescues in each: mean Value, and what it is more than that of {JUDGE}"]
    for name, value in sorted(found.items(), key=lambda item: -float(item[1].mean())):
        more = value - found[JUDGE]
        error = float(more.std(ddof=1)) / np.sqrt(len(scenes)) if len(scenes) > 1 else 0.0
        lines.append(f"  {float(value.mean()):.3f}  {float(more.mean()):+.3f} +- {error:.3f}  {name}")
    return "\n".join(lines)
