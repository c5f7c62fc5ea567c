"""The environment type `hazard_bridge` of LeRobot: our tasks where LeRobot and hazard_ms cannot be installed together.

Copy this file and hazard_ms/lerobot/hazard_client.py into a folder of LeRobot's side, and start a server on ours:

    python -m hazard_ms.lerobot.server --sessions 2
    PYTHONPATH=FOLDER lerobot-eval --env.discover_packages_path=hazard_lerobot --env.type=hazard_bridge ...

Actions, states and pictures are those of hazard_ms.lerobot, so that policies fit both.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

import hazard_client
from lerobot.configs.types import FeatureType, PolicyFeature
from lerobot.envs.configs import EnvConfig

__path__: list[str] = []  # LeRobot takes packages alone, and looks for modules in them: there are none
SIZES = {"fetch": (37, 13), "g1": (79, 17)}  # numbers of a state and of an action
FRAMES = 30  # of a second
ACTION, STATE, PICTURES = "action", "observation.state", "observation.images"  # as LeRobot names them


@EnvConfig.register_subclass("hazard_bridge")
@dataclass
class BridgeConfig(EnvConfig):
    """Settings, each of them an option of LeRobot's commands: `--env.task=HazardFlood-v1`."""

    task: str | None = "HazardFire-v1"
    fps: int = FRAMES  # steps of a second: those of demonstrations; fewer mean that an action lasts longer
    server: str = hazard_client.SERVER
    robot: str = "fetch"
    split: str = "test"
    side: int = 256  # of pictures [pixels]
    cameras: list[str] = field(default_factory=list)  # of the robot, beside that of its head
    keywords: dict[str, Any] = field(default_factory=dict)  # others of HazardRobot-v1
    features: dict[str, PolicyFeature] = field(default_factory=dict)
    features_map: dict[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        if self.fps < 1 or FRAMES % self.fps:
            raise ValueError(f"fps must be a divisor of {FRAMES}, got {self.fps}")
        if self.robot not in SIZES:
            raise ValueError(f"robot must be one of {', '.join(SIZES)}, got {self.robot!r}")
        state, action = SIZES[self.robot]
        seen = ("head", *self.cameras)
        self.features = {
            **{f"pixels/{name}": PolicyFeature(FeatureType.VISUAL, (self.side, self.side, 3)) for name in seen},
            "agent_pos": PolicyFeature(FeatureType.STATE, (state,)),
            ACTION: PolicyFeature(FeatureType.ACTION, (action,)),
        }
        self.features_map = {f"pixels/{name}": f"{PICTURES}.{name}" for name in seen}
        self.features_map |= {"agent_pos": STATE, ACTION: ACTION}

    @property
    def package_name(self) -> str:
        return hazard_client.__name__

    @property
    def gym_id(self) -> str:
        return hazard_client.ENV_ID

    @property
    def gym_kwargs(self) -> dict[str, Any]:
        asked = {"server": self.server, "task": self.task, "every": FRAMES // self.fps, "side": self.side}
        return {**asked, "robot_uids": self.robot, "split": self.split, "cameras": self.cameras, **self.keywords}
