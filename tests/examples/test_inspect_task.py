"""The example for Inspect AI: its model is asked and answers, and its scores are those of the episodes.

Most tests have a stub of what the example uses of Inspect, and a playground in place of the simulator; the last one has
the real ones, where Inspect is installed.
"""

from __future__ import annotations

import dataclasses
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from types import ModuleType, SimpleNamespace
from typing import Any

import anyio
import pytest

from hazard_ms.agents.base import agent
from hazard_ms.agents.llm.prompt import text_of
from hazard_ms.agents.llm.rules import RULES, block_in
from hazard_ms.evaluation.metrics import Fate
from hazard_ms.evaluation.workers import Job, Outcome
from tests.worlds.playground import Playground, play
from tests.worlds.registering import loaded
from tests.worlds.results import result_of

EXAMPLE = Path(__file__).parents[2] / "examples" / "inspect_task.py"
VALUES = {"mug": 1.0, "book": 5.0}


class Model:
    """A model of Inspect: `says` makes the text of an answer from the messages. It keeps what it was asked."""

    def __init__(self, says: Callable[[list[Any]], str]) -> None:
        self.says = says
        self.asked: list[list[Any]] = []

    async def generate(self, messages: list[Any]) -> Any:
        self.asked.append(messages)
        usage = SimpleNamespace(model_dump=lambda include: {"input_tokens": 700, "output_tokens": 5})
        return SimpleNamespace(completion=self.says(messages), stop_reason="stop", usage=usage)


class Played:
    """A worker that plays in a thread, in the playground."""

    def __init__(self, attempt: Any) -> None:
        self.done: Outcome | None = None

    def begin(self, job: Job) -> None:
        threading.Thread(target=self._play, args=(job,), daemon=True).start()

    def _play(self, job: Job) -> None:
        ground = Playground({"mug": (2.0, 0.0), "book": (0.0, 2.5)}, dict(VALUES))
        player, error = agent(job.options.agent), ""
        try:
            play(player, ground)
        except RuntimeError as raised:
            error = str(raised)
        saved = {name: name in ground.rescued for name in VALUES}
        fates = tuple(Fate(n, n, v, saved[n], False, 9 if saved[n] else None) for n, v in VALUES.items())
        row = dataclasses.replace(result_of(job.options), ended="error" if error else "stopped", error=error)
        self.done = Outcome(dataclasses.replace(row, targets=fates, counters=dict(player.counters)), error)

    def outcome(self) -> Outcome | None:
        return self.done

    def end(self, now: bool = False) -> None:
        pass


class Store(dict[str, Any]):
    def set(self, name: str, entry: Any) -> None:
        self[name] = entry


def greedily(messages: list[Any]) -> str:
    return f"The best one.\nAnswer: {RULES['greedy'](block_in(text_of(messages)))}"


@pytest.fixture
def example(monkeypatch: pytest.MonkeyPatch) -> Iterator[Any]:
    """The example with a stub of Inspect: decorators that change nothing, and plain records."""

    async def as_they_are(messages: list[Any]) -> list[Any]:
        return messages

    plain = lambda made: made  # noqa: E731
    names: dict[str, dict[str, Any]] = {
        "inspect_ai": {"Task": SimpleNamespace, "task": plain},
        "inspect_ai.dataset": {"Sample": lambda text, id: SimpleNamespace(input=text, id=id)},
        "inspect_ai.model": {"get_model": None, "messages_from_openai": as_they_are},
        "inspect_ai.scorer": {
            "Score": lambda **told: SimpleNamespace(**told),
            "scorer": lambda metrics: plain,
            "mean": lambda: "mean",
            "stderr": lambda: "stderr",
            "Scorer": None,
            "Target": None,
        },
        "inspect_ai.solver": {"solver": plain, "Generate": None, "Solver": None, "TaskState": None},
    }
    for name, entries in names.items():
        module = ModuleType(name)
        module.__dict__.update(entries)
        monkeypatch.setitem(sys.modules, name, module)
    with loaded(EXAMPLE) as made:
        monkeypatch.setattr(made, "Worker", Played)
        yield made


def solved(example: Any, monkeypatch: pytest.MonkeyPatch, model: Model) -> tuple[Any, Exception | None]:
    """The score of the first sample, and the error that ended it."""
    monkeypatch.setattr(example, "get_model", lambda: model)
    task = example.rescue(episodes=3, seed=4)
    assert [sample.id for sample in task.dataset] == [4, 5, 6]
    state, fault = SimpleNamespace(sample_id=task.dataset[0].id, store=Store(), output=None), None
    try:
        anyio.run(task.solver, state, None)
    except Exception as error:
        fault = error
    return anyio.run(task.scorer, state, None), fault


def test_the_model_of_inspect_plays_and_is_scored(example: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    model = Model(greedily)
    score, fault = solved(example, monkeypatch, model)
    assert fault is None and score.value == 1.0 and score.answer == "stopped"
    counters = score.metadata["counters"]
    assert counters["decisions"] == counters["calls"] == len(model.asked) >= 3
    assert counters["tokens_in"] == 700 * len(model.asked) and counters["tokens_out"] == 5 * len(model.asked)
    assert [message["role"] for message in model.asked[0]] == ["system", "user"]
    assert not any(counters[name] for name in ("fallbacks", "invalid", "lost", "retries"))


def test_an_error_of_the_model_ends_the_sample_with_what_was_saved(
    example: Any, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Inspect's limits are errors: it wants them back, and scores what there is. The book counts 5 of 6."""

    def limited(messages: list[Any]) -> str:
        if block_in(text_of(messages))["saved"]:
            raise LookupError("token limit exceeded")
        return greedily(messages)

    score, fault = solved(example, monkeypatch, Model(limited))
    assert isinstance(fault, LookupError) and score.answer == "error"
    assert 0.0 < score.value < 1.0 and "token limit exceeded" in score.metadata["error"]


def test_what_breaks_off_is_told_so(example: Any) -> None:
    made = SimpleNamespace(completion="Answ", stop_reason="max_tokens", usage=None)
    told = example.completion(made)["choices"][0]
    assert told == {"message": {"role": "assistant", "content": "Answ"}, "finish_reason": "length"}


@pytest.mark.render
@pytest.mark.long
def test_inspect_evaluates_a_model_in_a_room(tmp_path: Path) -> None:
    """The real library: the model looks around, and then stops, so that the episode is short."""
    inspect_ai = pytest.importorskip("inspect_ai")
    from inspect_ai.model import ModelOutput, ModelUsage, get_model

    def says(messages: Any, *settings: Any) -> Any:
        block = block_in(messages[-1].text)
        wanted = "stop" if block["last_actions"][1:] else "look"
        letter = next(letter for letter, words in block["options"].items() if words == wanted)
        made = ModelOutput.from_content("mockllm/model", f"Answer: {letter}")
        made.usage = ModelUsage(input_tokens=700, output_tokens=5)  # else Inspect counts with a file from the network
        return made

    with loaded(EXAMPLE) as example:
        model = get_model("mockllm/model", custom_outputs=says)
        (log,) = inspect_ai.eval(example.rescue(episodes=1), model=model, log_dir=str(tmp_path), display="none")
    assert log.status == "success", log.error
    assert log.results.scores[0].metrics["mean"].value == 0.0 and "stderr" in log.results.scores[0].metrics
    score = log.samples[0].scores["value_rescued"]
    counters = score.metadata["counters"]
    assert score.answer == "stopped" and score.metadata["frames"] > 0
    assert (counters["decisions"], counters["fallbacks"], counters["tokens_in"]) == (2, 0, 1400)
    assert log.samples[0].store["result"]["env_id"] == "HazardFire-v1"
