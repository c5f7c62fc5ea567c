"""The sketch's sight against real looks, in scenes that its constants were not chosen on.

`./run python -m tests.sketch.sight_rates` prints, for each task, how many of the things that a robot really saw the
sketch sees, too (hits), and how many of those that the sketch sees were not seen (false).
"""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

from hazard_ms.scenes.splits import scene
from hazard_ms.sensing.sighting import SEEN_PIXELS
from hazard_ms.sketch.sight import FETCH, Eye, Sight
from tests.worlds.real_looks import Look, real_looks

SCENES = {
    "HazardFire-v1": ["kitchen_a/03", "living_room_a/05", "craft_room_a/11", "kitchen_a/17"],
    "HazardWind-v1": ["street/02", "crossing/09", "park/14"],
}  # about 200 looks


def eye_of(look: Look) -> Eye:
    """The camera of a real look, as the sketch describes it."""
    x, y, heading = look.base
    ahead = (look.eye[:2, 3] - (x, y)) @ (np.cos(heading), np.sin(heading))
    return Eye(float(ahead), float(look.eye[2, 3]), float(np.arcsin(look.eye[2, 2])))


def compared(looks: Iterable[Look], eye: Eye = FETCH) -> tuple[NDArray[np.bool_], NDArray[np.bool_], NDArray[np.bool_]]:
    """For every thing in every look: whether it is a body, was really seen, and is seen by the sketch, [N] each."""
    sights: dict[str, Sight] = {}
    rows = []
    for look in looks:
        spec = scene(look.scene)
        sight = sights.setdefault(look.scene, Sight(spec, eye))
        every = np.arange(len(spec.things))
        seen = sight.visible([look.base[:2]], [look.base[2]], every, look.position)[0]
        rows.append(np.stack([every < len(spec.bodies), look.pixels >= SEEN_PIXELS, seen])[:, look.here])
    body, real, sketch = np.concatenate(rows, axis=1)
    return body, real, sketch


def rates(real: NDArray[np.bool_], sketch: NDArray[np.bool_]) -> tuple[float, float]:
    """The share of what was `real` that the `sketch` sees, and the share of what it sees that was not real."""
    return float(sketch[real].mean()), float(1.0 - real[sketch].mean())


def main() -> None:
    """Print the rates of both tasks."""
    for task, names in SCENES.items():
        looks = real_looks(task, names, split="train")
        body, real, sketch = compared(looks)
        for what, rows in (("bodies", body), ("fixtures", ~body)):
            hits, false = rates(real[rows], sketch[rows])
            count = int(real[rows].sum())
            print(f"{task}: {len(looks)} looks, {count} sightings of {what}: hits {hits:.1%}, false {false:.1%}")


if __name__ == "__main__":
    main()
