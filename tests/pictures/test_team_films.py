"""Films of teams: a row for each robot, and a film of an episode that plays."""

from __future__ import annotations

from pathlib import Path

import cv2
import numpy as np
import pytest

from hazard_ms.evaluation.options import EpisodeOptions
from hazard_ms.evaluation.teams.player import RecordedTeam, play
from hazard_ms.pictures import team_compositor
from hazard_ms.pictures.compositor import HEIGHT, MAIN, WIDTH
from hazard_ms.pictures.drawing import BLUE
from hazard_ms.pictures.film import LAST_SHOTS
from hazard_ms.pictures.team_compositor import TeamCompositor
from hazard_ms.pictures.team_film import TeamFilm
from hazard_ms.simulation.drawing.viewpoint import corner_view, following_view
from hazard_ms.skills.decision import EXPLORE, STOP
from hazard_ms.spec.storage.files import drafts
from hazard_ms.tasks import task_of
from tests.pictures.test_video import TEMPERATURE, shot

RED = (200, 30, 30)


@pytest.mark.parametrize("count", [2, 3, 4])
def test_each_robot_has_a_row_with_its_camera_and_its_map(count: int) -> None:
    """The picture of its head camera alone is red, and its path alone is drawn; all others are grey, without a path."""
    names = tuple(f"fetch-{k}" for k in range(count))
    compositor = TeamCompositor("title", "subtitle", (TEMPERATURE,), names)
    grey, rows = shot(path=()), []
    without = compositor.compose(dict.fromkeys(names, grey), (), 0)
    for name in names:
        red = shot(head=np.full((256, 256, 3), RED, np.uint8), path=((1.0, 1.5), (1.0, 2.6)))
        shots = {other: red if other == name else grey for other in names}
        frame = compositor.compose(shots, (), 0)
        assert frame.shape == (HEIGHT, WIDTH, 3) and frame.dtype == np.uint8
        y, x = np.nonzero((frame == RED).all(-1))
        assert x.min() > MAIN[0] and y.max() < 620
        drawn, plain = ((f[y.min() : y.max(), x.max() + 4 :] == BLUE).all(-1).sum() for f in (frame, without))
        assert drawn > plain + 20
        rows.append((y.min(), y.max()))
    assert all(before[1] < after[0] for before, after in zip(rows, rows[1:], strict=False))


def test_the_caption_tells_of_all() -> None:
    """What stops, what is held, and the collisions change the picture, each in its place."""
    names = ("fetch-0", "g1-1")
    compositor = TeamCompositor("title", "subtitle", (TEMPERATURE,), names)
    shots = dict.fromkeys(names, shot(verb="", target=None))
    plain = compositor.compose(shots, (), 0)
    y, x = np.nonzero((plain != compositor.compose(shots, ("g1-1",), 0)).any(-1))
    assert x.min() > MAIN[0] and 340 < y.min() and y.max() < 370
    y, x = np.nonzero((plain != compositor.compose(shots, (), 1)).any(-1))
    assert x.max() < 450 and y.min() > 640
    held = {**shots, "g1-1": shot(verb="", target=None, held="pen_1")}
    y, x = np.nonzero((plain[640:] != compositor.compose(held, (), 0)[640:]).any(-1))
    assert 450 < x.min() and x.max() < 1000


@pytest.mark.parametrize(
    ("target", "held", "told"),
    [
        (None, None, ""),
        (None, "pen_1", "holding pen_1"),
        ("cart_1", "pen_1", "cart_1, holding pen_1"),
        ("pen_1", "pen_1", "pen_1"),
        ("pen_1", None, "pen_1"),
    ],
)
def test_the_row_says_what_is_done_with_what_and_what_is_held(
    target: str | None, held: str | None, told: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """No comma before or after nothing, and nothing twice."""
    texts: list[str] = []
    monkeypatch.setattr(team_compositor, "write", lambda sheet, text, *_: texts.append(text))
    compositor = TeamCompositor("title", "subtitle", (TEMPERATURE,), ("fetch-0",))
    compositor.compose({"fetch-0": shot(verb="explore", target=target, held=held)}, (), 0)
    assert texts[:3] == ["fetch-0", "explore", told]


def test_the_camera_in_the_open_steps_back_where_robots_are_far_apart() -> None:
    """Each of two robots 14 m apart, whichever way, is in a picture of 1.15 rad, 4 to 3."""
    task = task_of("HazardWind-v1", "paper")
    whole = corner_view(task.build(task.scenes("test")[0]))
    near = following_view(whole, (20.0, 20.0))
    assert near.p.tolist() == following_view(whole, (20.0, 20.0), 2.0).p.tolist()
    pose = following_view(whole, (20.0, 20.0), 7.0).to_transformation_matrix()
    for angle in np.linspace(0.0, 2 * np.pi, 8, endpoint=False):
        place = [20.0 + 7.0 * np.cos(angle), 20.0 + 7.0 * np.sin(angle), 0.6]
        ahead, left, up = pose[:3, :3].T @ (place - pose[:3, 3])
        assert ahead > 0 and abs(up / ahead) < np.tan(0.575) and abs(left / ahead) < np.tan(0.575) * 4 / 3


@pytest.mark.render
def test_an_episode_of_a_team_is_filmed(tmp_path: Path) -> None:
    """Robot 0 looks around, robot 1 twice; a picture each 20 frames, and the last one for a while."""
    options = EpisodeOptions("HazardFire-v1", robot_uids=("fetch", "g1"), agent="auction", effects="off")
    robots = ("fetch-0", "fetch-0", "g1-1", "g1-1", "g1-1")
    team = RecordedTeam([(EXPLORE, None), (STOP, None), (EXPLORE, None), (EXPLORE, None), (STOP, None)], robots)
    path, camera = tmp_path / "out.mp4", {"width": 280, "height": 208}
    with drafts(path) as (draft,), TeamFilm(draft, "auction", 20) as film:
        result = play(options, [film], team, render_mode="rgb_array", human_render_camera_configs=camera)
    reader, pictures = cv2.VideoCapture(str(path)), []
    while (read := reader.read())[0]:
        pictures.append(read[1])
    assert len(pictures) == result.frames // 20 + 1 + LAST_SHOTS and result.ended == "stopped"
    assert pictures[0].shape == (HEIGHT, WIDTH, 3)
    heads = [pictures[-1][90:320, 790:980], pictures[-1][380:610, 790:980]]
    assert all(head.std() > 10 for head in heads) and np.abs(heads[0].astype(int) - heads[1]).mean() > 5
