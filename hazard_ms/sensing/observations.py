"""Observations of an environment: the task's own entries, the hazard image, and looks for skills and films."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cached_property
from typing import Any

import torch
from torch import Tensor

from hazard_ms.sensing.camera import NOTHING, metres, relabel
from hazard_ms.sensing.display import Display
from hazard_ms.sensing.hazard_image import enlarge, hazard_images, sample_points
from hazard_ms.sensing.label_camera import LabelCamera
from hazard_ms.sensing.labels import label_table
from hazard_ms.sensing.senses.picture_noise import noisy
from hazard_ms.sensing.senses.senses import DEGRADED, THERMAL, Frame, Senses
from hazard_ms.sensing.target_table import TargetTable
from hazard_ms.sensing.view import View
from hazard_ms.spec import Term
from hazard_ms.tasks.episode.situation import Situation

SLOTS = 32  # columns of the target table in observations: an episode has 5 to 29 targets (docs/benchmark.md 1)


class Observer:
    """The senses of one built environment, made anew with every reconfiguration."""

    def __init__(
        self,
        situation: Situation,
        terms: Sequence[Term],
        display: Display,
        sensors: dict[str, Any],
        labels: Tensor,
        senses: Sequence[str] = (),
        noise: int = 0,
    ) -> None:
        """Make the senses for the task's `terms`; `sensors`: cameras by name; `labels` [E, S]: see `labels_of`.

        `senses`: extra ones, see `hazard_ms.sensing.senses.senses`; `noise`: level of that in colour pictures, see
        `hazard_ms.sensing.senses.picture_noise`.
        """
        self.noise = noise
        self.situation, self.terms, self.display, self.sensors, self.labels = situation, terms, display, sensors, labels
        self.table = TargetTable(situation.world, SLOTS)
        self.senses = Senses(situation, senses)
        if DEGRADED in senses:
            display.clear_air()
        self._constant = {t.name: self._value(t) for t in terms if t.constant}

    @property
    def renders(self) -> bool:
        """Whether pictures can be taken."""
        return self.display.renders

    @cached_property
    def _label_camera(self) -> LabelCamera | None:
        return LabelCamera.beside(self.camera, self.display.scene)

    @property
    def camera(self) -> Any:
        """ManiSkill's camera in the robot's head. Raises KeyError if the environment was made without it."""
        return self.sensors[self.situation.agent.head_camera]

    def label_table(self, env: int = 0) -> dict[int, tuple[str, str]]:
        """Name and category of each id of a segmentation in scene `env`."""
        return label_table(self.situation.world, self.labels, env)

    def target_ids(self, env: int = 0) -> list[int]:
        """The id in a segmentation of scene `env` for each target of the entries extra/target_*; 0 without one."""
        numbers = self.labels[env].tolist()
        return [numbers.index(index) if index >= 0 else 0 for index in self.table.index[env].tolist()]

    def show(self, spectator: bool = False) -> None:
        """Show everything as it is now; call it before a picture is taken, with `spectator` in third person."""
        self.display.show(self.situation.world, spectator=spectator)

    def extra(self, hidden: bool) -> dict[str, Tensor]:
        """The task's own entries of the observation, float32 [E, N] each in its term's unit [SI]; all if `hidden`."""
        told = [t for t in self.terms if hidden or not t.hidden]
        known = {**self._constant, **self._of_targets([t for t in told if t.per_target and not t.constant])}
        return {t.name: known[t.name] if t.name in known else self._value(t) for t in told}

    def _value(self, term: Term) -> Tensor:
        value = term.of(self.situation)
        if value.ndim == 2 and value.dtype == torch.float32 and not term.per_target:
            return value
        return (self.table.of(value) if term.per_target else value).float().flatten(1)

    def _of_targets(self, terms: Sequence[Term]) -> dict[str, Tensor]:
        """The numbers of the `terms` of targets, [E, N] each, taken from those of all things at once."""
        if not terms:
            return {}
        values = [term.of(self.situation) for term in terms]
        columns = torch.cat([v if v.ndim == 3 else v[..., None] for v in values], dim=-1).float()
        widths = [v.shape[2] if v.ndim == 3 else 1 for v in values]
        taken = self.table.told(columns, widths).split([self.table.slots * width for width in widths], dim=1)
        return {term.name: part for term, part in zip(terms, taken, strict=True)}

    def add_hazard_image(self, obs: dict[str, Any], in_extra: bool) -> dict[str, Any]:
        """Put the hazard image of the head camera, [E, H, W, K], into an observation with sensor data.

        With `in_extra` it goes beside the task's entries: a point cloud drops all other data of the cameras.
        """
        name = self.situation.agent.head_camera
        if name not in self.sensors:
            return obs
        seen = obs["sensor_data"][name] if "sensor_data" in obs else None
        depth = seen["depth"] if seen is not None and "depth" in seen else self._textures(depth=True)["depth"]
        params = obs["sensor_param"][name] if "sensor_param" in obs else self.camera.get_params()
        place = obs["extra"] if in_extra or seen is None else seen
        place["hazard"] = enlarge(self._levels(depth, params), *depth.shape[1:3])
        if self.senses.chosen:
            self._add_senses(seen or {}, place, self._frame(depth, seen or {}, params))
        return obs

    def with_noise(self, obs: dict[str, Any]) -> dict[str, Any]:
        """An observation with the noise of the sensor in the colour pictures of all cameras, if there is any."""
        for name, seen in obs.get("sensor_data", {}).items():
            if "rgb" in seen:
                seen["rgb"] = self._noisy(seen["rgb"], name)
        return obs

    def _noisy(self, colour: Tensor, name: str) -> Tensor:
        """The picture `colour`, [E, H, W, 3], of the camera `name` as its sensor gives it."""
        return noisy(colour, self.noise, self.situation.world.chance, name) if self.noise else colour

    def labelled(self, segmentation: Tensor) -> Tensor:
        """Labels, int64 [E, H, W], of any camera's `segmentation` (see `hazard_ms.sensing.camera`)."""
        return relabel(segmentation, self.labels)

    def _frame(self, depth: Tensor, seen: dict[str, Tensor], params: dict[str, Tensor]) -> Frame:
        """What the head camera truly sees; `depth` as ManiSkill gives it, [E, H, W, 1]."""
        ids = seen["segmentation"] if "segmentation" in seen else self._textures(segmentation=True)["segmentation"]
        labels = self.labelled(ids)
        return Frame(
            depth[..., 0], labels, params["intrinsic_cv"], params["cam2world_gl"], self.situation.agent.head_camera
        )

    def _add_senses(self, seen: dict[str, Tensor], place: dict[str, Tensor], frame: Frame) -> None:
        """Put the thermal image, float32 [E, H, W, 1] [C], into `place`; degrade the colour and depth in `seen`."""
        if THERMAL in self.senses.chosen:
            place["thermal"] = self.senses.thermal(frame)[..., None]
        if DEGRADED in self.senses.chosen:
            colour, depth, _ = self.senses.degraded(seen.get("rgb"), metres(frame.depth), frame)
            if colour is not None:
                seen["rgb"] = colour
            if "depth" in seen:
                seen["depth"] = (depth * 1000.0).round().clamp(max=65535.0).to(torch.int32).to(torch.int16)[..., None]

    def _levels(self, depth: Tensor, params: dict[str, Tensor]) -> Tensor:
        """Levels of the K hazards at 16 x 16 points of the depth image, [E, K, 16, 16], each in its hazard's unit."""
        points = sample_points(depth, params["intrinsic_cv"], params["cam2world_gl"])
        return hazard_images(self.situation.episode.levels, points)

    def _textures(self, name: str = "", **wanted: bool) -> dict[str, Tensor]:
        every = dict.fromkeys(("rgb", "depth", "position", "segmentation", "normal", "albedo"), False)
        seen = (self.sensors[name] if name else self.camera).get_obs(**{**every, **wanted})
        # a GPU may have drawn what a CPU simulates
        return {name: image.to(self.labels.device) for name, image in seen.items()}

    def look(self) -> tuple[Tensor, View]:
        """One look of the first environment's head camera: its image [H, W, 3], uint8, and the view for the map."""
        labels = self._label_camera  # made before the scene is prepared, or its first picture would be empty
        self.display.show(self.situation.world)
        self._refresh()
        self.camera.capture()
        seen = self._textures(rgb=True, depth=labels is None, segmentation=labels is None)
        colour, view = self._view(seen if labels is None else labels.take(), seen["rgb"])
        return self._noisy(colour, self.situation.agent.head_camera)[0], view

    def picture(self, name: str) -> Tensor:
        """The first environment's picture of the camera `name` at the time of the last look, [H, W, 3], uint8."""
        self.sensors[name].capture()
        return self._noisy(self._textures(name, rgb=True)["rgb"], name)[0]

    def glance(self) -> View:
        """The view of a look without its image, in a third of the time."""
        if self._label_camera is None:
            return self.look()[1]
        self.display.show(self.situation.world, effects=False)
        self._refresh()
        return self._view(self._label_camera.take())[1]

    def _refresh(self) -> None:
        if self._label_camera is not None:
            self._label_camera.follow()
        self.display.scene.update_render(update_sensors=True, update_human_render_cameras=False)

    def _view(self, seen: dict[str, Tensor], colour: Any = None) -> tuple[Any, View]:
        """The `colour` and the view of "depth" in [mm] and "segmentation", [E, H, W, 1] each, degraded if asked for."""
        params = self.camera.get_params()
        levels = self._levels(seen["depth"], params)
        frame, depth = self._frame(seen["depth"], seen, params), seen["depth"]
        labels = frame.labels
        if DEGRADED in self.senses.chosen:
            colour, depth, _ = self.senses.degraded(colour, metres(frame.depth), frame)
            labels = torch.where(depth > 0.0, labels, NOTHING)
        return colour, View.of(depth, frame.intrinsic, frame.cam2world, labels, levels)
