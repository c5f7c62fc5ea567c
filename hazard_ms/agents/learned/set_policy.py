"""A policy over options that treats targets, carts and landmarks as sets: the order of their slots changes nothing.

    token    one for each thing that can matter, and one for the whole: an MLP of its row of features and of the whole's
    mixing   BLOCKS times: each token adds what it draws from all others (attention), then an MLP of itself
    logit    an MLP of the token of each target, cart and landmark, fire and tool; two of the whole's: look around, stop

Rows of rescued targets and of empty slots are left out. Columns that a teacher's world cannot give are `ignored`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from hazard_ms.skills.options.features import Encoder
from hazard_ms.skills.options.options import CART, END, FIRE, FIRST, LANDMARK, LOOK, TARGET, TOOL

KINDS = {"targets": TARGET, "carts": CART, "landmarks": LANDMARK}  # tables of things, and their options
MEASURES = {"fires": FIRE, "tools": TOOL}  # the same of tasks with measures, beside those
MOST = {"width": 1024, "heads": 1024, "blocks": 32}  # of an architecture: any larger number must be a mistake [ours]
FORBIDDEN = -1e9  # logit of an option that the mask forbids: its probability is 0 in float32


@dataclass(frozen=True)
class Shape:
    """The architecture of a policy."""

    ranges: tuple[tuple[float, float], ...]  # ends of the usual level of each hazard of its task, in its unit
    width: int = 40  # of a token
    heads: int = 4  # of each attention, which divide the width
    blocks: int = 2  # of mixing
    ignored: tuple[str, ...] = ()  # columns, or the beginnings of their names, that are not read
    measures: bool = False  # whether its options have measures about a fire

    def __post_init__(self) -> None:
        """Raises ValueError for numbers below 1 or above MOST, and for heads that do not divide the width."""
        for name, most in MOST.items():
            if not 1 <= getattr(self, name) <= most:
                raise ValueError(f"{name} of a policy must be from 1 to {most}, got {getattr(self, name)}")
        if self.width % self.heads:
            raise ValueError(f"heads of a policy must divide its width, {self.width}, got {self.heads}")


def worthwhile(mask: NDArray[np.bool_]) -> NDArray[np.bool_]:
    """A `mask` [..., A] without `stop`, as long as there is anything to go to: [..., A]."""
    made = mask.copy()
    others = mask[..., : FIRST[LOOK]].any(axis=-1) | mask[..., FIRST[END] + 1 :].any(axis=-1)
    made[..., FIRST[END]] &= ~others
    return made


class _Block(nn.Module):
    """Each token adds what it draws from all others, then an MLP of itself."""

    def __init__(self, width: int, heads: int) -> None:
        super().__init__()
        self.heads = heads
        self.before, self.after = nn.LayerNorm(width), nn.LayerNorm(width)
        self.drawn, self.mixed = nn.Linear(width, 3 * width), nn.Linear(width, width)
        self.own = nn.Sequential(nn.Linear(width, 2 * width), nn.ReLU(), nn.Linear(2 * width, width))

    def forward(self, token: Tensor, exists: Tensor) -> Tensor:
        n, k, width = token.shape
        parts = self.drawn(self.before(token)).view(n, k, 3, self.heads, width // self.heads)
        query, key, value = parts.permute(2, 0, 3, 1, 4)
        drawn = nn.functional.scaled_dot_product_attention(query, key, value, attn_mask=exists[:, None, None])
        token = token + self.mixed(drawn.transpose(1, 2).reshape(n, k, width))
        return torch.as_tensor(token + self.own(self.after(token)))


class SetPolicy(nn.Module):
    """Logits of all options from the features of a decision (`hazard_ms.skills.options.features`)."""

    def __init__(self, shape: Shape) -> None:
        """Make an untrained policy."""
        super().__init__()
        self.shape = shape
        self.layout = Encoder(shape.ranges, 0.0, shape.measures)
        self.kinds = KINDS | (MEASURES if shape.measures else {})
        whole = len(self.layout.tables["global"][1])
        inputs = {name: len(self.layout.tables[name][1]) + whole for name in self.kinds} | {"global": whole}
        self.enter = nn.ModuleDict(
            {
                name: nn.Sequential(nn.Linear(size, shape.width), nn.ReLU(), nn.Linear(shape.width, shape.width))
                for name, size in inputs.items()
            }
        )
        self.blocks = nn.ModuleList(_Block(shape.width, shape.heads) for _ in range(shape.blocks))
        self.score = nn.ModuleDict(
            {
                name: nn.Sequential(
                    nn.LayerNorm(shape.width),
                    nn.Linear(shape.width, shape.width),
                    nn.ReLU(),
                    nn.Linear(shape.width, 2 if name == "global" else 1),
                )
                for name in inputs
            }
        )
        read = [not any(c.name.startswith(name) for name in shape.ignored) for _, _, _, c in self.layout.cells()]
        self.register_buffer("read", torch.tensor(read, dtype=torch.float32), persistent=False)

    def forward(self, features: Tensor, mask: Tensor) -> Tensor:
        """Logits [N, A] from `features` [N, F]; FORBIDDEN where `mask` [N, A] is not set."""
        return self.logits(self.tokens(features), mask)

    def tokens(self, features: Tensor) -> dict[str, Tensor]:
        """The tokens that `features` [N, F] become, by table, [N, rows, width]: one of the whole, one for each thing.

        Rows of a table that no decision fills are cut off.
        """
        parts = self._parts(features * self.get_buffer("read"))
        whole = parts["global"]
        rows = {"global": self.enter["global"](whole)}
        exists = [torch.ones_like(whole[..., 0], dtype=torch.bool)]
        for name in self.kinds:
            table = parts[name]
            rows[name] = self.enter[name](torch.cat([table, whole.expand(-1, table.shape[1], -1)], dim=-1))
            exists.append(self._matters(name, table))
        token, there = torch.cat(list(rows.values()), dim=1), torch.cat(exists, dim=1)
        for block in self.blocks:
            token = block(token, there)
        return dict(zip(rows, token.split([row.shape[1] for row in rows.values()], dim=1), strict=True))

    def logits(self, tokens: dict[str, Tensor], mask: Tensor) -> Tensor:
        """Logits [N, A] from `tokens` [N, rows, width]; FORBIDDEN where `mask` [N, A] is not set."""
        made = torch.full(mask.shape, FORBIDDEN, device=mask.device)
        for name, kind in self.kinds.items():
            made[:, FIRST[kind] : FIRST[kind] + tokens[name].shape[1]] = self.score[name](tokens[name])[..., 0]
        made[:, FIRST[LOOK] : FIRST[END] + 1] = self.score["global"](tokens["global"][:, 0])
        return made.masked_fill(~mask, FORBIDDEN)

    def choose(self, features: Tensor, mask: Tensor) -> Tensor:
        """The option of the highest logit of each decision, [N]; arguments as of `forward`."""
        with torch.no_grad():
            return torch.as_tensor(self(features, mask).argmax(dim=-1))

    def _parts(self, features: Tensor) -> dict[str, Tensor]:
        """The tables of `features` [N, F], [N, rows, columns] each; rows that no decision fills are cut off."""
        parts, start = {}, 0
        for name, (rows, columns) in self.layout.tables.items():
            table = features[:, start : start + rows * len(columns)].view(len(features), rows, len(columns))
            filled = (table != 0).any(dim=-1).any(dim=0).nonzero()
            end = int(filled[-1]) + 1 if len(filled) and name != "global" else (1 if name == "global" else 0)
            parts[name] = table[:, :end]
            start += rows * len(columns)
        return parts

    def _matters(self, name: str, rows: Tensor) -> Tensor:
        """Whether each row stands for a thing that still matters, [N, rows]."""
        columns: Sequence[str] = [column.name for column in self.layout.tables[name][1]]
        if name == "targets":
            return (rows[..., columns.index("value")] > 0) & (rows[..., columns.index("rescued")] == 0)
        told = "edge" if name == "landmarks" else "known"  # no landmark is offered without an edge
        return rows[..., columns.index(told)] > 0
