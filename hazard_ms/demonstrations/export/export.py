"""The command `hazard-ms demos export`: a dataset in another format, whole or not at all."""

from __future__ import annotations

import os
import shutil
from collections.abc import Callable
from pathlib import Path

from hazard_ms.demonstrations.export import chat, lerobot, maniskill, minari, tar
from hazard_ms.demonstrations.export.options import ExportOptions
from hazard_ms.demonstrations.export.source import Source
from hazard_ms.spec.checks import one_of
from hazard_ms.spec.storage.files import make_folder

# Each writes the episodes of a source into an empty folder, and returns the name in it that readers open.
WRITERS: dict[str, Callable[[Source, Path], str]] = {
    "maniskill": maniskill.write,
    "lerobot": lerobot.write,
    "minari": minari.write,
    "chat": chat.write,
    "tar": tar.write,
}
TAKEN_BY = {
    "obs": ("maniskill", "minari"),
    "states": ("maniskill",),
    "privileged": ("maniskill", "chat", "tar"),
    "language": ("lerobot",),
}


def export(options: ExportOptions) -> int:
    """Write the dataset of `options` in their format, and print where it is. Returns 0.

    The folder appears when everything is in it. Raises ValueError for options that do not fit the format, for a folder
    without a dataset, and for an output that exists already.
    """
    writer = WRITERS[one_of(options.format, WRITERS, "format")]
    for name, formats in TAKEN_BY.items():
        if getattr(options, name) and options.format not in formats:
            raise ValueError(f"format must be {' or '.join(formats)} for --{name}, got {options.format}")
    source = Source(options.folder, options.obs, options.states, options.privileged, options.load, options.language)
    output = Path(os.path.abspath(options.output))
    if output.exists() and (not output.is_dir() or any(output.iterdir())):
        raise ValueError(f"output must be a new or an empty folder, got {options.output}; name another")
    draft = output.with_name(f".{output.name}.part-{os.getpid()}")
    make_folder(draft)
    try:
        opened = writer(source, draft)
        os.replace(draft, output)
    finally:
        shutil.rmtree(draft, ignore_errors=True)
    print(f"{source.count} episodes of {source.common.env_id} by {source.common.agent}: {options.output / opened}")
    return 0
