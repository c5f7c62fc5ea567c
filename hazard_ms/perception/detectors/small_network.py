"""The network of the detector `small`: colours and depth in, categories and centres of things out, pixel by pixel.

An encoder and a decoder with skips, from the full resolution down to a thirty-second of it. Depth is given as what is
the same wherever the robot stands: height above the floor, and how the surface lies. A thing on the floor is raised
however few pixels it has.
"""

from __future__ import annotations

import copy

import torch
from torch import Tensor, nn
from torch.nn import functional
from torch.nn.utils.fusion import fuse_conv_bn_eval

WIDTHS = (24, 32, 64, 96, 128)  # channels at each resolution [ours]
BLOCKS = (0, 1, 1, 3, 3)  # of two convolutions each, on the way down [ours]
FAR_WIDTH, FAR_BLOCKS = 192, 2  # of the look from afar, at half the coarsest of these resolutions [ours]
COARSE = 2  # number of the resolution from which on more channels tell classes, too: a quarter of the full one [ours]
SCALE = 2 ** len(WIDTHS)  # sides of pictures are multiples of it [pixels]
CHANNELS = 8  # of `features`
REACH = 16.0  # of an offset that the network says with 1 [pixels] [ours]
NEAREST, HIGHEST = 0.25, 2.5  # ends of what is told of depth and height [m] [ours]
RAISED = 0.15  # height that is told finely [m] [ours]
SLIGHT = 0.1  # by which a block of an untrained network changes what passes it [ours]


def convolution(inputs: int, outputs: int, stride: int = 1) -> nn.Sequential:
    """A convolution of 3 x 3 pixels with its normalisation."""
    return nn.Sequential(
        nn.Conv2d(inputs, outputs, 3, stride, 1, bias=False), nn.BatchNorm2d(outputs), nn.ReLU(inplace=True)
    )


class Block(nn.Module):
    """Two convolutions beside a way past them."""

    def __init__(self, width: int) -> None:
        super().__init__()
        self.both = nn.Sequential(convolution(width, width), convolution(width, width))
        nn.init.constant_(
            self.both.get_parameter("1.1.weight"), SLIGHT
        )  # so that blocks can be added to a trained network

    def forward(self, x: Tensor) -> Tensor:
        """Features, [N, C, H, W], as many as in `x`."""
        return x + self.both(x)


class SmallNetwork(nn.Module):
    """The network itself, which tells how likely each pixel shows each class, and where the middle of its thing is."""

    def __init__(self, classes: int) -> None:
        """Make an untrained network for so many `classes`, the structure (0) and other things (last) included."""
        super().__init__()
        self.stem = convolution(CHANNELS, WIDTHS[0])
        pairs = list(zip(WIDTHS, WIDTHS[1:], strict=False))
        self.down = nn.ModuleList(
            nn.Sequential(convolution(a, b, 2), *(Block(b) for _ in range(count)))
            for (a, b), count in zip(pairs, BLOCKS[1:], strict=True)
        )
        self.sideways = nn.ModuleList(nn.Conv2d(b, a, 1) for a, b in pairs)
        self.up = nn.ModuleList(convolution(a, a) for a in WIDTHS[:-1])
        self.afar = nn.Sequential(convolution(WIDTHS[-1], FAR_WIDTH, 2), *(Block(FAR_WIDTH) for _ in range(FAR_BLOCKS)))
        self.nearer = nn.Conv2d(FAR_WIDTH, WIDTHS[-1], 1)
        self.kinds = nn.ModuleList(nn.Conv2d(width, classes, 1) for width in WIDTHS[COARSE:])
        for part in (self.nearer, *self.kinds):  # say nothing until they have learned something
            nn.init.zeros_(part.weight)
            nn.init.zeros_(part.bias)
        self.logits = nn.Conv2d(WIDTHS[0], classes, 1)
        self.offsets = nn.Conv2d(WIDTHS[0], 2, 1)

    def forward(self, x: Tensor) -> tuple[Tensor, Tensor]:
        """Logits, [N, C, H, W], and offsets right and down to the middle of the thing [pixels], [N, 2, H, W].

        `x`: what `features` gives, [N, CHANNELS, H, W]; H and W are multiples of SCALE.
        """
        x = self.stem(x)
        kept = [x]
        for part in self.down:
            x = part(x)
            kept.append(x)
        x = x + _twice(self.nearer(self.afar(x)))
        kinds = self.kinds[-1](x)
        for level in reversed(range(len(self.up))):
            x = self.up[level](kept[level] + _twice(self.sideways[level](x)))
            if level >= COARSE:
                kinds = _twice(kinds) + self.kinds[level - COARSE](x)
        kinds = functional.interpolate(kinds, scale_factor=2.0**COARSE, mode="bilinear")
        return (self.logits(x) + kinds).float(), REACH * self.offsets(x).float()


def _twice(x: Tensor) -> Tensor:
    """The features `x`, [N, C, H, W], at twice the resolution, [N, C, 2 H, 2 W]."""
    return functional.interpolate(x, scale_factor=2.0, mode="nearest")


def without_normalisation(network: SmallNetwork) -> SmallNetwork:
    """A copy of `network` for asking alone: each convolution does what its normalisation did, to rounding."""
    made = copy.deepcopy(network).eval()
    for part in made.modules():
        match list(part.children()):
            case [nn.Conv2d() as kernels, nn.BatchNorm2d() as normalisation, _]:
                part[0], part[1] = fuse_conv_bn_eval(kernels, normalisation), nn.Identity()  # type: ignore[operator]
    return made


def features(rgb: Tensor, depth: Tensor, intrinsic: Tensor, cam2world: Tensor) -> Tensor:
    """Numbers of about -1 to 1 that the network looks at, float32 [N, CHANNELS, H, W].

    Colours, nearness, height above the floor, the same finely near the floor, how much the surface faces up, and how
    much it faces the camera. `rgb` uint8 [N, H, W, 3]; `depth` along the optical axis [m], [N, H, W], 0: nothing;
    `intrinsic` [N, 3, 3] [pixels]; `cam2world` [N, 4, 4] [m], of a camera that looks along its -z axis with y up.
    """
    there = depth > 0.0
    far = torch.where(there, depth, 1000.0)
    row = torch.arange(depth.shape[1], dtype=torch.float32, device=depth.device)[None, :, None] + 0.5
    column = torch.arange(depth.shape[2], dtype=torch.float32, device=depth.device)[None, None, :] + 0.5
    k = intrinsic[:, :, :, None, None]
    right, above = (column - k[:, 0, 2]) / k[:, 0, 0], (k[:, 1, 2] - row) / k[:, 1, 1]
    ray = torch.stack(torch.broadcast_tensors(right, above, torch.full_like(depth, -1.0)), dim=1)  # [N, 3, H, W]
    point = ray * far[:, None]
    up = cam2world[:, 2, :3, None, None]  # of the world, in the camera's axes
    height = (point * up).sum(1) + cam2world[:, 2, 3, None, None]
    down, across = torch.gradient(point, dim=(2, 3))
    normal = _unit(torch.linalg.cross(down, across, dim=1))
    told = (
        NEAREST / far.clamp(min=NEAREST),
        height.clamp(-HIGHEST, HIGHEST) / HIGHEST,
        (height / RAISED).clamp(-1.0, 2.0),
        (normal * up).sum(1),
        -(normal * _unit(ray)).sum(1),
    )
    geometry = torch.stack(told, dim=1) * there[:, None]
    return torch.cat([rgb.permute(0, 3, 1, 2).float() / 127.5 - 1.0, geometry], dim=1)


def _unit(vectors: Tensor) -> Tensor:
    """The `vectors`, [N, 3, H, W], at length 1 [-]; those of length 0 stay.

    What torch.nn.functional.normalize does, which is slow along an axis that is not the last.
    """
    length = (vectors * vectors).sum(dim=1, keepdim=True).sqrt()
    return vectors / length.clamp(min=1e-12)
