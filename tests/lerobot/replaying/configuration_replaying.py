"""What `--policy.type=replaying` takes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from lerobot.configs.policies import PreTrainedConfig


@PreTrainedConfig.register_subclass("replaying")
@dataclass
class ReplayingConfig(PreTrainedConfig):
    data: str = ""  # folder of the dataset

    observation_delta_indices: Any = None
    action_delta_indices: Any = None
    reward_delta_indices: Any = None

    def get_optimizer_preset(self) -> Any:
        raise NotImplementedError

    def get_scheduler_preset(self) -> Any:
        return None

    def validate_features(self) -> None:
        """It reads what it is given."""
