"""A rescue in this process: a script chooses what a page would."""

from __future__ import annotations

import json
import multiprocessing
import threading
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import pytest

from hazard_ms.evaluation.result import EpisodeResult
from hazard_ms.web.playing.link import PICTURES, Link
from hazard_ms.web.playing.process import play
from hazard_ms.web.rescue import asked_for, journal


class Page(threading.Thread):
    """Looks around once, asks about a thing, sends what is not valid, and stops."""

    def __init__(self, connection: Connection) -> None:
        super().__init__(daemon=True)
        self.connection, self.heard, self.pictures = connection, dict[str, list[Any]](), set[str]()
        self.start()

    def run(self) -> None:
        while True:
            try:
                message = self.connection.recv_bytes()
            except (EOFError, OSError):
                return
            letter = message[:1].decode("latin-1")
            if letter in PICTURES:
                assert message[1:3] == b"\xff\xd8"  # a JPEG
                self.pictures.add(letter)
                continue
            row = json.loads(message)
            self.heard.setdefault(row["type"], []).append(row)
            if row["type"] == "state" and row["phase"] == "asking":
                self.answer(row)

    def answer(self, row: dict[str, Any]) -> None:
        words = {choice["words"]: choice["key"] for choice in row["choices"]}
        self.ask(do="choose", number=row["number"], key="o999")
        self.ask(do="point", picture="r", across=2.0, down=0.5)
        self.ask(do="point", picture="r", across=0.5, down=0.9)
        self.ask(do="thing", name="<img src=x onerror=alert(1)>")
        self.ask(do="choose", number=row["number"], key=words["stop" if row["number"] else "look around here"])

    def ask(self, **message: Any) -> None:
        self.connection.send_bytes(json.dumps(message).encode())


@pytest.mark.render
@pytest.mark.timeout(200)
def test_a_rescue_is_played_and_kept_and_its_replay_is_equal(tmp_path: Path) -> None:
    folder = tmp_path / "rescues"
    folder.mkdir()
    ours, theirs = multiprocessing.Pipe()
    page = Page(ours)
    rescue = asked_for({"seed": 0, "every": 8}, ())
    play(Link(theirs), rescue, folder)
    theirs.close()
    page.join(10)
    assert page.pictures == {*PICTURES}
    assert [row["verb"] for row in page.heard["row"]] == ["explore", "stop"]
    assert len([w for w in page.heard["refused"] if "choice must be one of" in w["why"]]) == 2
    assert "two numbers from 0 to 1" in page.heard["refused"][1]["why"]
    assert page.heard["pointed"][1]["why"] == "the robot has not seen it yet"
    kept = page.heard["kept"][0]
    assert kept["replay"] == "exact"
    result = EpisodeResult.read(next(folder.glob("*.json")))
    assert result.agent == "human" and result.ended == "stopped" and result.counters == {"third_person": 1.0}
    assert next(folder.glob("*.mp4")).stat().st_size > 0 and next(folder.glob("*.html"))
    episode = json.loads((Path(kept["demonstration"]) / "episode.json").read_text())
    assert episode["teacher"] == "human" and not episode["privileged"]
    assert not journal(folder, rescue.name).exists()
