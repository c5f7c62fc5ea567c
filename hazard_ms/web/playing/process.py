"""The process of one rescue: it owns the environment, and talks to the server over a pipe."""

from __future__ import annotations

import os
import signal
from multiprocessing.connection import Connection
from pathlib import Path
from typing import Any
from urllib.parse import quote

from hazard_ms.machine.processes import end_with_parent
from hazard_ms.web.playing.link import Link
from hazard_ms.web.rescue import PLAY, Rescue, journal

POLITE = 5  # niceness of making a film: rescues that are being played come first [ours]


def main(connection: Connection, rescue: Rescue, folder: Path) -> None:
    """Play the rescue, and keep it in `folder`; whatever goes wrong is told to the page."""
    end_with_parent()
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the server ends its workers
    link = Link(connection)
    try:
        play(link, rescue, folder)
    except (EOFError, BrokenPipeError, ConnectionResetError):  # the server has gone; the journal stays
        return
    except Exception as error:
        from hazard_ms.evaluation.attempts import told

        link.say("failed", why=told(error))


def play(link: Link, rescue: Rescue, folder: Path) -> None:
    """Play the rescue to its end, and keep it in `folder`. Raises ValueError for one that cannot be played."""
    link.say("building")
    import torch

    torch.set_num_threads(1)
    from hazard_ms.evaluation.runner import Runner, environment, result_of
    from hazard_ms.web.playing.desk import Desk, EndedError
    from hazard_ms.web.playing.pictures import SIZE
    from hazard_ms.web.playing.player import Player

    rescue.check()
    desk = Desk(link, rescue, folder)
    player = Player(rescue, desk)
    options = rescue.episode
    camera = {"width": SIZE[0], "height": SIZE[1]}
    env = environment(options, render_mode="rgb_array", human_render_camera_configs=camera)
    try:
        played = Runner(env, player, [desk]).run(options.seed, options.reset_options)
        desk.tell_rows(played)
        desk.tell("over", ended=played.ended)
        desk.show(everything=True)
        result = result_of(options, env, played)
    except EndedError:
        link.say("closed")
        return
    finally:
        env.close()
    _keep(link, rescue, folder, result)


def _keep(link: Link, rescue: Rescue, folder: Path, result: Any) -> None:
    """Write what remains of a rescue: that of a person as every episode is kept, that of an agent not at all."""
    from hazard_ms.evaluation.runner import summary
    from hazard_ms.web.playing import keeping

    path = keeping.place(folder, result, rescue.name)
    kept = rescue.kind == PLAY
    if kept:
        keeping.keep(path, result)
    journal(folder, rescue.name).unlink(missing_ok=True)
    suffixes = (".html", ".json") if kept else ()
    link.say("over", ended=result.ended, summary=summary(result), files=_links(path, suffixes))
    if not kept:
        return
    os.nice(POLITE)
    told = lambda frame: link.say("filming", frame=frame, of=result.frames)  # noqa: E731
    verdict, demonstration = keeping.film(path, rescue.episode, result, told)
    where = None if demonstration is None else str(demonstration)
    link.say("kept", replay=verdict, demonstration=where, files=_links(path, (".html", ".mp4", ".json")))


def _links(path: Path, suffixes: tuple[str, ...]) -> list[dict[str, str]]:
    """Names and addresses of the files of a rescue."""
    names = [path.with_suffix(suffix).name for suffix in suffixes]
    return [{"name": name, "address": f"/files/0/{quote(name)}"} for name in names]
