"""The perception of agents by its specification: "truth", or a detector and how its detections become things.

noisy:miss=0.2,confuse=0.05,erode=1
mask_rcnn:detector.pth,association=paper,threshold=0.7
small:eyes=512/120
"""

from __future__ import annotations

import inspect
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from hazard_ms.sensing.detection.detector import Detector
from hazard_ms.sensing.detection.eyes import EYES, FAR, Eyes
from hazard_ms.sensing.detection.labeller import THRESHOLD, DetectingLabeller, Labeller, PublishedLabeller
from hazard_ms.sensing.detection.own import OwnLabeller
from hazard_ms.simulation.world import World
from hazard_ms.spec.checks import one_of
from hazard_ms.spec.parameters import parameters
from hazard_ms.spec.registry import load
from hazard_ms.spec.registry.detectors import DETECTORS, TRUTH

OWN, PAPER = "own", "paper"
ASSOCIATIONS: dict[str, type[DetectingLabeller]] = {OWN: OwnLabeller, PAPER: PublishedLabeller}


@dataclass(frozen=True)
class Perception:
    """A detector, None for the truth, and how its detections become things."""

    detector: Detector | None = None
    association: str = OWN
    threshold: float = THRESHOLD
    fusion: bool = True
    sight: float = FAR  # distance up to which a look tells most things [m]

    def labeller(self, world: World, containers: Sequence[str]) -> Labeller:
        """The labeller of an episode that begins in `world` with `containers`, the names of its carts."""
        if self.detector is None:
            return Labeller(world, containers)
        return ASSOCIATIONS[self.association](world, containers, self.detector, self.threshold, self.fusion)


class Common:
    """The parameters that can be given with every detector."""

    def __init__(
        self, association: str = OWN, threshold: float = THRESHOLD, eyes: str = "", fusion: bool = True
    ) -> None:
        """Choose how detections become things.

        `association`: own or paper; `threshold`: score from which detections count; `eyes`: of the camera, empty for
        those of the detector; `fusion`: whether tracks keep the evidence of all looks, where the errors of the detector
        are known. Raises ValueError for others.
        """
        self.association = one_of(association, ASSOCIATIONS, "association")
        if not 0.0 <= threshold <= 1.0:
            raise ValueError(f"threshold must be from 0 to 1, got {threshold!r}")
        self.threshold, self.eyes, self.fusion = threshold, eyes, fusion
        if eyes:
            Eyes.of(eyes)


COMMON = tuple(inspect.signature(Common).parameters)


def parts(text: str) -> tuple[str, Common, dict[str, Any]]:
    """The name of the detector in a specification, what every detector can be given, and its own parameters.

    A file or folder is its parameter `path`. Raises ValueError for a name or parameters that are not known.
    """
    name, _, rest = text.partition(":")
    one_of(name, (TRUTH, *DETECTORS), "perception")
    given = [part for part in rest.split(",") if part]
    pairs = [part for part in given if "=" in part]
    paths = [part for part in given if "=" not in part]
    if name == TRUTH and given:
        raise ValueError(f"perception must be {TRUTH} without parameters, got {text!r}")
    if len(paths) > 1:
        raise ValueError(f"perception must name at most one file or folder, got {text!r}")
    common = [part for part in pairs if part.partition("=")[0] in COMMON]
    own = [*(f"path={path}" for path in paths), *(part for part in pairs if part not in common)]
    shared = Common(**parameters(Common, common))
    if name == TRUTH:
        return name, shared, {}
    kind = load(DETECTORS[name])
    made = parameters(kind, own)
    if "path" not in made and (path := inspect.signature(kind).parameters.get("path")) and path.default is path.empty:
        raise ValueError(f"perception must name the file or folder of its detector, {name}:PATH, got {text!r}")
    return name, shared, made


def perception(text: str) -> Perception:
    """The perception that `text` specifies, its detector ready to use.

    Raises ValueError for a specification that cannot be, and for a detector whose files or packages are missing.
    """
    name, common, own = parts(text)
    if name == TRUTH:
        return Perception()
    kind = load(DETECTORS[name])
    detector = kind(**own)
    if not isinstance(detector, Detector):
        raise ValueError(f"a detector must be a subclass of {Detector.__module__}.Detector, got {kind!r}")
    sight = Eyes.of(common.eyes or detector.eyes).sight
    return Perception(detector, common.association, common.threshold, common.fusion, sight)


def eyes_of(text: str) -> str:
    """The eyes with which a perception looks, by its specification. Raises ValueError as `parts` does."""
    name, common, _ = parts(text)
    return EYES if name == TRUTH else common.eyes or load(DETECTORS[name]).eyes


def camera_of(text: str) -> dict[str, Any]:
    """Keywords of gym.make for the eyes of a perception, none for the robots' own. Raises ValueError as `parts`."""
    made = Eyes.of(eyes_of(text))
    return {} if made == Eyes.of(EYES) else {"sensor_configs": made.camera}


def with_eyes(text: str, eyes: str) -> str:
    """The specification `text` of a perception that looks with `eyes`, whatever its detector has today."""
    name, _, rest = text.partition(":")
    if name not in (TRUTH, *DETECTORS) or eyes == eyes_of(text):
        return text
    return f"{name}:" + ",".join(part for part in (*rest.split(","), f"eyes={eyes}") if part)
