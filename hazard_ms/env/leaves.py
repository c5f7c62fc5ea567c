"""The leaves of doors between rooms in the simulator: boxes with handles that turn about their hinges.

What is open of a doorway is so the same for robots and things as for fire, smoke and water
(hazard_ms.simulation.openings); where leaves are: hazard_ms.simulation.mitigation.hinges. A leaf that is broken is
gone: below the floor.
"""

from __future__ import annotations

import math
from typing import Any

import sapien
import torch
from sapien.physx import PhysxRigidDynamicComponent
from torch import Tensor

from hazard_ms.scenes.shell import ShellBox, leaf
from hazard_ms.scenes.walls import WALLS, runs_along_x
from hazard_ms.simulation.drawing.textured_box import surface_material, textured_box
from hazard_ms.simulation.mitigation import hinges
from hazard_ms.simulation.world import World
from hazard_ms.spec import Opening, Room
from hazard_ms.spec.names import actor_name

GONE = -10.0  # height of what is broken [m]
SLOW = 0.1  # leaves that move less in a frame turn, others are put where they belong [m] [ours]
HANDLE = (0.12, 2 * hinges.BESIDE, 0.025)  # of a lever on both faces: along the leaf, across it, upwards [m] [ours]


class Leaves:
    """The L leaves of all environments."""

    def __init__(self, scene: Any, world: World) -> None:
        self._scene, self._world = scene, world
        self._actors: list[Any] = []
        where, hinge, along, out = [], [], [], []
        for e, spec in enumerate(world.specs):
            for k, o in enumerate(spec.room.openings):
                if o.kind == "door" and o.wall not in WALLS:
                    box = leaf(spec.room, o)
                    self._actors.append(_build(scene, box, spec.room, o, e, k))
                    start, line, swing = hinges.hinge(spec.room, o)
                    where.append((e, k))
                    hinge.append((*start.tolist(), box.centre[2]))
                    along.append((*(line * o.width / 2).tolist(), 0.0))
                    out.append((*(swing * o.width / 2).tolist(), 0.0))
        self._where = torch.tensor(where, device=world.device).reshape(-1, 2)
        self._hinge, self._along, self._out = (
            torch.tensor(of, dtype=torch.float32, device=world.device).reshape(-1, 3) for of in (hinge, along, out)
        )

        self._at = self._before = torch.full((len(where), 7), math.inf)  # poses at the last move, and before it
        self._turning: list[int] = []
        self._step = 0

    def poses(self) -> tuple[Tensor, Tensor]:
        """Middles of the leaves as the doors are open now [m], [L, 3], and their rotations, [L, 4].

        In the world frame of their environment.
        """
        e, k = self._where.unbind(1)
        state = self._world.openings.state
        turn = (1.0 - state.open[e, k].clamp(0.0, 1.0)).acos()
        middle = self._hinge + turn.cos()[:, None] * self._along + turn.sin()[:, None] * self._out
        middle = torch.where(state.broken[e, k, None], middle.new_tensor([0.0, 0.0, GONE]), middle)
        left = torch.where(self._out[:, 0] < 0.0, 0.5, -0.5) * turn  # anticlockwise where it turns to the west
        zero = torch.zeros_like(turn)
        return middle, torch.stack([left.cos(), zero, zero, left.sin()], -1)

    def move(self) -> None:
        """Put the leaves where they belong."""
        if not self._actors:
            return
        places, turns = self.poses()
        if self._scene.gpu_sim_enabled:
            bodies = [a._objs[0].find_component_by_type(PhysxRigidDynamicComponent).gpu_index for a in self._actors]
            rows = self._scene.px.cuda_rigid_body_data.torch()
            moved = torch.tensor(bodies, device=places.device)
            rows[moved, :3] = places + self._scene.scene_offsets[self._where[:, 0]]
            rows[moved, 3:7] = turns
            self._scene.px.gpu_apply_rigid_dynamic_data()
            return
        now = torch.cat([places, turns], 1)
        slow = (now - self._at).abs().amax(1) < SLOW
        for number in (now != self._at).any(1).nonzero()[:, 0].tolist():
            if not bool(slow[number]):
                self._actors[number]._objs[0].set_pose(_pose(now[number]))
        self._turning = [number for number in (now != self._at).any(1).nonzero()[:, 0].tolist() if bool(slow[number])]
        self._before, self._at, self._step = self._at, now, 0

    def push(self, steps: int) -> None:
        """Lead leaves that turn on to where they are at the end of this physics step, one of `steps` in a frame.

        So they push what is in their way at their own speed.
        """
        self._step += 1
        share = min(1.0, self._step / steps)
        for number in self._turning:
            body = self._actors[number]._objs[0].find_component_by_type(PhysxRigidDynamicComponent)
            body.set_kinematic_target(_pose(torch.lerp(self._before[number], self._at[number], share)))


def _pose(numbers: Tensor) -> sapien.Pose:
    return sapien.Pose(numbers[:3].tolist(), (numbers[3:] / numbers[3:].norm()).tolist())


def _build(scene: Any, box: ShellBox, room: Room, o: Opening, env: int, number: int) -> Any:
    builder = scene.create_actor_builder()
    builder.set_scene_idxs([env])
    builder.add_box_collision(half_size=[edge / 2 for edge in box.size])
    ahead = o.width / 2 - hinges.HANDLE_EDGE
    high = o.sill + hinges.HANDLE_HEIGHT - box.centre[2]
    along_x = runs_along_x(room, o.wall)
    place = (ahead, 0.0, high) if along_x else (0.0, ahead, high)
    size = HANDLE if along_x else (HANDLE[1], HANDLE[0], HANDLE[2])
    builder.add_box_collision(sapien.Pose(place), half_size=[edge / 2 for edge in size])
    if scene.can_render():
        builder._procedural_shapes.append(textured_box(box.size, surface_material(box.material)))
        metal = sapien.render.RenderMaterial(base_color=[0.6, 0.6, 0.62, 1.0], roughness=0.3, metallic=0.9)
        builder.add_box_visual(sapien.Pose(place), half_size=[edge / 2 for edge in size], material=metal)
    builder.initial_pose = sapien.Pose(list(box.centre))
    actor = builder.build_kinematic(name=actor_name(env, f"leaf_{number}"))
    scene.remove_from_state_dict_registry(actor)
    return actor
