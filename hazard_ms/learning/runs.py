"""A training and its files, which are written together at every check.

NAME.safetensors and NAME.json hold the best policy, NAME.csv the curve of learning, and NAME.training all that is
needed to go on.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import torch

from hazard_ms.agents.learned.weights import contents, packed_state, told
from hazard_ms.learning.checks import Check
from hazard_ms.learning.ppo import Learner
from hazard_ms.spec.storage.files import write_together

RESUMABLE, CURVE = ".training", ".csv"


class Run:
    """Trains a learner, and keeps what it becomes."""

    def __init__(self, path: Path, task: str, facts: Mapping[str, Any]) -> None:
        """Keep files beside `path`, NAME.safetensors; `facts`, plain data, say how the policy of `task` comes about.

        Their `command` is that which resumes it, without its folder and without the numbers after which it ends.
        """
        self.path, self._task, self._facts = path, task, dict(facts)

    def state(self) -> bytes | None:
        """The state of an interrupted training by the same command; None if there is none.

        Raises ValueError if there is one by another command, or a damaged one.
        """
        kept = self.path.with_suffix(RESUMABLE)
        if not kept.exists():
            return None
        try:
            before = told(self.path)["command"]
        except (ValueError, KeyError) as error:
            raise ValueError(
                f"{kept} must have its NAME.json beside it, got {error}: delete both to start over"
            ) from None
        if before != self._facts["command"]:
            raise ValueError(
                f"{kept} must belong to the training `{self._facts['command']}`, got `{before!s:.500}`: give another "
                "folder, or delete it"
            )
        return packed_state(kept)

    def train(self, learner: Learner, decisions: int, minutes: float) -> None:
        """Train `learner` until there were `decisions` in all, or for `minutes` in all, and print how it gets on.

        Raises ValueError for numbers that are not positive, and where files cannot be written.
        """

        def keep(check: Check) -> None:
            self._keep(learner)
            print(line(learner.curve, decisions, minutes), flush=True)

        if learner.curve:
            print(f"resumes after {learner.curve[-1].decisions:,} decisions")
        threads = torch.get_num_threads()
        torch.set_num_threads(1)
        try:
            learner.train(decisions, minutes, keep)
        finally:
            torch.set_num_threads(threads)

    def _keep(self, learner: Learner) -> None:
        best = dataclasses.asdict(max(learner.curve, key=lambda check: check.validation))
        weights, facts = contents(learner.best, self._task, {**self._facts, "best": best, "value": learner.value()})
        names = [field.name for field in dataclasses.fields(Check)]
        rows = [",".join(f"{value:.6g}" for value in dataclasses.astuple(check)) for check in learner.curve]
        parts: dict[str, str | bytes] = {
            self.path.suffix: weights,
            ".json": facts,
            CURVE: "\n".join([",".join(names), *rows, ""]),
            RESUMABLE: learner.saved(),
        }
        write_together({self.path.with_suffix(ending): content for ending, content in parts.items()})


def line(curve: list[Check], decisions: int, minutes: float) -> str:
    """A line about the last check of a training, its decisions a second, and the time that is left.

    `decisions` and `minutes`: those after which it ends.
    """
    last, first = curve[-1], curve[max(0, len(curve) - 6)]
    rate = (last.decisions - first.decisions) / max(last.seconds - first.seconds, 1e-9) if len(curve) > 1 else 0.0
    left = 60.0 * minutes - last.seconds
    if rate:
        left = min(left, (decisions - last.decisions) / rate)
    return (
        f"{last.decisions:,} decisions, {rate:,.0f}/s: training {last.training:.3f}, "
        f"validation {last.validation:.3f} (best {last.best:.3f}, greedy {last.greedy:.3f}), "
        f"{max(left, 0.0) / 60.0:.0f} min left"
    )
