"""Starts the server of `hazard-ms serve`, on this machine alone."""

from __future__ import annotations

import contextlib
import secrets
import socket

from hazard_ms.cli.web.options import ServeOptions
from hazard_ms.spec.storage.files import make_folder

HOST = "127.0.0.1"
TOKEN_BYTES = 24  # of chance in a token [bytes] [ours]
LARGEST_HEAD = 16 * 1024  # of the first line and the headers of a request [bytes] [ours]


def serve(options: ServeOptions) -> int:
    """Serve until the process is interrupted. Raises ValueError for options that are not allowed."""
    options.check()
    try:
        import uvicorn

        from hazard_ms.cli.web.app import application
        from hazard_ms.cli.web.connections import BACKLOG, Connections
    except ImportError as error:
        raise ValueError(f"the page needs the extra web: pip install 'hazard_ms[web]' ({error})") from None
    make_folder(options.folders[0])
    token = secrets.token_urlsafe(TOKEN_BYTES)  # of this server alone: what others learn after its end opens nothing
    with _listening(options.port) as listening:
        listening.listen(BACKLOG)  # whoever reads the address early waits, and is not refused
        port, connections = listening.getsockname()[1], Connections()
        app = application(options, token, port, connections.admit)
        print(f"http://{HOST}:{port}/#token={token}", flush=True)
        config = uvicorn.Config(
            app,
            log_level="error",  # a line for each bad request would fill disks
            server_header=False,
            backlog=BACKLOG,
            http=connections.protocol,  # type: ignore[arg-type]
            h11_max_incomplete_event_size=LARGEST_HEAD,
            ws_max_size=65536,
        )
        with contextlib.suppress(KeyboardInterrupt):
            uvicorn.Server(config).run(sockets=[listening])
    return 0


def _listening(port: int) -> socket.socket:
    """A socket at the `port`, 0: at any. Raises ValueError for one that is taken."""
    made = socket.socket()
    if port:
        made.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
    try:
        made.bind((HOST, port))
    except OSError as error:
        made.close()
        raise ValueError(f"port must be free, got {port}: {error.strerror}") from None
    return made
