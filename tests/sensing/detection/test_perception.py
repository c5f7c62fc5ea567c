"""Specifications of perception: what they make, and what is refused with which words."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from hazard_ms.sensing.detection.detector import Detection, Detector
from hazard_ms.sensing.detection.noisy import Noisy
from hazard_ms.sensing.detection.perception import parts, perception
from hazard_ms.spec.registry import load
from hazard_ms.spec.registry.detectors import DETECTORS, TRUTH, register_detector


class Blind(Detector):
    """Finds nothing."""

    def __init__(self, path: str, dark: bool = False) -> None:
        self.path, self.dark = path, dark

    def detect(self, rgb: NDArray[np.uint8], depth: NDArray[np.float32]) -> list[Detection]:
        return []


@pytest.fixture(autouse=True)
def blind(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("hazard_ms.spec.registry.detectors._detectors", {**DETECTORS})
    monkeypatch.setattr("hazard_ms.sensing.detection.perception.DETECTORS", {**DETECTORS, "blind": Blind})


def test_truth_needs_no_detector() -> None:
    made = perception(TRUTH)
    assert made.detector is None


def test_parameters_reach_the_detector_and_what_all_have_in_common_does_not() -> None:
    name, common, own = parts("noisy:miss=0.2,association=paper,erode=1,threshold=0.7")
    assert (name, common.association, common.threshold, own) == ("noisy", "paper", 0.7, {"miss": 0.2, "erode": 1})
    made = perception("noisy")
    assert isinstance(made.detector, Noisy) and (made.association, made.threshold) == ("own", 0.5)


def test_a_file_is_the_path_of_the_detector() -> None:
    made = perception("blind:folder/file.pth,dark=true").detector
    assert isinstance(made, Blind) and made.path == "folder/file.pth" and made.dark is True


@pytest.mark.parametrize(
    ("text", "told"),
    [
        ("nosy", r"perception must be one of truth, noisy, .*got 'nosy' \(did you mean 'noisy'\?\)"),
        ("truth:miss=0.1", "perception must be truth without parameters, got 'truth:miss=0.1'"),
        ("noisy:missed=0.1", "a parameter of Noisy must be one of miss=..., .*got 'missed=0.1'"),
        ("noisy:miss=often", "miss must be float, got 'often'"),
        ("noisy:file.pth", "a parameter of Noisy must be one of .*got 'path=file.pth'"),
        ("noisy:association=mine", "association must be one of own, paper, got 'mine'"),
        ("noisy:threshold=2", "threshold must be from 0 to 1, got 2.0"),
        ("blind", "perception must name the file or folder of its detector, blind:PATH, got 'blind'"),
        ("blind:a,b", "perception must name at most one file or folder, got 'blind:a,b'"),
    ],
)
def test_what_cannot_be_is_refused_before_anything_is_loaded(text: str, told: str) -> None:
    with pytest.raises(ValueError, match=told):
        parts(text)


def test_every_registered_detector_is_one() -> None:
    assert all(issubclass(load(what), Detector) for what in DETECTORS.values())


@pytest.mark.parametrize(
    ("name", "told"), [("noisy", "must be new"), (TRUTH, "must be new"), ("a b", "must look like")]
)
def test_names_of_detectors_are_checked(name: str, told: str) -> None:
    with pytest.raises(ValueError, match=f"a registered name {told}"):
        register_detector(name, Blind)
