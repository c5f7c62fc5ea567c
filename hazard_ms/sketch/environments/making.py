"""Makes environments of skills for gymnasium: in the simulator or in the sketch, one rescue or many at once."""

from __future__ import annotations

from typing import Any

from hazard_ms.sketch.environments.batch import SketchBatch
from hazard_ms.sketch.environments.settings import Settings
from hazard_ms.sketch.environments.single import SketchSkills
from hazard_ms.sketch.rescues.state import AS_MEASURED, Domain
from hazard_ms.skills.options.choices import ACTIONS, OPTIONS
from hazard_ms.skills.options.environment import HazardSkills
from hazard_ms.skills.options.rewards import VALUE
from hazard_ms.spec.checks import one_of

SIMULATOR, SKETCH = "simulator", "sketch"
BACKENDS = (SIMULATOR, SKETCH)


def make(
    *, task: str, backend: str = SIMULATOR, actions: str = OPTIONS, **settings: Any
) -> HazardSkills | SketchSkills:
    """The environment of skills of `task`, in the simulator or in the sketch, with `settings` as these take them.

    Raises ValueError for unknown names, and for settings that are not allowed.
    """
    if one_of(backend, BACKENDS, "backend") == SIMULATOR:
        return HazardSkills(task=task, actions=actions, **settings)
    return SketchSkills(task=task, actions=actions, **settings)


def make_vector(
    *,
    task: str,
    num_envs: int = 1,
    backend: str = SIMULATOR,
    actions: str = OPTIONS,
    reward: str = VALUE,
    stop: bool = True,
    masked: bool = False,
    domain: Domain = AS_MEASURED,
    **settings: Any,
) -> SketchBatch:
    """Many rescues of `task` at once in the sketch, with the `settings` of `Settings`: split, scenes, generated.

    Raises ValueError for unknown names, for settings that are not allowed, and for the simulator, of which gymnasium
    can run several in processes of their own.
    """
    one_of(actions, ACTIONS, "actions")
    if one_of(backend, BACKENDS, "backend") == SIMULATOR:
        raise ValueError(
            f"backend must be {SKETCH} for many rescues in one process, got {backend}: "
            "give vectorization_mode='async' for simulators"
        )
    made = Settings.of(task, **settings)
    return SketchBatch(made.scenes(), made.ranges, made.times, num_envs, reward, stop, domain, actions, masked)
