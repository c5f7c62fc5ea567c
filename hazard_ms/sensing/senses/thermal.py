"""A thermal camera: the temperatures that a microbolometer for firefighters would show.

    radiance    of the surface, EMISSIVITY of it its own, the rest the room's, reflected
    flames      before it: 1 - exp(-FLAME_ABSORPTION x length) of the flames' own, the rest from behind
    murk        before these, in the same way, with its optical depth in thermal infrared
    optics      blur by BLUR pixels; the detector's noise, equal in radiance for all pixels
    reading     the temperature of a black body of that radiance, within RANGE

Water hides what is under it, at the room's temperature. Limits: flames and murk are not put in the order of distance,
all surfaces have one emissivity, and nothing is mirrored but the room. The camera does not lag: microbolometers take
about 10 ms, a third of a frame.
"""

from __future__ import annotations

from typing import NamedTuple

import torch
from torch import Tensor
from torch.nn import functional

from hazard_ms.sensing.senses.planck import radiance, slope, temperature

# Cameras for firefighters (FLIR K series, data sheets): 320 x 240 pixels, 7.5 to 13 um, -20 to 650 C in low gain
COLUMNS = 320  # most pixels along the longer side; larger pictures repeat them
RANGE = (-20.0, 650.0)  # [C]
NOISE = 0.25  # equivalent temperature difference at NOISE_AT in low gain [K] [ours: high gain has 0.03 to 0.05]
NOISE_AT = 30.0  # [C], where data sheets tell it
BLUR = 0.7  # standard deviation of the optics' point spread [pixels] [ours: diffraction at f/1.2 alone gives 0.3]
EMISSIVITY = 0.95  # of all surfaces [-] [ours: paint, wood, cloth and plastic have 0.90 to 0.97]
FLAME_ABSORPTION = 1.13  # of burning furniture [1/m] [M: Drysdale, table 2.10]
KERNEL = 3  # pixels on each side that the blur reaches [ours]


class Heat(NamedTuple):
    """The heat before a thermal camera, pixel by pixel, [E, P]."""

    surface: Tensor  # temperature [C]
    flame_way: Tensor  # length of the line of sight in flames [m]
    flame: float  # their temperature [C]
    dims: Tensor  # optical depth of smoke and the like in thermal infrared [-]
    murk: Tensor  # its temperature [C]
    room: float  # temperature of what surfaces reflect [C]


def stride(height: int, width: int) -> int:
    """Pixels of a picture, along each side, for which the camera has one."""
    return -(-max(height, width) // COLUMNS)


def arriving(heat: Heat) -> Tensor:
    """Radiance [-], [E, P], that arrives at the camera, as `planck.radiance` counts it."""
    own = EMISSIVITY * radiance(heat.surface)
    room, flame = (radiance(torch.tensor(t, device=heat.surface.device)) for t in (heat.room, heat.flame))
    seen = own + (1.0 - EMISSIVITY) * room
    kept = torch.exp(-FLAME_ABSORPTION * heat.flame_way)
    seen = kept * seen + (1.0 - kept) * flame
    kept = torch.exp(-heat.dims)
    return kept * seen + (1.0 - kept) * radiance(heat.murk)


def blurred(image: Tensor) -> Tensor:
    """`image`, [E, H, W], as the optics show it; beyond its edges it goes on as it is there."""
    place = torch.arange(-KERNEL, KERNEL + 1, dtype=image.dtype, device=image.device)
    weight = torch.exp(-0.5 * (place / BLUR) ** 2)
    weight = weight / weight.sum()
    padded = functional.pad(image[:, None], (KERNEL,) * 4, mode="replicate")
    made = functional.conv2d(padded, weight.view(1, 1, 1, -1))
    return functional.conv2d(made, weight.view(1, 1, -1, 1))[:, 0]


def reading(image: Tensor, noise: Tensor) -> Tensor:
    """Temperatures [C], [E, H, W], that the camera tells of the radiance `image`, [E, H, W]; `noise` is normal."""
    shown = image + NOISE * slope(NOISE_AT) * noise
    least = radiance(torch.tensor(RANGE[0], device=image.device))
    return temperature(torch.maximum(shown, least)).clamp(*RANGE)
