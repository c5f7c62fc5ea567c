"""The part of decisions that mitigations add: what can be tried now, and the tools there are."""

from __future__ import annotations

from collections.abc import Sequence

from hazard_ms.sensing.detection.labeller import Labeller
from hazard_ms.simulation.jet import KINDS
from hazard_ms.skills.context import Stage
from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, STOP, VERBS, Action, Tool
from hazard_ms.skills.telling import check_message
from hazard_ms.spec.checks import one_of
from hazard_ms.spec.registry import load
from hazard_ms.spec.registry.mitigations import LOOK_AT, MITIGATIONS, TELL


def verbs_of(labeller: Labeller, mitigations: Sequence[str]) -> tuple[str, ...]:
    """The verbs beyond those of the benchmark that an agent has: a task's `mitigations`, and to look at what it finds.

    It can look where a detector tells what there is; the truth needs no second look.
    """
    looks = (LOOK_AT,) if labeller.withheld else ()
    return tuple(dict.fromkeys((*mitigations, *looks)))


def offered(stage: Stage, verbs: Sequence[str]) -> tuple[Action, ...]:
    """The actions beyond those of the benchmark that can be tried: to pick up tools, and the mitigations of `verbs`."""
    made: list[Action] = []
    if not verbs:
        return ()
    if stage.held < 0:
        light = [tool for tool in tools(stage) if stage.labeller.index(tool.name) in stage.seen.objects]
        made = [Action(PICK_UP, tool.name) for tool in light if _carries(stage, tool.name)]
    for verb in verbs:
        made += [Action(verb, name) for name in load(MITIGATIONS[verb].targets)(stage)]
    return tuple(made)


def tools(stage: Stage) -> tuple[Tool, ...]:
    """The tools of the scene, by the names that the agent knows things by; none where it finds things by itself."""
    equipment, world = stage.world.equipment, stage.world
    if equipment is None or stage.labeller.names != world.names[0]:
        return ()
    rows = []
    for b in equipment.tool[0].nonzero()[:, 0].tolist():
        number, full = int(equipment.kinds[0, b]), float(equipment.full[0, b])
        left = float(equipment.state.charge[0, b]) / full if full > 0.0 else 1.0
        kind = KINDS[number] if number >= 0 else ""
        category = world.specs[0].things[b].category
        rows.append(Tool(world.names[0][b], category, kind, left, bool(world.held[0, b])))
    return tuple(rows)


def _carries(stage: Stage, name: str) -> bool:
    return float(stage.world.mass[0, stage.labeller.index(name)]) <= stage.robot.build.payload


def check(action: Action, stage: Stage, verbs: Sequence[str]) -> None:
    """Check that the task of `verbs` has the verb of `action`, and the scene its target. Raises ValueError if not."""
    if action.verb not in VERBS:
        one_of(action.verb, (*VERBS, *verbs), "verb")
        if action.verb == TELL:
            check_message(action.target)
            return
        known = (*stage.labeller.names, *stage.doors.names)
        one_of(action.target, known, f"the target of {action.verb}")
    if action.verb in (EXPLORE, STOP) and action.target is not None:
        raise ValueError(f"the target of {action.verb} must be None, got {action.target!r}")
    containers = stage.labeller.containers
    if action.verb == DROP and action.target not in (None, *containers):
        allowed = ", ".join(["None", *containers])
        raise ValueError(f"the target of drop must be one of {allowed}, got {action.target!r}")
