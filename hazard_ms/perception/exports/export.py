"""`hazard-ms perception export`: writes a dataset in another layout, whole or not at all, picture by picture."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

from hazard_ms.perception.coco import tools
from hazard_ms.perception.exports import coco_folder, huggingface, yolo
from hazard_ms.perception.exports.source import Source
from hazard_ms.perception.layout import LICENCES
from hazard_ms.spec.checks import one_of
from hazard_ms.spec.foreign.files import read_foreign
from hazard_ms.spec.storage.files import flush, make_folder
from hazard_ms.spec.storage.parts import part_of

WRITERS: dict[str, Callable[[Source, Path], None]] = {
    "yolo": yolo.write,
    "hf": huggingface.write,
    "coco": coco_folder.write,
}
LARGEST_TABLE = 10_000_000  # of the licences [bytes] [ours]


def export(dataset: Path, to: str, output: Path) -> int:
    """Write `dataset` to the new folder `output` in the layout `to` (yolo, hf, coco). Returns the number of pictures.

    Raises ValueError for a dataset that cannot be read or exported, and where there is such a folder already.
    """
    write = WRITERS[one_of(to, WRITERS, "to")]
    tools()
    output = output.absolute()
    if os.path.lexists(output):
        raise ValueError(f"output must be a new folder, got {output}, which already exists")
    source = Source(dataset)
    make_folder(output.parent)
    with part_of(output) as part:
        if part is None:
            raise ValueError(
                f"output must be written by one export alone, got {output}, which another process is writing"
            )
        write(source, part)
        if (dataset / LICENCES).exists():
            (part / LICENCES).write_bytes(read_foreign(dataset / LICENCES, LARGEST_TABLE))
        for path in [*part.rglob("*"), part]:
            flush(path)
        if os.path.lexists(output):
            raise ValueError(f"output must be a new folder, got {output}, which another process has just made")
        os.rename(part, output)
        flush(output.parent)
    return sum(source.counts.values())
