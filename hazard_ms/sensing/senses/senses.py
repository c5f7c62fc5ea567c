"""The extra senses of one environment's cameras: `thermal`, and `degraded` colour and depth."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import torch
from torch import Tensor

from hazard_ms.sensing.camera import points_of_depth
from hazard_ms.sensing.senses import degraded, thermal
from hazard_ms.sensing.senses.crossing import through
from hazard_ms.sensing.senses.of_others import AMBIENT, WindSignals
from hazard_ms.sensing.senses.signals import Murk, signals_of
from hazard_ms.simulation.chance import Chance
from hazard_ms.tasks.episode.situation import Situation

THERMAL, DEGRADED = "thermal", "degraded"
SENSES = (THERMAL, DEGRADED)


class Frame(NamedTuple):
    """The true view of a camera in each environment."""

    depth: Tensor  # along the optical axis, [E, H, W], int16 [mm] or float [m]; 0 where there is nothing
    labels: Tensor  # [E, H, W], see `hazard_ms.sensing.camera`
    intrinsic: Tensor  # [E, 3, 3] [pixels]
    cam2world: Tensor  # [E, 4, 4], of a camera that looks along its -z axis with y up
    name: str  # of the picture: noise depends on seed, frame and this


class Senses:
    """Makes thermal images and degraded pictures of the present frame."""

    def __init__(self, situation: Situation, chosen: Sequence[str] = ()) -> None:
        """`chosen`: those of SENSES that observations have."""
        self.chosen = tuple(chosen)
        self._situation = situation
        self._signals = signals_of(situation.episode.hazards)

    def thermal(self, frame: Frame) -> Tensor:
        """Temperatures [C], float32 [E, H, W], that a thermal camera in place of the frame's camera would show."""
        world, states = self._situation.world, self._situation.episode.states
        height, width = frame.depth.shape[1:3]
        step = thermal.stride(height, width)
        rows, columns = -(-height // step), -(-width // step)
        points, _ = points_of_depth(frame.depth, frame.intrinsic, frame.cam2world, (rows, columns))
        points, labels = points.flatten(1, 2), frame.labels[:, ::step, ::step].flatten(1)
        eye = frame.cam2world[:, :3, 3].float()
        surface, way, hottest = torch.full_like(points[..., 0], AMBIENT), torch.zeros_like(points[..., 0]), AMBIENT
        for name, signals in self._signals.items():
            warm = signals.warmth(states[name], world, labels, points)
            surface = surface if warm is None else torch.maximum(surface, warm)
            flames = signals.flames(states[name], world)
            if flames is not None:
                way, hottest = way + through(world, flames, eye, points), max(hottest, flames.temperature)
        if "water" in world.fields:
            surface = torch.where(world.fields["water"](points) > points[..., 2], AMBIENT, surface)
        murk = self._murk(eye, points)
        dims = torch.stack([m.far for m in murk]) if murk else torch.zeros_like(surface)[None]
        warmth = sum((m.far * m.temperature for m in murk), torch.zeros_like(surface)) / dims.sum(0).clamp(min=1e-9)
        heat = thermal.Heat(surface, way, hottest, dims.sum(0), warmth, AMBIENT)
        image = thermal.blurred(thermal.arriving(heat).unflatten(1, (rows, columns)))
        shown = thermal.reading(image, world.chance.normal(f"thermal {frame.name}", rows, columns))
        return shown.repeat_interleave(step, 1).repeat_interleave(step, 2)[:, :height, :width].contiguous()

    def degraded(self, rgb: Tensor | None, depth: Tensor, frame: Frame) -> tuple[Tensor | None, Tensor, Tensor]:
        """Colours, uint8 [E, H, W, 3], and depth [m], [E, H, W], through the murk, and what it lets through.

        The last are shares of the light, [E, H, W]. `rgb` may be None; `depth` [m], [E, H, W].
        """
        height, width = depth.shape[1:]
        points, _ = points_of_depth(frame.depth, frame.intrinsic, frame.cam2world)
        parts = self._murk(frame.cam2world[:, :3, 3].float(), points.flatten(1, 2))
        murk = [_shaped(m, height, width) for m in parts]
        chance = self._situation.world.chance
        seen = None if rgb is None else degraded.colours(rgb, murk)
        found = degraded.depths(depth, murk, chance.normal(f"depth {frame.name}", height, width))
        if any(isinstance(signals, WindSignals) for signals in self._signals.values()):
            slow = Chance(len(depth), depth.device)
            slow.seed, slow.frame = chance.seed, chance.frame // degraded.DROP_FRAMES
            behind = degraded.drops(slow.uniform(f"drops {frame.name}", degraded.DROPS, 4), height, width)
            seen = None if seen is None else degraded.smeared(seen, behind)
            found = torch.where(behind, 0.0, found)
        kept = torch.exp(-sum((m.sight for m in murk), torch.zeros_like(depth)))
        return seen, found, kept

    def _murk(self, eye: Tensor, points: Tensor) -> list[Murk]:
        """All that lies between the `eye` [m], [E, 3], and `points` [m], [E, P, 3]."""
        world, states = self._situation.world, self._situation.episode.states
        found = (signals.murk(states[name], world, eye, points) for name, signals in self._signals.items())
        return [murk for murk in found if murk is not None]


def _shaped(murk: Murk, height: int, width: int) -> Murk:
    """`murk` whose parts are [E, H, W] in place of [E, H W]."""
    sight, near, far, warmth = (v.unflatten(1, (height, width)) for v in murk[:4])
    return Murk(sight, near, far, warmth, murk.colour)
