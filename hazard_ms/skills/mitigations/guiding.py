"""Leads the leaf of a door by hand, in tasks in which leaves follow the hand (hazard_ms.simulation.mitigation.door_grip).

The hand is at the handle when it begins. It shuts, and then goes along the arc of the handle, a step ahead of the leaf.
"""

from __future__ import annotations

import math

from hazard_ms.simulation.mitigation import hinges
from hazard_ms.simulation.mitigation.door_grip import FASTEST
from hazard_ms.skills import failures
from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import Result
from hazard_ms.skills.mitigations.leaf import Leaf
from hazard_ms.skills.motor.kinematics import shifted

LEAD = math.radians(5)  # by which the hand is sent ahead of where the leaf would follow [rad] [ours]
THERE = math.radians(2)  # difference from the wanted angle at which a leaf is as far as it was asked to turn [rad]
STALLED = 30  # frames in which a leaf does not turn on, after which it will not [ours]


def guide(stage: Stage, leaf: Leaf, goal: float) -> Skill:
    """Shut the hand at the handle of `leaf`, lead it to the angle `goal` [rad], and let go."""
    grip, used, since, best = stage.world.door_grip, 0, 0, math.inf
    assert grip is not None
    arm = stage.robot.arm()
    reason = ""
    while (left := goal - leaf.angle) and abs(left) > THERE:
        best, since = (abs(left), 0) if abs(left) < best - 1e-3 else (best, since + 1)
        if leaf.broken or since > STALLED:
            reason = failures.BROKEN if leaf.broken else failures.UNREACHABLE
            break
        if bool(grip.state.holds[0, leaf.number]):
            behind = float(grip.state.ahead[0, leaf.number])
            place = hinges.handle(leaf.room, leaf.o, leaf.angle - behind + math.copysign(min(LEAD, abs(left)), left))
            arm = shifted(stage.robot, stage.robot.arm(), place - stage.robot.hand())
        yield stage.act(arm=arm, shut=True)
        used += 1
    yield stage.act(arm=stage.robot.arm(), shut=False)
    return Result(not reason, reason, used + 1)

