"""Language models as a team: each knows what its own robot knows and was told, and all are asked at the same time."""

from __future__ import annotations

import dataclasses
import json
import threading
from collections.abc import Iterator
from typing import Any

import pytest

from hazard_ms.agents.llm.answers import TELLING_ASKS
from hazard_ms.agents.llm.choices import menu
from hazard_ms.agents.llm.memory import Memory
from hazard_ms.agents.llm.prompt import estimate, messages, system_text, text_of
from hazard_ms.agents.llm.rules import RULES, block_in, rows
from hazard_ms.agents.llm.scene_text import Block, block
from hazard_ms.agents.llm.scripted import ScriptedServer
from hazard_ms.agents.llm.team.radio import Radio
from hazard_ms.agents.llm.team.rule import tells
from hazard_ms.agents.team import TeamAgent, team_agent
from hazard_ms.agents.teams.language import LanguageModels
from hazard_ms.skills.decision import Action, Decision, Message, Result, Teammate
from hazard_ms.skills.team import TeamSkills
from hazard_ms.skills.telling import FRAMES
from tests.agents.llm.conftest import Ground
from tests.agents.llm.test_prompts import LARGEST
from tests.agents.llm.test_servers import message, send, serving
from tests.worlds.playground import brief

LONG = "x" * 201


@pytest.fixture(scope="module")
def pair() -> Iterator[TeamSkills]:
    made = TeamSkills.make("HazardFire-v1", ("fetch", "fetch"), effects="off")
    yield made
    made.close()


def played(env: TeamSkills, player: TeamAgent, steps: int) -> list[tuple[int, dict[str, str]]]:
    """The frames and the actions of some steps of an episode."""
    decisions, _ = env.reset(seed=1)
    player.reset({name: env.brief(name) for name in env.names})
    made = []
    for _ in range(steps):
        actions = player.act(decisions)
        made.append((env.frame, {name: str(action) for name, action in actions.items()}))
        decisions = env.step(actions)[0]
    return made


def test_what_one_tells_is_in_the_next_prompt_of_the_other_and_what_it_names_is_on_offer(pair: TeamSkills) -> None:
    """Robot 0 looks around, and tells of all targets that it sees; robot 1 stands, and says that it waits."""
    blocks: dict[str, list[Block]] = {"fetch-0": [], "fetch-1": []}

    def act(handler: Any, request: dict[str, Any]) -> None:
        told = block_in(request["messages"][-1]["content"])
        seen = [row["thing"] for row in rows(told["targets"])]
        blocks[told["robot"]].append(told)
        looks = told["robot"] == "fetch-0" and not told["last_actions"][1:]
        words = "I see " + ", ".join(seen) if told["robot"] == "fetch-0" else "I wait"
        letter = next(key for key, text in told["options"].items() if text == ("look" if looks else "tell"))
        send(handler, 200, message(json.dumps({"reason": "", "choice": letter, "message": words})))

    with serving(act) as address:
        made = played(pair, team_agent(f"llm:base_url={address},model=m"), 7)
    said = next(frame for frame, actions in made if actions.get("fetch-0", "").startswith("tell I see"))
    words = next(actions["fetch-0"] for frame, actions in made if frame == said).removeprefix("tell ")
    first = next(k for k, told in enumerate(blocks["fetch-1"]) if "I see" in json.dumps(told["radio"]))
    before, after = blocks["fetch-1"][first - 1 : first + 1]
    assert after["frame"] - FRAMES <= said + FRAMES <= after["frame"], "it is in the first prompt after it was told"
    heard = next(row for row in rows(after["radio"]) if row["from"] == "fetch-0")
    assert heard == {"frames_ago": after["frame"] - said - FRAMES, "from": "fetch-0", "text": words}
    own = [row["text"] for row in rows(after["radio"]) if row["from"] == "fetch-1"]
    assert own == ["I wait"] * first, "it knows what it has told itself"
    new = {t for t in after["options"].values() if t.startswith("fetch ")} - {*before["options"].values()}
    assert new and all(text.removeprefix("fetch ") in words for text in new)
    place, other = (pair.base.robots[name].base()[:2] for name in ("fetch-0", "fetch-1"))
    away = ((place[0] - other[0]) ** 2 + (place[1] - other[1]) ** 2) ** 0.5
    assert rows(after["team"])[0]["metres"] == pytest.approx(away, abs=0.06)


def test_a_scripted_team_is_deterministic_and_divides_the_work(pair: TeamSkills, server: ScriptedServer) -> None:
    """In the same scene twice, by one agent; what both would fetch is left to one."""
    player = team_agent(f"llm:base_url={server.address},model=tells")
    first, again = played(pair, player, 8), played(pair, player, 8)
    assert first == again and player.counters["told"] == sum(a.startswith("tell") for _, s in first for a in s.values())
    aims = {name: a for _, actions in first for name, a in actions.items() if a.startswith("walk_to")}
    assert len(set(aims.values())) == 2, "each walks to another thing"
    assert player.counters["fallbacks"] == 0 and player.counters["decisions"] > 8


def decision(ground: Ground, other: str) -> Decision:
    """What a robot of a team of two knows, the other of which stands at (4, 0)."""
    return dataclasses.replace(ground.decision(), others=(Teammate(other, (4.0, 0.0)),))


def begun(player: TeamAgent) -> TeamAgent:
    player.reset({"a-0": brief(seed=1), "b-1": brief(seed=2)})
    return player


def seeing() -> Ground:
    """A robot that has looked around."""
    ground = Ground(last=(Action("explore"), Result(True, "", 60)))
    ground.look()
    return ground


@pytest.mark.parametrize("way", ["json", "letter", "think"])
def test_in_each_way_a_robot_can_tell(server: ScriptedServer, way: str) -> None:
    player = begun(team_agent(f"llm:base_url={server.address},model=tells,way={way}"))
    player.act({"a-0": decision(Ground(), "b-1")})  # it looks around first
    made = player.act({"a-0": decision(seeing(), "b-1")})
    assert made == {"a-0": Action("tell", "I fetch stone. I see mug. I see book.")}
    assert player.counters["told"] == 1 and player.counters["invalid"] == 0
    assert "by the script tells" in str(player.notes["a-0"])


@pytest.mark.parametrize("way", ["json", "letter", "think"])
def test_messages_that_cannot_be_sent_are_counted_as_answers_that_cannot_be_read(
    server: ScriptedServer, way: str
) -> None:
    player = begun(team_agent(f"llm:base_url={server.address},model=tells-too-much,way={way}"))
    made = player.act({"a-0": decision(seeing(), "b-1"), "b-1": decision(seeing(), "a-0")})
    assert made == dict.fromkeys(("a-0", "b-1"), Action("walk_to", "mug")), "the first option, by the rule"
    assert [player.counters[name] for name in ("decisions", "invalid", "fallbacks", "told")] == [2, 4, 2, 0]
    assert "a message must be 1 to 200 printable characters" in str(player.notes["a-0"])


@pytest.mark.parametrize("words", ["", "  ", None, 7, LONG, "two\nlines"])
def test_what_a_message_may_be_is_said_and_asked_for_again(words: Any) -> None:
    asked: list[str] = []

    def act(handler: Any, request: dict[str, Any]) -> None:
        asked.append(request["messages"][-1]["content"])
        letter = next(k for k, text in block_in(request["messages"][1]["content"])["options"].items() if text == "tell")
        answer = {"reason": "", "choice": letter, "message": words if len(asked) == 1 else "I fetch mug"}
        send(handler, 200, message(json.dumps(answer)))

    with serving(act) as address:
        player = begun(team_agent(f"llm:base_url={address},model=m"))
        assert player.act({"b-1": decision(seeing(), "a-0")}) == {"b-1": Action("tell", "I fetch mug")}
    assert "a message must be 1 to 200 printable characters" in asked[1] and '"message"' in asked[1]
    assert [player.counters[name] for name in ("invalid", "repaired", "told")] == [1, 1, 1]


def test_all_that_are_free_are_asked_at_the_same_time() -> None:
    """The server answers when it has been asked by both."""
    both = threading.Barrier(2, timeout=20.0)

    def act(handler: Any, request: dict[str, Any]) -> None:
        both.wait()
        send(handler, 200, message(json.dumps({"reason": "", "choice": "A", "message": ""})))

    with serving(act) as address:
        player = begun(team_agent(f"llm:base_url={address},model=m,tries=1"))
        player.act({"a-0": decision(seeing(), "b-1"), "b-1": decision(seeing(), "a-0")})
    assert player.counters["decisions"] == 2 and player.counters["fallbacks"] == player.counters["lost"] == 0


def test_servers_that_say_nothing_end_the_episode_in_time(server: ScriptedServer) -> None:
    player = begun(team_agent(f"llm:base_url={server.address},model=hang,deadline=0.5,tries=1"))
    for _ in range(2):
        player.act({"a-0": decision(seeing(), "b-1"), "b-1": decision(seeing(), "a-0")})
    with pytest.raises(RuntimeError, match="no answer came for 3 decisions in a row"):
        player.act({"a-0": decision(seeing(), "b-1")})
    assert player.counters["lost"] == 5 and player.counters["fallbacks"] == 4
    server.stop()
    with pytest.raises(ValueError, match="address of a running server"):
        team_agent(f"llm:base_url={server.address},model=greedy")


@pytest.mark.parametrize(
    ("parameters", "told"),
    [
        ("way=logprob", "way of a team, .* must be one of json, letter, think, got 'logprob'"),
        ("version=llm-2-image", "version of a team without colours must be one of llm-1, llm-2, llm-3"),
        ("words=3", "a parameter of Llm must be one of base_url="),
    ],
)
def test_what_no_team_can_have_is_refused(server: ScriptedServer, parameters: str, told: str) -> None:
    with pytest.raises(ValueError, match=told):
        team_agent(f"llm:base_url={server.address},model=greedy,{parameters}")


def test_each_robot_has_the_budget_and_one_that_has_spent_it_stops_alone(server: ScriptedServer) -> None:
    player = begun(team_agent(f"llm:base_url={server.address},model=greedy,most_calls=1"))
    known = {"a-0": decision(seeing(), "b-1"), "b-1": decision(seeing(), "a-0")}
    player.act({"a-0": known["a-0"]})
    assert player.act(known) == {"a-0": Action("stop"), "b-1": Action("walk_to", "stone")}
    assert player.counters["calls"] == 2 and "1 calls is spent" in str(player.notes["a-0"])


def test_a_team_of_one_is_told_what_a_robot_alone_is_told(server: ScriptedServer) -> None:
    player = team_agent(f"llm:base_url={server.address},model=tells")
    assert isinstance(player, LanguageModels)
    player.reset({"a-0": brief()})
    assert player.act({"a-0": seeing().decision()}) == {"a-0": Action("walk_to", "stone")}


def test_the_scripted_rule_leaves_things_to_the_one_that_said_first_that_it_fetches_them() -> None:
    options = {"A": "fetch mug", "B": "fetch book", "C": "look", "D": "stop", "E": "tell"}
    targets = [["option", "thing", "value", "metres"], ["A", "mug", 1, 1.0], ["B", "book", 1, 2.0]]
    said = [[30, "a-0", "I fetch mug. I see book."], [30, "b-1", "I fetch mug."]]
    told: Block = {"robot": "a-0", "options": options, "targets": targets, "held": None}
    told |= {"places_to_search": [["option"]], "last_actions": [["action", "result"], ["tell", "done"]]}
    told["radio"] = [["frames_ago", "from", "text"], *said]
    assert tells(told) == ("A", "") and tells({**told, "robot": "b-1"}) == ("E", "I fetch book.")
    said[0][0] = 29
    assert tells(told | {"radio": [told["radio"][0], *said]}) == ("E", "I fetch book.")
    assert RULES["first"]({**told, "options": {"A": "stop", "B": "tell"}}) == "A"


def test_the_newest_ten_messages_are_told_and_of_a_long_prompt_the_oldest_are_left_out() -> None:
    """All of 20 targets are known, and three others tell as much as can be told: digits and signs have most tokens."""
    ground = Ground({name: (1.0, 0.1 * k) for k, name in enumerate(LARGEST)}, dict.fromkeys(LARGEST, 5.0))
    ground.look()
    ground.last = (Action("tell", "I stay"), Result(True, "", FRAMES))
    heard = [Message(10 * k, "fetch-1", f"{k}: {100 * '1;'}"[:200]) for k in range(12)]
    others = tuple(Teammate(f"fetch-{k}", (2.0, float(k))) for k in (1, 2, 3))
    ground.frame = 115
    known = dataclasses.replace(ground.decision(), messages=tuple(heard), others=others)
    memory, radio = Memory(0), Radio("fetch-0")
    radio.note(known)
    on_offer = menu(known, {}, {}, 4, "macro", 20, tells=True)
    told = radio.added(block(brief(), known, memory, on_offer), brief(), known, memory.rooms)
    texts = [row["text"] for row in rows(told["radio"])]
    assert texts == [*(message.text for message in heard[3:]), "I stay"]
    names = ("fetch-0", *(other.name for other in others))
    asked, sent = messages("llm-1", system_text(brief(), True, names), told, TELLING_ASKS["json"])
    assert estimate(text_of(asked)) <= 1250 + 1000, "as the docs promise"
    kept = [row["text"] for row in rows(sent["radio"])]
    assert 3 < len(kept) < 10 and kept == texts[-len(kept) :] and len(sent["options"]) == 20
