"""The contract of every provider of models: list, describe.

Data are only read, where their own download put them, and never fetched.
"""

from __future__ import annotations

import abc
import gzip
import io
import os
import zlib
from pathlib import Path
from typing import Any, ClassVar

from hazard_ms.scenes.assets.intake.model import Model
from hazard_ms.scenes.assets.user_models import confined
from hazard_ms.spec.foreign.files import printable, read_foreign
from hazard_ms.spec.foreign.plain import parse

LARGEST_JSON = 256_000_000  # unpacked [bytes]; Objaverse describes 5,000 objects in one file of 60 MB [ours]
DOWNLOAD = "python -m mani_skill.utils.download_asset"


def maniskill_folder() -> Path:
    """The folder in which ManiSkill keeps downloaded data: $MS_ASSET_DIR/data, else ~/.maniskill/data."""
    return Path(os.environ.get("MS_ASSET_DIR", os.path.join(os.path.expanduser("~"), ".maniskill"))) / "data"


class Provider(abc.ABC):
    """A collection of models on this machine."""

    name: ClassVar[str]
    download: ClassVar[str]  # the command that fetches the data
    licence: ClassVar[str]  # of all of it; empty where each model has its own
    author: ClassVar[str]
    place: ClassVar[str]  # of the data, below ManiSkill's folder

    def __init__(self, folder: Path | None = None) -> None:
        self.folder = folder or maniskill_folder() / self.place

    @abc.abstractmethod
    def ids(self, category: str | None = None) -> tuple[str, ...]:
        """Names of all that is there, or of those of a category. Raises ValueError if there is nothing."""

    @abc.abstractmethod
    def model(self, name: str) -> Model:
        """The description of `name`: files, frame, category, licence. Raises ValueError if it cannot be had."""

    def missing(self, what: str = "") -> ValueError:
        """The error that says what is missing and how to get it."""
        return ValueError(
            f"{self.name} must have {what or 'data'} in {self.folder}, got none; get them with: {self.download}"
        )

    def known(self, name: str) -> str:
        """The name, if it is one of the ids. Raises ValueError if it is not."""
        there = self.ids()
        if name not in there:
            few = ", ".join(there[:20]) + (f" and {len(there) - 20} more" if len(there) > 20 else "")
            raise ValueError(
                f"a model of {self.name} must be one of {few} on this machine, got {name!r:.100}; more: {self.download}"
            )
        return name

    def read(self, file: str) -> Any:
        """The content of a JSON file of the collection, packed or not. Raises ValueError if it is missing."""
        path = confined(self.folder, file)
        if not path.is_file():
            raise self.missing(file)
        return read_json(path)


def read_json(path: Path) -> Any:
    """The content of a JSON file, .gz or not. Raises ValueError if it is too large or not valid JSON."""
    try:
        data = read_foreign(path, LARGEST_JSON)
        if path.suffix == ".gz":
            data = gzip.GzipFile(fileobj=io.BytesIO(data)).read(LARGEST_JSON + 1)
        if len(data) > LARGEST_JSON:
            raise ValueError(f"it must have at most {LARGEST_JSON} bytes, got more")
        return parse(data, "it")
    except (OSError, EOFError, ValueError, zlib.error) as error:
        raise ValueError(f"{printable(str(path))} cannot be read: {error}") from None
