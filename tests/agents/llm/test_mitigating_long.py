"""A scripted model plays the tasks with mitigations through HTTP: doors, the extinguisher and carts are used."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from hazard_ms.agents.llm.prompt import BUDGETS, MITIGATING, estimate
from hazard_ms.skills.executor import SkillEnv
from tests.agents.llm.conftest import Made

pytestmark = [pytest.mark.long, pytest.mark.render, pytest.mark.timeout(900)]

# a seed of the split train for each task, and what the model of the script "mitigates" must do there
CASES = {
    "HazardHouseFire-v1": (5, {"extinguish"}),
    "HazardHouseFlood-v1": (5, {"shut"}),
    "HazardGale-v1": (1, {"push"}),
}


@pytest.mark.parametrize("task", list(CASES))
def test_a_scripted_model_plays_each_task_with_its_mitigations(llm: Made, tmp_path: Path, task: str) -> None:
    seed, wanted = CASES[task]
    player = llm("mitigates", trace=str(tmp_path))
    env = SkillEnv.make(task, reward_mode="none")
    try:
        decision, _ = env.reset(seed=seed)
        player.reset(env.brief())
        done: set[str] = set()
        for _ in range(40):
            action = player.act(decision)
            decision, _, terminated, truncated, info = env.step(action)
            done |= {action.verb} if info["result"].ok else set()
            if wanted <= done or terminated or truncated:
                break
        assert wanted <= done, f"done: {done}"
    finally:
        env.close()
    assert player.counters["calls"] == player.counters["decisions"] >= 3
    assert [player.counters[name] for name in ("invalid", "fallbacks", "refused", "lost")] == [0] * 4
    (trace,) = tmp_path.glob("*.jsonl")
    asked = [json.loads(line)["asked"] for line in trace.read_text().splitlines()]
    sizes = [sum(estimate(message["content"]) for message in talk) for talk in asked]
    assert max(sizes) <= BUDGETS["llm-1"] + MITIGATING
