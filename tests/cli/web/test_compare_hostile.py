"""Files and addresses that mean harm: each is refused with a reason, and the page goes on without it."""

from __future__ import annotations

import json
import os
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any
from urllib.parse import quote

import pytest

from hazard_ms.cli.web.compare import shelf
from hazard_ms.evaluation.regret.causes import PARTS, EpisodeRegret, digest, place_of
from tests.worlds.asking import Asking
from tests.worlds.courses import course, drawn, fate

BAD = '<img src=x onerror="alert(1)">\u202e</script><script>alert(2)</script>'


def good(folder: Path) -> None:
    drawn("greedy", 0, 0.6).write(folder / "good.json")


def row(**changes: Any) -> str:
    made = course("greedy", 1, [fate(1, 100)]).to_dict()
    return json.dumps(made | changes)


def deep(changed: Callable[[dict[str, Any]], None]) -> str:
    made = drawn("greedy", 1, 0.6).to_dict()
    changed(made)
    return json.dumps(made)


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "it is empty"),
        ("[1, 2]", "it is not an object with a format"),
        ("[" * 100_000, "nested at most 64 deep"),
        (row(format=1), "the format of bad.json must be one of 2, 3, 4, got 1"),
        (row(format={}), "the format of bad.json must be one of 2, 3, 4"),
        (row(targets=[]), "targets must be of length 1 to 1000"),
        (row(max_frames=0), "max_frames must be a number from 1 to"),
        (row(frames=10**30), "a whole number must have at most 30 digits, got 31"),
        (row(seed=10**400), "a whole number must have at most 30 digits, got 401"),
        (row(wall_seconds=float("nan")), "numbers must be finite, got NaN"),
        (row(phase_seconds={"build": "long"}), "phase_seconds.build must be a number from .* got 'long'"),
        (row(phase_seconds={"build": float("inf")}), "numbers must be finite, got Infinity"),
        (row(agent="x" * 1001), "agent must be of length 0 to 1000, got 1001 characters"),
        (row(settings={"split": "y" * 5000}), "settings must have at most 4000 characters"),
        (row(agent="\ud800"), "agent must be valid Unicode, got '.ud800'"),
        (row(settings=["split"]), "AttributeError|settings"),
        (deep(lambda r: r["targets"][0].update(value=0.0)), "value must be a number from 1e-06 to"),
        (deep(lambda r: r["targets"][0].update(value=float("nan"))), "numbers must be finite, got NaN"),
        (deep(lambda r: r["targets"][0].update(damaged_frame=-5)), "damaged_frame must be .* got -5"),
        (deep(lambda r: r["decisions"][0].update(frames=-1)), "decisions\\[0\\].frames must be .* got -1"),
        (deep(lambda r: r["decisions"][0].update(value=float("inf"))), "numbers must be finite, got Infinity"),
        (deep(lambda r: r["decisions"][0].update(note="z" * 100_001)), "note must be a text of at most"),
        (deep(lambda r: r["decisions"][0].update(verb=7)), "verb must be a str, got 7"),
        (deep(lambda r: [target.update(value=0) for target in r["targets"]]), "."),
        (deep(lambda r: r["targets"][0].update(value=10**400)), "."),
        (deep(lambda r: r["targets"][0].update(frame=10**400)), "."),
        (deep(lambda r: r["decisions"][0].update(note=10**400)), "."),
    ],
)
def test_a_broken_result_is_named_and_left_out(text: str, said: str, tmp_path: Path) -> None:
    good(tmp_path)
    (tmp_path / "bad.json").write_text(text)
    asking = Asking(tmp_path)
    told = asking.get("/api/compare/folders").json
    (refused,) = told["refused"]
    assert refused["name"] == f"{tmp_path.name}/bad.json" and str(tmp_path) not in refused["reason"]
    assert re.search(said, refused["reason"]), refused["reason"]
    (group,) = asking.get("/api/compare/groups").json["groups"]
    assert group["results"] == 1
    assert asking.get(f"/api/compare/numbers?settings={quote(group['settings'])}").status == 200


@pytest.mark.parametrize(
    "changes",
    [
        {"lost": {"planning": "all"}},
        {"lost": []},
        {"decisions": ["walk"]},
        {
            "decisions": [
                {
                    "frame": 0,
                    "verb": "x",
                    "target": None,
                    "best": 1,
                    "regret": float("nan"),
                    "unseen": 0,
                    "execution": 0,
                }
            ]
        },
        {"start": float("inf")},
        {"format": 9},
        [],
    ],
)
def test_a_broken_regret_leaves_its_result(changes: Any, tmp_path: Path) -> None:
    path = tmp_path / "good.json"
    good(tmp_path)
    EpisodeRegret(digest(path), "greedy", 0, "x", 0.9, 0.5, dict.fromkeys(PARTS, 0.0), ()).write(place_of(path))
    made = json.loads(place_of(path).read_text())
    place_of(path).write_text(json.dumps(made | changes if isinstance(changes, dict) else changes))
    told = Asking(tmp_path).get("/api/compare/folders").json
    assert told["folders"][0]["results"] == 1
    (refused,) = told["refused"]
    assert refused["name"].endswith("/good.json") and refused["reason"].startswith("its regret: ")


def test_nothing_outside_of_the_folders_is_read(tmp_path: Path) -> None:
    outside, inside = tmp_path / "outside", tmp_path / "inside"
    outside.mkdir()
    inside.mkdir()
    good(inside)
    drawn("secret", 3, 0.5).write(outside / "secret.json")
    (outside / "film.mp4").write_bytes(b"secret film")
    (inside / "link.json").symlink_to(outside / "secret.json")
    (inside / "folder").symlink_to(outside)
    (inside / "good.mp4").symlink_to(outside / "film.mp4")
    (inside / ".serve.json").write_text('{"token": "secret"}')
    (inside / ".hidden").mkdir()
    drawn("secret", 4, 0.5).write(inside / ".hidden" / "a.json")
    os.mkfifo(inside / "pipe.json")  # reading it would never end
    asking = Asking(inside)
    told = asking.get("/api/compare/folders")
    assert b"secret" not in told.body and [row["name"] for row in told.json["folders"]] == ["inside"]
    reasons = {row["name"]: row["reason"] for row in told.json["refused"]}
    assert reasons == {
        "inside/link.json": "link.json must be a file, got a link",
        "inside/pipe.json": "pipe.json must be a file, got something else",
    }
    settings = quote(asking.get("/api/compare/groups").json["groups"][0]["settings"])
    cell = asking.get(f"/api/compare/numbers?settings={settings}").json["rows"][0]["cells"]["greedy"]
    assert not cell["film"]
    for place in ("../outside/secret", "..%2foutside%2fsecret.json", "/etc/passwd", cell["key"] + "/../x", "%00", ""):
        assert asking.get(f"/files/episode/{place}").status == 404, place
    for place in ("../outside/secret.json", "", "x"):
        assert asking.get(f"/api/compare/episodes?key={place}").status == 400, place
        assert asking.get(f"/api/compare/groups?folder={place}").status == 400, place
    assert asking.get("/api/compare/folders", token="wrong").status == 403


def test_sizes_are_bounded(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    for seed in range(6):
        course("greedy", seed, [fate(1, 100)]).write(tmp_path / f"{seed}.json")
    size = (tmp_path / "0.json").stat().st_size
    with (tmp_path / "huge.json").open("wb") as file:
        file.truncate(shelf.LARGEST + 1)
    asking = Asking(tmp_path)
    assert "must have at most 8388608 bytes" in asking.get("/api/compare/folders").json["refused"][0]["reason"]
    (tmp_path / "huge.json").unlink()
    monkeypatch.setattr(shelf, "LARGEST_IN_ALL", 4 * size + 40)
    told = Asking(tmp_path).get("/api/compare/folders").json
    assert told["folders"][0]["results"] == 4 and told["refused_count"] == 2
    monkeypatch.setattr(shelf, "MOST_FILES", 5)
    told = Asking(tmp_path).get("/api/compare/folders").json
    assert told["folders"] == [] and "at most 5 results" in told["refused"][0]["reason"]


def test_hostile_names_stay_text(tmp_path: Path) -> None:
    made = course(BAD, 0, [fate(5, 100)], settings={"split": BAD, "physics": "paper"}, ended=BAD).to_dict()
    made["targets"][0]["name"] = BAD
    decision = {
        "frame": 0,
        "verb": BAD,
        "target": BAD,
        "ok": False,
        "reason": BAD,
        "frames": 9,
        "note": BAD,
        "held": BAD,
    }
    (tmp_path / "a.json").write_text(json.dumps(made | {"decisions": [decision]}))
    (tmp_path / f"{BAD[:4]}.json").write_text("{}")
    asking = Asking(tmp_path)
    told = asking.get("/api/compare/folders")
    assert told.headers["content-type"] == "application/json" and told.headers["x-content-type-options"] == "nosniff"
    assert told.json["folders"][0]["agents"] == [{"name": BAD, "person": False}]
    (group,) = asking.get("/api/compare/groups").json["groups"]
    assert asking.get(f"/api/compare/numbers?settings={quote(group['settings'])}").json["agents"].keys() == {BAD}
    key = next(iter(shelf.Librarian([tmp_path]).look().books))
    (episode,) = asking.get(f"/api/compare/episodes?key={key}").json["episodes"]
    assert episode["decisions"][0]["verb"] == BAD and episode["targets"][0]["name"] == BAD
    page = asking.get(episode["page_link"])
    assert page.status == 200 and b"<script" not in page.body and b"<img" not in page.body
    assert (
        "sandbox" in page.headers["content-security-policy"]
        and "script-src" not in page.headers["content-security-policy"]
    )
