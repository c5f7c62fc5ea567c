"""A mitigation from outside the package: a fire blanket that is laid over a small thing that burns.

hazard-ms play --load examples/own_tool.py -e HazardBlanket-v1 -a random

A blanket of 1.2 m by 1.2 m keeps air from what it covers (EN 1869), so it smothers what is no wider than 0.5 m. It
stays there. In this task the bags of a scene, which are no targets, hold one each.
"""

from dataclasses import replace

import hazard_ms
from hazard_ms import Task, hazard, rescue
from hazard_ms.skills import failures
from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import Result
from hazard_ms.skills.mitigations.approach import approach
from hazard_ms.skills.mitigations.putting import put_down
from hazard_ms.skills.motor.arm import reach_for

WIDEST = 0.5  # of a thing that it covers down to what it stands on [m] [ours]
OVER = 0.15  # of the hand above what is covered [m] [ours]
SPREADING = 3.0  # to spread it out [s] [ours]
NO_BLANKET, TOO_LARGE = "no_blanket", "too_large"


def things(stage: Stage) -> tuple[str, ...]:
    """Names of the known things that are small enough, while a blanket is in the hand."""
    small = stage.world.extent[0].amax(1) <= WIDEST
    known = [b for b in sorted(stage.seen.objects) if bool(small[b]) and b != stage.held]
    return tuple(stage.labeller.names[b] for b in known) if _has_blanket(stage) else ()


def cover(stage: Stage, name: str) -> Skill:
    """Lay the blanket over the thing called `name`."""
    index = stage.labeller.index(name)
    if not _has_blanket(stage):
        return Result(False, NO_BLANKET)
    if index not in stage.seen.objects:
        return Result(False, failures.UNKNOWN)
    if float(stage.world.extent[0, index].max()) > WIDEST:
        return Result(False, TOO_LARGE)
    place = stage.position(index)
    nearest, farthest = stage.robot.build.span(float(place[2]))
    walked = yield from approach(stage, place, max(nearest, 0.8 * farthest), farthest)
    if not walked.ok:
        return walked
    top = float(place[2] + stage.world.extent[0, index, 2] / 2)
    reached = yield from reach_for(stage, (float(place[0]), float(place[1]), top + OVER))
    used = walked.frames + reached.frames
    if not reached.ok:
        return Result(False, reached.reason, used)
    for _ in range(round(SPREADING / stage.env.control_timestep)):
        yield stage.act(arm=stage.robot.arm())
        used += 1
    stage.env.episode.smother(stage.world.position.new_zeros(1).long(), index)
    used += (yield from put_down(stage)).frames
    return Result(True, frames=used)


def _has_blanket(stage: Stage) -> bool:
    return stage.held >= 0 and stage.world.specs[0].things[stage.held].category == "bag"


def rescue_with_blankets(physics: str) -> Task:
    """The rescue from a fire, in which bags are blankets and no targets."""
    plain = rescue([hazard("fire", physics)])

    def scene(name: str) -> hazard_ms.SceneSpec:
        made = plain.build(name)
        return replace(made, target_categories=tuple(c for c in made.target_categories if c != "bag"))

    return replace(plain, build=scene, mitigations=("cover",))


hazard_ms.register_mitigation(
    "cover",
    cover,
    things,
    "lays the fire blanket in the hand over a small thing that burns, which then goes out",
    tools=("bag",),
    reasons=(NO_BLANKET, TOO_LARGE),
)
hazard_ms.register_task("HazardBlanket-v1", rescue_with_blankets)
