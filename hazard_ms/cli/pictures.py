"""The commands `hazard-ms render` and `hazard-ms gallery`; each imports what it needs when it is called."""

from __future__ import annotations

from pathlib import Path
from time import perf_counter, process_time
from typing import Annotated, Any

import tyro

from hazard_ms.pictures.options import GalleryOptions, RenderOptions

FILM_RATE = 24.0  # of a turntable, pictures per second


def render(options: Annotated[tyro.conf.OmitArgPrefixes[RenderOptions], tyro.conf.arg(name="")]) -> int:
    """Take a picture of a frame of an episode, rasterised or ray-traced; with --turntable, a film around it."""
    from hazard_ms.agents.base import user_path
    from hazard_ms.pictures.files import film
    from hazard_ms.pictures.frozen_episode import FrozenEpisode

    user_path()
    options.check()
    width, height = options.pixels()
    with FrozenEpisode(options) as frozen:
        if options.output is not None:
            _take(options, frozen, options.output)
        if options.turntable is not None:
            views = (frozen.around(k / options.turns, width, height) for k in range(options.turns))
            pictures = (frozen.picture(v, options.shader, options.spp) for v in views)
            film(options.turntable, pictures, (width, height), FILM_RATE)
        where = f"{frozen.env.specs[0].name}, frame {frozen.frame}"
    for path in (options.output, options.turntable):
        if path is not None:
            print(f"{where}: {path.resolve()}")
    return 0


def _take(options: RenderOptions, frozen: Any, path: Path) -> None:
    """Take the picture of a FrozenEpisode and say how long it took."""
    from hazard_ms.pictures.files import save

    start = perf_counter()
    with frozen.ready(frozen.view(options.camera, *options.pixels()), options.shader) as take:
        began, worked = perf_counter(), process_time()
        picture = take(options.spp)
        spent = f"{perf_counter() - began:.1f} s, {process_time() - worked:.1f} s of processor time"
    print(f"{options.kind()}: {spent}, after {began - start:.1f} s that made it ready")
    save(path, picture)


def gallery(options: Annotated[tyro.conf.OmitArgPrefixes[GalleryOptions], tyro.conf.arg(name="")]) -> int:
    """Make the gallery: every task at several moments, rasterised and ray-traced, with its page."""
    options.check()
    from hazard_ms.pictures.gallery import make

    print(make(options.output, options.spp).resolve())
    return 0
