"""The command writes scenes of the original benchmark as ours; they are like their files where these are at hand."""

from __future__ import annotations

import json
import time
from pathlib import Path

import numpy as np
import pytest

from hazard_ms.cli.__main__ import main
from hazard_ms.scenes.original.read import Found, read
from hazard_ms.scenes.schema import from_json, to_json
from tests.worlds.files.original_folders import (
    FIRE_INFO,
    FLOOD,
    SWAP,
    WIND_INFO,
    folder,
    kitchen,
    matrix,
    of_id,
    street,
)
from tests.worlds.files.original_reference import commands, poses

ORIGINAL = Path(__file__).parents[3] / "shared" / "hazard_original"
published = pytest.mark.skipif(not ORIGINAL.exists(), reason="the original benchmark's scenes are not here")


def test_import_writes_what_can_be_read(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    scenes, out = tmp_path / "scenes", tmp_path / "out"
    folder(scenes / "mm_kitchen_2a-7", kitchen(), FIRE_INFO, FLOOD)
    folder(scenes / "suburb_scene_2023-1-7", street(), WIND_INFO)
    assert main(["scenes", "import", str(scenes), "-o", str(out)]) == 0
    assert {p.name for p in out.iterdir()} == {"mm_kitchen_2a-7.json", "suburb_scene_2023-1-7.json"}
    assert from_json((out / "mm_kitchen_2a-7.json").read_text()) == read(scenes / "mm_kitchen_2a-7").spec
    assert "mm_kitchen_2a-7: 3 bodies, 2 fixtures, 1 targets, 0 containers" in capsys.readouterr().out
    folder(scenes / "broken-1", "[", FIRE_INFO)
    assert main(["scenes", "import", str(scenes), "-o", str(out)]) == 1
    assert "broken-1/log.txt, line 1" in capsys.readouterr().err


def test_import_writes_nothing_outside(tmp_path: Path) -> None:
    out, secret = tmp_path / "out", tmp_path / "secret.json"
    secret.write_text("mine")
    out.mkdir()
    (out / "a-1.json").symlink_to(secret)
    good = folder(tmp_path / "a-1", kitchen(), FIRE_INFO, FLOOD)
    assert main(["scenes", "import", str(good), "-o", str(out)]) == 0
    assert secret.read_text() == "mine" and not (out / "a-1.json").is_symlink()
    for bad in ("a b", ".hidden", "x\ny"):
        assert main(["scenes", "import", str(folder(tmp_path / bad, kitchen(), FIRE_INFO, FLOOD)), "-o", str(out)]) == 1
    assert [p.name for p in out.iterdir()] == ["a-1.json"]
    for nothing in (tmp_path / "none", out, secret):
        assert main(["scenes", "import", str(nothing), "-o", str(out)]) == 2
    assert main(["scenes", "import", str(good), "-o", str(secret)]) == 2


@pytest.fixture(scope="module")
def all_found() -> dict[Path, Found]:
    before = time.process_time()
    found = {log.parent: read(log.parent) for log in sorted(ORIGINAL.glob("*/*/log.txt"))}
    assert len(found) == 156 and time.process_time() - before < 30.0
    return found


@published
def test_published_scenes_hold_what_their_files_hold(all_found: dict[Path, Found]) -> None:
    for where, found in all_found.items():
        log, info = commands(where / "log.txt"), json.loads((where / "info.json").read_text())
        added = {c["id"]: c for c in log if c["$type"] == "add_object"}
        spec = found.spec
        assert {
            int(t.name.rsplit("_", 1)[1]) for t in (*spec.bodies, *spec.fixtures[: len(added) - len(spec.bodies)])
        } == set(added)
        wanted = [i for i, c in added.items() if i in info["targets"] or c["category"] in info["targets"]]
        assert sorted(int(b.name.rsplit("_", 1)[1]) for b in spec.targets) == sorted(wanted), where
        assert sorted(int(f.name.rsplit("_", 1)[1]) for f in spec.containers) == sorted(info["containers"])
        assert len(spec.fires) == len(info["other"].get("fire", []))
        masses = {c["id"]: c["mass"] for c in log if c["$type"] == "set_mass"}
        assert all(b.mass == masses.get(int(b.name.rsplit("_", 1)[1]), 1.0) for b in spec.bodies)
        assert from_json(to_json(spec)) == spec
        assert not [n for n in found.notes if "agent starts" not in n]


@published
def test_published_things_are_where_they_were(all_found: dict[Path, Found]) -> None:
    """Positions to 1 mm; indoors against the room's corner, in the open, where things fall first, horizontally."""
    rooms = json.loads((ORIGINAL / "tdw_rooms.json").read_text())
    regions = {"0": (-9.0, -9.0), "1": (46.0, -9.0), "2": (-67.0, -18.0), "4": (-70.0, 46.0)}
    for where, found in all_found.items():
        world = poses(where / "log.txt")
        inside = where.parent.name == "indoor"
        if inside:
            room = rooms[where.name.rsplit("-", 1)[0]]
            corner = np.array([room["center_xyz_m"][k] - room["size_xyz_m"][k] / 2 for k in (0, 2)])
        else:
            corner = np.array(regions[where.name.split("-")[1]])
        for i, pose in world.items():
            thing = of_id(found.spec, i)
            assert thing.position[:2] == pytest.approx(pose[[0, 2], 3] - corner, abs=1e-3), (where.name, thing.name)
            assert not inside or thing.position[2] == pytest.approx(pose[1, 3], abs=1e-3)
            up = (SWAP @ pose[:3, :3] @ SWAP)[:, 2]
            assert matrix(thing.rotation)[:, 2] == pytest.approx(up, abs=1e-5)


@published
@pytest.mark.long
@pytest.mark.parametrize("number", range(0, 156, 20))
def test_published_scenes_come_to_rest(all_found: dict[Path, Found], number: int) -> None:
    """Most things stay where they are when left alone for a second, and no target leaves."""
    from hazard_ms.simulation.bare_scene import PHYSICS_RATE, build

    spec = list(all_found.values())[number].spec
    alone, count = build(spec), len(spec.bodies)
    alone.world.read()
    start, highest = alone.world.position[0, :count].clone(), 0.0
    for _ in range(PHYSICS_RATE):
        alone.step()
        alone.world.read()
        highest = max(highest, float((alone.world.position[0, :count] - start)[:, 2].max()))
    end = alone.world.position[0, :count]
    assert float((end - start).norm(dim=-1).median()) < 0.02
    assert highest < 0.3 and float((end - start)[:, :2].norm(dim=-1).max()) < 1.0  # nothing is thrown
    edge = end.new_tensor(spec.room.size) + spec.room.beyond
    assert bool(((end[:, :2] > -spec.room.beyond) & (end[:, :2] < edge) & (end[:, 2:] > -0.05)).all())
