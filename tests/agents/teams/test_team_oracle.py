"""The oracle of teams: what its robots are told, how they divide a small room, and how its records are played again."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

import pytest

from hazard_ms.agents.team import TEAM_AGENTS, team_agent
from hazard_ms.agents.teams.oracle import TeamOracle
from hazard_ms.agents.teams.sharing import Sharing
from hazard_ms.evaluation.attempts import attempt
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.replay import EXACT, compare, job_of
from hazard_ms.evaluation.result import EpisodeResult
from hazard_ms.evaluation.teams.player import privileged_team
from hazard_ms.evaluation.workers import Job, Word
from hazard_ms.skills.decision import EXPLORE, WALK_TO
from hazard_ms.skills.team import TeamSkills
from hazard_ms.spec import AgentStart, Body, Room, SceneSpec, Task
from hazard_ms.spec.registry import AGENTS, load
from hazard_ms.tasks.fire import hazard_fire
from tests.agents.teams.test_teams_divide import decision
from tests.worlds.playground import brief
from tests.worlds.registering import registered_task

TASK, PAIR = "HazardTwoHide-v1", ("fetch", "fetch")
PLACES = {"ahead": (5.2, 2.2), "left": (3.0, 4.4), "behind": (1.0, 2.0), "corner": (0.8, 4.4), "hot": (6.0, 4.4)}
ROOM = SceneSpec(
    name="test/two_hide",
    room=Room((7.0, 5.0)),
    fixtures=(),
    bodies=tuple(
        Body(name, "box", "plain_box", (*at, 0.0), scale=(0.15, 0.15, 0.15), mass=0.4) for name, at in PLACES.items()
    ),
    target_categories=("box",),
    fires=((6.3, 4.6),),
    agent_start=AgentStart((3.0, 2.0)),
)


def two_hide(physics: str) -> Task:
    return dataclasses.replace(hazard_fire(physics), scenes=lambda split: (ROOM.name,), build=lambda name: ROOM)


def ignore(word: Word) -> None:
    """Nobody listens."""


def played(agent: str) -> EpisodeResult:
    options = EpisodeOptions(TASK, robot_uids=PAIR, agent=agent, effects="off")
    outcome = attempt(Job(options, 60.0), ignore)
    assert outcome.result is not None and not outcome.error
    return outcome.result


@pytest.fixture(scope="module", autouse=True)
def task() -> Iterator[str]:
    with registered_task(TASK, two_hide, 700) as name:
        yield name


@pytest.fixture(scope="module")
def result() -> EpisodeResult:
    return played("oracle")


@pytest.fixture(scope="module")
def room() -> Iterator[TeamSkills]:
    made = TeamSkills.make(TASK, PAIR, effects="off")
    yield made
    made.close()


def test_it_alone_of_all_teams_is_privileged_and_so_is_the_agent_of_its_name() -> None:
    assert {name for name in TEAM_AGENTS if load(TEAM_AGENTS[name]).privileged} == {"oracle"}
    assert load(AGENTS["oracle"].agent).privileged  # by whose name cards are checked
    assert isinstance(team_agent("oracle"), TeamOracle) and isinstance(privileged_team("oracle"), TeamOracle)
    assert [privileged_team(name) for name in ("joint", "own.py:Mine", "random", "")] == [None] * 4
    with pytest.raises(ValueError, match="an environment must be attached to the oracles"):
        team_agent("oracle").reset({"fetch-0": brief()})


def overlaps(result: EpisodeResult) -> list[str]:
    """The targets for which two robots went, or that one held, at the same time."""
    targets, spans = {fate.name for fate in result.targets}, list[tuple[str, str, int, int]]()
    for d in result.decisions:
        for name in {d.target, d.held} & targets:
            spans.append((str(name), d.robot, d.frame, d.frame + d.frames))
    return [a[0] for a in spans for b in spans if a[0] == b[0] and a[1] < b[1] and max(a[2], b[2]) < min(a[3], b[3])]


@pytest.mark.render
def test_no_two_go_for_the_same_and_all_is_rescued_without_a_look_around(result: EpisodeResult) -> None:
    assert overlaps(result) == [] and result.robot_collisions == 0
    assert result.ended == "all rescued" and result.tally.value > 0.9
    first = {d.robot: d.verb for d in reversed(result.decisions)}
    assert first == {"fetch-0": WALK_TO, "fetch-1": WALK_TO}
    rescuers = {d.robot for d in result.decisions if d.held is not None}
    assert rescuers == {"fetch-0", "fetch-1"}


@pytest.mark.render
def test_those_who_must_look_around_rescue_no_more(result: EpisodeResult) -> None:
    joint = played("joint")
    assert any(d.verb == EXPLORE for d in joint.decisions)
    assert joint.tally.value <= result.tally.value
    assert result.frames < joint.frames or joint.tally.value < result.tally.value


@pytest.mark.render
def test_its_record_is_played_again_with_what_it_told_the_maps(result: EpisodeResult) -> None:
    again = attempt(job_of(result), ignore).result
    assert compare(result, again) == (EXACT, "")
    blind = attempt(job_of(dataclasses.replace(result, agent="joint")), ignore).result
    assert compare(result, blind)[0] != EXACT  # nobody tells where things are that no robot has seen


@pytest.mark.render
def test_what_another_holds_is_neither_on_the_map_nor_to_be_rescued(room: TeamSkills) -> None:
    decisions, _ = room.reset(seed=0)
    player = TeamOracle()
    player.attach(room)
    player.reset({name: room.brief(name) for name in room.names})
    index = room.base.world.index(0, "ahead")
    told = player._seers["fetch-0"].told(decisions["fetch-0"])
    assert index in told.map.objects and len(told.targets) == len(PLACES) == len(told.map.objects)
    for world in (room.base.world, room.base.members[1].world):
        world.held[0, index] = True
    told = player._seers["fetch-0"].told(decisions["fetch-0"])
    assert index not in told.map.objects and "ahead" not in {t.name for t in told.targets}
    own = player._seers["fetch-1"].told(room.decision("fetch-1"))
    assert "ahead" in {t.name for t in own.targets if t.held}


@pytest.mark.render
def test_the_second_robot_plans_without_what_the_first_goes_for(room: TeamSkills) -> None:
    """On their own, two oracles that stand beside each other go for the same."""
    decisions, _ = room.reset(seed=0)
    player = TeamOracle()
    player.attach(room)
    player.reset({name: room.brief(name) for name in room.names})
    actions = player.act(decisions)
    aims = [action.target for action in actions.values()]
    assert len(set(aims)) == 2
    seer = player._seers["fetch-1"]
    assert seer._truth is not None
    left = {seer._scene.spec.things[i].name for i in seer._problem(seer.told(decisions["fetch-1"]), seer._truth)[0]}
    assert aims[0] not in left and aims[1] in left


def test_what_is_far_may_be_done_before_a_robot_is_there() -> None:
    """Work at a thing that is 5 m away bars no way to it; within 0.8 m of a robot that stands none begins."""
    team, told = TeamOracle(), decision((0.0, 0.0), {"a": (5.0, 0.0), "b": (2.0, 0.0)})
    team._work, team._stands = {"r1": [(5.5, 0.0)]}, {}  # there it may be done before this robot comes
    assert team.crowded_things("r0", told) == set() and Sharing.crowded_things(team, "r0", told) == {"a"}
    team._work, team._stands = {}, {"r1": (1.3, 0.0)}
    assert team.crowded_things("r0", told) == {"b"}
    team._stands = {"r1": (1.1, 0.0)}
    assert team.crowded_things("r0", told) == set()
