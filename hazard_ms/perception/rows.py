"""The rows of COCO files, which somebody else may have made: types and limits of every field that is read.

Further fields are allowed, as other programs write them, and are never read.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, fields
from pathlib import Path
from typing import Any

from hazard_ms.spec.checks import one_of
from hazard_ms.spec.foreign.files import printable, read_foreign
from hazard_ms.spec.foreign.pictures import MOST_PIXELS
from hazard_ms.spec.foreign.plain import Limits, made, parse

LARGEST = 400_000_000  # of a file of rows [bytes] [ours]
LIMITS = Limits(farthest=1e15, longest_text=10_000_000)  # whole numbers up to it are exact in pycocotools, too
MOST_OF_PICTURE = 1000  # annotations, as our own ids allow
MOST_INSTANCE = 65534  # that a picture of ids can hold
STATUSES = ("normal", "burning", "burnt")

Row = tuple[float, float, float]
Pose = tuple[float, float, float, float]


@dataclass(frozen=True)
class Camera:
    """The place of the camera that took a picture."""

    intrinsic: tuple[Row, Row, Row]  # [pixels]
    cam2world: tuple[Pose, Pose, Pose, Pose]  # [m]


@dataclass(frozen=True)
class Image:
    """A row of `images`; None: not given."""

    id: int
    width: int  # [pixels]
    height: int  # [pixels]
    file_name: str | None = None
    depth_file: str | None = None
    ids_file: str | None = None
    hazard_file: str | None = None
    scene: str | None = None
    room: str | None = None
    seed: int | None = None
    frame: int | None = None
    lighting: str | None = None
    effects: str | None = None
    hazard_visible: bool | None = None
    thermal_file: str | None = None
    degraded: bool | None = None
    transmission: float | None = None
    camera: Any = None


@dataclass(frozen=True)
class Attributes:
    """The state of a thing that a hazard has changed; None: not given."""

    target: bool | None = None
    status: str | None = None
    wet: bool | None = None
    submerged: float | None = None
    floating: bool | None = None
    speed_mps: float | None = None  # [m/s]
    damaged: bool | None = None
    distance_m: float | None = None  # [m]
    pixels: int | None = None


@dataclass(frozen=True)
class Annotation:
    """A row of `annotations`; None: not given. Masks are checked when they are decoded."""

    id: int
    image_id: int
    category_id: int
    bbox: tuple[float, float, float, float] | None = None  # [pixels]
    area: float | None = None  # [pixels]
    iscrowd: int | None = None
    instance: int | None = None
    name: str | None = None
    attributes: Any = None


@dataclass(frozen=True)
class Category:
    """A row of `categories`."""

    id: int
    name: str


@dataclass(frozen=True)
class Thing:
    """A row of `things` in the file of a scene."""

    name: str
    category: str
    asset: str


@dataclass(frozen=True)
class Detection:
    """A row of a detector's results."""

    image_id: int
    category_id: int
    score: float
    bbox: tuple[float, float, float, float] | None = None  # [pixels]


@dataclass(frozen=True)
class Needs:
    """The fields that a reader cannot do without, beside those that every row has."""

    images: tuple[str, ...] = ()
    annotations: tuple[str, ...] = ()
    attributes: tuple[str, ...] = ()


STATE = ("target", "status", "submerged", "floating", "speed_mps", "damaged", "pixels")
SHOWN = Needs(
    ("file_name", "scene", "frame", "lighting", "effects", "hazard_visible"),
    ("segmentation", "bbox", "area", "name", "attributes"),
    STATE,
)
CHECKED = Needs(
    ("file_name", "depth_file", "ids_file", "hazard_file", "scene", "room", "seed", "frame", "camera"),
    ("segmentation", "bbox", "area", "instance", "attributes"),
    ("pixels", "submerged"),
)
COUNTED = Needs(("scene", "lighting", "effects", "hazard_visible"), ("attributes",), STATE)
LEARNT = Needs(("file_name", "ids_file", "scene"), ("bbox", "instance"))
SCORED = Needs(
    (),
    ("area", "iscrowd", "bbox", "attributes"),
    ("status", "wet", "submerged", "floating", "speed_mps", "damaged", "distance_m", "pixels"),
)


def read_json(path: Path) -> Any:
    """The values in a file of JSON. Raises ValueError for one that is too large, no regular file, or not JSON."""
    return parse(read_foreign(path, LARGEST), printable(str(path)))


def check_rows(rows: Any, what: str, needs: Needs) -> None:
    """Check the images, annotations and categories of the file `what`.

    Raises ValueError that names the first row that is wrong.
    """
    for key in ("images", "annotations", "categories"):
        if not isinstance(rows, dict) or not isinstance(rows.get(key), list):
            raise ValueError(f"{what} must hold images, annotations and categories, got no list of {key}")
    for k, row in enumerate(rows["images"]):
        check_image(row, f"images[{k}] of {what}", needs)
    for k, row in enumerate(rows["annotations"]):
        check_annotation(row, f"annotations[{k}] of {what}", needs)
    for k, row in enumerate(rows["categories"]):
        typed(Category, row, f"categories[{k}] of {what}")


def check_image(row: Any, where: str, needs: Needs) -> None:
    """Check a row of images. Raises ValueError that says what is wrong, and `where`."""
    image = typed(Image, row, where, needs.images)
    if image.width < 1 or image.height < 1 or image.width * image.height > MOST_PIXELS:
        raise ValueError(f"{where} must have 1 to {MOST_PIXELS} pixels, got {image.width} x {image.height}")
    if image.camera is not None:
        typed(Camera, image.camera, f"{where}.camera")


def check_annotation(row: Any, where: str, needs: Needs) -> None:
    """Check a row of annotations. Raises ValueError that says what is wrong, and `where`."""
    annotation = typed(Annotation, row, where, needs.annotations)
    if annotation.instance is not None and not 0 <= annotation.instance <= MOST_INSTANCE:
        raise ValueError(f"{where}.instance must be from 0 to {MOST_INSTANCE}, got {annotation.instance}")
    if annotation.attributes is not None or "attributes" in needs.annotations:
        state = typed(Attributes, annotation.attributes, f"{where}.attributes", needs.attributes)
        if state.status is not None:
            one_of(state.status, STATUSES, f"{where}.attributes.status")


def typed(kind: Any, row: Any, where: str, needed: Sequence[str] = ()) -> Any:
    """The fields of `row` that `kind` has, by their types. Raises ValueError for others, and without a needed one."""
    if not isinstance(row, dict):
        raise ValueError(f"{where} must be an object, got {printable(repr(row)[:100])}")
    if lacking := [key for key in needed if row.get(key) is None]:
        raise ValueError(f"{where} must have {', '.join(lacking)}, got none")
    return made(kind, {f.name: row[f.name] for f in fields(kind) if f.name in row}, where, LIMITS)


def check_unique(rows: Iterable[Mapping[str, Any]], what: str) -> None:
    """Check that ids are positive and differ, as pycocotools needs them. Raises ValueError for one that is not."""
    seen: set[int] = set()
    for row in rows:
        if row["id"] < 1 or row["id"] in seen:
            raise ValueError(f"ids of {what} must be positive and distinct, got {row['id']}")
        seen.add(row["id"])


def by_image(rows: Mapping[str, Any], what: str) -> dict[int, list[dict[str, Any]]]:
    """The annotations of each image by its id. Raises ValueError for one of no image, and for too many of one."""
    found: dict[int, list[dict[str, Any]]] = {image["id"]: [] for image in rows["images"]}
    for annotation in rows["annotations"]:
        number = annotation["image_id"]
        if number not in found:
            raise ValueError(
                f"image_id must be the id of an image, got {number} in annotation {annotation['id']} of {what}"
            )
        found[number].append(annotation)
        if len(found[number]) > MOST_OF_PICTURE:
            raise ValueError(
                f"an image must have at most {MOST_OF_PICTURE} annotations, got more for image {number} in {what}"
            )
    return found
