"""A rescue in this process: a script chooses what a page would."""

from __future__ import annotations

import json
import multiprocessing
import threading
from collections.abc import Iterator
from dataclasses import replace
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any

import pytest

from hazard_ms.cli.web.compare.shelf import Librarian, film_of
from hazard_ms.cli.web.playing import saving
from hazard_ms.cli.web.playing.link import PICTURES, Link
from hazard_ms.cli.web.playing.process import main, play
from hazard_ms.cli.web.rescue import Rescue, Taken, asked_for, journal, keep, read
from hazard_ms.evaluation.result import EpisodeResult
from hazard_ms.spec import registry


@pytest.fixture(autouse=True)
def few_pictures(monkeypatch: pytest.MonkeyPatch) -> None:
    """Films have a picture a second: drawing takes most of the time."""
    monkeypatch.setattr(saving, "EVERY", 30)


class Page(threading.Thread):
    """Looks around once, asks about a thing, sends what is not valid, and stops."""

    def __init__(self, connection: Connection) -> None:
        super().__init__(daemon=True)
        self.connection, self.heard, self.pictures = connection, dict[str, list[Any]](), set[str]()
        self.looking = ""  # the key of the first choice
        self.told = threading.Condition()
        self.start()

    def until(self, kind: str, seconds: float = 120.0) -> None:
        """Wait until a message of this kind has come."""
        with self.told:
            assert self.told.wait_for(lambda: kind in self.heard, seconds), f"{kind} must come, got {[*self.heard]}"

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
            with self.told:
                self.heard.setdefault(row["type"], []).append(row)
                self.told.notify_all()
            if row["type"] == "state" and row["phase"] == "asking":
                self.answer(row)

    def answer(self, row: dict[str, Any]) -> None:
        words = {choice["words"]: choice["key"] for choice in row["choices"]}
        self.ask(do="choose", number=row["number"], key="o999")
        self.ask(do="point", picture="r", across=2.0, down=0.5)
        self.ask(do="point", picture="r", across=0.5, down=0.9)
        self.ask(do="thing", name="<img src=x onerror=alert(1)>")
        if row["number"]:
            self.ask(do="choose", number=row["number"] - 1, key=self.looking)
        else:
            self.looking = words["look around here"]
        self.ask(do="choose", number=row["number"], key=words["stop"] if row["number"] else self.looking)

    def ask(self, **message: Any) -> None:
        self.connection.send_bytes(json.dumps(message).encode())


@pytest.mark.render
@pytest.mark.timeout(200)
def test_a_rescue_is_played_and_kept_and_its_replay_is_equal(tmp_path: Path) -> None:
    folder = tmp_path / "rescues"
    folder.mkdir()
    ours, theirs = multiprocessing.Pipe()
    page = Page(ours)
    rescue = asked_for({"seed": 0, "every": 16}, ())
    play(Link(theirs), rescue, folder)
    theirs.close()
    page.join(10)
    assert page.pictures == {*PICTURES}
    assert [row["verb"] for row in page.heard["row"]] == ["explore", "stop"]
    assert len([w for w in page.heard["refused"] if "choice must be one of" in w["why"]]) == 2
    assert len([w for w in page.heard["refused"] if "got one from an earlier decision" in w["why"]]) == 1
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


def played(rescue: Rescue, folder: Path) -> Page:
    """The page of a rescue that was played in this process."""
    ours, theirs = multiprocessing.Pipe()
    page = Page(ours)
    play(Link(theirs), rescue, folder)
    theirs.close()
    page.join(10)
    return page


@pytest.mark.long
@pytest.mark.render
@pytest.mark.timeout(300)
def test_a_process_that_dies_before_the_film_is_there_costs_nothing(tmp_path: Path) -> None:
    """The next process makes the film alone: nobody plays the rescue again, and its result stays as it was."""
    folder = tmp_path / "rescues"
    rescue = asked_for({"seed": 0, "every": 16}, ())
    keep(folder, rescue)
    context = multiprocessing.get_context("spawn")
    ours, theirs = context.Pipe()
    process = context.Process(target=main, args=(theirs, rescue, folder), daemon=True)
    process.start()
    theirs.close()
    page = Page(ours)
    page.until("over")
    process.kill()
    process.join()
    assert "kept" not in page.heard
    result = next(folder.glob("*.json"))
    before = result.read_bytes()
    assert not result.with_suffix(".mp4").exists()
    left = read(folder, rescue.name, ())
    assert left.over and [t.verb for t in left.taken] == ["explore", "stop"]
    again = played(left, folder)
    assert "state" not in again.heard and [row["verb"] for row in again.heard["row"]] == ["explore", "stop"]
    assert again.heard["kept"][0]["replay"] == "exact" and result.read_bytes() == before
    assert result.with_suffix(".mp4").stat().st_size > 0 and not journal(folder, rescue.name).exists()
    assert [path for path in folder.iterdir() if ".part" in path.name] == []


@pytest.mark.render
@pytest.mark.timeout(300)
def test_a_process_that_dies_before_the_result_is_there_costs_nothing(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Waits are simulated again, too; the folder may be called `.`, and only an exact replay is a demonstration."""
    (tmp_path / "rescues").mkdir()
    monkeypatch.chdir(tmp_path / "rescues")
    taken = (Taken("explore", None, 7), Taken("stop", None))
    rescue = replace(asked_for({"seed": 0, "every": 16}, ()), taken=taken, over=True)
    page = played(rescue, Path())
    assert [row["phase"] for row in page.heard["state"]] == ["over"]
    assert page.heard["kept"][0]["replay"] == "exact"
    assert Path(page.heard["kept"][0]["demonstration"]).is_relative_to(tmp_path / "rescues_demos")
    result = EpisodeResult.read(next(Path().glob("*.json")))
    assert [(d.verb, d.waited) for d in result.decisions] == [("explore", 7), ("stop", 0)]
    other = tmp_path / "other" / "changed.json"
    other.parent.mkdir()
    changed = replace(result, links=result.links[:-1])
    verdict, demonstration = saving.film(other, rescue.episode, changed, lambda frame: None, teaches=True)
    assert verdict.startswith("same score") and demonstration is None and not (tmp_path / "other_demos").exists()


@pytest.fixture
def stopping() -> Iterator[str]:
    """The name of an agent that looks around once and stops, registered as long as the test lasts."""
    registry.register_agent("stopping", "tests.examples.stopping:Stopping")
    yield "stopping"
    registry.unregister(registry.AGENTS["stopping"])


@pytest.mark.render
@pytest.mark.timeout(300)
def test_what_an_agent_did_in_watch_is_kept_and_compared(tmp_path: Path, stopping: str) -> None:
    """After it was taken back once: that is counted, since an agent may decide otherwise the second time."""
    folder = tmp_path / "rescues"
    rescue = asked_for({"kind": "watch", "agent": stopping, "seed": 0, "every": 16}, ())
    keep(folder, rescue)
    page = played(replace(rescue, gone_back=1), folder)
    assert page.heard["kept"][0]["replay"] == "exact" and page.heard["kept"][0]["demonstration"] is None
    assert not journal(folder, rescue.name).exists() and not (tmp_path / "rescues_demos").exists()
    (book,) = Librarian([folder]).look().books.values()
    result = book.kept.result
    assert (result.agent, result.seed, result.ended) == (stopping, 0, "stopped")
    assert [d.verb for d in result.decisions] == ["explore", "stop"] and result.counters == {"gone_back": 1.0}
    assert film_of(book.kept) == book.kept.path.with_suffix(".mp4") and result.wall_seconds > 1.0
    assert "<video" in book.kept.path.with_suffix(".html").read_text()
