"""The robots that share an episode: each has a hand, a bag and a place of its own; things and hazards are there once.

What is rescued counts for all of them. With one robot everything is that of the episode itself.
"""

from __future__ import annotations

import copy
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import Any

import torch
from torch import Tensor

from hazard_ms.hazards.base import none_set
from hazard_ms.simulation.mitigation.equipment import NozzleState
from hazard_ms.simulation.robot import Robot
from hazard_ms.simulation.world import World
from hazard_ms.tasks.episode import grasp, rewards
from hazard_ms.tasks.episode.episode import Episode
from hazard_ms.tasks.episode.grasp import Hand
from hazard_ms.tasks.episode.safe_places import Drop
from hazard_ms.tasks.episode.situation import Situation


@dataclass(frozen=True)
class Member:
    """One of the robots. In its world `agent_position`, `agent_heading`, `agent_build` and `held` are its own."""

    name: str
    situation: Situation

    @property
    def agent(self) -> Robot:
        """The robot itself."""
        return self.situation.agent

    @property
    def world(self) -> World:
        """The world with its own place and the thing in its own hand."""
        return self.situation.world

    @property
    def hand(self) -> Hand:
        """Whether and which thing it holds."""
        return self.situation.episode.hand


class Members:
    """All robots of the environments, in order."""

    def __init__(self, episode: Episode, robots: Mapping[str, Robot], affects_agent: bool) -> None:
        """Let `robots`, by name, play in `episode`; the hands of all but the first become records of it."""
        self._episode, world = episode, episode.world
        first = Situation(episode, next(iter(robots.values())), affects_agent)
        self._all = [Member(name, first) for name in robots]
        if len(robots) == 1:
            return
        world.openings, world.targets  # noqa: B018 made now, they are shared by the copies below
        hands, sizes = [episode.hand], {"E": world.num_envs, "B": world.num_bodies}
        for number in range(1, len(robots)):
            hands.append(Hand.allocate(sizes, world.device))
            episode.others[f"hand_{number}"] = hands[-1]
        episodes = [_own(episode, hand, number) for number, hand in enumerate(hands)]
        parts = zip(self._all, robots.values(), episodes, strict=True)
        self._all = [replace(m, situation=replace(first, episode=e, agent=r)) for m, r, e in parts]
        if world.equipment is not None:
            for number in range(1, len(robots)):
                nozzle = NozzleState.allocate(sizes, world.device)
                episode.others[f"nozzle_{number}"] = nozzle
                world.jets.append(nozzle.jet)
            world.equipment.hands = [(jet, m.world.held) for jet, m in zip(world.jets, self._all, strict=True)]
            for jet, member in zip(world.jets, self._all, strict=True):
                member.world.jets = [jet]

    def __len__(self) -> int:
        """Number of robots."""
        return len(self._all)

    def __iter__(self) -> Iterator[Member]:
        """The robots, in order."""
        return iter(self._all)

    def __getitem__(self, number: int) -> Member:
        """The robot `number`, from 0. Raises IndexError where there is none."""
        return self._all[number]

    def see(self) -> None:
        """Copy the places and headings of all robots into their worlds; the episode has those of the first."""
        for member in self._all:
            member.situation.episode.see(member.agent)

    def yield_to_hazards(self) -> None:
        """Let hazards slow all robots and keep them out of fire; call it after actions are set, before physics steps.

        Those that lie on the ground do not drive.
        """
        for member in self._all:
            episode, robot = member.situation.episode, member.agent
            down = episode.lying()
            if down is not None and not none_set(down):
                robot.lie(down)
            robot.carry(episode.slowed)
            robot.keep_out(episode.forbidden)

    def told(self) -> dict[str, Tensor]:
        """The entries of `info` about each robot, [E] each, in the units that hazards declare [-].

        In a team their names begin with that of the robot.
        """
        if len(self) == 1:
            return rewards.told(self._all[0].situation)
        return {f"{m.name}-{name}": value for m in self._all for name, value in rewards.told(m.situation).items()}

    def joints(self) -> Tensor:
        """Positions of all joints of all robots [rad] or [m], [E, J]."""
        every: list[Any] = [member.agent for member in self._all]
        return every[0].robot.get_qpos() if len(self) == 1 else torch.cat([a.robot.get_qpos() for a in every], dim=1)

    def use_hands(self, dt: float) -> None:
        """Let all hands take, lead doors, carry and let go, and record rescues, after a frame of `dt` seconds."""
        grips = [(*member.agent.gripper_pose(), member.agent.grip_closed()) for member in self._all]
        if len(self) == 1:
            (*gripper, closed), first = grips[0], self._all[0]
            grasp.lead_doors(first.hand, first.world, gripper[0], closed, dt)
            self._episode.use_hand((gripper[0], gripper[1]), closed, first.agent.bag_position)
            return
        drops = []
        for member, (place, turn, closed) in zip(self._all, grips, strict=True):
            if none_set(closed != member.hand.closed):
                drops.append(torch.full_like(member.hand.held, -1))  # nothing is taken or let go
                continue
            others = self._episode.world.held & ~member.world.held
            drops.append(grasp.update(member.hand, member.world, place, turn, closed, others))
            self._gather()
        for member, grip, dropped in zip(self._all, grips, drops, strict=True):
            self._episode.put_away(Drop(dropped, grip[0], member.agent.bag_position))
        self._episode.keep(lambda: self._places([(place, turn) for place, turn, _ in grips]))

    def resume(self, rows: Tensor) -> None:
        """Go on from records that were restored in the environments `rows` [R]."""
        self.see()
        grips = [member.agent.gripper_pose() for member in self._all]
        if len(self) == 1:
            self._episode.freeze(grips[0])
            return
        index = torch.arange(self._episode.world.num_bodies, device=rows.device)
        for member in self._all:
            member.world.held[rows] = index == member.hand.held[rows][:, None]
        self._gather()
        self._episode.keep(lambda: self._places(grips))

    def begin(self, rows: Tensor) -> None:
        """Empty the hands in the environments `rows` [R]."""
        for member in self._all:
            member.world.held[rows] = False

    def _gather(self) -> None:
        """Tell the world that all share what is in any hand."""
        self._episode.world.held[:] = torch.stack([member.world.held for member in self._all]).any(0)

    def _places(self, grips: list[tuple[Tensor, Tensor]]) -> tuple[Tensor, Tensor, Tensor]:
        """As `grasp.places`, with what each hand holds at that hand; `grips`: positions [m], [E, 3], and rotations."""
        frozen, base, turn = grasp.places(self._all[0].hand, self._all[0].world, *grips[0])
        for member, grip in zip(self._all[1:], grips[1:], strict=True):
            _, own, own_turn = grasp.places(member.hand, member.world, *grip)
            held = member.world.held[..., None]
            base, turn = torch.where(held, own, base), torch.where(held, own_turn, turn)
            frozen = frozen | member.world.held
        return frozen, base, turn


def _own(episode: Episode, hand: Hand, number: int) -> Episode:
    """The same `episode` with place, heading, build and `hand` of the robot `number`; all else is shared."""
    made, world, crew = copy.copy(episode), copy.copy(episode.world), episode.world.crew
    world.team, world.agent_build = replace(crew, number=number), crew.builds[number]
    world.agent_position, world.held = crew.places[:, number], world.held.clone()
    if number:  # the episode has that of the first robot
        world.agent_heading = world.agent_heading.clone()
    made.world, made.hand = world, hand
    return made
