"""Opens a door by hand, in tasks in which leaves follow it (hazard_ms.simulation.mitigation.door_grip).

The hand is at the handle when it begins. It shuts, and then goes along the arc of the handle, a step ahead of the leaf.
Limits: the base draws back at most, so the arm must be as long as Fetch's; to shut a door, it is not led in this way.
"""

from __future__ import annotations

import math

from hazard_ms.simulation.mitigation import hinges
from hazard_ms.skills import failures
from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import Result
from hazard_ms.skills.mitigations.leaf import Leaf
from hazard_ms.skills.motor.kinematics import shifted

LEAD = math.radians(5)  # by which the hand is sent ahead of where the leaf would follow [rad] [ours]
ROOMY = 0.75  # distance of the handle from the base from which on this draws back, so that the arm has room [m] [ours]
ADVANCE = 1e-3  # least turn of the leaf that counts as progress [rad] [ours]
THERE = math.radians(
    2
)  # difference from the wanted angle at which a leaf is as far as it was asked to turn [rad] [ours]
STALLED = 20  # frames in which a leaf does not turn on, after which it will not [ours]


def guide(stage: Stage, leaf: Leaf, goal: float) -> Skill:
    """Shut the hand at the handle of `leaf`, lead it open to the angle `goal` [rad], and let go.

    Where the arm gets no farther, it is far enough if the robot gets through what is open.
    """
    grip, used, since, best = stage.world.door_grip, 0, 0, math.inf
    assert grip is not None
    arm, step = stage.robot.arm(), stage.robot.build.forward_step
    forward, reason = 0.0, ""
    while (left := goal - leaf.angle) > THERE:
        best, since = (left, 0) if left < best - ADVANCE else (best, since + 1)
        if leaf.broken or since > STALLED:
            reason = failures.BROKEN if leaf.broken else failures.UNREACHABLE
            break
        if bool(grip.state.holds[0, leaf.number]):
            behind = float(grip.state.ahead[0, leaf.number])
            place = hinges.handle(leaf.room, leaf.o, leaf.angle - behind + min(LEAD, left))
            x, y, _ = stage.robot.base()
            forward = max(-step, min(0.0, math.hypot(place[0] - x, place[1] - y) - ROOMY))
            arm = shifted(stage.robot, stage.robot.arm(), place - stage.robot.hand())
        yield stage.act(forward, arm=arm, shut=True)
        used += 1
    passes = leaf.o.width * hinges.share(leaf.angle) > 2.0 * stage.robot.build.radius
    if reason == failures.UNREACHABLE and passes:
        reason = ""
    yield stage.act(arm=stage.robot.arm(), shut=False)
    return Result(not reason, reason, used + 1)
