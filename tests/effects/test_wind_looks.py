"""Things in the wind fly along its heading, more of them in a stronger one; labels stay those of the scene."""

from __future__ import annotations

import numpy as np
import pytest
import torch

from tests.worlds.alone import alone
from tests.worlds.looking import OVERHEAD, windy

LABELS = ("segmentation", "depth", "position", "normal")
SPEED, LATER, MOST = 4.5, 2, 10  # of the wind [m/s], between two pictures [frames], searched shifts [pixels]


@pytest.mark.render
@pytest.mark.parametrize(("mode", "stock"), [("full", "default"), ("fast", "minimal")])
@pytest.mark.long
@alone
def test_labels_are_those_without_wind(mode: str, stock: str) -> None:
    blown, still = windy(mode=mode), windy(mode="off", pack=stock)
    for frame in (0, 1, 100, 101, 1400):
        seen, without = blown.picture(frame), still.picture(frame)
        assert set(seen) == set(without)
        for name in set(LABELS) & set(without):
            np.testing.assert_array_equal(seen[name], without[name], err_msg=f"{name} at frame {frame}")
        assert (seen["rgb"] != without["rgb"]).any(-1).mean() > 0.05


@pytest.mark.render
@pytest.mark.parametrize("heading", [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0)])
def test_what_flies_moves_along_the_heading(heading: tuple[float, float]) -> None:
    """From above: the shift at which one picture resembles a later one most."""
    place = windy((SPEED * heading[0], SPEED * heading[1]), mode="fast", view=OVERHEAD)
    pairs = [[_flying(place, f) for f in (frame, frame + LATER)] for frame in range(60, 240, 25)]
    shifts = [(x, y) for x in range(-MOST, MOST + 1) for y in range(-MOST, MOST + 1)]
    best = np.array(max(shifts, key=lambda shift: sum(_alike(*pair, shift) for pair in pairs)))
    model = place.camera.get_model_matrix()  # x: right in the picture, y: up
    ahead = np.array([*heading, 0.0]) @ model[:3, :2] * [1.0, -1.0]  # columns, rows
    assert best @ ahead > 0.93 * np.linalg.norm(best) * np.linalg.norm(ahead), best
    # at the ground [pixels]; above it, more
    way = SPEED * LATER / 30.0 * place.camera.get_intrinsic_matrix()[0, 0] / OVERHEAD[0][2]
    assert 0.7 * way < np.linalg.norm(best) < 2.0 * way


@pytest.mark.render
def test_a_stronger_wind_carries_more_and_dims_more() -> None:
    calm, storm = windy((0.3, 0.0)), windy((9.0, 0.0))
    flown = [_flying(p, 60).mean() for p in (calm, storm)]
    assert flown[1] > 1.5 * flown[0]


@pytest.mark.render
def test_a_gust_shows() -> None:
    place = windy((0.5, 0.0))
    before = place.picture(60)["rgb"]
    place.state.gust[:] = 3.0
    assert (place.picture(60)["rgb"] != before).any(-1).mean() > 0.02


@pytest.mark.render
def test_haze_hides_what_is_far_more() -> None:
    """Everything fades towards one colour, by a share that grows with the distance."""
    clear, hazy = windy(mode="off", pack="default"), windy((9.0, 0.0))
    clear_rgb, hazy_rgb = (
        clear.picture(60)["rgb"].astype(float),
        np.median([hazy.picture(f)["rgb"] for f in range(40, 100, 12)], axis=0),
    )
    points = clear.points()
    floor = (np.abs(points[..., 2]) < 1e-3) & (clear_rgb[..., 0] > clear_rgb.max() * 0.55)
    far = np.linalg.norm(points - [0.3, 0.5, 1.4], axis=-1)
    blue = hazy_rgb[..., 2] - clear_rgb[..., 2]  # the floor is brown
    assert np.median(blue[floor & (far > 4.5)]) > np.median(blue[floor & (far < 2.2)]) > 0


@pytest.mark.render
def test_a_picture_depends_on_the_present_state_alone() -> None:
    place = windy()
    first = place.picture(200)["rgb"]
    place.state.speed[:], place.state.heading[:] = 7.0, torch.tensor([0.6, 0.8])
    assert (place.picture(900)["rgb"] != first).any()
    place.state.speed[:], place.state.heading[:] = 2.0, torch.tensor([1.0, 0.0])
    np.testing.assert_array_equal(place.picture(200)["rgb"], first)


@pytest.mark.render
def test_a_stock_pack_shows_no_wind() -> None:
    np.testing.assert_array_equal(
        windy(mode="fast", pack="default").picture(50)["rgb"], windy(mode="off", pack="default").picture(50)["rgb"]
    )


def _flying(place, frame: int) -> np.ndarray:  # noqa: ANN001
    """How much each pixel differs from what is there mostly, [H, W]."""
    seen = place.picture(frame)["rgb"].astype(float)
    usual = np.median([place.picture(frame + k)["rgb"] for k in (25, 50, 75, 100, 125)], axis=0)
    return np.abs(seen - usual).max(-1)


def _alike(first: np.ndarray, second: np.ndarray, shift: tuple[int, int]) -> float:
    """How alike `second` is to `first` shifted by columns and rows."""
    moved = np.roll(first, (shift[1], shift[0]), (0, 1))
    return float((np.minimum(moved, 60.0) * np.minimum(second, 60.0))[MOST:-MOST, MOST:-MOST].sum())
