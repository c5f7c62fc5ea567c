"""Skills of several robots at once: who is asked when, how they keep clear of one another; PettingZoo's own test."""

from __future__ import annotations

import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np
import pytest

from hazard_ms.agents.base import agent
from hazard_ms.agents.team import Independent, team_agent
from hazard_ms.agents.teams.joint import Joint
from hazard_ms.sensing.sighting import Sighting
from hazard_ms.skills.decision import EXPLORE, PICK_UP, STOP, WALK_TO, Action, Message, Teammate
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.skills.motor.motion import drive
from hazard_ms.skills.team import PASSING, PATIENCE, TeamSkills

LOOK, END = Action(EXPLORE), Action(STOP)


@pytest.fixture(scope="module")
def pair() -> Iterator[TeamSkills]:
    made = TeamSkills.make("HazardFire-v1", ("fetch", "fetch"), effects="off")
    yield made
    made.close()


def test_each_robot_is_asked_again_when_its_own_skill_is_over(pair: TeamSkills) -> None:
    decisions, _ = pair.reset(seed=1)
    assert list(decisions) == ["fetch-0", "fetch-1"] == list(pair.free)
    assert [d.agent_position for d in decisions.values()] == [
        pytest.approx(robot.base()[:2]) for robot in pair.base.robots.values()
    ]
    assert decisions["fetch-0"].map is not decisions["fetch-1"].map
    for name, other in (("fetch-0", "fetch-1"), ("fetch-1", "fetch-0")):
        assert decisions[name].others == (Teammate(other, decisions[other].agent_position),)
    thing = next(a for a in decisions["fetch-0"].available if a.verb == WALK_TO)
    decisions, terminated, truncated, info = pair.step({"fetch-0": thing, "fetch-1": LOOK})
    assert not terminated and not truncated and len(info["results"]) == 1
    (first,) = info["results"]
    assert list(decisions) == [first] == list(pair.free)
    assert decisions[first].last_result == info["results"][first]
    with pytest.raises(ValueError, match=f"actions must be for {first}, got them for fetch-0, fetch-1"):
        pair.step({"fetch-0": LOOK, "fetch-1": LOOK})
    with pytest.raises(ValueError, match=rf"the action of {first} must be an Action\(verb, target\), got 'stop'"):
        pair.step({first: "stop"})  # type: ignore[dict-item]
    frame = pair.frame
    decisions, terminated, _, _ = pair.step({first: END})  # it stands while the other goes on
    assert pair.frame > frame and not terminated and first not in decisions
    _, terminated, _, _ = pair.step(dict.fromkeys(decisions, END))
    assert terminated
    with pytest.raises(ValueError, match="the episode must be running, but it is over: call reset first"):
        pair.step({})


def test_an_action_without_frames_costs_one(pair: TeamSkills) -> None:
    pair.reset(seed=1)
    hidden = next(b.name for b in pair.base.specs[0].bodies if b.name not in _seen_names(pair))
    _, _, _, info = pair.step({"fetch-0": Action(WALK_TO, hidden), "fetch-1": LOOK})
    assert info["results"]["fetch-0"].reason == "target_unknown"
    assert info["results"]["fetch-0"].frames == pair.frame == 1


def _seen_names(env: TeamSkills) -> set[str]:
    known = env.knowledge["fetch-0"]
    return {known.labeller.names[index] for index in known.seen.objects}


def test_one_robot_plays_as_in_the_environment_of_one() -> None:
    """Decision by decision, until an action takes no frame."""
    team, one = TeamSkills.make("HazardFire-v1", "fetch", effects="off"), SkillEnv.make("HazardFire-v1", effects="off")
    (decision,), alone = team.reset(seed=2)[0].values(), one.reset(seed=2)[0]
    players = [agent("greedy"), agent("greedy")]
    players[0].reset(team.brief("fetch-0"))
    players[1].reset(one.brief())
    for _ in range(6):
        actions = players[0].act(decision), players[1].act(alone)
        assert actions[0] == actions[1]
        (decision,) = team.step({"fetch-0": actions[0]})[0].values()
        alone = one.step(actions[1])[0]
        assert (decision.frame, decision.last_result) == (alone.frame, alone.last_result)
        assert decision.agent_position == alone.agent_position
        assert np.array_equal(decision.map.height, alone.map.height)
    team.close()
    one.close()


def test_paths_and_drives_keep_clear_of_the_other_robot(pair: TeamSkills) -> None:
    """Robot 1 is driven straight at robot 0, which stands: it halts before it, and no contact is made."""
    pair.reset(seed=1)
    stage, other = pair.knowledge["fetch-1"].stage, pair.base.robots["fetch-0"]
    x, y, _ = other.base()
    cell = np.floor((np.array([y, x]) - stage.seen.origin[::-1]) / stage.seen.cell).astype(int)
    assert stage.obstacles()[tuple(cell)] == 1.0
    still = pair.knowledge["fetch-0"].stage
    for move in drive(stage, np.array([[x, y]]), 200):
        pair.base.advance({"fetch-0": still.act(), "fetch-1": move})
        gap = np.hypot(*(np.array(stage.robot.base()[:2]) - other.base()[:2])) - 2 * 0.29
        assert gap > 0.05
    assert pair.collisions == 0
    assert stage.bumps  # it noticed that it is stuck, and so another path is planned


def test_who_may_reach_out_lets_pass_who_walks_close_by(pair: TeamSkills, monkeypatch: pytest.MonkeyPatch) -> None:
    """They start 0.9 m apart. Robot 0 stands until robot 1 is 1.3 m away, or was near for 90 frames; then it goes."""
    decisions, _ = pair.reset(seed=1)
    near: list[tuple[float, float]] = []
    after = pair._frame

    def watched(moves: dict[str, Any]) -> dict[str, Any]:
        info = after(moves)
        (x, y, heading), (ox, oy, _) = (robot.base() for robot in pair.base.robots.values())
        near.append((float(np.hypot(x - ox, y - oy)), abs(x - start[0]) + abs(y - start[1]) + abs(heading - start[2])))
        return info

    monkeypatch.setattr(pair, "_frame", watched)
    start = pair.base.robots["fetch-0"].base()
    thing = next(t for t in decisions["fetch-0"].targets)
    place = pair.base.world.position[0, thing.index].cpu().numpy()
    seen = {thing.index: Sighting(place, 0.1, float(place[2]) + 0.1, 0, 0)}
    pair.knowledge["fetch-0"].hear(Message(0, "fetch-1", thing.name), seen)
    away = {t: s for t, s in decisions["fetch-1"].map.objects.items()}
    far = max(away, key=lambda t: float(np.hypot(*(away[t].position[:2] - np.array(start[:2])))))
    pair.step({"fetch-0": Action(PICK_UP, thing.name), "fetch-1": Action(WALK_TO, decisions["fetch-1"].names[far])})
    stood = next((n for n, (_, moved) in enumerate(near) if moved > 1e-3), len(near))
    assert 5 < stood <= PATIENCE + 1
    assert max(gap for gap, _ in near[: stood - 1]) < PASSING + 0.05


def test_planners_that_plan_together_never_fetch_the_same(pair: TeamSkills) -> None:
    """Through some decisions in a burning kitchen; looks around and walks to search do not count."""
    decisions, _ = pair.reset(seed=1)
    player = team_agent("joint")
    player.reset({name: pair.brief(name) for name in pair.names})
    aims: dict[str, str | None] = {}
    for _ in range(8):
        actions = player.act(decisions)
        for name, action in actions.items():
            target = action.target in {t.name for t in decisions[name].targets}
            aims[name] = action.target if target else decisions[name].held
        kept = [aim for aim in aims.values() if aim is not None]
        assert len(set(kept)) == len(kept), aims
        decisions, terminated, truncated, _ = pair.step(actions)
        if terminated or truncated:
            break
    assert pair.collisions == 0


def test_team_agents_are_found_by_name() -> None:
    assert isinstance(team_agent("independent"), Independent)
    assert isinstance(team_agent("joint"), Joint) and isinstance(team_agent("independent:planner"), Independent)
    with pytest.raises(ValueError, match="team agent must be joint alone, since it brings its own agents"):
        team_agent("joint:planner")
    with pytest.raises(ValueError, match="team agent must be one of"):
        team_agent("planner")
    with pytest.raises(ValueError, match="agents of a team must see only what robots see .* got oracle"):
        Independent("oracle")


def test_pettingzoos_own_test_of_parallel_environments() -> None:
    pytest.importorskip("pettingzoo", reason="pettingzoo is not installed; the extra teams brings it")
    from pettingzoo.test import parallel_api_test

    from hazard_ms.skills.options.parallel import HazardTeam

    env = HazardTeam(max_episode_steps=150)
    with warnings.catch_warnings():
        warnings.simplefilter("error", UserWarning)
        parallel_api_test(env, num_cycles=20)
    obs, _ = env.reset(seed=1)
    for name in env.agents:
        assert env.observation_space(name).contains(obs[name])
        assert obs[name]["action_mask"][env.go_on] == 0
    look = env.go_on - 2  # the last but one of the options looks around
    with pytest.raises(ValueError, match=r"action of fetch-0 must be one that its mask allows"):
        env.step({"fetch-0": env.go_on, "fetch-1": look})
    target = int(np.flatnonzero(obs["fetch-0"]["action_mask"])[0])
    obs, reward, _, _, _ = env.step({"fetch-0": target, "fetch-1": look})
    masks = {name: one["action_mask"] for name, one in obs.items()}
    assert masks["fetch-0"][env.go_on] == 1 and masks["fetch-0"].sum() == 1  # still walking
    assert masks["fetch-1"][env.go_on] == 0
    assert reward["fetch-0"] == reward["fetch-1"]
    env.close()
