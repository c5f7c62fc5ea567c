"""Text, chips and rounded panels on numpy images, fast enough for video: what repeats is drawn once and kept.

Images are uint8 [H, W, 3], RGB; positions are (x, y) in pixels from the top left; colours are RGB, 0 to 255.
"""

from __future__ import annotations

from functools import lru_cache

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFont

Colour = tuple[int, int, int]
Pixels = NDArray[np.uint8]

# Colours of panels and texts.
NIGHT: Colour = (15, 17, 21)
PANEL: Colour = (24, 27, 33)
EDGE: Colour = (44, 49, 58)
TEXT: Colour = (236, 239, 244)
SOFT: Colour = (148, 157, 171)
ACCENT: Colour = (255, 138, 61)
GOOD: Colour = (86, 204, 130)
BAD: Colour = (239, 95, 84)
GOLD: Colour = (255, 205, 86)
BLUE: Colour = (92, 173, 255)
CORNER = 10  # radius of the panels' corners


@lru_cache(maxsize=32)
def font(size: int) -> ImageFont.FreeTypeFont | ImageFont.ImageFont:
    """Pillow's own font, so that every machine draws the same."""
    return ImageFont.load_default(size)


@lru_cache(maxsize=2048)
def glyphs(text: str, size: int) -> NDArray[np.float32]:
    """Coverage of a line of text, 0 to 1, [h, w, 1]; the height depends on the size alone."""
    width = max(1, int(np.ceil(font(size).getlength(text))))
    image = Image.new("L", (width, int(size * 1.35)))
    ImageDraw.Draw(image).text((0, 0), text, font=font(size), fill=255)
    return np.asarray(image, np.float32)[..., None] / 255.0


@lru_cache(maxsize=2048)
def text_width(text: str, size: int) -> int:
    """Width of a line of text [pixels]."""
    return int(np.ceil(font(size).getlength(text)))


def shorten(text: str, size: int, width: int) -> str:
    """`text`, cut to fit into `width` pixels, with an ellipsis when it was cut."""
    if text_width(text, size) <= width:
        return text
    while text and text_width(text + "…", size) > width:
        text = text[:-1]
    return text + "…"


def write(image: Pixels, text: str, at: tuple[int, int], size: int, colour: Colour = TEXT, align: str = "left") -> None:
    """A line of text with its top left, top middle or top right at `at`, in place."""
    mask = glyphs(text, size)
    x = at[0] - {"left": 0, "middle": mask.shape[1] // 2, "right": mask.shape[1]}[align]
    paint(image, mask, (x, at[1]), colour)


def paint(image: Pixels, mask: NDArray[np.float32], at: tuple[int, int], colour: Colour) -> None:
    """`colour` over `image` where `mask` [h, w, 1] covers, in place; what lies outside the image is cut off."""
    x, y = at
    top, left = max(0, -y), max(0, -x)
    bottom, right = min(mask.shape[0], image.shape[0] - y), min(mask.shape[1], image.shape[1] - x)
    if bottom <= top or right <= left:
        return
    part = image[y + top : y + bottom, x + left : x + right]
    cover = mask[top:bottom, left:right]
    part[:] = (part + cover * (np.asarray(colour, np.float32) - part) + 0.5).astype(np.uint8)


@lru_cache(maxsize=256)
def rounded(width: int, height: int, radius: int) -> NDArray[np.float32]:
    """Coverage of a rectangle with round corners, smooth at its edge, [height, width, 1] [-]."""
    large = Image.new("L", (width * 4, height * 4))
    ImageDraw.Draw(large).rounded_rectangle((0, 0, width * 4 - 1, height * 4 - 1), radius * 4, fill=255)
    return np.asarray(large.resize((width, height), Image.Resampling.BOX), np.float32)[..., None] / 255.0


@lru_cache(maxsize=64)
def disc(radius: float) -> NDArray[np.float32]:
    """Coverage of a disc, smooth at its edge, [N, N, 1] [-], with its middle in the middle."""
    half = int(np.ceil(radius)) + 1
    y, x = np.mgrid[-half : half + 1, -half : half + 1]
    return np.clip(radius + 0.5 - np.hypot(x, y), 0.0, 1.0).astype(np.float32)[..., None]


def dot(image: Pixels, at: tuple[int, int], radius: float, colour: Colour) -> None:
    """A disc around `at`, in place."""
    mask = disc(radius)
    paint(image, mask, (at[0] - mask.shape[1] // 2, at[1] - mask.shape[0] // 2), colour)


def door(image: Pixels, at: tuple[int, int], name: str, shut: bool, broken: bool) -> None:
    """A square with a `name` for a door: filled while it is `shut`, a frame while it is open, red if it is `broken`."""
    x, y = at
    colour = BAD if broken else TEXT
    cv2.rectangle(image, (x - 6, y - 6), (x + 6, y + 6), PANEL, -1)
    cv2.rectangle(image, (x - 4, y - 4), (x + 4, y + 4), colour, -1 if shut and not broken else 1)
    write(image, name, (min(x + 8, image.shape[1] - 20), max(y - 7, 2)), 12, colour)


def tool(image: Pixels, at: tuple[int, int]) -> None:
    """An upright red bar with a white edge for an extinguisher."""
    x, y = at
    cv2.rectangle(image, (x - 4, y - 7), (x + 4, y + 7), TEXT, -1)
    cv2.rectangle(image, (x - 2, y - 5), (x + 2, y + 5), BAD, -1)


def chip(
    image: Pixels, text: str, at: tuple[int, int], size: int, colour: Colour, back: Colour, cover: float = 0.78
) -> int:
    """A line of text on a rounded ground; returns its width."""
    pad = size // 2
    width, height = text_width(text, size) + 2 * pad, int(size * 1.25) + pad
    paint(image, rounded(width, height, min(CORNER, height // 2)) * cover, at, back)
    write(image, text, (at[0] + pad, at[1] + pad // 2), size, colour)
    return width


def place(image: Pixels, panel: Pixels, at: tuple[int, int], ground: Colour = NIGHT) -> None:
    """`panel` with rounded corners onto `image`, in place; only the corners are blended."""
    x, y = at
    height, width = panel.shape[:2]
    target = image[y : y + height, x : x + width]
    target[:] = panel
    gap = 1.0 - rounded(2 * CORNER, 2 * CORNER, CORNER)
    for rows, corner_rows in ((slice(0, CORNER),) * 2, (slice(height - CORNER, height), slice(CORNER, 2 * CORNER))):
        for columns, corner_columns in (
            (slice(0, CORNER),) * 2,
            (slice(width - CORNER, width), slice(CORNER, 2 * CORNER)),
        ):
            paint(target[rows, columns], gap[corner_rows, corner_columns], (0, 0), ground)
