"""Starts the server of `hazard-ms serve`, on this machine alone."""

from __future__ import annotations

import contextlib
import json
import os
import secrets
import socket
from pathlib import Path

from hazard_ms.machine.files import make_folder
from hazard_ms.web.options import ServeOptions

HOST = "127.0.0.1"
KEY = ".serve.key"  # in the first folder, for its owner alone: the token and the port, so that pages survive a restart
BACKLOG = 128  # connections that wait to be taken [ours]
TOKEN_BYTES = 24  # of chance in a token [bytes] [ours]


def serve(options: ServeOptions) -> int:
    """Serve until the process is interrupted. Raises ValueError for options that are not allowed."""
    options.check()
    try:
        import uvicorn

        from hazard_ms.web.app import application
    except ImportError as error:
        raise ValueError(f"the page needs the extra web: pip install 'hazard_ms[web]' ({error})") from None
    make_folder(options.folders[0])
    token, port = _key(options.folders[0])
    with _listening(options.port, port) as listening:
        port = listening.getsockname()[1]
        _keep(options.folders[0], token, port)
        app = application(options, token, port)
        print(f"http://{HOST}:{port}/?token={token}", flush=True)
        config = uvicorn.Config(app, log_level="warning", server_header=False, ws_max_size=65536)
        with contextlib.suppress(KeyboardInterrupt):
            uvicorn.Server(config).run(sockets=[listening])
    return 0


def _listening(asked: int, last: int) -> socket.socket:
    """A socket at the port `asked`; for 0 at the `last` one if it is free. Raises ValueError for one that is taken."""
    for port in (asked,) if asked else (last, 0):
        made = socket.socket()
        made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            made.bind((HOST, port))
            made.listen(BACKLOG)  # whoever reads the address early waits, and is not refused
            return made
        except OSError as error:
            made.close()
            if asked:
                raise ValueError(f"port must be one that is free, got {asked}: {error.strerror}") from None
    raise ValueError("port must be one that is free, got none")


def _key(folder: Path) -> tuple[str, int]:
    """The token and the port of the last server of `folder`; new ones where there was none."""
    with contextlib.suppress(OSError, ValueError, KeyError, TypeError):
        row = json.loads((folder / KEY).read_text())
        token, port = row["token"], row["port"]
        if isinstance(token, str) and len(token) >= TOKEN_BYTES and isinstance(port, int) and 0 < port < 65536:
            return token, port
    return secrets.token_urlsafe(TOKEN_BYTES), 0


def _keep(folder: Path, token: str, port: int) -> None:
    """Keep the token and the port for the next server, in a file that nobody else can read."""
    path = folder / KEY
    opened = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_TRUNC | os.O_NOFOLLOW, 0o600)
    with os.fdopen(opened, "w") as file:
        os.fchmod(file.fileno(), 0o600)
        json.dump({"token": token, "port": port}, file)
