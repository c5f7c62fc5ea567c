"""Other collections, in small files of the layouts that their downloads have.

Listed, described, converted.
"""

from __future__ import annotations

import gzip
from pathlib import Path

import numpy as np
import pytest
import trimesh

from hazard_ms.cli.__main__ import main
from hazard_ms.scenes.assets.intake.worker import assembled
from hazard_ms.scenes.assets.providers import PROVIDERS, provider
from hazard_ms.scenes.assets.providers.partnet import parts
from tests.worlds.files.model_collections import CABINET, CABINET_SCALE, MUG, UID, URDF, write_objaverse


def bounds(model: object) -> np.ndarray:
    """Lowest and highest corner of the model's parts in our frame [m], [2, 3]."""
    import dataclasses

    return assembled(dataclasses.asdict(model)).bounds  # type: ignore[call-overload]


@pytest.mark.parametrize("name", PROVIDERS)
def test_missing_data_name_the_command(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """The command is one that ManiSkill's downloader takes: its ids are read here."""
    from mani_skill.utils.assets.data import DATA_GROUPS, DATA_SOURCES

    monkeypatch.setenv("MS_ASSET_DIR", str(tmp_path))
    monkeypatch.setenv("HAZARD_MS_OBJAVERSE", str(tmp_path))
    there = provider(name)
    with pytest.raises(ValueError, match="get them with") as refusal:
        there.ids()
    assert there.download in str(refusal.value) and str(tmp_path) in str(refusal.value)
    if name != "objaverse":
        command, _, uid = there.download.rpartition(" ")
        assert command == "python -m mani_skill.utils.download_asset" and uid in {**DATA_SOURCES, **DATA_GROUPS}
    assert main(["assets", "list", "--provider", name]) == 2


def test_ycb(data: Path) -> None:
    ycb = provider("ycb")
    assert ycb.ids() == ("025_mug", "077_rubiks_cube"), "what is listed and there"
    assert ycb.ids("mug") == ("025_mug",)
    model = ycb.model("025_mug")
    assert (model.category, model.licence) == ("mug", "CC-BY-4.0")
    assert model.mass == pytest.approx(0.5 * 1000 * np.prod(MUG))
    np.testing.assert_allclose(np.diff(bounds(model), axis=0)[0], MUG, atol=1e-6)
    with pytest.raises(ValueError, match="must be one of 025_mug.*, got '013_apple'"):
        ycb.model("013_apple")


def test_a_ycb_object_becomes_a_model_of_ours(data: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Where nothing draws it has no preview."""
    from hazard_ms.scenes.assets.index import asset

    monkeypatch.setenv("HAZARD_MS_RENDER", "none")
    assert main(["assets", "add", "ycb:025_mug", "--name", "ycb_mug"]) == 0
    a = asset("ycb_mug")
    assert sorted(p.name for p in Path(a.visual).parent.iterdir()) == ["hulls.ply", "model.glb"]
    assert (a.category, a.licence, a.source) == ("mug", "CC-BY-4.0", "ManiSkill's YCB, 025_mug")
    np.testing.assert_allclose(a.extent, MUG, atol=1e-4)
    assert trimesh.load(a.visual, force="mesh").bounds[0, 2] == pytest.approx(0.0, abs=1e-4)


def test_partnet(data: Path) -> None:
    """The joints' frames are applied: the second box is 3 m along z of the first, which is turned."""
    partnet = provider("partnet-mobility")
    assert partnet.ids() == (CABINET,) == partnet.ids("cabinet") and partnet.ids("bottle") == ()
    model = partnet.model(CABINET)
    assert model.scale == CABINET_SCALE and "non-commercial" in model.licence
    # by hand: rpy (90, 0, -90) degrees takes x to -y, y to z, z to -x; ours then turns its front, -x, to -y: x to y, y
    # to -x
    first = [[0, 0, 0.5], [0.5, 0.5, 0.5]]  # middle and half size in the frame of link_0
    second = [[1, 0, 3], [0.5, 0.5, 1.0]]
    corners = []
    for middle, half in (first, second):
        for sign in (-1, 1):
            x, y, z = np.array(middle) + sign * np.array(half)
            in_robot = np.array([-z, -x, y])
            corners.append(np.array([-in_robot[1], in_robot[0], in_robot[2]]))
    wanted = CABINET_SCALE * np.array([np.min(corners, axis=0), np.max(corners, axis=0)])
    np.testing.assert_allclose(bounds(model), wanted, atol=1e-6)


@pytest.mark.parametrize(
    ("old", "new", "word"),
    [
        ("textured_objs/box.obj", "../../../../../../etc/passwd", "leads out of"),
        ("textured_objs/box.obj", "/etc/passwd", "leads out of"),
        ('<?xml version="1.0"?>', '<?xml version="1.0"?><!DOCTYPE a [<!ENTITY b "c">]>', "entities"),
        ('xyz="0 0 3"', 'xyz="0 0 nan"', "three numbers"),
        ('<parent link="base"/>', '<parent link="link_1"/>', "must form a tree, got a loop"),
        ("</robot>", "", "cannot be read"),
        ("visual", "hidden", "0 files"),
    ],
)
def test_a_hostile_urdf_is_refused(old: str, new: str, word: str, tmp_path: Path) -> None:
    assert old in URDF
    (tmp_path / "mobility_cvx.urdf").write_text(URDF.replace(old, new))
    with pytest.raises(ValueError, match=word):
        parts(tmp_path / "mobility_cvx.urdf")


def test_objaverse(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("HAZARD_MS_OBJAVERSE", str(tmp_path))
    write_objaverse(tmp_path, {"license": "by-nc", "user": {"displayName": "Ada"}, "viewerUrl": "https://somewhere/1"})
    objaverse = provider("objaverse")
    assert objaverse.ids() == (UID,) == objaverse.ids("teddy_bear") and objaverse.ids("sofa") == ()
    model = objaverse.model(UID)
    assert (model.licence, model.author, model.category) == ("CC-BY-NC-4.0", "Ada", "teddy_bear")
    np.testing.assert_allclose(np.diff(bounds(model), axis=0)[0], (1.0, 2.0, 3.0), atol=1e-6)  # y was up


@pytest.mark.parametrize(
    ("row", "word"),
    [
        ({"user": {"displayName": "Ada"}}, "licence of .*, got None"),
        ({"license": "", "user": {"displayName": "Ada"}}, "licence of .*, got ''"),
        ({"license": "all rights reserved", "user": {"displayName": "Ada"}}, "all rights reserved"),
        ({"license": "by"}, "must have an author"),
    ],
)
def test_an_objaverse_object_without_licence_is_refused(
    row: dict[str, object], word: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("HAZARD_MS_OBJAVERSE", str(tmp_path))
    write_objaverse(tmp_path, row)
    with pytest.raises(ValueError, match=word):
        provider("objaverse").model(UID)


def test_a_packed_bomb_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from hazard_ms.scenes.assets.providers import base

    monkeypatch.setattr(base, "LARGEST_JSON", 1_000_000)
    (tmp_path / "x.json.gz").write_bytes(gzip.compress(b" " * 2_000_000))
    with pytest.raises(ValueError, match="at most 1000000 bytes, got more"):
        base.read_json(tmp_path / "x.json.gz")


def test_unknown_providers_are_refused() -> None:
    with pytest.raises(ValueError, match="provider must be one of ycb, .*, got 'shapenet'"):
        provider("shapenet")
