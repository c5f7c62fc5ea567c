"""The curves on the page of `hazard-ms validate`: results of the code, and points of exact or published solutions."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import torch

from hazard_ms.hazards.base import begin
from hazard_ms.hazards.fire.realistic import burning, fuels
from hazard_ms.validation import blaze_cases, correlations, fire_cases, flood_cases
from hazard_ms.validation.charts import Chart, Line
from hazard_ms.validation.experiments import fire, flood, smoke_room, wind
from hazard_ms.validation.experiments.blaze import PLAIN
from hazard_ms.validation.experiments.fire_room import room_world


def fire_charts() -> Iterator[Chart]:
    """The curves of both fires."""
    apart = sorted(fire_cases.F1)
    code = Line("shipped preset", apart, [fire.equilibrium(fire.SHIPPED, d) for d in apart])
    table = Line("table of the original (F-1)", apart, [fire_cases.F1[d] for d in apart], points=True)
    yield Chart("fire_equilibrium", "Temperature beside one flame in the end", "distance [m]", "C", (code, table))
    age = torch.arange(0.0, 1200.0, 2.0)
    names = ("upholstered_chair", "sofa", "wardrobe", "mattress", "tv")
    rows = [list(fuels.CURVES).index(n) for n in names]
    lines = (
        Line(n.replace("_", " "), age.tolist(), burning.measured(torch.full(age.shape, r), age).tolist())
        for n, r in zip(names, rows, strict=True)
    )
    yield Chart("fire_release", "Heat release of furniture", "time since ignition [s]", "kW", tuple(lines))
    times = tuple(float(t) for t in range(1, 31))
    hall = smoke_room.Burner(410.0, smoke_room.HALL, smoke_room.SLOT, smoke_room.INSULATED, 0.0, 22.0, step=0.05)
    depth = [smoke_room.HALL[2] - seen.height for seen in smoke_room.course(hall, times).values()]
    guide = Line("FDS Correlation Guide", (10, 20, 30), (0.35, 0.65, 0.93), points=True)
    zone = Line("this code", (0, *times), (0.0, *depth))
    yield Chart("fire_layer", "Depth of the smoke layer, 410 kW in a hall (N-7)", "time [s]", "m", (zone, guide))
    yield _layers()
    yield _room()


def _layers() -> Chart:
    """Temperature of the layer in a room with an open door, against MQH."""
    times, lines = tuple(range(30, 601, 15)), []
    door = (smoke_room.DOOR[0], smoke_room.DOOR[2])
    for power in blaze_cases.POWERS:
        made = [seen.rise for seen in smoke_room.course(smoke_room.Burner(power), times).values()]
        lines.append(Line(f"{power:.0f} kW", times, made))
        other = [correlations.mqh(power, smoke_room.DWELLING, door, blaze_cases.BOARD, t) for t in times[::3]]
        lines.append(Line(f"MQH {power:.0f} kW", times[::3], other, points=True))
    title = "Rise of the layer's temperature, 6.8 x 6.4 x 2.6 m, gypsum board, door open"
    return Chart("fire_rooms", title, "time [s]", "K", tuple(lines))


def _room() -> Chart:
    """A room with a sofa 0.5 m from a burning waste basket: height and temperature of the smoke, and heat release."""
    blaze = PLAIN
    world = room_world(
        [("sofa", (2.5, 2.0, 0.0))], [(2.0, 2.0)], size=(5.0, 4.0), agent=(4.5, 3.5), extent=(0.9, 0.8, 0.8)
    )
    state = begin(blaze, world)
    seen = []
    for step in range(1200):
        world.chance.tick()
        blaze.advance(state, world, 0.5)
        seen.append(
            (
                step / 2,
                float(state.smoke_height),
                float(state.smoke_temperature) / 100,
                float(state.heat_release) / 1000,
            )
        )
    t, height, warmth, power = (list(v) for v in zip(*seen, strict=True))
    lines = (
        Line("smoke height [m]", t, height),
        Line("smoke temperature [100 C]", t, warmth),
        Line("heat release [MW]", t, power),
    )
    return Chart("fire_room", "A sofa 0.5 m from a burning waste basket, 5 x 4 m, doors closed", "time [s]", "", lines)


def flood_charts() -> Iterator[Chart]:
    """The curves of floods."""
    seen = flood.heaving()
    t = (np.arange(len(seen[0.5])) * 0.01).tolist()
    lines = tuple(Line(f"s = {s}", t, (100 * z).tolist()) for s, z in seen.items())
    yield Chart(
        "flood_heave", "Heaving of boxes released 1 cm off their level, in SAPIEN (L-13)", "time [s]", "cm", lines
    )
    fine = np.linspace(0.0, 1.0, 101)
    exact = Line("v tanh(g' t / v)", fine.tolist(), [1.3670 * math.tanh(4.905 * x / 1.3670) for x in fine])
    made = flood.sinking()
    body = Line("SAPIEN", list(made), [v for v, _ in made.values()], points=True)
    yield Chart("flood_sinking", "Sinking of a cube of 2000 kg/m3 (L-15)", "time [s]", "m/s", (exact, body))
    angles = sorted(flood_cases.ARMS)
    beam, upright = (0.2, 0.3, 0.1), (0.0, 1.0, 0.0)
    code = [1000 * abs(float(flood.wet(beam, upright, a, 0.0).arm[0, 0])) for a in range(0, 27)]
    table = Line("wall-sided formula", angles, [1000 * flood_cases.ARMS[a] for a in angles], points=True)
    yield Chart(
        "flood_righting",
        "Righting arm of a beam (L-22)",
        "angle [degrees]",
        "mm",
        (Line("this code", list(range(27)), code), table),
    )


def wind_charts() -> Iterator[Chart]:
    """The curves of wind."""
    fine = np.linspace(0.0, 10.0, 101)
    exact = Line("U - U / (1 + k U t)", fine.tolist(), [3.7 - 3.7 / (1 + 0.147 * 3.7 * x) for x in fine])
    made = wind.carried(wind.LAW)
    body = Line("SAPIEN", list(made), [v for v, _ in made.values()], points=True)
    yield Chart("wind_free", "A free body in a wind of 3.7 m/s (W-1)", "time [s]", "m/s", (exact, body))
    gusts = wind.gusty(5.0, 0.2)[:600, :2]
    t = (np.arange(600) * 0.2).tolist()
    yield Chart(
        "wind_gusts",
        "Gusts of intensity 0.2 (W-20)",
        "time [s]",
        "u / U",
        tuple(Line(f"street {k}", t, gusts[:, k].tolist()) for k in range(2)),
    )
