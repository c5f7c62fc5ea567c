"""A server of the bridge as users start it, and the files of the other side in a folder, as users copy them."""

from __future__ import annotations

import contextlib
import shutil
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

ROOT = Path(__file__).parents[3]
CLIENT = ROOT / "hazard_ms" / "lerobot" / "hazard_client.py"
EXAMPLES = ROOT / "examples" / "bridge"


@contextlib.contextmanager
def serving(*words: str) -> Iterator[str]:
    """The address of `python -m hazard_ms.lerobot.server --port 0` with more `words`, which ends with the context."""
    command = [sys.executable, "-m", "hazard_ms.lerobot.server", "--port", "0", *words]
    with subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True) as process:
        try:
            assert process.stdout is not None
            yield process.stdout.readline().strip()
        finally:
            process.terminate()


def copied(folder: Path) -> Path:
    """The folder with the client and the examples in it."""
    for path in (CLIENT, *EXAMPLES.glob("*.py")):
        shutil.copy(path, folder)
    return folder
