"""COCO data in the layout of COCO itself: annotations/instances_SPLIT.json, and pictures in SPLIT/.

File names in it are relative to SPLIT/, as loaders of COCO expect. Masks are compressed run lengths.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from hazard_ms.perception.exports.source import Picture, Source
from hazard_ms.perception.layout import instances, text_of


def write(source: Source, folder: Path) -> None:
    """Write the dataset into `folder`, which is empty. Raises ValueError for what cannot be exported."""
    (folder / "annotations").mkdir()
    for split in source.splits():
        (folder / split.name).mkdir()
        images, things = folder / ".images", folder / ".things"  # one row a line, put together at the end
        with images.open("w", encoding="utf-8") as of_images, things.open("w", encoding="utf-8") as of_things:
            for picture in split.pictures():
                (folder / split.name / picture.name).write_bytes(picture.content)
                of_images.write(text_of(image_row(picture)))
                of_things.writelines(text_of(row) for row in rows_of(picture))
        kinds = [{"id": number, "name": name, "supercategory": ""} for number, name in source.categories.items()]
        with (folder / "annotations" / instances(split.name)).open("w", encoding="utf-8") as file:
            file.write('{"info":{"description":"exported by hazard_ms"},"licenses":[],"categories":')
            file.write(text_of(kinds).rstrip("\n"))
            for key, path in (("images", images), ("annotations", things)):
                file.write(f',\n"{key}":[')
                file.writelines(_joined(path))
                file.write("]")
                path.unlink()
            file.write("}\n")


def _joined(path: Path) -> Iterator[str]:
    """The rows of a file, with commas between them."""
    with path.open(encoding="utf-8") as file:
        for k, line in enumerate(file):
            yield (",\n" if k else "\n") + line.rstrip("\n")


def image_row(picture: Picture) -> dict[str, Any]:
    """The row of `images` for a picture."""
    size = {"width": picture.width, "height": picture.height}
    return {"id": picture.id, "file_name": picture.name, **size, **picture.moment}


def rows_of(picture: Picture) -> Iterator[dict[str, Any]]:
    """The rows of `annotations` for the things of a picture."""
    for thing in picture.things:
        row = {
            "id": thing.id,
            "image_id": picture.id,
            "category_id": thing.category,
            "segmentation": thing.runs,
            "area": thing.area,
            "bbox": thing.box,
            "iscrowd": int(thing.crowd),
        }
        yield row | ({"attributes": dict(thing.state)} if thing.state else {})
