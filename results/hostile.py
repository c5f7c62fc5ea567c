"""Episodes with language models that misbehave: `./run python results/hostile.py [fire|flood|wind...]`.

In 25 scenes of each task's split `test`, each behaviour of the scripted server plays the first FRAMES frames, with a
key that no file may hold; every fifth is played again out of its recorded answers, without a server. Prints each
episode and writes hostile.md beside this file; stops with an error where an episode breaks a promise.
"""

from __future__ import annotations

import itertools
import os
import sys
import tempfile
import time
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from hazard_ms.agents.base import Agent
from hazard_ms.agents.llm.agent import Llm
from hazard_ms.agents.llm.scripted import BEHAVIOURS, ScriptedServer
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.runner import Runner
from hazard_ms.skills.brief import Brief
from hazard_ms.skills.decision import Action, Decision
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.spec.checks import one_of
from results.tables import machine

HERE = Path(__file__).parent
RAW = HERE.parent / "build" / "hostile"  # the table of each task
TASKS = {"fire": "HazardFire-v1", "flood": "HazardFlood-v1", "wind": "HazardWind-v1"}
KEY = "sk-SENTINEL-0123456789abcdef"
SEEDS = range(25)
FRAMES = 200  # of an episode, enough for a few decisions
REPLAYED = SEEDS[::5]
DEADLINE = 2.0  # for a decision of a model that never answers [s]
SLACK = 5.0  # by which a decision may be late on a busy machine [s]
NOBODY = "http://127.0.0.1:9/v1"  # where no server listens
SILENT = ("500", "hang", "drip", "html", "5mb")
HEAD = f"""# Language models that misbehave

Made by `./run python results/hostile.py`: the first {FRAMES} frames of {len(SEEDS)}
episodes for each task and each behaviour of the scripted server (`hazard-ms llm serve-scripted` says what they do), and
how they ended; counts are sums over episodes. Every call was counted, by the server as by the agent; every fifth
episode, played again out of its recorded answers, without a server, had the same hashes.
Written at
{{machine}}.
"""
FAULTS = ("calls", "retries", "lost", "refused", "truncated", "invalid", "fallbacks")


class Watched(Agent):
    """Keeps the longest time that `player` took for a decision [s]."""

    def __init__(self, player: Llm) -> None:
        self._player, self.longest = player, 0.0

    def reset(self, brief: Brief) -> None:
        """Begin an episode."""
        self._player.reset(brief)

    def act(self, decision: Decision) -> Action:
        """What the player does."""
        begun = time.monotonic()
        try:
            return self._player.act(decision)
        finally:
            self.longest = max(self.longest, time.monotonic() - begun)
            self.fallback, self.counters = self._player.fallback, self._player.counters


def episode(env: SkillEnv, player: Llm, seed: int) -> tuple[list[Any], dict[str, float], float]:
    """Play one. Returns what must be the same again, the counters, and the longest time for a decision [s]."""
    watched = Watched(player)
    try:
        played = Runner(env, watched).run(seed, until_frame=FRAMES)
        same: list[Any] = [played.ended, *played.links, *((d.verb, d.target) for d in played.decisions)]
    except RuntimeError as error:  # an answer that ends the episode
        same = [type(error).__name__, str(error)]
    return same, dict(watched.counters), watched.longest


@dataclass
class Row:
    """The row of the table for one behaviour."""

    ended: Counter[str] = field(default_factory=Counter)
    counts: Counter[str] = field(default_factory=Counter)
    longest: float = 0.0  # time for a decision [s]

    def text(self, model: str) -> str:
        """The row, Markdown."""
        how = ", ".join(f"{count} {reason}" for reason, count in self.ended.most_common())
        return f"| {model} | {how} | {' | '.join(str(self.counts[name]) for name in FAULTS)} | {self.longest:.1f} |"


def hostile(env: SkillEnv, server: ScriptedServer, model: str, seed: int, folder: Path) -> tuple[str, Any, float]:
    """Play an episode with one behaviour, and check it. Returns how it ended, its counters, its longest decision."""
    given: dict[str, Any] = {"model": model, "cache": str(folder / f"{model}.sqlite")}
    given |= {"version": "llm-2-image"} if model == "sees" else {}
    given |= {"deadline": DEADLINE, "tries": 2} if model in SILENT else {}
    player, before = Llm(base_url=server.address, trace=str(folder / model), **given), server.calls
    same, counters, longest = episode(env, player, seed)
    told = f"{model}, seed {seed}"
    check(server.calls - before == counters["calls"] + counters["retries"], f"{told}: {counters}")
    check(longest < player.deadline + SLACK, f"{told}: a decision took {longest:.1f} s")
    if seed in REPLAYED and same[0] != "RefusedError":  # no answer is recorded that ends a run
        again, recounted, _ = episode(env, Llm(base_url=NOBODY, replay=True, **given), seed)
        check(again == same, f"{told}: {again} in place of {same}")
        check(recounted["calls"] == counters["calls"], f"{told}: {recounted}")
    return same[0], counters, longest


def check(holds: bool, told: str) -> None:
    """Raises AssertionError with `told` unless it `holds`."""
    if not holds:
        raise AssertionError(told)


def section(task: str) -> str:
    """Play a task. Returns its table, Markdown."""
    env = SkillEnv.make(TASKS[task], **EpisodeOptions(env_id=TASKS[task], agent="llm").settings)
    server, rows = ScriptedServer().start(), {model: Row() for model in BEHAVIOURS}
    with tempfile.TemporaryDirectory() as name:
        for seed, (model, row) in itertools.product(SEEDS, rows.items()):
            ended, counters, longest = hostile(env, server, model, seed, Path(name))
            row.ended[ended] += 1
            row.counts.update({fault: int(counters[fault]) for fault in FAULTS})
            row.longest = max(row.longest, longest)
            print(f"{task}, seed {seed}, {model}: {ended}, {counters}", flush=True)
        files = [path for path in Path(name).rglob("*") if path.is_file()]
        for path in files:
            check(KEY.encode() not in path.read_bytes(), f"{path.name} holds the key")
    server.stop()
    env.close()
    lines = [f"## {task.capitalize()}\n", f"| model | ended | {' | '.join(FAULTS)} | longest decision [s] |"]
    lines += ["|---" * (len(FAULTS) + 3) + "|", *(row.text(model) for model, row in rows.items())]
    return "\n".join([*lines, f"\nThe key stands in none of {len(files)} files of answers and traces.\n"])


def main(wanted: list[str]) -> None:
    """Play the tasks `wanted`, or all, and write the tables. Raises ValueError for unknown names."""
    os.environ["HAZARD_MS_LLM_KEY"] = KEY
    RAW.mkdir(parents=True, exist_ok=True)
    for task in [one_of(name, TASKS, "a task") for name in wanted] or [*TASKS]:
        (RAW / f"{task}.md").write_text(section(task), encoding="utf-8")
    made = [RAW / f"{task}.md" for task in TASKS]
    told = [path.read_text(encoding="utf-8") for path in made if path.exists()]
    (HERE / "hostile.md").write_text("\n".join([HEAD.format(machine=machine()), *told]), encoding="utf-8")


if __name__ == "__main__":
    main(sys.argv[1:])
