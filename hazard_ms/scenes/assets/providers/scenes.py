"""Whole scenes that ManiSkill downloads and builds: ReplicaCAD, ArchitecTHOR, RoboCasa.

They are listed if their files are there. `build` is called from an environment's `_load_scene`, and returns ManiSkill's
scene builder: its `scene_objects`, `movable_objects` and `articulations` hold what was built.
"""

from __future__ import annotations

import abc
import importlib
import importlib.util
import json
from pathlib import Path
from typing import Any

from hazard_ms.scenes.assets.intake.model import Model
from hazard_ms.scenes.assets.providers.base import DOWNLOAD, Provider

BUILDERS = "mani_skill.utils.scene_builder"


class SceneProvider(Provider):
    """A collection of scenes; ManiSkill's builder wants their numbers in its own list."""

    module: str  # of ManiSkill's builder
    builder: str  # its class

    @abc.abstractmethod
    def numbers(self) -> dict[str, int]:
        """The name and number of every scene that ManiSkill knows, whether downloaded or not."""

    @abc.abstractmethod
    def files(self, name: str) -> tuple[str, ...]:
        """The files below the folder without which the scene cannot be built."""

    def ids(self, category: str | None = None) -> tuple[str, ...]:
        """Names of the scenes that are there; empty for a category of things. Raises ValueError if there are none."""
        there = tuple(n for n in self.numbers() if all((self.folder / f).is_file() for f in self.files(n)))
        if not there:
            raise self.missing("scenes")
        return there if category is None else ()

    def model(self, name: str) -> Model:
        """The licence and author of a scene, without files: a scene is not a model."""
        return Model((), licence=self.licence, author=self.author, source=f"{self.name}, {self.known(name)}")

    def build(self, where: Any, name: str) -> Any:
        """Build the scene into every sub-scene of the environment `where`, and return ManiSkill's scene builder.

        The builder sets lights, so it needs a renderer. Raises ValueError if there is none.
        """
        self.known(name)
        self.check_maniskill()
        if not where.scene.can_render():
            raise ValueError(
                f"{self.name}: ManiSkill's scenes need a renderer, got none: see render_backend, or hazard-ms doctor"
            )
        made = getattr(importlib.import_module(self.module), self.builder)(where)
        made.build([self.numbers()[name]] * where.num_envs)
        return made


class ReplicaCad(SceneProvider):
    """ReplicaCAD: apartments of one plan, furnished in 90 ways."""

    name = "replicacad"
    download = f"{DOWNLOAD} ReplicaCAD"
    licence = "CC-BY-4.0"
    author = "Szot et al., ReplicaCAD"
    place = "scene_datasets/replica_cad_dataset"
    module, builder = f"{BUILDERS}.replicacad.scene_builder", "ReplicaCADSceneBuilder"

    def numbers(self) -> dict[str, int]:
        return _listed("replicacad/metadata/scene_configs.json")

    def files(self, name: str) -> tuple[str, ...]:
        return (f"configs/scenes/{name}.scene_instance.json",)


class ArchitecThor(SceneProvider):
    """ArchitecTHOR: ten large houses, drawn by architects."""

    name = "architecthor"
    download = f"{DOWNLOAD} AI2THOR"
    licence = "CC-BY-4.0"
    author = "Deitke et al., ProcTHOR; Khanna et al., ai2thor-hab"
    place = "scene_datasets/ai2thor"
    module, builder = f"{BUILDERS}.ai2thor.variants", "ArchitecTHORSceneBuilder"

    def numbers(self) -> dict[str, int]:
        return _listed("ai2thor/metadata/ArchitecTHOR.json")

    def files(self, name: str) -> tuple[str, ...]:
        return (
            f"ai2thor-hab/configs/scenes/ArchitecTHOR/{name}.scene_instance.json",
            "ai2thor-hab/configs/object_semantic_id_mapping.json",
        )


class RoboCasa(SceneProvider):
    """RoboCasa: kitchens of ten layouts in twelve styles each."""

    name = "robocasa"
    download = f"{DOWNLOAD} RoboCasa"
    licence = "MIT"
    author = "Nasiriany et al., RoboCasa"
    place = "scene_datasets/robocasa_dataset"
    module, builder = f"{BUILDERS}.robocasa.scene_builder", "RoboCasaSceneBuilder"
    layouts = (
        "one_wall_small",
        "one_wall_large",
        "l_shaped_small",
        "l_shaped_large",
        "galley",
        "u_shaped_small",
        "u_shaped_large",
        "g_shaped_small",
        "g_shaped_large",
        "wraparound",
    )
    styles = (
        "industrial",
        "scandanavian",
        "coastal",
        "modern_1",
        "modern_2",
        "traditional_1",
        "traditional_2",
        "farmhouse",
        "rustic",
        "mediterranean",
        "transitional_1",
        "transitional_2",
    )

    def numbers(self) -> dict[str, int]:
        """The number of each scene, "galley/rustic" for example: twelve styles of each layout in turn."""
        pairs = [f"{layout}/{style}" for layout in self.layouts for style in self.styles]
        return {name: number for number, name in enumerate(pairs)}

    def files(self, name: str) -> tuple[str, ...]:
        layout, style = name.split("/")
        file = layout.capitalize() if layout[1] == "_" else layout  # as the data set writes them
        return f"assets/scenes/kitchen_layouts/{file}.yaml", f"assets/scenes/kitchen_styles/{style}.yaml"


def _listed(file: str) -> dict[str, int]:
    """Names and numbers of the scenes in one of ManiSkill's own lists."""
    found = importlib.util.find_spec("mani_skill")
    assert found is not None and found.origin is not None
    rows = json.loads((Path(found.origin).parent / "utils/scene_builder" / file).read_text())["scenes"]
    return {row.removeprefix("./").removesuffix(".scene_instance.json"): number for number, row in enumerate(rows)}
