"""The leaves of doors between rooms in the simulator: boxes that slide along their wall as far as the doors are open.

What is open of a doorway is so the same for robots and things as for fire, smoke and water
(hazard_ms.simulation.openings). A leaf that is broken is gone: below the floor.
"""

from __future__ import annotations

from typing import Any

import sapien
import torch
from sapien.physx import PhysxRigidDynamicComponent
from torch import Tensor

from hazard_ms.scenes.shell import ShellBox, leaf
from hazard_ms.scenes.walls import WALLS, runs_along_x
from hazard_ms.simulation.drawing.textured_box import surface_material, textured_box
from hazard_ms.simulation.names import actor_name
from hazard_ms.simulation.world import World

GONE = -10.0  # height of what is broken [m]


class Leaves:
    """The L leaves of all environments."""

    def __init__(self, scene: Any, world: World) -> None:
        self._scene, self._world = scene, world
        self._actors: list[Any] = []
        where, middle, along = [], [], []
        for e, spec in enumerate(world.specs):
            for k, o in enumerate(spec.room.openings):
                if o.kind == "door" and o.wall not in WALLS:
                    box = leaf(spec.room, o)
                    self._actors.append(_build(scene, box, e, k))
                    where.append((e, k))
                    middle.append(box.centre)
                    along.append((o.width, 0.0, 0.0) if runs_along_x(spec.room, o.wall) else (0.0, o.width, 0.0))
        self._where = torch.tensor(where, device=world.device).reshape(-1, 2)
        self._middle, self._along = (torch.tensor(of, device=world.device).reshape(-1, 3) for of in (middle, along))

    def places(self) -> Tensor:
        """Middles of the leaves as the doors are open now [m], [L, 3], world frame of their environment."""
        e, k = self._where.unbind(1)
        state = self._world.openings.state
        slid = self._middle - state.open[e, k, None] * self._along
        return torch.where(state.broken[e, k, None], slid.new_tensor([0.0, 0.0, GONE]), slid)

    def move(self) -> None:
        """Put the leaves where they belong."""
        if not self._actors:
            return
        places = self.places()
        if self._scene.gpu_sim_enabled:
            bodies = [a._objs[0].find_component_by_type(PhysxRigidDynamicComponent).gpu_index for a in self._actors]
            rows = self._scene.px.cuda_rigid_body_data.torch()
            rows[torch.tensor(bodies, device=places.device), :3] = places + self._scene.scene_offsets[self._where[:, 0]]
            self._scene.px.gpu_apply_rigid_dynamic_data()
            return
        for actor, place in zip(self._actors, places.tolist(), strict=True):
            actor._objs[0].set_pose(sapien.Pose(place))


def _build(scene: Any, box: ShellBox, env: int, number: int) -> Any:
    builder = scene.create_actor_builder()
    builder.set_scene_idxs([env])
    builder.add_box_collision(half_size=[edge / 2 for edge in box.size])
    if scene.can_render():
        builder._procedural_shapes.append(textured_box(box.size, surface_material(box.material)))
    builder.initial_pose = sapien.Pose(list(box.centre))
    actor = builder.build_kinematic(name=actor_name(env, f"leaf_{number}"))
    scene.remove_from_state_dict_registry(actor)
    return actor
