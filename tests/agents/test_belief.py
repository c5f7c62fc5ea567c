"""Agents that doubt: expected value, a closer look first, and nothing of it where nothing is in doubt."""

from __future__ import annotations

from dataclasses import replace

import pytest

from hazard_ms.agents.base import agent
from hazard_ms.agents.search.memory import Memory
from hazard_ms.skills.decision import EXPLORE, PICK_UP, STOP, WALK_ONE_STEP, WALK_TO, Action, Decision, Result
from hazard_ms.skills.failures import MAX_FRAMES, NOT_A_TARGET
from tests.worlds.playground import Playground, brief, play

AGENTS = ("greedy", "planner", "mcts:simulations=100")


def doubted(decision: Decision, **beliefs: float) -> Decision:
    """The decision of an agent that believes in targets only so much."""
    rows = tuple(replace(row, belief=beliefs.get(row.name, row.belief)) for row in decision.targets)
    return replace(decision, targets=rows)


@pytest.mark.parametrize("name", AGENTS)
def test_the_nearer_of_two_that_is_hardly_believed_comes_second(name: str) -> None:
    """At 1.5 m and 2.5 m: with a tenth of its value the nearer one costs more a metre."""
    ground = Playground({"near": (1.5, 0.0), "far": (-2.5, 0.0)}, {"near": 5.0, "far": 5.0})
    player = agent(name)
    player.reset(brief())
    ground.do(player.act(ground.decision()))
    assert player.act(doubted(ground.decision(), near=0.1)).target == "far"
    other = agent(name)
    other.reset(brief())
    other.act(replace(ground.decision(), last_action=None, last_result=None))
    assert other.act(ground.decision()).target == "near"


@pytest.mark.parametrize("name", ["greedy:belief=false", "planner:belief=0", "mcts:simulations=100,belief=0"])
def test_without_belief_doubts_do_not_count(name: str) -> None:
    ground = Playground({"near": (1.5, 0.0), "far": (-2.5, 0.0)}, {"near": 5.0, "far": 5.0})
    player = agent(name)
    player.reset(brief())
    ground.do(player.act(ground.decision()))
    assert player.act(doubted(ground.decision(), near=0.1)) == Action(WALK_TO, "near")


@pytest.mark.parametrize("name", ["greedy", "planner:reach=0"])
def test_agents_look_closer_before_they_walk_far(name: str) -> None:
    """2.5 m to what may well be none: they decide anew on the way. 1 m is no way, and 0.8 is hardly a doubt."""
    for away, belief, verb in ((2.5, 0.6, WALK_ONE_STEP), (2.5, 0.8, WALK_TO), (1.0, 0.6, WALK_TO)):
        ground = Playground({"a": (away, 0.0)}, {"a": 5.0})
        player = agent(name)
        player.reset(brief())
        ground.do(player.act(ground.decision()))
        assert player.act(doubted(ground.decision(), a=belief)) == Action(verb, "a")


@pytest.mark.parametrize("name", ["greedy", "planner:reach=0"])
def test_where_a_step_leads_nowhere_they_walk(name: str) -> None:
    """It stands where the thing was seen, which has been driven on: else it would step there for ever."""
    ground = Playground({"a": (2.5, 0.0)}, {"a": 5.0})
    player = agent(name)
    player.reset(brief())
    ground.do(player.act(ground.decision()))
    step = Action(WALK_ONE_STEP, "a")
    for frames, action in ((0, Action(WALK_TO, "a")), (30, step)):
        ground.last = (step, Result(True, "", frames))
        assert player.act(doubted(ground.decision(), a=0.6)) == action


def test_what_is_hardly_believed_is_searched_for_elsewhere() -> None:
    """One target, seen a good way off, and a landmark by unseen floor: if that is hardly it, it must be elsewhere."""
    for belief, first in ((1.0, "known"), (0.02, "table")):
        ground = Playground({"table": (2.5, 0.0), "known": (-2.8, 0.0)}, {"known": 5.0})
        told = replace(brief(), targets=ground.decision().targets)
        player = agent("planner")
        player.reset(told)
        ground.do(player.act(ground.decision()))
        assert player.act(doubted(ground.decision(), known=belief)).target == first


@pytest.mark.parametrize(("belief", "away", "first"), [(0.1, 2.8, "table"), (0.2, 2.8, "a"), (0.1, 1.0, "a")])
def test_greedy_searches_before_it_walks_far_to_what_it_hardly_believes(belief: float, away: float, first: str) -> None:
    ground = Playground({"table": (-2.5, 0.0), "a": (away, 0.0)}, {"a": 5.0})
    player = agent("greedy")
    player.reset(brief())
    ground.do(player.act(ground.decision()))
    assert player.act(doubted(ground.decision(), a=belief)).target == first


def test_greedy_goes_to_what_it_hardly_believes_once_nothing_is_left_to_search() -> None:
    ground = Playground({"a": (2.8, 0.0)}, {"a": 5.0})
    ground.map.explored[:] = True
    player = agent("greedy")
    player.reset(brief())
    targets = set()
    for _ in range(8):
        action = player.act(doubted(ground.decision(), a=0.1))
        targets.add(action)
        ground.do(action)
    assert Action(PICK_UP, "a") in targets


@pytest.mark.parametrize("name", AGENTS)
def test_with_eyes_that_overlook_things_the_search_begins_anew(name: str) -> None:
    """One target is nowhere to be seen: with the truth the agent stops, with a detector never."""
    for detects in (False, True):
        ground = Playground({"table": (1.5, 0.0), "a": (90.0, 0.0)}, {"a": 5.0})
        player, actions = agent(name), []
        player.reset(replace(brief(), looks=detects, targets=ground.decision().targets))
        for _ in range(25):
            actions.append(player.act(ground.decision()))
            if actions[-1] == Action(STOP):
                break
            ground.do(actions[-1])
        assert (actions[-1] == Action(STOP)) is not detects
        assert not detects or sum(action == Action(EXPLORE) for action in actions) >= 4


def test_what_was_no_target_is_no_failure_of_whatever_gets_its_name() -> None:
    ground = Playground({"a": (2.0, 0.0)}, {"a": 1.0})
    ground.look()
    pick = Action(PICK_UP, "a")
    for belief, chance, count in ((True, 0.9, {}), (True, 1.0, {"a": 1}), (False, 0.9, {"a": 1})):
        memory = Memory(0, belief)
        memory.chose(ground.decision(), pick)
        told = replace(ground.decision(), last_action=pick, last_result=Result(False, NOT_A_TARGET, 0))
        memory.note(doubted(told, a=chance))
        assert memory.failures == count
    ground.map.forget(0)  # as where the belief has ended, and nothing else is taken for it
    memory = Memory(0)
    memory.chose(ground.decision(), pick)
    memory.note(replace(ground.decision(), last_action=pick, last_result=Result(False, NOT_A_TARGET, 0)))
    assert memory.failures == {}


@pytest.mark.parametrize("name", AGENTS)
def test_what_is_refused_but_stays_as_sure_as_before_is_given_up(name: str) -> None:
    """As with detectors whose errors nobody counted: else it would be reached for until the episode ends."""
    ground = Playground({"stone": (0.5, 0.0), "far": (-2.5, 0.0)}, {"stone": 5.0, "far": 1.0})
    player = agent(name)
    player.reset(brief())
    ground.do(player.act(ground.decision()))
    reached = 0
    for _ in range(12):
        action = player.act(ground.decision())
        if action.target == "far":
            break
        if action == Action(PICK_UP, "stone"):
            reached += 1
            ground.last = (action, Result(False, NOT_A_TARGET, 0))
        else:
            ground.do(action)
    assert action.target == "far" and 1 <= reached <= 6


def test_a_name_that_is_seen_far_from_where_it_was_is_that_of_another_thing() -> None:
    """Unless nothing is in doubt, or the wind has had the time to drive it there: then the thing has moved."""
    for belief, frames in ((0.9, [7]), (1.0, [0, 7]), (0.9, [0, 60])):
        ground = Playground({"a": (2.0, 0.0)}, {"a": 1.0})
        ground.look()
        memory = Memory(0)
        memory.note(doubted(ground.decision(), a=belief))
        memory.failures["a"] = 1
        sighting = ground.map.objects[0]
        ground.remember(0, replace(sighting, position=sighting.position + 1.0, frame=frames[-1]))
        memory.note(doubted(ground.decision(), a=belief))
        assert [frame for frame, _ in memory.tracks["a"]] == frames
        assert memory.failures == ({} if len(frames) == 1 else {"a": 1})


@pytest.mark.parametrize("name", ["greedy", "planner", "mcts"])
def test_with_the_truth_beliefs_change_nothing(name: str) -> None:
    """The same decisions in a whole rescue, with and without a look at beliefs, which are all 1."""
    places = {"a": (1.5, 0.3), "b": (-2.0, 1.0), "table": (2.5, -2.0), "c": (6.0, 6.0), "d": (0.5, -1.5)}
    values = {"a": 1.0, "b": 5.0, "c": 5.0, "d": 1.0}
    off = {"greedy": "false", "planner": "0", "mcts": "0"}[name]
    taken = [play(agent(text), Playground(places, values)) for text in (name, f"{name}:belief={off}")]
    assert taken[0] == taken[1] and len(taken[0]) > 6 and Action(EXPLORE) in taken[0]


@pytest.mark.parametrize("looks", [True, False])
def test_with_a_detector_greedy_does_not_turn_from_one_cart_to_another_that_is_hardly_nearer(looks: bool) -> None:
    """With something in its hand, on its way, the other cart seems to be a little nearer now."""
    ground = Playground(
        {"a": (0.6, 0.0), "left": (-2.0, 0.0), "right": (2.5, 0.0)}, {"a": 1.0}, carts=("left", "right")
    )
    player = agent("greedy")
    player.reset(replace(brief(), looks=looks))
    while ground.held is None:
        ground.do(player.act(ground.decision()))
    walk = player.act(ground.decision())
    assert walk == Action(WALK_TO, "left")
    x = ground.decision().agent_position[0] - 0.4  # how far it has come
    ground.places["right"] = (x + 0.95 * (x + 2.0), 0.0)
    ground.look()
    cut_short = {"last_action": walk, "last_result": Result(False, MAX_FRAMES, 30)}
    now = replace(ground.decision(), agent_position=(x, 0.0), **cut_short)
    assert player.act(now) == Action(WALK_TO, "left" if looks else "right")
