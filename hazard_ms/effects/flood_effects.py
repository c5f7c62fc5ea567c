"""The surface of a flood, what is seen through it, and what it has made wet, driven by `hazard_ms.hazards.flood.Flood`'s state.

The surface is a mesh over every part of the room that water can reach; each corner knows its way from the source wall, and the pose of
the one entity tells the level there and the slope: so it is the hazard's own surface, and nothing is built or sent anew as it rises.
"""

from __future__ import annotations

import itertools
import math

import numpy as np
import sapien
import torch
from sapien.render import RenderMaterial, RenderShapeTriangleMesh
from torch import Tensor

from hazard_ms.effects import shader_pack
from hazard_ms.effects.entities import FRAMES_PER_SECOND, canvas, entities_of, make_effect, materials
from hazard_ms.effects.glsl import WATER
from hazard_ms.effects.surroundings import Surroundings
from hazard_ms.effects.textures import ripple_texture
from hazard_ms.effects.water_glsl import DRY_IOR, WET_IOR
from hazard_ms.hazards import surface
from hazard_ms.hazards.flood import FloodState
from hazard_ms.spec import SceneSpec
from hazard_ms.world import World

CELL = 0.25  # of the surface's mesh where water goes around corners [m] [ours]
INSIDE = 1e-4  # by which a corner of the mesh lies in its own part of the room [m]
SOAKED_AT = 0.3  # share of a thing under water at which it is wet all over [ours]


class _SceneFlood:
    """The flood of one scene."""

    def __init__(self, scene: sapien.Scene, spec: SceneSpec, names: tuple[str, ...], around: Surroundings) -> None:
        self._around, self._ways = around, _ways(spec)
        self._map = _way(self._ways, around.places)[0]
        self._surface = make_effect(scene, ripple_texture(), lambda material: surface_mesh(spec, material), 0)
        if self._surface is not None:
            material = self._surface.material
            material.transmission_texture = around.texture
            material.transmission = 1.0
        self._things = [materials(e) for e in entities_of(scene, names)]
        self._wet = [0.0] * len(names)

    def show(self, level: float, fall: float, time: float) -> None:
        """Water at `level` [m] at its source, with slope `fall`."""
        self._around.water(level - fall * self._map, time)
        if self._surface is None:
            return
        half = math.atan(fall) / 2
        if level > 0.0:
            self._surface.show(sapien.Pose([0.0, 0.0, level], [math.cos(half), 0.0, 0.0, math.sin(half)]), 1.0, time)
        else:
            self._surface.hide()

    def wet(self, shares: np.ndarray) -> None:
        """How wet things look, 0..1, [B]."""
        for k, parts in enumerate(self._things):
            share = round(float(shares[k]), 3)
            if share != self._wet[k]:
                for material in parts:
                    material.ior = DRY_IOR + WET_IOR * share
                self._wet[k] = share


class FloodEffects:
    """What a flood looks like, in each of E scenes."""

    def __init__(self, scenes: list[_SceneFlood], mode: str, device: sapien.Device | None) -> None:
        self._scenes, self._mode, self._device = scenes, mode, device

    @classmethod
    def build(
        cls, scenes: list[sapien.Scene], specs: tuple[SceneSpec, ...], world: World, mode: str, around: list[Surroundings]
    ) -> FloodEffects:
        """Effects of `mode` (full; fast: without light on the ground; off) for `scenes` in which the things of `specs` stand.

        Without a renderer, or with a SAPIEN whose shaders are unknown, nothing is shown.
        """
        device, shown = canvas(scenes, mode)
        if not shown:
            return cls([], mode, device)
        rows = zip(scenes, specs, world.names, around, strict=True)
        return cls([_SceneFlood(*row) for row in rows], mode, device)

    def update(self, world: World, flood: FloodState, frame: Tensor) -> None:
        """Show `world` and `flood` at `frame` [E]. Call it before a picture is taken; it changes nothing but the picture."""
        if self._device is not None:
            shader_pack.keep_warm(self._mode, self._device)
        if not self._scenes:
            return
        wet = torch.maximum(flood.fraction / SOAKED_AT, flood.soaked).clamp(max=1.0).cpu().numpy()
        level, fall, time = (t.cpu().tolist() for t in (flood.level, flood.fall, frame / FRAMES_PER_SECOND))
        for e, scene in enumerate(self._scenes):
            scene.show(level[e], fall[e], time[e])
            scene.wet(wet[e])


def surface_corners(spec: SceneSpec) -> tuple[np.ndarray, np.ndarray]:
    """The surface of the water over the floor of `spec`'s room as Q quads, as far as water can get.

    Places of their corners [m], [Q, 4, 2], and what these carry: way of the water [m], its direction [rad], kind, [Q, 4, 3].
    """
    ways, room = _ways(spec), spec.room
    low, high = -room.beyond, (room.size[0] + room.beyond, room.size[1] + room.beyond)
    cuts = [sorted([low, high[k], *(p.at for p in room.partitions if p.axis == "yx"[k])]) for k in (0, 1)]
    corners = []
    for (x0, x1), (y0, y1) in itertools.product(*(itertools.pairwise(c) for c in cuts)):
        count = [math.ceil((b - a) / CELL) if room.partitions else 1 for a, b in ((x0, x1), (y0, y1))]
        xs, ys = (np.linspace(a + INSIDE, b - INSIDE, n + 1) for (a, b), n in zip(((x0, x1), (y0, y1)), count, strict=True))
        at = np.stack(np.meshgrid(xs, ys), -1)
        corners.append(np.stack([at[:-1, :-1], at[:-1, 1:], at[1:, 1:], at[1:, :-1]], 2).reshape(-1, 4, 2))
    place = np.concatenate(corners)
    way, turn = _way(ways, place)
    reached = way.max(axis=1) < surface.NEVER / 2
    return place[reached], np.stack([way, turn, np.full_like(way, WATER)], -1)[reached]


def surface_mesh(spec: SceneSpec, material: RenderMaterial) -> RenderShapeTriangleMesh | None:
    """A mesh of `surface_corners`, whose vertices coincide; None where water gets nowhere."""
    place, data = (c.reshape(-1, c.shape[-1]).astype(np.float32) for c in surface_corners(spec))
    if len(place) == 0:
        return None
    first = 4 * np.arange(len(place) // 4)[:, None]
    faces = (first + np.array([[0, 1, 2, 0, 2, 3, 2, 1, 0, 3, 2, 0]])).reshape(-1, 3)  # both sides
    return RenderShapeTriangleMesh(np.zeros((len(place), 3), np.float32), faces.astype(np.uint32), data, place, material)


def _ways(spec: SceneSpec) -> surface.Ways:
    """The ways of the water in the room of `spec`, [1, ...]."""
    counts = surface.sizes((spec,))
    made = surface.ways_of(spec, counts["W"], counts["G"])
    shapes = {"wall": (1, counts["W"], 2), "gate": (1, counts["G"], 4), "gate_part": (1, counts["G"], 2)}
    whole = ("near", "gate_part")
    return surface.Ways(
        **{
            name: torch.tensor([made[name]], dtype=torch.int64 if name in whole else torch.float32).reshape(
                shapes.get(name, (1, *np.shape(made[name])))
            )
            for name in surface.Ways._fields
        }
    )


def _way(ways: surface.Ways, place: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """How far water has come [m], and where it flows to [rad from +x], at `place` [m], [..., 2]: [...] each."""
    flat = torch.from_numpy(place.reshape(1, -1, 2)).float()
    far, toward = surface.ways_to(ways, torch.nn.functional.pad(flat, (0, 1)))
    turn = torch.atan2(toward[..., 1], toward[..., 0])
    return far.numpy().reshape(place.shape[:-1]), turn.numpy().reshape(place.shape[:-1])
