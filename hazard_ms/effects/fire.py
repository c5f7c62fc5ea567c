"""The effects of a fire: flames, scorch marks, smoke, soot, hot air, charring and its light, all driven by its state.

Everything is made when a scene is built. A picture then only moves effect entities and writes scalars of materials,
both functions of the world, the fire and the frame alone: the same state gives the same pixels, whatever was shown
before.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial
from typing import ClassVar

import numpy as np
import sapien
import torch
from sapien.render import RenderMaterial, RenderPointLightComponent, RenderShapeTriangleMesh
from torch import Tensor

from hazard_ms.effects import meshes
from hazard_ms.effects.charring import char_codes
from hazard_ms.effects.entities import FRAMES_PER_SECOND, Effect, entities_of, make_effect, materials, seed
from hazard_ms.effects.scene_effects import Place, SceneEffects
from hazard_ms.effects.shaders.common import SMOKE_PERIOD
from hazard_ms.effects.shimmer import hot_air
from hazard_ms.effects.soot import Soot
from hazard_ms.effects.textures import noise_texture
from hazard_ms.hazards.base import State
from hazard_ms.hazards.fire.fire import FireState, body_flames, floor_flames
from hazard_ms.hazards.fire.spread import SCALE_LAST, roster_length
from hazard_ms.simulation.world import World

MOST_FRAMES = 1500  # frames of a fire, for which patches are made (docs/benchmark.md 1)
PATCH_SIZE = 0.34  # edge of a burning patch of floor, more than its cell so that neighbours merge [m] [ours]
MOST_PATCHES = 160  # flames on the floor that are shown at once; the oldest ones
COLUMNS = 8  # of smoke and of hot air
BROAD_EDGE = 0.7  # edge of a thing above which the air is as hot as it gets [m] [ours]
FLOOR_HEAT = 0.7  # of the air above a burning patch, whose neighbours burn as well, as a share of that [ours]
UNDER_CEILING = 0.15  # where smoke has faded, below the ceiling [m] [ours]
SMOKE_STRENGTH = 0.30  # opacity of a puff [ours]
SPECTATOR_DEPTH = 1.3  # optical depth across the room of the thickest smoke that a spectator sees [ours]
SOOT_ON_THINGS = 0.40  # char of furniture below a ceiling that is black with soot [ours]
FAINTEST = 0.02  # char by soot that is not shown [ours]
FRAMES_PER_UPDATE = 5  # of heat, by which burning is counted (docs/physics.md 1.1)
GLOW_COLOUR = np.array([1.0, 0.42, 0.10])  # linear RGB of firelight, about 1900 K
LIGHT_PER_FLAME = 0.8  # radiant intensity in SAPIEN's units [ours]
LIGHT_HEIGHT = 1.1  # above the middle of all that burns [m] [ours]
BRIGHTEST = 4.0  # of the light, however much burns [ours]


class _SceneFire:
    """The effects of one scene."""

    def __init__(self, place: Place, patches: int) -> None:
        scene, spec, names, rich = place.scene, place.spec, place.names, place.rich
        self.scene, self.around, self.noise = scene, place.around, noise_texture()
        self.soot = Soot(scene, spec.room) if rich else None  # first, or smoke would hide it
        entities = entities_of(scene, names)
        self.charred = [materials(e) for e in entities]
        self.codes = [0.0] * len(names)
        self.things = [self._effect(partial(meshes.thing_flames, e), k) for k, e in enumerate(entities)]
        patch = [self._effect(partial(meshes.floor_flames, PATCH_SIZE, seed(k)), k) for k in range(patches)]
        ceiling = spec.room.height - UNDER_CEILING
        smoke = [self._effect(partial(meshes.smoke_column, ceiling, seed(k)), k) for k in range(COLUMNS if rich else 0)]
        self.patches = [e for e in patch if e is not None]
        self.columns = [e for e in smoke if e is not None]
        self.air = [hot_air(scene, self.noise, k) for k in range(COLUMNS if rich else 0)]
        self.light = _lamp(scene) if rich else None
        self.across = math.hypot(*spec.room.size)  # [m]

    def _effect(self, make: Callable[[RenderMaterial], RenderShapeTriangleMesh | None], number: int) -> Effect | None:
        return make_effect(self.scene, self.noise, make, number)

    def show_things(self, pose: np.ndarray, strength: np.ndarray, time: float) -> None:
        """Show flames on things with the poses of their bases, [B, 7], and `strength` 0..1, [B]."""
        for effect, place, s in zip(self.things, pose, strength, strict=False):
            if effect is None:
                continue
            if s > 0.0:
                effect.show(sapien.Pose(place[:3], place[3:]), float(s), time)
            else:
                effect.hide()

    def show_floor(self, place: np.ndarray, strength: np.ndarray, time: float) -> None:
        """Show flames on the floor at `place` [m], [F, 3], with `strength` 0..1, [F]."""
        for k, effect in enumerate(self.patches):
            if k < len(place) and strength[k] > 0.0:
                effect.show(sapien.Pose(place[k]), float(strength[k]), time)
            else:
                effect.hide()

    def show_smoke(self, place: np.ndarray, strength: np.ndarray, heat: np.ndarray, time: float) -> None:
        """Show smoke and hot air above some of the places that burn.

        `place` [m], [F, 3]; `strength` of the fire and `heat` of the air 0..1, [F].
        """
        burning = np.flatnonzero(strength > 0.0)
        chosen = (
            burning[np.linspace(0, len(burning) - 1, min(len(burning), len(self.columns))).astype(int)]
            if len(burning)
            else burning
        )
        for k, (smoke, air) in enumerate(zip(self.columns, self.air, strict=True)):
            if k >= len(chosen):
                smoke.hide()
                air.hide()
                continue
            half = math.pi * ((time / SMOKE_PERIOD + smoke.seed) % 1.0)
            turn = [math.cos(half), 0.0, 0.0, math.sin(half)]
            smoke.show(sapien.Pose(place[chosen[k]], turn), SMOKE_STRENGTH * float(strength[chosen[k]]), time)
            air.show(sapien.Pose(place[chosen[k]]), float(heat[chosen[k]]), time)

    def show_light(self, place: np.ndarray, strength: np.ndarray, time: float) -> None:
        """Show one flickering light in the middle of all that burns."""
        if self.light is None:
            return
        total = float(strength.sum())
        flicker = (
            1.0 + 0.10 * math.sin(11.0 * time) + 0.07 * math.sin(23.7 * time + 1.0) + 0.05 * math.sin(41.3 * time + 2.0)
        )
        power = min(LIGHT_PER_FLAME * math.sqrt(total), BRIGHTEST) * flicker if total > 0.0 else 0.0
        middle = (place * strength[:, None]).sum(0) / max(total, 1e-6)
        self.light.entity.set_pose(sapien.Pose(middle + [0.0, 0.0, LIGHT_HEIGHT]))
        self.light.color = GLOW_COLOUR * power

    def thinned(self, density: float) -> float:
        """The density of smoke [1/m] that a spectator sees instead of `density` [1/m]."""
        most = SPECTATOR_DEPTH / self.across
        return most * (1.0 - math.exp(-density / most))

    def show_soot(self, place: np.ndarray, burnt: np.ndarray, frame: int) -> None:
        """Show soot above `place` [m], [F, 3], which have burnt for the frames `burnt`, [F], at `frame`."""
        if self.soot is not None:
            self.soot.show(place, burnt, frame)

    def sooty(self, codes: np.ndarray, place: np.ndarray, fixed: np.ndarray) -> np.ndarray:
        """The char `codes`, [B], with the soot on things at `place` [m], [B, 3], that stay where they are (`fixed`)."""
        if self.soot is None:
            return codes
        share = np.where(fixed, SOOT_ON_THINGS * self.soot.above(place), 0.0)
        return np.where(share > FAINTEST, np.maximum(codes, 1.0 + np.floor(255.0 * share)), codes)

    def char(self, codes: np.ndarray) -> None:
        """Blacken and heat things by their char codes, [B]."""
        for k, parts in enumerate(self.charred):
            code = float(codes[k])
            if code != self.codes[k]:
                for material in parts:
                    material.transmission_roughness = code
                self.codes[k] = code


class FireEffects(SceneEffects):
    """The effects of a fire in each of E scenes. The mode `fast` leaves out smoke, soot, hot air and firelight."""

    layer: ClassVar[int] = 1

    @classmethod
    def of_scene(cls, place: Place) -> _SceneFire:
        lattices = max(1, *(len(spec.fires) for spec in place.batch))
        return _SceneFire(place, patches=min(roster_length(MOST_FRAMES, lattices), MOST_PATCHES))

    def show(self, world: World, fire: FireState, frame: Tensor) -> None:
        base = world.base_of(world.position, world.rotation, world.extent).cpu().numpy()
        rotation, centre = world.rotation.cpu().numpy(), world.position.cpu().numpy()
        on_things = (body_flames(fire) * (world.exists & ~world.away) / SCALE_LAST).cpu().numpy()
        flames, scales = floor_flames(fire, frame)
        place, scale = above_water(world, flames).cpu().numpy(), scales.cpu().numpy()
        on_floor = scale / SCALE_LAST
        broad = np.sqrt(world.extent[..., :2].prod(-1).cpu().numpy()) / BROAD_EDGE
        heat = np.concatenate([on_things * np.minimum(broad, 1.0), on_floor * FLOOR_HEAT], -1)
        times = frame.cpu().numpy() / FRAMES_PER_SECOND
        codes = char_codes(fire, times)
        frames, fixed = frame.cpu().numpy(), (world.exists & ~world.movable).cpu().numpy()
        age = np.where(on_floor > 0.0, frames[:, None] - fire.flame_birth.cpu().numpy(), 0)
        burnt = np.concatenate([fixed * FRAMES_PER_UPDATE * fire.burn_updates.cpu().numpy(), age], -1)
        sooted = np.concatenate([centre, place], 1)
        for e, scene in enumerate(self._scenes):
            time = float(times[e])
            scene.show_soot(sooted[e], burnt[e], int(frames[e]))
            scene.char(scene.sooty(codes[e], centre[e], fixed[e]))
            scene.show_things(np.concatenate([base[e], rotation[e]], -1), on_things[e], time)
            scene.show_floor(place[e], on_floor[e], time)
            sources, strength = np.concatenate([centre[e], place[e]]), np.concatenate([on_things[e], on_floor[e]])
            scene.show_smoke(sources, strength, heat[e], time)
            scene.show_light(sources, strength, time)
        self._fill(fire, world)

    def _fill(self, fire: State, world: World) -> None:
        """The layer of smoke under the ceiling of the robot's room, of fires that have one: those of `realistic`."""
        # absent from FireState
        told = [getattr(fire, name, None) for name in ("smoke_height", "smoke_density", "smoke_low_density")]
        if any(of is None for of in told):
            return
        here = (world.crew.own(of).cpu().tolist() for of in told if of is not None)
        for scene, low, *thick in zip(self._scenes, *here, strict=True):
            if scene.around is not None:
                scene.around.smoke(low, *(scene.thinned(k) if self.spectator else k for k in thick))


def above_water(world: World, place: Tensor) -> Tensor:
    """`place` [m], [E, F, 3], world frame, lifted to the surface of the water where it is below that."""
    if "water" not in world.fields:
        return place
    level = torch.maximum(place[..., 2], world.fields["water"](place))
    return torch.cat([place[..., :2], level[..., None]], -1)


def _lamp(scene: sapien.Scene) -> RenderPointLightComponent:
    """A light for the fire, dark as yet."""
    light = RenderPointLightComponent()
    light.color = np.zeros(3)
    light.shadow = False  # SAPIEN's default is True: six shadow maps, three times the time of a picture
    entity = sapien.Entity()
    entity.add_component(light)
    scene.add_entity(entity)
    return light
