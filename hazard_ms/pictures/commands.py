"""The sub-commands `render` and `gallery` of `hazard-ms`; each imports what it needs when it is called."""

from __future__ import annotations

import os
import sys
from time import perf_counter, process_time

import tyro

from hazard_ms.pictures.order import GalleryOrder, RenderOrder

FILM_RATE = 24.0  # of a turntable, pictures per second


def render(order: tyro.conf.OmitArgPrefixes[RenderOrder]) -> int:
    """Take a picture of a frame of an episode, rasterised or ray-traced; with --turntable, a film around it."""
    order.check()
    if os.getcwd() not in sys.path:
        sys.path.insert(0, os.getcwd())  # an installed command does not look for the user's agent where the user is
    from hazard_ms.pictures.files import film, save
    from hazard_ms.pictures.stage import Stage

    width, height = order.pixels()
    with Stage(order) as stage:
        if order.output is not None:
            view = stage.view(order.camera, width, height)
            start = perf_counter()
            with stage.ready(view, order.shader) as take:
                began, worked = perf_counter(), process_time()
                picture = take(order.spp)
                spent = f"{perf_counter() - began:.1f} s, {process_time() - worked:.1f} s of processor time"
            print(f"{order.kind()}: {spent}, after {began - start:.1f} s that made it ready")
            save(order.output, picture)
        if order.turntable is not None:
            views = (stage.around(k / order.turns, width, height) for k in range(order.turns))
            film(order.turntable, (stage.picture(v, order.shader, order.spp) for v in views), (width, height), FILM_RATE)
        where = f"{stage.env.specs[0].name}, frame {stage.frame}"
    for path in (order.output, order.turntable):
        if path is not None:
            print(f"{where}: {path.resolve()}")
    return 0


def gallery(order: tyro.conf.OmitArgPrefixes[GalleryOrder]) -> int:
    """Make the gallery: every task at four moments, rasterised and ray-traced, with its page."""
    order.check()
    from hazard_ms.pictures.gallery import make

    print(make(order.output, order.spp).resolve())
    return 0
