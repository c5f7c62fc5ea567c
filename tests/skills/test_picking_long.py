"""A robot that stands next to a target picks it up: at least four of five, in every kind of place, with every robot.

In streets the air is still: what the wind carries away from a robot says nothing about its arm.
"""

from __future__ import annotations

import dataclasses
import math
from pathlib import Path

import gymnasium as gym
import numpy as np
import pytest
import torch

import hazard_ms  # noqa: F401 registers the environments
from hazard_ms.scenes import splits
from hazard_ms.scenes.floor import connected, free_floor
from hazard_ms.scenes.schema import to_json
from hazard_ms.skills.decision import EXPLORE, PICK_UP, Action
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.spec.registry import ROBOTS

pytestmark = [pytest.mark.long, pytest.mark.render]

SHARE = 0.8  # of the reachable targets, at least
SCENES = 4  # of each place
STEP = 0.05  # edge of a cell of the free floor [m]
BESIDE = (0.45, 0.85)  # how far from a target a robot stands, middle to middle [m]
PLACES = {
    "HazardFire-v1": ("kitchen_a", "living_room_a", "craft_room_a", "kitchen_b"),
    "HazardWind-v1": ("street", "parking"),
}
CASES = [(env_id, place) for env_id, places in PLACES.items() for place in places]


def standpoint(name: str, target: tuple[float, float]) -> tuple[float, float] | None:
    """A place of the connected free floor next to `target` [m], not so near as to touch it; None if there is none."""
    spec = splits.scene(name)
    cells = (np.argwhere(connected(free_floor(spec, 0.3), spec.agent_start.position)) + 0.5) * STEP
    far = np.hypot(*(cells - target).T)
    able = cells[(far >= BESIDE[0]) & (far <= BESIDE[1])]
    if len(able) == 0:
        return None
    best = able[np.argmin(np.abs(np.hypot(*(able - target).T) - 0.65))]
    return float(best[0]), float(best[1])


@pytest.mark.parametrize("robot", list(ROBOTS))
@pytest.mark.parametrize(("env_id", "place"), CASES)
def test_four_of_five_targets_can_be_picked_from_next_to_them(
    env_id: str, place: str, robot: str, tmp_path: Path
) -> None:
    names = [f"{place}/{number:02d}" for number in range(SCENES)]
    for name in names:
        calm = dataclasses.replace(splits.scene(name), name=f"calm/{name}", wind=(0.01, 0.0))
        (tmp_path / f"{name[-2:]}.json").write_text(to_json(calm))
    made = gym.make(env_id, obs_mode="none", robot_uids=robot, control_mode="pd_joint_pos", scenes=str(tmp_path))
    env = SkillEnv(made)
    tried, failed = 0, []
    for number, name in enumerate(names):
        for body in splits.scene(name).targets:
            spot = standpoint(name, body.position[:2])
            if spot is None:
                continue
            env.reset(seed=number, options={"scene": f"calm/{name}"})
            heading = math.atan2(body.position[1] - spot[1], body.position[0] - spot[0])
            base = env.base
            base.agent.place(torch.tensor([0]), torch.tensor([spot]), torch.tensor([heading]))
            base.world.read()
            base.episode.see(base.agent)
            env.look()
            if base.world.index(0, body.name) not in env.seen.objects:
                env.step(Action(EXPLORE))
            _, _, _, _, info = env.step(Action(PICK_UP, body.name))
            tried += 1
            if not info["result"].ok:
                failed.append((name, body.name, round(body.position[2], 2), info["result"].reason))
    made.close()
    print(f"\n{robot} in {place}: picked {tried - len(failed)} of {tried}; not: {failed}")
    assert tried >= 5 * SCENES and len(failed) <= (1.0 - SHARE) * tried, failed
