"""Serves `HazardRobot-v1` to other environments of Python, where hazard_client.py gives the same environment.

    python -m hazard_ms.lerobot.server --sessions 2

Each client gets an environment in a process of its own, which ends when the client leaves. There is no password:
whoever can reach the port can have episodes played, and nothing else. Clients name neither files nor modules.
"""

from __future__ import annotations

import contextlib
import importlib
import multiprocessing
import signal
import socket
import sys
import traceback
from collections.abc import Callable
from functools import partial
from multiprocessing.connection import wait
from typing import Any

import gymnasium as gym

from hazard_ms.lerobot.hazard_client import PROTOCOL, SERVER, VERSION, packed, receive, send
from hazard_ms.spec.checks import one_of, whole

HOST, PORT = SERVER.split(":")[0], int(SERVER.split(":")[1])
SESSIONS = 4  # environments at once, each a process of 1 to 2 GB [ours]
MOST_SESSIONS = 1024  # any larger number must be a mistake [ours]
IDLE_MINUTES = 60.0  # after which a client that asks for nothing loses its environment [min] [ours]
HELLO_SECONDS = 10.0  # for a client to say what it wants [s] [ours]
GRACE_SECONDS = 5.0  # in which an environment that is being closed makes room for another one [s] [ours]
LINGER_SECONDS = 1.0  # for a client to read why it is refused [s] [ours]
MOST_LEFT = 2**16  # of what it has sent, which is read and dropped meanwhile [bytes] [ours]
KEYWORDS = (  # of HazardRobot-v1 that clients give; none of them names a file, a module, or a device
    *("task", "side", "every", "render_mode", "robot_uids", "control_mode", "max_frames", "split", "physics"),
    *(
        "severity",
        "hazards",
        "affects_agent",
        "deterministic",
        "scene_every",
        "effects",
        "lighting",
        "cameras",
        "perturb",
    ),
)
CALLS = ("reset", "step", "render", "close")
Make = Callable[..., gym.Env[Any, Any]]


def robot_env(load: tuple[str, ...] = (), **keywords: Any) -> gym.Env[Any, Any]:
    """`HazardRobot-v1` with these keywords, after the modules `load` have registered what they bring."""
    from hazard_ms.lerobot.environment import RobotEnv  # loads the simulator, which takes seconds

    for name in load:
        importlib.import_module(name)
    return RobotEnv(**keywords)


def converse(link: socket.socket, make: Make, idle: float) -> None:
    """Play with one client until it leaves, or asks for nothing for `idle` seconds [s]; it is told what goes wrong.

    `make` makes the environment from the keywords of the client.
    """
    with link:
        try:
            env = make(**_wanted(receive(link, HELLO_SECONDS)))
            try:
                send(link, packed({"version": VERSION, **_about(env)}))
                while (answer := _answer(env, receive(link, idle))) is not None:
                    send(link, answer)
            finally:
                env.close()
            send(link, packed({}))
        except ConnectionError:
            pass  # the client has left
        except Exception as error:  # whatever an environment raises, the client has to know
            _refuse(link, error)


def serve(
    host: str = HOST,
    port: int = PORT,
    sessions: int = SESSIONS,
    idle: float = IDLE_MINUTES,
    scenes: tuple[str, ...] = (),
    load: tuple[str, ...] = (),
) -> None:
    """Serve HazardRobot-v1 until the process is interrupted.

    Args:
        host: Address to listen at; the default is for this machine alone.
        port: Port there; 0: any that is free.
        sessions: Clients at once, at most: each is a process of 1 to 2 GB.
        idle: Time after which a client that asks for nothing loses its environment [min].
        scenes: Files or folders of scenes, in place of those of a split.
        load: Modules that register tasks of your own.

    Raises:
        ValueError: For numbers and addresses that are not allowed.
    """
    whole(sessions, 1, MOST_SESSIONS, "sessions")
    whole(port, 0, 2**16 - 1, "port")
    if not 0.0 < idle < float("inf"):
        raise ValueError(f"idle must be more than 0 min, got {idle}")
    given: dict[str, Any] = {"scenes": list(scenes)} if scenes else {}
    try:
        listening = socket.create_server((host, port))
    except OSError as error:
        raise ValueError(
            f"host must be an address of this machine and port must be free, got {host}:{port}: {error}"
        ) from None
    with listening, contextlib.suppress(KeyboardInterrupt):
        signal.signal(signal.SIGTERM, signal.default_int_handler)
        print("{}:{}".format(*listening.getsockname()), flush=True)
        admit(listening, partial(robot_env, load=load, **given), sessions, idle * 60.0)


def admit(listening: socket.socket, make: Make, sessions: int, idle: float) -> None:
    """Give each client that connects a process, at most `sessions` at once; see `converse`. It does not return."""
    playing: list[multiprocessing.process.BaseProcess] = []
    while True:
        link, _ = listening.accept()
        playing = [process for process in playing if process.is_alive()]
        if len(playing) >= sessions:
            ended = wait([process.sentinel for process in playing], GRACE_SECONDS)
            for process in playing:
                if process.sentinel in ended:
                    process.join()  # what it held is closed, but it may still count as alive for a moment
            playing = [process for process in playing if process.is_alive()]
        if len(playing) >= sessions:
            with link:
                _refuse(link, RuntimeError(f"at most {sessions} clients can connect at once (see --sessions)"))
            continue
        process = multiprocessing.get_context("spawn").Process(target=_session, args=(link, make, idle), daemon=True)
        with link:  # the process has a copy of its own
            process.start()
        playing.append(process)


def _session(link: socket.socket, make: Make, idle: float) -> None:
    """The life of one process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the server ends it
    link.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    converse(link, make, idle)


def _wanted(hello: Any) -> dict[str, Any]:
    """The keywords of a client's first message."""
    if not isinstance(hello, dict) or hello.get("protocol") != PROTOCOL:
        raise ValueError(f"the first message must name the protocol {PROTOCOL!r}, got {hello!r:.100}")
    if hello.get("version") != VERSION:
        raise ValueError(f"version must be {VERSION}, got {hello.get('version')!r}: use the server's hazard_client.py")
    keywords = hello.get("keywords")
    if not isinstance(keywords, dict):
        raise ValueError(f"keywords must be an object, got {keywords!r:.100}")
    for name in keywords:
        one_of(name, KEYWORDS, "a keyword", shown=len(KEYWORDS))
    task = keywords.get("task", "")
    if not isinstance(task, str) or ":" in task:  # gymnasium would import what stands before it
        raise ValueError(f"task must be a name without a module, got {task!r:.100}: see --load of the server")
    return keywords


def _about(env: gym.Env[Any, Any]) -> dict[str, Any]:
    """All that a client must know of its environment."""
    names = {"max_episode_steps": "_max_episode_steps", "task_description": "task_description"}
    told = {name: env.get_wrapper_attr(attribute) for name, attribute in names.items()}
    spaces = {name: _described(getattr(env, name)) for name in ("observation_space", "action_space")}
    return {**told, **spaces, "metadata": env.metadata}


def _described(space: gym.Space[Any]) -> dict[str, Any]:
    """A box, or a dict of them, as plain values and arrays."""
    if isinstance(space, gym.spaces.Dict):
        return {name: _described(entry) for name, entry in space.items()}
    assert isinstance(space, gym.spaces.Box)
    return {"low": space.low, "high": space.high}


def _answer(env: gym.Env[Any, Any], question: Any) -> bytes | None:
    """The answer to a question, which may be an error; None where the client takes its leave."""
    try:
        asked = question if isinstance(question, dict) else {}
        call = one_of(asked.get("call"), CALLS, "call")
        if call == "close":
            return None
        if call == "render":
            return packed({"picture": env.render()})
        if call == "reset":
            seen, info = env.reset(seed=asked.get("seed"), options=asked.get("options"))
            return packed({"observation": seen, "info": info})
        seen, reward, terminated, truncated, info = env.step(asked.get("action"))
        ended = {"terminated": terminated, "truncated": truncated}
        return packed({"observation": seen, "reward": reward, **ended, "info": info})
    except Exception as error:  # as above
        return _told(error)


def _told(error: Exception) -> bytes:
    """The message that tells a client of an error; others than bad input are printed here, too."""
    if not isinstance(error, (ValueError, TimeoutError, gym.error.Error)):
        traceback.print_exception(error, file=sys.stderr)
    return packed({"error": str(error)[:1000], "kind": type(error).__name__})


def _refuse(link: socket.socket, error: Exception) -> None:
    """Tell a client why it is left, and let it read that: what it still sends would have it reset otherwise."""
    with contextlib.suppress(OSError):
        send(link, _told(error))
        link.shutdown(socket.SHUT_WR)
        link.settimeout(LINGER_SECONDS)
        left = MOST_LEFT
        while left > 0 and (more := link.recv(left)):
            left -= len(more)


if __name__ == "__main__":
    import tyro

    tyro.cli(serve)
