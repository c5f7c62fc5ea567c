"""Colour and depth through smoke, rain and water, by stated laws.

    colour   C exp(-tau) + A (1 - exp(-tau)), in linear light: Koschmieder's law, with the simulated optical depth tau
             and the light A that the murk scatters
    depth    none beyond tau = SIGHT_LOSS; before it, normal noise whose variance is (QUALITY z^2)^2 (exp(2 tau) - 1),
             by which contrast that has fallen by exp(-tau) makes a stereo camera worse than it is in clear air
    drops    in rain, on the lens: discs in which colours are smeared and depth is missing

In clear air nothing changes. What pictures draw of smoke and haze by themselves is left out meanwhile, or it would
count twice; flames, puffs of smoke and water stay.
"""

from __future__ import annotations

from collections.abc import Sequence

import torch
from torch import Tensor
from torch.nn import functional

from hazard_ms.sensing.senses.signals import Murk

GAMMA = 2.2  # between light and the numbers of a picture, as in all our pictures
SIGHT_LOSS = 3.0  # optical depth beyond which nothing is recognised [-] [docs/physics.md 3.1: Jin; exp(-3) is 5 %]
# Error of stereo depth per squared depth [1/m]: 0.08 pixels, a base of 95 mm and a focal length of 447 pixels
# [Intel, "Tuning depth cameras for best performance"; D455 at 848 x 480]
QUALITY = 0.08 / (447.0 * 0.095)
DROPS = 12  # places on the lens where a drop can be [ours]
DROP_CHANCE = 0.5  # that there is one [-] [ours]
DROP_SIZE = (0.01, 0.04)  # radius per width of the picture [-] [ours]
DROP_FRAMES = 30  # for which drops stay [ours]
SMEAR = 16  # parts of the picture's width over which a drop smears colours [ours]


def colours(rgb: Tensor, murk: Sequence[Murk]) -> Tensor:
    """The colours `rgb`, uint8 [E, H, W, 3], through all `murk`, whose parts are [E, H, W]."""
    if not murk:
        return rgb
    depth = torch.stack([m.sight for m in murk])
    kept = torch.exp(-depth.sum(0))[..., None]
    scattered = torch.stack([d[..., None] * d.new_tensor(m.colour) for d, m in zip(depth, murk, strict=True)]).sum(0)
    light = (rgb.float() / 255.0) ** GAMMA
    seen = light * kept + scattered / depth.sum(0).clamp(min=1e-9)[..., None] * (1.0 - kept)
    changed = (seen.clamp(0.0, 1.0) ** (1.0 / GAMMA) * 255.0 + 0.5).to(torch.uint8)
    return torch.where(kept < 1.0, changed, rgb)


def depths(depth: Tensor, murk: Sequence[Murk], noise: Tensor) -> Tensor:
    """The `depth` [m], [E, H, W], through all `murk`, whose parts are [E, H, W]; 0 where nothing returns.

    `noise`, [E, H, W], is normal.
    """
    if not murk:
        return depth
    tau = torch.stack([m.near for m in murk]).sum(0)
    error = QUALITY * depth.square() * torch.expm1(2.0 * tau.clamp(max=SIGHT_LOSS)).clamp(min=0.0).sqrt()
    return torch.where((depth > 0.0) & (tau <= SIGHT_LOSS), (depth + error * noise).clamp(min=1e-3), 0.0)


def drops(draw: Tensor, height: int, width: int) -> Tensor:
    """Pixels behind drops on the lens, bool [E, H, W]; `draw`, [E, DROPS, 4], is uniform in (0, 1)."""
    there, x, y, size = draw.unbind(-1)
    radius = (DROP_SIZE[0] + (DROP_SIZE[1] - DROP_SIZE[0]) * size) * width * (there < DROP_CHANCE)
    row = torch.arange(height, device=draw.device)[None, None, :, None] + 0.5
    column = torch.arange(width, device=draw.device)[None, None, None, :] + 0.5
    apart = (row - (y * height)[..., None, None]) ** 2 + (column - (x * width)[..., None, None]) ** 2
    return (apart < radius[..., None, None] ** 2).any(1)


def smeared(rgb: Tensor, behind: Tensor) -> Tensor:
    """The colours `rgb`, uint8 [E, H, W, 3], smeared in the pixels `behind` drops, bool [E, H, W]."""
    height, width = behind.shape[1:]
    size = max(width // SMEAR, 1)
    coarse = functional.avg_pool2d(rgb.permute(0, 3, 1, 2).float(), size, ceil_mode=True)
    smooth = functional.interpolate(coarse, (height, width), mode="bilinear", align_corners=False)
    return torch.where(behind[..., None], smooth.permute(0, 2, 3, 1).round().to(torch.uint8), rgb)
