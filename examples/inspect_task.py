"""An evaluation for Inspect AI: any model that Inspect knows plays rescues, one episode for each sample.

    pip install 'hazard_ms[llm]' inspect_ai
    inspect eval examples/inspect_task.py --model openai/gpt-4o -T env_id=HazardFlood-v1 --max-samples 4

The agent `llm` plays in a process of its own, 1.6 GB for each sample. It asks at an address of this machine, where
Inspect's model answers: settings, retries, limits and logs of models are Inspect's.
"""

from __future__ import annotations

import json
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from queue import SimpleQueue
from typing import Any

import anyio
from inspect_ai import Task, task
from inspect_ai.dataset import Sample
from inspect_ai.model import get_model, messages_from_openai
from inspect_ai.scorer import Score, Scorer, Target, mean, scorer, stderr
from inspect_ai.solver import Generate, Solver, TaskState, solver

from hazard_ms.evaluation.attempts import attempt
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.workers import Job, Worker

LONGEST = 3600.0  # time for an answer, with Inspect's own retries [s]
PAUSE = 0.05  # between two looks for news of the episode [s]
STOPS = {"max_tokens": "length", "model_length": "length", "content_filter": "content_filter"}  # else "stop"


@task
def rescue(
    env_id: str = "HazardFire-v1",
    split: str = "test",
    episodes: int = 25,
    seed: int = 0,
    version: str = "llm-1",
    way: str = "letter",
) -> Task:
    """Episodes of `env_id`, one for each seed from `seed` on; `version` and `way` are those of the agent `llm`."""
    samples = [Sample(f"{env_id}, {split}, seed {s}", id=s) for s in range(seed, seed + episodes)]
    return Task(dataset=samples, solver=rescuer(env_id, split, version, way), scorer=value_rescued())


@solver
def rescuer(env_id: str, split: str, version: str, way: str) -> Solver:
    """Plays the episode of a sample; its result is in the store."""
    server_decides = "temperature=none,top_p=none,send_seed=false,tries=1"

    async def solve(state: TaskState, generate: Generate) -> TaskState:
        server = Questions()
        agent = f"llm:base_url={server.address},model=inspect,version={version},way={way},deadline={LONGEST:g}"
        options = EpisodeOptions(env_id, split, agent=f"{agent},{server_decides}", seed=int(state.sample_id))
        worker, fault = Worker(attempt), None
        try:
            worker.begin(Job(options, 2 * LONGEST))
            while (outcome := worker.outcome()) is None:
                if not server.asked.empty():
                    messages, answer = server.asked.get()
                    try:
                        state.output = await get_model().generate(await messages_from_openai(messages))
                        answer.put((200, completion(state.output)))
                    except Exception as error:  # such as a limit of Inspect's: the episode ends, and is scored so far
                        fault = error
                        answer.put((403, {"error": {"message": str(error)}}))
                await anyio.sleep(PAUSE)
        finally:
            worker.end(now=True)
            server.shutdown()
            server.server_close()
        if outcome.result is not None:
            state.store.set("result", json.loads(outcome.result.to_json()))
        if fault is not None or outcome.result is None:
            raise fault or RuntimeError(outcome.error)
        return state

    return solve


@scorer(metrics=[mean(), stderr()])
def value_rescued() -> Scorer:
    """The score Value of the episode, 0 to 1, as far as it was played; its counters are in the metadata."""

    async def score(state: TaskState, target: Target) -> Score:
        result = state.store.get("result")
        if result is None:
            return Score(value=0.0, explanation="the episode was cut off")
        told = {name: result[name] for name in ("counters", "frames", "error", "command")}
        return Score(value=result["score"]["value"], answer=result["ended"], metadata=told)

    return score


class Questions(ThreadingHTTPServer):
    """Takes chat completions at `address`: each is put into `asked`, with a queue for its answer, (status, body)."""

    daemon_threads = True

    def __init__(self) -> None:
        super().__init__(("127.0.0.1", 0), Handler)
        self.asked: SimpleQueue[tuple[list[Any], SimpleQueue[tuple[int, dict[str, Any]]]]] = SimpleQueue()
        self.address = f"http://127.0.0.1:{self.server_address[1]}/v1"
        threading.Thread(target=self.serve_forever, kwargs={"poll_interval": 0.05}, daemon=True).start()


class Handler(BaseHTTPRequestHandler):
    server: Questions

    def do_POST(self) -> None:  # noqa: N802 the name that the base class calls
        request = json.loads(self.rfile.read(int(self.headers["Content-Length"])))
        answer: SimpleQueue[tuple[int, dict[str, Any]]] = SimpleQueue()
        self.server.asked.put((request["messages"], answer))
        status, body = answer.get()
        content = json.dumps(body).encode()
        self.send_response(status)
        self.send_header("Content-Type", "application/json")
        self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, format: str, *args: Any) -> None:
        """Print nothing."""


def completion(output: Any) -> dict[str, Any]:
    """What a model of Inspect's put out, as a chat completion."""
    used = {} if output.usage is None else output.usage.model_dump(include={"input_tokens", "output_tokens"})
    usage = {"prompt_tokens": used.get("input_tokens"), "completion_tokens": used.get("output_tokens")}
    message = {"role": "assistant", "content": output.completion}
    return {"choices": [{"message": message, "finish_reason": STOPS.get(output.stop_reason, "stop")}], "usage": usage}
