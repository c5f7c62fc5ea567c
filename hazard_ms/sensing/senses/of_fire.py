"""The signals of fires that sensors notice: hot things, floors and walls, flames, and the smoke of a realistic fire.

Flames are upright cylinders. In `realistic` they are as wide as their fires and as long as Heskestad's law says
(hazard_ms.hazards.fire.realistic.radiation); in `paper` and `shipped`, which have none, as large as pictures draw them.
Smoke lies in two zones in each room of a row, so its optical depth along a line is a sum of lengths, and exact.
"""

from __future__ import annotations

from typing import NamedTuple

import torch
from torch import Tensor

from hazard_ms.hazards.fire import spread
from hazard_ms.hazards.fire.fire import body_flames, floor_flames
from hazard_ms.hazards.fire.fire_state import FireState
from hazard_ms.hazards.fire.realistic import burners, radiation, smoke
from hazard_ms.hazards.fire.realistic.blaze_state import BlazeState
from hazard_ms.hazards.fire.realistic.twozone.zones import SIGHT, SOOT_ABSORPTION, SOOT_DENSITY
from hazard_ms.sensing.camera import STRUCTURE
from hazard_ms.sensing.senses.planck import SECOND, WAVELENGTH
from hazard_ms.sensing.senses.signals import Flames, Murk, Signals
from hazard_ms.simulation.world import World

DRAWN_HEIGHT = 0.58  # of a grown flame of `paper` as pictures draw it: 1.7 edges of a patch of 0.34 m [m]
ON_FLOOR = 0.05  # height up to which a surface is floor [m] [ours]
SMOKE_COLOUR = (0.045, 0.042, 0.040)  # light that smoke scatters, as in the shaders of pictures [ours]
# Soot is far smaller than the wavelength, so it absorbs as c f / wavelength, f its share of the volume. The mean over
# Planck's law, 3.83 (c / SECOND) f T [M: SFPE, radiation], is SOOT_ABSORPTION f T here, which gives c. Of the
# extinction in visible light, SIGHT SOOT_DENSITY f, this share is left in thermal infrared, about 3 %.
INFRARED = SOOT_ABSORPTION * SECOND / 3.83 / WAVELENGTH / (SIGHT * SOOT_DENSITY)
SMALL = 1e-6  # least value of a divisor, in its own unit


class FireSignals(Signals):
    """The signals of the fires of `paper` and `shipped`, where air and structure have the temperature of the image."""

    def warmth(self, state: FireState, world: World, labels: Tensor, points: Tensor) -> Tensor:
        """Temperature of the surfaces [C], [E, P], see `Signals.warmth`."""
        return of_things(state, labels, self.hazard.image(state, world, points), self.hazard.room_temperature)

    def flames(self, state: FireState, world: World) -> Flames:
        """The flames on things and on the floor, see `Signals.flames`."""
        place, scale = floor_flames(state, world.frame)
        share = scale / spread.SCALE_LAST
        base = world.base_of(world.position, world.rotation, world.extent)
        burning = body_flames(state, self.hazard.heat_every) * (world.exists & ~world.away) / spread.SCALE_LAST
        wide = world.extent[..., :2].prod(-1).sqrt()
        return Flames(
            torch.cat([base, place], 1),
            torch.cat([torch.where(burning > 0, wide, 0.0), spread.CELL * share], 1),
            torch.cat([world.extent[..., 2] + DRAWN_HEIGHT * burning, DRAWN_HEIGHT * share], 1),
            self.hazard.flame_temperature,
        )


class BlazeSignals(Signals):
    """The signals of the fire of `realistic`."""

    def warmth(self, state: BlazeState, world: World, labels: Tensor, points: Tensor) -> Tensor:
        """Temperature of the surfaces [C], [E, P], see `Signals.warmth`.

        Floors have that of their cells, walls and ceilings that of the linings of their rooms.
        """
        here = smoke.zone_of(state, points)
        high = points[..., 2] > state.zone_height.gather(1, here)
        lining = torch.where(high, state.zone_upper[..., 0].gather(1, here), state.zone_lower[..., 0].gather(1, here))
        floor = torch.where(points[..., 2] < ON_FLOOR, _cells(state, points), lining)
        return of_things(state, labels, torch.maximum(lining, floor), self.hazard.room_temperature)

    def flames(self, state: BlazeState, world: World) -> Flames:
        """The flames on things and on the floor, see `Signals.flames`."""
        law = self.hazard
        given = burners.fires(state, world, law.growth, law.first_release, law.first_base, law.radiant)
        room = torch.where(state.roofed > 0, state.height, torch.inf)[:, None]
        tall = torch.minimum(radiation.flame_length(given.power, given.diameter), room - given.place[..., 2])
        return Flames(given.place, torch.where(given.power > 0, given.diameter, 0.0), tall, law.flame_temperature)

    def murk(self, state: BlazeState, world: World, eye: Tensor, points: Tensor) -> Murk:
        """The layers of smoke and the haze below them, see `Signals.murk`."""
        ways = lengths(state, world, eye, points)
        parts = (
            (ways.above, state.zone_density, state.zone_temperature),
            (ways.below, state.zone_low_density, state.zone_low_temperature),
        )
        dims = [length * density[:, None] for length, density, _ in parts]
        depth = sum(dim.sum(-1) for dim in dims)
        warm = sum((dim * heat[:, None]).sum(-1) for dim, (_, _, heat) in zip(dims, parts, strict=True))
        assert isinstance(depth, Tensor) and isinstance(warm, Tensor)
        room = self.hazard.room_temperature
        return Murk(
            depth,
            depth,
            INFRARED * depth,
            torch.where(depth > SMALL, warm / depth.clamp(min=SMALL), room),
            SMOKE_COLOUR,
        )


def of_things(state: FireState, labels: Tensor, structure: Tensor, room: float) -> Tensor:
    """Temperatures [C], [E, P]: of things by their state, of walls and floors `structure`, else that of the `room`."""
    own = state.temperature.gather(1, labels.clamp(min=0))
    return torch.where(labels >= 0, own, torch.where(labels == STRUCTURE, structure, room))


def _cells(state: BlazeState, points: Tensor) -> Tensor:
    """Temperature [C], [E, P], of the hottest floor cell that holds each of `points` [m], [E, P, 3]; else -inf."""
    count, side = state.floor_temperature.shape[1:3]
    found = torch.full_like(points[..., 0], -torch.inf)
    for s in range(count):
        cell = ((points[..., :2] - state.anchor[:, s, None]) / spread.STEP).round().long() + side // 2
        inside = ((cell >= 0) & (cell < side)).all(-1)
        number = (cell[..., 0] * side + cell[..., 1]).clamp(0, side * side - 1)
        warm = state.floor_temperature[:, s].flatten(1).gather(1, number)
        found = torch.where(inside, torch.maximum(found, warm), found)
    return found


class Ways(NamedTuple):
    """The lengths [m] of lines of sight in the layer of smoke and in the air below it, room by room, [E, P, R]."""

    above: Tensor
    below: Tensor


def lengths(state: BlazeState, world: World, eye: Tensor, points: Tensor) -> Ways:
    """The ways from the `eye` [m], [E, 3], to `points` [m], [E, P, 3], inside the house, room by room."""
    way = points - eye[:, None]
    way = torch.where(way.abs() < SMALL, SMALL, way)
    length = way.norm(dim=-1)[..., None]
    number, columns = torch.arange(state.zone_area.shape[1], device=eye.device), state.zone_columns[:, None]
    low, high = torch.zeros_like(length), torch.ones_like(length)
    for axis, place in ((0, number % columns), (1, number // columns)):  # of each room in the grid of all, [E, R]
        ends = (state.zone_end_x, state.zone_end_y)[axis]
        begins = torch.cat([torch.full_like(ends[:, :1], -torch.inf), ends[:, :-1]], 1)
        size = world.room[:, axis, None]  # beyond the walls of the house there is no smoke
        first, last = (torch.minimum(of.gather(1, place).clamp(min=0.0), size) for of in (begins, ends))
        near, far = _cut(first[:, None], last[:, None], eye[:, None, axis, None], way[..., axis, None])
        low, high = torch.maximum(low, near), torch.minimum(high, far)
    share = (high - low).clamp(min=0.0)
    ends = torch.stack([eye[:, None, 2, None] + way[..., 2, None] * t for t in (low, high)])
    bottom, top = ends.amin(0), ends.amax(0)
    over = ((top - state.zone_height[:, None]) / (top - bottom).clamp(min=SMALL)).clamp(0.0, 1.0)
    return Ways(share * over * length, share * (1.0 - over) * length)


def _cut(first: Tensor, last: Tensor, begin: Tensor, step: Tensor) -> tuple[Tensor, Tensor]:
    """The shares, 0 to 1, of a line at which it enters and leaves what lies from `first` to `last` [m], [...].

    It runs from `begin` [m] over `step` [m], which is not 0; shapes broadcast.
    """
    ends = torch.stack(torch.broadcast_tensors((first - begin) / step, (last - begin) / step))
    return ends.amin(0).clamp(0.0, 1.0), ends.amax(0).clamp(0.0, 1.0)
