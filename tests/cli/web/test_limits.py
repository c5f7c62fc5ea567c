"""How many rescues a server has at once, and how long it keeps one that nobody looks at: a real server, real processes.

Nothing waits until a scene is built: a process counts from its start.
"""

from __future__ import annotations

import contextlib
import json
import time
import urllib.error
import urllib.request
from collections.abc import Callable, Iterator
from pathlib import Path
from urllib.parse import urlsplit

import pytest
from websockets.sync.client import ClientConnection, connect

from hazard_ms.cli.web.guard import PROTOCOL
from hazard_ms.cli.web.rescue import journal
from hazard_ms.cli.web.sessions import LOOK_ROUND
from tests.worlds.serving import Server, serving

pytestmark = [pytest.mark.render, pytest.mark.timeout(200)]

IDLE = 2.0  # time after which a rescue gives its process back [s]
SOON = 20.0  # longest time until a process has gone, on a crowded machine [s]


class Client:
    """A page of `server`, without a browser."""

    def __init__(self, server: Server) -> None:
        parts = urlsplit(server.address)
        self.server, self.host, self.token = server, parts.netloc, parts.fragment.removeprefix("token=")

    def begin(self) -> str:
        """Begin a rescue. Returns its name; raises ValueError with the words in which the server refuses it."""
        origin = {"Origin": f"http://{self.host}", "Authorization": f"Bearer {self.token}"}
        request = urllib.request.Request(f"http://{self.host}/api/rescues", b"{}", origin)
        try:
            with urllib.request.urlopen(request, timeout=60) as answer:
                return str(json.load(answer)["name"])
        except urllib.error.HTTPError as error:
            raise ValueError(f"{error.code}: {json.load(error)['error']}") from None

    @contextlib.contextmanager
    def looking(self, name: str) -> Iterator[ClientConnection]:
        """A page that shows the rescue called `name`, from the first word about it on."""
        address = f"ws://{self.host}/api/rescues/{name}/live"
        shown = [PROTOCOL, self.token]
        with connect(
            address, origin=f"http://{self.host}", subprotocols=shown, max_size=None, open_timeout=60
        ) as socket:  # type: ignore[arg-type]
            assert json.loads(socket.recv(60))["type"] == "building"
            yield socket

    def processes(self) -> set[int]:
        """The processes of rescues."""
        tasks = Path(f"/proc/{self.server.process.pid}/task").glob("*/children")
        found = {int(child) for task in tasks for child in task.read_text().split()}
        return {p for p in found if "spawn_main" in _read(Path(f"/proc/{p}/cmdline"))}


def _read(path: Path) -> str:
    try:
        return path.read_text()
    except OSError:  # it has ended
        return ""


def soon(holds: Callable[[], bool]) -> float:
    """Wait until something holds. Returns how long that took [s]."""
    start = time.monotonic()
    while not holds():
        assert time.monotonic() - start < SOON, "it must hold soon"
        time.sleep(0.1)
    return time.monotonic() - start


def test_a_rescue_too_many_is_refused_while_all_are_looked_at_and_else_takes_the_place_of_one(tmp_path: Path) -> None:
    folder = tmp_path / "rescues"
    with serving(folder, "--sessions", "1") as server:
        client = Client(server)
        first = client.begin()
        with client.looking(first):
            (process,) = client.processes()
            with pytest.raises(ValueError, match="400: at most 1 rescues can run at once"):
                client.begin()
            assert client.processes() == {process}
        second = client.begin()
        soon(lambda: process not in client.processes() and len(client.processes()) == 1)
        assert journal(folder, first).exists() and journal(folder, second).exists()


@pytest.mark.long
def test_a_rescue_that_nobody_looks_at_gives_its_process_back_and_goes_on_later(tmp_path: Path) -> None:
    folder = tmp_path / "rescues"
    with serving(folder, "--idle", str(IDLE / 60.0)) as server:
        client = Client(server)
        name = client.begin()
        with client.looking(name):
            (process,) = client.processes()
            time.sleep(IDLE + LOOK_ROUND + 1.0)
            assert client.processes() == {process}
        assert soon(lambda: not client.processes()) > IDLE - 0.5
        assert journal(folder, name).exists()
        with client.looking(name):
            assert len(client.processes() - {process}) == 1
