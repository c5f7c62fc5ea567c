"""The skill `block`: a flood board is set into the rails of a doorway, and holds water back up to its own height.

Boards are boxes called `flood_board_1` and so on that are no targets: as long as the opening is wide, upright, light
enough for the arm. Water that stands h deep presses with rho g w h^2 / 2 on one that is let down into it, and the arm
must press as hard. Floods of `paper` have rails where their water comes in, at the outer doors of homes, and press on
nothing. Limits: a board that stands is in nobody's way, and is not lifted out again; water deeper than it passes as if
it were not there.
"""

from __future__ import annotations

import numpy as np

from hazard_ms.sensing.door_memory import KnownOpening
from hazard_ms.skills import failures
from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import Result
from hazard_ms.skills.mitigations.approach import approach
from hazard_ms.skills.motor.arm import REACH_FRAMES, fold, follow, lacking, posture_for
from hazard_ms.skills.motor.grasping import SHUT_FRAMES
from hazard_ms.skills.motor.reaching import STAND_OFF
from hazard_ms.skills.motor.routes import quickest
from hazard_ms.skills.motor.surface import Leg, Place, Surface
from hazard_ms.spec.robot import GRASP_REACH

HOLD = 0.5  # height of the hand at which it lets a board down [m] [ours]
SETTING = 5.0  # to let it down into its rails and press it tight [s] [ours: rails and seals are there]
WEIGHT = 1000.0 * 9.81  # of water [N/m^3]


def gaps(stage: Stage) -> tuple[str, ...]:
    """Names of the known doors and doorways that the board in the hand closes."""
    return tuple(o.name for o in stage.doors.rows() if _has_rails(stage, o) and _fits(stage, o))


def block(stage: Stage, name: str) -> Skill:
    """Set the board in the hand into the door or doorway called `name`."""
    known = stage.doors.find(name)
    if known is None:
        return Result(False, failures.UNKNOWN)
    if not _has_rails(stage, known):
        return Result(False, failures.NO_RAILS)
    if not _fits(stage, known):
        return Result(False, failures.NO_BOARD)
    tools, held = stage.world.equipment, stage.held
    assert tools is not None
    foot = tools.stand[0, known.number].cpu().numpy().astype(np.float64)
    goal = foot + np.array([0.0, 0.0, HOLD])
    nearest, farthest = stage.robot.build.span(HOLD)
    walked = yield from approach(stage, goal, max(nearest, STAND_OFF * farthest), farthest + GRASP_REACH)
    if not walked.ok:
        return walked
    place = Place(goal, known.width / 2, 0.0, 2.5)
    x, y, _ = stage.robot.base()
    towards = np.array([x - goal[0], y - goal[1], 0.0])
    posture = posture_for(stage, goal + 0.1 * towards / max(float(np.hypot(*towards[:2])), 1e-6))
    used = walked.frames
    route = quickest(stage, [Leg(posture.arm, 0.0)], Surface(stage, place), lacking(stage))
    used += (yield from follow(stage, route)).frames
    reason = "" if float(np.linalg.norm(stage.robot.hand() - goal)) < 2 * GRASP_REACH else failures.UNREACHABLE
    arm = stage.robot.arm()
    for _ in range(0 if reason else round(SETTING / stage.env.control_timestep)):
        if _pressing(stage, known) > stage.robot.build.pull:
            reason = failures.TOO_DEEP
            break
        yield stage.act(arm=arm)
        used += 1
    opened = 0
    if not reason:
        tools.state.stands_in[0, held] = known.number
        while opened < REACH_FRAMES and (opened < SHUT_FRAMES or stage.held >= 0):
            yield stage.act(arm=arm, shut=False)
            opened += 1
    used += opened + (yield from fold(stage, place)).frames
    return Result(not reason, reason, used)


def _has_rails(stage: Stage, o: KnownOpening) -> bool:
    """Whether a board can stand in an opening: doors and doorways where water flows, else where it comes in."""
    if o.kind == "window" or "water" not in stage.world.fields:
        return False
    if stage.env.episode.loads_openings:
        return True
    through = any(getattr(hazard, "through_doors", False) for hazard in stage.env.episode.hazards)
    return through and bool(stage.world.openings.plan.inlet[0, o.number])


def _fits(stage: Stage, o: KnownOpening) -> bool:
    """Whether a board as long as the opening is in the hand, and none stands there."""
    tools, held = stage.world.equipment, stage.held
    if tools is None or held < 0 or not bool(tools.board[0, held]):
        return False
    return float(stage.world.extent[0, held, 0]) >= o.width and not bool((tools.state.stands_in[0] == o.number).any())


def _pressing(stage: Stage, o: KnownOpening) -> float:
    """Force [N] of the water on a board that is let down into the opening; of `paper` none."""
    if not stage.env.episode.loads_openings:
        return 0.0
    beside = stage.world.openings.plan.beside[:1, o.number]
    level = float(stage.world.fields["water"](beside.expand(stage.world.num_envs, -1, -1).contiguous()).max())
    return 0.5 * WEIGHT * o.width * max(0.0, level) ** 2
