"""The commands `hazard-ms assets ...`; each imports what it needs when it is called, so that help is quick."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Literal

import tyro

from hazard_ms.evaluation.choices import flag, offer

PROVIDERS = ("ycb", "partnet-mobility", "objaverse")


def add(
    model: tyro.conf.Positional[str],
    category: str = "",
    name: str = "",
    mass: float | None = None,
    size: float | None = None,
    licence: str = "",
    author: str = "",
    source: str = "",
    up: Literal["x", "-x", "y", "-y", "z", "-z"] | None = None,
    front: Literal["x", "-x", "y", "-y", "z", "-z"] | None = None,
) -> int:
    """Add a model of your own: convert it, make collision shapes, measure surfaces, draw a preview.

    Scenes name it by its id.

    Args:
        model: A glb, gltf, obj, stl or ply file, or a model that you downloaded: ycb:025_mug, partnet-mobility:1000,
            objaverse:UID.
        category: Category of the catalogue; by default what the downloaded model says, if it does.
        name: Id of the model; by default made from the file's name.
        mass: Mass [kg]; by default estimated from volume and category.
        size: Longest edge [m]; by default the size in the file.
        licence: Licence of the model, such as CC-BY-4.0 or "own work"; downloaded models bring theirs.
        author: Author of the model.
        source: Origin of the model.
        up: Axis of the file that points up; by default y for glb, gltf and obj, else z.
        front: Axis of the file that the model faces; by default z if y is up, else -y.
    """
    import dataclasses

    from hazard_ms.scenes.assets.intake import adding
    from hazard_ms.scenes.assets.intake.model import model_of_file
    from hazard_ms.scenes.assets.providers import PROVIDERS, provider

    kind, colon, rest = model.partition(":")
    found = provider(kind).model(rest) if colon and kind in PROVIDERS else model_of_file(Path(model), up, front)
    given = {"category": category, "licence": licence, "author": author, "source": source, "up": up, "front": front}
    found = dataclasses.replace(found, **{key: value for key, value in given.items() if value})  # type: ignore[arg-type]
    made = adding.add(
        found, name or adding.free_name(rest if colon and kind in PROVIDERS else Path(model).stem), mass, size
    )
    extent = " x ".join(f"{e:.3g}" for e in made.extent)
    print(f"{made.id}: {made.category}, {extent} m, {made.mass:.3g} kg, {made.faces} faces")
    print(f"surfaces: {len(made.supports)}; files: {Path(made.visual).parent}")
    return 0


def list_all(category: str = "", provider: Annotated[str, offer(PROVIDERS)] = "") -> int:
    """List the shipped models and your own, or those of a collection that you downloaded.

    Args:
        category: List only this category.
        provider: Downloaded collection to list instead.
    """
    from hazard_ms.scenes.assets.index import asset, asset_ids
    from hazard_ms.scenes.assets.shipped import shipped_index
    from hazard_ms.scenes.assets.user_models import user_root
    from hazard_ms.spec.catalogue import category as known

    only = known(category).name if category else None
    if provider:
        from hazard_ms.scenes.assets.providers import provider as collection

        print("\n".join(collection(provider).ids(only)))
        return 0
    for each in asset_ids(category=only, users=True):
        a = asset(each)
        whose = "" if each in shipped_index() else f"yours, in {user_root()}"
        print(f"{a.id:24s} {a.kind:9s} {a.category:16s} {a.mass:7.3g} kg  {a.licence:14s} {whose}".rstrip())
    return 0


def remove(name: tyro.conf.Positional[str]) -> int:
    """Remove one of your own models.

    Args:
        name: Id of the model.
    """
    from hazard_ms.scenes.assets.intake import adding

    adding.remove(name)
    print(f"{name} removed")
    return 0


def sheet(output: Annotated[Path, flag("-o", "--output", old="out")] = Path("sheet.png"), category: str = "") -> int:
    """Render all models, shipped and your own, into one picture.

    Args:
        output: File to write.
        category: List only this category.
    """
    from hazard_ms.scenes.assets.contact_sheet import save_sheet
    from hazard_ms.scenes.assets.index import asset_ids
    from hazard_ms.spec.catalogue import category as known

    save_sheet(output, asset_ids(category=known(category).name if category else None, users=True))
    print(f"contact sheet: {output.resolve()}")
    return 0


AssetCommand = (
    Annotated[int, tyro.conf.subcommand(name="add", constructor=add)]
    | Annotated[int, tyro.conf.subcommand(name="list", constructor=list_all)]
    | Annotated[int, tyro.conf.subcommand(name="remove", constructor=remove)]
    | Annotated[int, tyro.conf.subcommand(name="sheet", constructor=sheet)]
)
