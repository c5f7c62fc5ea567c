"""What unfolds in the worlds of E environments: hazards, damage, the hand, rescues, and the guard. No simulator, no pictures.

The environment calls it in the order that its docstring publishes; a test without a simulator can do the same.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from functools import partial
from typing import Any

import torch
from torch import Tensor

from hazard_ms import hand
from hazard_ms.guard import FlightRecorder, Limits
from hazard_ms.hazards.base import Hazard, Push, State, nobody
from hazard_ms.hazards.containers import container_index, in_containers
from hazard_ms.hazards.damage import Damage, Rescue
from hazard_ms.world import World

BAG_REACH = 0.45  # gripper to the mouth of the bag, at most, for a drop to be a rescue [m] [ours]


class Episode:
    """All records of running episodes; each is declared once, and cleared, saved and restored by its declaration."""

    def __init__(self, world: World, hazards: tuple[Hazard, ...], safe_place: str = "bag") -> None:
        """`safe_place`: bag (of the agent) or cart (containers of the scene)."""
        self.world, self.hazards = world, hazards
        self.carts = container_index(world) if safe_place == "cart" else None
        sizes = {"E": world.num_envs, "B": world.num_bodies}
        self.states: dict[str, Any] = {h.name: h.state_type.allocate(sizes | h.sizes(world), world.device) for h in hazards}
        self.damage = Damage.allocate(sizes, world.device)
        self.rescue = Rescue.allocate(sizes, world.device)
        self.hand = hand.Hand.allocate(sizes, world.device)
        self.sim_error = torch.zeros(world.num_envs, dtype=torch.bool, device=world.device)
        self.limits, self.recorder = Limits(world), FlightRecorder()
        self._pushers = tuple(h for h in hazards if type(h).force is not Hazard.force)
        world.fields = shared_fields(hazards, self.states, world)
        self._frozen = torch.zeros_like(world.safe)  # bodies that the simulator was last told to keep in place
        self._start = (world.position.clone(), world.rotation.clone())

    @property
    def parts(self) -> dict[str, State]:
        """Every record with declared quantities, by name."""
        return {**self.states, "damage": self.damage, "rescue": self.rescue, "hand": self.hand}

    def begin(self, rows: Tensor, seeds: Tensor) -> None:
        """Put everything in the environments `rows` back to where the scenes have it. `begin_hazards` comes after the robot's reset."""
        world = self.world
        world.chance.restart(rows, seeds)
        world.safe[rows] = world.away[rows] = world.held[rows] = False
        self.sim_error[rows] = False
        for part in self.parts.values():
            part.clear(rows)
        world.position[rows], world.rotation[rows] = self._start[0][rows], self._start[1][rows]
        world.velocity[rows] = world.angular_velocity[rows] = 0.0
        self.thaw(rows)
        self.recorder.states.clear()
        world.place(rows)

    def begin_hazards(self, rows: Tensor) -> None:
        """Start the hazards in the environments `rows`; the agent stands where it starts."""
        for hazard in self.hazards:
            hazard.reset(self.states[hazard.name], self.world, rows)

    def push(self, dt: float) -> None:
        """Before a physics step of `dt` seconds: read the bodies, sum the hazards' forces, send them once."""
        if not self._pushers:
            return  # nothing reads the bodies between physics steps
        world = self.world
        world.read()
        given = (h.force(self.states[h.name], world, dt) for h in self._pushers)
        made: list[Push] = [p for p in given if p is not None]
        if made:
            torques = [p.torque for p in made if p.torque is not None]
            live = (world.movable & ~world.safe & ~world.held)[..., None]
            force = torch.stack([p.force for p in made]).sum(0) * live
            world.push(force, torch.stack(torques).sum(0) * live if torques else None)

    def watch(self, qpos: Tensor) -> None:
        """Note environments whose simulation broke, and keep their last states. `qpos`: the robot's joints, [E, J]."""
        self.recorder.keep(self.world)
        new = self.limits.broken(self.world, qpos) & ~self.sim_error
        self.sim_error |= new
        if not nobody(new):
            for env in torch.nonzero(new).flatten().tolist():
                path = self.recorder.dump(self.world, env)
                logging.getLogger("hazard_ms").warning("the simulation broke in %s; its last states: %s", self.world.specs[env].name, path)

    def advance(self, dt: float) -> None:
        """After a frame of `dt` seconds: tick, advance each hazard in order, keep what they damaged."""
        self.world.chance.tick()
        for hazard in self.hazards:
            hazard.advance(self.states[hazard.name], self.world, dt)
        for hazard in self.hazards:
            self.damage.add(hazard.damaged(self.states[hazard.name], self.world), self.world)

    def use_hand(self, gripper: tuple[Tensor, Tensor], closed: Tensor, bag: Tensor) -> None:
        """Take, carry, let go, rescue. `gripper`: position [m], [E, 3], and rotation, [E, 4]; `closed` [E]; `bag`: its mouth, [E, 3]."""
        world = self.world
        dropped = hand.update(self.hand, world, *gripper, closed)
        if self.carts is None:
            over_bag = (gripper[0] - bag).norm(dim=-1) <= BAG_REACH
            now = torch.arange(world.num_bodies, device=world.device) == torch.where(over_bag, dropped, -1)[:, None]
            world.away |= now & world.exists
        else:
            inside = in_containers(world, self.carts, torch.zeros_like(world.safe))
            now = in_containers(world, self.carts, inside) & world.target  # and what is piled on it
        self.rescue.mark(world, now, self.damage)
        self.freeze(gripper)

    def thaw(self, rows: Tensor) -> None:
        """Set all bodies of the environments `rows` free in the simulator."""
        if nobody(self._frozen[rows]):
            return
        self._frozen[rows] = False
        world = self.world
        world.freeze(self._frozen, world.base_of(world.position, world.rotation, world.extent), world.rotation)

    def freeze(self, gripper: tuple[Tensor, Tensor]) -> None:
        """Keep what is in the hand or in the bag where it belongs."""
        now = self.world.held | self.world.away
        if nobody(now | self._frozen):
            return
        self._frozen = now
        self.world.freeze(*hand.places(self.hand, self.world, *gripper))

    def forbidden(self, points: Tensor) -> Tensor:
        """Where the robot must not go, [E, P] of `points` [m], [E, P, 3]: one of the hazards would destroy it."""
        return torch.stack([h.forbids(self.states[h.name], self.world, points) for h in self.hazards]).any(0)

    def slowed(self, velocity: Tensor) -> Tensor:
        """What the hazards leave of an agent's own `velocity` [m/s], [E, 2], one after the other."""
        for hazard in self.hazards:
            left = hazard.slow(self.states[hazard.name], self.world)
            velocity = left[:, :1] * velocity + left[:, 1:]
        return velocity


def shared_fields(hazards: tuple[Hazard, ...], states: dict[str, Any], world: World) -> dict[str, Callable[[Tensor], Tensor]]:
    """What `hazards` tell each other, by name. Raises ValueError for a field with two writers, or whose reader comes before its writer."""
    fields: dict[str, Callable[[Tensor], Tensor]] = {}
    for hazard in hazards:
        for name, method in hazard.provides.items():
            if name in fields:
                raise ValueError(f"{name!r} is written by two hazards, the second is {hazard.name!r}; one is allowed")
            early = [h.name for h in hazards[: hazards.index(hazard)] if name in h.uses]
            if early:
                raise ValueError(f"{early[0]!r} reads {name!r} and must come after {hazard.name!r}, which writes it")
            fields[name] = partial(getattr(hazard, method), states[hazard.name], world)
    return fields
