"""A key goes to its server and to nobody else: no file, no text and no error holds it."""

from __future__ import annotations

import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import ClassVar

import pytest

from hazard_ms.agents.llm.agent import Llm
from hazard_ms.agents.llm.client import Client
from hazard_ms.agents.llm.endpoint import HIDDEN, endpoint
from hazard_ms.agents.llm.network.faults import RefusedError
from hazard_ms.agents.llm.scripted import ScriptedServer
from tests.agents.llm.conftest import Ground, Made
from tests.worlds.playground import play

SENTINEL = "sk-SENTINEL-0123456789abcdef"


@pytest.fixture
def keyed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HAZARD_MS_LLM_KEY", SENTINEL)


@pytest.mark.usefixtures("keyed")
@pytest.mark.parametrize("model", ["greedy", "not-json", "500", "401", "hang", "redirect", "429-then-ok"])
def test_no_output_holds_the_key(
    llm: Made, tmp_path: Path, model: str, capfd: pytest.CaptureFixture[str], caplog: pytest.LogCaptureFixture
) -> None:
    caplog.set_level("DEBUG")
    player = llm(model, deadline=0.4, tries=2, cache=str(tmp_path / "answers.sqlite"), trace=str(tmp_path / "trace"))
    told = [repr(player), repr(player._endpoint)]
    try:
        play(player, Ground(), most=10)
    except RuntimeError as error:
        told += [str(error), repr(error)]
    out, err = capfd.readouterr()
    told += [str(player.note), str(player.counters), out, err, caplog.text]
    files = [path.read_bytes() for path in tmp_path.rglob("*") if path.is_file()]
    assert files and SENTINEL.encode() not in b"".join(files)
    assert SENTINEL not in "".join(told)


@pytest.mark.usefixtures("keyed")
def test_the_server_gets_the_key_and_may_show_it_without_effect(llm: Made) -> None:
    """The model "401" says which key it got, as servers of vendors do."""
    with pytest.raises(RefusedError, match=r"Bearer \[key\]"):
        play(llm("401"), Ground())


def test_without_a_key_none_is_sent(llm: Made, monkeypatch: pytest.MonkeyPatch) -> None:
    """Not even one that the environment holds for another server."""
    monkeypatch.setenv("OPENAI_API_KEY", SENTINEL)
    with pytest.raises(RefusedError) as refused:
        play(llm("401"), Ground())
    assert str(refused.value).endswith("incorrect key provided:")


class Headers(BaseHTTPRequestHandler):
    """Keeps the headers of requests, and answers what cannot be read."""

    seen: ClassVar[list[str]] = []

    def log_message(self, format: str, *args: object) -> None:
        return

    def do_GET(self) -> None:  # noqa: N802
        self.do_POST()

    def do_POST(self) -> None:  # noqa: N802
        self.seen.append(str(self.headers))
        self.rfile.read(int(self.headers.get("content-length") or 0))
        self.send_response(200)
        self.send_header("Content-Length", "2")
        self.end_headers()
        self.wfile.write(b"{}")


@pytest.mark.parametrize("key", ["", "sk-our-own-key"])
def test_what_the_environment_holds_for_others_is_not_sent(monkeypatch: pytest.MonkeyPatch, key: str) -> None:
    """The client of openai sends organization, project and any headers that it finds there to every address."""
    for name in ("API_KEY", "ADMIN_KEY", "ORG_ID", "PROJECT_ID"):
        monkeypatch.setenv(f"OPENAI_{name}", SENTINEL)
    monkeypatch.setenv("OPENAI_CUSTOM_HEADERS", f"X-Secret: {SENTINEL}")
    monkeypatch.setenv("HAZARD_MS_LLM_KEY", key)
    Headers.seen.clear()
    with ThreadingHTTPServer(("127.0.0.1", 0), Headers) as listening:
        threading.Thread(target=listening.serve_forever, daemon=True).start()
        client = Client(endpoint(f"http://127.0.0.1:{listening.server_address[1]}/v1", "m"), 1, 0)
        client.greet()
        client.ask({"model": "m", "messages": []}, 10.0)
        listening.shutdown()
    sent = "".join(Headers.seen)
    assert len(Headers.seen) == 2 and SENTINEL not in sent
    assert ("authorization" in sent.lower()) == bool(key) and sent.count("Bearer sk-our-own-key") == 2 * bool(key)


def test_the_key_is_hidden_wherever_it_stands(monkeypatch: pytest.MonkeyPatch, server: ScriptedServer) -> None:
    monkeypatch.setenv("HAZARD_MS_LLM_KEY", SENTINEL)
    where = endpoint(server.address, "greedy")
    nest = {"a": [f"x{SENTINEL}y", {SENTINEL: 1}], "b": 2, "c": None}
    assert where.hide(nest) == {"a": [f"x{HIDDEN}y", {HIDDEN: 1}], "b": 2, "c": None}


@pytest.mark.parametrize(
    ("address", "told"),
    [
        ("http://models.example/v1", "must begin with https:// when a key is sent"),
        ("https://user:hunter2@models.example/v1", "must not contain a user"),
        ("https://models.example/v1?key=hunter2", "must not contain a user"),
        ("ftp://models.example/v1", "must begin with https"),
        ("models.example", "must begin with https"),
    ],
)
@pytest.mark.usefixtures("keyed")
def test_addresses_that_would_show_the_key_are_refused(address: str, told: str) -> None:
    with pytest.raises(ValueError, match=told) as refused:
        endpoint(address, "model")
    assert "hunter2" not in str(refused.value)


def test_addresses_that_keep_the_key_are_taken(monkeypatch: pytest.MonkeyPatch) -> None:
    assert endpoint("http://models.example/v1", "m").key == "", "without a key, nothing can leak"
    monkeypatch.setenv("HAZARD_MS_LLM_KEY", SENTINEL)
    for address in ("https://models.example/v1/", "http://127.0.0.1:1/v1", "http://localhost/v1", "http://[::1]:1/v1"):
        made = endpoint(address, "m")
        assert made.key == SENTINEL and made.base_url == address.rstrip("/")


def test_a_key_file_must_be_closed_to_others(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    place = tmp_path / "key"
    monkeypatch.setenv("HAZARD_MS_LLM_KEY_FILE", str(place))
    with pytest.raises(ValueError, match="must name a file"):
        endpoint("https://models.example/v1", "m")
    place.write_text(f"{SENTINEL}\n")
    place.chmod(0o640)
    with pytest.raises(ValueError, match="chmod 600"):
        endpoint("https://models.example/v1", "m")
    place.chmod(0o600)
    assert endpoint("https://models.example/v1", "m").key == SENTINEL
    place.write_text("short")
    with pytest.raises(ValueError, match="at least 6 characters, all of them printable ASCII, got 5"):
        endpoint("https://models.example/v1", "m")


def test_address_and_model_must_be_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.delenv("HAZARD_MS_LLM_BASE_URL")
    monkeypatch.delenv("HAZARD_MS_LLM_MODEL")
    with pytest.raises(ValueError, match="base_url must be the address of a server"):
        Llm()
    with pytest.raises(ValueError, match="model must name a model"):
        Llm(base_url="http://127.0.0.1:1/v1")
