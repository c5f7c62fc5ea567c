"""An environment with the spaces of `HazardRobot-v1` and no simulator, which servers of the tests give to clients."""

from __future__ import annotations

import contextlib
import os
import socket
import threading
from collections.abc import Callable, Iterator
from typing import Any

import gymnasium as gym
import numpy as np

from hazard_ms.lerobot import server

SIDE = 16
TASKS = {"HazardFire-v1": "Stand in.", "HazardFlood-v1": "Stand in water."}


class StandIn(gym.Env[dict[str, Any], Any]):
    """A step adds up the action, and the third one succeeds. `closed` are those of this process that were closed."""

    metadata = {"render_modes": ["rgb_array"], "render_fps": 10}  # noqa: RUF012
    _max_episode_steps = 3
    closed: list[StandIn] = []  # noqa: RUF012

    def __init__(self, task: str = "HazardFire-v1", side: int = SIDE, **settings: Any) -> None:
        if task not in TASKS:
            raise ValueError(f"task must be one of {', '.join(TASKS)}, got {task!r}")
        self.task_description, self.settings = TASKS[task], settings
        picture = gym.spaces.Box(0, 255, (side, side, 3), np.uint8)
        state = gym.spaces.Box(-np.inf, np.inf, (4,), np.float32)
        self.observation_space = gym.spaces.Dict({"pixels": gym.spaces.Dict({"head": picture}), "agent_pos": state})
        self.action_space = gym.spaces.Box(np.float32(-1.5), np.float32(0.1), (2,), np.float32)
        self.side, self.total, self.steps = side, np.zeros(2, np.float32), 0

    def reset(self, *, seed: int | None = None, options: Any = None) -> tuple[dict[str, Any], dict[str, Any]]:
        super().reset(seed=seed)
        self.total, self.steps, self.started = np.float32(self.np_random.random(2)), 0, options
        return self.seen(), {"is_success": False, "value": 0.0, "process": os.getpid()}

    def step(self, action: Any) -> tuple[dict[str, Any], float, bool, bool, dict[str, Any]]:
        if not self.action_space.contains(action):
            raise ValueError(f"action must fit, got {action}")
        if action[0] == np.float32(-1.5):
            raise OSError("the disk is full")
        self.total, self.steps = self.total + action, self.steps + 1
        told = {"is_success": self.steps == 3, "value": 1 / 3, "frames": 3}
        return self.seen(), float(self.total.sum()) / 3.0, self.steps == 3, False, told

    def seen(self) -> dict[str, Any]:
        picture = np.full((self.side, self.side, 3), self.steps, np.uint8)
        return {"pixels": {"head": picture}, "agent_pos": np.float32([*self.total, 1e-42, np.nan])}

    def render(self) -> Any:
        return np.full((8, 4, 3), self.steps, np.uint8)

    def close(self) -> None:
        self.closed.append(self)


@contextlib.contextmanager
def conversation(make: Callable[..., Any] = StandIn, idle: float = 20.0) -> Iterator[str]:
    """The address of a server for one client, in a thread. It has ended when the context has."""
    with socket.create_server(("127.0.0.1", 0)) as listening:

        def answer() -> None:
            link, _ = listening.accept()
            server.converse(link, make, idle)

        thread = threading.Thread(target=answer, daemon=True)
        thread.start()
        yield "{}:{}".format(*listening.getsockname())
        thread.join(20.0)
        assert not thread.is_alive()


@contextlib.contextmanager
def admitting(sessions: int, make: Callable[..., Any] = StandIn) -> Iterator[str]:
    """The address of a server whose clients get processes of their own, at most `sessions` at once."""
    with socket.create_server(("127.0.0.1", 0)) as listening:

        def admit() -> None:
            with contextlib.suppress(OSError):  # the context has closed the socket
                server.admit(listening, make, sessions, 20.0)

        thread = threading.Thread(target=admit, daemon=True)
        thread.start()
        yield "{}:{}".format(*listening.getsockname())
        listening.shutdown(socket.SHUT_RDWR)
        thread.join(20.0)
        assert not thread.is_alive()


def equal(left: Any, right: Any) -> None:
    """Fail unless both are the same, bit by bit."""
    assert type(left) is type(right)
    if isinstance(left, dict):
        assert list(left) == list(right)
        for name in left:
            equal(left[name], right[name])
    elif isinstance(left, np.ndarray):
        assert (left.dtype, left.shape, left.tobytes()) == (right.dtype, right.shape, right.tobytes())
    else:
        assert left == right
