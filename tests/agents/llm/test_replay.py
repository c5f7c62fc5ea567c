"""Episodes of a model in the simulator: played again out of recorded answers, they are the same to the last hash."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from hazard_ms.agents.llm.agent import Llm
from hazard_ms.agents.llm.scripted import ScriptedServer
from hazard_ms.evaluation.attempts import Recorded
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.result import EpisodeResult
from hazard_ms.evaluation.runner import Runner, play, result_of
from hazard_ms.skills.executor import SkillEnv

SEED = 3
FRAMES = 170  # long enough for a look and a walk


def test_with_recorded_answers_an_episode_is_the_same(env: SkillEnv, server: ScriptedServer, tmp_path: Path) -> None:
    """By the wall clock, too: the times are those that were recorded."""
    file = str(tmp_path / "answers.sqlite")
    player = Llm(base_url=server.address, model="greedy", cache=file)
    played = Runner(env, player, clock="wall").run(SEED, until_frame=FRAMES)
    server.stop()
    again = Llm(base_url=server.address, model="greedy", cache=file, replay=True)
    replayed = Runner(env, again, clock="wall").run(SEED, until_frame=FRAMES)
    assert (replayed.links, replayed.decisions, replayed.ended) == (played.links, played.decisions, played.ended)
    assert len(played.decisions) >= 2 and any(d.waited for d in played.decisions)
    assert replayed.counters == {**played.counters, "cached": played.counters["calls"]}
    actions = tuple((d.verb, d.target) for d in played.decisions)
    recorded = Recorded(actions, "llm", tuple(d.waited for d in played.decisions))
    assert Runner(env, recorded).run(SEED, until_frame=FRAMES).links == played.links, "as hazard-ms replay plays it"


def test_a_result_holds_the_counts_of_its_agent(env: SkillEnv, server: ScriptedServer, tmp_path: Path) -> None:
    options = EpisodeOptions(seed=SEED, agent="llm", clock="tokens")
    player = Llm(base_url=server.address, model="not-json", most_calls=4)
    played = Runner(env, player, clock="tokens").run(SEED)
    result = result_of(options, env, played)
    result.write(tmp_path / "result.json")
    read = EpisodeResult.read(tmp_path / "result.json")
    assert read == result and read.ended == "budget" and read.clock == "tokens"
    assert read.counters["calls"] == 4 and read.counters["fallbacks"] == 2 == sum(d.fallback for d in read.decisions)
    assert json.loads((tmp_path / "result.json").read_text())["score"]["latency"] > 0


@pytest.mark.long
@pytest.mark.parametrize("env_id", ["HazardFire-v1", "HazardFlood-v1", "HazardWind-v1"])
@pytest.mark.parametrize("model", ["greedy", "first", "not-json", "truncated", "429-then-ok"])
def test_whole_episodes_end_and_count(env_id: str, model: str, server: ScriptedServer) -> None:
    player = Llm(base_url=server.address, model=model)
    result = play(EpisodeOptions(env_id=env_id, seed=SEED, agent="llm"), player=player)
    assert result.ended in ("time", "stopped", "all rescued") and result.decisions
    readable = model not in ("not-json", "truncated")
    assert result.counters["fallbacks"] == (0 if readable else result.counters["decisions"])
    assert result.counters["lost"] == 0
