"""Oracle and planner set flood boards where water would take more than they could carry off."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator

import numpy as np
import pytest

from hazard_ms.agents.base import agent
from hazard_ms.agents.mitigating.choice import Chooser
from hazard_ms.agents.mitigating.prospects import FETCH, blocks
from hazard_ms.agents.teams.oracle import TeamOracle
from hazard_ms.evaluation.runner import Runner
from hazard_ms.sketch.futures.interventions import BLOCK, Intervention, foresee
from hazard_ms.sketch.futures.surroundings import free_boards, inlets_of
from hazard_ms.sketch.rescue_problem import RescueScene
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.skills.team import TeamSkills
from hazard_ms.spec import AgentStart, Body, Opening, Room, SceneSpec, Task
from hazard_ms.tasks.house import hazard_house_flood
from tests.worlds.registering import registered_task

TASK = "HazardRoomWithBoards-v1"
BOOKS = [(x, 0.6 + 0.6 * k, 0.0) for x in (11.6, 12.4, 13.2) for k in range(7)]
HOME = SceneSpec(
    name="test/room_with_boards",
    room=Room((14.0, 5.0), openings=(Opening("door", "west", 2.5, 0.9, 2.0), Opening("door", "south", 2.0, 0.9, 2.0))),
    fixtures=(),
    bodies=(
        *(Body(f"book_{k}", "book", "plain_box", at, scale=(0.2, 0.15, 0.04), mass=1.5) for k, at in enumerate(BOOKS)),
        Body("flood_board_1", "box", "plain_box", (0.8, 4.5, 0.0), scale=(1.0, 0.04, 0.6), mass=5.0),
        Body("flood_board_2", "box", "plain_box", (3.4, 0.5, 0.0), scale=(1.0, 0.04, 0.6), mass=5.0),
    ),
    target_categories=("book",),
    fires=(),
    flood_side="west",
    second_flood_side="south",
    agent_start=AgentStart((2.5, 2.5), 0.0),
)


def home(physics: str) -> Task:
    made = hazard_house_flood(physics)
    (water,) = made.hazards
    return dataclasses.replace(
        made,
        hazards=(dataclasses.replace(water, every=80),),
        scenes=lambda split: (HOME.name,),
        build=lambda name: HOME,
    )


@pytest.fixture(scope="module")
def env() -> Iterator[SkillEnv]:
    with registered_task(TASK, home, 2000):
        made = SkillEnv.make(TASK, sensor_configs={"width": 128, "height": 128}, effects="off")
        yield made
        made.close()


@pytest.mark.render
def test_boards_that_are_foreseen_hold_water_as_those_that_stand(env: SkillEnv) -> None:
    """The future with boards set now is that of an episode in which they stand now."""
    env.reset(seed=0)
    base = env.base
    for _ in range(100):
        base.advance(env.stage.act())
    inlets = [*inlets_of(base.world)]
    assert len(inlets) == len(free_boards(base.world)) == 2
    sets = [[Intervention(BLOCK, n, int(base.world.frame[0])) for n in inlets[:count]] for count in (1, 2)]
    nothing, one, both = foresee(base, sets).whole_until()
    things = base.world.names[0]
    books = [things.index(f"book_{k}") for k in range(len(BOOKS))]
    assert np.isfinite(nothing[books]).any() and (one[books] >= nothing[books]).all()
    assert (both[books] >= one[books]).all() and np.isinf(both[books]).sum() > np.isinf(nothing[books]).sum()
    for board, number in zip(free_boards(base.world), inlets, strict=True):
        base.world.equipment.state.stands_in[0, board] = number
    assert not free_boards(base.world) and not inlets_of(base.world)
    assert foresee(base, []).whole_until()[0].tolist() == both.tolist()


@pytest.mark.render
def test_the_planner_sets_them_when_it_has_seen_them(env: SkillEnv) -> None:
    run = Runner(env, agent("planner")).run(0)
    assert [d.verb for d in run.decisions if d.ok].count("block") == 2
    assert not inlets_of(env.base.world)


@pytest.mark.render
def test_the_oracle_sets_boards_into_both_doors_before_it_rescues(env: SkillEnv) -> None:
    decision, _ = env.reset(seed=0)
    made = agent("oracle")
    made.attach(env)
    made.reset(env.brief())
    done = list[str]()
    while "drop" not in done and done.count("block") < 2:
        action = made.act(decision)
        decision, *_ = env.step(action)
        assert decision.last_result is not None
        done += [action.verb] if decision.last_result.ok else []
    assert done.count("block") == 2 and not inlets_of(env.base.world)


@pytest.mark.render
def test_what_another_robot_is_at_is_left_to_it(env: SkillEnv) -> None:
    env.reset(seed=0)
    base, brief = env.base, env.brief()
    scene = RescueScene(base.specs[0], brief.robot, brief.radius, brief.max_frames)
    here, boards, doors = np.array([2.5, 2.5]), free_boards(base.world), sorted(inlets_of(base.world))
    every = blocks(base, scene, here)
    assert sorted(len(one.numbers) for one in every) == [1, 1, 2]
    left = blocks(base, scene, here, {(FETCH, boards[0])})  # one board, for either door
    assert [one.numbers for one in left] == [(door,) for door in doors]
    assert {tuple(one.first) for one in left} == {tuple(base.world.position[0, boards[1], :2].tolist())}
    chooser = Chooser(base)
    chooser.others = frozenset({(BLOCK, doors[0])})
    assert [one.numbers for one in chooser._open(every, ())] == [(doors[1],)]
    assert chooser._open(every, {(BLOCK, (doors[1],))}) == []


@pytest.mark.long
@pytest.mark.render
def test_two_oracles_set_both_boards(env: SkillEnv) -> None:
    """Never two at one door, nor with one board."""
    pair = TeamSkills.make(TASK, ("fetch", "fetch"), sensor_configs={"width": 128, "height": 128}, effects="off")
    decisions, _ = pair.reset(seed=0)
    team = TeamOracle()
    team.attach(pair)
    team.reset({name: pair.brief(name) for name in pair.names})
    done: set[str | None] = set()
    while len(done) < 2 and pair.frame < 1200:
        decisions, _, _, info = pair.step(team.act(decisions))
        begun = [seer.begun for seer in team._seers.values()]
        held = [int(member.hand.held[0]) for member in pair.base.members]
        assert not begun[0] & begun[1] and (held[0] != held[1] or held[0] < 0)
        ended = {pair.decision(name).last_action for name, result in info["results"].items() if result.ok}
        done |= {action.target for action in ended if action is not None and action.verb == BLOCK}
    pair.close()
    assert len(done) == 2 and not inlets_of(pair.base.world)
