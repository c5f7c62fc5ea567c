"""Detectors by name: what tells agents of things in a picture in place of the simulator's truth.

An entry names a class as text, "package.module:Class", which is imported when it is first needed, or holds it. It is a
subclass of `hazard_ms.sensing.detection.detector.Detector`.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

from hazard_ms.spec.registry import NAME

TRUTH = "truth"  # no detector: the simulator's own labels
_detectors: dict[str, Any] = {}
DETECTORS: Mapping[str, Any] = MappingProxyType(_detectors)


def register_detector(name: str, detector: Any) -> None:
    """Add a detector. Raises ValueError for a name that cannot be, or that is taken."""
    if not isinstance(name, str) or not NAME.fullmatch(name):
        raise ValueError(f"a registered name must look like 'name', got {name!r}")
    if name == TRUTH or _detectors.get(name, detector) != detector:
        raise ValueError(f"a registered name must be new, got {name!r}, which is taken")
    _detectors[name] = detector


register_detector("noisy", "hazard_ms.sensing.detection.noisy:Noisy")
register_detector("mask_rcnn", "hazard_ms.perception.detectors.mask_rcnn:MaskRcnn")
register_detector("rf_detr", "hazard_ms.perception.detectors.rf_detr:RfDetr")
register_detector("open", "hazard_ms.perception.detectors.open_vocabulary:OpenVocabulary")
register_detector("small", "hazard_ms.perception.detectors.small:Small")
