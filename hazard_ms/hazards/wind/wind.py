"""Wind as in the HAZARD challenge: a steady flow over the whole scene pushes, sways and turns every free thing.

Forces and random vectors are Warp kernels; gusts, the lee and the agent, about once a frame, are torch.

    F = F1 + r x F1,   F1 = gain rho A |s| s,   s = felt wind - velocity along the wind,   torque = F1 x r' h / 2

The felt wind is the scene's wind / (1 + resistance); r and r' are drawn anew in every frame (none in the first), h is
the height of the thing's box. The step is exact for a free body (hazard_ms.hazards.wind.air), so along the wind the
main force never makes a thing faster than the wind. Across it nothing brakes what r pushes: as in the original, the
sideways speed of a light thing is a random walk that can pass that of the wind (docs/physics.md W-15). What lies in a
cart has settled: it feels nothing, for ever. Constants: docs/physics.md 1.3; what the presets change: docs/physics.md
1.5, R9 to R13.

`realistic` is the same with c = Cd / 2 for the gain, the whole relative velocity, gusts, sheltered lees, as a torque
the pressure upwind of the centre, and the logarithmic profile, over which force and torque are integrated from a
thing's base to its top. There the new velocity is a weighted mean of the thing's own and of those of the air that
meets it, so wind alone makes no thing faster than its gusts, in any direction. Blows break fragile things, and robots
fall over. What is carried away stops at the enclosure that `Room.beyond` sets. Limits: no added mass, no mutual lee.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import ClassVar

import torch
from torch import Tensor

from hazard_ms.hazards.base import Hazard, Level, Push, State
from hazard_ms.hazards.wind import blows, breaking, gusts, kernels, shelter
from hazard_ms.hazards.wind.air import REFERENCE
from hazard_ms.hazards.wind.sweeping import sweeping_speed, toppling_speed
from hazard_ms.hazards.wind.wind_state import WindState
from hazard_ms.simulation.containers import container_index, in_containers
from hazard_ms.simulation.kernels.bodies import Bodies
from hazard_ms.simulation.kernels.draws import word
from hazard_ms.simulation.kernels.launch import of_environments
from hazard_ms.simulation.kernels.structs import Argument
from hazard_ms.simulation.world import World
from hazard_ms.spec import Quantity, rounding
from hazard_ms.spec.catalogue import IMMOVABLE
from hazard_ms.spec.severity import MIDDLE, STREETS, WINDS, usual_wind

TALL = 2.0  # height that neither a robot nor a thing to rescue exceeds [m] [ours]
CHEST = 1.0  # height at which the wind acts on the agent [m] [ours]
NEAR = 0.1  # what takes a blow within this distance of the agent has hit it [m] [ours]


@dataclass(frozen=True)
class Wind(Hazard):
    """A wind with these parameters; the defaults are those of the preset `paper`."""

    name: ClassVar[str] = "wind"
    state_type: ClassVar[type[State]] = WindState
    level: ClassVar[Level] = Level("wind", "m/s", 0.0, 6.0, "bone", (148, 157, 171), least=0.0, told_up_to=TALL)
    tells: ClassVar[dict[str, Quantity]] = {
        "agent_wind": Quantity("speed of the air at the agent's chest", "m/s", 0.0),
        "agent_fallen": Quantity("the agent lies on the ground", "", 0, 1),
        "agent_struck": Quantity("energy of the hardest blow at the agent in the last frame", "J", 0.0),
    }
    signals: ClassVar[str] = "hazard_ms.sensing.senses.of_others:WindSignals"
    fills: ClassVar[bool] = True  # with haze
    open_air: ClassVar[bool] = True
    provides: ClassVar[dict[str, str]] = {"air": "velocity_at"}

    # A frame lasts 10/3 of the original's, and walking speeds are given per frame, so the wind's is, too: the agent
    # must not meet things that are three times as fast for it. Weight does not slow down with the frames, so the gain
    # grows. With it the models of the wind tasks, at their own masses and a friction of 0.5, drift 1.25 cm per frame
    # in the mean over winds and models, as 1 kg does at 0.3 in the original (docs/physics.md W-9's law); 0.79 of them
    # move (original: 0.77), 0.32 outrun the agent (0.31). [ours]
    scale: float = 0.3  # factor on the scene's wind
    by_split: bool = False  # a scene's wind counts as its share of its split's, from two thirds to four thirds
    gain: float = 1400.0  # factor on rho A v^2 [the paper: "hand-adjusted"]
    # the exact step for a free body, else the original's explicit one, held at the flow's speed [docs/physics.md R12]
    implicit: bool = True
    # area across the flow, else x extent times z extent of the axis-aligned box [docs/physics.md R9]
    projected: bool = True
    # the whole relative velocity counts, else the part along the wind [HAZARD wind/object.py:45]
    crossflow: bool = False
    turbulence: float = 0.0866  # root mean square length of r per 0.01 s [HAZARD wind/wind_utils.py:9: 0.05 per axis]
    fixed_length: bool = True  # r has exactly this length, else it is normal [docs/physics.md R10]
    torque: float = 0.1  # standard deviation of r' per axis, per 0.01 s [HAZARD wind/wind.py:42-47]
    resistances: bool = True  # those of the catalogue count up to 10, else only those that a scene sets
    shaped: bool = False  # the catalogue's Cd / 2 is one more factor
    pressure: bool = False  # it acts upwind of the centre, so plates turn broadside on, and air slows turning
    # roughness length of the surroundings, for the logarithmic profile [m]; 0: no profile, the wind at the centre
    roughness: float = 0.0
    pavement: float = 0.0  # roughness length of what things lie on, for the lowest metre of air [m]; 0: as around
    lift: float = 0.0  # coefficient of lift of what lies on the ground in a profile, on its area seen from above
    plates: bool = False  # in a profile, air lifts flat things by their faces
    gust_intensity: float = 0.0  # standard deviation of the wind's speed over its mean, at 10 m if there is a profile
    gust_time: float = 5.0  # correlation time of gusts [s] [docs/physics.md W-20]
    sheltered: bool = False  # fixtures have a lee
    # The agent only drifts at this share of the speed at which its robot really slides, see
    # hazard_ms.hazards.wind.sweeping. With it Fetch, which slides at 39.73 m/s, drifts at 3.354 m/s: it keeps 0.8 of
    # its motion in the wind that a scene gives as 5 m/s. [ours]
    sweeping_share: float = 0.0844124
    topples: bool = False  # it throws the agent over, too
    breaks: bool = False  # blows damage things, and agents are told of those that hit them

    def __post_init__(self) -> None:
        for name in ("scale", "gain", "gust_time", "sweeping_share"):
            if not 0 < getattr(self, name) < math.inf:
                raise ValueError(f"{name} must be a positive number, got {getattr(self, name)}")
        for name in ("turbulence", "torque", "roughness", "pavement", "lift", "gust_intensity"):
            if not 0 <= getattr(self, name) < REFERENCE:
                raise ValueError(f"{name} must be at least 0 and below {REFERENCE}, got {getattr(self, name)}")
        if self.roughness and not (self.implicit and self.projected and self.crossflow):
            raise ValueError(f"roughness must be 0 without implicit, projected and crossflow, got {self.roughness}")

    @property
    def shown_level(self) -> Level:
        """Colours up to the fastest mean wind: 2 m/s in `paper`, 5 in `shipped`, more in `realistic`."""
        return replace(self.level, high=float(math.ceil(self.scale * WINDS[1])))

    def sizes(self, world: World) -> dict[str, int]:
        deep, wide = shelter.map_size(world) if self.sheltered else (1, 1)
        return {"C": container_index(world).shape[1], "Y": deep, "X": wide, "A": len(world.crew)}

    def reset(self, state: WindState, world: World, rows: Tensor) -> None:
        wind = torch.tensor([world.specs[row].wind for row in rows.tolist()], device=world.device).reshape(-1, 2)
        draw = world.chance.uniform("wind.mean", 2)[rows]
        angle, speed = 2.0 * math.pi * draw[:, 0], WINDS[0] + (WINDS[1] - WINDS[0]) * draw[:, 1]
        drawn = torch.stack([speed * rounding.cos(angle), speed * rounding.sin(angle)], -1)
        open_to_chance = (wind == 0.0).all(-1)
        wind = torch.where(open_to_chance[:, None], drawn, wind)
        strength = wind.norm(dim=-1)
        state.heading[rows] = wind / strength[:, None]
        if self.by_split:
            usual = wind.new_tensor([usual_wind(world.specs[row].split) for row in rows.tolist()])
            strength = MIDDLE * (strength / torch.where(open_to_chance, MIDDLE, usual)).clamp(*STREETS)
        state.speed[rows] = self.scale * strength
        state.gust[rows] = world.chance.normal("wind.gust")[rows] if self.gust_intensity else 0.0
        state.felt[rows] = self._felt_share(world)[rows]
        state.strength[rows] = self.gain * (0.5 * world.lookup("drag_coefficient")[rows] if self.shaped else 1.0)
        state.endurance[rows] = breaking.endurance(world)[rows]
        state.carts[rows] = container_index(world)[rows]
        if self.sheltered:
            state.corner[rows] = shelter.south_west(world)[rows]
            obstacles = shelter.height_map(world, rows, (state.loss.shape[1], state.loss.shape[2]))
            state.loss[rows], state.cause[rows] = shelter.lee(world, *obstacles, state.heading[rows])

    def _felt_share(self, world: World) -> Tensor:
        """Share of the wind that every thing feels, [E, B]: 1 / (1 + resistance), 0 if the resistance is above 10."""
        resistance = world.lookup("wind_resistance")
        if not self.resistances:
            resistance = torch.where(resistance < IMMOVABLE, 0.0, resistance)
        for e, spec in enumerate(world.specs):
            for b, body in enumerate(spec.bodies):
                if body.wind_resistance is not None:
                    resistance[e, b] = body.wind_resistance
        return torch.where(resistance > IMMOVABLE - 1, 0.0, 1.0 / (1.0 + resistance))

    def force(self, state: WindState, world: World, dt: float) -> Push:
        made = world.launches.results(kernels.push, world.position, world.position)
        world.launches.run(
            kernels.push,
            tuple(world.exists.shape),
            dt,
            *self._air(state, world),
            world.launches.struct(Bodies, world),
            *made,
        )
        return Push(*made)

    @torch.inference_mode()  # for one environment, autograd's part of every operation is a sixth of its time
    def advance(self, state: WindState, world: World, dt: float) -> None:
        state.settled.logical_or_(in_containers(world, state.carts, state.settled))
        if self.gust_intensity:
            state.gust.copy_(gusts.gust(state.gust, dt, self.gust_time, world.chance.normal("wind.gust")))
        if self.breaks:
            blown = world.launches.struct(Bodies, world), state.before, state.struck
            world.launches.run(blows.strike, tuple(world.exists.shape), dt, *self._air(state, world), *blown)
        if self.topples:
            self._topple(state, world, dt)
        if not self.turbulence and not self.torque:
            return
        scale = gusts.per_frame(dt)
        world.launches.run(
            kernels.turbulence,
            tuple(world.exists.shape),
            word("wind.turbulence"),
            scale * self.turbulence / math.sqrt(3.0),
            scale * self.torque,
            world.chance.seed,
            world.chance.frame,
            *self._air(state, world),
            world.launches.struct(Bodies, world),
        )

    def _topple(self, state: WindState, world: World, dt: float) -> None:
        """Let robots fall, lie and stand up during `dt` [s]."""
        for robot, *own in world.crew.each(state.lies, state.lain):
            speeds = toppling_speed(robot), robot.rising
            world.launches.run(kernels.topple, (world.num_envs,), dt, *speeds, CHEST, *self._air(state, world), *own)

    def _air(self, state: WindState, world: World) -> tuple[Argument, Argument]:
        """The rules and the air as kernels take them."""
        return world.launches.struct(kernels.Rules, self), world.launches.struct(kernels.Air, state)

    def speed_at(self, state: WindState, world: World, points: Tensor) -> Tensor:
        """Speed of the air along its heading [m/s] at `points` [m], [E, P, 3], world frame: [E, P]."""
        points = of_environments(points, world.num_envs)
        found = points.new_empty(points.shape[:2])
        world.launches.run(kernels.speeds, tuple(found.shape), *self._air(state, world), points, found)
        return found

    def velocity_at(self, state: WindState, world: World, points: Tensor) -> Tensor:
        """Velocity of the air x, y [m/s] at `points` [m], [E, P, 3], world frame: [E, P, 2]."""
        return self.speed_at(state, world, points)[..., None] * state.heading[:, None]

    def damaged(self, state: WindState, world: World) -> Tensor:
        """Bodies that break by a blow, [E, B], bool: none in `paper` and `shipped`, whose wind only carries off."""
        return state.struck > state.endurance if self.breaks else torch.zeros_like(world.exists)

    def image(self, state: WindState, world: World, points: Tensor) -> Tensor:
        """Speed of the air [m/s] at `points` [m], [E, P, 3], world frame, before any thing's resistance: [E, P]."""
        return self.speed_at(state, world, points).abs()

    def slow(self, state: WindState, world: World) -> Tensor:
        """Motion that is left to the agent, [E, 3]: the share of its own velocity, and a velocity x, y [m/s] to add.

        Together they are a weighted mean of its own velocity and the air's, so it is carried no faster than the wind.
        In `realistic`, friction holds it: it only slides once the wind outdoes that, at what is faster then, and what
        lies on the ground does not drive.
        """
        speed = self.speed_at(state, world, self._chest(world))
        swept = self.sweeping_share * sweeping_speed(world.robot)
        kept = (1.0 - (speed / swept).square()).clamp(min=0.0)
        drift = (1.0 - kept) * speed
        if self.topples:
            kept, drift = torch.where(world.crew.own(state.lies)[:, None], 0.0, kept), (speed - swept).clamp(min=0.0)
        return torch.cat([kept, drift * state.heading], 1)

    def fallen(self, state: WindState, world: World) -> Tensor | None:
        return world.crew.own(state.lies) if self.topples else None

    def agent_info(self, state: WindState, world: World) -> dict[str, Tensor]:
        told = {"agent_wind": self.image(state, world, self._chest(world))[:, 0]}
        if self.topples:
            told["agent_fallen"] = world.crew.own(state.lies).clone()
        if self.breaks:
            told["agent_struck"] = torch.where(breaking.at_the_agent(world, NEAR), state.struck, 0.0).amax(1)
        return told

    def _chest(self, world: World) -> Tensor:
        """Place where the wind acts on the agent [m], [E, 1, 3], world frame."""
        return (world.agent_position + world.agent_position.new_tensor([0.0, 0.0, CHEST]))[:, None]
