"""Reads models out of the Debian package sweethome3d-furniture, without installing it and without unpacking it to disk."""

from __future__ import annotations

import hashlib
import io
import re
import tarfile
import zipfile
from dataclasses import dataclass
from pathlib import Path

SHA256 = "3ccb90c63f9525e887a767b9cd5c8b6933b8b6b2973a615a5359ee68a2118668"  # sweethome3d-furniture_1.8-1_all.deb
LIBRARIES = {  # library -> licence of its models, debian/copyright and the LICENSE.TXT inside each library
    "BlendSwap-CC-0": "CC0-1.0",
    "BlendSwap-CC-BY": "CC-BY-3.0",
    "Scopia": "CC-BY-3.0",
    "KatorLegaz": "CC-BY-3.0-US",
}
NOT_CC0 = ("winchesterSofa", "winchesterArmchair")  # their own licence files say CC-BY 3.0


@dataclass(frozen=True)
class Model:
    """One model as its catalogue describes it: `size_cm` is width, depth, height; `rotation` is row-major or empty."""

    library: str
    path: str
    name: str
    author: str
    licence: str
    size_cm: tuple[float, float, float]
    rotation: tuple[float, ...]
    archive: zipfile.ZipFile

    def read(self, name: str) -> bytes:
        """A file that lies beside the model."""
        return self.archive.read(str(Path(self.path).parent / name))

    def names(self) -> list[str]:
        folder = str(Path(self.path).parent) + "/"
        return [n[len(folder) :] for n in self.archive.namelist() if n.startswith(folder)]


def open_package(deb: Path) -> dict[str, zipfile.ZipFile]:
    """The furniture libraries inside the package, by name."""
    data = deb.read_bytes()
    found = hashlib.sha256(data).hexdigest()
    if found != SHA256:
        raise ValueError(f"{deb.name} has sha256 {found}, the build is pinned to {SHA256}")
    with tarfile.open(fileobj=io.BytesIO(_member(data, "data.tar"))) as tar:
        paths = {Path(m.name).stem: m for m in tar.getmembers() if m.name.endswith(".sh3f")}
        return {name: zipfile.ZipFile(io.BytesIO(tar.extractfile(paths[name]).read())) for name in LIBRARIES}


def _member(data: bytes, prefix: str) -> bytes:
    """A member of an `ar` archive: 60-byte headers, contents padded to even length."""
    at = 8  # past the magic "!<arch>\n"
    while at < len(data):
        name, size = data[at : at + 16].decode().strip(), int(data[at + 48 : at + 58])
        if name.startswith(prefix):
            return data[at + 60 : at + 60 + size]
        at += 60 + size + size % 2
    raise ValueError(f"the package has no member {prefix!r}")


def find_models(libraries: dict[str, zipfile.ZipFile]) -> dict[str, Model]:
    """All models of all libraries by their path, "Scopia/scopia/bowl/bowl.obj"."""
    models = {}
    for library, archive in libraries.items():
        rows = _rows(archive.read("PluginFurnitureCatalog.properties").decode("latin-1"))
        for row in rows:
            path = row["model"].lstrip("/")
            licence = "CC-BY-3.0" if any(n in path for n in NOT_CC0) else LIBRARIES[library]
            models[f"{library}/{path}"] = Model(
                library=library,
                path=path,
                name=row["name"],
                author=_credit(library, row.get("creator", "")),
                licence=licence,
                size_cm=(float(row["width"]), float(row["depth"]), float(row["height"])),
                rotation=tuple(float(x) for x in row.get("modelRotation", "").split()),
                archive=archive,
            )
    return models


def _rows(text: str) -> list[dict[str, str]]:
    """Catalogue rows of a Java properties file whose keys are `field#number`."""
    rows: dict[int, dict[str, str]] = {}
    for line in re.sub(r"\\\n\s*", "", text).splitlines():
        match = re.match(r"(\w+)#(\d+)\s*=\s*(.*)", line.strip())
        if match:
            rows.setdefault(int(match[2]), {})[match[1]] = match[3]
    return [r for r in rows.values() if "model" in r]


def _credit(library: str, creator: str) -> str:
    """Scopia's licence asks to name eTeks beside Scopia for most of its models; we name both for all."""
    if library == "Scopia":
        return "Emmanuel Puybaret / eTeks and Scopia Visual Interfaces Systems, s.l. (http://www.scopia.es)"
    return {"KatorLegaz": "Andrew Kator and Jennifer Legaz (http://www.katorlegaz.com)"}.get(library, creator)
