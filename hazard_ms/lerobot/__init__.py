"""Our tasks for LeRobot, whose tools find them here by themselves.

    lerobot-eval --env.discover_packages_path=hazard_ms.lerobot --env.type=hazard --env.task=HazardFire-v1 ...

Importing it registers `HazardRobot-v1`: any of our tasks, in which a policy drives the robot from pictures and joints.
LeRobot itself is needed by `hazard_ms.lerobot.config` alone.
"""

from __future__ import annotations

from gymnasium import register

ENV_ID = "HazardRobot-v1"

# without wrappers: LeRobot asks the environment itself for its task, and gymnasium's wrappers do not pass that on
register(ENV_ID, "hazard_ms.lerobot.environment:RobotEnv", order_enforce=False, disable_env_checker=True)
