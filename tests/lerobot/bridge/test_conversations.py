"""Clients and servers of the bridge, with a stand-in for the simulator: all that can go wrong between them is told."""

from __future__ import annotations

import socket
import time
from collections.abc import Iterator
from multiprocessing.pool import ThreadPool
from typing import Any

import gymnasium as gym
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from hazard_ms.lerobot import hazard_client, server
from hazard_ms.lerobot.hazard_client import PROTOCOL, VERSION, RemoteEnv, packed, receive, send
from tests.lerobot.bridge.stand_in import StandIn, conversation, equal

HELLO = {"protocol": PROTOCOL, "version": VERSION, "keywords": {}}


@pytest.fixture(autouse=True)
def none_closed() -> Iterator[None]:
    StandIn.closed.clear()
    yield


def said_to(address: str, *messages: bytes) -> list[Any]:
    """The answers to these messages, the last one after a server has closed the connection."""
    host, _, port = address.rpartition(":")
    told = []
    with socket.create_connection((host, int(port)), 5.0) as link:
        for message in messages:
            link.sendall(message)
            told.append(receive(link, 10.0))
        with pytest.raises(ConnectionError):
            receive(link, 5.0)
    return told


def test_an_episode_is_the_same_as_without_a_bridge() -> None:
    alone = StandIn()
    with conversation() as address:
        env = RemoteEnv(server=address)
        assert env.observation_space == alone.observation_space and env.action_space == alone.action_space
        assert env.metadata == alone.metadata and env._max_episode_steps == 3 and env.render_mode == "rgb_array"
        assert env.task == env.task_description == "Stand in."
        told, here = env.reset(seed=5, options={"lerobot_new_rollout": True}), alone.reset(seed=5)
        assert told[1].pop("process") == here[1].pop("process")
        equal(dict(enumerate(told)), dict(enumerate(here)))
        for _ in range(3):
            action = np.array([0.1, -0.7], np.float32)
            equal(dict(enumerate(env.step(action))), dict(enumerate(alone.step(action))))
        equal(env.render(), alone.render())
        seen, kept = env.reset()[0], env.reset()[0]
        assert not np.shares_memory(seen["agent_pos"], kept["agent_pos"])
        env.close()
        env.close()
        with pytest.raises(ConnectionError, match="make a new environment"):
            env.reset()
    assert len(StandIn.closed) == 1


def test_gymnasium_finds_nothing_wrong_with_the_client() -> None:
    class Plain(StandIn):
        def reset(self, *, seed: int | None = None, options: Any = None) -> Any:
            return super().reset(seed=seed, options=options)[0], {}

        def seen(self) -> dict[str, Any]:
            found = super().seen()
            return {**found, "agent_pos": np.nan_to_num(found["agent_pos"])}

    with conversation(Plain) as address:
        env = gym.make("HazardBridge-v1", server=address)
        assert type(env) is RemoteEnv  # no wrapper: LeRobot looks for the task's sentence on what gym.make returns
        check_env(env, skip_render_check=True, skip_close_check=True)
        env.close()


def test_errors_of_the_environment_arrive_and_the_episode_goes_on() -> None:
    with conversation() as address:
        env = RemoteEnv(server=address, side=20)
        env.reset(seed=1)
        with pytest.raises(ValueError, match=r"action must fit, got \[9. 9.\]"):
            env.step([9, 9])
        with pytest.raises(RuntimeError, match="OSError: the disk is full"):
            env.step([-1.5, 0])
        with pytest.raises(ValueError, match="a message must hold plain values and arrays, got <object"):
            env.reset(options={"scene": object()})
        seen, *_ = env.step([0, 0])
        assert seen["pixels"]["head"].shape == (20, 20, 3) and seen["pixels"]["head"].max() == 1
        env.close()


@pytest.mark.parametrize(
    ("hello", "message"),
    [
        ({**HELLO, "version": 2}, "version must be 1, got 2"),
        ({**HELLO, "protocol": "other"}, "must name the protocol 'hazard_ms'"),
        ({"version": 1, "keywords": {}}, "must name the protocol"),
        ([1, 2], r"got \[1, 2\]"),
        ({**HELLO, "keywords": [1]}, r"keywords must be an object, got \[1\]"),
        ({**HELLO, "keywords": {"scenes": "/etc"}}, "a keyword must be one of task, .*, got 'scenes'"),
        ({**HELLO, "keywords": {"render_backend": "cuda"}}, "got 'render_backend'"),
        ({**HELLO, "keywords": {"task": "antigravity:HazardFire-v1"}}, "without a module, got 'antigravity:Haz"),
        ({**HELLO, "keywords": {"task": 3}}, "without a module, got 3"),
        (
            {**HELLO, "keywords": {"task": "HazardFier-v1"}},
            "task must be one of .*, got 'HazardFier-v1'",
        ),
    ],
)
def test_what_a_server_does_not_take_is_told_and_no_environment_stays(hello: Any, message: str) -> None:
    with conversation() as address:
        (told,) = said_to(address, packed(hello))
    with pytest.raises(ValueError, match=message):
        raise ValueError(told["error"])
    assert told["kind"] == "ValueError" and StandIn.closed == []


@pytest.mark.parametrize(
    ("bytes_", "message"),
    [
        (b"GET / HTTP/1.1\r\nHost: here\r\n\r\n", "at most 65536"),
        (b"\x00\x00\x00\x02\x00\x00\x00\x00{]" + b"x" * 50000, "must begin with JSON"),
    ],
)
@pytest.mark.parametrize("first", [True, False])
def test_garbage_ends_a_conversation_and_says_why(bytes_: bytes, message: str, first: bool) -> None:
    with conversation() as address:
        *_, told = said_to(address, *([] if first else [packed(HELLO)]), bytes_)
        assert message in told["error"]
    assert len(StandIn.closed) == (not first)


def test_unknown_calls_are_told_and_the_conversation_goes_on() -> None:
    with conversation() as address:
        about, *errors, bye = said_to(
            address, *map(packed, (HELLO, {"call": "dance"}, [3], {"call": "step"}, {"call": "close"}))
        )
    assert about["version"] == VERSION and bye == {}
    assert [told["kind"] for told in errors[:2]] == ["ValueError"] * 2
    assert "call must be one of reset, step, render, close, got 'dance'" in errors[0]["error"]
    assert "error" in errors[2]


def test_a_client_that_asks_for_nothing_loses_its_environment() -> None:
    with conversation(idle=0.2) as address:
        env = RemoteEnv(server=address)
        env.reset(seed=1)
        time.sleep(0.5)
        with pytest.raises((ConnectionError, RuntimeError)):
            env.step([0, 0])
        env.close()
    assert len(StandIn.closed) == 1


def test_a_client_that_vanishes_frees_its_environment() -> None:
    with conversation() as address:
        env = RemoteEnv(server=address)
        env.reset(seed=1)
        env._link.close()  # type: ignore[union-attr]
    assert len(StandIn.closed) == 1


def test_a_late_answer_is_not_taken_for_the_next_one() -> None:
    class Slow(StandIn):
        def step(self, action: Any) -> Any:
            time.sleep(0.6)
            return super().step(action)

    with conversation(Slow) as address:
        env = RemoteEnv(server=address, patience=0.3)
        env.reset(seed=1)
        with pytest.raises(TimeoutError, match="must arrive in time"):
            env.step([0, 0])
        time.sleep(0.5)  # the answer is there now
        with pytest.raises(ConnectionError, match="make a new environment"):
            env.reset(seed=2)


def test_a_client_that_says_nothing_is_not_waited_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(server, "HELLO_SECONDS", 0.2)
    with conversation() as address:
        host, _, port = address.rpartition(":")
        with socket.create_connection((host, int(port))) as link:
            assert "arrive in time" in receive(link, 5.0)["error"]


@pytest.mark.parametrize(
    ("answer", "error", "message"),
    [
        ({"version": 2}, ValueError, "version must be 1, got 2"),
        ({}, ValueError, "version must be 1, got None"),
        (3, ValueError, "an answer must be an object, got 3"),
        (None, TimeoutError, "must arrive in time, got 0 of 8 bytes"),
    ],
)
def test_a_client_believes_no_other_server(answer: Any, error: type[Exception], message: str) -> None:
    with socket.create_server(("127.0.0.1", 0)) as listening:
        port = listening.getsockname()[1]
        asking = ThreadPool(1).apply_async(RemoteEnv, kwds={"server": f"127.0.0.1:{port}", "patience": 0.5})
        link, _ = listening.accept()
        with link:
            if answer is not None:
                send(link, packed(answer))
            with pytest.raises(error, match=message):
                asking.get(10.0)


def test_addresses_where_nothing_listens_are_named(monkeypatch: pytest.MonkeyPatch) -> None:
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    monkeypatch.setenv("HAZARD_MS_SERVER", f"127.0.0.1:{port}")
    with pytest.raises(ConnectionError, match=rf"hazard_ms.lerobot.server must listen at 127.0.0.1:{port}"):
        RemoteEnv()
    for address in ("here", "here:", ":3", "here:port"):
        with pytest.raises(ValueError, match=f"server must be HOST:PORT, got '{address}'"):
            RemoteEnv(server=address)


def test_numbers_of_a_server_that_cannot_be_are_refused() -> None:
    for words, message in (
        ({"sessions": 0}, "sessions must be"),
        ({"port": 70000}, "port must be"),
        ({"idle": 0.0}, "idle must be more than 0 min, got 0.0"),
        ({"host": "192.0.2.1"}, "host must be an address of this machine and port must be free, got 192.0.2.1"),
    ):
        with pytest.raises(ValueError, match=message):
            server.serve(**words)  # type: ignore[arg-type]


def test_defaults_are_those_of_the_client() -> None:
    assert hazard_client.SERVER == f"{server.HOST}:{server.PORT}"
