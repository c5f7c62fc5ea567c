"""The highest number of each hazard in a look, which films and the page tell beside its colours."""

from __future__ import annotations

import numpy as np
import torch

from hazard_ms.sensing.view import View
from hazard_ms.skills.executor import SkillEnv


def peak_levels(env: SkillEnv, view: View) -> tuple[float, ...]:
    """The highest level of each hazard in a look of the first environment, in its unit; empty without hazard images.

    Where the hazard's `told_up_to` is a height, it is the highest level at that height above what is seen lower: of a
    wind, which grows with the height, neither the sky's nor a roof's counts. Minus infinity where nothing is so low.
    """
    if view.level is None:
        return ()
    base, points, made = env.base, view.sampled, []
    for k, hazard in enumerate(base.task.hazards):
        top = hazard.shown_level.told_up_to
        if not np.isfinite(top):
            made.append(float(np.nanmax(view.level[k])))
            continue
        low = points[points[:, 2] <= top]
        low[:, 2] = top
        levels = base.episode.levels(torch.as_tensor(low, device=base.device)[None])[0, k]
        made.append(float(levels.max()) if len(low) else -np.inf)
    return tuple(made)
