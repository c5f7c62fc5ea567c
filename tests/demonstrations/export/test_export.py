"""The command `hazard-ms demos export`: whole or not at all, and clear about what it cannot do."""

from __future__ import annotations

from pathlib import Path
from typing import Any, NoReturn

import pytest

from hazard_ms.demonstrations.export import export as exporting
from hazard_ms.demonstrations.export.export import WRITERS, export
from hazard_ms.demonstrations.export.options import FORMATS, ExportOptions
from hazard_ms.demonstrations.export.source import Source, needed
from tests.worlds.recorded import dataset


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return dataset(tmp_path_factory.mktemp("recorded") / "HazardFire-v1/oracle").parents[1]


def test_help_offers_every_format() -> None:
    assert set(FORMATS) == set(WRITERS)


def test_the_dataset_in_a_folder_is_exported(
    recorded: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    output = tmp_path / "new/out"
    assert export(ExportOptions(recorded, "chat", output)) == 0
    assert len((output / "chat.jsonl").read_text().splitlines()) == 4
    assert f"2 episodes of HazardFire-v1 by oracle: {output / 'chat.jsonl'}" in capsys.readouterr().out
    assert [path.name for path in output.parent.iterdir()] == ["out"]


@pytest.mark.parametrize(
    ("wanted", "refusal"),
    [
        ({"format": "hdf5"}, "format must be one of maniskill, lerobot, minari, chat, tar, got 'hdf5'"),
        ({"format": "chat", "states": True}, "format must be maniskill for --states, got chat"),
        ({"format": "lerobot", "privileged": True}, "format must be maniskill or chat or tar for --privileged"),
    ],
)
def test_options_that_do_not_fit_are_refused(
    recorded: Path, tmp_path: Path, wanted: dict[str, Any], refusal: str
) -> None:
    with pytest.raises(ValueError, match=refusal):
        export(ExportOptions(recorded, output=tmp_path / "out", **wanted))
    assert not list(tmp_path.iterdir())


def test_a_folder_with_files_is_left_as_it_is(recorded: Path, tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("mine")
    with pytest.raises(ValueError, match="output must be a new or an empty folder, got"):
        export(ExportOptions(recorded, "chat", tmp_path))
    assert [path.name for path in tmp_path.iterdir()] == ["mine.txt"]


def test_nothing_is_left_of_an_export_that_fails(
    recorded: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def breaks(source: Any, folder: Path) -> NoReturn:
        (folder / "half.txt").write_text("half")
        raise RuntimeError("broken")

    monkeypatch.setitem(exporting.WRITERS, "chat", breaks)
    with pytest.raises(RuntimeError, match="broken"):
        export(ExportOptions(recorded, "chat", tmp_path / "out"))
    assert not list(tmp_path.iterdir())


def test_episodes_that_were_recorded_differently_are_refused(tmp_path: Path) -> None:
    dataset(tmp_path / "one", (5,))
    dataset(tmp_path / "one/two", (5,), obs="state")
    with pytest.raises(ValueError, match="folder must hold one dataset, got 2"):
        export(ExportOptions(tmp_path / "one", "chat", tmp_path / "out"))
    with (tmp_path / "one/manifest.jsonl").open("a") as manifest:
        manifest.write((tmp_path / "one/two/manifest.jsonl").read_text().replace("kitchen", "bedroom"))
    (tmp_path / "one/two/kitchen_b-00-s000010").rename(tmp_path / "one/bedroom_b-00-s000010")
    (tmp_path / "one/two/manifest.jsonl").unlink()
    with pytest.raises(ValueError, match="bedroom_b-00-s000010 must be recorded like the other"):
        export(ExportOptions(tmp_path / "one", "chat", tmp_path / "out"))


def test_a_missing_package_is_named_with_its_extra() -> None:
    assert needed("json", "lerobot").dumps([]) == "[]"
    with pytest.raises(
        ValueError,
        match=r"lerobot needs the package no_such_package, .*: pip install 'hazard_ms\[demos\]'",
    ):
        needed("no_such_package", "lerobot")


@pytest.mark.parametrize(
    ("robot", "names"),
    [("fetch", {0: "arm.shoulder_pan_joint", 11: "base.forward"}), ("g1", {0: "body.torso_joint", 14: "hands.1"})],
)
def test_every_number_of_an_action_has_a_name(tmp_path: Path, robot: str, names: dict[int, str]) -> None:
    source = Source(dataset(tmp_path, (5,), robot=robot))
    assert len(source.action_names) == len(set(source.action_names)) == {"fetch": 13, "g1": 17}[robot]
    assert {k: source.action_names[k] for k in names} == names
    assert all(row.key in source.action_text for row in source.actions)
