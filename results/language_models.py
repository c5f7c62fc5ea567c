"""Plays language models that need no network, and writes language_models.md: `./run python results/language_models.py`.

The scripted model `greedy` plays the 25 scenes of each task's split `test` beside the agent `greedy`; the small model
of HAZARD_MS_LOCAL_LLM=1, where it is installed, plays one episode of each task. Resumes where it stopped; with `tables`
alone it plays nothing.
"""

from __future__ import annotations

import importlib.util
import sys
from collections import Counter
from collections.abc import Sequence

from hazard_ms.evaluation.comparison.pairing import difference
from hazard_ms.evaluation.result import EpisodeResult
from results.tables import HERE, TASKS, evaluate, machine, results_in, value_of, words

RAW = HERE.parent / "build" / "language_models"
SCRIPTED = "llm:base_url=scripted,model=greedy"
SMALL = "llm:base_url=local,deadline=120"
SMALL_SEED = 3  # of the split train
SMALL_MODEL = "xllamacpp"  # package that serves it
COUNTED = ("decisions", "calls", "invalid", "fallbacks", "tokens_in", "tokens_out")
HEAD = """# Language models without a network

Made by `./run python results/language_models.py`. `scripted` is a rule that reads nothing but the prompt and answers
over HTTP as a language model does: it shows how little of what `greedy` knows is lost in prompt and parser.
`SmolLM2-135M` is a real model, small enough for one core; one episode of each task says that it runs, and nothing of
how well it decides.
Values are in percent, with 95 % bootstrap intervals over scenes, the difference paired by episode; counts are sums
over episodes, and tokens means per call.
Written at
{machine}.

"""


def play(task: str) -> None:
    """Play what is missing of a task."""
    evaluate(task, RAW / task, "--agents", "greedy", SCRIPTED)
    if importlib.util.find_spec(SMALL_MODEL) is not None:
        options = ["--split", "train", "-s", str(SMALL_SEED), "--episodes", "1", "--timeout", "600"]
        evaluate(task, RAW / f"{task}-small", *options, "--agents", SMALL)


def read(folder: str) -> dict[str, list[EpisodeResult]]:
    """The results in a folder, by agent."""
    found: dict[str, list[EpisodeResult]] = {}
    for result in results_in(RAW / folder):
        found.setdefault("greedy" if result.agent == "greedy" else "llm", []).append(result)
    return found


def row(task: str, name: str, results: Sequence[EpisodeResult], less: str = "-") -> str:
    """A row of the table."""
    total: Counter[str] = Counter()
    for result in results:
        total.update({counter: int(result.counters.get(counter, 0)) for counter in COUNTED})
    value = words(value_of(results))
    counts: list[object] = ["-"] * len(COUNTED)
    if total["calls"]:
        tokens = (round(total[counter] / total["calls"]) for counter in ("tokens_in", "tokens_out"))
        counts = [*(total[counter] for counter in COUNTED[:4]), *tokens]
    cells = [task, name, len(results), value, less, *counts]
    return f"| {' | '.join(map(str, cells))} |"


def table() -> str:
    """All that was played, Markdown."""
    names = ("task", "model", "episodes", "Value", "less `greedy`", "decisions", "calls", "invalid", "fallbacks")
    lines = [f"| {' | '.join((*names, 'tokens read', 'tokens written'))} |", "|---" * (len(names) + 2) + "|"]
    for task in TASKS:
        found = read(task)
        if found:
            model, plain = ({(r.seed, r.scene): r.tally.value for r in found[name]} for name in ("llm", "greedy"))
            lines.append(row(task, "scripted", found["llm"], words(difference(model, plain))))
            lines.append(row(task, "none: `greedy`", found["greedy"]))
        if small := read(f"{task}-small"):
            lines.append(row(task, "SmolLM2-135M", small["llm"]))
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    if sys.argv[1:] != ["tables"]:
        for each in TASKS:
            play(each)
    (HERE / "language_models.md").write_text(HEAD.format(machine=machine()) + table(), encoding="utf-8")
    print(table())
