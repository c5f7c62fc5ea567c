"""Pictures of models: PNG, JPEG and WebP, told apart by their first bytes, and made small before anything else."""

from __future__ import annotations

import hashlib
import io
import warnings

from PIL import Image

from hazard_ms.spec.foreign.files import printable

FORMATS = ("PNG", "JPEG", "WEBP")  # PIL opens others by starting programs, EPS with Ghostscript for example
LARGEST_IMAGE = 8192  # edge of a picture [pixels] [ours]
TEXTURE_SIZE = 512  # longest edge of what is kept [pixels] [ours]
QUICK = 1  # zlib's level for pictures that are only handed on


def forbid_other_formats() -> None:
    """Make PIL open FORMATS only, in this process and whoever asks."""
    Image.init()  # loads all formats: what is taken out now does not come back
    Image.ID[:] = FORMATS
    for name in set(Image.OPEN) - set(FORMATS):
        del Image.OPEN[name]


class Textures:
    """The pictures of one model; each is decoded once, however often it is named."""

    def __init__(self) -> None:
        self._made: dict[bytes, bytes] = {}

    def small(self, data: bytes, name: str) -> bytes:
        """The picture `data`, its longest edge at most TEXTURE_SIZE pixels, as a PNG file.

        Raises ValueError that calls it `name` for other formats, larger edges and broken files.
        """
        key = hashlib.sha256(data).digest()
        if key not in self._made:
            self._made[key] = _small(data, printable(name)[:200])
        return self._made[key]


def _small(data: bytes, name: str) -> bytes:
    kind = format_of(data)
    if not kind:
        raise ValueError(f"a texture must be a PNG, JPEG or WebP file, got {name}, which begins with {data[:8]!r}")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", Image.DecompressionBombWarning)
            image = Image.open(io.BytesIO(data), formats=(kind,))
    except (Image.DecompressionBombError, Image.DecompressionBombWarning) as error:
        raise ValueError(f"{name} must have edges of at most {LARGEST_IMAGE} pixels, got more: {error}") from None
    except Exception as error:  # of whatever kind PIL raises for broken files
        raise ValueError(f"{name} cannot be read: {error!r:.200}") from None
    if max(image.size) > LARGEST_IMAGE:
        width, height = image.size
        raise ValueError(f"{name} must have edges of at most {LARGEST_IMAGE} pixels, got {width} x {height}")
    packed = io.BytesIO()
    try:
        _reduced(image).save(packed, "PNG", compress_level=QUICK)
    except MemoryError:
        raise ValueError(f"{name} must fit into the memory of one model, got more: make it smaller first") from None
    except Exception as error:  # likewise
        raise ValueError(f"{name} cannot be read: {error!r:.200}") from None
    return packed.getvalue()


def format_of(data: bytes) -> str:
    """The format of a picture, one of FORMATS, by the first bytes of its file; empty for other files."""
    if data.startswith(b"\x89PNG\r\n\x1a\n"):
        return "PNG"
    if data.startswith(b"\xff\xd8\xff"):
        return "JPEG"
    return "WEBP" if data[:4] == b"RIFF" and data[8:12] == b"WEBP" else ""


def _reduced(image: Image.Image) -> Image.Image:
    if image.mode not in ("L", "RGB", "RGBA") or "transparency" in image.info:
        image = image.convert("RGBA")
    scale = TEXTURE_SIZE / max(image.size)
    if scale >= 1.0:
        return image
    width, height = (max(1, round(edge * scale)) for edge in image.size)
    return image.resize((width, height), Image.Resampling.LANCZOS)
