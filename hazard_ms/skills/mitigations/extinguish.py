"""The skill `extinguish`: the jet of the extinguisher in the hand, aimed at the flames of a thing and around it.

The robot stops as far away as the jet carries well, with the flames in a straight line that no wall is in, and aims at
the flame nearest to it until none is left within AROUND of the thing. What the jet does there is for the fire to say
(hazard_ms.hazards.fire.dousing, .realistic.extinguishing). Limits: it starts to discharge at once when it aims; the
hand stays where it carries; things do not shade each other.
"""

from __future__ import annotations

from typing import Protocol, cast

import numpy as np
import torch
from numpy.typing import NDArray

from hazard_ms.episode.episode import Episode
from hazard_ms.simulation.jet import KINDS
from hazard_ms.simulation.walls import blocked
from hazard_ms.skills import failures
from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import Result
from hazard_ms.skills.mitigations.approach import approach
from hazard_ms.skills.motor.motion import wrap
from hazard_ms.skills.motor.walking import known
from hazard_ms.spec.extinguishers import EXTINGUISHERS

AROUND = 1.0  # of the thing, within which flames on the floor are put out with it [m] [ours]
SHARES = (0.75, 0.5, 0.3)  # of the jet's reach: distances from which it is tried, in turn [ours]
WITHIN = 0.95  # share of the reach from which the jet is opened [ours]
HOT = 100.0  # level at which a thing on the map counts as hot: boiling water [C]
PIN_TIME = 2.0  # to pull the pin and aim before the first discharge [s] [ours]
ONE_FLAME = 150  # frames after which a flame under the jet is given up [ours]
FRAMES = 450  # budget of one action [frames] [ours]


class Endangered(Protocol):
    """The part of an environment that knows of hazards."""

    episode: Episode


def _episode(stage: Stage) -> Episode:
    return cast(Endangered, stage.env).episode


def extinguisher_in_hand(stage: Stage) -> str:
    """The kind of the extinguisher in the hand; empty for none."""
    tools, held = stage.world.equipment, stage.held
    number = -1 if tools is None or held < 0 else int(tools.kinds[0, held])
    return KINDS[number] if number >= 0 else ""


def charge(stage: Stage) -> float:
    """Agent that is left in the extinguisher in the hand [kg]; 0 for none."""
    tools, held = stage.world.equipment, stage.held
    return 0.0 if tools is None or held < 0 else float(tools.state.charge[0, held])


def hot_things(stage: Stage) -> tuple[str, ...]:
    """Names of known things that were hot when last seen, while a charged extinguisher is in the hand."""
    names = [hazard.name for hazard in _episode(stage).hazards]
    if not charge(stage) > 0.0 or "fire" not in names:
        return ()
    k = names.index("fire")
    rows = sorted(stage.seen.objects.items())
    hot = [index for index, seen in rows if len(seen.levels) > k and seen.levels[k] >= HOT and index != stage.held]
    return tuple(stage.labeller.names[index] for index in hot)


def extinguish(stage: Stage, name: str) -> Skill:
    """Put out the thing called `name`, and flames around it."""
    index = stage.labeller.index(name)
    if not extinguisher_in_hand(stage):
        return Result(False, failures.NO_EXTINGUISHER)
    if not known(stage, index):
        return Result(False, failures.UNKNOWN)
    used, pinned, given_up = 0, False, 0
    while used < FRAMES:
        aim = _nearest_flame(stage, index)
        if aim is None:
            return Result(True, frames=used)
        if charge(stage) <= 0.0:
            return Result(False, failures.EMPTY, used)
        if given_up:
            return Result(False, failures.STILL_BURNING, used)
        came = yield from _into_range(stage, aim)
        used += came.frames
        if not came.ok:
            return Result(False, came.reason, used)
        if not pinned:
            for _ in range(round(PIN_TIME / stage.env.control_timestep)):
                yield stage.act()
                used += 1
            pinned = True
        sprayed = yield from _spray(stage, index, aim)
        used += sprayed.frames
        given_up = not sprayed.ok and sprayed.reason == failures.STILL_BURNING
    return Result(False, failures.MAX_FRAMES, used)


def _nearest_flame(stage: Stage, index: int) -> NDArray[np.float64] | None:
    """The place [m], [3], of what burns of the thing `index` or around it, nearest to the hand; None for nothing."""
    flames, thing = _episode(stage).flames(), stage.labeller.thing(index)
    if flames is None:
        return None
    middle = stage.position(thing) if thing >= 0 else stage.seen.objects[index].position
    place = flames.place[0].cpu().numpy().astype(np.float64)
    near = flames.lit[0].cpu().numpy() & (np.hypot(*(place - middle)[:, :2].T) <= AROUND)
    bodies = stage.world.num_bodies
    near[:bodies] &= np.arange(bodies) == thing
    if not near.any():
        return None
    burning = place[near]
    return np.asarray(burning[int(np.linalg.norm(burning - stage.robot.hand(), axis=1).argmin())])


def _in_sight(stage: Stage, aim: NDArray[np.float64]) -> bool:
    """Whether the jet would get from the hand to `aim`, [3] [m]."""
    reach = EXTINGUISHERS[extinguisher_in_hand(stage)].reach
    hand, there = (torch.as_tensor(p[None, None], dtype=torch.float32) for p in (stage.robot.hand(), aim))
    device = stage.world.device
    wall = bool(blocked(stage.world.walls, hand.to(device), there.to(device)).any())
    return not wall and float((there - hand).norm()) <= WITHIN * reach


def _too_hot(stage: Stage) -> bool:
    place = stage.world.agent_position[:, None]
    return bool(_episode(stage).forbidden(place)[0, 0])


def _into_range(stage: Stage, aim: NDArray[np.float64]) -> Skill:
    """Walk to where the jet gets to `aim`, [3] [m]."""
    used, reason = 0, ""
    reach = EXTINGUISHERS[extinguisher_in_hand(stage)].reach
    for share in SHARES:
        if _in_sight(stage, aim):
            return Result(True, frames=used)
        if _too_hot(stage):
            return Result(False, failures.TOO_HOT, used)

        def stop() -> bool:
            return _in_sight(stage, aim) or _too_hot(stage)

        walked = yield from approach(stage, aim, share * reach, WITHIN * reach, stop)
        used, reason = used + walked.frames, walked.reason
        if reason == failures.MAX_FRAMES:
            return Result(False, reason, used)
    if _in_sight(stage, aim):
        return Result(True, frames=used)
    return Result(False, failures.TOO_HOT if _too_hot(stage) else reason or failures.NO_LINE_OF_SIGHT, used)


def _spray(stage: Stage, index: int, aim: NDArray[np.float64]) -> Skill:
    """Discharge at `aim`, [3] [m], and what burns next to it, until something else is nearest, or it is given up."""
    jet, used = stage.world.jet, 0
    assert jet is not None
    rows = torch.zeros(1, dtype=torch.int64, device=stage.world.device)
    kind = extinguisher_in_hand(stage)
    try:
        while used < ONE_FLAME:
            now = _nearest_flame(stage, index)
            if now is None or not np.allclose(now, aim, atol=0.05):
                return Result(True, frames=used)
            if charge(stage) <= 0.0 or not _in_sight(stage, aim):
                return Result(False, failures.NO_LINE_OF_SIGHT, used)
            if _too_hot(stage):
                return Result(False, failures.TOO_HOT, used)
            hand = stage.robot.hand()
            ends = (torch.as_tensor(p[None], dtype=torch.float32, device=rows.device) for p in (hand, aim))
            jet.open(rows, kind, *ends)
            x, y, heading = stage.robot.base()
            yield stage.act(turn=wrap(float(np.arctan2(aim[1] - y, aim[0] - x)) - heading))
            used += 1
        return Result(False, failures.STILL_BURNING, used)
    finally:
        jet.close(rows)
