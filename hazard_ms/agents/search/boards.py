"""Lists the flood boards that can be set into the outer doors of a home that are known: into one, and into two.

A board is fetched first, unless it is in the hand. Water that comes in where none stands rises on everywhere.
"""

from __future__ import annotations

import itertools
from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple

from hazard_ms.agents.search.house_water import OUTER_DOORS
from hazard_ms.agents.search.memory import Place, apart
from hazard_ms.sensing.door_memory import KnownOpening
from hazard_ms.sketch.travel.ways import WALK
from hazard_ms.skills.decision import PICK_UP, Action, Decision
from hazard_ms.spec.catalogue import FLOOD_BOARD

BLOCK = "block"
SETTING = 190.0  # frames of setting a board before its door [hazard_ms.agents.mitigating.costs]
DETOUR = 1.3  # of a way in a home over the straight line [ours]


class Setting(NamedTuple):
    """Boards set into doors, one after another."""

    doors: tuple[KnownOpening, ...]  # as they are then
    action: Action  # the first
    frames: float  # until the last board stands, but for the way to the last door
    place: Place  # of the last door
    all: bool  # whether no outer door of the home is left without one


def settings(decision: Decision, failures: dict[str, int], tries: int, pick: float) -> list[Setting]:
    """All of them; what failed `tries` times is left out. `pick`: frames of a pick-up."""
    held = next((tool.name for tool in decision.tools if tool.held), None)
    if decision.held is not None and (held is None or not held.startswith(FLOOD_BOARD)):
        return []
    doors = [o for o in decision.openings if o.outer and o.kind == "door" and o.boarded is None]
    doors = [door for door in doors if failures.get(str(Action(BLOCK, door.name)), 0) < tries]
    lying = _lying(decision, failures, tries)
    made = []
    for count in range(1, OUTER_DOORS + 1):
        for order in itertools.permutations(doors, count):
            one = _setting(decision, order, held, lying, pick)
            if one is not None:
                standing = sum(o.boarded is not None for o in decision.openings)
                made.append(one._replace(all=count + standing >= OUTER_DOORS))
    return made


def _lying(decision: Decision, failures: dict[str, int], tries: int) -> dict[str, Place]:
    """The places of the boards that can be picked up, by name."""
    found = {}
    for tool in decision.tools:
        seen = decision.map.objects.get(decision.index(tool.name))
        usable = tool.name.startswith(FLOOD_BOARD) and not tool.held and failures.get(tool.name, 0) < tries
        if usable and seen is not None:
            at = (float(seen.position[0]), float(seen.position[1]))
            if all(o.boarded is None or apart(at, o.position[:2]) > o.width for o in decision.openings):
                found[tool.name] = at
    return found


def _setting(
    decision: Decision, order: Sequence[KnownOpening], held: str | None, lying: dict[str, Place], pick: float
) -> Setting | None:
    """Boards in the doors of `order`, each with the nearest board that is left; None where there are too few."""
    left, here, way, action = dict(lying), decision.agent_position, 0.0, None
    frames, doors = 0.0, []
    for door in order:
        at = (door.position[0], door.position[1])
        if action is not None or held is None:
            if not left:
                return None
            board = min(left, key=lambda name, at=at: apart(left[name], at))  # type: ignore[misc]
            place = left.pop(board)
            way, frames = way + apart(here, place) + apart(place, at), frames + pick
            action = action or Action(PICK_UP, board)
        else:
            way, action = way + apart(here, at), Action(BLOCK, door.name)
        frames, here = frames + SETTING, at
        doors.append(replace(door, boarded=round(decision.frame + frames + DETOUR * WALK * way)))
    if action is None:
        return None
    direct = apart(decision.agent_position, here)
    return Setting(tuple(doors), action, frames + DETOUR * WALK * (way - direct), here, False)
