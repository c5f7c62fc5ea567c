"""A scene by itself in the simulator, without robot, task and hazards, for checks and pictures of scenes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import sapien
import torch
from mani_skill.envs.scene import ManiSkillScene
from mani_skill.utils.structs.types import SimConfig

from hazard_ms.machine.render_backend import backend
from hazard_ms.simulation import building
from hazard_ms.simulation.drawing.lighting import Lighting
from hazard_ms.simulation.world import World
from hazard_ms.spec import SceneSpec
from hazard_ms.spec.undocumented import parse_sim_and_render_backend

PHYSICS_RATE = 120  # [Hz] as in the preset `paper`


@dataclass
class Standalone:
    """A scene that was built, with its things as tensors."""

    scene: Any  # ManiSkillScene of one sub-scene
    world: World

    def step(self) -> None:
        """Advance the simulation by one physics step."""
        self.scene.px.step()


def build(
    spec: SceneSpec, draw: bool = False, rate: int = PHYSICS_RATE, loose: frozenset[str] = frozenset()
) -> Standalone:
    """Build the scene of `spec`, ready to be rendered if `draw`, for `rate` physics steps a second [Hz].

    `loose`: names of the furniture that can be set free.

    Raises ValueError if `draw` without a renderer.
    """
    if draw and backend() == "none":
        raise ValueError("draw must be False without a renderer, got True: `hazard-ms doctor` says what is missing")
    info = parse_sim_and_render_backend("cpu", backend() if draw else "none")
    _configure(SimConfig())
    systems: list[Any] = [sapien.physx.PhysxCpuSystem()]
    if draw:
        systems.append(sapien.render.RenderSystem(info.render_device))
    scene = ManiSkillScene([sapien.Scene(systems)], debug_mode=False, device=torch.device("cpu"), backend=info)
    scene.set_timestep(1.0 / rate)
    rows = building.build_scenes(scene, (spec,), (loose,))
    world = building.make_world((spec,), torch.device("cpu"), (loose,))
    world.handles = building.connect(scene, (spec,), rows, torch.device("cpu"))
    if draw:
        Lighting(scene, (spec,))
    return Standalone(scene, world)


def _configure(config: SimConfig) -> None:
    """Set PhysX as ManiSkill's environments do."""
    scene, physx = config.scene_config, sapien.physx
    physx.set_shape_config(contact_offset=scene.contact_offset, rest_offset=scene.rest_offset)
    physx.set_body_config(
        solver_position_iterations=scene.solver_position_iterations,
        solver_velocity_iterations=scene.solver_velocity_iterations,
        sleep_threshold=scene.sleep_threshold,
    )
    physx.set_scene_config(
        gravity=scene.gravity,
        bounce_threshold=scene.bounce_threshold,
        enable_pcm=scene.enable_pcm,
        enable_tgs=scene.enable_tgs,
        enable_ccd=scene.enable_ccd,
        enable_enhanced_determinism=True,
        enable_friction_every_iteration=scene.enable_friction_every_iteration,
        cpu_workers=scene.cpu_workers,
    )
