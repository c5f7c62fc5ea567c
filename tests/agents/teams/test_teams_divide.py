"""How teams divide the work: auctions and joint plans, by hand."""

from __future__ import annotations

import math
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from hazard_ms.agents.planner import Planner
from hazard_ms.agents.search.outlook import Outlook
from hazard_ms.agents.teams.auction import Auction
from hazard_ms.agents.teams.joint import Joint
from hazard_ms.agents.teams.sharing import places_of
from hazard_ms.sketch.planning.problem import Problem
from hazard_ms.sketch.planning.travel import StaticTravel
from hazard_ms.skills.decision import EXPLORE, PICK_UP, WALK_TO, Action, Result
from hazard_ms.skills.failures import MAX_FRAMES


def decision(place: tuple[float, float], seen: dict[str, tuple[float, float]], **more: Any) -> Any:
    """What an auction reads of a decision: place [m], and targets that were seen, with their places [m]."""
    names = tuple(sorted({"a", "b", "c", "d", *seen}))
    sighting = {names.index(n): SimpleNamespace(position=np.array([*at, 0.5]), missing=False) for n, at in seen.items()}
    rows = tuple(SimpleNamespace(name=n, rescued=n in more.get("rescued", ())) for n in names)
    return SimpleNamespace(
        agent_position=place,
        held=more.get("held"),
        targets=rows,
        map=SimpleNamespace(objects=sighting),
        index=names.index,
        names=names,
        containers=(),
    )


def test_an_auction_gives_each_target_to_the_robot_that_gets_there_with_the_least_travel() -> None:
    """By hand, with robots at x = 0 and 10 m; a pick-up counts as 1 m.

    a at 1 m: bid 1 of r0. d at 9 m: bid 1 of r1. b at 2 m: 1 + 1 + 1 = 3 of r0. c at 4.6 m: r0 is at b after 4 m and
    bids 6.6, r1 is at d after 2 m and bids 6.4.
    """
    player, spots = Auction(), {"a": (1.0, 0.0), "b": (2.0, 0.0), "c": (4.6, 0.0), "d": (9.0, 0.0)}
    player._agents = {n: SimpleNamespace(has_given_up=lambda name: False) for n in ("r0", "r1")}  # type: ignore[misc]
    player._aims = {}
    player._last = {"r0": decision((0.0, 0.0), spots), "r1": decision((10.0, 0.0), spots)}
    assert player._allocated(player._last["r0"]) == {"a": "r0", "b": "r0", "c": "r1", "d": "r1"}
    player._last["r1"] = decision((10.0, 0.0), {})  # it has seen nothing, so it bids for nothing
    assert player._allocated(player._last["r0"]) == dict.fromkeys("abcd", "r0")
    player._last["r1"] = decision((10.0, 0.0), spots)
    player._aims = {"r1": "a"}  # on its way there
    won = player._allocated(decision((0.0, 0.0), spots, rescued=("d",)))
    assert won == {"a": "r1", "b": "r0", "c": "r0"}
    player._aims, near = {}, {"a": (1.0, 0.0), "b": (4.0, 0.0)}  # r0 goes on from a: 1 + 1 + 3 = 5, before 5.5 of r1
    player._last = {"r0": decision((0.0, 0.0), near), "r1": decision((9.5, 0.0), near)}
    assert player._allocated(player._last["r0"]) == {"a": "r0", "b": "r0"}


def lying_ahead(at: float, limit: float = 60.0) -> Outlook:
    """What lies ahead of a robot at `at` [m] on a line, 10 frames to the metre: a at 5 m is worth 5, b at 6 m 3."""
    places = np.array([5.0, 6.0, at])
    ways = StaticTravel(10.0 * np.abs(places[:, None] - places))
    whole = [math.inf] * 2
    problem = Problem(ways, values=[5.0, 3.0], damaged_at=whole, pick=[10.0] * 2, drop=[0.0] * 2, limit=limit)
    return Outlook(("a", "b"), (), (), problem, problem, 10.0 * np.abs(places[:, None] - places))


def test_a_joint_plan_leaves_to_others_what_they_alone_can_fetch() -> None:
    """Robots at 0 and 10 m have 60 frames: r0 gets to a alone, r1 to a or to b. Together they save 8, r1 first 5."""
    team = Joint()
    team._ahead, team._aims, team._rescued = {}, {}, set()
    assert team.shared("r0", lying_ahead(0.0)).problem.values == (5.0, 3.0)
    assert team.shared("r1", lying_ahead(10.0)).problem.values == (0.0, 3.0)
    team._rescued = {"a"}  # r0 knows it, too, once it is asked
    assert team.shared("r1", lying_ahead(10.0)).problem.values == (0.0, 3.0)
    team._rescued, team._aims = set(), {"r0": "b"}  # on its way there, whatever would be better
    assert team.shared("r1", lying_ahead(10.0)).problem.values == (5.0, 0.0)
    assert team.fetched("r0") == set() and team.fetched("r1") == {"b"}


def test_a_robot_is_not_robbed_of_what_it_is_on_its_way_to() -> None:
    """r0 at 10 m can fetch a or b, r1 at 0 m a alone: r0 would leave a to it, unless it is on its way to a."""
    team = Joint()
    team._ahead, team._aims, team._rescued = {}, {}, set()
    assert team.shared("r1", lying_ahead(0.0)).problem.values == (5.0, 3.0)
    assert team.shared("r0", lying_ahead(10.0)).problem.values == (0.0, 3.0)
    team._aims = {"r0": "a"}
    assert team.shared("r0", lying_ahead(10.0)).problem.values == (5.0, 3.0)


class Fixed(Joint):
    """A team of one robot, r0, that is at `place` and always does `action`; `known`: its aims while it chose."""

    def __init__(self, place: tuple[float, float], action: Action) -> None:
        super().__init__()
        self.reset({})
        self.place, self.action, self.known = place, action, dict[str, str]()
        self._partners = {"r0": SimpleNamespace(act=self._chosen, note="")}  # type: ignore[dict-item]

    def _chosen(self, _: Any) -> Action:
        self.known = dict(self._aims)
        return self.action

    def asked(self, result: Result | None) -> None:
        seen = {"a": (5.0, 0.0)}
        more = {"last_result": result, "tools": (), "walked_up_to": None}
        told = decision(self.place, seen)
        self.act({"r0": SimpleNamespace(**{**vars(told), **more})})  # type: ignore[dict-item]


def test_a_robot_keeps_its_aim_while_its_walk_is_unfinished() -> None:
    team = Fixed((0.0, 0.0), Action(WALK_TO, "a"))
    team.asked(None)
    for result, kept in ((Result(False, MAX_FRAMES, 100), {"r0": "a"}), (Result(True, frames=60), {})):
        team.asked(result)
        assert team.known == kept and team.fetched("r1") == {"a"}
    team.action = Action(EXPLORE)
    team.asked(Result(False, MAX_FRAMES, 100))
    assert team.fetched("r1") == set()


def test_work_keeps_others_away_once_a_robot_will_soon_be_there() -> None:
    """a lies at 5 m: a walk from 0.9 m leaves the place to others, one from 1.1 m does not, nor does a reach."""
    for x, action, busy in ((0.9, WALK_TO, False), (1.1, WALK_TO, True), (0.9, PICK_UP, True)):
        team = Fixed((x, 0.0), Action(action, "a"))
        team.asked(None)
        assert team.crowded("r1", [(5.5, 0.0)]) == busy
        assert not team.crowded("r1", [(x, 0.5)])  # it does not stay where it is, or works elsewhere


def test_nobody_begins_within_reach_of_where_another_robot_works() -> None:
    """r1 works at 1.5 m: a at 0.4 m and b at 3.4 m are nearer than 2 m to it, c at 3.6 m is not; d was not seen."""
    team, seen = Joint(), {"a": (0.4, 0.0), "b": (3.4, 0.0), "c": (3.6, 0.0)}
    team._work, team._stands = {"r1": [(1.5, 0.0)], "r0": [(3.6, 0.0)]}, {}
    told = decision((0.0, 0.0), seen)
    near = {name: team.crowded("r0", places_of(told, Action(WALK_TO, name))) for name in "abcd"}
    assert near == {"a": True, "b": True, "c": False, "d": False}
    team._work, team._stands = {}, {"r1": (2.5, 0.0), "r0": (0.4, 0.0)}  # it stands: b and c are nearer than 1.2 m
    near = {name: team.crowded("r0", places_of(told, Action(WALK_TO, name))) for name in "abcd"}
    assert near == {"a": False, "b": True, "c": True, "d": False}
    told.containers = ("b", "c")  # the cart at hand is b
    assert places_of(told, Action("push", "c")) == [(3.4, 0.0), (3.6, 0.0)]
    team._ahead, team._aims, team._rescued = {}, {}, set()
    assert team.shared("r0", lying_ahead(0.0), {"a"}).problem.values == (0.0, 3.0)


def test_two_do_not_wait_for_each_other_for_ever(monkeypatch: pytest.MonkeyPatch) -> None:
    """Near to where another robot stands it looks around three times, then walks up to the thing and takes it."""
    walk, take = Action(WALK_TO, "a"), Action(PICK_UP, "a")
    team = Joint()
    team.reset({})
    team._stands = {"r1": (0.5, 0.0)}
    partner, chosen, done = team._partner("r0"), [walk], list[str]()
    partner._crowded, partner._waited = set(), 0
    monkeypatch.setattr(Planner, "_choose", lambda self, decision: chosen[0])
    for _ in range(9):
        action = partner._choose(decision((0.0, 0.0), {"a": (1.0, 0.0)}))
        done.append(action.verb)
        chosen[0] = take if action == walk else walk if action == take else chosen[0]
    assert done == [*["explore"] * 3, "walk_to", "pick_up", *["explore"] * 3, "walk_to"]
