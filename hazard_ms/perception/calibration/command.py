"""`hazard-ms perception calibrate`: the errors of a detector as a table, and how reliable beliefs from it are."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

import numpy as np

from hazard_ms.perception import layout
from hazard_ms.perception.calibration.measuring import confusion_of
from hazard_ms.perception.calibration.observing import observed
from hazard_ms.perception.calibration.reliability import crossed, table, weight_of_repeats
from hazard_ms.perception.calibration.thinned import Thinned
from hazard_ms.perception.training.pictures import read
from hazard_ms.sensing.detection.perception import perception as perception_of
from hazard_ms.spec.checks import whole
from hazard_ms.spec.storage.files import write

MOST_EVERY = 64  # pixels; any larger number must be a mistake [ours]


def calibrate(datasets: Sequence[Path], text: str, splits: Sequence[str], every: int, output: Path | None) -> str:
    """Count the errors of the detector of a perception in every `every`-th pixel of the pictures of some `splits`.

    The table goes to the file `output`; what is returned is the reliability diagram, with the table of half of the
    scenes for the other half. Raises ValueError for datasets without these splits, and for detectors that do not say
    which categories they tell.
    """
    whole(every, 1, MOST_EVERY, "every")
    detector = perception_of(text).detector
    if detector is None or not detector.classes:
        raise ValueError(f"perception must name a detector that lists its categories, got {text!r}")
    parts = [(home, split) for home in datasets for split in splits if (home / layout.instances(split)).is_file()]
    if {home for home, _ in parts} != set(datasets):
        without = ", ".join(sorted({str(home) for home in datasets} - {str(home) for home, _ in parts}))
        raise ValueError(f"each of DATA must have one of the splits {', '.join(splits)}, got none in {without}")
    pictures = [Thinned(picture, every) for home, split in parts for picture in read([home], split)]
    looks = observed(detector, pictures, detector.classes)
    command = f"hazard-ms perception calibrate {' '.join(home.name for home in datasets)} --perception {text}"
    command += f" --split {' '.join(splits)} --every {every}"
    repeated = weight_of_repeats(looks, detector.classes)
    made = confusion_of(looks, detector.classes, eyes_of(pictures[0]), command, repeated)
    if output is not None:
        write(output, json.dumps(asdict(made), indent=1) + "\n")
    return table(crossed(looks, detector.classes, repeated))


def eyes_of(picture: Thinned) -> str:
    """The eyes that took a picture: its side in pixels, over the angle in degrees."""
    matrix, width = picture.intrinsic(), picture.depth().shape[1]
    return f"{width}/{2.0 * float(np.degrees(np.arctan(width / 2.0 / matrix[0, 0]))):.0f}"
