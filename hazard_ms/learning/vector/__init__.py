"""Many environments at once behind gymnasium's interface of vector environments: `hazard_ms.vector.make`.

import hazard_ms

if __name__ == "__main__":  # processes that are started import the program again
    envs = hazard_ms.vector.make("HazardFire-v1", num_envs=8, obs_mode="state", render_backend="none")
"""

from hazard_ms.learning.vector.making import make, make_for_sb3
from hazard_ms.learning.vector.players import LostEnvironmentError

__all__ = ["LostEnvironmentError", "make", "make_for_sb3"]
