"""The presets of physics: one code path, different numbers (docs/physics.md 0 and 1.5).

paper    the equations of the paper; constants from the original's code where the text gives none
shipped  what the original's code does, for comparison with published scores; its things weigh 1 kg, which is for the
         scenes to say
realistic  published engineering laws and material data, SI units and seconds, true masses
"""

from __future__ import annotations

import dataclasses
import inspect
from typing import Any

from hazard_ms.hazards.base import Hazard
from hazard_ms.hazards.fire.fire import Fire
from hazard_ms.hazards.fire.realistic.blaze import Blaze
from hazard_ms.hazards.flood.flood import Flood
from hazard_ms.hazards.flood.realistic.inundation import Inundation
from hazard_ms.hazards.flood.water import Water
from hazard_ms.hazards.wind.gale import Gale
from hazard_ms.hazards.wind.wind import Wind
from hazard_ms.spec.registry import HAZARDS, find, load
from hazard_ms.spec.severity import MIDDLE, SCALED, SEVERITIES, USUAL, chosen

FREQUENCIES = {  # frames and physics steps per second: a frame is one env step
    "paper": (30, 120),
    "shipped": (100, 100),  # 0.01 s a frame, one physics step each [docs/physics.md 0.1]
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
    "shipped": Wind(  # an impulse per 0.01 s [docs/physics.md 0.1]
        scale=1.0, gain=100.0, implicit=False, projected=False, fixed_length=False, sweeping_share=0.2813746
    ),
    "realistic": Wind(
        by_split=True,
        gain=1.0,
        crossflow=True,
        turbulence=0.0,
        torque=0.0,
        resistances=False,
        shaped=True,
        pressure=True,
        roughness=0.03,  # open ground [docs/physics.md 3.3]
        pavement=0.001,  # asphalt [docs/physics.md 3.3]
        lift=0.4,  # suction of 0.7 above less 0.3 below [docs/physics.md 3.3]
        plates=True,
        gust_intensity=0.172,  # 1 / ln(10 m / 0.03 m)
        sheltered=True,
        topples=True,
        breaks=True,
        sweeping_share=1.0,  # the agent drifts at the speed at which its robot really slides [docs/physics.md 3.3]
    ),
}

_FLOOD: dict[str, Flood | Inundation] = {
    "paper": Flood(),
    "shipped": Flood(gain=1.0, slabs=True, spares_waterproof=False, damage_fraction=0.0),
    "realistic": Inundation(
        water=Water(added_mass=0.5),  # sphere 0.5, cube 0.67 [docs/physics.md 3.2]
        drag_coefficient=0.0,
        damage_time=1.0,
        electronic_time=0.1,
        soaks=True,
        least_grip=0.0,
    ),
}


def fire(preset: str, severity: str = USUAL) -> Fire | Blaze:
    """The fire of `preset`, as severe as `severity` says. Raises ValueError for an unknown one of both."""
    law, level = _FIRE[known(preset)], SEVERITIES[chosen(severity, preset)]
    if not isinstance(law, Blaze):
        return law
    law = dataclasses.replace(law, growth=level.fire_growth, first_release=level.fire_start)
    return dataclasses.replace(law, first_base=level.fire_base, first_height=level.fire_height)


def flood(preset: str, severity: str = USUAL) -> Flood:
    """The flood of `preset`, as severe as `severity` says. Raises ValueError for an unknown one of both."""
    law, level = _FLOOD[known(preset, tuple(_FLOOD))], SEVERITIES[chosen(severity, preset)]
    return dataclasses.replace(law, outside=level.flood_outside) if isinstance(law, Inundation) else law


def wind(preset: str, severity: str = USUAL) -> Wind:
    """The wind of `preset`, as severe as `severity` says. Raises ValueError for an unknown one of both."""
    law, level = _WIND[known(preset, tuple(_WIND))], SEVERITIES[chosen(severity, preset)]
    if preset != SCALED:
        return law
    return dataclasses.replace(law, scale=level.wind / MIDDLE)


def gale(preset: str, severity: str = USUAL) -> Gale:
    """The wind of `preset`, as severe as `severity` says, with a gust front. Raises ValueError as `wind` does.

    A frame of `shipped` is 0.3 of that of the others, and so are the times of its front.
    """
    calm = wind(preset, severity)
    steady = {field.name: getattr(calm, field.name) for field in dataclasses.fields(calm)} | {"sheltered": True}
    if preset != "shipped":
        return Gale(**steady)
    usual = Gale()
    return Gale(**steady, **{n: 0.3 * getattr(usual, n) for n in ("earliest", "latest", "rise", "turning")})


def known(preset: str, presets: tuple[str, ...] = PRESETS) -> str:
    """The name of a preset, if it is one of `presets`. Raises ValueError for others."""
    if preset not in presets:
        raise ValueError(f"physics must be one of {', '.join(presets)}, got {preset!r}")
    return preset


def hazard(name: str, preset: str, severity: str = USUAL) -> Hazard:
    """The registered hazard called `name` with the parameters of `preset`, as severe as `severity` says.

    Raises ValueError for an unknown one, and for a severity that the hazard does not have.
    """
    maker = load(find(HAZARDS, name, "hazard").maker)
    made = maker(preset, **severity_for(maker, name, preset, severity))
    if not isinstance(made, Hazard):
        raise ValueError(f"the maker of {name!r} must return a Hazard, got {type(made).__name__}")
    return made


def severity_for(maker: Any, name: str, preset: str, severity: str) -> dict[str, str]:
    """Keywords by which the `maker` of what is called `name` learns of `severity`: none for the usual one.

    Raises ValueError for a severity that the preset or the maker does not have.
    """
    if chosen(severity, preset) == USUAL:
        return {}
    if "severity" not in inspect.signature(maker).parameters:
        raise ValueError(f"severity must be {USUAL!r} for {name}, which has no other severity, got {severity!r}")
    return {"severity": severity}
