"""`hazard-ms evaluate`: which episodes it plays, that it resumes, and that its table is that of the scores."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from hazard_ms.evaluation import sweep
from hazard_ms.evaluation.options import EnvOptions, SweepOptions
from hazard_ms.evaluation.result import DamagedResultError, EpisodeResult, file_hashes
from tests.worlds.results import result_of


def test_every_agent_plays_every_seed_in_a_file_of_its_own(tmp_path: Path) -> None:
    options = SweepOptions(agents=("greedy:give_up=2", "random"), episodes=3, seed=10, output=tmp_path)
    episodes = options.episode_options()
    wanted = [(agent, seed) for agent in options.agents for seed in (10, 11, 12)]
    assert sorted((e.agent, e.seed) for e in episodes) == sorted(wanted)
    assert all(e.split == "test" for e in episodes)
    places = {options.place(e) for e in episodes}
    assert len(places) == 6 and {place.parent for place in places} == {tmp_path}


def test_every_setting_has_files_of_its_own(tmp_path: Path) -> None:
    usual = EnvOptions(split="test")
    changes = ({"lighting": "night"}, {"effects": "off"}, {"physics": "realistic"}, {"affects_agent": True})
    others = [EnvOptions(**{"split": "test", **change}) for change in changes]  # type: ignore[arg-type]
    sweeps = [SweepOptions(env, episodes=1, output=tmp_path) for env in (usual, *others)]
    assert len({sweep.place(sweep.episode_options()[0]) for sweep in sweeps}) == len(sweeps)


BAD: list[dict[str, object]] = [
    {"episodes": -1},
    {"workers": -1},
    {"seed": -1},
    {"backend": "cloud"},
    {"timeout": 0.0},
    {"timeout": float("nan")},
    {"scenes": Path("no_such_folder")},
    {"env": EnvOptions("HazardQuake-v1")},
]


@pytest.mark.parametrize("bad", BAD, ids=str)
def test_bad_options_are_refused(bad: dict[str, object]) -> None:
    with pytest.raises(ValueError, match=next(iter(bad))):
        SweepOptions(**bad).episode_options()  # type: ignore[arg-type]


def test_names_that_no_file_can_have_are_refused_before_anything_is_played(tmp_path: Path) -> None:
    """An agent and a detector with long paths, each of them short enough alone."""
    agents, detector, folder = (f"rl:weights={'a' * 130}",), f"mask_rcnn:{'b' * 100}", tmp_path / "results"
    with pytest.raises(ValueError, match="of at most 255 bytes, got 2[0-9]{2}: give agents and perception shorter"):
        sweep.evaluate(SweepOptions(agents=agents, perception=detector, episodes=1, output=folder))
    assert not folder.exists()
    for alone in (SweepOptions(agents=agents, episodes=1), SweepOptions(perception=detector, episodes=1)):
        (tmp_path / alone.place(alone.episode_options()[0]).name).touch()


def test_a_folder_of_scenes_is_played_in_the_order_of_their_names(tmp_path: Path) -> None:
    """Seeds count the files, and begin again after the last one."""
    for name in ("room10", "room9", "yard", "notes.txt"):
        (tmp_path / name).with_suffix("" if name.endswith("txt") else ".json").touch()
    sweep = SweepOptions(agents=("greedy",), scenes=tmp_path, output=tmp_path / "results")
    played = sweep.episode_options()
    assert [(e.seed, e.scene) for e in played] == [
        (k, f"{tmp_path}/{name}.json") for k, name in enumerate(("room9", "room10", "yard"))
    ]
    assert [e.settings["scenes"] for e in played] == [e.scene for e in played]
    assert {"room9", "yard"} < {
        sweep.place(e).name.removeprefix("HazardFire-v1-").partition("-paper")[0] for e in played
    }
    more = SweepOptions(agents=("greedy",), scenes=tmp_path, episodes=4, seed=2).episode_options()
    assert [Path(str(e.scene)).stem for e in more] == ["yard", "room9", "room10", "yard"]
    assert SweepOptions().count == 25, "as many as a split of the benchmark has"


def test_what_is_there_is_not_played_again_and_the_table_holds_its_scores(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Greedy saves one of two equal targets in both episodes, random in one of two: 50 and 25 per cent."""
    options = SweepOptions(EnvOptions(split="test", lighting="night"), episodes=2, output=tmp_path)
    for episode in options.episode_options():
        saved = episode.agent == "greedy" or episode.seed == 0
        result_of(episode, saved).write(options.place(episode))
    before = {p.name: p.stat().st_mtime_ns for p in tmp_path.iterdir()}
    assert sweep.evaluate(options) == 0
    assert {p.name: p.stat().st_mtime_ns for p in tmp_path.iterdir()} == before
    printed = capsys.readouterr().out
    assert "50.0 [50.0, 50.0]" in printed and "25.0 [0.0, 50.0]" in printed and "2/4" in printed and "1/4" in printed
    assert "lighting night" in printed and "greedy: ended by 2 time; failures: none" in printed


def refill(options: SweepOptions, contents: dict[int, bytes]) -> None:
    """Write whole results of all episodes, but `contents` into the files of some, by place in the list."""
    for k, episode in enumerate(options.episode_options()):
        result_of(episode).write(options.place(episode))
        if k in contents:
            options.place(episode).write_bytes(contents[k])


QUITS = """
from hazard_ms import Agent
class Quits(Agent):
    def __init__(self):
        __import__("sys").exit(0)
    def reset(self, brief): ...
    def act(self, decision): ...
"""
WHOLE = result_of(SweepOptions().episode_options()[0]).to_json().encode()


@pytest.mark.parametrize(
    "damaged",
    [
        b"",
        bytes(len(WHOLE)),
        WHOLE[: len(WHOLE) // 2],
        b"\xff\xfe",
        b"[]",
        b"{}",
        b"[" * 100_000,
        WHOLE.replace(b'"targets": [', b'"targets": [1, '),
        WHOLE.replace(b'"frames": 1500', b'"frames": "many"'),
        WHOLE.replace(b'"value": 5.0', b'"value": null'),
        WHOLE.replace(b'"ended"', b'"stopped"'),
    ],
    ids=lambda content: content[:20].decode("latin-1"),
)
def test_a_damaged_file_is_no_result(damaged: bytes, tmp_path: Path) -> None:
    (tmp_path / "one.json").write_bytes(damaged)
    with pytest.raises(DamagedResultError, match=f"{tmp_path}/one.json must hold the result of an episode: "):
        EpisodeResult.read(tmp_path / "one.json")


def test_files_that_hold_no_whole_result_are_named_and_played_again(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The agent ends its process now, so what is played again has no result: the others are in the table."""
    (tmp_path / "own.py").write_text(QUITS)
    options = SweepOptions(agents=(f"{tmp_path}/own.py:Quits",), episodes=3, workers=1, output=tmp_path / "results")
    (tmp_path / "results").mkdir()
    refill(options, {0: b"", 2: WHOLE[:100]})
    assert sweep.evaluate(options) == 1
    printed = capsys.readouterr().out
    for k, told in ((0, "it is empty"), (2, "it must be valid JSON")):
        place = options.place(options.episode_options()[k])
        assert f"{place} must hold the result of an episode: " in printed and told in printed
        assert f"no result: {tmp_path}/own.py:Quits, seed {k}: RuntimeError: the agent {tmp_path}/own.py" in printed
    assert printed.count("is played again") == 2 and printed.count("got sys.exit(0) (own.py, line 5)") == 4
    assert "ended by 2 error, 1 time" in printed


@pytest.mark.parametrize("change", [(b'"format": 3', b'"format": 1'), (b'"hazard-ms": "', b'"hazard-ms": "0.0.1+')])
def test_results_of_another_format_or_version_are_refused_before_anything_is_played(
    change: tuple[bytes, bytes], tmp_path: Path
) -> None:
    options = SweepOptions(agents=("greedy",), episodes=2, output=tmp_path)
    first, second = options.episode_options()
    result_of(first).write(options.place(first))
    content = options.place(first).read_bytes()
    assert change[0] in content
    options.place(first).write_bytes(content.replace(*change))
    with pytest.raises(ValueError, match="format of|results of hazard-ms"):
        sweep.evaluate(options)
    assert options.place(first).read_bytes() == content.replace(*change) and not options.place(second).exists()


def test_a_broken_simulation_is_told_by_the_exit_code(tmp_path: Path) -> None:
    options = SweepOptions(agents=("greedy",), episodes=2, output=tmp_path)
    first, second = options.episode_options()
    result_of(first).write(options.place(first))
    result_of(second, ended="time").write(options.place(second))
    assert sweep.evaluate(options) == 0
    result_of(second, ended="simulation error").write(options.place(second))
    assert sweep.evaluate(options) == 1


def test_episodes_that_failed_are_played_again(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    options = SweepOptions(agents=("greedy",), episodes=3, output=tmp_path)
    for episode, ended in zip(options.episode_options(), ("time", "worker died", "too slow"), strict=True):
        result_of(episode, ended=ended).write(options.place(episode))
    kept = [sweep.kept(options, episode) is not None for episode in options.episode_options()]
    assert kept == [True, False, False]
    assert capsys.readouterr().out.count("holds an episode that failed") == 2


def test_episodes_are_played_again_when_their_agent_has_other_weights(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """The digest of "one" is that of FIPS 180-4's algorithm, by sha256sum."""
    monkeypatch.chdir(tmp_path)  # names of results hold these paths, which can be too long
    weights = Path("best.safetensors")
    weights.write_bytes(b"one")
    options = SweepOptions(agents=(f"rl:weights={weights}",), perception=f"small:{weights}", episodes=1)
    options = replace(options, output=tmp_path)
    (episode,) = options.episode_options()
    digest = "7692c3ad3540bb803c020b3aee66cd8887123234ea0c6e7143c0add73ff431ed"
    assert file_hashes(episode.agent, episode.perception) == {str(weights): digest}
    place = options.place(episode)
    replace(result_of(episode), files={str(weights): digest}).write(place)
    assert sweep.kept(options, episode) is not None
    weights.write_bytes(b"two")
    assert sweep.kept(options, episode) is None
    assert (
        capsys.readouterr().out
        == f"{place} was played with files that have changed since: its episode is played again\n"
    )


def test_agents_that_would_share_files_are_refused(tmp_path: Path) -> None:
    agents = ("rl:weights=a/b.safetensors", "rl:weights=a.b.safetensors")
    with pytest.raises(ValueError, match="got rl:weights=a/b.safetensors and rl:weights=a.b.safetensors"):
        sweep.evaluate(SweepOptions(agents=agents, episodes=1, output=tmp_path))


def test_an_unknown_agent_is_refused_before_anything_is_played(tmp_path: Path) -> None:
    for name in ("gready", "gready:give_up=2"):
        with pytest.raises(ValueError, match="did you mean 'greedy'"):
            sweep.evaluate(SweepOptions(agents=("random", name), episodes=1, output=tmp_path / "results"))
    assert not (tmp_path / "results").exists()


def test_a_result_is_replaced_whole(tmp_path: Path) -> None:
    """Who reads the older file still has it; and no draft is left."""
    place = tmp_path / "one.json"
    place.write_text("old")
    with place.open() as reader:
        result_of(SweepOptions().episode_options()[0]).write(place)
        assert reader.read() == "old"
    assert EpisodeResult.read(place).ended == "time" and list(tmp_path.iterdir()) == [place]


def test_a_folder_that_cannot_be_made_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").touch()
    with pytest.raises(ValueError, match=f"a writable folder, got {tmp_path}/file"):
        sweep.evaluate(SweepOptions(agents=("greedy",), episodes=1, output=tmp_path / "file"))


@pytest.mark.parametrize("other", [{"seed": 9}, {"env_id": "HazardFlood-v1"}, {"agent": "greedy"}, {"settings": {}}])
def test_a_result_counts_as_that_of_its_episode_only_if_it_is(tmp_path: Path, other: dict[str, object]) -> None:
    options = SweepOptions(agents=("random",), episodes=1, output=tmp_path)
    (episode,) = options.episode_options()
    own = result_of(episode)
    own.write(options.place(episode))
    assert sweep.kept(options, episode) == EpisodeResult.read(options.place(episode))
    replace(own, **other).write(options.place(episode))  # type: ignore[arg-type]
    assert sweep.kept(options, episode) is None
