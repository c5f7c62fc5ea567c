"""Watches what this process does outside of one folder: what it writes there, starts, connects to and imports."""

from __future__ import annotations

import os
import sys
from pathlib import Path
from typing import Any

WRITING = os.O_WRONLY | os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_APPEND
NEVER = ("subprocess.Popen", "socket.connect", "pickle.find_class", "pty.spawn", "winreg.*", "code.interact")
CALLS = ("system", "exec", "fork", "forkpty", "posix_spawn", "spawn", "startfile", "putenv", "kill")
PATHS = ("remove", "rename", "mkdir", "rmdir", "link", "symlink", "chmod", "chown", "truncate", "utime", "setxattr")
FORBIDDEN = {*NEVER, *(f"os.{call}" for call in CALLS)}
CHANGING = {*(f"os.{call}" for call in PATHS), "shutil.rmtree", "shutil.move", "shutil.copyfile"}


def watch(folder: Path, module: str) -> list[str]:
    """The list to which from now on everything is added that reading files in `folder` must not do.

    `module`: the name of one that the files name, and that must not be imported.
    """
    found: list[str] = []
    sys.dont_write_bytecode = True  # modules that are imported only now
    top = os.path.realpath(folder)

    def outside(path: Any) -> bool:
        if isinstance(path, int) or path is None:
            return False
        real = os.path.realpath(os.path.join(top, os.fsdecode(path)))
        return real != os.devnull and os.path.commonpath((top, real)) != top

    def hook(event: str, told: tuple[Any, ...]) -> None:
        writes = event == "open" and isinstance(told[2], int) and told[2] & WRITING and outside(told[0])
        changes = event in CHANGING and any(outside(path) for path in told[:2] if isinstance(path, (str, bytes, Path)))
        imports = event == "import" and told[0] == module
        if writes or changes or imports or event in FORBIDDEN:
            found.append(f"{event} {told!r:.300}")

    sys.addaudithook(hook)
    return found
