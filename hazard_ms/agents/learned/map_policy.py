"""The network of the original's learner: logits of the six actions from a map (`hazard_ms.skills.options.paper_map`).

    maximum of 2 x 2, convolution to 32 planes, maximum, 64, maximum, 128, maximum, 64, 32, then layers of 512 and 256

Convolutions are of 3 x 3 cells; a ReLU follows each layer. The marks of the agent are negative, and a maximum would
lose them, so the sign of this plane is flipped first. `share` makes all layers narrower.
"""

from __future__ import annotations

from dataclasses import dataclass

import torch
from torch import Tensor, nn

from hazard_ms.agents.learned.set_policy import FORBIDDEN
from hazard_ms.skills.options.paper_actions import COUNT
from hazard_ms.skills.options.paper_map import AGENT, CELLS, HERE, LEVEL, THING, MapLayout

CONVOLUTIONS, LAYERS = (32, 64, 128, 64, 32), (512, 256)
POOLED = 4  # maxima of 2 x 2, one before each of the first convolutions


@dataclass(frozen=True)
class MapShape:
    """The architecture of a policy, and what it was trained to do."""

    ranges: tuple[tuple[float, float], ...]  # ends of the usual level of each hazard of its task, in its unit
    share: float = 1.0  # of the original's widths
    masked: bool = False  # whether it chooses among what can be done only
    ignored: tuple[int, ...] = ()  # planes that are not read
    at_things: bool = False  # whether levels are read where targets and carts are only

    def __post_init__(self) -> None:
        """Raises ValueError for a share out of range."""
        if not 1.0 / min(CONVOLUTIONS) <= self.share <= 1.0:
            raise ValueError(f"share of a policy must be from 1/{min(CONVOLUTIONS)} to 1, got {self.share}")

    @property
    def width(self) -> int:
        """The number of features that the last layer gives."""
        return self.widths(LAYERS)[-1]

    def widths(self, layers: tuple[int, ...]) -> list[int]:
        """The widths of `layers`, narrowed."""
        return [round(self.share * layer) for layer in layers]


class MapPolicy(nn.Module):
    """Logits of the six actions from maps."""

    def __init__(self, shape: MapShape) -> None:
        """Make an untrained policy."""
        super().__init__()
        self.shape, self.layout = shape, MapLayout(shape.ranges)
        body: list[nn.Module] = []
        before = self.layout.planes
        for k, width in enumerate(shape.widths(CONVOLUTIONS)):
            body += [nn.MaxPool2d(2)] if k < POOLED else []
            body += [nn.Conv2d(before, width, 3, padding=1), nn.ReLU()]
            before = width
        body.append(nn.Flatten())
        before *= (CELLS >> POOLED) ** 2
        for width in shape.widths(LAYERS):
            body += [nn.Linear(before, width), nn.ReLU()]
            before = width
        self.body, self.score = nn.Sequential(*body), nn.Linear(before, COUNT)
        nn.init.orthogonal_(self.score.weight, 0.01)  # untrained, it likes all actions alike
        nn.init.zeros_(self.score.bias)
        scale = torch.ones(self.layout.planes)
        scale[AGENT] = 1.0 / HERE
        scale[list(shape.ignored)] = 0.0
        self.register_buffer("scale", scale[:, None, None], persistent=False)

    def forward(self, maps: Tensor, mask: Tensor) -> Tensor:
        """Logits [N, 6] from `maps` [N, 4 + H, 64, 64]; FORBIDDEN where `mask` [N, 6] is not set."""
        return self.logits(self.features(maps), mask)

    def features(self, maps: Tensor) -> Tensor:
        """The features of the last layer, [N, width], for `maps` [N, 4 + H, 64, 64]."""
        if self.shape.at_things:
            there = (maps[:, THING : THING + 1] >= 0.0).to(maps)
            maps = torch.cat([maps[:, :LEVEL], maps[:, LEVEL:] * there], dim=1)
        return torch.as_tensor(self.body(maps * self.get_buffer("scale")))

    def logits(self, features: Tensor, mask: Tensor) -> Tensor:
        """Logits [N, 6] from `features` [N, width]; FORBIDDEN where `mask` [N, 6] is not set."""
        return torch.as_tensor(self.score(features)).masked_fill(~mask, FORBIDDEN)

    def draw(self, maps: Tensor, mask: Tensor, chance: Tensor) -> Tensor:
        """Actions [N], each as likely as the policy wants it, by uniform numbers `chance` [N]; others as `forward`."""
        with torch.no_grad():
            likely = self(maps, mask).softmax(-1)
        below = (likely.cumsum(-1) < chance[:, None]).sum(-1)
        last = (mask * torch.arange(1, COUNT + 1)).argmax(-1)  # the sum of all may be a little less than 1
        return torch.minimum(below, last)
