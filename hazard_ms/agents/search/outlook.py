"""The rescue that lies ahead, as an agent believes: a problem for `sketch/planning`, and what its numbers stand for.

Beside the targets that it knows, the problem has the places to search as targets of their own: to go there and look
around is worth what is expected to be found, and takes the time of fetching that.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from hazard_ms.agents.base import known
from hazard_ms.agents.search.forecast import Forecast, unseen_losses
from hazard_ms.agents.search.lookouts import Lookout, lookouts
from hazard_ms.agents.search.memory import Memory, Place, Seen
from hazard_ms.agents.search.walks import TURNING, frames_between
from hazard_ms.sensing.sighting import Sighting
from hazard_ms.sensing.target_table import Target
from hazard_ms.sketch import skill_times
from hazard_ms.sketch.planning.averting import BESIDE, averting
from hazard_ms.sketch.planning.belief import drifted, speed_of
from hazard_ms.sketch.planning.problem import Problem
from hazard_ms.sketch.planning.travel import StaticTravel
from hazard_ms.sketch.travel.ways import WALK
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import WALK_ONE_STEP, WALK_TO, Action, Decision
from hazard_ms.skills.motor.walking import ARRIVED

FOUND_WAY = 1.5  # distance to fetch what is found in a search [m] [ours]
MOST_FOUND = 2.0  # targets that a single search is counted on to find: any more are planned for when found [ours]
# share of what a look should show that a detector does not tell of: 21 looks in floods of `train` led to beliefs in new
# things of 0.45 of the value that was counted on, the last 12 to 0.2 of the number [measured]
OVERLOOKED = 0.6
FOUND_WHOLE = 0.8  # share of its value that a target counts when it has to be found first [ours]
# standard deviation of the frames of a plan over their root: a rescue of 170 frames takes 50 more or less, or fails
SPREAD = 4.0  # [sqrt(frames)] [ours]
LEAST_MISSING = 0.1  # targets that must be expected to be elsewhere for a search to be weighed [ours]
CART_WAY = 6.0  # distance to a cart while none is known [m] [ours]


@dataclass(frozen=True)
class SkillFrames:
    """The frames that skills take on average, and the share of pick-ups that work."""

    pick: float  # of a pick-up that works
    failed_pick: float  # of one that does not
    works: float  # share of the pick-ups that work
    bag: float  # of putting into the bag
    cart: float  # of putting into a cart
    explore: float  # of looking around


@lru_cache
def skill_frames(robot: str) -> SkillFrames:
    """The measured skill frames of a robot; those of Fetch for a robot that was not measured."""
    times = skill_times.shipped(robot)
    works, pick, failed = times.typical(skill_times.PICK_UP)
    rest = (times.typical(skill)[1] for skill in (skill_times.BAG, skill_times.CART, skill_times.EXPLORE))
    return SkillFrames(pick, failed, works, *rest)


@dataclass(frozen=True)
class Weights:
    """The weights by which an agent decides; all are shares from 0 to 1."""

    loyalty: float = 0.1  # of the way to its present goal that is not counted
    fading: float = 0.3  # of its value that a target loses if it is saved at the last frame rather than the first
    search: float = 1.0  # of what may be found that is counted
    caution: float = 0.0  # of SPREAD that is counted: 1 where plans leave time for what goes wrong
    belief: float = 1.0  # of the doubts about what things are that is counted: 0 where all are what they seem to be

    def __post_init__(self) -> None:
        """Raises ValueError unless each is from 0 to 1."""
        for name, share in vars(self).items():
            if not 0.0 <= share <= 1.0:
                raise ValueError(f"{name} must be a share from 0 to 1, got {share!r}")


@dataclass(frozen=True)
class Outlook:
    """The goals, numbered as the targets of `problem`: known targets, then the places to search."""

    targets: tuple[str, ...]
    lookouts: tuple[Lookout, ...]
    carts: tuple[str, ...]
    problem: Problem  # by the aim of the task
    plain: Problem  # by the values of the targets
    frames: NDArray[np.float64]  # of ways between the goals, the carts and, last, the agent, [N, N]
    unseen: float = 0.0  # value that is expected where nothing was seen yet

    def name(self, goal: int) -> str:
        """The thing to which a goal leads."""
        return self.targets[goal] if goal < len(self.targets) else self.lookouts[goal - len(self.targets)].name

    def way(self, goal: int) -> float:
        """The length of the way to a goal from where the agent stands [m]."""
        (met, _), *_ = self.problem.travel.meetings(self.problem.travel.start, 0.0, [goal])
        return max(met - TURNING, 0.0) / WALK

    def way_to_cart(self, cart: int) -> float:
        """The length of the way to one of `carts`, by its number, from where the agent stands [m]."""
        travel = self.problem.travel
        return max(travel.to_carts(travel.start)[cart] - TURNING, 0.0) / WALK

    def to_cart(self, failures: Mapping[str, int]) -> float:
        """Frames in which what is in the hand can be put into the nearest of `carts` without `failures`; inf: none."""
        travel, drop = self.problem.travel, self.problem.drop
        ways = zip(self.carts, travel.to_carts(travel.start), drop, strict=False)
        return min((way + frames for cart, way, frames in ways if not failures.get(cart)), default=np.inf)

    def is_search(self, goal: int) -> bool:
        """Whether a goal is a place to search."""
        return goal >= len(self.targets)


def outlook(brief: Brief, decision: Decision, memory: Memory, weights: Weights, give_up: int) -> Outlook:
    """The rescue that is believed to lie ahead at `decision`; things that failed `give_up` times are left out."""
    failures, times = memory.failures, skill_frames(brief.robot)
    open_ones = [t for t in decision.targets if not t.rescued and failures.get(t.name, 0) < give_up]
    held = [t for t in open_ones if t.name == decision.held]
    there = known(decision, tuple(t.name for t in open_ones if t.name != decision.held))
    seen = [t for t in open_ones if t.name in there]
    unseen = [t for t in open_ones if t.index not in decision.map.objects and t.name != decision.held]
    avoided = [name for name, count in failures.items() if count >= give_up] + _failed_ways(failures, seen)
    carts = tuple(name for name in known(decision, decision.containers) if failures.get(name, 0) < give_up)
    doubts = [weights.belief * (1.0 - t.belief) for t in seen]
    missing, worth = float(len(unseen)), sum(t.value for t in unseen)
    if any(doubts):
        missing, worth = _missing(brief, decision, seen, doubts)
    walls = brief.radius if brief.several_rooms else None
    wanted = missing >= LEAST_MISSING or (held and not carts)
    known_so_far = decision, memory.visits, memory.looks, avoided
    places = lookouts(*known_so_far, walls, brief.sight, doors=True, barred=memory.barred.values()) if wanted else ()
    targets = [*held, *seen]
    frames = _frames(decision, memory, targets, places, carts, weights.loyalty, brief)
    works = [1.0 if t in held else times.works * memory.chance(decision, t.name) for t in targets]
    real = [*(1.0 for _ in held), *(1.0 - doubt for doubt in doubts)]  # what is none of them is refused at once
    picks = [chance * _pick(times, work) for work, chance in zip(works, real, strict=True)]
    works = [work * chance for work, chance in zip(works, real, strict=True)]
    forecast = Forecast(brief, decision, memory.house if brief.several_rooms else memory.fire)
    aims = brief.averted and brief.several_rooms  # a wind damages nothing, so nothing tells what it threatens
    whole = [forecast.whole_until(t, decision.map.objects[t.index]) if t in seen else np.inf for t in targets]
    told = missing * (1.0 - OVERLOOKED if brief.looks else 1.0)
    share = min(1.0, MOST_FOUND / max(sum(mark.share for mark in places) * told, 1e-9))
    found = [mark.share * told * share for mark in places]
    stays = [forecast.stays_until(t, decision.map.objects[t.index]) if t in seen else np.inf for t in targets]
    unseen_lost, damaged_by, gone_by = unseen_losses(brief)
    at_risk = (BESIDE + unseen_lost) / BESIDE if aims else 1.0
    mean = at_risk * weights.search * FOUND_WHOLE * worth / (missing or 1.0)
    put_away = times.bag if not decision.containers else times.cart + (0.0 if carts else CART_WAY * WALK)
    fetch = FOUND_WAY * WALK + _pick(times, times.works) + put_away
    problem = Problem(
        travel=StaticTravel(frames, len(carts)),
        values=[*(t.value * c for t, c in zip(targets, works, strict=True)), *(n * mean for n in found)],
        damaged_at=[*whole, *(np.inf for _ in places)],
        gone_at=[*stays, *(np.inf for _ in places)] if aims else None,
        pick=[*picks, *(times.explore + n * fetch for n in found)],
        drop=[times.cart] * len(carts) if carts else [*(put_away for _ in targets), *(0.0 for _ in places)],
        limit=decision.max_frames,
        frame=decision.frame,
        holding=0 if held else None,
        damaged_share=brief.damaged_share,
        fading=weights.fading / decision.max_frames,
        spread=weights.caution * SPREAD,
    )
    aimed, names = averting(problem) if aims else problem, tuple(t.name for t in targets)
    if aims and unseen_lost:  # measures count what they keep of the unseen, and rescues what they find of it in time
        taken = 1.0 if gone_by < np.inf else 1.0 - brief.damaged_share  # of the value of what is lost
        first, in_time = len(targets), unseen_lost / taken / at_risk
        values = [*problem.values[:first], *(in_time * value for value in problem.values[first:])]
        whole, stays = [*whole, *(damaged_by for _ in places)], [*stays, *(gone_by for _ in places)]
        aimed = averting(replace(problem, values=values, damaged_at=whole, gone_at=stays))
    return Outlook(names, places, carts, aimed, problem, frames, worth)


def _missing(brief: Brief, decision: Decision, seen: Sequence[Target], doubts: Sequence[float]) -> tuple[float, float]:
    """How many targets are expected to be where none is seen, and their value: of each category what beliefs leave."""
    left = Counter(t.category for t in brief.targets)
    left.subtract(Counter(t.category for t in decision.targets if t.rescued or t.held))
    values, count = {t.category: t.value for t in brief.targets}, {kind: float(n) for kind, n in left.items()}
    for target, doubt in zip(seen, doubts, strict=True):
        count[target.category] = count.get(target.category, 0) - (1.0 - doubt)
    missing = {category: max(number, 0.0) for category, number in count.items()}
    return sum(missing.values()), sum(number * values.get(category, 0.0) for category, number in missing.items())


def _pick(times: SkillFrames, works: float) -> float:
    """The frames that a pick-up is expected to take if it works with probability `works`."""
    return works * times.pick + (1 - works) * times.failed_pick


def _failed_ways(failures: Mapping[str, int], targets: Sequence[Target]) -> list[str]:
    """Things, other than targets, to which a walk failed: there are others to search from."""
    names = {target.name for target in targets}
    return [name for name in failures if name not in names]


def _frames(
    decision: Decision,
    memory: Memory,
    targets: Sequence[Target],
    places: Sequence[Lookout],
    carts: Sequence[str],
    loyalty: float,
    brief: Brief,
) -> NDArray[np.float64]:
    """Frames between the targets, the places to search, the carts and, last, where the agent stands, [N, N]."""
    here = np.asarray(decision.agent_position, np.float64)
    names = [*(t.name for t in targets), *(mark.name for mark in places), *carts]
    things = [thing_of(decision, name) for name in names]
    goals = [here if thing is None else np.asarray(thing.position[:2], np.float64) for thing in things]
    for number, mark in enumerate(places, len(targets)):
        goals[number] = np.array(mark.place)
    near = [ARRIVED + (0.0 if thing is None else thing.radius) for thing in things]
    fastest = max((float(np.hypot(*_velocity(track))) for track in memory.tracks.values() if track), default=0.0)
    for number, target in enumerate(targets):
        track = memory.tracks.get(target.name)
        if track and target.name != decision.held:
            arrival = decision.frame + WALK * float(np.hypot(*(goals[number] - here)))
            goals[number] = drifted(*_columns(track), fastest, arrival)
    if not names:
        return np.zeros((1, 1))
    start = decision.agent_position
    frames = frames_between(decision.map, start, np.array(goals), np.array(near), brief.radius, brief.several_rooms)
    for number, name in enumerate(names):
        if decision.last_action in (Action(WALK_TO, name), Action(WALK_ONE_STEP, name)):
            frames[-1, number] *= 1.0 - loyalty
    return frames


def thing_of(decision: Decision, name: str) -> Sighting | None:
    """The thing called `name` as it was last seen; None where it never was, and for openings."""
    return decision.map.objects.get(decision.index(name)) if name in decision.names else None


def _velocity(track: Sequence[Seen]) -> NDArray[np.float64]:
    return speed_of(*_columns(track))


def _columns(track: Sequence[Seen]) -> tuple[list[int], list[Place]]:
    """The frames and the places of a track."""
    return [frame for frame, _ in track], [place for _, place in track]
