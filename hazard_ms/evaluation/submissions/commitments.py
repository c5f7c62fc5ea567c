"""Hidden scenes: hashes are committed now, names and salts published later, and everybody can check that they agree.

Each hash is the SHA-256 of the task, the number of the scene in the set, its name, the SHA-256 of its file, and a salt
of 256 bits. So it tells nothing before, nothing can be exchanged after, and a generator that makes another scene of the
same name is found out.
"""

from __future__ import annotations

import dataclasses
import hashlib
import json
import secrets
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

from hazard_ms.evaluation.submissions.packing import Hash
from hazard_ms.evaluation.submissions.tracks import PUBLISHED, TRACKS, Track, hidden_track
from hazard_ms.spec.checks import whole
from hazard_ms.spec.foreign import plain
from hazard_ms.spec.foreign.files import folder_name, read_foreign, sha256_of
from hazard_ms.spec.foreign.plain import Within
from hazard_ms.spec.storage.files import make_folder, write
from hazard_ms.tasks.spare import file_of

FORMAT = 1  # goes up when a field changes its meaning, goes away or is new
LARGEST = 1_000_000  # of a file of commitments or of published scenes [bytes] [ours]
MOST = 200  # hidden scenes of a task [ours]
FIRST, LAST = 1_000, 10**9  # numbers that are drawn: no scene below 1,000 is likely to have been looked at [ours]
SALT = 32  # [bytes]
TRACK = TRACKS["published"]  # in whose places hidden scenes lie

Name = Annotated[str, Within(1, 40)]  # [characters] [ours]


@dataclass(frozen=True)
class Hidden:
    """One hidden scene, once it is published: its name, "kitchen_b/48213", and its salt as hexadecimal digits."""

    scene: Annotated[str, Within(1, 100)]
    salt: Annotated[str, Within(2 * SALT, 2 * SALT)]


@dataclass(frozen=True)
class Commitments:
    """A set of hidden scenes by hashes alone: those of each task, in the order in which seeds will choose them."""

    name: Name
    hashes: Annotated[dict[str, Annotated[tuple[Hash, ...], Within(1, MOST)]], Within(1, 20)]
    format: int = FORMAT


@dataclass(frozen=True)
class Published:
    """The scenes of a set, which are secret until it is published."""

    name: Name
    scenes: Annotated[dict[str, Annotated[tuple[Hidden, ...], Within(1, MOST)]], Within(1, 20)]
    format: int = FORMAT


def draw(name: str, count: int, tasks: Sequence[str] = PUBLISHED) -> tuple[Commitments, Published]:
    """A new set of `count` hidden scenes for each of `tasks`: what is committed, and what is kept secret until later.

    Raises ValueError for a name that no file can have, and for too many scenes.
    """
    folder_name(name, "name of a set of scenes")
    whole(count, 1, MOST, "draw")
    places = {task: list(dict.fromkeys(n.partition("/")[0] for n in TRACK.names(task))) for task in tasks}
    drawn = {
        task: tuple(
            Hidden(f"{own[k % len(own)]}/{FIRST + secrets.randbelow(LAST - FIRST)}", secrets.token_hex(SALT))
            for k in range(count)
        )
        for task, own in places.items()
    }
    published = Published(name, drawn)
    return Commitments(name, _hashes(published)), published


def check(commitments: Commitments, published: Published) -> Track:
    """The track of a published set. Raises ValueError that names the first scene that was not committed."""
    if (published.name, published.scenes.keys()) != (commitments.name, commitments.hashes.keys()):
        told = f"{commitments.name!r} of {', '.join(commitments.hashes)}"
        raise ValueError(f"published scenes must be those of the set {told}, got {published.name!r:.100}")
    for task, hashes in _hashes(published).items():
        committed = commitments.hashes[task]
        if len(hashes) != len(committed):
            raise ValueError(f"{len(committed)} scenes of {task} must be published, got {len(hashes)}")
        for k, (own, wanted) in enumerate(zip(hashes, committed, strict=True)):
            if own != wanted:
                scene = published.scenes[task][k].scene
                raise ValueError(f"scene {k} of {task} must match its commitment, got {scene!r}")
    return hidden_track(
        published.name, {task: tuple(one.scene for one in own) for task, own in published.scenes.items()}
    )


def read_hidden(files: tuple[Path, Path] | None) -> Track | None:
    """The track of a hidden set by its commitments and what was published; None for no files. Raises as `check`."""
    if files is None:
        return None
    made: list[object] = [
        plain.made(kind, plain.read(path, LARGEST), str(path))
        for kind, path in zip((Commitments, Published), files, strict=True)
    ]
    commitments, published = made
    assert isinstance(commitments, Commitments) and isinstance(published, Published)
    return check(commitments, published)


def write_drawn(path: Path, secret: Path, name: str, count: int) -> None:
    """Draw a set, and write what is committed to `path`, what is secret to `secret`, for its owner alone to read.

    Raises ValueError for a file that is there, and for one that cannot be written.
    """
    for file in (path, secret):
        if file.exists():
            raise ValueError(f"a drawn set must be written to new files, got {file}, which already exists")
    commitments, published = draw(name, count)
    secret.touch(mode=0o600)
    write(secret, json.dumps(dataclasses.asdict(published), indent=1) + "\n")
    write(path, json.dumps(dataclasses.asdict(commitments), indent=1) + "\n")


def write_scenes(track: Track, output: Path) -> None:
    """Write the scene files of a hidden track, a folder for each task, as `hazard-ms evaluate --scenes` plays them."""
    for task, seed in track.places:
        make_folder(output / task)
        with track.scene_file((task, seed)) as file:
            assert file is not None
            write(output / task / f"scene-{seed:03d}.json", read_foreign(Path(file), LARGEST * 64))


def _hashes(published: Published) -> dict[str, tuple[str, ...]]:
    """The hash of each scene. Raises ValueError for a scene of another place or of the split, or there twice."""
    made: dict[str, tuple[str, ...]] = {}
    for task, own in published.scenes.items():
        names = [one.scene for one in own]
        if len(set(names)) != len(names):
            raise ValueError(f"hidden scenes of {task} must differ, got one twice")
        made[task] = tuple(_hash(task, k, one, TRACK.names(task)) for k, one in enumerate(own))
    return made


def _hash(task: str, number: int, hidden: Hidden, names: Sequence[str]) -> str:
    if hidden.scene in names:
        raise ValueError(f"hidden scenes must not belong to a split, got {hidden.scene!r}")
    with file_of(hidden.scene, names) as file:
        content = sha256_of(Path(file))
    return hashlib.sha256(f"{task} {number} {hidden.scene} {content} {hidden.salt}".encode()).hexdigest()
