"""Tar files for WebDataset: the files of an episode follow each other and share the start of their names."""

from __future__ import annotations

import json
import tarfile
from pathlib import Path

from hazard_ms.demonstrations.export.source import Source
from hazard_ms.demonstrations.layout import PRIVILEGED, files_of

SHARD = 200 * 10**6  # bytes of a file, unless its first episode has more [ours]
ABOUT = "about.json"


def write(source: Source, folder: Path, size: int = SHARD) -> str:
    """Write `shard-000000.tar` and so on, of up to `size` bytes each, and about.json. Returns the names of the shards.

    The file `depth/000012.png` of an episode becomes `EPISODE.depth-000012.png`: WebDataset takes the name up to the
    first dot as the key of a sample, and the rest as the name of a part.
    """
    shards: list[tarfile.TarFile] = []
    room = 0
    try:
        for one in source:
            files = {name: path for name, path in files_of(one.folder).items() if source.privileged or _open(name)}
            bytes_needed = sum(path.stat().st_size + 2 * tarfile.BLOCKSIZE for path in files.values())
            if not shards or bytes_needed > room:
                if shards:
                    shards[-1].close()
                shards.append(tarfile.open(folder / f"shard-{len(shards):06d}.tar", "w"))
                room = size
            room -= bytes_needed
            for name, path in files.items():
                _add(shards[-1], f"{one.folder.name.replace('.', '-')}.{name.replace('/', '-')}", path)
    finally:
        if shards:
            shards[-1].close()
    about = {
        "env_id": source.common.env_id,
        "episodes": source.count,
        "shards": len(shards),
        "actions": source.action_text,
    }
    (folder / ABOUT).write_text(json.dumps(about, indent=1) + "\n")
    return f"shard-{{000000..{len(shards) - 1:06d}}}.tar"


def _open(name: str) -> bool:
    """Whether a file of an episode may be read by everybody."""
    return name.split("/")[0] != PRIVILEGED


def _add(shard: tarfile.TarFile, name: str, path: Path) -> None:
    """Add a file without owner and time, so that the same episodes give the same bytes."""
    entry = tarfile.TarInfo(name)
    entry.size = path.stat().st_size
    with path.open("rb") as file:
        shard.addfile(entry, file)
