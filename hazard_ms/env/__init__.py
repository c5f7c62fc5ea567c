"""The one environment class, which puts a task's scenes, hazards, robot and senses into ManiSkill's loop."""

from hazard_ms.env.memory import lasting
from hazard_ms.spec.progress import slow

with slow("loading PyTorch, SAPIEN and ManiSkill"), lasting():
    from hazard_ms.env.hazard_env import HazardEnv

__all__ = ["HazardEnv"]
