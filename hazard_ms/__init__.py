"""Fire, flood and wind rescue tasks for ManiSkill and SAPIEN.

Importing registers the environments with gymnasium and ManiSkill, now or as soon as these are imported, and loads
nothing heavy:

    import gymnasium as gym, hazard_ms
    env = gym.make("HazardFire-v1")

Third parties add tasks, hazards, robots, agents, detectors and mitigations with `register_task`, `register_hazard`,
`register_robot`, `register_agent`, `register_detector` and `register_mitigation`; see `hazard_ms.spec.registry`.
"""

from __future__ import annotations

import importlib
from typing import Any

from hazard_ms.spec.registry import load, register_agent, register_hazard, register_robot, register_task
from hazard_ms.spec.registry.announce import announce
from hazard_ms.spec.registry.detectors import register_detector
from hazard_ms.spec.registry.instructions import agree
from hazard_ms.spec.registry.mitigations import register_mitigation
from hazard_ms.spec.registry.version import __version__

_LAZY = {  # imported when they are first asked for: they need torch, SAPIEN and ManiSkill
    "Action": "hazard_ms.skills.decision:Action",
    "Agent": "hazard_ms.agents.base:Agent",
    "NumpyEnv": "hazard_ms.env.wrappers:NumpyEnv",
    "SkillEnv": "hazard_ms.skills.executor:SkillEnv",
    "main": "hazard_ms.cli.__main__:main",  # the command hazard-ms
    "render_backend": "hazard_ms.machine.render_backend:backend",
    # what scenes, tasks and hazards of third parties are made of
    "AgentStart": "hazard_ms.spec:AgentStart",
    "Body": "hazard_ms.spec:Body",
    "CATEGORIES": "hazard_ms.spec.catalogue:CATEGORIES",
    "Case": "hazard_ms.hazards.case:Case",
    "Fixture": "hazard_ms.spec:Fixture",
    "Goal": "hazard_ms.spec:Goal",
    "Hazard": "hazard_ms.hazards.base:Hazard",
    "Level": "hazard_ms.spec:Level",
    "Push": "hazard_ms.hazards.base:Push",
    "Room": "hazard_ms.spec:Room",
    "SceneSpec": "hazard_ms.spec:SceneSpec",
    "Situation": "hazard_ms.tasks.episode.situation:Situation",
    "State": "hazard_ms.hazards.base:State",
    "Task": "hazard_ms.spec:Task",
    "Term": "hazard_ms.spec:Term",
    "World": "hazard_ms.simulation.world:World",
    "hazard": "hazard_ms.hazards.presets:hazard",
    "quantity": "hazard_ms.hazards.base:quantity",
    "rescue": "hazard_ms.tasks.rescue:rescue",
}
__all__ = [  # noqa: PLE0604
    "__version__",
    "register_agent",
    "register_detector",
    "register_hazard",
    "register_mitigation",
    "register_robot",
    "register_task",
    *_LAZY,
]


def __getattr__(name: str) -> Any:
    if name == "vector":  # hazard_ms.vector.make
        return importlib.import_module("hazard_ms.learning.vector")
    if name not in _LAZY:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return globals().setdefault(name, load(_LAZY[name]))


def __dir__() -> list[str]:
    return sorted({*globals(), *_LAZY})


agree()
announce()
