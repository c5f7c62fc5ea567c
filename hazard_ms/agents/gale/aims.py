"""The aim of an agent without privileges in a gale: it rescues what the wind is likely to carry off.

A target counts its value by the chance that the wind will move it until the end, and a tenth beside. Beside the carts,
the lee is a place to rescue it to, where it is likely enough to stay whichever way the wind turns. So before the front
that is a place between several things that shelter it, and light things go into carts.
"""

from __future__ import annotations

import dataclasses

import numpy as np
from numpy.typing import NDArray

from hazard_ms.agents.gale.carts import BEAM, MOST_LABELS, Push, Pushing
from hazard_ms.agents.gale.course import Array, Course, kept
from hazard_ms.agents.gale.sites import DETOUR, Sites, sites
from hazard_ms.agents.gale.stops import PUT_DOWN, SEEKING, put_away
from hazard_ms.agents.gale.weather import Weather
from hazard_ms.agents.search.outlook import Outlook
from hazard_ms.agents.search.walks import TURNING
from hazard_ms.sketch.planning.orienteering import solve
from hazard_ms.sketch.planning.travel import StaticTravel
from hazard_ms.sketch.travel.ways import WALK
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import DROP, Action, Decision
from hazard_ms.skills.motor.navigation import FLOOR
from hazard_ms.skills.motor.walking import ARRIVED

BESIDE = 0.1  # what a rescue counts of its value beside what it averts [ours]
LIKELY = 0.8  # chance of staying from which a place in the lee is one to rescue to [ours]
SAFE = 0.15  # chance of being moved up to which a target is left where it is [ours]
SHARE = 0.5  # of what is found by searching that is taken to be at risk [measured: 49 % of the value]
MOVED = 0.4  # distance from where it was first seen from which a target has been moved [m]: seen places err by 0.1 m
LOW = 0.15  # height of the middle of what lies on the ground [m] [ours]
EVERY = 4  # of the cells of the map, along each side, in which a site is looked for [ours]
AROUND = 4.0  # distance from a target up to which a site is looked for [m] [ours]
ROLLING = ("bottle", "soda_can")  # what rolls off where it was put down: into carts alone [ours]


class GaleAims:
    """The aim in one episode."""

    def __init__(self, brief: Brief, mitigate: bool = True) -> None:
        """Begin an episode of a task in which a gale blows; `mitigate`: whether it uses the lee, and pushes carts."""
        self._mitigate, self._pushing = mitigate, Pushing()
        self._weather, self._radius = Weather(brief), brief.radius
        (self._withstands,) = (h.withstands for h in brief.hazards if _carries_off(h.withstands, brief))
        self._seconds = brief.frame_seconds
        self._put: dict[str, NDArray[np.float64]] = {}  # where each target was first seen, or last put down [m], [2]
        self.note = ""  # on what `put_away` chose

    def see(self, decision: Decision) -> None:
        """Enter what a decision shows of the wind, and of where things are."""
        self._weather.note(decision)
        last, result = decision.last_action, decision.last_result
        if last is not None and result is not None and last.verb == DROP and result.ok:
            self._put = {name: place for name, place in self._put.items() if name != self._held}
        self._held = decision.held
        for target in decision.targets:
            thing = decision.map.objects.get(target.index)
            if thing is not None and target.name != decision.held:
                self._put.setdefault(target.name, np.asarray(thing.position[:2], np.float64))

    _held: str | None = None

    def aimed(self, decision: Decision, ahead: Outlook) -> Outlook:
        """The outlook with values by what is at risk, and with sites in the lee beside the carts."""
        if not self._weather.known:
            return ahead
        courses = self._weather.courses()
        values = list(ahead.problem.values)
        for number, name in enumerate(ahead.targets):
            risk = 1.0 if name == decision.held else self._risk(decision, name, courses)
            values[number] *= risk + BESIDE if risk > SAFE else 0.0
        for number in range(len(ahead.targets), len(values)):
            values[number] *= SHARE
        problem = dataclasses.replace(ahead.problem, values=values)
        if decision.held is None and ahead.carts and self._mitigate:
            lee = self._sites(decision, ahead, courses)
            drop = [*ahead.problem.drop, *([PUT_DOWN + SEEKING] * len(lee.places))]
            problem = dataclasses.replace(problem, travel=self._travel(decision, ahead, lee), drop=drop)
        return dataclasses.replace(ahead, problem=problem)

    def push(self, decision: Decision, ahead: Outlook) -> Action | None:
        """The push of a cart to begin with, for what `aimed` gave; None where rescues alone are better."""
        if not self._mitigate or not self._weather.known or not ahead.carts or decision.held is not None:
            return None
        count = len(ahead.carts)
        table, drop = StaticTravel(ahead.frames, count), list(ahead.problem.drop)[:count]
        plain = dataclasses.replace(ahead.problem, travel=table, drop=drop)
        wanted = [name for name, worth in zip(ahead.targets, plain.values, strict=False) if worth > 0.0]

        def after(push: Push) -> float:
            if decision.names[push.cart] not in ahead.carts:  # it was given up: no rescue would use it
                return -np.inf
            late = dataclasses.replace(
                plain, travel=self._with_cart_at(decision, ahead, push), frame=plain.frame + push.frames
            )
            return (1.0 - plain.fading * push.frames) * solve(late, MOST_LABELS, BEAM).value

        action = self._pushing.choose(decision, wanted, lambda: solve(plain, MOST_LABELS, BEAM).value, after)
        self.note = self._pushing.note if action is not None else self.note
        return action

    def _with_cart_at(self, decision: Decision, ahead: Outlook, push: Push) -> StaticTravel:
        """The travel of an outlook, without the lee, after a push."""
        goals = len(ahead.targets) + len(ahead.lookouts)
        names = [*ahead.targets, *(mark.name for mark in ahead.lookouts), *ahead.carts]
        places, moved = self._places(decision, names), goals + ahead.carts.index(decision.names[push.cart])
        table = ahead.frames.copy()
        for row, start in ((moved, push.place), (len(names), push.robot)):
            far = np.maximum(np.hypot(*(places - start).T) - ARRIVED, 0.0)
            table[row, :-1] = WALK * DETOUR * far + TURNING
        table[:-1, moved] = table[moved, :-1]
        table[-1, moved] = TURNING
        np.fill_diagonal(table, 0.0)
        return StaticTravel(table, len(ahead.carts))

    def put_away(self, decision: Decision, cart: float) -> Action | None:
        """The next action that puts the held thing into the lee; None where a cart, in `cart` frames, is better."""
        held = decision.held
        if held is None or not self._mitigate or not self._weather.known or decision.target(held).category in ROLLING:
            return None
        courses, category = self._weather.courses(), decision.target(held).category

        def keeps(points: Array) -> NDArray[np.bool_]:
            return self._chances(decision, points, category, courses) >= LIKELY

        found = put_away(decision, self._radius, keeps, cart)
        if found is None:
            return None
        self.note = f"into the lee by {found.action}, {found.frames:.0f} frames"
        return found.action

    def _chances(
        self, decision: Decision, points: Array, category: str, courses: list[tuple[float, Course]]
    ) -> NDArray[np.float64]:
        """The chance that a thing of a `category` stays until the end at each of `points` [m], [P, 2]: [P]."""
        return self._staying(self._pressures(decision, points, courses), category)

    def _pressures(self, decision: Decision, points: Array, courses: list[tuple[float, Course]]) -> list[tuple]:
        raised = np.hstack([points, np.full((len(points), 1), LOW)])
        now = decision.frame * self._seconds
        return [(chance, course.pressure(raised, now)) for chance, course in courses]

    def _staying(self, pressures: list[tuple], category: str) -> NDArray[np.float64]:
        models = self._withstands(category)
        made = [chance * kept(there, limit) / len(models) for chance, there in pressures for limit in models]
        return np.asarray(np.sum(made, axis=0))

    def _risk(self, decision: Decision, name: str, courses: list[tuple[float, Course]]) -> float:
        """The chance that a target will be moved, 1 where it has been."""
        target = decision.target(name)
        place = np.asarray(decision.map.objects[target.index].position[:2], np.float64)
        if float(np.hypot(*(place - self._put.get(name, place)))) > MOVED:
            return 1.0
        return 1.0 - float(self._chances(decision, place[None], target.category, courses)[0])

    def _sites(self, decision: Decision, ahead: Outlook, courses: list[tuple[float, Course]]) -> Sites:
        seen = decision.map
        cells = np.argwhere(seen.explored & (seen.height <= FLOOR))
        ground = seen.origin + (cells[(cells % EVERY == 0).all(1)][:, ::-1] + 0.5) * seen.cell
        goals = self._places(decision, ahead.targets)
        near = np.hypot(*(ground[:, None] - goals[None]).transpose(2, 0, 1)).min(1, initial=np.inf) < AROUND
        ground = ground[near]
        pressures = self._pressures(decision, ground, courses)
        kinds = [decision.target(name).category for name in ahead.targets]
        staying = {kind: self._staying(pressures, kind) >= LIKELY for kind in set(kinds) - set(ROLLING)}
        good = [staying.get(kind, np.zeros(len(ground), bool)) for kind in kinds]
        return sites(ground, np.array(good, bool).reshape(len(kinds), -1), goals)

    def _travel(self, decision: Decision, ahead: Outlook, lee: Sites) -> StaticTravel:
        """The travel of an outlook with sites after its carts."""
        base, count = ahead.problem.travel, len(lee.places)
        nodes = base.targets + base.carts
        names = [*ahead.targets, *(mark.name for mark in ahead.lookouts), *ahead.carts]
        places = np.vstack([self._places(decision, names), np.asarray(decision.agent_position)[None]])
        way = WALK * DETOUR * np.hypot(*(places[:, None] - lee.places[None]).transpose(2, 0, 1)) + TURNING
        table = np.full((nodes + count + 1,) * 2, np.inf)
        for node in range(nodes + 1):
            row = node if node < nodes else nodes + count
            table[row, : base.targets] = [met for met, _ in base.meetings((node, 0), 0.0, range(base.targets))]
            table[row, base.targets : nodes] = base.to_carts((node, 0))
        to = way[: len(lee.keep)].copy()
        to[~lee.keep] = np.inf
        table[: len(lee.keep), nodes : nodes + count] = to
        table[nodes : nodes + count, :nodes] = way[:nodes].T
        np.fill_diagonal(table, 0.0)
        return StaticTravel(table, base.carts + count)

    def _places(self, decision: Decision, names: tuple[str, ...] | list[str]) -> Array:
        """Where things were last seen [m], [N, 2]."""
        things = [decision.map.objects[decision.index(name)].position[:2] for name in names]
        return np.array(things, np.float64).reshape(-1, 2)


def aims_of(brief: Brief, mitigate: bool = True) -> GaleAims | None:
    """The aims of an episode, `mitigate` as for GaleAims; None where no gale blows."""
    return GaleAims(brief, mitigate) if any(_carries_off(h.withstands, brief) for h in brief.hazards) else None


def _carries_off(withstands: object, brief: Brief) -> bool:
    return callable(withstands) and any(withstands(target.category) for target in brief.targets)
