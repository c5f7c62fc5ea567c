"""Wind that turns: a gust front crosses the scene, behind which it blows harder and from elsewhere.

At a place that the front passed s seconds ago the air is

    (1 - a) first + a (1 - b) middle + a b last,   a = clamp(s / rise),  b = clamp((s - rise) / turning)

a mean of three steady winds, each with its own lee. The second and the third are as fast as the scene's wind, the first
is slower. They blow half of the turn and all of it away from the first. Forces are means with the same shares, so what
holds for each wind holds for them: none makes a thing faster than the air. The front is a straight line that moves as
the wind right behind it blows.

Turn    45 to 180 degrees, either way. A wind shift is one of 45 degrees or more in less than 15 minutes [FMH-1]; winds
        of downbursts turn up to right round [Iwashita & Kobayashi 2019]
Speed   twice that before the front: a squall is a rise by 8 m/s at least, to 11 m/s or more [WMO-No. 182]
Pace    the wind behind the front over 1.44, the median of 943 fronts [Sherburn, Bunkers & Mose 2021]
Times   rise and turning are those of a passage within a minute, in an episode of 100 s [ours]

Carts can be pushed, but feel no wind, as in the steady wind (docs/physics.md 1.3.1). Limits: no lift at the nose of the
front, no rain.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any, ClassVar

import torch
from torch import Tensor

from hazard_ms.hazards.base import Push, State, none_set
from hazard_ms.hazards.places import SETTLING, follow, strayed
from hazard_ms.hazards.wind import endurance, kernels, shelter
from hazard_ms.hazards.wind.gale_state import GaleState
from hazard_ms.hazards.wind.sweeping import sweeping_speed
from hazard_ms.hazards.wind.wind import Wind
from hazard_ms.hazards.wind.wind_state import WindState
from hazard_ms.simulation.containers import CATEGORY, container_index
from hazard_ms.simulation.kernels.bodies import Bodies
from hazard_ms.simulation.world import World
from hazard_ms.spec import SceneSpec, rounding

WINDS = {"first": 0.0, "middle": 0.5, "last": 1.0}  # the three winds, and their shares of the turn
TURN = math.pi / 4.0, math.pi  # least and most that the wind turns by [rad] [FMH-1; Iwashita & Kobayashi 2019]
GUST_RATIO = 1.44  # wind behind a front over the speed of the front [-] [Sherburn, Bunkers & Mose 2021]
AIR = ("heading", "speed", "loss", "cause")  # what differs between the winds
SHARED = ("gust", "corner", "felt", "strength", "sway", "twist", "settled")


@dataclass(frozen=True)
class Gale(Wind):
    """A wind with a gust front; the defaults are those of the preset `paper`."""

    state_type: ClassVar[type[State]] = GaleState

    sheltered: bool = True
    before: float = 0.5  # wind before the front over that behind it [-] [WMO-No. 182]
    earliest: float = 25.0  # when the front passes the middle of the scene [s] [ours: from a quarter of an episode on]
    latest: float = 50.0  # [s] [ours: to its half]
    rise: float = 3.0  # time in which the wind rises as the front passes [s] [ours]
    turning: float = 40.0  # time in which it then turns on [s] [ours]

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("before", "rise", "turning"):
            if not 0 < getattr(self, name) < math.inf:
                raise ValueError(f"{name} must be a positive number, got {getattr(self, name)}")
        if not 0 <= self.earliest <= self.latest < math.inf:
            raise ValueError(f"earliest must be from 0 to latest, {self.latest}, got {self.earliest}")

    def withstands(self, category: str) -> tuple[float, ...]:
        return endurance.of_models(self, category)

    def loosens(self, spec: SceneSpec) -> frozenset[str]:
        return frozenset(f.name for f in spec.fixtures if f.category == CATEGORY)

    def loose(self, state: WindState, world: World) -> Tensor:
        carts = torch.zeros_like(world.floats)
        index = container_index(world)
        return carts.scatter_(1, index.clamp(min=0), index >= 0) & world.floats

    def reset(self, state: GaleState, world: World, rows: Tensor) -> None:  # type: ignore[override]
        super().reset(state, world, rows)
        draw = world.chance.uniform("wind.front", 3)[rows]
        turn = (TURN[0] + (TURN[1] - TURN[0]) * draw[:, 0]) * torch.where(draw[:, 1] < 0.5, -1.0, 1.0)
        state.onset[rows] = self.earliest + (self.latest - self.earliest) * draw[:, 2]
        scene, fast = state.heading[rows], state.speed[rows]
        obstacles = shelter.height_map(world, rows, (state.loss.shape[1], state.loss.shape[2]))
        for name, share in WINDS.items():
            heading = turned(scene, share * turn)
            loss, cause = shelter.lee(world, *obstacles, heading)
            made = heading, fast * (self.before if name == "first" else 1.0), loss, cause
            for part, value in zip(AIR, made, strict=True):
                getattr(state, f"{name}_{part}")[rows] = value
        state.way[rows] = state.middle_heading[rows]
        state.pace[rows] = fast / GUST_RATIO
        state.place[rows], state.rested[rows] = world.position[rows], SETTLING
        self._show(state, world)

    @torch.inference_mode()
    def force(self, state: GaleState, world: World, dt: float) -> Push:  # type: ignore[override]
        shares = self.shares(state, world, world.position)
        force, torque = torch.zeros_like(world.position), torch.zeros_like(world.position)
        made = world.launches.results(kernels.push, force, torque)
        for share, wind in zip(shares.unbind(-1), WINDS, strict=True):
            if none_set(share > 0.0):
                continue
            air, bodies = self._air(wind_of(state, wind), world), world.launches.struct(Bodies, world)
            world.launches.run(kernels.push, tuple(world.exists.shape), dt, *air, bodies, *made)
            force += share[..., None] * made[0]
            torque += share[..., None] * made[1]
        return Push(force, torque)

    @torch.inference_mode()
    def advance(self, state: GaleState, world: World, dt: float) -> None:  # type: ignore[override]
        super().advance(state, world, dt)
        state.time += dt
        self._show(state, world)
        state.blown += state.speed[:, None] * state.heading * dt
        follow(state.place, state.rested, world, dt)

    def shares(self, state: GaleState, world: World, points: Tensor) -> Tensor:
        """Shares of the three winds at `points` [m], [E, P, 3], world frame: [E, P, 3], with the sum 1."""
        ahead = ((points[..., :2] - 0.5 * world.room[:, None]) * state.way[:, None]).sum(-1)
        since = (state.time - state.onset)[:, None] - ahead / state.pace[:, None]
        risen = (since / self.rise).clamp(0.0, 1.0)
        turned_on = ((since - self.rise) / self.turning).clamp(0.0, 1.0)
        return torch.stack([1.0 - risen, risen * (1.0 - turned_on), risen * turned_on], -1)

    def _show(self, state: GaleState, world: World) -> None:
        """Write the air in the middle of the scene where WindState has it; its lee is that of the main wind."""
        middle = torch.cat([0.5 * world.room, torch.zeros_like(world.room[:, :1])], 1)[:, None]
        share = self.shares(state, world, middle)[:, 0]
        flows = [wind_of(state, name).heading * wind_of(state, name).speed[:, None] for name in WINDS]
        flow = sum((share[:, k, None] * flow for k, flow in enumerate(flows)), torch.zeros_like(state.way))
        speed = flow.norm(dim=-1)
        state.heading.copy_(torch.where(speed[:, None] > 0.0, flow / speed[:, None].clamp(min=1e-9), state.way))
        state.speed.copy_(speed)
        reached = self.shares(state, world, corners(world))[..., 0].amin(1) <= 0.0
        state.lifted.copy_(torch.where(reached, state.last_speed, state.first_speed))
        main = share.argmax(-1)[:, None, None]
        for part in ("loss", "cause"):
            parts = [getattr(state, f"{name}_{part}") for name in WINDS]
            getattr(state, part).copy_(torch.where(main == 0, parts[0], torch.where(main == 1, parts[1], parts[2])))

    def velocity_at(self, state: GaleState, world: World, points: Tensor) -> Tensor:  # type: ignore[override]
        shares = self.shares(state, world, points.expand(world.num_envs, -1, -1))
        found = torch.zeros(*shares.shape[:2], 2, dtype=points.dtype, device=points.device)
        for share, name in zip(shares.unbind(-1), WINDS, strict=True):
            if not none_set(share > 0.0):
                wind = wind_of(state, name)
                speed = super().speed_at(wind, world, points)
                found += (share * speed)[..., None] * wind.heading[:, None]
        return found

    def speed_at(self, state: GaleState, world: World, points: Tensor) -> Tensor:  # type: ignore[override]
        return self.velocity_at(state, world, points).norm(dim=-1)

    def slow(self, state: GaleState, world: World) -> Tensor:  # type: ignore[override]
        flow = self.velocity_at(state, world, self._chest(world))[:, 0]
        speed = flow.norm(dim=-1, keepdim=True)
        swept = self.sweeping_share * sweeping_speed(world.robot)
        kept = (1.0 - (speed / swept).square()).clamp(min=0.0)
        drift = (1.0 - kept) * speed
        if self.topples:
            kept, drift = torch.where(world.crew.own(state.lies)[:, None], 0.0, kept), (speed - swept).clamp(min=0.0)
        return torch.cat([kept, drift * flow / speed.clamp(min=1e-9)], 1)

    def carried_off(self, state: GaleState, world: World) -> Tensor:
        """Things that are no longer where they were put, and neither safe nor in a hand: bool [E, B]."""
        return strayed(state.place, world) & world.exists & ~world.safe & ~world.held


def corners(world: World) -> Tensor:
    """Corners of all that the wind can reach [m], [E, 4, 3], world frame."""
    beyond = world.room.new_tensor([[s.room.beyond] for s in world.specs])
    low, high = -beyond, world.room + beyond
    x, y = (torch.cat([low, high[:, axis, None]], 1) for axis in (0, 1))
    return torch.stack([x[:, (0, 0, 1, 1)], y[:, (0, 1, 0, 1)], torch.zeros_like(world.room).repeat(1, 2)], -1)


def wind_of(state: GaleState, name: str) -> Any:
    """The fields of WindState that tell of the air, for the wind called `name` in WINDS; they share its memory."""
    own = {part: getattr(state, f"{name}_{part}") for part in AIR}
    return SimpleNamespace(**own, **{part: getattr(state, part) for part in SHARED})


def turned(heading: Tensor, angle: Tensor) -> Tensor:
    """Unit vectors `heading`, [R, 2], turned by `angle` [rad], [R], anticlockwise."""
    c, s = rounding.cos(angle), rounding.sin(angle)
    x, y = heading.unbind(-1)
    return torch.stack([c * x - s * y, s * x + c * y], -1)
