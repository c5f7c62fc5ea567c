"""What lies between the bound and the oracle: the exact plan, where all skills work in their usual time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from hazard_ms.agents.oracle import BEAM, MOST_LABELS
from hazard_ms.evaluation.result import EpisodeResult
from hazard_ms.sketch.planning.orienteering import solve
from hazard_ms.sketch.recording import recorded
from hazard_ms.sketch.rescue_problem import Outset, RescueScene
from hazard_ms.skills.decision import PICK_UP
from hazard_ms.skills.failures import UNREACHABLE
from hazard_ms.spec.registry.robots import robot_class
from hazard_ms.tasks import task_of


def planned(env_id: str, robot: str, result: EpisodeResult) -> float:
    """The Value of the exact plan of an episode, 0 to 1: all is known, and skills work in their usual time."""
    task, build = task_of(env_id, "paper"), robot_class(robot).build
    spec = task.build(result.scene)
    timeline = recorded(task, "paper", spec, result.seed)
    values = np.array([target.value for target in result.targets])
    targets = np.array([timeline.index(target.name) for target in spec.targets], np.int64)
    carts = np.array([timeline.index(cart.name) for cart in spec.containers], np.int64)
    alone = timeline.safe_at[targets] >= 0  # it becomes safe by itself
    scene = RescueScene(spec, robot, build.radius, result.max_frames)
    outset = Outset(spec.agent_start.position, spec.agent_start.heading, 0)
    plan = solve(scene.problem(timeline, targets[~alone], values[~alone], carts, outset), MOST_LABELS, BEAM)
    return float((values[alone].sum() + plan.value) / values.sum())


def between(env_id: str, robot: str, oracle: Sequence[EpisodeResult]) -> str:
    """The mean Value of the plans of the episodes of the executed `oracle`, and what it made of them, in words."""
    plans = 100.0 * float(np.mean([planned(env_id, robot, result) for result in oracle]))
    reached = 100.0 * float(np.mean([result.tally.value for result in oracle]))
    tried = [d for result in oracle for d in result.decisions if d.verb == PICK_UP and d.reason in ("", UNREACHABLE)]
    worked = sum(d.ok for d in tried)
    return (
        f"The exact plan, if all were known and every skill worked in its usual time: {plans:.1f}. The oracle, which "
        f"executes such plans, reaches {100.0 * reached / plans:.0f} % of that; {worked} of its {len(tried)} pick-ups "
        "worked."
    )
