"""Who is let through the door of the server, and with which rules for browsers."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from starlette.testclient import TestClient
from starlette.websockets import WebSocketDisconnect

from hazard_ms.web.app import application
from hazard_ms.web.options import ServeOptions

TOKEN, PORT = "t" * 32, 8000
PAGE = f"http://127.0.0.1:{PORT}"


@pytest.fixture
def client(tmp_path: Path) -> Iterator[TestClient]:
    (tmp_path / "film.json").write_text("{}")
    app = application(ServeOptions(folder=(tmp_path,)), TOKEN, PORT)
    with TestClient(app, base_url=PAGE) as made:
        yield made


def test_the_token_in_the_address_opens_the_page_and_stays_in_a_cookie(client: TestClient) -> None:
    first = client.get(f"/?token={TOKEN}")
    assert first.status_code == 200 and "hazard_ms" in first.text
    cookie = first.headers["set-cookie"]
    assert "HttpOnly" in cookie and "SameSite=Strict" in cookie
    assert client.get("/static/main.js").status_code == 200
    assert client.get("/api/rescues").json() == []


@pytest.mark.parametrize("path", ["/", "/static/main.js", "/api/rescues", "/api/setup", "/files/0/film.json"])
@pytest.mark.parametrize("token", ["", "t", "x" * 32, "t" * 33])
def test_without_the_token_nothing_is_shown(client: TestClient, path: str, token: str) -> None:
    assert client.get(path, params={"token": token}).status_code == 403
    client.cookies.set(f"hazard_ms_{PORT}", token)
    assert client.get(path).status_code == 403


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "http://127.0.0.1:9000", "https://127.0.0.1:8000"])
def test_another_origin_is_refused_even_with_the_token(client: TestClient, origin: str) -> None:
    client.get(f"/?token={TOKEN}")
    assert client.get("/api/rescues", headers={"Origin": origin}).status_code == 403
    assert client.post("/api/rescues", json={}, headers={"Origin": origin}).status_code == 403
    with (
        pytest.raises(WebSocketDisconnect),
        client.websocket_connect("ws://127.0.0.1:8000/api/rescues/a/live", headers={"Origin": origin}),
    ):
        pass


@pytest.mark.parametrize("host", ["evil.example", "evil.example:8000", "127.0.0.1:9000", "127.0.0.1.evil.example:8000"])
def test_another_name_of_this_machine_is_refused(client: TestClient, host: str) -> None:
    assert client.get(f"/?token={TOKEN}", headers={"Host": host}).status_code == 403


def test_what_changes_something_must_say_its_origin(client: TestClient) -> None:
    client.get(f"/?token={TOKEN}")
    assert client.post("/api/rescues", json={}).status_code == 403
    with pytest.raises(WebSocketDisconnect), client.websocket_connect("ws://127.0.0.1:8000/api/rescues/a/live"):
        pass
    with client.websocket_connect("ws://127.0.0.1:8000/api/rescues/a/live", headers={"Origin": PAGE}) as socket:
        assert socket.receive_json()["type"] == "gone"


def test_answers_forbid_browsers_whatever_the_page_does_not_need(client: TestClient) -> None:
    policy = client.get(f"/?token={TOKEN}").headers["content-security-policy"]
    assert "default-src 'none'" in policy and "script-src 'self'" in policy and "unsafe" not in policy
    files = client.get("/files/0/film.json").headers["content-security-policy"]
    assert "sandbox" in files and "script-src" not in files and "allow-scripts" not in files


@pytest.mark.parametrize(
    ("body", "words"),
    [
        ({"env_id": "HazardFyre-v1"}, "env_id must be one of"),
        ({"seed": -1}, "seed must be"),
        ({"seed": True}, "seed must be"),
        ({"scene": "/etc/passwd.json"}, "scene must be"),
        ({"kind": "watch", "agent": "os:system"}, "agent must be one of"),
        ({"every": 3}, "every must be one of"),
        ({"load": ["evil.py"]}, "a setting of a rescue must be one of"),
    ],
)
def test_what_cannot_be_played_is_refused_in_plain_words(client: TestClient, body: dict, words: str) -> None:
    client.get(f"/?token={TOKEN}")
    answer = client.post("/api/rescues", json=body, headers={"Origin": PAGE})
    assert answer.status_code == 400 and words in answer.json()["error"]


def test_a_request_that_is_no_json_or_too_long_is_refused(client: TestClient) -> None:
    client.get(f"/?token={TOKEN}")
    for content in (b"[" * 3000, b"[]", b"x" * 10_000):
        assert client.post("/api/rescues", content=content, headers={"Origin": PAGE}).status_code == 400
