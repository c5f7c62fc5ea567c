"""Put this file into a repository of the Hugging Face Hub, and LeRobot's EnvHub makes our tasks from it:

from lerobot.envs.factory import make_env
envs = make_env("you/hazard", n_envs=2, trust_remote_code=True)
"""

from hazard_ms.lerobot.hub import make_env

__all__ = ["make_env"]
