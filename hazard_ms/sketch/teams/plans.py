"""References for teams: the most Value that any can reach, and that of the best plan if skills take their usual time.

Both divide the targets in the best way (`hazard_ms.sketch.teams.split`), in a future in which nobody acts.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from hazard_ms.sketch.bound import easiest
from hazard_ms.sketch.planning.bound import never_damaged
from hazard_ms.sketch.planning.problem import Problem
from hazard_ms.sketch.rescue_problem import Outset, RescueScene
from hazard_ms.sketch.teams.split import split
from hazard_ms.sketch.timeline import Timeline
from hazard_ms.spec import Build, SceneSpec
from hazard_ms.spec.registry.robots import robot_class

Place = tuple[float, float]  # x, y [m]


def team_bound(
    timeline: Timeline,
    spec: SceneSpec,
    build: Build,
    values: Sequence[float],
    limit: int,
    starts: Sequence[Place],
    strict: bool = False,
) -> float:
    """The share of the value of all targets that no team of robots from `starts` [m] exceeds, 0 to 1.

    It is a bound as `hazard_ms.sketch.bound.bound` is, of which the other arguments are, for teams in which nobody
    takes what another one put down. Raises ValueError as that does, and as `split` does.
    """
    targets, worth, alone = _targets(timeline, spec, values)
    left = targets[~alone], worth[~alone]
    problems = [easiest(timeline, spec, build, *left, limit, start) for start in starts]
    return _share([never_damaged(problem) for problem in problems] if strict else problems, worth, alone)


def team_plan(
    timeline: Timeline, spec: SceneSpec, robot: str, values: Sequence[float], limit: int, starts: Sequence[Place]
) -> float:
    """The share of the value of all targets that the best plan rescues, 0 to 1, if every skill takes its usual time.

    This is no bound: skills may be quicker than usual. Robots called `robot` begin at `starts` [m], know the
    `timeline`, never fail, and are not in each other's way. Raises ValueError as `team_bound` does.
    """
    targets, worth, alone = _targets(timeline, spec, values)
    scene = RescueScene(spec, robot, robot_class(robot).build.radius, limit)
    carts = np.array([timeline.index(cart.name) for cart in spec.containers], np.int64)
    begun = [Outset(start, spec.agent_start.heading, 0) for start in starts]
    problems = [scene.problem(timeline, targets[~alone], worth[~alone], carts, outset) for outset in begun]
    return _share(problems, worth, alone)


def _targets(
    timeline: Timeline, spec: SceneSpec, values: Sequence[float]
) -> tuple[NDArray[np.int64], NDArray[np.float64], NDArray[np.bool_]]:
    """The targets as indices along B, their values, and whether each becomes safe by itself, [T] each."""
    if len(values) != len(spec.targets):
        raise ValueError(f"values must be {len(spec.targets)}, one for each target, got {len(values)}")
    targets = np.array([timeline.index(target.name) for target in spec.targets], np.int64)
    return targets, np.asarray(values, np.float64), timeline.safe_at[targets] >= 0


def _share(problems: Sequence[Problem], worth: NDArray[np.float64], alone: NDArray[np.bool_]) -> float:
    """The share of all that the best division of `problems` rescues, with what becomes safe by itself."""
    return float(min(1.0, (worth[alone].sum() + split(problems).value) / max(worth.sum(), 1e-9)))
