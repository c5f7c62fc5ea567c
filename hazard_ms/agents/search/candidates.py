"""Lists what can be done about the hazards of a home: fires to put out, or to look for with an extinguisher, and doors.

Limits: doors are shut on water alone, since in fires of the paper there is a fire in most rooms, and what burns behind
a shut door burns on.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hazard_ms.agents.search.boards import BLOCK, settings
from hazard_ms.agents.search.floor_plan import FloorPlan, shut_doors
from hazard_ms.agents.search.forecast import FIRE, RISK, STRIDE, WATER, Forecast
from hazard_ms.agents.search.house_fire import HouseFire, Seat
from hazard_ms.agents.search.house_water import HouseWater
from hazard_ms.agents.search.lookouts import HERE, fire_lookouts
from hazard_ms.agents.search.memory import Memory
from hazard_ms.agents.search.outlook import Outlook, skill_frames, thing_of
from hazard_ms.sensing.door_memory import KnownOpening
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import EXPLORE, PICK_UP, WALK_TO, Action, Decision, Tool
from hazard_ms.skills.motor.walking import ARRIVED
from hazard_ms.spec.extinguishers import EXTINGUISHERS

EXTINGUISH, SHUT = "extinguish", "shut"
HOT = 100.0  # level from which a thing can be named to the skill: boiling water [C]
AROUND = 1.8  # distance from a thing within which the skill finds flames, less the error of where they are [m] [ours]
SEEN_FROM = 3.5  # distance up to which things beside a fire come into sight [m] [ours]: a room
PART_OF_FIRE = 0.3  # share of a fire's flames that is around what it can be named by [ours]
JET = 15.0  # frames of the jet that a flame takes while they are few [measured: 13 to 14 for 4 and 5 flames]
FACED, LONGER = 40.0, 1.5  # frames until the jet is open, and of a fire for each of the jet [ours]
PIN = 60.0  # frames of pulling the pin, once [hazard_ms.skills.mitigations.extinguish: 2 s]
DOUBLING = 280.0  # frames in which flames become twice as many: 41 after 1,500 frames [measured]
SHUTTING = 250.0  # frames of shutting a door from before it [hazard_ms.agents.mitigating.costs]
TRIES = 2  # failures of one measure, after which it is given up [ours]
STANDS = 0.7  # distance from a door at which it is shut [m] [ours]
JET_WAY = 2.5  # distance from flames at which a jet is opened [m] [ours]
LARGE = 1.5  # charges that a fire may take and still be fought with one [ours]
FIRES = 4  # that a home begins with [hazard_ms.scenes.generate.house.homes]
# share of the value of unseen targets that a fire burns [measured: four homes of `train` lose 0.24 to 0.42 to four]
UNSEEN_SHARE = 0.09
# frames by which a fire has burned each fifth of it, and half a fight later [measured: the same, 830 to 1,500]
BURNT_BY = (900.0, 1000.0, 1150.0, 1350.0, 1600.0)
# share of the value of unseen targets that water spoils in a room that it reaches: half of what is in one of seven
ROOM_SHARE = 0.07  # [ours]
LOOKED = 0.3  # of this share where it has looked around in there [ours]
AWASH = 0.05  # level at a door from which the room behind it is counted as wet [m] [ours]
BEHIND = 0.6  # distance from a door at which it is told whether it stays dry behind it [m] [ours]
HALF = 0.5  # of what water spoils that boards come in time for [ours]
WET_BY = (800.0, 1300.0, 1800.0, 2300.0)  # frames by which a quarter each of it does [ours: a guess]
MOST_DOORS = 6  # that are weighed at a time: those that close off most [ours]

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Candidate:
    """Something that can be done: its first action, where, and what it is good for."""

    name: str
    action: Action
    place: tuple[float, float]  # [m]
    near: float  # distance from there at which it is begun [m]
    frames: float
    spares: Sequence[float]  # frame until which each known target of the outlook is whole then
    guards: str = ""  # what keeps from harm what was never seen: the fire that is put out, or the door; empty: nothing
    unseen: float = 0.0  # value that is expected to be lost without that beside the known targets that it spares
    unseen_at: tuple[float, ...] = ()  # frames at which equal parts of it are
    tool: str = ""  # name of the tool that it needs
    uses: float = 0.0  # frames of the tool's charge
    charge: float = 0.0  # frames that the tool lasts that it fetches
    stays: Sequence[float] | None = None  # frame until which each known target stays where it is then; None: as it is
    stand: tuple[float, float] | None = None  # from which it is done, where that is known [m]
    closes: tuple[int, ...] = ()  # known targets that cannot be fetched any more


def candidates(
    brief: Brief, decision: Decision, memory: Memory, ahead: Outlook, put_down: dict[str, int]
) -> list[Candidate]:
    """All that can be done about the hazards; `put_down` says how often each tool was put down."""
    names = [hazard.name for hazard in brief.hazards]
    made = []
    if EXTINGUISH in brief.mitigations and FIRE in names:
        made += _fires(brief, decision, memory, ahead, names.index(FIRE), put_down)
    if BLOCK in brief.mitigations and WATER in names:
        made += _boards(brief, decision, memory, ahead)
    if SHUT in brief.mitigations and WATER in names and decision.held is None:
        made += _doors(brief, decision, memory, ahead, names.index(WATER))
    return made


def _fires(
    brief: Brief, decision: Decision, memory: Memory, ahead: Outlook, number: int, put_down: dict[str, int]
) -> list[Candidate]:
    fetches = [_fetch(brief, decision, tool, ahead) for tool in decision.tools if _usable(decision, tool, put_down)]
    fetches = [one for one in fetches if memory.failures.get(str(one.action.target), 0) < TRIES]
    made, grown = list[Candidate](), 2.0 ** (decision.frame / DOUBLING)
    for k, seat in enumerate(memory.house.seats if fetches else ()):
        name = _named(decision, memory, seat, number)
        action = _nearer(decision, memory, seat) if name is None else Action(EXTINGUISH, name)
        if action is None:
            continue
        spares, _ = _spared(brief, decision, memory.house, ahead, without=(k,))
        stand = memory.house.stand(seat, decision.agent_position, JET_WAY)
        seen = max(seat.flames, 1.0) * 2.0 ** ((decision.frame - seat.seen) / DOUBLING)
        flames = float(np.sqrt(seen * max(seen, grown)))  # a map shows a part of a fire
        for fetch in fetches:
            uses = min(JET * flames, fetch.charge)
            if JET * flames > LARGE * fetch.charge:
                continue  # far more than it can put out
            what = f"put out the fire at {action.target}"
            guards = f"fire {k}", UNSEEN_SHARE * ahead.unseen, BURNT_BY
            frames = FACED + LONGER * uses
            made.append(
                Candidate(what, action, seat.place, JET_WAY, frames, spares, *guards, fetch.name, uses, stand=stand)
            )
    return [*fetches, *made, *_patrols(brief, decision, memory, ahead, fetches)]


def _patrols(
    brief: Brief, decision: Decision, memory: Memory, ahead: Outlook, fetches: Sequence[Candidate]
) -> list[Candidate]:
    """Looks for the fires that were never seen, with one of the tools in the hand that `fetches` fetch."""
    left = FIRES - len(memory.house.places)
    flames = 2.0 ** (decision.frame / DOUBLING)
    able = [fetch for fetch in fetches if JET * flames <= LARGE * fetch.charge]
    if left <= 0 or not able:
        return []
    worth = UNSEEN_SHARE * sum(target.value for target in decision.targets if not target.rescued)
    failed = [name for name, count in memory.failures.items() if count >= TRIES]
    made = []
    for mark in fire_lookouts(decision, memory.visits, memory.looks, failed, brief.radius, memory.house.places):
        expected = left * mark.share
        what = "look for fires from here" if mark.name == HERE else f"look for fires at {mark.name}"
        guards = f"fires at {mark.name}", worth * expected, BURNT_BY
        nothing = [0.0] * len(ahead.targets)
        action = Action(EXPLORE) if mark.name == HERE else Action(WALK_TO, mark.name)
        for fetch in able:
            uses = min(JET * flames, fetch.charge)
            frames = min(expected, 1.0) * (FACED + LONGER * uses)  # the look itself finds targets, too
            used = uses * expected
            made.append(Candidate(what, action, mark.place, ARRIVED, frames, nothing, *guards, fetch.name, used))
    return made


def _usable(decision: Decision, tool: Tool, put_down: dict[str, int]) -> bool:
    """Whether a tool is in the hand, or an empty hand can take it, and it still holds something."""
    there = tool.held or Action(PICK_UP, tool.name) in decision.available
    return bool(tool.kind) and tool.left > 0.02 and there and put_down.get(tool.name, 0) < TRIES


def _fetch(brief: Brief, decision: Decision, tool: Tool, ahead: Outlook) -> Candidate:
    seen = decision.map.objects.get(decision.index(tool.name))
    place = decision.agent_position if seen is None or tool.held else seen.position[:2].tolist()
    charge = EXTINGUISHERS[tool.kind].seconds * tool.left / brief.frame_seconds
    near = ARRIVED + (0.0 if seen is None else seen.radius)
    frames = skill_frames(brief.robot).pick + (PIN if tool.left >= 1.0 else 0.0)
    nothing = [0.0] * len(ahead.targets)
    action = Action(PICK_UP, tool.name)
    return Candidate(tool.name, action, (place[0], place[1]), near, frames, nothing, charge=charge)


def _named(decision: Decision, memory: Memory, seat: Seat, number: int) -> str | None:
    """The thing to name for putting out a fire: with most of its flames around it, if possible a hot one; else None."""
    best, name = (PART_OF_FIRE, False), None
    for index, seen in decision.map.objects.items():
        thing = decision.names[index]
        if len(seen.levels) <= number or thing == decision.held:
            continue
        if memory.failures.get(str(Action(EXTINGUISH, thing)), 0) >= TRIES:
            continue
        around = round(memory.house.share_around(seat, seen.position[:2].astype(np.float64), AROUND), 1)
        if (around, bool(seen.levels[number] >= HOT)) > best:
            best, name = (around, bool(seen.levels[number] >= HOT)), thing
    return name


def _nearer(decision: Decision, memory: Memory, seat: Seat) -> Action | None:
    """A walk to what is nearest to a fire that nothing can be named for yet, to look around; None where nothing is."""
    things = {decision.names[index]: seen.position for index, seen in decision.map.objects.items()}
    things |= {o.name: np.array(o.position) for o in decision.openings if o.kind != "window"}
    things.pop(str(decision.held), None)
    left = [name for name in things if not memory.visits.get(name) and memory.failures.get(name, 0) < TRIES]
    ways = [float(np.hypot(*(things[name][:2] - seat.place))) for name in left]
    return Action(WALK_TO, left[int(np.argmin(ways))]) if ways and min(ways) < SEEN_FROM else None


def _doors(brief: Brief, decision: Decision, memory: Memory, ahead: Outlook, number: int) -> list[Candidate]:
    seen, shut = decision.map, shut_doors(decision.openings)
    water = HouseWater(seen, number, FloorPlan(seen, shut))
    frames = np.arange(decision.frame, decision.max_frames, STRIDE, dtype=np.float64)
    known = [thing_of(decision, name) for name in ahead.targets]
    goals = [None if thing is None else thing.position for thing in known] + [np.array(m.place) for m in ahead.lookouts]
    made = []
    for door in decision.openings:
        action = Action(SHUT, door.name)
        if door.kind != "door" or action not in decision.available or memory.failures.get(str(action), 0) >= TRIES:
            continue
        plan = FloorPlan(seen, (*shut, door))
        away = plan.ways_from(decision.agent_position)
        others = [plan.reached(away, np.array(o.position)) for o in decision.openings if o not in (door, *shut)]
        if sum(others) < 0.5 * len(others):
            continue  # it would lock itself in
        closes = [k for k, at in enumerate(goals) if at is not None and not plan.reached(away, at)]
        closes += [k for k, mark in enumerate(ahead.lookouts, len(known)) if mark.name == door.name and k not in closes]
        wet = (water.at([door.position[:2]], frames)[:, 0] >= AWASH).argmax()
        inside = any(not plan.reached(away, np.array(place)) for place in memory.looks)
        keeps = wet > 0 and _keeps_dry(HouseWater(seen, number, plan), plan, away, door, frames)
        share = ROOM_SHARE * (LOOKED if inside else 1.0) if keeps else 0.0
        if closes or share:
            spares, stays = _spared(brief, decision, memory.house, ahead, shut=(door,))
            guards = door.name, share * ahead.unseen, (float(frames[wet]),)
            what = f"shut {door.name}", action, door.position[:2], STANDS, SHUTTING, spares
            made.append(Candidate(*what, *guards, stays=stays, closes=tuple(closes)))
    return sorted(made, key=lambda one: -one.unseen - len(one.closes))[:MOST_DOORS]


def _boards(brief: Brief, decision: Decision, memory: Memory, ahead: Outlook) -> list[Candidate]:
    made = []
    for one in settings(decision, memory.failures, TRIES, skill_frames(brief.robot).pick):
        names = " and ".join(door.name for door in one.doors)
        spares, stays = _spared(brief, decision, memory.house, ahead, boarded=one.doors)
        guards = names, RISK[WATER] * HALF * ahead.unseen if one.all else 0.0, WET_BY
        what = f"set boards into {names}", one.action, one.place, STANDS, one.frames, spares
        made.append(Candidate(*what, *guards, stays=stays))
    return made


def _keeps_dry(water: HouseWater, plan: FloorPlan, away: Array, door: KnownOpening, frames: Array) -> bool:
    """Whether it stays dry just behind a `door` once it is shut, where `away` does not lead; `water`: that to come."""
    beside = np.array(door.position[:2]) + BEHIND * np.array([(1, 0), (-1, 0), (0, 1), (0, -1)])
    behind = [point for point in beside if plan.seen_at(point) and not plan.reached(away, point)]
    return bool(behind) and bool(water.at(behind, frames).max() < AWASH)


def _spared(
    brief: Brief, decision: Decision, fire: HouseFire, ahead: Outlook, **done: Sequence
) -> tuple[list[float], list[float]]:
    """The frames until which each target of the outlook is whole, and stays, if that is done: see `Forecast`."""
    forecast = Forecast(brief, decision, fire, **done)
    targets = [decision.target(name) for name in ahead.targets]
    rows = [(t, decision.map.objects.get(t.index)) for t in targets]
    both = forecast.whole_until, forecast.stays_until
    whole, stays = ([np.inf if seen is None else until(t, seen) for t, seen in rows] for until in both)
    return whole, stays
