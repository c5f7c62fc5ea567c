"""What frames, looks and episodes cost now and at an older commit: `./run python results/paired.py COMMIT [ROUNDS]`.

Both versions run in turn, each in a process of its own with one thread, and write results/paired.md. The older one must
run with today's packages, and with git.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
TASKS = ("HazardFire-v1", "HazardFlood-v1", "HazardWind-v1")
FRAMES, TURNS = 30, 14  # frames of a turn with random actions, and turns to take the median of [ours]
LOOKS = 15  # to take the median of [ours]
ROUNDS = 3  # in which both versions have their turn [ours]


def measured() -> Iterator[tuple[str, float]]:
    """Processor time of this version: of a frame [us], of a look [ms], and of a greedy episode of 1,500 frames [s]."""
    import gymnasium as gym
    import torch

    from hazard_ms.agents.base import agent
    from hazard_ms.evaluation.runner import Runner
    from hazard_ms.skills.decision import EXPLORE, Action
    from hazard_ms.skills.executor import SkillEnv

    torch.set_num_threads(1)
    for task in TASKS:
        env = gym.make(task, obs_mode="state", render_backend="none")
        env.reset(seed=0)
        space = env.unwrapped.single_action_space  # type: ignore[attr-defined]
        rng = np.random.default_rng(0)
        actions = rng.uniform(space.low, space.high, (TURNS + 1, FRAMES, *space.shape)).astype(np.float32)
        spans = []
        for turn in actions:
            start = time.process_time()
            for action in turn:
                env.step(action)
            spans.append(time.process_time() - start)
        env.close()
        yield f"frame of {task}, state observation [us]", float(np.median(spans[1:])) / FRAMES * 1e6
    made = SkillEnv.make(TASKS[0])
    made.colours = False  # as greedy plays it
    made.reset(seed=0)
    made.step(Action(EXPLORE))  # the first picture compiles shaders
    spans = []
    for _ in range(LOOKS):
        start = time.process_time()
        made.look()
        spans.append(time.process_time() - start)
    yield "look, 256 pixels [ms]", float(np.median(spans)) * 1e3
    start = time.process_time()
    Runner(made, agent("greedy")).run(0)
    yield "greedy episode, for 1,500 frames [s]", (time.process_time() - start) * 1500 / made.frame
    made.close()


def run(checkout: Path) -> dict[str, float]:
    """What the version in `checkout` measures of itself."""
    kept = {**os.environ, "PYTHONPATH": str(checkout), "OMP_NUM_THREADS": "1"}
    command = [sys.executable, str(HERE / "paired.py"), "--measure"]
    done = subprocess.run(command, cwd=checkout, env=kept, stdout=subprocess.PIPE, text=True, check=True)
    found: dict[str, float] = json.loads(done.stdout.splitlines()[-1])
    return found


def table(before: list[dict[str, float]], now: list[dict[str, float]]) -> str:
    """The medians of both versions' rounds, and how many times less today's takes."""
    lines = ["| processor time of a | before | now | ratio |", "|---|---:|---:|---:|"]
    for name in now[0]:
        one, other = (float(np.median([found[name] for found in rounds])) for rounds in (before, now))
        lines.append(f"| {name} | {one:.1f} | {other:.1f} | {one / other:.2f} |")
    return "\n".join(lines) + "\n"


def main(commit: str, rounds: int) -> None:
    """Measure `commit` and the present checkout in turn, and write the table."""
    from results.tables import machine

    root = HERE.parent
    load = os.getloadavg()[1]
    with tempfile.TemporaryDirectory() as folder:
        older = Path(folder) / "older"
        subprocess.run(["git", "-C", str(root), "worktree", "add", "--detach", str(older), commit], check=True)
        try:
            pairs = [(run(older), run(root)) for _ in range(rounds)]
        finally:
            subprocess.run(["git", "-C", str(root), "worktree", "remove", "--force", str(older)], check=True)
    text = f"# Beside an older version\n\nMade by `./run python results/paired.py {commit}`: {machine()}. "
    text += f"Both versions in turn, medians of {rounds} rounds, one thread. "
    text += f"In the minutes before, {load:.1f} processes wanted the cores.\n\n"
    text += table([one for one, _ in pairs], [other for _, other in pairs])
    (HERE / "paired.md").write_text(text, encoding="utf-8")
    print(text)


if __name__ == "__main__":
    if sys.argv[1:] == ["--measure"]:
        print(json.dumps(dict(measured())))
    else:
        main(sys.argv[1], int(sys.argv[2]) if len(sys.argv) > 2 else ROUNDS)
