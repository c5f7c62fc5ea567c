"""Hidden scenes: the commitments tell nothing, and no other scenes can be published for them."""

from __future__ import annotations

import hashlib
import json
import stat
from dataclasses import asdict, replace
from pathlib import Path

import pytest

from hazard_ms.cli.__main__ import main
from hazard_ms.evaluation.submissions.commitments import LARGEST, Commitments, Hidden, Published, check, draw
from hazard_ms.evaluation.submissions.tracks import PUBLISHED
from hazard_ms.scenes.schema import to_json
from hazard_ms.scenes.splits import spare_scene
from hazard_ms.spec.foreign import plain

FIRE, WIND = "HazardFire-v1", "HazardWind-v1"


@pytest.fixture(scope="module")
def drawn() -> tuple[Commitments, Published]:
    """Two scenes of fire and of wind."""
    return draw("autumn", 2, (FIRE, WIND))


def test_a_published_set_is_that_which_was_committed(drawn: tuple[Commitments, Published]) -> None:
    commitments, published = drawn
    track = check(commitments, published)
    assert track.name == "hidden-autumn" and track.places == [(FIRE, 0), (FIRE, 1), (WIND, 0), (WIND, 1)]
    assert track.scene((WIND, 1)) == published.scenes[WIND][1].scene and track.scene((WIND, 1)).startswith("parking/")
    text = json.dumps(asdict(commitments))
    assert not any(one.scene in text or one.salt in text for own in published.scenes.values() for one in own)


def test_a_hash_is_that_of_task_number_name_scene_and_salt(drawn: tuple[Commitments, Published]) -> None:
    """Computed here from the scene itself."""
    commitments, published = drawn
    one = published.scenes[FIRE][1]
    place, _, number = one.scene.partition("/")
    content = hashlib.sha256(to_json(spare_scene((place,), int(number))).encode()).hexdigest()
    told = f"{FIRE} 1 {one.scene} {content} {one.salt}"
    assert commitments.hashes[FIRE][1] == hashlib.sha256(told.encode()).hexdigest()


def test_whatever_is_exchanged_afterwards_is_named(drawn: tuple[Commitments, Published]) -> None:
    commitments, published = drawn
    first, second = published.scenes[FIRE]

    def with_fire(*own: Hidden) -> Published:
        return replace(published, scenes={**published.scenes, FIRE: own})

    other = Hidden("kitchen_b/2000", first.salt)
    for own, told in (
        ((other, second), "scene 0 of HazardFire-v1 must match its commitment, got 'kitchen_b/2000'"),
        ((first, replace(second, salt="0" * 64)), "scene 1 of HazardFire-v1 must match its commitment"),
        ((second, first), "scene 0 of HazardFire-v1 must match its commitment"),
        ((first,), "2 scenes of HazardFire-v1 must be published, got 1"),
        ((first, first), "hidden scenes of HazardFire-v1 must differ"),
        ((first, Hidden("kitchen_b/03", second.salt)), "hidden scenes must not belong to a split, got 'kitchen_b/03'"),
        ((first, Hidden("/etc/passwd", second.salt)), "scenes must be in the split"),
    ):
        with pytest.raises(ValueError, match=told):
            check(commitments, with_fire(*own))
    with pytest.raises(ValueError, match="must be those of the set 'autumn'"):
        check(commitments, replace(published, name="spring"))


def test_a_set_is_drawn_and_checked_by_the_command(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file, secret = tmp_path / "winter.json", tmp_path / "secret.json"
    assert main(["commitments", str(file), "--draw", "1", "--secret", str(secret)]) == 0
    assert stat.S_IMODE(secret.stat().st_mode) == 0o600
    assert main(["commitments", str(file), "--published", str(secret), "-o", str(tmp_path / "scenes")]) == 0
    assert "all 3 scenes of hidden-winter match their commitments" in capsys.readouterr().out
    scenes = sorted(str(path.relative_to(tmp_path)) for path in (tmp_path / "scenes").rglob("*.json"))
    assert scenes == [f"scenes/Hazard{task}-v1/scene-000.json" for task in ("Fire", "Flood", "Wind")]
    assert main(["commitments", str(file), "--draw", "1", "--secret", str(secret)]) == 2
    assert main(["commitments", str(file)]) == 2
    changed = json.loads(secret.read_text())
    changed["scenes"][FIRE][0]["scene"] = "kitchen_b/2000"
    secret.write_text(json.dumps(changed))
    assert main(["commitments", str(file), "--published", str(secret)]) == 2
    assert "scene 0 of HazardFire-v1 must match its commitment" in capsys.readouterr().err


@pytest.mark.parametrize("file", sorted((Path(__file__).parents[3] / "results" / "hidden").glob("*.json")))
def test_a_set_of_ours_has_25_scenes_of_each_task_and_tells_nothing_of_them(file: Path) -> None:
    told = plain.made(Commitments, plain.read(file, LARGEST), str(file))
    assert told.name == file.stem
    assert {task: len(own) for task, own in told.hashes.items()} == dict.fromkeys(PUBLISHED, 25)
    assert len({one for own in told.hashes.values() for one in own}) == 25 * len(PUBLISHED)
    assert set(json.loads(file.read_text())) == {"name", "hashes", "format"}
