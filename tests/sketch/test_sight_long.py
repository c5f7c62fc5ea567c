"""The sketch's sight against real cameras: where they are, and what they saw."""

from __future__ import annotations

import pytest

from hazard_ms.sketch.sight import FETCH, G1, Eye
from tests.sketch.sight_rates import SCENES, compared, eye_of, rates
from tests.worlds.real_looks import Watched, real_looks

pytestmark = pytest.mark.long


@pytest.mark.parametrize(("robot", "eye"), [("fetch", FETCH), ("g1", G1)])
def test_the_cameras_are_where_the_robots_have_them(robot: str, eye: Eye) -> None:
    skills = Watched.make("HazardFire-v1", effects="off", reward_mode="none", robot_uids=robot)
    try:
        skills.looks = []
        skills.reset(seed=0)
        real = eye_of(skills.looks[0])
        params = skills.base.observer.camera.get_params()["intrinsic_cv"][0].cpu().numpy()
    finally:
        skills.close()
    assert (real.ahead, real.height, real.down) == pytest.approx((eye.ahead, eye.height, eye.down), abs=0.002)
    assert params[0, 2] == params[1, 2] == eye.pixels / 2
    assert params[0, 0] == pytest.approx(eye.focal, rel=1e-4)


@pytest.mark.parametrize("task", SCENES)
def test_nine_of_ten_things_that_are_really_seen_are_seen_and_few_others(task: str) -> None:
    looks = real_looks(task, SCENES[task], split="train")
    assert len(looks) >= 80
    body, real, sketch = compared(looks)
    for rows in (body, ~body):
        hits, false = rates(real[rows], sketch[rows])
        assert real[rows].sum() > 200
        assert hits >= 0.9 and false <= 0.1
