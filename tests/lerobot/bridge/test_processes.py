"""Clients of the bridge that play at once, each with a process of the server, in which a stand-in is simulated."""

from __future__ import annotations

import os
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from hazard_ms.lerobot.hazard_client import RemoteEnv, make_env
from tests.lerobot.bridge.stand_in import StandIn, admitting, equal


def test_two_clients_at_once_have_processes_of_their_own_and_a_third_is_refused() -> None:
    with admitting(2) as address:
        first, second = RemoteEnv(server=address), RemoteEnv(server=address)
        processes = [env.reset(seed=number)[1]["process"] for number, env in enumerate((first, second))]
        alone = StandIn()
        alone.reset(seed=0)
        for _ in range(2):
            equal(first.step([0.1, 0.1])[0], alone.step(np.float32([0.1, 0.1]))[0])
            second.step([0.0, -0.5])
        assert len({*processes, os.getpid()}) == 3
        with pytest.raises(RuntimeError, match="at most 2 clients can connect at once"):
            RemoteEnv(server=address)
        second._link.close()  # type: ignore[union-attr]  # a client that is killed
        third = RemoteEnv(server=address)
        assert third.reset(seed=0)[1]["process"] not in processes
        equal(first.step([0.1, 0.1])[0], alone.step(np.float32([0.1, 0.1]))[0])
        first.close()
        third.close()


@pytest.mark.parametrize("asynchronous", [False, True])
def test_vectors_of_clients(asynchronous: bool) -> None:
    """As LeRobot's EnvHub makes them; those in processes first make an environment that only tells its spaces."""
    with admitting(2 + asynchronous) as address:
        cfg = SimpleNamespace(gym_kwargs={"server": "nowhere", "side": 20})
        made = make_env(2, asynchronous, cfg=cfg, server=address)
        assert list(made) == ["hazard"] and list(made["hazard"]) == [0]
        vector: Any = made["hazard"][0]
        seen, _ = vector.reset(seed=[5, 6])
        for number in (0, 1):
            alone, _ = StandIn(side=20).reset(seed=5 + number)
            equal(seen["agent_pos"][number], alone["agent_pos"])
        assert vector.call("task_description") == ("Stand in.",) * 2 and vector.call("_max_episode_steps") == (3, 3)
        for _ in range(3):
            _, _, ended, _, info = vector.step(np.zeros((2, 2), np.float32))
        assert ended.all() and info["final_info"]["is_success"].tolist() == [True, True]
        vector.close()
