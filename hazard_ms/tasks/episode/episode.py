"""Course of the episodes of E environments: hazards, damage, the hand, rescues and the watchdog.

It needs no simulator and no pictures. The environment calls it in the order that the environment's docstring states;
a test without a simulator can do the same.
"""

from __future__ import annotations

import logging
from collections.abc import Callable
from functools import partial
from typing import Any

import torch
from torch import Tensor

from hazard_ms.hazards.base import Flames, Hazard, Push, State, none_set, summed
from hazard_ms.simulation.kernels.bodies import Bodies
from hazard_ms.simulation.kernels.pushing import free_only
from hazard_ms.simulation.openings import EVERY
from hazard_ms.simulation.robot import Robot
from hazard_ms.simulation.walls import leaves
from hazard_ms.simulation.world import World
from hazard_ms.spec import SafePlace
from hazard_ms.tasks.episode import grasp
from hazard_ms.tasks.episode.records import Damage, Rescue
from hazard_ms.tasks.episode.safe_places import BAG, Drop
from hazard_ms.tasks.episode.watchdog import FlightRecorder, Limits


class Episode:
    """All records of running episodes. Each is declared once, and cleared, saved and restored by its declaration."""

    def __init__(self, world: World, hazards: tuple[Hazard, ...], safe_place: SafePlace = BAG) -> None:
        self.world, self.hazards = world, hazards
        self.safe_place, self._safe_now = safe_place, safe_place.rule(world)
        sizes = {"E": world.num_envs, "B": world.num_bodies}
        self.states: dict[str, Any] = {
            h.name: h.state_type.allocate(sizes | h.sizes(world), world.device) for h in hazards
        }
        self.damage = Damage.allocate(sizes, world.device)
        self.rescue = Rescue.allocate(sizes, world.device)
        self.hand = grasp.Hand.allocate(sizes, world.device)
        self.others: dict[str, State] = {}  # further records by name, such as the hands of more robots
        self.sim_error = torch.zeros(world.num_envs, dtype=torch.bool, device=world.device)
        self.limits, self.recorder = Limits(world), FlightRecorder()
        self._pushers = tuple(h for h in hazards if type(h).force is not Hazard.force)
        self._strainers = tuple(h for h in hazards if type(h).strain is not Hazard.strain)
        # what opens and breaks is part of the state where anything can
        self._opens = bool(self._strainers) or any(leaves(spec) for spec in world.specs)
        world.fields = shared_fields(hazards, self.states, world)
        self._frozen = torch.zeros_like(world.safe)  # bodies that the simulator keeps in place
        self._start = (world.position.clone(), world.rotation.clone())

    @property
    def parts(self) -> dict[str, State]:
        """Every record with declared quantities, by name."""
        openings = {"openings": self.world.openings.state} if self._opens else {}
        equipment = {} if self.world.equipment is None else {"equipment": self.world.equipment.state}
        grip = {} if self.world.door_grip is None else {"door_grip": self.world.door_grip.state}
        rest = {"damage": self.damage, "rescue": self.rescue, "hand": self.hand}
        return {**self.states, **openings, **equipment, **grip, **rest, **self.others}

    def begin(self, rows: Tensor, seeds: Tensor) -> None:
        """Put everything in the environments `rows` [R] back in its place, with new `seeds` [R].

        Call `begin_hazards` after the robot's reset.
        """
        world = self.world
        world.chance.restart(rows, seeds)
        world.safe[rows] = world.away[rows] = world.held[rows] = False
        self.sim_error[rows] = False
        for part in self.parts.values():
            part.clear(rows)
        if self._opens:
            world.openings.begin(rows)
        if world.equipment is not None:
            world.equipment.begin(rows)
        world.position[rows], world.rotation[rows] = self._start[0][rows], self._start[1][rows]
        world.velocity[rows] = world.angular_velocity[rows] = 0.0
        self.thaw(rows)
        self.recorder.states.clear()
        self.loosen()
        world.place(rows)

    def begin_hazards(self, rows: Tensor) -> None:
        """Start the hazards in the environments `rows` [R]; the agent must stand at its start."""
        for hazard in self.hazards:
            hazard.reset(self.states[hazard.name], self.world, rows)

    def see(self, agent: Robot) -> None:
        """Copy the place and heading of the `agent` into the world."""
        position, heading = agent.base_pose()
        self.world.agent_position.copy_(position)
        self.world.agent_heading.copy_(heading)

    def push(self, dt: float) -> None:
        """Read the bodies, sum the hazards' forces and send them; call it before each physics step of `dt` seconds."""
        if not self._pushers:
            return  # nothing reads the bodies between physics steps
        world = self.world
        world.read()
        given = [h.force(self.states[h.name], world, dt) for h in self._pushers]
        made: list[Push] = [p for p in given if p is not None]
        if made:
            torques, bodies = [p.torque for p in made if p.torque is not None], world.launches.struct(Bodies, world)
            force = summed([p.force for p in made], world.position)
            torque = summed(torques, world.position) if torques else force
            kept = world.launches.results(free_only, force, torque)
            world.launches.run(free_only, tuple(world.exists.shape), bodies, force, torque, *kept)
            world.push(kept[0], kept[1] if torques else None)

    def watch(self, qpos: Tensor) -> None:
        """Mark environments whose simulation broke, and write their last states; `qpos` [rad], [E, J]: joints."""
        self.recorder.keep(self.world)
        new = self.limits.mark(self.world, qpos, self.sim_error)
        if not none_set(new):
            for env in torch.nonzero(new).flatten().tolist():
                path = self.recorder.dump(self.world, env)
                logging.getLogger("hazard_ms").warning(
                    "the simulation broke in %s; its last states: %s", self.world.specs[env].name, path
                )

    def advance(self, dt: float) -> None:
        """Advance the clock and each hazard, in order, and record damage; call it after each frame of `dt` seconds.

        Then doors and windows bear what the hazards do to them.
        """
        self.world.chance.tick()
        for hazard in self.hazards:
            hazard.advance(self.states[hazard.name], self.world, dt)
        if self.world.equipment is not None:
            self.world.equipment.advance(dt, max((h.clock for h in self.hazards), default=1.0))
        self.loosen()
        for hazard in self.hazards:
            self.damage.add(hazard.damaged(self.states[hazard.name], self.world), self.world)
        due = self.world.chance.due(EVERY) if self._strainers else None
        if due is not None:
            given = (h.strain(self.states[h.name], self.world) for h in self._strainers)
            self.world.openings.bear([s for s in given if s is not None], due, EVERY * dt)

    def loosen(self) -> None:
        """Set furniture free that a hazard has loosened; all other stands."""
        if none_set(self.world.floats):
            return
        known = [h.loose(self.states[h.name], self.world) for h in self.hazards]
        loose = torch.stack([mask for mask in known if mask is not None]).any(0)
        if not torch.equal(loose & self.world.floats, self.world.movable & self.world.floats):
            self.world.loosen(loose)

    def use_hand(self, gripper: tuple[Tensor, Tensor], closed: Tensor, bag: Callable[[], Tensor]) -> None:
        """Let the hands take, carry and let go, and record rescues.

        `gripper`: positions [m], [E, 3], and rotations, [E, 4]; `closed` [E]: commands; `bag` gives its mouth [m],
        [E, 3], and is called when something is let go.
        """
        self.put_away(Drop(grasp.update(self.hand, self.world, *gripper, closed), gripper[0], bag))
        self.freeze(gripper)

    def put_away(self, drop: Drop) -> None:
        """Record what is safe by now, after a hand has let things go as `drop` tells."""
        now = self._safe_now(drop)
        if now is not None and not none_set(now):
            if self.safe_place.carried:
                self.world.away |= now & self.world.exists
            self.rescue.mark(self.world, now, self.damage)

    def thaw(self, rows: Tensor) -> None:
        """Set all bodies of the environments `rows` [R] free in the simulator."""
        if none_set(self._frozen[rows]):
            return
        self._frozen[rows] = False
        world = self.world
        world.freeze(self._frozen, world.base_of(world.position, world.rotation, world.extent), world.rotation)

    def freeze(self, gripper: tuple[Tensor, Tensor]) -> None:
        """Keep things in a hand or in the bag in their places; `gripper`: positions [m], [E, 3], rotations, [E, 4]."""
        self.keep(lambda: grasp.places(self.hand, self.world, *gripper))

    def keep(self, places: Callable[[], tuple[Tensor, Tensor, Tensor]]) -> None:
        """Keep what is in hands or bags at `places`, [E, B, 3] [m], asked if anything is there: see `grasp.places`."""
        now = self.world.held | self.world.away
        if self.world.equipment is not None:
            now = now | self.world.equipment.placed
        if none_set(now | self._frozen):
            return
        self._frozen = now
        self.world.freeze(*places())

    def forbidden(self, points: Tensor) -> Tensor:
        """Whether a hazard would destroy the robot at each of the `points` [m], [E, P, 3]: bool [E, P]."""
        return torch.stack([h.forbids(self.states[h.name], self.world, points) for h in self.hazards]).any(0)

    def levels(self, points: Tensor) -> Tensor:
        """Levels of the K hazards at `points` [m], world frame, [E, P, 3]: [E, K, P], each in its hazard's unit."""
        if not self.hazards:  # practice has none
            return points.new_zeros(points.shape[0], 0, points.shape[1])
        return torch.stack([h.image(self.states[h.name], self.world, points) for h in self.hazards], dim=1)

    def flames(self) -> Flames | None:
        """The flames of the hazard that burns; None where none does."""
        found = [h.flames(self.states[h.name], self.world) for h in self.hazards]
        return next((flames for flames in found if flames is not None), None)

    def smother(self, rows: Tensor, thing: int) -> None:
        """Keep the air from `thing`, an index along B, in the environments `rows` [R]: if it burns, it goes out."""
        things = torch.zeros_like(self.world.exists)
        things[rows, thing] = True
        for hazard in self.hazards:
            hazard.smother(self.states[hazard.name], self.world, things)

    @property
    def loads_openings(self) -> bool:
        """Whether a hazard presses on doors and windows, or burns them."""
        return bool(self._strainers)

    def lying(self) -> Tensor | None:
        """Whether the agent lies on the ground where a hazard threw it over, [E], bool; None: none ever does."""
        falls = [h.fallen(self.states[h.name], self.world) for h in self.hazards]
        known = [fell for fell in falls if fell is not None]
        return torch.stack(known).any(0) if known else None

    def slowed(self, velocity: Tensor) -> Tensor:
        """The agent's own `velocity` [m/s], [E, 2], after each hazard in turn has slowed it."""
        for hazard in self.hazards:
            left = hazard.slow(self.states[hazard.name], self.world)
            velocity = left[:, :1] * velocity + left[:, 1:]
        return velocity


def shared_fields(
    hazards: tuple[Hazard, ...], states: dict[str, Any], world: World
) -> dict[str, Callable[[Tensor], Tensor]]:
    """Functions of points [m], [E, P, 3], through which `hazards` tell each other their levels, by name.

    Raises ValueError for a field with two writers, or whose reader comes before its writer.
    """
    fields: dict[str, Callable[[Tensor], Tensor]] = {}
    for hazard in hazards:
        for name, method in hazard.provides.items():
            if name in fields:
                raise ValueError(f"{name!r} must be written by one hazard alone, got a second: {hazard.name!r}")
            early = [h.name for h in hazards[: hazards.index(hazard)] if name in h.uses]
            if early:
                raise ValueError(f"{hazard.name!r} must come before {early[0]!r}, which reads {name!r}, got it after")
            fields[name] = partial(getattr(hazard, method), states[hazard.name], world)
    return fields
