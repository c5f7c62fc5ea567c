"""Makes visible before each picture what the simulator does not draw: the hazards, the light and the bag."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from hazard_ms.effects.entities import FRAMES_PER_SECOND
from hazard_ms.effects.looks import Looks, tell_of_first_picture
from hazard_ms.effects.raytracing.sensor import take_over, with_our_shaders
from hazard_ms.effects.shaders.pack import shader_config
from hazard_ms.simulation.building import extent_of_bag, pose_of
from hazard_ms.simulation.drawing.lighting import Lighting
from hazard_ms.simulation.drawing.moved_cameras import MovedCameras
from hazard_ms.simulation.world import World
from hazard_ms.tasks.episode.situation import Situation

CAMERAS = ("sensor_configs", "human_render_camera_configs")  # ManiSkill's keywords of cameras


def camera_settings(
    given: Mapping[str, Any], effects: str | None, num_envs: int, sim_backend: str
) -> dict[str, dict[str, Any]]:
    """ManiSkill's keywords of cameras, complete: those `given`, drawn with our shaders; `effects` None: without.

    Raises ValueError for unknown `effects`, and as `with_our_shaders` does.
    """
    pack = {} if effects is None else {"shader_pack": shader_config(effects)}
    return {name: with_our_shaders({**pack, **(given.get(name) or {})}, num_envs, sim_backend) for name in CAMERAS}


class Display:
    """The visible side of one built environment, made anew with every reconfiguration."""

    def __init__(
        self,
        situation: Situation,
        scene: Any,
        bags: Sequence[tuple[Any, list[Any]]],
        lights: Lighting | None,
        cameras: tuple[dict[str, Any], ...],
        mode: str,
        moved: MovedCameras,
    ) -> None:
        """Prepare to show the episodes of `situation` in ManiSkill's `scene`.

        `bags`: each robot with the actor of its bag in each environment; `cameras`: dictionaries of cameras by name;
        `mode` of effects; `moved`: the robots' cameras where they are not as in training.
        Cameras that use our ray tracing are replaced in place. Raises ValueError for one that uses SAPIEN's own.
        """
        self._situation, self._bags, self._lights, self._moved = situation, bags, lights, moved
        self.scene = scene
        self.renders = bool(scene.can_render())
        world = situation.world
        hazards = situation.episode.hazards
        self.effects = Looks(hazards, scene.sub_scenes, world.specs, world, mode) if self.renders else None
        for some in cameras:
            take_over(some, lambda: int(world.frame[0]) / FRAMES_PER_SECOND)

    def clear_air(self) -> None:
        """Draw no more smoke and haze between the cameras and what they see, but for spectators."""
        if self.effects is not None:
            self.effects.veiled = False

    def show(self, world: World, effects: bool = True, spectator: bool = False) -> None:
        """Show everything as it is now in `world`; call it before a picture is taken by the robot whose world it is.

        Without `effects`, only what has labels. For a `spectator` smoke is thinner than the robot sees it.
        """
        if self.renders and effects:
            tell_of_first_picture(on_cpu=not self.scene.sub_scenes[0].render_system.device.is_cuda())
        self._moved.show(world.chance.seed)
        depth = extent_of_bag()[2]
        for robot, bags in self._bags:
            mouths, headings = robot.bag_position().tolist(), robot.base_pose()[1].tolist()
            for bag, (x, y, z), heading in zip(bags, mouths, headings, strict=False):
                bag._objs[0].set_pose(pose_of((x, y, z - depth), heading).sp)
        if effects and self.effects is not None and self._lights is not None:
            self._lights.show(world.chance.seed, world.frame)
            self.effects.light(self._lights.air())
            self.effects.update(world, self._situation.episode.states, world.frame, spectator)
