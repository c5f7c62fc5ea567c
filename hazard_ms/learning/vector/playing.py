"""The part of a vector environment that runs in its processes: each plays some environments, one after another."""

from __future__ import annotations

import contextlib
import copy
import os
import signal
import sys
import traceback
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any, NamedTuple

import gymnasium as gym
from gymnasium.vector import AutoresetMode

from hazard_ms.learning.vector.board import NONE, Board
from hazard_ms.machine.processes import end_with_parent


@dataclass(frozen=True)
class Share:
    """The environments that one process plays, and how."""

    process: int  # its number
    numbers: range  # of its environments
    env_id: str
    keywords: Mapping[str, Any]  # of gym.make
    autoreset: AutoresetMode


class Spaces(NamedTuple):
    """The spaces of an environment: the answer of a process that has made its environments."""

    observation: gym.Space[Any]
    action: gym.Space[Any]
    metadata: dict[str, Any]
    render_mode: str | None


class Failure(NamedTuple):
    """The answer of a process in which an environment raised an error."""

    number: int  # of the environment
    error: BaseException
    trace: str


def single(env_id: str, keywords: Mapping[str, Any]) -> gym.Env[Any, Any]:
    """One environment as gymnasium defines it: unbatched numpy."""
    env: gym.Env[Any, Any] = gym.make(env_id, **keywords)
    simulator = sys.modules.get("mani_skill.envs.sapien_env")  # takes seconds to import, which others need not wait for
    if simulator is None or not isinstance(env.unwrapped, simulator.BaseEnv):
        return env
    from hazard_ms import NumpyEnv

    return NumpyEnv(env)


def serve(connection: Connection, share: Share) -> None:
    """Make the environments and play them, until nobody asks any more. Ctrl-C is for the process that started this."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    if share.process:
        os.environ["HAZARD_MS_QUIET"] = "1"  # the first process says what takes so long
    end_with_parent()
    with contextlib.suppress(EOFError, OSError):
        player = Player(share)
        _answer(connection, 0, player.make, player)
        while True:
            ticket, name, *details = connection.recv()
            _answer(connection, ticket, lambda: getattr(player, name)(*details), player)  # noqa: B023 called at once
    sys.stdout.flush()


def _answer(connection: Connection, ticket: int, work: Callable[[], Any], player: Player) -> None:
    try:
        made = work()
    except Exception as error:
        made = Failure(player.at, _portable(error), traceback.format_exc())
    player.go_to(NONE)
    try:
        connection.send((ticket, made))
    except OSError:
        raise
    except Exception as error:  # it cannot be sent
        connection.send((ticket, Failure(player.at, RuntimeError(str(error)), traceback.format_exc())))


def _portable(error: Exception) -> Exception:
    """The `error`, or one that says the same where it could not be made again in another process."""
    try:
        copy.copy(error)
    except Exception:
        return RuntimeError(f"{type(error).__name__}: {error}")
    return error


class Player:
    """The environments of a process. Each method is asked for by its name."""

    def __init__(self, share: Share) -> None:
        self._share, self._envs = share, list[gym.Env[Any, Any]]()
        self._board: Board | None = None
        self._over = [False] * len(share.numbers)
        self.at = share.numbers[0]  # environment that it was busy with last

    def go_to(self, number: int) -> None:
        """Note which environment this process is busy with."""
        if number != NONE:
            self.at = number
        if self._board is not None:
            self._board.busy[self._share.process] = number

    def make(self) -> Spaces:
        """Make all environments."""
        for number in self._share.numbers:
            self.go_to(number)
            self._envs.append(single(self._share.env_id, self._share.keywords))
        env = self._envs[0]
        return Spaces(env.observation_space, env.action_space, dict(env.metadata), env.render_mode)

    def share(self, path: Path, space: gym.Space[Any], num_envs: int, processes: int) -> None:
        """Write observations to the board in the file `path` from now on."""
        self._board = Board(path, space, num_envs, processes)

    def reset(self, wanted: list[tuple[int | None, dict[str, Any] | None] | None]) -> list[dict[str, Any] | None]:
        """Begin episodes with the seeds and options that are `wanted`, None where an episode goes on: the infos."""
        return [self._reset(k, *asked) if asked is not None else None for k, asked in enumerate(wanted)]

    def step(self, actions: Any) -> list[tuple[float, bool, bool, dict[str, Any]]]:
        """Step all environments: reward, whether the episode is terminated, or truncated, and info of each."""
        return [self._step(k, action) for k, action in enumerate(actions)]

    def call(self, wanted: list[tuple[str, tuple[Any, ...], dict[str, Any]] | None]) -> list[Any]:
        """The values of attributes, or of methods with their arguments; None where nothing is `wanted`."""
        return [None if asked is None else self._call(k, *asked) for k, asked in enumerate(wanted)]

    def _reset(self, k: int, seed: int | None, options: dict[str, Any] | None) -> dict[str, Any]:
        self.go_to(self._share.numbers[k])
        obs, info = self._envs[k].reset(seed=seed, options=options)
        self._over[k] = False
        self._write(k, obs)
        return info

    def _step(self, k: int, action: Any) -> tuple[float, bool, bool, dict[str, Any]]:
        if self._over[k] and self._share.autoreset == AutoresetMode.NEXT_STEP:
            return 0.0, False, False, self._reset(k, None, None)
        self.go_to(self._share.numbers[k])
        obs, reward, terminated, truncated, info = self._envs[k].step(action)
        self._over[k] = terminated or truncated
        if self._over[k] and self._share.autoreset == AutoresetMode.SAME_STEP:
            info = {"final_obs": obs, "final_info": info, **self._reset(k, None, None)}
        else:
            self._write(k, obs)
        return float(reward), terminated, truncated, info

    def _call(self, k: int, name: str, args: tuple[Any, ...], keywords: dict[str, Any]) -> Any:
        self.go_to(self._share.numbers[k])
        found = self._envs[k].get_wrapper_attr(name)
        return found(*args, **keywords) if callable(found) else found

    def _write(self, k: int, obs: Any) -> None:
        assert self._board is not None
        self._board.write(self._share.numbers[k], obs)
