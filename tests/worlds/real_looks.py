"""Looks of a robot's head camera in real scenes, with what it truly saw: what a model of sight is measured against."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from hazard_ms.skills.decision import EXPLORE, WALK_TO, Action
from hazard_ms.skills.executor import SkillEnv

PLACES = 2  # from which a robot looks around in a scene: its start, and beside a thing


@dataclass(frozen=True)
class Look:
    """One look in a scene: from where, and how many pixels of each of B things were in it."""

    scene: str
    base: tuple[float, float, float]  # place [m] and heading [rad]
    eye: NDArray[np.float64]  # pose of the camera, [4, 4]
    position: NDArray[np.float64]  # middles of the things' boxes [m], [B, 3]
    pixels: NDArray[np.int64]  # [B]
    here: NDArray[np.bool_]  # neither in the hand nor away, [B]


class Watched(SkillEnv):
    """An environment of skills that keeps its looks."""

    looks: list[Look]

    def look(self) -> None:
        """Look, and keep it."""
        super().look()
        world, base = self.base.world, self.base
        count = len(world.names[0])
        assert self._images is not None and self._images.segmentation is not None
        labels = self._images.segmentation
        self.looks.append(
            Look(
                scene=base.specs[0].name,
                base=base.agent.base(),
                eye=base.observer.camera.get_params()["cam2world_gl"][0].cpu().numpy().astype(np.float64),
                position=world.position[0, :count].cpu().numpy().astype(np.float64),
                pixels=np.bincount(labels[labels >= 0], minlength=count)[:count],
                here=~(world.held[0] | world.away[0])[:count].cpu().numpy(),
            )
        )


def real_looks(task: str, scenes: list[str], robot: str = "fetch", split: str = "test", seed: int = 0) -> list[Look]:
    """All looks of a robot that looks around at its start and beside a thing that it walks to, in each scene."""
    rng = np.random.default_rng(seed)
    skills = Watched.make(task, effects="off", reward_mode="none", robot_uids=robot, split=split)
    skills.looks = []
    try:
        for name in scenes:
            decision, _ = skills.reset(seed=seed, options={"scene": name})
            decision, *_ = skills.step(Action(EXPLORE))
            for _ in range(PLACES - 1):
                goal = decision.names[rng.choice(sorted(decision.map.objects))]
                decision, *_ = skills.step(Action(WALK_TO, goal))
                decision, *_ = skills.step(Action(EXPLORE))
    finally:
        skills.close()
    return skills.looks
