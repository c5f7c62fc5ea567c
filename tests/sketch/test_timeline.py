"""Timelines as records: what they say of positions and damage, and that files are whole or refused."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from hazard_ms.sketch.array_files import DIGEST_BYTES
from hazard_ms.sketch.timeline import Timeline, from_bytes, read
from tests.worlds.same import same_fields

BALL, TABLE = 0, 1


def timeline() -> Timeline:
    """A ball that goes 1 m along x in 10 frames, rests, and is damaged in frame 25; a table that stays."""
    offsets = np.zeros((4, 1, 3), np.float16)
    offsets[1:, 0, 0] = 1.0
    return Timeline(
        scene="test/hall",
        task="HazardFire-v1",
        physics="paper",
        suite="abc",
        seed=2**31 + 5,
        first=0,
        stride=10,
        names=("ball_1", "table_1"),
        start=np.array([[1.0, 2.0, 0.5], [4.0, 4.0, 0.4]], np.float32),
        moves=np.array([BALL], np.int16),
        offsets=offsets,
        levels=np.full((4, 1, 2), 20.0, np.float16),
        damaged_at=np.array([25, -1], np.int32),
        safe_at=np.array([-1, -1], np.int32),
        flame_birth=np.array([0, 150], np.int32),
        flame_place=np.zeros((2, 2), np.float32),
    )


def test_positions_lie_on_lines_between_samples_and_rest_beyond() -> None:
    line = timeline()
    assert [float(line.position_at(frame)[BALL, 0]) for frame in (-5, 0, 2.5, 10, 17, 99)] == [1, 1, 1.25, 2, 2, 2]
    assert (line.position_at(7)[TABLE] == line.start[TABLE]).all()
    assert line.positions(np.array([TABLE, BALL]))[:, :, 0].tolist() == [[4, 1], [4, 2], [4, 2], [4, 2]]
    later = dataclasses.replace(line, first=100)
    assert later.frames.tolist() == [100, 110, 120, 130] and float(later.position_at(105)[BALL, 0]) == 1.5


def test_a_rescue_finds_a_thing_whole_until_the_frame_before_its_damage() -> None:
    """Hazards advance before hands let go: in the frame of the damage it is too late (hazard_ms.env.hazard_env)."""
    assert timeline().whole_until().tolist() == [24, np.inf]


def test_things_are_found_by_name() -> None:
    assert timeline().index("table_1") == TABLE
    with pytest.raises(ValueError, match="must be one of ball_1, table_1, got 'tabel_1'"):
        timeline().index("tabel_1")


def test_a_file_gives_back_what_was_written(tmp_path: Path) -> None:
    path = tmp_path / "new" / "folder" / "one.timeline"
    line = timeline()
    line.write(path)
    same_fields(read(path), line)


@pytest.mark.parametrize("share", [0.0, 0.3, 0.6, 1.0])
def test_a_file_with_one_changed_bit_is_refused(share: float, tmp_path: Path) -> None:
    path = tmp_path / "one.timeline"
    content = bytearray(timeline().to_bytes())
    content[int(share * (len(content) - 1))] ^= 1
    path.write_bytes(content)
    with pytest.raises(ValueError, match=f"{path} must hold a timeline: .* damaged, or another kind of file"):
        read(path)


@pytest.mark.parametrize("length", [0, DIGEST_BYTES, 200])
def test_a_file_that_was_cut_off_is_refused(length: int) -> None:
    with pytest.raises(ValueError, match="damaged, or another kind of file"):
        from_bytes(timeline().to_bytes()[:length])


def test_a_missing_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="gone.timeline must hold a timeline"):
        read(tmp_path / "gone.timeline")
