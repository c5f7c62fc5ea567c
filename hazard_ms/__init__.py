"""hazard_ms: fire, flood and wind rescue tasks for ManiSkill and SAPIEN.

Importing registers the environments with gymnasium, now or as soon as gymnasium is imported, and loads nothing heavy:

    import gymnasium as gym, hazard_ms
    env = gym.make("HazardFire-v1")
"""

from __future__ import annotations

import importlib.util
import sys
from collections.abc import Sequence
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any

__version__ = "0.1.0"

MAX_FRAMES = {  # frames of an episode (benchmark.md 1)
    "HazardFire-v1": 1500,
    "HazardFlood-v1": 1500,
    "HazardWind-v1": 3000,
    "HazardCompound-v1": 1500,
}


def register() -> None:
    """Make the environments known to gymnasium."""
    import gymnasium
    from gymnasium.envs.registration import WrapperSpec

    for name, frames in MAX_FRAMES.items():
        if name not in gymnasium.registry:
            gymnasium.register(
                id=name,
                entry_point="hazard_ms.env:HazardEnv",
                max_episode_steps=frames,
                disable_env_checker=True,  # it is written for unbatched numpy: see hazard_ms.wrappers.NumpyEnv
                kwargs={"task": name},
                additional_wrappers=(WrapperSpec("TimeLimit", "hazard_ms.wrappers:TimeLimit", kwargs={}),),
            )


class _AfterGymnasium(MetaPathFinder):
    """Registers once gymnasium has been imported: loading it here would cost every `import hazard_ms` half a second."""

    def find_spec(self, name: str, path: Sequence[str] | None, target: ModuleType | None = None) -> ModuleSpec | None:
        if name != "gymnasium":
            return None
        sys.meta_path.remove(self)
        spec = importlib.util.find_spec(name)
        if spec is not None and spec.loader is not None:
            loader: Any = spec.loader
            load = loader.exec_module

            def load_and_register(module: ModuleType) -> None:
                load(module)
                register()

            loader.exec_module = load_and_register
        return spec


if "gymnasium" in sys.modules:
    register()
else:
    sys.meta_path.insert(0, _AfterGymnasium())
