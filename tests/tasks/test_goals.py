"""Goals that one action achieves: what agents do for them, which of them refuse, and what language models are told."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from hazard_ms.agents.base import agent
from hazard_ms.agents.greedy import Greedy
from hazard_ms.agents.llm.prompt import system_text
from hazard_ms.demonstrations.options import RecordOptions
from hazard_ms.demonstrations.recording import why_not
from hazard_ms.evaluation.options import EnvOptions, EpisodeOptions, SweepOptions
from hazard_ms.evaluation.report import success_line, summary
from hazard_ms.skills.brief import Brief, brief_of
from hazard_ms.skills.decision import DROP, EXPLORE, PICK_UP, WALK_TO, Action
from hazard_ms.spec.registry import AGENTS, TASKS
from hazard_ms.tasks import task_of
from tests.worlds.playground import Playground, brief
from tests.worlds.registering import practising
from tests.worlds.results import result_of

DOOR, PICK, BAG = "HazardOpenDoor-v1", "HazardPickUp-v1", "HazardFetch-v1"
VERBS = {"HazardWalkTo-v1": WALK_TO, PICK: PICK_UP, "HazardStow-v1": DROP, BAG: DROP, DOOR: "open"}
SEARCHING = ("greedy", "rule", "planner", "mcts", "fighter")
# SHA-256 of the system texts of the four published tasks, as they were before goals had verbs
TEXTS = "3bfad958921c1fb5e34be886ae30540ca8350fc7c1254c92ba86f9acdd64e353"


@pytest.fixture(scope="module", autouse=True)
def practice() -> Iterator[Any]:
    with practising() as module:
        yield module


def asked(verb: str) -> Brief:
    return replace(brief(), verb=verb)


def ground(**changes: Any) -> Playground:
    """A cheap thing at hand, a dear one within sight and one out of it; it has looked ahead once."""
    places = {"near": (1.2, 0.0), "dear": (-2.5, 0.0), "hidden": (9.0, 0.0)}
    made = Playground(places, {"near": 1.0, "dear": 5.0, "hidden": 5.0}, **changes)
    made.look()
    return made


def test_each_practice_task_names_the_action_that_achieves_it() -> None:
    assert {name: task_of(name, "paper").goal.verb for name in VERBS} == VERBS
    assert not any(task_of(name, "paper").goal.verb for name in TASKS if name not in VERBS)


@pytest.mark.parametrize("name", SEARCHING)
@pytest.mark.parametrize("verb", [WALK_TO, PICK_UP, DROP])
def test_agents_do_at_once_what_is_asked_for_to_the_nearest_thing(name: str, verb: str) -> None:
    """In a rescue they look around first, and may fetch what is worth more."""
    player, room = agent(name), ground()
    player.reset(asked(verb))
    for wanted in (Action(WALK_TO, "near"), Action(PICK_UP, "near"), Action(DROP)):
        action = player.act(room.decision())
        assert action == wanted
        assert wanted.target is None or player.note == "what the task asks for"
        room.do(action)
    assert room.rescued == {"near"}
    rescuer = agent(name)
    rescuer.reset(brief())
    assert rescuer.act(ground().decision()) == Action(EXPLORE)


def test_what_is_harmed_unknown_or_has_just_failed_is_left_to_the_agent() -> None:
    player, room = Greedy(), ground(slippery=frozenset({"near"}))
    player.reset(asked(PICK_UP))
    whole = room.decision()
    harmed = replace(whole, targets=tuple(replace(t, damaged=t.name == "near") for t in whole.targets))
    assert player.asked(harmed, PICK_UP) == Action(WALK_TO, "dear")
    assert player.asked(replace(harmed, targets=harmed.targets[:1]), PICK_UP) is None
    assert player.asked(whole, "") is None
    unseen = Playground({"near": (9.0, 0.0)}, {"near": 1.0})
    assert player.asked(unseen.decision(), PICK_UP) is None
    assert player.act(unseen.decision()) == Action(EXPLORE)
    room.do(Action(WALK_TO, "near"))
    room.do(Action(PICK_UP, "near"))
    assert room.last[1] is not None and not room.last[1].ok
    assert player.asked(room.decision(), PICK_UP) is None
    room.at, room.last = (0.0, 0.0), (Action(WALK_TO, "dear"), replace(room.last[1], reason="max_frames"))
    assert player.asked(room.decision(), PICK_UP) == Action(WALK_TO, "near"), "a walk that paused has not failed"


def test_a_goal_that_no_action_achieves_is_refused() -> None:
    base = SimpleNamespace(task=SimpleNamespace(goal=SimpleNamespace(verb="opne"), mitigations=("open",)))
    with pytest.raises(ValueError, match="verb of the goal must be one of .*walk_to, pick_up, drop, open, got 'opne'"):
        brief_of(base, None, None, 300)  # type: ignore[arg-type]


def test_agents_that_know_rescues_alone_refuse_other_goals() -> None:
    """Before anything is built; agents of one's own are never refused."""
    able = {name for name in AGENTS if name not in ("bc", "rl", "rl_paper") and not name.startswith("paper/")}
    for task, verb in VERBS.items():
        for name in AGENTS:
            options = EpisodeOptions(env_id=task, agent=f"{name}:weights=x")
            if name in able or (name.startswith("paper/") and verb != "open"):
                options.check()
                continue
            said = (
                f"^agent must be one of .*planner.*, or your own, in {task}, whose goal is .*, got '{name}:weights=x'$"
            )
            with pytest.raises(ValueError, match=said) as error:
                options.check()
            assert ("paper/mcts" in str(error.value).partition(", or your own")[0]) is (verb != "open")
    EpisodeOptions(env_id=DOOR, agent="own.py:Own").check()
    for name in AGENTS:
        EpisodeOptions(env_id="HazardFire-v1", agent=name).check()
    with pytest.raises(ValueError, match=f"agent must be one of .* in {DOOR}, .* got 'rl'"):
        SweepOptions(EnvOptions(env_id=DOOR), agents=("greedy", "rl")).episode_options()
    with pytest.raises(ValueError, match=f"agent must be one of .* in {PICK}, .* got 'bc'"):
        RecordOptions(EnvOptions(env_id=PICK), agent="bc").check()


def test_language_models_are_told_the_task() -> None:
    told = replace(brief(), hazards=(), max_frames=120, verb=PICK_UP, text="Take the thing before you.")
    text = system_text(told, macro=True)
    assert text.startswith("You direct a robot.\nYour task: Take the thing before you. Nothing else counts,")
    assert "120 frames in all" in text and '"stop" ends the episode' in text
    assert "saved" not in text and "rescue" not in text and "of its value" not in text
    assert "A thing that was damaged does not count." in system_text(asked(PICK_UP), macro=False)
    door = replace(told, verb="open", mitigations=("open",), several_rooms=True, text="Open the door before you.")
    text = system_text(door, macro=True)
    assert "Your task: Open the door before you." in text and '\n"open" opens a shut door' in text
    assert "rescue" not in text and "home" not in text and "per_100_frames" not in text and "saving" not in text


def test_what_models_are_told_in_published_tasks_is_as_it_was() -> None:
    names = ("HazardFire-v1", "HazardFlood-v1", "HazardWind-v1", "HazardCompound-v1")
    texts = [system_text(brief(name), macro) for name in names for macro in (True, False)]
    assert hashlib.sha256("\n".join(texts).encode()).hexdigest() == TEXTS


def test_what_counts_in_practice_is_success() -> None:
    goal, half = task_of(PICK, "paper").goal, result_of(EpisodeOptions(), saved=True)
    done, late = replace(half, ended=goal.done), replace(half, ended="time")
    assert why_not(late, 0.0, 0.8, succeeded=False, verb=goal.verb) == "the goal was not reached"
    assert why_not(late, 0.0, 0.0, succeeded=False, verb=goal.verb) == "", "with keep 0 all are kept"
    assert why_not(done, 1.0, 0.8, succeeded=True, verb=goal.verb) == ""
    assert summary(done, goal).startswith(
        f"{half.agent} succeeded in {half.scene}, in {half.frames} frames (in the hand);"
    )
    assert summary(late, goal).startswith(f"{half.agent} failed in {half.scene}, in {half.frames} frames (time);")
    assert "50.0 % of the value" in summary(half, EpisodeOptions().goal)
    assert success_line("planner", [done, late, done], goal) == "planner: succeeded in 2 of 3 episodes"
