"""The commands `hazard-ms llm ...`."""

from __future__ import annotations

import functools
import json
import signal
import subprocess
import sys
import urllib.request
from pathlib import Path

import pytest

from hazard_ms.cli.__main__ import main


@pytest.mark.parametrize(("model", "code", "told"), [("greedy", 0, "way=json"), ("letter-in-prose", 0, "way=letter")])
def test_a_model_that_can_play_is_recommended_a_way(
    model: str, code: int, told: str, capsys: pytest.CaptureFixture[str]
) -> None:
    """1,500 decisions of 900 tokens at 2 USD a million are 2.70 USD, and a little for what is written."""
    assert main(["llm", "check", "--base-url", "scripted", "--model", model, "--price-in", "2"]) == code
    out = capsys.readouterr().out
    assert f"It can play: --agent llm:{told}" in out and "1.35 million tokens read" in out and "2.70 USD" in out
    assert out.count("4/4") >= 4, "read, and as greedy"


@pytest.mark.parametrize("model", ["not-json", "401", "500"])
def test_a_model_that_cannot_play_is_said_to(model: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["llm", "check", "--base-url", "scripted", "--model", model, "--deadline", "0.3"]) == 1
    assert "It cannot play" in capsys.readouterr().out


def test_a_check_without_an_address_says_what_is_missing(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.delenv("HAZARD_MS_LLM_BASE_URL", raising=False)
    assert main(["llm", "check"]) == 2
    assert "base_url must be the address of a server" in capsys.readouterr().err
    assert main(["llm", "check", "--base-url", "http://127.0.0.1:1/v1", "--model", "m"]) == 2
    assert "must be the address of a running server" in capsys.readouterr().err


def test_pictures_of_decisions_need_a_result(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "t.jsonl").write_text("")
    assert main(["llm", "page", str(tmp_path / "t.jsonl"), "-o", str(tmp_path / "a.html"), "--pictures"]) == 2
    assert "--pictures needs --result" in capsys.readouterr().err
    assert not (tmp_path / "a.html").exists()


@pytest.mark.render
@pytest.mark.long
def test_a_page_shows_what_could_be_seen(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    agent = f"llm:base_url=scripted,model=refuse,most_calls=2,trace={tmp_path}"
    assert main(["play", "-a", agent, "-s", "1", "-o", str(tmp_path / "out.mp4")]) == 0
    (trace,) = tmp_path.glob("*.jsonl")
    words = ["llm", "page", str(trace), "--result", str(tmp_path / "out.json"), "-o", str(tmp_path / "a.html")]
    assert main(words) == 0 and "<img" not in (tmp_path / "a.html").read_text()
    assert main([*words, "--pictures"]) == 0
    asked = len(trace.read_text().splitlines())
    assert f"pictures: of {asked} of {asked} decisions" in capsys.readouterr().out
    assert (tmp_path / "a.html").read_text().count('<img src="data:image/jpeg;base64,') == 2 * asked


def test_the_scripted_server_serves_until_it_is_interrupted(capsys: pytest.CaptureFixture[str]) -> None:
    command = [sys.executable, "-m", "hazard_ms.cli", "llm", "serve-scripted"]
    # shells let their background jobs ignore it
    heard = functools.partial(signal.signal, signal.SIGINT, signal.SIG_DFL)
    server = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, preexec_fn=heard)
    assert server.stdout is not None
    address = server.stdout.readline().removeprefix("address: ").strip()
    with urllib.request.urlopen(f"{address}/models") as answer:
        assert "greedy" in [model["id"] for model in json.load(answer)["data"]]
    port = address.split(":")[2].split("/")[0]
    assert main(["llm", "serve-scripted", "--port", port]) == 2
    assert f"port must be free, got {port}" in capsys.readouterr().err
    server.send_signal(signal.SIGINT)
    out, err = server.communicate(timeout=240)
    assert server.returncode == 0 and out.endswith("stopped\n") and "Traceback" not in err
