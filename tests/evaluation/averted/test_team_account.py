"""What a team averts, and what each of its robots bears, told as for one robot."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from hazard_ms.agents.team import TeamAgent
from hazard_ms.evaluation.averted.account import Account
from hazard_ms.evaluation.averted.loss import Loads
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.teams.player import TeamRunner, play
from hazard_ms.skills.decision import EXPLORE, STOP, Action
from hazard_ms.skills.team import TeamSkills
from tests.evaluation.averted.test_account import FRAMES, environment, rooms

__all__ = ["rooms"]
PAIR = ("fetch", "fetch")


class Does(TeamAgent):
    """All robots do one thing until time is up."""

    def __init__(self, verb: str) -> None:
        self._verb = verb

    def reset(self, briefs: Any) -> None:
        """Begin."""

    def act(self, decisions: Any) -> dict[str, Action]:
        return {name: Action(self._verb) for name in decisions}


def still(env: Any) -> dict[str, np.ndarray]:
    return {m.name: m.agent.action(0.0, 0.0, m.agent.tucked, True) for m in env.unwrapped.members}


def told(env: Any, frames: int, name: str, actions: Any = still) -> tuple[Account, np.ndarray]:
    """The account of `frames`, and what `info` tells of both robots after each under `name`, [frames, 2]."""
    account, made = Account(), []
    account.begin(SimpleNamespace(base=env.unwrapped))  # type: ignore[arg-type]
    for _ in range(frames):
        env.unwrapped.advance(actions(env))
        account.frame(None)
        info = env.unwrapped.get_info()
        made.append([float(info[f"fetch-{k}-{name}"][0]) for k in (0, 1)])
    return account, np.array(made)


def test_heat_is_the_dose_of_each_robot() -> None:
    """ISO 13571: T^3.61 / 4.1e8 a minute. The second stands nearer to the fire."""
    env = environment(robot_uids=PAIR, affects_agent=True)
    account, heat = told(env, 300, "agent_temperature")
    doses = (heat**3.61 / 4.1e8 / 60.0 / 30.0).sum(0)
    loads = account.loads()
    env.close()
    assert [*loads] == ["fetch-0", "fetch-1"] and doses[1] > 1.5 * doses[0] > 0.0
    assert [load.heat for load in loads.values()] == pytest.approx(doses, rel=0.02)
    assert all(load.water is None and load.collisions == 0 for load in loads.values())


def test_water_is_that_at_each_robot() -> None:
    env = environment("HazardPool-v1", robot_uids=PAIR, affects_agent=True)
    account, depth = told(env, 600, "water_depth")
    loads = account.loads()
    env.close()
    assert depth.sum(0)[0] != depth.sum(0)[1]
    assert [load.water for load in loads.values()] == pytest.approx(depth.sum(0) / 30.0, rel=0.02)


def test_robots_that_push_each_other_have_not_hit_furniture() -> None:
    """The second drives into the first from behind."""
    env = environment(robot_uids=PAIR)
    base = env.unwrapped
    base.place_robot((1.6, 4.0), 0.0, robot=1)
    account = Account()
    account.begin(SimpleNamespace(base=base))  # type: ignore[arg-type]
    second = base.members[1].agent
    for _ in range(40):
        base.advance(still(env) | {"fetch-1": second.action(1 / 62, 0.0, second.tucked, True)})
        account.frame(None)
    assert int(base.contacts.record.count[0]) == 1
    assert [load.collisions for load in account.loads().values()] == [0, 0]
    env.close()


@pytest.mark.render
def test_a_team_that_stops_at_once_averts_nothing_and_time_after_it_counts() -> None:
    env = TeamSkills.make("HazardWind-v1", PAIR, split="test", effects="off", max_episode_steps=FRAMES)
    losses, frames = [], []
    for player in (None, Does(STOP), Does(EXPLORE)):
        account = Account()
        if player is None:
            env.reset(seed=1)
            account.begin(env)
        else:
            TeamRunner(env, player, [account]).run(1)
        frames.append(env.frame)
        losses.append(account.close())
        assert env.frame == FRAMES
    base = env.base
    env.reset(seed=1)
    start, spec = base.world.position[0].clone(), base.specs[0]
    for _ in range(FRAMES):
        base.advance(still(env.env))
    moved = (base.world.position[0] - start).norm(dim=-1) > 0.25
    things = [k for k in range(len(spec.bodies)) if base.world.target[0, k]]
    env.close()
    assert frames == [0, 0, FRAMES] and losses[0] == losses[1]
    assert losses[0] is not None and losses[0].targets > 0.0
    assert losses[0].targets == sum(float(base.world.value[0, k]) for k in things if moved[k])


@pytest.mark.render
def test_results_tell_what_each_robot_bore_and_what_lies_where_it_was_put_is_safe() -> None:
    """In a gale, where all stop at once; the wind knocks nobody into furniture, and there is no heat and no water."""
    options = EpisodeOptions("HazardGale-v1", split="test", robot_uids=PAIR, agent="joint", effects="off")
    result = play(options, [Account()], Does(STOP), max_episode_steps=90)
    assert result.robot_loads == dict.fromkeys(("fetch-0", "fetch-1"), Loads(collisions=0)) and result.loads is None
    assert result.frames == 0 and result.lost is not None and result.tally.value > 0.0
