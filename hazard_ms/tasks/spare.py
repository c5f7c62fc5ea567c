"""Scenes beyond those of a split, of which pictures are taken, too: of the same places, with numbers of their own.

They belong to no split, and so are played from a file.
"""

from __future__ import annotations

import tempfile
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from hazard_ms.scenes.schema import to_json
from hazard_ms.scenes.splits import SCENES, spare_scene


def spare_names(names: Sequence[str], count: int) -> tuple[str, ...]:
    """Names of `count` spare scenes for each place of the scenes `names`: "kitchen_a/25" and so on, place by place."""
    return tuple(f"{place}/{SCENES + k:02d}" for place in _places(names) for k in range(count))


def number_of(scene: str, names: Sequence[str]) -> int:
    """The number of a scene of a split, whose scenes are `names`, or of a spare one: spare ones follow, in turn.

    No two scenes have the same, however many are spare. Raises ValueError for a scene that is neither.
    """
    if scene in names:
        return list(names).index(scene)
    place, number = _spare(scene, names)
    places = _places(names)
    return len(names) + (number - SCENES) * len(places) + places.index(place)


@contextmanager
def file_of(scene: str, names: Sequence[str]) -> Iterator[str]:
    """The name of `scene`, or the file of a spare one, as episodes take it; the file goes when the context ends.

    Raises ValueError for a scene that is neither of `names` nor a spare one of their places.
    """
    if scene in names:
        yield scene
        return
    place, number = _spare(scene, names)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "scene.json"
        path.write_text(to_json(spare_scene((place,), number)), encoding="utf-8")
        yield str(path)


def _spare(scene: str, names: Sequence[str]) -> tuple[str, int]:
    """The place and number of a spare scene. Raises ValueError for another name."""
    place, _, number = scene.partition("/")
    known = place in _places(names) and number.isascii() and number.isdigit() and number == f"{int(number):02d}"
    if not known or int(number) < SCENES:
        raise ValueError(
            f"scenes must be in the split, or at its places with numbers of at least {SCENES}, got {scene!r}"
        )
    return place, int(number)


def _places(names: Sequence[str]) -> list[str]:
    return list(dict.fromkeys(name.partition("/")[0] for name in names))
