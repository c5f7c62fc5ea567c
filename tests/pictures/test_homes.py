"""Homes as spectators see them: whole, open from above, and as they were once the picture is taken."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest
from sapien.render import RenderBodyComponent

from hazard_ms.effects.cutaway import CUT
from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.pictures.frozen_episode import FrozenEpisode
from hazard_ms.pictures.options import IDLE, RenderOptions
from hazard_ms.scenes.splits import scene
from hazard_ms.simulation.drawing.viewpoint import HOUSE_ANGLE, HOUSE_HIGH, house_view
from hazard_ms.spec.names import plain_name


def on_picture(pose: np.ndarray, point: np.ndarray, aspect: float) -> tuple[float, float]:
    """Where a point is in a picture: -1 to 1 from left to right and from bottom to top [-]."""
    ahead, left, up = np.linalg.inv(pose)[:3] @ [*point, 1.0]  # SAPIEN's camera looks along x, z is up
    half = np.tan(HOUSE_ANGLE / 2) * ahead
    return -left / (half * aspect), up / half


@pytest.mark.parametrize("wide", [True, False])
@pytest.mark.parametrize("aspect", [0.6, 4 / 3, 3.0])
def test_all_of_a_home_is_in_the_picture_and_fills_it(aspect: float, wide: bool) -> None:
    spec = scene("house_01/03")
    if not wide:
        room = dataclasses.replace(spec.room, size=spec.room.size[::-1], openings=(), partitions=(), areas=())
        spec = dataclasses.replace(spec, room=room)
    x, y = spec.room.size
    pose = house_view(spec, aspect).to_transformation_matrix()
    corners = [np.array([a, b, c]) for a in (0, x) for b in (0, y) for c in (0, HOUSE_HIGH)]
    places = np.array([on_picture(pose, corner, aspect) for corner in corners])
    most = np.abs(places).max()
    assert 0.9 < most <= 0.9401, "as near as the margin of 3 % on each side allows"
    assert pose[2, 2] > 0.0 and pose[2, 0] < -0.5


def test_a_camera_that_follows_stays_over_the_home() -> None:
    spec = scene("house_01/03")
    for place in ((0.0, 0.0), spec.room.size, (5.0, 4.0)):
        pose = house_view(spec, 4 / 3, place).to_transformation_matrix()
        u, v = on_picture(pose, np.array([*place, 0.0]), 4 / 3)
        assert abs(u) <= 1.0 and abs(v) <= 1.0
    assert pose[2, 3] < house_view(spec, 4 / 3).p[2], "it is nearer than one that sees everything"


@pytest.mark.render
def test_a_home_is_open_for_its_picture_alone(tmp_path: Path) -> None:
    episode = EpisodeOptions("HazardHouseFire-v1", agent=IDLE, scene="house_01/03")
    with FrozenEpisode(RenderOptions(output=tmp_path / "x.png", episode=episode)) as frozen:
        sizes = (64, 48)
        closed, view = frozen.view("third", *sizes), frozen.view("home", *sizes)
        shut = frozen.picture(dataclasses.replace(view, open_home=False), "default", 1)
        before = frozen.picture(closed, "default", 1)
        opened = frozen.picture(view, "default", 1)
        assert np.array_equal(frozen.picture(closed, "default", 1), before)
        middle = np.s_[16:32, 16:48]
        assert shut[middle].std() < 5.0 < 15.0 < opened[middle].std(), "a ceiling is plain, rooms are not"
        with frozen._cutaway:
            drawn = [
                (e, body)
                for e in frozen._scene.entities
                if (body := e.find_component_by_type(RenderBodyComponent)) is not None and body.visibility > 0.0
            ]
            names = {plain_name(e.name): e.pose.p for e, _ in drawn}
            assert [name for name, at in names.items() if name.startswith("shell_") and at[2] > CUT] == []
            assert not any(name.startswith("leaf_") for name in names), "they are higher than the cut"
            leaves = [e.pose.p for e in frozen._scene.entities if plain_name(e.name).startswith("leaf_")]
            cut = np.array([e.pose.p for e, _ in drawn if e.name == "cutaway"])
            assert len(leaves) >= 5 and cut[:, 2].max() < CUT
            for leaf in leaves:
                same = np.abs(cut[:, :2] - leaf[:2]).max(1) < 1e-5
                assert same.sum() == 2, "a lower leaf and its top stand where each leaf stands"


@pytest.mark.render
def test_rooms_without_rooms_cannot_be_opened(tmp_path: Path) -> None:
    with FrozenEpisode(RenderOptions(output=tmp_path / "x.png", episode=EpisodeOptions(agent=IDLE))) as frozen:
        with pytest.raises(ValueError, match="several rooms"):
            frozen.view("home", 64, 48)
