"""YCB objects as ManiSkill downloads them: info_pick_v0.json, models/<id>/textured.obj and collision.ply."""

from __future__ import annotations

import re
from typing import Any

from hazard_ms.scenes.assets.intake.model import Model, ModelPart
from hazard_ms.scenes.assets.providers.base import DOWNLOAD, Provider

CATEGORIES = {  # words in a YCB name -> our category; others have none
    "apple": "apple",
    "banana": "banana",
    "orange": "orange",
    "bowl": "bowl",
    "mug": "mug",
    "plate": "plate",
    "scissors": "scissors",
    "knife": "knife",
    "hammer": "hammer",
    "bottle": "bottle",
    "bleach_cleanser": "bottle",
    "box": "box",
    "marker": "pen",
}
DENSITY = 1000.0  # [kg/m^3] ManiSkill's, where the file says nothing
FILLED = 0.5  # share of its bounding box that a thing fills [-] [ours]


class Ycb(Provider):
    """The YCB set: 77 household objects, scanned."""

    name = "ycb"
    download = f"{DOWNLOAD} ycb"
    licence = "CC-BY-4.0"
    author = "Calli et al., Yale-CMU-Berkeley Object and Model Set"
    place = "assets/mani_skill2_ycb"

    def ids(self, category: str | None = None) -> tuple[str, ...]:
        there = [
            i
            for i in self._table()
            if re.fullmatch(r"[\w\-]+", i) and (self.folder / "models" / i / "textured.obj").is_file()
        ]
        if not there:
            raise self.missing("models")
        return tuple(i for i in there if category is None or category_of(i) == category)

    def model(self, name: str) -> Model:
        """The description of an object, z up; its mass is ManiSkill's density times half the bounding box.

        Raises ValueError if its row cannot be read.
        """
        row = self._table()[self.known(name)]
        try:
            scale = float(row.get("scales", [1.0])[0])
            edges = [(b - a) * scale for a, b in zip(row["bbox"]["min"], row["bbox"]["max"], strict=True)]
            mass = FILLED * float(row.get("density", DENSITY)) * edges[0] * edges[1] * edges[2]
        except (AttributeError, KeyError, IndexError, TypeError, ValueError) as error:
            raise ValueError(f"ycb: the row of {name} in info_pick_v0.json cannot be read: {error!r}") from None
        file = self.folder / "models" / name / "textured.obj"
        source = f"ManiSkill's YCB, {name}"
        return Model(
            (ModelPart(str(file)),), "z", "-y", scale, category_of(name), mass, self.licence, self.author, source
        )

    def _table(self) -> dict[str, Any]:
        rows = self.read("info_pick_v0.json")
        if not isinstance(rows, dict):
            raise ValueError(
                f"ycb: {self.folder / 'info_pick_v0.json'} must hold an object with one entry per model, got "
                f"{type(rows).__name__}"
            )
        return rows


def category_of(name: str) -> str:
    """Our category of a YCB name, for example 025_mug; empty if there is none."""
    return next((ours for word, ours in CATEGORIES.items() if re.search(rf"_{word}(_|$)", name)), "")
