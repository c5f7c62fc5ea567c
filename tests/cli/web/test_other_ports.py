"""Other servers of this machine see nothing that opens ours: in a real browser, with all that they receive tried out.

A browser sends cookies to every port of an address, and a page tries to reach its server again after that has ended.
"""

from __future__ import annotations

import http.client
import json
import re
import socket
import threading
import time
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import pytest

from hazard_ms.cli.web.rescue import asked_for, keep
from tests.worlds.serving import browsing, needs_browser, serving, text, until

pytestmark = [pytest.mark.long, pytest.mark.timeout(300), needs_browser]
LURE = b"""<!doctype html><img src=/pixel>
<script>fetch('/stored?' + encodeURIComponent(JSON.stringify(sessionStorage)))</script>"""


class Listener:
    """A server of somebody else: it answers everything with a page, and keeps all that it receives."""

    def __init__(self, port: int = 0) -> None:
        self.received: list[str] = []
        listener = self

        class Handler(BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                listener.received.append(f"{self.requestline}\n{self.headers}")
                self.send_response(200)
                self.send_header("Content-Type", "text/html")
                self.end_headers()
                self.wfile.write(LURE)

            def log_message(self, *words: Any) -> None:
                """Stay silent."""

        self.server = ThreadingHTTPServer(("127.0.0.1", port), Handler)
        self.port = self.server.server_address[1]
        threading.Thread(target=self.server.serve_forever, daemon=True).start()

    def close(self) -> None:
        self.server.shutdown()
        self.server.server_close()

    def words(self) -> set[str]:
        """All that could be a secret."""
        return set(re.findall(r"[\w-]{16,}", "\n".join(self.received)))


def status(address: str, path: str, word: str = "") -> int:
    """How a server answers a request that shows a word in every place where a secret may be."""
    host = urlsplit(address).netloc
    cookie = f"hazard_ms_{host.rpartition(':')[2]}={word}"
    connection = http.client.HTTPConnection(host, timeout=20)
    connection.request("GET", path, headers={"Authorization": f"Bearer {word}", "Cookie": cookie})
    return connection.getresponse().status


def opens(address: str, word: str) -> bool:
    """Whether a word opens anything."""
    paths = ("/api/rescues", f"/api/rescues?token={word}", f"/files/{word}/0/kept.json")
    return any(status(address, path, word) != 403 for path in paths) or shakes(address, word)


def shakes(address: str, word: str) -> bool:
    """Whether a WebSocket that offers a word is opened."""
    host = urlsplit(address).netloc
    with socket.create_connection(("127.0.0.1", int(host.rpartition(":")[2])), timeout=20) as made:
        head = f"GET /api/rescues/{'a' * 16}/live HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\n"
        upgrade = "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
        offer = f"Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: hazard_ms, {word}\r\n\r\n"
        made.sendall(f"{head}{upgrade}{offer}".encode())
        return b" 403 " not in made.recv(300).splitlines()[0]


def test_another_port_receives_nothing_that_opens_ours(tmp_path: Path) -> None:
    (tmp_path / "kept.json").write_text("{}")
    other = Listener()
    with serving(tmp_path) as server, browsing() as browser:
        token = server.address.partition("=")[2]
        assert status(server.address, "/api/rescues", token) == 200 and shakes(server.address, token)
        browser.get(server.address)
        until(lambda: browser.find_elements("css selector", "#play form"), 60)
        assert "token" not in browser.current_url and browser.get_cookies() == []
        browser.get(f"http://127.0.0.1:{other.port}/")
        until(lambda: any("/stored" in row for row in other.received), 30)
        browser.get(f"{server.address.partition('#')[0]}#watch")
        until(lambda: browser.find_elements("css selector", "#watch form"), 60)
        assert other.received and token not in "\n".join(other.received)
        assert [word for word in other.words() if opens(server.address, word)] == []
    other.close()


def test_who_takes_the_port_over_receives_nothing_that_opens_the_next_server(tmp_path: Path) -> None:
    """It gets the token of the server that has ended, also out of the tab's storage, and that opens nothing."""
    (tmp_path / "kept.json").write_text("{}")
    keep(tmp_path, rescue := asked_for({}, ()))
    with socket.create_server(("127.0.0.1", 0)) as free:
        port = free.getsockname()[1]
    with browsing() as browser:
        with serving(tmp_path, "--port", str(port)) as first:
            browser.get(first.address)
            until(lambda: browser.find_elements("css selector", "#play ul.plain button"), 60)
            browser.find_element("css selector", "#play ul.plain button").click()
            until(lambda: text(browser, "#play .title"), 30)
            first.kill()
        time.sleep(0.5)
        other = Listener(port)
        with serving(tmp_path) as second:
            until(lambda: any("websocket" in row.lower() for row in other.received), 30)
            browser.refresh()
            until(lambda: any("/stored" in row for row in other.received), 30)
            old, new = (server.address.partition("=")[2] for server in (first, second))
            assert old in other.words() and new not in "\n".join(other.received)
            assert [word for word in other.words() if opens(second.address, word)] == []
            browser.get(second.address)
            until(lambda: browser.find_elements("css selector", "#play ul.plain button"), 60)
            assert new not in "\n".join(other.received)
        other.close()
    assert json.loads((tmp_path / ".rescues" / f"{rescue.name}.journal").read_text())["name"] == rescue.name
