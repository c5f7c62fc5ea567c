"""What strangers can cost a server before they have shown the token: nothing that others would notice."""

from __future__ import annotations

import asyncio
import contextlib
import http.client
import resource
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path
from urllib.parse import urlsplit

import pytest
import uvicorn
from uvicorn.server import ServerState

from hazard_ms.cli.web import connections

FILES = 128  # files that the server may open; connections try to take more
MOST_LOG = 100_000  # of what the server writes meanwhile [bytes]
START = 90.0  # longest time until the server prints its address [s]


@pytest.fixture(scope="module")
def served(tmp_path_factory: pytest.TempPathFactory) -> Iterator[tuple[str, str, Path, Path]]:
    """Host and token of a server that may open few files, its folder, and the file of what it writes to stderr."""
    folder = tmp_path_factory.mktemp("served")
    results, log = folder / "results", folder / "log"
    command = [sys.executable, "-m", "hazard_ms.cli", "serve", "--folder", str(results)]
    limit = lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (FILES, FILES))  # noqa: E731
    with log.open("w") as errors:
        process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=errors, text=True, preexec_fn=limit)  # noqa: PLW1509
    assert process.stdout is not None
    parts = urlsplit(process.stdout.readline().strip())
    yield parts.netloc, parts.fragment.removeprefix("token="), results, log
    process.terminate()
    process.wait(30)


def answered(host: str, token: str) -> float:
    """Ask for the rescues under way. Returns how long the answer took [s]."""
    start = time.monotonic()
    connection = http.client.HTTPConnection(host, timeout=10)
    connection.request("GET", "/api/rescues", headers={"Authorization": f"Bearer {token}"})
    answer = connection.getresponse()
    assert answer.status == 200 and answer.read() == b"[]"
    return time.monotonic() - start


@pytest.mark.parametrize("said", [pytest.param(b"", marks=pytest.mark.long), b"GET / HTTP/1.1\r\nHost: 127"])
def test_idle_connections_keep_nobody_out_and_do_not_fill_the_disk(
    served: tuple[str, str, Path, Path], said: bytes
) -> None:
    host, token, _, log = served
    address = ("127.0.0.1", int(host.rpartition(":")[2]))
    with contextlib.ExitStack() as held:
        for _ in range(2 * FILES):
            made = held.enter_context(socket.create_connection(address, timeout=10))
            with contextlib.suppress(OSError):  # it was closed again
                made.sendall(said)
        assert max(answered(host, token) for _ in range(3)) < 5.0
        time.sleep(2.0)
        assert answered(host, token) < 5.0
    assert log.stat().st_size < MOST_LOG


def test_a_connection_that_says_nothing_is_closed(monkeypatch: pytest.MonkeyPatch) -> None:
    """In this process, where a connection can be given less time to show the token."""
    monkeypatch.setattr(connections, "TIME", 0.2)

    async def heard() -> bytes:
        config, made = uvicorn.Config(_nothing, log_level="critical"), connections.Connections()
        config.load()
        protocol = lambda: made.protocol(config=config, server_state=ServerState(), app_state={})  # noqa: E731
        server = await asyncio.get_running_loop().create_server(protocol, "127.0.0.1", 0)
        async with server:
            reader, writer = await asyncio.open_connection(*server.sockets[0].getsockname())
            try:
                return await asyncio.wait_for(reader.read(1), 10.0)
            except ConnectionResetError:
                return b""
            finally:
                writer.close()

    assert asyncio.run(heard()) == b""


async def _nothing(scope: object, receive: object, send: object) -> None:
    """Answers nobody."""


@pytest.mark.parametrize(
    "head", [b'Cookie: a="' + b"\\" * 60_000 + b'"\r\n', b"X: y\r\n" * 10_000, b"X: " + b"y" * 10**6 + b"\r\n"]
)
def test_long_heads_cost_no_time(served: tuple[str, str, Path, Path], head: bytes) -> None:
    host, token, _, log = served
    with socket.create_connection(("127.0.0.1", int(host.rpartition(":")[2])), timeout=10) as made:
        with contextlib.suppress(OSError):
            made.sendall(b"GET /api/rescues HTTP/1.1\r\nHost: " + host.encode() + b"\r\n" + head + b"\r\n")
        assert answered(host, token) < 2.0
        with contextlib.suppress(OSError):
            assert made.recv(12) in (b"HTTP/1.1 400", b"HTTP/1.1 403", b"")
    assert log.stat().st_size < MOST_LOG


def test_no_secret_is_kept_in_the_folder_and_none_is_taken_from_it(served: tuple[str, str, Path, Path]) -> None:
    """Who plants a file, or reads one, learns nothing: there is none."""
    _, token, results, _ = served
    assert token and list(results.rglob("*")) == []
