"""`HazardRobot-v1` where hazard_ms cannot be installed: copy this file there. It needs numpy and gymnasium alone.

    python -m hazard_ms.lerobot.server             where hazard_ms is
    env = RemoteEnv(task="HazardFire-v1")          where this file is

The environment lives in the server, which the variable HAZARD_MS_SERVER names; both must be of the same VERSION.
A message is two lengths [bytes] of 4 bytes each, big-endian; JSON of the first length; and, of the second, the bytes of
the arrays in the order in which `{"array": [dtype, *shape]}` stands for them in the JSON. No byte of it is ever run.
As `env.py` in a repository of the Hugging Face Hub this file is all that LeRobot's EnvHub needs.
"""

from __future__ import annotations

import contextlib
import json
import math
import os
import socket
import struct
import time
from functools import partial
from typing import Any

import gymnasium as gym
import numpy as np
from gymnasium.vector import AsyncVectorEnv, AutoresetMode, SyncVectorEnv, VectorEnv
from numpy.typing import NDArray

PROTOCOL, VERSION = "hazard_ms", 1  # the version rises with every change of a message
SERVER = "127.0.0.1:47470"  # where a server listens unless told otherwise [ours]
LENGTHS = "!II"  # of JSON and of arrays [bytes]
MOST_JSON = 2**16  # [bytes] [ours]
MOST_BYTES = 2**24  # of arrays [bytes]: five pictures of 1024 x 1024 [ours]
MOST_AXES = 4  # of an array [ours]
ARRAY, DTYPES = "array", ("|u1", "<i4", "<i8", "<f4", "<f8")  # all little-endian
MESSAGE_SECONDS = 30.0  # from the first to the last byte of a message, at most [s] [ours]
PATIENCE = 300.0  # for an answer: an environment is made, or a scene is built [s] [ours]
FAREWELL = 10.0  # for the server to close its environment [s] [ours]
ENV_ID, SUITE = "HazardBridge-v1", "hazard"


def packed(value: Any) -> bytes:
    """The message that says `value`. Raises ValueError for what is neither plain nor an array, and for too much."""
    arrays: list[bytes] = []
    head = json.dumps(_plain(value, arrays)).encode()
    body = b"".join(arrays)
    _check(len(head), len(body))
    return struct.pack(LENGTHS, len(head), len(body)) + head + body


def send(link: socket.socket, message: bytes) -> None:
    """Send a message. Raises TimeoutError where the other side does not take it, ConnectionError where it has left."""
    link.settimeout(MESSAGE_SECONDS)
    link.sendall(message)


def receive(link: socket.socket, seconds: float) -> Any:
    """The next message, which must begin within `seconds` [s], and be there within MESSAGE_SECONDS then.

    Raises ValueError for bytes that are no message, TimeoutError, and ConnectionError where the other side has left.
    """
    lengths = bytearray(struct.calcsize(LENGTHS))
    _fill(link, memoryview(lengths), time.monotonic() + seconds)
    until = time.monotonic() + MESSAGE_SECONDS
    length, size = struct.unpack(LENGTHS, lengths)
    _check(length, size)
    head = bytearray(length)
    _fill(link, memoryview(head), until)
    value, arrays = _parsed(bytes(head), size)
    for array in arrays:
        _fill(link, array.reshape(-1).view(np.uint8).data, until)
    return value


def _plain(value: Any, arrays: list[bytes]) -> Any:
    """`value` as JSON has it; the bytes of its arrays are appended to `arrays`."""
    if isinstance(value, np.ndarray):
        data = value.astype(value.dtype.newbyteorder("<"), copy=False)
        if data.dtype.str not in DTYPES or data.ndim > MOST_AXES:
            raise ValueError(f"an array must be of {', '.join(DTYPES)}, got {value.dtype}, {value.shape}")
        arrays.append(data.tobytes())
        return {ARRAY: [data.dtype.str, *data.shape]}
    if isinstance(value, dict):
        if ARRAY in value or not all(isinstance(key, str) for key in value):
            raise ValueError(f"keys must be strings other than {ARRAY!r}, got {list(value)!r:.100}")
        return {key: _plain(entry, arrays) for key, entry in value.items()}
    if isinstance(value, (list, tuple)):
        return [_plain(entry, arrays) for entry in value]
    if isinstance(value, np.generic):
        return value.item()
    if value is None or isinstance(value, (bool, int, float, str)):
        return value
    raise ValueError(f"a message must hold plain values and arrays, got {value!r:.100}")


def _check(length: int, size: int) -> None:
    if length > MOST_JSON or size > MOST_BYTES:
        raise ValueError(f"a message must have at most {MOST_JSON} + {MOST_BYTES} bytes, got {length} + {size}")


def _fill(link: socket.socket, data: memoryview, until: float) -> None:
    """Receive all of `data` by the time `until`."""
    got = 0
    while got < len(data):
        link.settimeout(max(until - time.monotonic(), 1e-6))  # 0 would be another mode: not to wait at all
        try:
            more = link.recv_into(data[got:])
        except TimeoutError:
            raise TimeoutError(f"a message must arrive in time, got {got} of {len(data)} bytes") from None
        if not more:
            raise ConnectionError(f"the other side closed the connection after {got} of {len(data)} bytes of a message")
        got += more


def _parsed(head: bytes, size: int) -> tuple[Any, list[NDArray[Any]]]:
    """The value of a message whose arrays have `size` bytes, and these arrays, still to be filled."""
    arrays: list[NDArray[Any]] = []

    def placed(entry: dict[str, Any]) -> Any:
        if ARRAY not in entry:
            return entry
        arrays.append(_empty(entry[ARRAY], size - sum(made.nbytes for made in arrays)))
        return arrays[-1]

    try:
        value = json.loads(head.decode(), object_hook=placed)
    except (json.JSONDecodeError, UnicodeDecodeError, RecursionError) as error:
        raise ValueError(f"a message must begin with JSON, got {head[:40]!r}: {error}") from None
    if sum(made.nbytes for made in arrays) != size:
        raise ValueError(f"arrays of a message must fill {size} bytes, got {[made.shape for made in arrays]!r:.100}")
    return value, arrays


def _empty(form: Any, left: int) -> NDArray[Any]:
    """An array for at most `left` bytes, of the dtype and the shape in `form`."""
    dtype, shape = (form[0], form[1:]) if isinstance(form, list) and form else (None, [])
    whole = all(type(length) is int and 0 <= length <= MOST_BYTES for length in shape)
    if dtype not in DTYPES or len(shape) > MOST_AXES or not whole:
        raise ValueError(f"an array must be [dtype, *shape], of {', '.join(DTYPES)}, got {form!r:.100}")
    if math.prod(shape) * np.dtype(dtype).itemsize > left:
        raise ValueError(f"an array must have at most {left} bytes, the rest of its message, got {form!r:.100}")
    return np.empty(shape, dtype)


def _space(told: Any) -> gym.Space[Any]:
    """The space that a server describes: boxes, and dicts of them."""
    if "low" in told and isinstance(told["low"], np.ndarray):
        return gym.spaces.Box(told["low"], told["high"], told["low"].shape, told["low"].dtype.type)
    return gym.spaces.Dict({name: _space(entry) for name, entry in told.items()})


class RemoteEnv(gym.Env[dict[str, Any], NDArray[np.float32]]):
    """`HazardRobot-v1` in a server: the same spaces, observations, rewards and infos, bit by bit."""

    def __init__(self, *, server: str | None = None, patience: float = PATIENCE, **keywords: Any) -> None:
        """Have a server make an environment for this client alone.

        Args:
            server: HOST:PORT; None: that of the variable HAZARD_MS_SERVER, or SERVER.
            patience: Time that an answer may take [s].
            **keywords: Those of `HazardRobot-v1`: task, side, every, split, ...

        Raises:
            ValueError: For keywords that the server refuses, and for an address that is none.
            ConnectionError: Where no server answers.
        """
        address = os.environ.get("HAZARD_MS_SERVER", SERVER) if server is None else server
        host, _, port = address.rpartition(":")
        if not host or not port.isdecimal():
            raise ValueError(f"server must be HOST:PORT, got {address!r}")
        self._patience = patience
        try:
            self._link: socket.socket | None = socket.create_connection((host, int(port)), MESSAGE_SECONDS)
        except OSError as error:
            raise ConnectionError(f"hazard_ms.lerobot.server must listen at {address}: {error}") from None
        self._link.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        try:
            told = self._ask(protocol=PROTOCOL, version=VERSION, keywords=keywords)
            if told.get("version") != VERSION:
                raise ValueError(f"version must be {VERSION}, got {told.get('version')!r}: use the server's client")
        except BaseException:
            self._leave()
            raise
        self.render_mode = keywords.get("render_mode", "rgb_array")
        self.metadata = told["metadata"]
        self.observation_space, self.action_space = _space(told["observation_space"]), _space(told["action_space"])
        self._max_episode_steps = told["max_episode_steps"]
        self.task_description = self.task = told["task_description"]  # one sentence, which LeRobot knows by two names

    def reset(self, *, seed: int | None = None, options: dict[str, Any] | None = None) -> tuple[Any, dict[str, Any]]:
        """Start the episode of `seed`, as `HazardRobot-v1` does. Raises ValueError for what it refuses."""
        super().reset(seed=seed)
        told = self._ask(call="reset", seed=seed, options=options)
        return told["observation"], told["info"]

    def step(self, action: Any) -> tuple[Any, float, bool, bool, dict[str, Any]]:
        """Let a step pass with `action`, [A]. Raises ValueError for what the environment refuses."""
        told = self._ask(call="step", action=np.asarray(action, np.float32))
        return told["observation"], told["reward"], told["terminated"], told["truncated"], told["info"]

    def render(self) -> Any:
        """A picture of the scene in third person, [H, W, 3], uint8; None without a render mode."""
        return self._ask(call="render")["picture"]

    def close(self) -> None:
        """Let the server close the environment; a second time does nothing."""
        if self._link is not None:
            with contextlib.suppress(OSError, ValueError):  # it may have left already
                send(self._link, packed({"call": "close"}))
                receive(self._link, FAREWELL)
            self._leave()

    def _ask(self, **question: Any) -> dict[str, Any]:
        """The answer to a question. What breaks the connection off ends it, so that no answer comes one too late."""
        if self._link is None:
            raise ConnectionError("the connection must be open, got a closed one: make a new environment")
        message = packed(question)
        try:
            send(self._link, message)
            told = receive(self._link, self._patience)
            if not isinstance(told, dict):
                raise ValueError(f"an answer must be an object, got {told!r:.100}")
        except BaseException:
            self._leave()
            raise
        if "error" in told:
            known = told["kind"] == "ValueError"
            raise ValueError(told["error"]) if known else RuntimeError(f"{told['kind']}: {told['error']}")
        return told

    def _leave(self) -> None:
        if self._link is not None:
            self._link.close()
            self._link = None


gym.register(ENV_ID, RemoteEnv, order_enforce=False, disable_env_checker=True)


def make_env(
    n_envs: int = 1, use_async_envs: bool = False, cfg: Any = None, **keywords: Any
) -> dict[str, dict[int, VectorEnv]]:
    """`n_envs` environments side by side, as LeRobot's EnvHub wants them; keywords are those of RemoteEnv.

    Those in `cfg.gym_kwargs`, where `cfg` is a configuration of LeRobot's, give way to `keywords`.
    """
    made = [partial(RemoteEnv, **{**getattr(cfg, "gym_kwargs", {}), **keywords})] * n_envs
    if use_async_envs and n_envs > 1:
        return {SUITE: {0: AsyncVectorEnv(made, context="forkserver", autoreset_mode=AutoresetMode.SAME_STEP)}}
    return {SUITE: {0: SyncVectorEnv(made, autoreset_mode=AutoresetMode.SAME_STEP)}}
