"""The example for OpenEnv: what a model is told and does there is what the agent `llm` is told and does.

Most tests have a stub of what the example uses of OpenEnv, and a playground in place of the simulator; the last one has
the real ones, where OpenEnv is installed.
"""

from __future__ import annotations

import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import pytest

from hazard_ms.agents.base import agent
from hazard_ms.agents.llm.prompt import text_of
from hazard_ms.agents.llm.rules import RULES, block_in
from hazard_ms.evaluation.metrics import Fate
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import STOP, Action, Decision
from tests.worlds.playground import Playground, brief, play
from tests.worlds.registering import loaded

EXAMPLE = Path(__file__).parents[2] / "examples" / "openenv_server.py"
PLACES = {"mug": (2.0, 0.0), "book": (0.0, 2.5), "far": (6.0, 0.0), "shelf": (4.5, 0.5)}
VALUES = {"mug": 1.0, "book": 5.0, "far": 4.0}


class Ground:
    """What the example uses of SkillEnv, in the playground. `taken`: actions of all; `threads` in which they ran."""

    taken: list[Action]
    threads: set[int]
    max_frames = 1500
    stage = None

    @classmethod
    def make(cls, env_id: str, split: str) -> Ground:
        return cls()

    def reset(self, seed: int | None) -> tuple[Decision, dict[str, Any]]:
        self.ground = Playground(dict(PLACES), dict(VALUES))
        return self.decision(), {}

    def brief(self) -> Brief:
        return brief()

    def decision(self) -> Decision:
        return self.ground.decision()

    @property
    def frame(self) -> int:
        return self.ground.frame

    def run(self, frames: int) -> None:
        self.ground.frame += frames

    def step(self, action: Action) -> tuple[Decision, float, bool, bool, dict[str, Any]]:
        self.taken.append(action)
        self.threads.add(threading.get_ident())
        self.ground.do(action)
        done = action.verb == STOP or self.ground.rescued == set(VALUES)
        return self.decision(), 0.0, done, self.frame >= self.max_frames, {}

    def close(self) -> None:
        del self.ground


class Record(SimpleNamespace):
    """Stands for the messages of OpenEnv, which have defaults."""

    step_count = 0

    def __init__(self, **entries: Any) -> None:
        super().__init__(**entries)


@pytest.fixture
def example(monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    """The example with a stub of OpenEnv: plain records and classes."""
    module = ModuleType("openenv.core")
    names = {"Action": Record, "Observation": Record, "State": Record, "Environment": object}
    module.__dict__.update(names, create_app=lambda *given, **named: (given, named))
    monkeypatch.setitem(sys.modules, "openenv", ModuleType("openenv"))
    monkeypatch.setitem(sys.modules, "openenv.core", module)
    monkeypatch.setattr(Ground, "taken", [], raising=False)
    monkeypatch.setattr(Ground, "threads", set(), raising=False)
    with loaded(EXAMPLE) as made:
        monkeypatch.setattr(made, "SkillEnv", Ground)
        monkeypatch.setattr(made, "wait", lambda stage, frames: frames)
        monkeypatch.setattr(made, "fates", fates)
        yield made


def fates(env: Ground) -> tuple[Fate, ...]:
    saved = {name: name in env.ground.rescued for name in VALUES}
    return tuple(Fate(n, n, v, saved[n], False, 9 if saved[n] else None) for n, v in VALUES.items())


def greedily(situation: Any) -> str:
    return RULES["greedy"](block_in(text_of(situation.messages)))


def test_a_rule_does_there_what_it_does_as_the_agent(example: Any) -> None:
    """Its rewards add up to what it rescued: everything."""
    rescue = example.Rescue("HazardFire-v1", "train")
    situation = rescue.reset(seed=3, episode_id="one")
    total, steps = 0.0, 0
    while not situation.done:
        situation = rescue.step(example.Choose(letter=greedily(situation)))
        total, steps = total + situation.reward, steps + 1
    assert total == pytest.approx(1.0) and situation.metadata["value"] == 1.0
    assert rescue.state.episode_id == "one" and rescue.state.step_count == steps
    alone = Playground(dict(PLACES), dict(VALUES))
    taken = play(agent("llm:base_url=scripted,model=greedy,way=letter"), alone)
    assert Ground.taken == taken[: len(Ground.taken)] and taken[len(Ground.taken) :] in ([], [Action(STOP)])
    with pytest.raises(ValueError, match="call reset first"):
        rescue.step(example.Choose(letter="A"))


def test_sessions_do_not_mix_and_share_one_thread(example: Any) -> None:
    first, second = (example.Rescue("HazardFire-v1", "train") for _ in range(2))
    begun = first.reset(seed=1)
    second.reset(seed=1)
    callers = [threading.Thread(target=second.step, args=(example.Choose(letter="A"),)) for _ in range(3)]
    for caller in callers:
        caller.start()
        caller.join()
    assert first.state.step_count == 0 and second.state.step_count == 3
    assert first.step(example.Choose(letter="A")).metadata["frame"] == 60
    assert begun.metadata["frame"] == 0 and len(Ground.threads) == 1
    assert threading.get_ident() not in Ground.threads


def test_a_letter_that_is_no_option_takes_time_and_nothing_else(example: Any) -> None:
    rescue = example.Rescue("HazardFire-v1", "train")
    before = rescue.reset()
    after = rescue.step(example.Choose(letter="Z"))
    assert after.metadata == {"frame": example.IDLE, "value": 0.0, "error": "letter must be one of A, B, got 'Z'"}
    assert after.options == before.options and after.reward == 0.0 and not after.done and Ground.taken == []
    assert block_in(text_of(after.messages))["last_actions"] == block_in(text_of(before.messages))["last_actions"]
    for _ in range(Ground.max_frames // example.IDLE - 1):
        after = rescue.step(example.Choose(letter=""))
    assert after.done


def test_a_session_that_was_only_asked_about_has_no_simulation(example: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(Ground, "make", pytest.fail)
    rescue = example.Rescue("HazardFire-v1", "train")
    assert rescue.state.step_count == 0
    rescue.close()
    with pytest.raises(ValueError, match="call reset first"):
        rescue.step(example.Choose(letter="A"))


def test_unknown_tasks_are_refused_before_anything_is_served(example: Any) -> None:
    (made, *_), named = example.application("HazardWind-v1", "test", 3)
    assert made.args == ("HazardWind-v1", "test") and named["max_concurrent_envs"] == 3
    with pytest.raises(ValueError, match="env_id must be one of"):
        example.application("HazardSnow-v1", "test", 3)


@pytest.mark.render
@pytest.mark.long
def test_clients_play_over_the_network() -> None:
    """The real library, with two sessions that take turns: each goes as it does alone."""
    pytest.importorskip("openenv")
    import uvicorn
    from openenv.core import GenericEnvClient

    def letter(options: dict[str, str], wanted: str) -> dict[str, Any]:
        return {"letter": next((letter for letter, words in options.items() if words.startswith(wanted)), wanted)}

    with loaded(EXAMPLE) as example:
        server = uvicorn.Server(uvicorn.Config(example.application("HazardFire-v1", "train", 2), port=0))
        threading.Thread(target=server.run, daemon=True).start()
        while not server.started:
            time.sleep(0.05)
        address = f"http://127.0.0.1:{server.servers[0].sockets[0].getsockname()[1]}"
        clients = [
            GenericEnvClient(address, message_timeout_s=250, websocket_ping_interval_s=None).sync() for _ in "ab"
        ]
        told: list[list[Any]] = [[], []]
        with clients[0], clients[1]:
            for moves in (("reset",) * 2, ("look", "Z"), ("Z", "look"), ("stop", "stop")):
                for number, (client, move) in enumerate(zip(clients, moves, strict=True)):
                    options = told[number][-1].observation["options"] if told[number] else {}
                    made = client.reset(seed=1) if move == "reset" else client.step(letter(options, move))
                    told[number].append(made)
        server.should_exit = True
    first, second = told
    assert [each.done for each in first] == [each.done for each in second] == [False, False, False, True]
    assert first[0].observation["messages"] == second[0].observation["messages"]
    assert first[2].observation["metadata"]["frame"] == second[2].observation["metadata"]["frame"] > example.IDLE
    assert "letter must be one of" in second[1].observation["metadata"]["error"]
    assert sum(each.reward for each in first) == 0.0
