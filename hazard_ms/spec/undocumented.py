"""Every name that we import from ManiSkill and SAPIEN and that they do not document: no other file imports one.

Each is imported once it is asked for, since ManiSkill takes seconds to import. docs/maniskill_internals.md says what
each is for, and which attributes with an underscore are used beside them.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from mani_skill.agents.controllers.base_controller import BaseController as BaseController
    from mani_skill.agents.controllers.base_controller import CombinedController as CombinedController
    from mani_skill.agents.registration import REGISTERED_AGENTS as REGISTERED_AGENTS
    from mani_skill.agents.registration import AgentSpec as AgentSpec
    from mani_skill.envs.utils.observations import parse_obs_mode_to_struct as parse_obs_mode_to_struct
    from mani_skill.envs.utils.system.backend import parse_sim_and_render_backend as parse_sim_and_render_backend
    from mani_skill.render import PREBUILT_SHADER_CONFIGS as PREBUILT_SHADER_CONFIGS
    from mani_skill.utils.registration import REGISTERED_ENVS as REGISTERED_ENVS
    from mani_skill.utils.registration import EnvSpec as EnvSpec
    from sapien.wrapper.urdf_exporter import export_kinematic_chain_xml as export_kinematic_chain_xml

MODULES = {  # name: where it is
    "BaseController": "mani_skill.agents.controllers.base_controller",
    "CombinedController": "mani_skill.agents.controllers.base_controller",
    "REGISTERED_AGENTS": "mani_skill.agents.registration",
    "AgentSpec": "mani_skill.agents.registration",
    "parse_obs_mode_to_struct": "mani_skill.envs.utils.observations",
    "parse_sim_and_render_backend": "mani_skill.envs.utils.system.backend",
    "PREBUILT_SHADER_CONFIGS": "mani_skill.render",
    "REGISTERED_ENVS": "mani_skill.utils.registration",
    "EnvSpec": "mani_skill.utils.registration",
    "export_kinematic_chain_xml": "sapien.wrapper.urdf_exporter",
}


def __getattr__(name: str) -> Any:
    """One of MODULES. Raises AttributeError for other names, ImportError where ManiSkill or SAPIEN has it no more."""
    if name not in MODULES:
        raise AttributeError(f"{__name__} has no {name!r}: it has {', '.join(MODULES)}")
    found = importlib.import_module(MODULES[name])
    if not hasattr(found, name):
        raise ImportError(f"{found.__name__} must have {name}, which hazard_ms needs: see docs/maniskill_internals.md")
    return getattr(found, name)
