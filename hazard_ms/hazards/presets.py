"""The presets of physics: one code path, different numbers (physics.md 0 and 1.5).

paper    the equations of the paper; constants from the original's code where the text gives none
shipped  what the original's code does, for comparison with published scores; its things weigh 1 kg, which is for the scenes to say
realistic  published engineering laws and material data, SI units and seconds, true masses
"""

from __future__ import annotations

from collections.abc import Callable

from hazard_ms.hazards.base import Hazard
from hazard_ms.hazards.blaze import Blaze
from hazard_ms.hazards.fire import Fire
from hazard_ms.hazards.flood import Flood
from hazard_ms.hazards.water import Water
from hazard_ms.hazards.wind import Wind

FREQUENCIES = {  # frames and physics steps per second: a frame is one env step
    "paper": (30, 120),
    "shipped": (100, 100),  # 0.01 s a frame, one physics step each [physics.md 0.1]
    "realistic": (30, 120),
}
PRESETS = tuple(FREQUENCIES)

_FIRE: dict[str, Fire | Blaze] = {
    "paper": Fire(),
    "shipped": Fire(nearest=0.1, strict=True, embers=True, image_room_weight=0.36787944, fixtures_block=False),  # e^-1
    "realistic": Blaze(),
}

_WIND = {
    "paper": Wind(),
    "shipped": Wind(  # an impulse per 0.01 s [physics.md 0.1]
        scale=1.0, gain=100.0, implicit=False, projected=False, fixed_length=False, sweeps_agent=11.18
    ),
    "realistic": Wind(
        scale=4.8,  # 12 to 24 m/s at 10 m: Beaufort 6 to 9 [physics.md 4.4]
        gain=1.0,
        crossflow=True,
        turbulence=0.0,
        torque=0.0,
        resistances=False,
        shaped=True,
        pressure=True,
        roughness=0.03,  # open ground [physics.md 3.3]
        gust_intensity=0.172,  # 1 / ln(10 m / 0.03 m)
        sheltered=True,
        sweeps_agent=39.7,  # 115 kg, friction 0.6, Cd A 0.7 m^2 [physics.md 3.2, 3.3]
    ),
}

_FLOOD = {
    "paper": Flood(),
    "shipped": Flood(gain=1.0, slabs=True, spares_waterproof=False, damage_fraction=0.0),
    "realistic": Flood(
        rise_rate=0.03,  # 1 cm in 10 frames of 1/30 s: an open front door with 0.5 m of water outside [physics.md 3.2]
        current=0.5724341,  # of the front: rise_rate / tan(slope) [m/s]
        gain=1.0,
        water=Water(added_mass=0.5),  # sphere 0.5, cube 0.67 [physics.md 3.2]
        drag_coefficient=0.0,
        damage_time=1.0,
        electronic_time=0.1,
        soaks=True,
        least_grip=0.0,
    ),
}


def fire(preset: str) -> Fire | Blaze:
    """The fire of `preset`."""
    return _FIRE[known(preset)]


def flood(preset: str) -> Flood:
    """The flood of `preset`, `realistic` among them: SI units and seconds, soaking, an agent that can be carried off."""
    return _FLOOD[known(preset, tuple(_FLOOD))]


def wind(preset: str) -> Wind:
    """The wind of `preset`."""
    return _WIND[known(preset, tuple(_WIND))]


def known(preset: str, presets: tuple[str, ...] = PRESETS) -> str:
    """`preset` itself; ValueError unless it is one of `presets`."""
    if preset not in presets:
        raise ValueError(f"no preset of physics is called {preset!r}; there are {', '.join(presets)}")
    return preset


HAZARDS: dict[str, Callable[[str], Hazard]] = {"fire": fire, "flood": flood, "wind": wind}  # every hazard by name: preset -> hazard
