"""The page and the JSON of `hazard-ms report`: out of folders, whole, and true to the results."""

from __future__ import annotations

import dataclasses
import json
import re
from pathlib import Path
from urllib.parse import unquote

import pytest

from hazard_ms.cli.__main__ import main
from hazard_ms.evaluation.comparison.folders import Kept, grouped
from hazard_ms.evaluation.metrics import value
from tests.worlds.courses import course, drawn, fate
from tests.worlds.files.html_pages import Reader

SKILLS = {"greedy": 0.6, "oracle": 0.95, "my.py:<Own>": 0.3}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Six episodes of three agents in fire, in two folders, and two of one agent in wind."""
    for agent, skill in SKILLS.items():
        for seed in range(6):
            place = tmp_path / "results" / ("first" if seed < 3 else "second") / f"{int(100 * skill)}-{seed}.json"
            place.parent.mkdir(parents=True, exist_ok=True)
            drawn(agent, seed, skill).write(place)
    for seed in range(2):
        drawn("greedy", seed, 0.6, "HazardWind-v1").write(tmp_path / "results" / f"wind-{seed}.json")
    return tmp_path


def test_the_page_is_whole_and_stands_alone(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    film = folder / "results" / "first" / "95-0.mp4"
    film.write_bytes(b"12345")
    film.with_suffix(".html").write_text("<script>what a stranger wrote</script>")
    page = folder / "made" / "a page.html"
    assert main(["report", str(folder / "results"), "-o", str(page)]) == 0
    reader, text = Reader(), page.read_text(encoding="utf-8")
    reader.feed(text)
    assert not reader.open and "<script" not in text and "http" not in re.sub(r"<pre>.*?</pre>", "", text)
    for told in ("HazardFire-v1", "HazardWind-v1", "my.py:<Own>", "Regret", "kitchen_b/05", "minus oracle"):
        assert told in reader.text
    links = [(page.parent / unquote(link)).resolve() for link in reader.links]
    assert len(links) == 20 + 1 and all(link.is_file() for link in links)  # each episode's page, and one film
    assert film.resolve() in links and film.with_suffix(".html").resolve() not in links
    assert not any("stranger" in link.read_text("utf-8") for link in links if link.suffix == ".html")
    assert str(page) in capsys.readouterr().out


def test_results_with_and_without_a_clock_are_not_compared() -> None:
    plain = drawn("greedy", 0, 0.6)
    clocked = dataclasses.replace(drawn("rule", 0, 0.6), clock="wall")
    made = grouped([Kept(plain, Path("a.json")), Kept(clocked, Path("b.json"))])
    assert [list(group.agents) for group in made] == [["greedy"], ["rule"]]
    assert made[1].title == f"{made[0].title}, clock wall"


def test_json_holds_the_scores(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["report", str(folder / "results" / "first"), str(folder / "results" / "second"), "--json"]) == 0
    said = json.loads(capsys.readouterr().out)
    (group,) = said["groups"]
    assert group["settings"] == "HazardFire-v1, split test, physics paper, robot fetch" and group["episodes"] == 6
    assert list(group["agents"]) == ["oracle", "greedy", "my.py:<Own>"]  # the best first
    means = {}
    for agent, skill in SKILLS.items():
        row, results = group["agents"][agent], [drawn(agent, seed, skill) for seed in range(6)]
        means[agent] = value([result.tally for result in results])
        assert row["value"]["mean"] == pytest.approx(means[agent]) and row["ended"] == {"time": 6}
        assert row["targets"] == 60 and row["rescued"] == sum(r.tally.rescued for r in results)
        assert row["skills"]["walk_to"]["unfinished"]["tries"] == sum(
            d.verb == "walk_to" and not d.ok for r in results for d in r.decisions
        )
        assert row["seconds_per_episode"] == pytest.approx(
            {"build": 2.0, "looks": 8.0, "physics": 6.0, "agent": 1.0, "rest": 3.0}
        )
    greedy, oracle = means["greedy"], means["oracle"]
    assert group["agents"]["greedy"]["regret"]["mean"] == pytest.approx(1 - greedy / oracle)
    apart = {(d["agent"], d["other"]): d["value"]["mean"] for d in group["differences"]}
    assert len(apart) == 6 and apart["greedy", "oracle"] == pytest.approx(greedy - oracle)


def test_without_an_oracle_there_is_no_regret(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    course("greedy", 0, [fate(5, None)]).write(tmp_path / "one.json")
    page = tmp_path / "page.html"
    assert main(["report", str(tmp_path), "-o", str(page), "--no-pages"]) == 0
    assert "Regret" not in page.read_text() and "Regret" not in capsys.readouterr().out
    assert not (tmp_path / "page_episodes").exists()


def test_what_is_no_result_is_named_and_left_out(folder: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (folder / "results" / "half.json").write_text('{"format"')
    page = folder / "page.html"
    assert main(["report", str(folder / "results"), "-o", str(page), "--no-pages"]) == 0
    assert "left out: " in capsys.readouterr().out and "half.json" in page.read_text()


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["nowhere"], "folder must be one that `hazard-ms evaluate -o FOLDER` wrote, got nowhere"),
        (["empty"], "folders must hold results of `hazard-ms evaluate -o FOLDER`, got none in empty"),
        (["results", "-o", "page.pdf"], "output must end in .html, got 'page.pdf'"),
        (["results", "copy"], "results must hold each episode of an agent once, got .*0.json and .*0.json"),
    ],
)
def test_what_cannot_be_compared_is_refused(
    words: list[str], said: str, folder: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(folder)
    (folder / "empty").mkdir()
    (folder / "copy").mkdir()
    drawn("greedy", 0, 0.6).write(folder / "copy" / "0.json")
    assert main(["report", *words]) == 2
    assert re.search(said, capsys.readouterr().err)
    assert not list(folder.glob("page*"))
