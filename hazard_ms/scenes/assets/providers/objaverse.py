"""Objaverse 1.0 as its own tool downloads it: glbs/<part>/<uid>.glb, metadata/<part>.json.gz, lvis-annotations.json.gz.

Licences differ from object to object, so an object whose licence is not on record cannot be had.
"""

from __future__ import annotations

import os
import re
from pathlib import Path

from hazard_ms.scenes.assets.intake.model import Model, model_of_file
from hazard_ms.scenes.assets.providers.base import Provider
from hazard_ms.spec.catalogue import CATEGORIES

LICENCES = {  # Objaverse's words -> SPDX
    "by": "CC-BY-4.0",
    "by-sa": "CC-BY-SA-4.0",
    "by-nc": "CC-BY-NC-4.0",
    "by-nc-sa": "CC-BY-NC-SA-4.0",
    "cc0": "CC0-1.0",
}
FOLDER = "HAZARD_MS_OBJAVERSE"  # environment variable: the folder, when it is not the tool's own


class Objaverse(Provider):
    """Models by many authors. Their units differ, so they are added with a size."""

    name = "objaverse"
    download = (
        'pip install objaverse; python -c "import objaverse; '
        "objaverse.load_objects(['<uid>']); objaverse.load_annotations(['<uid>'])\""
    )
    licence = ""
    author = ""
    place = ""

    def __init__(self, folder: Path | None = None) -> None:
        default = Path.home() / ".objaverse" / "hf-objaverse-v1"
        super().__init__(folder or Path(os.environ.get(FOLDER) or default))

    def ids(self, category: str | None = None) -> tuple[str, ...]:
        there = sorted(p.stem for p in (self.folder / "glbs").glob("*/*.glb") if re.fullmatch(r"[0-9a-f]{32}", p.stem))
        if not there:
            raise self.missing("objects")
        if category is None:
            return tuple(there)
        ours = self._categories()
        return tuple(i for i in there if ours.get(i) == category)

    def model(self, name: str) -> Model:
        """The description of an object, y up as in glTF. Raises ValueError if its licence is not on record."""
        file = next((self.folder / "glbs").glob(f"*/{self.known(name)}.glb"))
        rows = self.read(f"metadata/{file.parent.name}.json.gz")
        row = rows.get(name) if isinstance(rows, dict) else None
        word = row.get("license") if isinstance(row, dict) else None
        if word not in LICENCES:
            raise ValueError(f"objaverse: licence of {name} must be one of {', '.join(LICENCES)}, got {word!r:.100}")
        assert isinstance(row, dict)
        user = row.get("user")
        author = str(user.get("displayName") or user.get("username") or "")[:200] if isinstance(user, dict) else ""
        if not author and word != "cc0":
            raise ValueError(f"objaverse: {name} must have an author, since its licence asks for one, got none")
        plain = model_of_file(file)
        category = self._categories().get(name, "")
        source = f"Objaverse, {row.get('uri') or row.get('viewerUrl') or name}"[:300]
        return Model(plain.parts, plain.up, plain.front, 1.0, category, None, LICENCES[word], author, source)

    def _categories(self) -> dict[str, str]:
        """Our category of each object that LVIS names."""
        if not (self.folder / "lvis-annotations.json.gz").is_file():
            return {}
        rows = self.read("lvis-annotations.json.gz")
        found = {uid: ours for name, uids in rows.items() if (ours := category_of(name)) for uid in uids}
        return {str(uid): ours for uid, ours in found.items()}


def category_of(name: str) -> str:
    """Our category of an LVIS name, for example "Sofa" or "wineglass"; empty if there is none."""
    word = re.sub(r"_\(.*\)", "", name.lower()).replace("_", " ").strip()
    return next((c.name for c in CATEGORIES.values() if word == c.label or word in c.published.split(", ")), "")
