"""The skill `extinguish`: the jet of the extinguisher in the hand, aimed at what burns of a thing and around it.

The robot aims at the flames that the jet gets to from where it stands, where most are in it first, until none is left
within AROUND of the thing, on its side of walls. Where it gets to none, the robot walks towards the nearest place with
a view of the nearest flame (views.py), until it gets to any. What the jet does there is for
the fire to say (hazard_ms.hazards.fire.dousing, .realistic.extinguishing). The pin is pulled once, before the first
discharge. Limits: it starts to discharge at once when it aims; the hand stays where it carries; things do not shade
each other.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray

from hazard_ms.simulation.jet import KINDS
from hazard_ms.skills import failures
from hazard_ms.skills.context import Skill, Stage
from hazard_ms.skills.decision import Result
from hazard_ms.skills.mitigations.approach import approach
from hazard_ms.skills.mitigations.views import CLOSE, ENOUGH, Place, facing, in_view, nearest_view, sees
from hazard_ms.skills.motor.motion import turn_to, turned, wrap
from hazard_ms.skills.motor.walking import known
from hazard_ms.spec.extinguishers import EXTINGUISHERS

Array = NDArray[np.float64]
AROUND = 2.0  # of the thing, within which flames on the floor are put out with it [m] [ours]
SHARES = (0.75, 0.5, 0.3)  # of the jet's reach: distances from which it is tried [ours]
WITHIN = 0.95  # share of the reach from which the jet is opened [ours]
HOT = 100.0  # level at which a thing on the map counts as hot: boiling water [C]
PIN_TIME = 2.0  # to pull the pin and aim before the first discharge [s] [ours]
SAME = 0.05  # distance up to which a flame is still the one that is aimed at [m] [ours]
ONE_FLAME = 150  # frames after which a flame under the jet is given up [ours]
FRAMES = 450  # budget of one action [frames] [ours]


def extinguisher_in_hand(stage: Stage) -> str:
    """The kind of the extinguisher in the hand; empty for none."""
    tools, held = stage.world.equipment, stage.held
    number = -1 if tools is None or held < 0 else int(tools.kinds[0, held])
    return KINDS[number] if number >= 0 else ""


def charge(stage: Stage) -> float:
    """Agent that is left in the extinguisher in the hand [kg]; 0 for none."""
    tools, held = stage.world.equipment, stage.held
    return 0.0 if tools is None or held < 0 else float(tools.state.charge[0, held])


def _pinned(stage: Stage) -> bool:
    """Whether the pin is still in the extinguisher in the hand: nothing was discharged from it."""
    tools = stage.world.equipment
    return tools is not None and charge(stage) >= float(tools.full[0, stage.held])


def hot_things(stage: Stage) -> tuple[str, ...]:
    """Names of known things that were hot when last seen, while a charged extinguisher is in the hand."""
    names = [hazard.name for hazard in stage.env.episode.hazards]
    if not charge(stage) > 0.0 or "fire" not in names:
        return ()
    k = names.index("fire")
    rows = sorted(stage.seen.objects.items())
    hot = [index for index, seen in rows if len(seen.levels) > k and seen.levels[k] >= HOT and index != stage.held]
    return tuple(stage.labeller.names[index] for index in hot)


def extinguish(stage: Stage, name: str) -> Skill:
    """Put out the thing called `name`, and flames and burning things around it."""
    index = stage.labeller.index(name)
    if not extinguisher_in_hand(stage):
        return Result(False, failures.NO_EXTINGUISHER)
    if not known(stage, index):
        return Result(False, failures.UNKNOWN)
    used, given_up, fought = 0, False, False
    while True:
        if not len(_flames(stage, index)):
            return Result(True, frames=used) if fought else Result(False, failures.NOT_BURNING, used)
        if used >= FRAMES:
            return Result(False, failures.MAX_FRAMES, used)
        if charge(stage) <= 0.0:
            return Result(False, failures.EMPTY, used)
        if given_up:
            return Result(False, failures.STILL_BURNING, used)
        came, aim = yield from _into_range(stage, index, FRAMES - used)
        used += came.frames
        if not came.ok:
            return Result(False, came.reason, used)
        if aim is None:
            continue  # it has burnt out on the way
        if not fought and _pinned(stage):
            for _ in range(round(PIN_TIME / stage.env.control_timestep)):
                yield stage.act()
                used += 1
        fought = True
        sprayed = yield from _spray(stage, index, aim)
        used += sprayed.frames
        given_up = not sprayed.ok and sprayed.reason == failures.STILL_BURNING


def _by_distance(stage: Stage, index: int) -> list[Array]:
    """The places [m], [3], of what burns at the thing `index` or around it, those nearest to the hand first."""
    burning = _flames(stage, index)
    return list(burning[np.argsort(np.linalg.norm(burning - stage.robot.hand(), axis=1), kind="stable")])


def _flames(stage: Stage, index: int) -> NDArray[np.float64]:
    """The places [m], [N, 3], of what burns at the thing `index` or around it."""
    flames, thing = stage.env.episode.flames(), stage.labeller.thing(index)
    if flames is None:
        return np.zeros((0, 3))
    middle = np.asarray(stage.position(thing) if thing >= 0 else stage.seen.objects[index].position, np.float64)
    place = flames.place[0].cpu().numpy().astype(np.float64)
    near = flames.lit[0].cpu().numpy() & (np.hypot(*(place - middle)[:, :2].T) <= AROUND)
    return place[near][in_view(stage, place[near], middle)]


def _in_sight(stage: Stage, aim: NDArray[np.float64]) -> bool:
    """Whether the jet would get from the hand to `aim`, [3] [m]."""
    reach, hand = WITHIN * EXTINGUISHERS[extinguisher_in_hand(stage)].reach, stage.robot.hand()
    return bool(in_view(stage, hand[None], aim)[0]) and float(np.linalg.norm(aim - hand)) <= reach


def _carried(stage: Stage) -> NDArray[np.float64]:
    """Where the hand is [m], [3]: ahead of the middle of the base, to its left, and over the floor."""
    x, y, heading = stage.robot.base()
    return turned(stage.robot.hand() - (x, y, 0.0), (0.0, 0.0), -heading)


def _too_hot(stage: Stage) -> bool:
    place = stage.world.agent_position[:, None]
    return bool(stage.env.episode.forbidden(place)[0, 0])


def _into_range(stage: Stage, index: int, frames: int) -> Generator[Any, Any, tuple[Result, Array | None]]:
    """Get into range of a flame around the thing `index`, and turn to it, in at most `frames`: its place [m], [3].

    None where nothing burns there any more.
    """
    used, tried, missed = 0, set[Place](), list[Array]()
    reach = EXTINGUISHERS[extinguisher_in_hand(stage)].reach

    def ready() -> Array | None:
        """The flame to aim at from here once it has turned: with the most others in the jet, then the nearest."""
        here, carried, burning = np.array([stage.robot.base()[:2]]), _carried(stage), _by_distance(stage, index)
        nozzles = [facing(here, flame, carried)[0] for flame in burning]
        rows = [
            (nozzle, flame)
            for nozzle, flame in zip(nozzles, burning, strict=True)
            if float(np.linalg.norm(nozzle - flame)) <= WITHIN * reach
            and not any(np.abs(flame - other).max() < SAME for other in missed)
            and bool(sees(stage, here, flame, carried)[0])
        ]
        return max(rows, key=lambda row: _covered(stage, row[0], row[1], burning))[1] if rows else None

    while burning := _by_distance(stage, index):
        if _too_hot(stage):
            return Result(False, failures.TOO_HOT, used), None
        aim = ready()
        if aim is not None and _in_sight(stage, aim):
            return Result(True, frames=used), aim
        if aim is not None:
            faced = yield from turn_to(stage, aim, max(0, frames - used))
            used += faced.frames
            if not faced.ok:
                return Result(False, faced.reason, used), None
            if not _in_sight(stage, aim):
                missed.append(aim)
            continue
        stand = nearest_view(stage, burning[0], [share * reach for share in SHARES], _carried(stage), tried)
        if stand is None:
            return Result(False, failures.NO_LINE_OF_SIGHT, used), None
        tried.add(stand)
        missed.clear()

        def arrived() -> bool:
            return ready() is not None or _too_hot(stage)

        walked = yield from approach(stage, np.array(stand), CLOSE, ENOUGH, arrived, frames - used)
        used += walked.frames
        if walked.reason == failures.MAX_FRAMES:
            return Result(False, walked.reason, used), None
    return Result(True, frames=used), None


def _covered(stage: Stage, nozzle: Array, aim: Array, burning: Sequence[Array]) -> int:
    """The number of flames `burning` [m], [3] each, in the jet from a `nozzle` [m], [3], to `aim` [m], [3]."""
    kind = EXTINGUISHERS[extinguisher_in_hand(stage)]
    ways, along = np.stack(burning) - nozzle, (aim - nozzle) / np.linalg.norm(aim - nozzle)
    lengths = np.linalg.norm(ways, axis=1)
    return int(((ways @ along >= np.cos(kind.angle) * lengths) & (lengths <= kind.reach)).sum())


def _spray(stage: Stage, index: int, aim: NDArray[np.float64]) -> Skill:
    """Discharge at `aim`, [3] [m], and what burns next to it, until that is out, or it is given up."""
    (jet, *_), used = stage.world.jets, 0
    rows = torch.zeros(1, dtype=torch.int64, device=stage.world.device)
    kind = extinguisher_in_hand(stage)
    try:
        while used < ONE_FLAME:
            if not (np.abs(_flames(stage, index) - aim).max(1, initial=0.0) < SAME).any():
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
