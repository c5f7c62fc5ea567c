"""The eyes of a perception: what they are called, what camera they make, and where they are kept."""

from __future__ import annotations

import math

import pytest

from hazard_ms.sensing.detection.detector import Detector
from hazard_ms.sensing.detection.eyes import EYES, Eyes
from hazard_ms.sensing.detection.perception import camera_of, eyes_of, parts, with_eyes


def test_the_angle_is_that_over_the_width() -> None:
    """640 x 480 with a focal length of f pixels: tan(55 / 2) = 320 / f over the width, and 240 / f over the height."""
    focal = 320.0 / math.tan(math.radians(27.5))
    camera = Eyes.of("640x480/55").camera
    assert (camera["width"], camera["height"]) == (640, 480)
    assert math.tan(camera["fov"] / 2.0) == pytest.approx(240.0 / focal)
    assert Eyes.of("512/120").camera["fov"] == pytest.approx(2.0 * math.pi / 3.0)  # square: the same both ways


@pytest.mark.parametrize(
    "text", ["512", "512/", "x480/55", "640x/55", "512/120 ", "-512/120", "512/5", "512/151", "8/120", "4096/120"]
)
def test_what_no_eyes_are_is_refused_with_the_perception(text: str) -> None:
    with pytest.raises(ValueError, match="eyes"):
        parts(f"noisy:eyes={text}")


def test_the_truth_and_detectors_without_others_have_the_robots_own() -> None:
    assert EYES == Detector.eyes == "256/120"
    for text in ("truth", "noisy", "noisy:eyes=256/120", "noisy:eyes=256x256/120"):
        assert camera_of(text) == {}, "no keyword: pictures stay as they were, to the bit"
    assert eyes_of("noisy:miss=0.1,eyes=512/120") == "512/120"
    assert camera_of("noisy:eyes=512/120")["sensor_configs"]["width"] == 512


def test_a_recorded_perception_looks_with_the_eyes_that_it_had(monkeypatch: pytest.MonkeyPatch) -> None:
    """Whatever eyes its detector has by then."""
    assert with_eyes("noisy", "256/120") == "noisy" and with_eyes("truth", "256/120") == "truth"
    monkeypatch.setattr(Detector, "eyes", "512/120")
    assert with_eyes("noisy", "256/120") == "noisy:eyes=256/120"
    assert with_eyes("noisy:miss=0.2", "256/120") == "noisy:miss=0.2,eyes=256/120"
    assert with_eyes("noisy:eyes=640x480/55", "640x480/55") == "noisy:eyes=640x480/55"
    assert eyes_of(with_eyes("noisy:miss=0.2", "256/120")) == "256/120"
