"""How hazards look. Pictures only: nothing here changes physics, chance or labels."""

from hazard_ms.effects.fire_effects import FireEffects
from hazard_ms.effects.shader_pack import shader_config

__all__ = ["FireEffects", "shader_config"]
