"""Who is let through the door of the server, and with which rules for browsers."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest
from starlette.testclient import TestClient
from starlette.websockets import WebSocketDisconnect

from hazard_ms.cli.web.app import application
from hazard_ms.cli.web.guard import PROTOCOL, file_key
from hazard_ms.cli.web.options import ServeOptions

TOKEN, PORT = "t" * 32, 8000
PAGE = f"http://127.0.0.1:{PORT}"


@pytest.fixture
def client(tmp_path: Path) -> Iterator[TestClient]:
    (tmp_path / "film.json").write_text("{}")
    app = application(ServeOptions(folder=(tmp_path,)), TOKEN, PORT)
    with TestClient(app, base_url=PAGE) as made:
        yield made


SHOWN = {"Authorization": f"Bearer {TOKEN}"}
OFFERED = [PROTOCOL, TOKEN]
LIVE = f"ws://127.0.0.1:{PORT}/api/rescues/a/live"


def test_the_page_is_the_same_for_everybody_and_the_token_opens_the_rest(client: TestClient) -> None:
    first = client.get("/")
    assert first.status_code == 200 and "hazard_ms" in first.text and TOKEN not in first.text
    assert client.get("/static/main.js").status_code == 200
    assert client.get("/api/rescues", headers=SHOWN).json() == []
    assert client.get("/files/0/film.json", headers=SHOWN).status_code == 200


def test_nothing_is_ever_put_into_a_cookie_which_other_ports_would_get(client: TestClient) -> None:
    for path in ("/", "/api/enter", "/api/rescues", "/files/0/film.json"):
        assert "set-cookie" not in client.get(path, headers=SHOWN).headers


@pytest.mark.parametrize("path", ["/api/rescues", "/api/setup", "/api/enter", "/files/0/film.json", "/staticx"])
@pytest.mark.parametrize("token", ["", "t", "x" * 32, "t" * 33])
def test_without_the_token_nothing_is_shown(client: TestClient, path: str, token: str) -> None:
    assert client.get(path, headers={"Authorization": f"Bearer {token}"}).status_code == 403
    assert client.get(path, params={"token": TOKEN}).status_code == 403  # addresses end in logs and histories
    client.cookies.set(f"hazard_ms_{PORT}", TOKEN)
    assert client.get(path).status_code == 403


def test_the_key_of_files_opens_files_and_nothing_else(client: TestClient) -> None:
    key = client.get("/api/enter", headers=SHOWN).json()["file_key"]
    assert key == file_key(TOKEN) and TOKEN not in key
    assert client.get(f"/files/{key}/0/film.json").text == "{}"
    assert client.get(f"/files/{key[:-1]}x/0/film.json").status_code == 403
    assert client.get(f"/files/{key}/../../api/rescues").status_code in (403, 404)
    assert client.get("/api/rescues", headers={"Authorization": f"Bearer {key}"}).status_code == 403
    assert client.post(f"/files/{key}/0/film.json", headers={"Origin": PAGE}).status_code == 403


def test_what_rescues_cannot_do_is_not_found(client: TestClient) -> None:
    answer = client.post(f"/api/rescues/{'a' * 16}/anything", json={}, headers={**SHOWN, "Origin": PAGE})
    assert answer.status_code == 404


@pytest.mark.parametrize("origin", ["http://evil.example", "null", "http://127.0.0.1:9000", "https://127.0.0.1:8000"])
def test_another_origin_is_refused_even_with_the_token(client: TestClient, origin: str) -> None:
    client.headers.update(SHOWN)
    assert client.get("/api/rescues", headers={"Origin": origin}).status_code == 403
    assert client.post("/api/rescues", json={}, headers={"Origin": origin}).status_code == 403
    with (
        pytest.raises(WebSocketDisconnect),
        client.websocket_connect("ws://127.0.0.1:8000/api/rescues/a/live", OFFERED, headers={"Origin": origin}),
    ):
        pass


@pytest.mark.parametrize(
    "host", ["evil.example", "evil.example:8000", "127.0.0.1:9000", "127.0.0.1.evil.example:8000", "localhost:8000"]
)
def test_another_name_of_this_machine_is_refused(client: TestClient, host: str) -> None:
    assert client.get("/", headers={"Host": host}).status_code == 403


def test_what_changes_something_must_say_its_origin(client: TestClient) -> None:
    client.headers.update(SHOWN)
    assert client.post("/api/rescues", json={}).status_code == 403
    with pytest.raises(WebSocketDisconnect), client.websocket_connect(LIVE, OFFERED):
        pass
    for offered in ([], [TOKEN], [PROTOCOL], [PROTOCOL, "x" * 32], [PROTOCOL, TOKEN, "more"]):
        with pytest.raises(WebSocketDisconnect), client.websocket_connect(LIVE, offered, headers={"Origin": PAGE}):
            pass
    with client.websocket_connect(LIVE, OFFERED, headers={"Origin": PAGE}) as socket:
        assert socket.receive_json()["type"] == "gone"


def test_answers_forbid_browsers_whatever_the_page_does_not_need(client: TestClient) -> None:
    policy = client.get("/", headers=SHOWN).headers["content-security-policy"]
    assert "default-src 'none'" in policy and "script-src 'self'" in policy and "unsafe" not in policy
    files = client.get("/files/0/film.json", headers=SHOWN).headers["content-security-policy"]
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
        ({"every": 4.0}, "every must be one of"),
        ({"every": True}, "every must be one of"),
        ({"load": ["evil.py"]}, "a setting of a rescue must be one of"),
    ],
)
def test_what_cannot_be_played_is_refused_in_plain_words(client: TestClient, body: dict, words: str) -> None:
    client.headers.update(SHOWN)
    answer = client.post("/api/rescues", json=body, headers={"Origin": PAGE})
    assert answer.status_code == 400 and words in answer.json()["error"]


def test_a_request_that_is_no_json_or_too_long_is_refused(client: TestClient) -> None:
    client.headers.update(SHOWN)
    for content in (b"[" * 3000, b"[]", b"x" * 10_000):
        assert client.post("/api/rescues", content=content, headers={"Origin": PAGE}).status_code == 400
