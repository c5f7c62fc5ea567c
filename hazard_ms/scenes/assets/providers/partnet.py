"""PartNet-Mobility cabinets and faucets as ManiSkill downloads them.

Their files are dataset/<id>/mobility_cvx.urdf or mobility_fixed.urdf. As models of ours they are furniture
with everything shut: all joints at zero.
"""

from __future__ import annotations

import functools
import xml.etree.ElementTree as ET  # documents with entities are refused before they are parsed
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from hazard_ms.scenes.assets.intake.model import Model, ModelPart
from hazard_ms.scenes.assets.providers.base import DOWNLOAD, Provider, read_json
from hazard_ms.scenes.assets.user_models import confined
from hazard_ms.spec.foreign.files import read_foreign

URDFS = ("mobility_cvx.urdf", "mobility_fixed.urdf")  # the first that is there
TABLES = {
    "info_cabinet_drawer_train.json": "cabinet",
    "info_cabinet_door_train.json": "cabinet",
    "info_faucet_train.json": "",
}
LARGEST_URDF = 4_000_000  # [bytes] [ours]
MOST_PARTS = 1000  # visual files of one URDF [ours]

Matrix = NDArray[np.float64]


class PartNetMobility(Provider):
    """PartNet-Mobility: furniture with doors and drawers."""

    name = "partnet-mobility"
    download = f"{DOWNLOAD} partnet_mobility_cabinet"
    licence = "PartNet-Mobility terms (non-commercial research)"
    author = "Xiang et al., SAPIEN; Mo et al., PartNet; Chang et al., ShapeNet"
    place = "partnet_mobility/dataset"

    def ids(self, category: str | None = None) -> tuple[str, ...]:
        rows = _table()
        there = [i for i in rows if self._urdf(i) is not None]
        if not there:
            raise self.missing("models")
        return tuple(i for i in there if category is None or rows[i][0] == category)

    def model(self, name: str) -> Model:
        """The description of a piece of furniture, z up, doors towards -x. Raises ValueError if it cannot be read."""
        category, scale = _table()[self.known(name)]
        urdf = self._urdf(name)
        assert urdf is not None
        return Model(
            parts(urdf), "z", "-x", scale, category, None, self.licence, self.author, f"PartNet-Mobility, {name}"
        )

    def _urdf(self, name: str) -> Path | None:
        return next((path for file in URDFS if (path := self.folder / name / file).is_file()), None)


@functools.cache
def _table() -> dict[str, tuple[str, float]]:
    """Category and scale of every model of which ManiSkill has the metadata, by id; they come with the package."""
    import importlib.util

    found = importlib.util.find_spec("mani_skill")
    assert found is not None and found.origin is not None
    folder = Path(found.origin).parent / "assets/partnet_mobility/meta"
    return {
        i: (ours, float(row["scale"])) for file, ours in TABLES.items() for i, row in read_json(folder / file).items()
    }


def parts(urdf: Path) -> tuple[ModelPart, ...]:
    """The files that a URDF shows, placed as they are with all joints at zero.

    Raises ValueError for a URDF that cannot be read.
    """
    data = read_foreign(urdf, LARGEST_URDF)
    if not data or b"<!" in data.replace(b"<!--", b""):
        raise ValueError(f"{urdf} must be a plain URDF, got an empty file, or one with entities")
    try:
        tree = ET.fromstring(data)  # noqa: S314
        places = _places(tree)
        found = [
            ModelPart(
                str(confined(urdf.parent, mesh.attrib["filename"])),
                tuple((places[link.attrib["name"]] @ _origin(visual) @ _scale(mesh)).ravel()),
            )
            for link in tree.findall("link")
            for visual in link.findall("visual")
            for mesh in visual.findall("geometry/mesh")
        ]
    except (ET.ParseError, KeyError, ValueError, RecursionError) as error:
        raise ValueError(f"{urdf} cannot be read: {error}") from None
    if not 0 < len(found) <= MOST_PARTS:
        raise ValueError(f"{urdf} must show 1 to {MOST_PARTS} files, got {len(found)}")
    return tuple(found)


def _places(tree: ET.Element) -> dict[str, Matrix]:
    """The place of each link in the frame of the root, [4, 4]."""
    above = {_linked(joint, "child"): (_linked(joint, "parent"), _origin(joint)) for joint in tree.findall("joint")}
    placed: dict[str, Matrix] = {}
    for link in tree.findall("link"):
        name, place, steps = link.attrib["name"], np.eye(4), 0
        while name in above:
            name, origin = above[name]
            place, steps = origin @ place, steps + 1
            if steps > len(above):
                raise ValueError(f"links must form a tree, got a loop at {name!r:.100}")
        placed[link.attrib["name"]] = place
    return placed


def _linked(joint: ET.Element, end: str) -> str:
    """The name of the link at one end of a joint."""
    found = joint.find(end)
    if found is None:
        raise ValueError(f"a joint must have a {end}, got none")
    return found.attrib["link"]


def _origin(element: ET.Element) -> Matrix:
    """<origin xyz rpy>, [4, 4]: turned about x, then y, then z of the parent."""
    origin = element.find("origin")
    made = np.eye(4)
    if origin is not None:
        made[:3, 3] = _three(origin.get("xyz", "0 0 0"))
        (cr, cp, cy), (sr, sp, sy) = (f(_three(origin.get("rpy", "0 0 0"))) for f in (np.cos, np.sin))
        about_x = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
        about_y = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
        about_z = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
        made[:3, :3] = about_z @ about_y @ about_x
    return made


def _scale(mesh: ET.Element) -> Matrix:
    return np.diag([*_three(mesh.get("scale", "1 1 1")), 1.0])


def _three(text: str) -> Matrix:
    values = np.array([float(word) for word in text.split()])
    if values.shape != (3,) or not np.isfinite(values).all():
        raise ValueError(f"a vector must be three numbers, got {text!r:.100}")
    return values
