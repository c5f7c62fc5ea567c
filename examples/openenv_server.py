"""Rescues as an OpenEnv environment, in which language models can be trained over HTTP and WebSocket.

    pip install 'hazard_ms[llm]' openenv
    python examples/openenv_server.py --env-id HazardFlood-v1 --port 8000

An observation holds the messages that the agent `llm` would send, an action is the letter of an option, and the reward
of a step is the value that it rescued: those of an episode add up to its score Value. Each session has a simulation of
its own, 1.6 GB. They take turns in one thread: start more servers to use more cores.
"""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from functools import partial
from typing import Any

import tyro
from openenv.core import Action as Message
from openenv.core import Environment, Observation, State, create_app

from hazard_ms import Action
from hazard_ms.agents.llm.answers import ASKS, LETTER
from hazard_ms.agents.llm.choices import LETTERS, MACRO, SEARCH, forced, menu
from hazard_ms.agents.llm.memory import Memory
from hazard_ms.agents.llm.prompt import messages, system_text
from hazard_ms.agents.llm.scene_text import block
from hazard_ms.evaluation.metrics import Tally
from hazard_ms.evaluation.options import EnvOptions
from hazard_ms.evaluation.runner import fates
from hazard_ms.skills.actions import wait
from hazard_ms.skills.decision import EXPLORE, Decision
from hazard_ms.skills.executor import SkillEnv

GIVE_UP = 4  # failures with a thing after which it is no longer an option
IDLE = 10  # frames that a letter takes that is no option, so that every episode ends
SIMULATOR = ThreadPoolExecutor(1)  # all simulations run in its one thread, from whichever thread they are asked for


class Choose(Message):
    """What a model does."""

    letter: str


class Situation(Observation):
    """What a model is told. Its metadata says at which frame, what was rescued so far, and what was wrong."""

    messages: list[dict[str, Any]]
    options: dict[str, str]  # in words, by their letters


class Rescue(Environment):
    """The rescues of one session."""

    SUPPORTS_CONCURRENT_SESSIONS = True

    def __init__(self, env_id: str, split: str) -> None:
        super().__init__()
        self._make = partial(SkillEnv.make, env_id, split=split)
        self._env: SkillEnv | None = None  # made by the first reset, as servers make objects for mere questions, too
        self._state, self._over = State(), True

    @property
    def state(self) -> State:
        return self._state

    def reset(self, seed: int | None = None, episode_id: str | None = None, **_: Any) -> Situation:
        return SIMULATOR.submit(self._reset, seed, episode_id).result()

    def step(self, action: Choose, timeout_s: float | None = None, **_: Any) -> Situation:
        return SIMULATOR.submit(self._step, action.letter.strip()).result()

    def close(self) -> None:
        if self._env is not None:
            SIMULATOR.submit(self._env.close).result()
            self._env = None

    def _reset(self, seed: int | None, episode_id: str | None) -> Situation:
        self._env = self._env or self._make()
        decision, _ = self._env.reset(seed=seed)
        self._brief, self._state = self._env.brief(), State(episode_id=episode_id)
        self._memory, self._value, self._over = Memory(self._brief.random_seed), 0.0, False
        self._note(decision)
        return self._situation()

    def _note(self, decision: Decision) -> Action | None:
        """Remember what came of the last action; what follows by itself, if anything does."""
        self._decision = decision
        self._memory.note(decision)
        return Action(EXPLORE) if self._memory.arrived_to_search(decision) else forced(decision)

    def _step(self, letter: str) -> Situation:
        if self._env is None or self._over:
            raise ValueError("the episode must have begun and not be over: call reset first")
        self._state.step_count += 1
        choice = next((choice for choice in self._menu.choices if choice.letter == letter), None)
        if choice is None:
            self._env.run(wait(self._env.stage, IDLE))
            self._decision, self._over = self._env.decision(), self._env.frame >= self._env.max_frames
            return self._situation(f"letter must be one of {', '.join(self._options)}, got {letter!r:.20}")
        action, words, search = choice.action, self._options[letter], choice.move == SEARCH
        while not self._over:
            self._memory.chose(self._decision, action, words, search)
            decision, _, terminated, truncated, _ = self._env.step(action)
            self._over, follows = terminated or truncated, self._note(decision)
            if follows is None:
                break
            action, words, search = follows, str(follows), False
        return self._situation()

    def _situation(self, error: str = "") -> Situation:
        failures, visits = self._memory.believed.failures, self._memory.believed.visits
        self._menu = menu(self._decision, failures, visits, GIVE_UP, MACRO, len(LETTERS))
        told = block(self._brief, self._decision, self._memory, self._menu)
        asked, _ = messages("llm-1", system_text(self._brief, macro=True), told, ASKS[LETTER])
        self._options, before, self._value = told["options"], self._value, Tally.of(fates(self._env)).value
        about = {"frame": self._decision.frame, "value": self._value, "error": error}
        reward = self._value - before
        return Situation(messages=asked, options=self._options, done=self._over, reward=reward, metadata=about)


def application(env_id: str, split: str, sessions: int) -> Any:
    """The application that serves rescues. Raises ValueError for unknown names."""
    EnvOptions(env_id, split).check()
    made = partial(Rescue, env_id, split)
    return create_app(made, Choose, Situation, env_name="hazard_ms", max_concurrent_envs=sessions)


def serve(
    env_id: str = "HazardFire-v1", split: str = "train", sessions: int = 2, host: str = "127.0.0.1", port: int = 8000
) -> None:
    """Serve rescues, to this machine alone unless another `host` is given."""
    import uvicorn

    uvicorn.run(application(env_id, split, sessions), host=host, port=port)


if __name__ == "__main__":
    tyro.cli(serve)
