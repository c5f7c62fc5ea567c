"""A small environment that does what it is told in a step, and be it to hang or to die: for vector environments."""

from __future__ import annotations

import os
import time
from typing import Any

import gymnasium as gym
import numpy as np

WALK, RAISE, ODD, SLEEP, SPIN, DIE, NAP = range(7)  # what an action does


class OddError(Exception):
    """Cannot be made again from what it holds."""

    def __init__(self, one: int, other: int) -> None:
        super().__init__(f"odd: {one} and {other}")


class Naughty(gym.Env[dict[str, np.ndarray], np.int64]):
    """Walks by chance. An episode ends after 3 to 6 steps, terminated or truncated by chance."""

    metadata = {"render_modes": []}  # noqa: RUF012 gymnasium's name and type
    observation_space = gym.spaces.Dict(
        {"place": gym.spaces.Box(-100.0, 100.0, (2,)), "picture": gym.spaces.Box(0, 255, (3, 2), np.uint8)}
    )
    action_space = gym.spaces.Discrete(7)
    mood = "fine"

    def __init__(self, speed: float = 1.0) -> None:
        if not speed > 0:
            raise ValueError(f"speed must be positive, got {speed}")
        self.speed = speed

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> Any:
        super().reset(seed=seed)
        if options and "place" not in options:
            raise ValueError(f"options must be place, got {options}")
        self._left = int(self.np_random.integers(3, 7))
        self._place = np.full(2, (options or {}).get("place", 0.0), np.float32)
        return self._seen(), {"length": self._left, "nested": {"half": self._left / 2}}

    def step(self, action: Any) -> Any:
        if action == RAISE:
            raise ValueError("told to raise")
        if action == ODD:
            raise OddError(1, 2)
        if action == SLEEP:
            time.sleep(1000)
        if action == NAP:
            time.sleep(1.0)
        while action == SPIN:
            pass
        if action == DIE:
            os._exit(7)
        self._left -= 1
        self._place += np.float32(self.speed * self.np_random.normal(size=2))
        over, terminated = self._left == 0, bool(self.np_random.integers(2))
        info = {"place": self._place.copy(), "name": "a", **({"worth": 3.5} if over else {})}
        return self._seen(), float(self._place[0]), over and terminated, over and not terminated, info

    def mood_of(self, name: str, mark: str = "") -> str:
        return f"{name} is {self.mood}{mark}"

    def _seen(self) -> dict[str, np.ndarray]:
        return {"place": self._place.copy(), "picture": np.full((3, 2), int(abs(self._place[0]) * 20) % 256, np.uint8)}


gym.register("Naughty-v0", Naughty)
