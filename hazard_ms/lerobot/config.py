"""The environment type `hazard` of LeRobot. It needs lerobot, 0.4.4 or later."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from lerobot.configs.types import FeatureType, PolicyFeature
from lerobot.envs.configs import EnvConfig

from hazard_ms.lerobot import ENV_ID
from hazard_ms.lerobot.sizes import ACTIONS, STATES, frames_of
from hazard_ms.spec.checks import one_of

ACTION, STATE, PICTURES = "action", "observation.state", "observation.images"  # as LeRobot names them


@EnvConfig.register_subclass("hazard")
@dataclass
class HazardConfig(EnvConfig):
    """Settings of `HazardRobot-v1`, each of them an option of LeRobot's commands: `--env.task=HazardFlood-v1`."""

    task: str | None = "HazardFire-v1"
    fps: int = 30  # steps of a second: those of demonstrations; fewer mean that an action lasts longer
    episode_length: int | None = None  # in steps; None: as long as the task's
    robot: str = "fetch"
    split: str = "test"
    scenes: list[str] | None = None  # files or folders of scenes in place of a split
    physics: str = "paper"
    perturb: str = ""  # what differs from training: "lighting:2,camera:1"
    side: int = 256  # of pictures [pixels]
    cameras: list[str] = field(default_factory=list)  # of the robot, beside that of its head
    keywords: dict[str, Any] = field(default_factory=dict)  # others of gym.make
    features: dict[str, PolicyFeature] = field(default_factory=dict)
    features_map: dict[str, str] = field(default_factory=dict)

    def __post_init__(self) -> None:
        """Say what policies see and do. Raises ValueError for an unknown robot, and for a rate that is none."""
        one_of(self.robot, STATES, "robot")
        frames_of(self.fps, self.physics)
        seen = ("head", *self.cameras)
        self.features = {
            **{f"pixels/{name}": PolicyFeature(FeatureType.VISUAL, (self.side, self.side, 3)) for name in seen},
            "agent_pos": PolicyFeature(FeatureType.STATE, (STATES[self.robot],)),
            ACTION: PolicyFeature(FeatureType.ACTION, (ACTIONS[self.robot],)),
        }
        self.features_map = {f"pixels/{name}": f"{PICTURES}.{name}" for name in seen}
        self.features_map |= {"agent_pos": STATE, ACTION: ACTION}

    @property
    def package_name(self) -> str:
        """The package that registers the environment."""
        return "hazard_ms.lerobot"

    @property
    def gym_id(self) -> str:
        """The name of the environment in gymnasium's register."""
        return ENV_ID

    @property
    def gym_kwargs(self) -> dict[str, Any]:
        """Keywords of gym.make."""
        every = frames_of(self.fps, self.physics)
        made: dict[str, Any] = {"task": self.task, "every": every, "side": self.side}
        made |= {"robot_uids": self.robot, "physics": self.physics, "cameras": self.cameras}
        made |= {"perturb": self.perturb} if self.perturb else {}
        made |= {"split": self.split} if self.scenes is None else {"scenes": self.scenes}
        if self.episode_length is not None:
            made["max_frames"] = self.episode_length * every
        return {**made, **self.keywords}
