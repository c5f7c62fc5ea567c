"""`hazard-ms perception show`: pictures of a dataset with their masks and states, and its numbers, as one page."""

from __future__ import annotations

import base64
from collections.abc import Mapping, Sequence
from html import escape
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from numpy.typing import NDArray

from hazard_ms.perception import layout
from hazard_ms.perception.card import numbers
from hazard_ms.perception.closeups import COLOURS, closeups, state_of
from hazard_ms.perception.reading import colours_of, mask_of
from hazard_ms.perception.rows import SHOWN, by_image
from hazard_ms.spec.checks import whole
from hazard_ms.spec.storage.files import make_folder, write

MOST_PICTURES, MOST_THINGS = 500, 5000  # of a page [ours]
EDGE = 384  # of a picture on the page [pixels] [ours]
PIXELS = 80  # of a thing whose name is written [pixels], on EDGE [ours]
QUALITY = 82  # of the page's JPEG pictures, of 100 [ours]
COVER = 0.35  # share of the colour of a mask [ours]
COLUMNS, OF_THINGS = 4, 10  # of a sheet of pictures, and of one of things [ours]
PAGE = """<!doctype html><html lang="en"><meta charset="utf-8"><title>{title}</title>
<style>body{{font:15px system-ui,sans-serif;margin:24px;background:#0f1115;color:#eceff4}}
td,th{{padding:3px 12px 3px 0;text-align:left;vertical-align:top}}
figure{{display:inline-block;margin:0 10px 14px 0;width:{edge}px;vertical-align:top}}
figcaption{{color:#949dab;font-size:13px}}img{{border-radius:6px;width:100%}}
b{{padding:1px 8px;border-radius:4px;color:#000;margin-right:6px}}</style>
<h1>{title}</h1><p>{legend}</p>{body}</html>
"""


def show(dataset: Path, output: Path, pictures: int, things: int = 0) -> Path:
    """Write the page, NAME.html, or only its pictures as one sheet, NAME.png or NAME.jpg. Returns its path.

    `pictures` of each split are shown, evenly spread, and `things` of each, drawn at random; a sheet has these alone
    if there are any. Raises ValueError for a folder that is not a dataset, and for a page that cannot be written.
    """
    whole(pictures, 1, MOST_PICTURES, "pictures")
    whole(things, 0, MOST_THINGS, "things")
    splits = layout.splits_of(dataset)
    endings = (".html", ".png", ".jpg")
    if output.suffix not in endings:
        raise ValueError(f"output must end in {' or '.join(endings)}, got {output.name!r}")
    make_folder(output.parent)
    close = [cell for path in splits for cell in closeups(dataset, path, things)] if things else []
    if things and not close:
        raise ValueError(f"{dataset} must hold annotated things to show, got none")
    if output.suffix != ".html" and things:
        write(output, _encoded(sheet(close, OF_THINGS), output.suffix))
        return output
    if output.suffix != ".html":
        shown = [drawn for path in splits for drawn, _ in _some(dataset, layout.read_instances(path, SHOWN), pictures)]
        write(output, _encoded(sheet(shown, COLUMNS), output.suffix))
        return output
    parts = []
    for path in splits:
        rows = layout.read_instances(path, SHOWN)
        table = "".join(f"<tr><th>{escape(name)}</th><td>{escape(text)}</td></tr>" for name, text in numbers(rows))
        figures = "".join(_figure(drawn, image) for drawn, image in _some(dataset, rows, pictures))
        parts.append(f"<h2>{escape(path.stem)}</h2><table>{table}</table><p>{figures}</p>")
    parts += [f"<h2>Things</h2><p>{_image(sheet(close, OF_THINGS))}</p>"] if close else []
    legend = "".join(f'<b style="background:rgb{colour}">{name}</b>' for name, colour in COLOURS.items())
    write(output, PAGE.format(title=escape(dataset.name), legend=legend, body="".join(parts), edge=EDGE))
    return output


def sheet(pictures: list[NDArray[np.uint8]], columns: int) -> NDArray[np.uint8]:
    """Pictures of one size as one, at most `columns` in a row, [H, W, 3]."""
    blank = np.zeros_like(pictures[0])
    columns = min(columns, len(pictures))
    rest = [*pictures, *[blank] * (-len(pictures) % columns)]
    rows = [np.hstack(rest[k : k + columns]) for k in range(0, len(rest), columns)]
    whole_sheet: NDArray[np.uint8] = np.vstack(rows)
    return whole_sheet


def _some(dataset: Path, rows: Mapping[str, Any], count: int) -> list[tuple[NDArray[np.uint8], Mapping[str, Any]]]:
    """So many pictures of a split, drawn over, evenly spread, each with its row of images."""
    images = rows["images"]
    chosen = [images[k] for k in np.unique(np.linspace(0, len(images) - 1, min(count, len(images))).astype(int))]
    of_image = by_image(rows, str(dataset))
    return [(drawn(dataset, image, of_image[image["id"]]), image) for image in chosen]


def drawn(dataset: Path, image: Mapping[str, Any], annotations: Sequence[Mapping[str, Any]]) -> NDArray[np.uint8]:
    """A picture of EDGE pixels, [H, W, 3], RGB, with its masks, boxes and names in the colours of their states.

    Raises ValueError for a file that is not a picture of the size in its row, and for masks of other sizes.
    """
    read = colours_of(dataset, image)
    shown = cv2.resize(read, (EDGE, EDGE), interpolation=cv2.INTER_AREA)
    scale = EDGE / read.shape[0]
    for annotation in sorted(annotations, key=lambda row: -row["area"]):
        colour = COLOURS[state_of(annotation["attributes"])]
        runs = mask_of(
            annotation["segmentation"], read.shape[:2], f"annotation {annotation['id']} of {image['file_name']}"
        )
        mask = cv2.resize(runs, (EDGE, EDGE)).astype(bool)
        shown[mask] = ((1.0 - COVER) * shown[mask] + COVER * np.asarray(colour)).astype(np.uint8)
        x, y, width, height = (round(scale * n) for n in annotation["bbox"])
        cv2.rectangle(shown, (x, y), (x + width, y + height), colour, 1)
        if annotation["area"] * scale**2 >= PIXELS:
            at = (min(max(x, 2), EDGE - 60), max(y - 3, 9))
            cv2.putText(shown, annotation["name"], at, cv2.FONT_HERSHEY_SIMPLEX, 0.32, colour, 1, cv2.LINE_AA)
    return np.ascontiguousarray(shown)


def _figure(picture: NDArray[np.uint8], image: Mapping[str, Any]) -> str:
    words = f"{image['scene']}, frame {image['frame']}, {image['lighting']}, effects {image['effects']}"
    return f"<figure>{_image(picture)}<figcaption>{escape(words)}</figcaption></figure>"


def _image(picture: NDArray[np.uint8]) -> str:
    return f'<img src="data:image/jpeg;base64,{base64.b64encode(_encoded(picture, ".jpg")).decode()}">'


def _encoded(picture: NDArray[np.uint8], ending: str) -> bytes:
    settings = [cv2.IMWRITE_JPEG_QUALITY, QUALITY] if ending == ".jpg" else []
    return cv2.imencode(ending, picture[..., ::-1], settings)[1].tobytes()
