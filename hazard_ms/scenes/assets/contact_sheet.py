"""One picture of all models, each in its own tile with name, size and mass: `hazard-ms assets sheet -o sheet.png`."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import sapien
from numpy.typing import NDArray

from hazard_ms.machine.render_backend import DEVICES, backend
from hazard_ms.scenes.assets.index import asset, asset_ids, asset_path
from hazard_ms.scenes.assets.rows import Asset
from hazard_ms.spec.storage.files import write

TILE = 220  # edge of a picture [pixels]
CAPTION = 30  # height of the words below it [pixels]
FIELD_OF_VIEW = 0.5  # [rad]: a lens long enough that sizes do not look distorted
DIRECTION = (0.55, -0.75, 0.5)  # from the model to the camera: models face -y
GROUND = (0.62, 0.65, 0.68)  # linear colour of the floor below
INK = (40, 40, 40)  # colour of words: red, green, blue

Image = NDArray[np.uint8]


def contact_sheet(ids: Sequence[str] | None = None, columns: int = 9) -> Image:
    """Pictures of the assets `ids`, or of all that have a model, [H, W, 3], RGB.

    Raises ValueError if nothing can draw on this machine.
    """
    if backend() == "none":
        raise ValueError("a contact sheet needs a renderer, got none on this machine: hazard-ms doctor says why")
    chosen = [asset(i) for i in (asset_ids() if ids is None else ids)]
    shown = [a for a in chosen if a.visual.endswith((".glb", ".jpg", ".png"))]
    studio = Studio() if any(a.visual.endswith(".glb") for a in shown) else None
    tiles = [captioned(studio.picture(a) if studio and a.visual.endswith(".glb") else flat(a), a) for a in shown]
    blank = np.full((TILE + CAPTION, TILE, 3), 255, np.uint8)
    tiles += [blank] * (-len(tiles) % columns)
    return np.concatenate(
        [np.concatenate(tiles[i : i + columns], axis=1) for i in range(0, len(tiles), columns)], axis=0
    )


def save_sheet(path: Path, ids: Sequence[str] | None = None, columns: int = 9) -> None:
    """Write the sheet as a PNG or JPEG file. Raises ValueError if the file cannot be written."""
    if path.suffix.lower() not in (".png", ".jpg", ".jpeg"):
        raise ValueError(f"a contact sheet must be a .png, .jpg or .jpeg file, got {path}")
    sheet = contact_sheet(ids, columns)
    write(path, cv2.imencode(path.suffix.lower(), sheet[..., ::-1])[1].tobytes())


class Studio:
    """A floor, two lights and a camera, in front of which one model stands at a time."""

    def __init__(self) -> None:
        render = sapien.render.RenderSystem(sapien.Device(DEVICES[backend()]))
        self.scene = sapien.Scene([sapien.physx.PhysxCpuSystem(), render])
        self.scene.set_ambient_light([0.55, 0.55, 0.55])
        self.scene.add_directional_light(
            [-0.2, 0.55, -1.0], [1.5, 1.45, 1.4], shadow=True, shadow_scale=4, shadow_map_size=2048
        )
        self.scene.add_directional_light([-0.8, -0.1, -0.5], [0.4, 0.42, 0.45])
        floor = self.scene.create_actor_builder()
        paint = sapien.render.RenderMaterial(base_color=[*GROUND, 1.0], roughness=0.95, specular=0.0)
        floor.add_box_visual(half_size=[60.0, 60.0, 0.5], material=paint)
        floor.initial_pose = sapien.Pose([0.0, 0.0, -0.5])
        floor.build_static(name="floor")
        self.camera = self.scene.add_camera("camera", TILE, TILE, FIELD_OF_VIEW, 0.01, 100.0)

    def picture(self, a: Asset) -> Image:
        """A picture of the model, [TILE, TILE, 3], shown one metre large so that light and shadow suit all sizes."""
        scale = 1.0 / float(np.linalg.norm(a.extent))
        builder = self.scene.create_actor_builder()
        builder.add_visual_from_file(str(asset_path(a.visual)), scale=[scale] * 3)
        model: Any = builder.build_kinematic(name=a.id)
        self.camera.entity.set_pose(view(np.array([0.0, 0.0, a.extent[2] * scale / 2]), distance=2.15))
        self.scene.update_render()
        self.camera.take_picture()
        seen = self.camera.get_picture("Color")[..., :3]
        self.scene.remove_actor(model)
        return (np.clip(seen, 0.0, 1.0) * 255).astype(np.uint8)


def view(target: NDArray[np.float64], distance: float) -> sapien.Pose:
    """A camera pose that looks at `target` [m], [3], from DIRECTION. SAPIEN's cameras look along x, y is left, z up."""
    back = np.array(DIRECTION) / np.linalg.norm(DIRECTION)
    left = np.cross([0.0, 0.0, 1.0], -back)
    left /= np.linalg.norm(left)
    pose = np.eye(4)
    pose[:3, :3] = np.stack([-back, left, np.cross(-back, left)], axis=1)
    pose[:3, 3] = target + distance * back
    return sapien.Pose(pose)


def flat(a: Asset) -> Image:
    """The picture of a texture, [TILE, TILE, 3]. Raises ValueError if its file cannot be read."""
    pixels = cv2.imread(str(asset_path(a.visual)))
    if pixels is None:
        raise ValueError(f"{a.visual} of the asset {a.id!r} must be a picture, got a file that cannot be read as one")
    return np.ascontiguousarray(cv2.resize(pixels, (TILE, TILE), interpolation=cv2.INTER_AREA)[..., ::-1])


def captioned(picture: Image, a: Asset) -> Image:
    """The picture, [H, W, 3], with the asset's name, size and mass below it."""
    words = np.full((CAPTION, TILE, 3), 255, np.uint8)
    size = " x ".join(f"{100 * e:.0f}" if e >= 0.1 else f"{100 * e:.1f}" for e in a.extent)
    second = f"{size} cm, {a.mass:g} kg, {a.faces} faces" if a.faces else a.kind
    for text, base in ((a.id, 12), (second, 25)):
        cv2.putText(words, text, (4, base), cv2.FONT_HERSHEY_SIMPLEX, 0.36, INK, 1, cv2.LINE_AA)
    return np.concatenate([picture, words])
