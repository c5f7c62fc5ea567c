"""Rooms and things in numbers, as a realistic fire needs them: set at reset (torch)."""

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import Tensor

from hazard_ms.hazards.fire.realistic import burning, fuels
from hazard_ms.hazards.fire.realistic.blaze_state import BlazeState
from hazard_ms.hazards.fire.realistic.radiation import AIR, KELVIN
from hazard_ms.hazards.fire.realistic.twozone import leaves, lining, rooms
from hazard_ms.simulation.openings import all_openings
from hazard_ms.simulation.world import World
from hazard_ms.spec.catalogue import CATEGORIES


def describe_rooms(state: BlazeState, world: World, rows: Tensor, room: float) -> None:
    """Set what the fire needs of the rooms of the environments `rows`, [R]: floor, height [m], gaps and ceiling.

    They are full of air of `room` [C].
    """
    specs = [world.specs[row] for row in rows.tolist()]
    floors = [fuels.FLOORS.get(s.room.floor, fuels.BARE) for s in specs]
    for name in ("ignition", "critical", "inertia"):
        getattr(state, f"floor_{name}")[rows] = torch.tensor([getattr(f, name) for f in floors], device=world.device)
    state.height[rows] = torch.tensor([s.room.height for s in specs], device=world.device)
    state.smoke_height[rows] = state.height[rows, None]
    state.zone_height[rows] = state.height[rows, None]
    state.roofed[rows] = torch.tensor([float(not s.room.open_air) for s in specs], device=world.device)
    state.zone_columns[rows] = torch.tensor([len(rooms.ends(s.room, 0)) for s in specs], device=world.device)
    for axis, name in enumerate(("zone_end_x", "zone_end_y")):
        _fill(state, rows, (name,), [[(end,) for end in rooms.ends(s.room, axis)] for s in specs])
    _fill(state, rows, ("zone_area", "zone_edge"), [rooms.parts(s.room) for s in specs])
    state.zone_wall[rows] = state.zone_area[rows]
    fill_with_air(state, rows, room)
    if "water" in world.fields:
        world.openings.let_in(rows)
    state.vents[rows] = leaves.vents(world)[rows]
    _fill(state, rows, ("vent_from", "vent_to"), [rooms.joined(s.room, all_openings(s)) for s in specs])
    linings = [lining.LININGS.get(s.room.wall, lining.GYPSUM) for s in specs]
    for name in ("conductivity", "capacity", "thickness"):
        made = torch.tensor([getattr(x, name) for x in linings], device=world.device)
        getattr(state, f"lining_{name}")[rows] = made


def fill_with_air(state: BlazeState, rows: Tensor, room: float) -> None:
    """Fill the rooms of the environments `rows`, [R], with clean air of `room` [C], as warm as their walls."""
    for name in ("temperature", "low_temperature", "upper", "lower"):
        getattr(state, f"zone_{name}")[rows] = room
    state.zone_air[rows, :, 0] = state.zone_area[rows] * state.height[rows, None] * (AIR / (room + KELVIN))


def _fill(state: BlazeState, rows: Tensor, names: Sequence[str], table: Sequence[Sequence[Sequence[float]]]) -> None:
    """Write the columns of `table`, a list for each of the `rows`, into quantities; what is missing keeps its fill."""
    for column, name in enumerate(names):
        held = getattr(state, name)
        for row, entries in zip(rows.tolist(), table, strict=True):
            values = torch.tensor([entry[column] for entry in entries])
            held[row, : len(entries)] = values.to(held)


def describe_things(state: BlazeState, world: World, rows: Tensor) -> None:
    """Set how the things of the environments `rows`, [R], ignite and burn: surfaces, heat release [kW] and yields."""
    category = world.category.clamp(min=0)

    def of(attribute: str) -> Tensor:
        numbers = [float(getattr(fuels.material(c), attribute)) for c in CATEGORIES]
        return torch.tensor(numbers, device=world.device)[category]

    for name in ("ignition", "critical", "inertia", "sheet"):
        getattr(state, name)[rows] = of(name)[rows]
    state.threshold[rows] = torch.where(world.lookup("flammable") > 0, state.ignition, torch.inf)[rows]
    wide, deep, high = world.extent.unbind(-1)
    # fixtures weigh nothing on purpose
    mass = torch.where(world.movable, world.mass, world.lookup("density") * wide * deep * high)
    peak, energy = of("release") * (wide * deep + 2.0 * (wide + deep) * high), of("combustion") * mass
    measured = torch.tensor([fuels.MEASURED.get(c, (0.0, 0.0)) for c in CATEGORIES], device=world.device)[category]
    known = measured[..., 0] > 0
    peak, energy = torch.where(known, measured[..., 0], peak), torch.where(known, measured[..., 1], energy)
    made = burning.course(of("growth"), peak, energy)
    numbers = {name: k for k, name in enumerate(fuels.CURVES)}
    curve = torch.tensor([numbers.get(fuels.CURVE_OF.get(c, ""), -1) for c in CATEGORIES], device=world.device)
    state.curve[rows] = curve[category][rows]
    for name in ("growth", "peak", "decline"):
        getattr(state, name)[rows] = getattr(made, name)[rows]
    state.burn_end[rows] = torch.where(state.curve >= 0, burning.lasting(state.curve), made.end)[rows]
    table = torch.tensor([fuels.material(c).yields for c in CATEGORIES], device=world.device)
    state.yields[rows] = table[category][rows]
