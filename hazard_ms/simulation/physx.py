"""The only file that touches SAPIEN's handles of moving bodies: one class for PhysX on the CPU, one for PhysX on a GPU.

CPU: one environment. All bodies are read in one call (`pack`: rotation, position, velocity and angular velocity of
every dynamic body of the scene, in the order of `rigid_dynamic_components`); the rest of SAPIEN's CPU interface is per
body. GPU: whole buffers, one call for the forces of all bodies of all environments in each physics step. Written from
SAPIEN 3.0.3's interface (`cuda_rigid_body_data`, `cuda_rigid_body_force`, `gpu_apply_rigid_dynamic_force`); run the
tests marked `gpu` on such a machine.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING, Any

import numpy as np
import sapien
import torch
from sapien.physx import PhysxRigidDynamicComponent
from torch import Tensor

from hazard_ms.simulation.kernels.bodies import Bodies
from hazard_ms.simulation.kernels.reading import unpack

if TYPE_CHECKING:
    from hazard_ms.simulation.world import World

_NONE: Mapping[int, sapien.Entity] = MappingProxyType({})
PACKED_NUMBERS = 13  # numbers that SAPIEN packs for each body: position, rotation, velocity, angular velocity


class CpuHandles:
    """Bodies of one scene in PhysX on the CPU, in the order of World's B. See `hazard_ms.simulation.world.Handles`."""

    def __init__(self, entities: list[sapien.Entity], furniture: Mapping[int, sapien.Entity] = _NONE) -> None:
        """Take the bodies `entities`, and the `furniture` that can be set free, by its index along B."""
        self.bodies = [e.find_component_by_type(PhysxRigidDynamicComponent) for e in entities]
        self.furniture = {b: e.find_component_by_type(PhysxRigidDynamicComponent) for b, e in furniture.items()}
        self._groups = [[s.get_collision_groups() for s in b.collision_shapes] for b in self.bodies]
        every = dict(enumerate(self.bodies)) | self.furniture
        self._add = {b: body.add_force_torque for b, body in every.items()}
        self._which, self._size = torch.tensor(list(every)), (len(every),)
        self._frozen: set[int] = set()
        self._px: Any = entities[0].scene.physx_system if entities else None
        self._length = -1  # size of what SAPIEN packed last [bytes]

    def read(self, world: World) -> None:
        """Write the state of the bodies into `world`."""
        if not self.bodies:
            return
        packed = self._px.pack()
        if len(packed) != self._length:
            self._find(len(packed))
        self._numbers[:] = np.frombuffer(packed, np.float32, len(self._numbers))
        bodies = world.launches.struct(Bodies, world)
        world.launches.run(unpack, self._size, self._packed, self._rows, self._which, bodies)

    def _find(self, length: int) -> None:
        """Find the rows of the bodies in what SAPIEN packs; needed again when bodies come or go."""
        every = self._px.rigid_dynamic_components
        self._length = length
        self._rows = torch.tensor([every.index(b) for b in (*self.bodies, *self.furniture.values())])
        self._packed = torch.zeros(len(every), PACKED_NUMBERS)
        self._numbers = self._packed.view(-1).numpy()  # the same memory

    def asleep(self) -> Tensor:
        """Whether PhysX has put each body to rest, bool [1, M]."""
        return torch.tensor([[b.is_sleeping for b in self.bodies]])

    def put_to_sleep(self, asleep: Tensor) -> None:
        """Let the bodies of the mask `asleep` [1, M] rest exactly where they are: restored piles do not move."""
        for b, (body, still) in enumerate(zip(self.bodies, asleep[0].tolist(), strict=True)):
            if still and b not in self._frozen:
                body.put_to_sleep()

    def push(self, force: Tensor, torque: Tensor | None) -> None:
        """Apply `force` [N] and `torque` [N m], [1, B, 3], world frame, for one physics step."""
        forces = force.numpy()[0]
        torques = np.zeros_like(forces) if torque is None else torque.numpy()[0]
        rows = (forces.any(1) | torques.any(1)).nonzero()[0]
        for b, one, turn in zip(rows.tolist(), forces.take(rows, 0), torques.take(rows, 0), strict=True):
            if b not in self._frozen:
                self._add[b](one, turn)

    def place(self, rows: Tensor, base: Tensor, rotation: Tensor) -> None:
        """Put all bodies at rest at `base` [m], [1, B, 3], and `rotation` [1, B, 4], unless `rows` is empty."""
        if len(rows) == 0:
            return
        for b, body in enumerate(self.bodies):
            body.entity.set_pose(sapien.Pose(base[0, b].numpy(), rotation[0, b].numpy()))
            if b not in self._frozen:
                body.linear_velocity = body.angular_velocity = np.zeros(3)
        for b, body in self.furniture.items():
            body.entity.set_pose(sapien.Pose(base[0, b].numpy(), rotation[0, b].numpy()))

    def loosen(self, loose: Tensor) -> None:
        """Let the furniture of the mask `loose` [1, B] move; all other furniture stands where it is, kinematic."""
        wanted = loose[0].tolist()
        for b, body in self.furniture.items():
            if body.kinematic == wanted[b]:
                body.kinematic = not wanted[b]
                if wanted[b]:
                    body.linear_velocity = body.angular_velocity = np.zeros(3)
                self._wake()

    def freeze(self, frozen: Tensor, base: Tensor, rotation: Tensor) -> None:
        """Keep the bodies of the mask `frozen` [1, B] at `base` [m], [1, B, 3], and `rotation` [1, B, 4].

        They are kinematic and collide with nothing meanwhile.
        """
        wanted = frozen[0].tolist()
        for b, body in enumerate(self.bodies):
            if wanted[b] != (b in self._frozen):
                self._switch(b, wanted[b])
            if wanted[b]:
                body.entity.set_pose(sapien.Pose(base[0, b].numpy(), rotation[0, b].numpy()))

    def _switch(self, b: int, frozen: bool) -> None:
        (self._frozen.add if frozen else self._frozen.discard)(b)
        body = self.bodies[b]
        for shape, groups in zip(body.collision_shapes, self._groups[b], strict=True):
            shape.set_collision_groups([0, 0, 0, 0] if frozen else groups)
        body.kinematic = frozen
        if not frozen:
            body.linear_velocity = body.angular_velocity = np.zeros(3)
        self._wake()  # bodies that rested on it must fall: contacts alone do not wake them

    def _wake(self) -> None:
        for b, other in enumerate(self.bodies):
            if b not in self._frozen:
                other.wake_up()


class GpuHandles:
    """Bodies of E scenes in PhysX on a GPU, in the order of World's B, padded to M per scene.

    See `hazard_ms.simulation.world.Handles`.
    """

    def __init__(self, px: Any, entities: list[list[sapien.Entity]], offsets: Tensor, device: torch.device) -> None:
        self.px = px
        self.offsets = offsets  # place of each sub-scene within the shared PhysX scene [m], [E, 3]
        found = [[e.find_component_by_type(PhysxRigidDynamicComponent).gpu_index for e in row] for row in entities]
        width = max(len(row) for row in found)
        self.index = torch.tensor([row + [-1] * (width - len(row)) for row in found], device=device)  # [E, M]
        self.present = self.index >= 0
        self._frozen = torch.zeros_like(self.present)

    def read(self, world: World) -> None:
        """Write the state of the bodies into `world`."""
        self.px.gpu_fetch_rigid_dynamic_data()
        data = self.px.cuda_rigid_body_data.torch()[self.index.clamp(min=0)]
        m = self.index.shape[1]
        keep = self.present[..., None]
        base = data[..., :3] - self.offsets[:, None]
        centre = world.centre_of(base, data[..., 3:7], world.extent[:, :m])
        for target, new in (
            (world.position, centre),
            (world.rotation, data[..., 3:7]),
            (world.velocity, data[..., 7:10]),
            (world.angular_velocity, data[..., 10:13]),
        ):
            target[:, :m] = torch.where(keep, new, target[:, :m])

    def push(self, force: Tensor, torque: Tensor | None) -> None:
        """Apply `force` [N] and `torque` [N m], [E, B, 3], world frame, for one physics step."""
        m = self.index.shape[1]
        live = self.present & ~self._frozen
        felt, here = live[..., None], self.present
        self.px.cuda_rigid_body_force.torch()[self.index[here], :3] = torch.where(felt, force[:, :m], 0.0)[here]
        self.px.gpu_apply_rigid_dynamic_force()
        if torque is not None:
            self.px.cuda_rigid_body_torque.torch()[self.index[here], :3] = torch.where(felt, torque[:, :m], 0.0)[here]
            self.px.gpu_apply_rigid_dynamic_torque()

    def asleep(self) -> Tensor:
        """All False, bool [E, M]: PhysX on a GPU does not tell which bodies rest."""
        return torch.zeros_like(self.present)

    def put_to_sleep(self, asleep: Tensor) -> None:
        """Do nothing with the mask `asleep` [E, M]: PhysX on a GPU cannot do it, so restored piles settle again."""

    def place(self, rows: Tensor, base: Tensor, rotation: Tensor) -> None:
        """Put the bodies of the environments `rows` at rest at `base` [m], [E, B, 3], and `rotation` [E, B, 4]."""
        moved = torch.zeros_like(self.present)
        moved[rows] = True
        self._write(moved, base, rotation)

    def loosen(self, loose: Tensor) -> None:
        """Do nothing with the mask `loose` [E, B]: on a GPU a body cannot stop being kinematic, so furniture stays."""

    def freeze(self, frozen: Tensor, base: Tensor, rotation: Tensor) -> None:
        """Keep the bodies of the mask `frozen` [E, B] at `base` [m], [E, B, 3], and `rotation` [E, B, 4].

        A body on a GPU cannot become kinematic at run time: it is put back in its place every frame, and no hazard acts
        on it.
        """
        self._frozen = frozen[:, : self.index.shape[1]]
        self._write(self._frozen, base, rotation)

    def _write(self, moved: Tensor, base: Tensor, rotation: Tensor) -> None:
        m = self.index.shape[1]
        rows = self.px.cuda_rigid_body_data.torch()
        old = rows[self.index.clamp(min=0)]
        pose = torch.cat(
            [base[:, :m] + self.offsets[:, None], rotation[:, :m], torch.zeros_like(old[..., 7:13])], dim=-1
        )
        new = torch.where((moved & self.present)[..., None], pose, old[..., :13])
        rows[self.index[self.present], :13] = new[self.present]
        self.px.gpu_apply_rigid_dynamic_data()
