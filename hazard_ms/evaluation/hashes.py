"""The chain of hashes of an episode: two runs with the same chain were the same episode; else it shows where they part.

Each link is the SHA-256 of the link before it, the frame, and the state of everything: poses of all bodies and of all
robots, and all records of the episode (hazards, damage, rescues, the hand). Numbers are rounded to steps of `GRAIN`,
so that the last bits, which differ between processors, rarely matter.
"""

from __future__ import annotations

import hashlib
from itertools import chain

import numpy as np
from torch import Tensor

from hazard_ms.evaluation.result import Link
from hazard_ms.skills.executor import SkillEnv
from hazard_ms.skills.team import TeamSkills

EVERY = 50  # frames from one link to the next [ours]
GRAIN = 1e-4  # to which numbers are rounded, in their own units: [m], [-], [rad], [°C], [m/s] [ours]


def extended(links: list[Link], env: SkillEnv | TeamSkills) -> None:
    """Add the link of the present frame to `links`, unless it is there."""
    if not links or links[-1].frame != env.frame:
        links.append(Link(env.frame, _hash(env, links[-1].sha256 if links else "")))


def _hash(env: SkillEnv | TeamSkills, before: str) -> str:
    base = env.base
    world, made = base.world, hashlib.sha256(f"{before} {env.frame}".encode())
    every = zip(base.members, base.robots.values(), strict=True)
    robots = [(m.world.agent_position, m.world.agent_heading, robot.robot.get_qpos()) for m, robot in every]
    for values in (world.position, world.rotation, *chain(*robots)):
        made.update(_rounded(values))
    for name, part in sorted(base.episode.parts.items()):
        for quantity, values in sorted(part.save().items()):
            made.update(f"{name}.{quantity}".encode())
            made.update(_rounded(values))
    return made.hexdigest()


def _rounded(values: Tensor) -> bytes:
    """The bytes of a tensor of any shape, its numbers as multiples of `GRAIN`."""
    array = values.detach().cpu().numpy()
    if array.dtype.kind == "f":
        array = np.nan_to_num(np.rint(array.astype(np.float64) / GRAIN)) + 0.0  # no -0
    return array.tobytes()
